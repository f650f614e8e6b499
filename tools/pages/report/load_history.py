"""Load histories of a joint for its report: load ramp and load cycles."""

import numpy as np

from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array

from ...run.engine import open_joint
from ...run.ramps.loops import CyclicInputPath, HysteresisLoops, find_conjugate_output, loops_from_results
from ...run.ramps.ramp import RampResult

_RAMP_POINT_COUNT = 101
"""Number of points of the load ramp [1]."""
_LOAD_CYCLE = CyclicInputPath(points_per_cycle=80)
"""Load cycle: points per cycle, shape, number of cycles."""
LOOP_AMPLITUDES_OVER_LARGEST_AMPLITUDE = (0.25, 0.5, 1.0)
"""Amplitudes of the load cycles over the largest amplitude [1]."""
_MAX_LOAD_DOUBLINGS, _LAW_LIMIT_BISECTIONS = 10, 12
"""Doublings of the load in the search for the end of the law, and bisections to locate it."""
_SLIPPING_OVER_GROSS_SLIP_FORCE = 0.95
"""Force over the force at gross slip [1], above which the joint counts as slipping."""


class LoadHistory:
    """Load ramp and load cycles of a joint. All other inputs have the start values of the file.

    file            : parameter file
    tabulated_joint : tabulated curves of the joint
    model           : model of the FMU, with ramp and load cycle for this file
    start_values    : {input: start value}
    law_limit       : (value of the ramped input, warning) where the interface law ceases to be valid; None
                      if this is not near the ramp
    """

    def __init__(self, fmu_model: Model, parameter_file: ParameterFile) -> None:
        self.file, self.tabulated_joint = parameter_file, fmu_model.tabulate(parameter_file.values)
        self.start_values = {v.name: parameter_file.start_value(v.name) for v in fmu_model.inputs}
        self.model = fmu_model.with_parameters(parameter_file.joint, parameter_file.values).with_load_range(
            self.tabulated_joint, self.start_values
        )
        self._engine = open_joint(self.model, parameter_file)
        self.law_limit = self._find_law_limit()

    def compute_ramp(self) -> dict[str, Array]:
        """Compute inputs and outputs (n) along the load ramp; points are dense where curves bend."""
        ramp = self.model.ramp
        points = {ramp.input_name: ramp.sample_inputs(_RAMP_POINT_COUNT)}
        return self._engine.evaluate_path(points, restart_at_each_point=True).variable_columns

    @property
    def loop_inputs(self) -> dict[str, float]:
        """{input: value} in the load cycles: its start value; if it is 0, the value in `Model.load_cycle`."""
        assert self.model.load_cycle
        settings = self.model.load_cycle.variable_values
        return {name: value or float(settings.get(name, 0.0)) for name, value in self.start_values.items()}

    def compute_loops(self) -> HysteresisLoops:
        """Compute hysteresis loops of increasing amplitude, each from rest, of a joint with friction."""
        loop, driven = self.model.load_cycle, {v.name: v.unit for v in self.model.inputs}
        assert loop
        outputs = {v.name: v.unit for v in self.model.outputs}
        output = find_conjugate_output(driven, outputs, loop.input_name, None, self.model.name)
        swing = CyclicInputPath(
            centre_value=self.loop_inputs[loop.input_name], points_per_cycle=_LOAD_CYCLE.points_per_cycle
        )
        largest = self._largest_amplitude(output)
        results = [
            self._compute_along_path(
                loop.input_name, swing.compute_input_values(a * largest), driven | outputs
            )
            for a in LOOP_AMPLITUDES_OVER_LARGEST_AMPLITUDE
        ]
        return loops_from_results(results, loop.input_name, output, swing)

    def _largest_amplitude(self, conjugate_output: str) -> float:
        """Largest amplitude of the load cycles.

        The smaller one of the amplitude in `Model.load_cycle` and twice the displacement at gross slip.
        """
        loop = self.model.load_cycle
        assert loop
        largest = loop.input_amplitude

        def force_range(amplitude: float) -> float:
            """Largest minus smallest force [unit of the output] in a load cycle with an amplitude."""
            points = self.loop_inputs[loop.input_name] + np.array([0.0, amplitude])
            return float(
                np.ptp(
                    self._compute_along_path(loop.input_name, points, {}).variable_columns[conjugate_output]
                )
            )

        end = force_range(largest)
        if _SLIPPING_OVER_GROSS_SLIP_FORCE * force_range(2.0 * largest) > end:
            return largest
        low, high = 0.0, largest
        for _ in range(_LAW_LIMIT_BISECTIONS):
            middle = 0.5 * (low + high)
            low, high = (
                (low, middle)
                if force_range(middle) > _SLIPPING_OVER_GROSS_SLIP_FORCE * end
                else (middle, high)
            )
        return min(largest, float(f"{2.0 * high:.2g}"))

    def _compute_along_path(
        self, input_name: str, input_values: Array, unit_by_variable: dict[str, str]
    ) -> RampResult:
        """Compute the outputs along a path of one input, from rest."""
        columns = self._engine.evaluate_path({**self.loop_inputs, input_name: input_values}).variable_columns
        read = (input_name, *(v.name for v in self.model.outputs))
        return RampResult({key: columns[key] for key in read}, unit_by_variable, ())

    def _find_law_limit(self) -> tuple[float, str] | None:
        """Find where the law ceases to be valid: smallest ramped input with a new warning, and the warning.

        A warning is new if it is absent at zero. None if none appears up to 2^10 times the end of the ramp.
        """
        model = self.model

        def list_warnings_at(input_value: float) -> dict[int, str]:
            """Warnings of the model at a value of the ramped input."""
            columns = self._engine.evaluate_path(
                {model.ramp.input_name: input_value}, restart_at_each_point=True
            ).variable_columns
            return model.find_warnings(
                self.tabulated_joint, {name: float(column[0]) for name, column in columns.items()}
            )

        before = list_warnings_at(0.0)

        def list_new_warnings(input_value: float) -> list[str]:
            """Warnings at a value of the ramped input that are absent at zero."""
            return [text for number, text in list_warnings_at(input_value).items() if number not in before]

        low, high = 0.0, 2.0**-_MAX_LOAD_DOUBLINGS * model.ramp.end_value
        while not list_new_warnings(high):
            low, high = high, 2.0 * high
            if high > 2.0**_MAX_LOAD_DOUBLINGS * model.ramp.end_value:
                return None
        for _ in range(_LAW_LIMIT_BISECTIONS):
            middle = 0.5 * (low + high)
            low, high = (low, middle) if list_new_warnings(middle) else (middle, high)
        return high, list_new_warnings(high)[0]
