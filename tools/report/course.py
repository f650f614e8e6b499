"""Load histories of a joint for its report: load ramp and load cycles, computed in Python without an FMU."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from jointfmu_fmu_src.native.page import evaluate_outputs

from jointfmu.joints.model import Model
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array

from ..ramps.loops import CyclicPath, HysteresisLoops, find_conjugate_output, loops_from_results
from ..ramps.ramp import RampResult

_RAMP_POINTS = 101
"""Number of points of the load ramp."""
_LOAD_CYCLE = CyclicPath(points=80)
"""Load cycle: points per cycle, shape, number of cycles."""
AMPLITUDE_RATIOS = (0.25, 0.5, 1.0)
"""Amplitudes of the load cycles over the largest amplitude [1]."""
_MAX_DOUBLINGS, _BISECTIONS = 10, 12
"""Doublings of the load in the search for the end of the law, and bisections to locate it."""
_GROSS_SLIP_RATIO = 0.95
"""Force over the force at gross slip [1] above which the joint counts as slipping."""


class LoadHistory:
    """Load ramp and load cycles of a joint. All other inputs have the start values of the file.

    file, spring : parameter file, tabulated curves of the joint
    model        : model of the FMU, with ramp and load cycle for this file
    start_values : {input: start value}
    law_limit    : (value of the ramped input, warning) at the end of the law's range; None if there is no end
                   near the ramp
    """

    def __init__(self, model: Model, file: ParameterFile) -> None:
        self.file, self.spring = file, model.tabulate(file.values)
        self.start_values = {v.name: file.start_value(v.name) for v in model.inputs}
        self.model = model.with_parameters(file.joint, file.values).with_load_range(
            self.spring, self.start_values
        )
        self.law_limit = _find_law_limit(self.model, self.spring, self.start_values)

    def compute_ramp(self) -> dict[str, Array]:
        """Compute inputs and outputs (n) along the load ramp; points are dense where curves bend."""
        ramp = self.model.ramp
        points = [{**self.start_values, ramp.input_name: float(x)} for x in ramp.sample_inputs(_RAMP_POINTS)]
        rows = [point | evaluate_outputs(self.model, self.spring, point) for point in points]
        return {name: np.array([row[name] for row in rows]) for name in rows[0]}

    @property
    def loop_inputs(self) -> dict[str, float]:
        """Inputs during the load cycles: start values, or the settings of the model if these are zero."""
        assert self.model.load_cycle
        settings = self.model.load_cycle.settings
        return {name: value or float(settings.get(name, 0.0)) for name, value in self.start_values.items()}

    def compute_loops(self) -> HysteresisLoops:
        """Compute hysteresis loops of increasing amplitude, each from rest, of a joint with friction."""
        loop, driven = self.model.load_cycle, {v.name: v.unit for v in self.model.inputs}
        assert loop
        outputs = {v.name: v.unit for v in self.model.outputs}
        output = find_conjugate_output(driven, outputs, loop.input_name, None, self.model.name)
        swing = CyclicPath(centre=self.loop_inputs[loop.input_name], points=_LOAD_CYCLE.points)
        largest = self._largest_amplitude(output)
        results = [
            self._follow_path(loop.input_name, swing.input_values(a * largest), driven | outputs)
            for a in AMPLITUDE_RATIOS
        ]
        return loops_from_results(results, loop.input_name, output, swing)

    def _largest_amplitude(self, output: str) -> float:
        """Largest amplitude of the load cycles.

        It is the amplitude of the model, or, if that is less, twice the displacement at gross slip.
        """
        loop = self.model.load_cycle
        assert loop
        largest = loop.amplitude

        def force_range(amplitude: float) -> float:
            points = self.loop_inputs[loop.input_name] + np.array([0.0, amplitude])
            return float(np.ptp(self._follow_path(loop.input_name, points, {}).columns[output]))

        end = force_range(largest)
        if _GROSS_SLIP_RATIO * force_range(2.0 * largest) > end:
            return largest
        low, high = 0.0, largest
        for _ in range(_BISECTIONS):
            middle = 0.5 * (low + high)
            low, high = (low, middle) if force_range(middle) > _GROSS_SLIP_RATIO * end else (middle, high)
        return min(largest, float(f"{2.0 * high:.2g}"))

    def _follow_path(self, name: str, points: Array, units: dict[str, str]) -> RampResult:
        """Compute the outputs along a path of one input, from rest."""
        evolve, rest = self.model.advance, self.model.initial_history
        assert evolve
        assert rest
        memory, rows = rest(self.spring), []
        for x in points:
            outputs, memory = evolve(self.spring, {**self.loop_inputs, name: float(x)}, memory)
            rows.append({name: float(x)} | {output: float(value) for output, value in outputs.items()})
        return RampResult({key: np.array([row[key] for row in rows]) for key in rows[0]}, units, ())


def _find_law_limit(model: Model, spring: Any, start_values: Mapping[str, float]) -> tuple[float, str] | None:
    """Find the end of the law: smallest ramped input with a warning that is absent at zero, and the warning.

    None if no such warning appears up to 2^10 times the end of the ramp.
    """

    def warnings_at(x: float) -> dict[int, str]:
        inputs = {**start_values, model.ramp.input_name: x}
        return model.find_warnings(spring, inputs | evaluate_outputs(model, spring, inputs))

    before = warnings_at(0.0)

    def new_warnings(x: float) -> list[str]:
        return [text for number, text in warnings_at(x).items() if number not in before]

    low, high = 0.0, 2.0**-_MAX_DOUBLINGS * model.ramp.end_value
    while not new_warnings(high):
        low, high = high, 2.0 * high
        if high > 2.0**_MAX_DOUBLINGS * model.ramp.end_value:
            return None
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if new_warnings(middle) else (middle, high)
    return high, new_warnings(high)[0]
