"""Task for an importer: an experiment as plain numbers, passed to the process of the importer as JSON."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from ..host import FmuInstance

FMI_REAL_TYPES = ("Real", "Float64")
"""Types of real variables in FMI 2.0 and 3.0."""


@dataclass(frozen=True, slots=True)
class ExperimentTask:
    """Task for an importer: experiment with an FMU, ready to be executed.

    fmu_path, fmu_folder : path of the FMU, and of the folder where it is unpacked
    fmi_interface : FMI interface, co-simulation or model exchange
    start_values : {variable: start value}
    communication_points : communication points (n) [s]
    input_values : {input: values (n)}; at a jump the value after it
    input_values_before_jump : {input: values (n)}; at a jump the value before it
    output_names : names of the variables to be read, in the order of the columns of the result
    variable_data_types : {variable: data type} of inputs and outputs: "real", "integer" or "boolean"
    solver_tolerance : relative tolerance of the solver [1]
    comparison_times : times [s] at which outputs are compared; empty: outputs at all communication points
    """

    fmu_path: str
    fmu_folder: str
    fmi_interface: str
    start_values: Mapping[str, object] = field(default_factory=dict)
    communication_points: Sequence[float] = ()
    input_values: Mapping[str, Sequence[float]] = field(default_factory=dict)
    input_values_before_jump: Mapping[str, Sequence[float]] = field(default_factory=dict)
    output_names: Sequence[str] = ()
    variable_data_types: Mapping[str, str] = field(default_factory=dict)
    solver_tolerance: float = 1e-5
    comparison_times: Sequence[float] = ()

    def inputs_at(self, point_index: int) -> dict[str, float]:
        """Inputs {name: value} at the communication point with an index; at a jump the value after it."""
        return {name: values[point_index] for name, values in self.input_values.items()}

    @property
    def step_size(self) -> float:
        """Constant step size [s], for importers that support no other.

        Raises ValueError if step sizes differ, or if the experiment does not start at zero.
        """
        if self.communication_points[0] != 0.0:
            raise ValueError(
                f"its start time is {self.communication_points[0]:g} s; this importer starts at 0 s only: "
                "use --in fmpy"
            )
        size = (self.communication_points[-1] - self.communication_points[0]) / max(
            len(self.communication_points) - 1, 1
        )
        if any(abs(time - i * size) > 1e-6 * size for i, time in enumerate(self.communication_points)):
            raise ValueError(
                "its time steps are not equal; this importer takes equal steps only: use --in fmpy"
            )
        return size

    def mask_unneeded_rows(self, output_rows: "OutputRows") -> "OutputRows":
        """Replace rows of outputs that are not needed for the comparison with references by None.

        Rows next to a comparison time, and the first and the last row, are kept.
        """
        available = np.array([i for i, row in enumerate(output_rows) if row is not None], dtype=int)
        if not (len(self.comparison_times) and available.size):
            return output_rows
        after = np.searchsorted(
            np.take(self.communication_points, available), self.comparison_times, side="right"
        )
        neighbours = np.clip([after - 1, after], 0, available.size - 1)
        needed = {*available[neighbours.ravel()].tolist(), int(available[0]), int(available[-1])}
        return [row if i in needed else None for i, row in enumerate(output_rows)]


OutputRows = list[list[float] | None]
"""Outputs at each communication point; None if the importer gives none, or if they are not needed."""
ExecuteFunction = Callable[[ExperimentTask, list[str]], OutputRows]
"""Function of an importer: (task, messages) -> rows; it appends the messages of the FMU."""


def make_output_reader(fmu_instance: FmuInstance, output_names: Sequence[str]) -> Callable[[], list[float]]:
    """Make a function that reads the outputs of an FMU instance; if all are real, in one FMI call."""
    if all(fmu_instance.variables[name].type in FMI_REAL_TYPES for name in output_names):
        return fmu_instance.group_real_variables(output_names).get_values
    return lambda: [float(fmu_instance.get_value(name)) for name in output_names]
