"""Task for an importer: an experiment as plain numbers, passed to the process of the importer as JSON."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from ..host import Instance

REAL_TYPES = ("Real", "Float64")
"""Types of real variables in FMI 2.0 and 3.0."""


@dataclass(frozen=True, slots=True)
class ExperimentTask:
    """Task for an importer: experiment with an FMU, ready to be executed.

    fmu, folder : path of the FMU, and of the folder where it is unpacked
    interface : FMI interface, one of INTERFACES
    settings  : {variable: start value}
    times     : communication points (n) [s]
    inputs    : {input: values (n)}; at a jump the value after it
    inputs_before_jump : {input: values (n)}; at a jump the value before it
    outputs   : names of the variables to be read
    variable_kinds     : {variable: kind} of inputs and outputs: "real", "integer" or "boolean"
    tolerance : relative tolerance of the solver [1]
    comparison_times : times [s] at which outputs are compared; empty: outputs at all communication points
    """

    fmu: str
    folder: str
    interface: str
    settings: Mapping[str, object] = field(default_factory=dict)
    times: Sequence[float] = ()
    inputs: Mapping[str, Sequence[float]] = field(default_factory=dict)
    inputs_before_jump: Mapping[str, Sequence[float]] = field(default_factory=dict)
    outputs: Sequence[str] = ()
    variable_kinds: Mapping[str, str] = field(default_factory=dict)
    tolerance: float = 1e-5
    comparison_times: Sequence[float] = ()

    def inputs_at(self, point_index: int) -> dict[str, float]:
        """Inputs {name: value} at the communication point i; at a jump the value after it."""
        return {name: values[point_index] for name, values in self.inputs.items()}

    @property
    def step_size(self) -> float:
        """Constant step size [s], for importers that support no other.

        Raises ValueError if step sizes differ, or if the experiment does not start at zero.
        """
        if self.times[0] != 0.0:
            raise ValueError(f"begins at {self.times[0]:g} s, this importer begins at 0")
        size = (self.times[-1] - self.times[0]) / max(len(self.times) - 1, 1)
        if any(abs(time - i * size) > 1e-6 * size for i, time in enumerate(self.times)):
            raise ValueError("has steps of different size, this importer has one")
        return size

    def mask_unneeded_rows(self, rows: "OutputRows") -> "OutputRows":
        """Replace rows of outputs that are not needed for the comparison with references by None.

        Rows next to a comparison time, and the first and the last row, are kept.
        """
        available = np.array([i for i, row in enumerate(rows) if row is not None], dtype=int)
        if not (len(self.comparison_times) and available.size):
            return rows
        after = np.searchsorted(np.take(self.times, available), self.comparison_times, side="right")
        neighbours = np.clip([after - 1, after], 0, available.size - 1)
        needed = {*available[neighbours.ravel()].tolist(), int(available[0]), int(available[-1])}
        return [row if i in needed else None for i, row in enumerate(rows)]


OutputRows = list[list[float] | None]
"""Outputs at each communication point; None if the importer gives none, or if they are not needed."""
ExecuteFunction = Callable[[ExperimentTask, list[str]], OutputRows]
"""Function of an importer: (task, messages) -> rows; it appends the messages of the FMU."""


def make_output_reader(instance: Instance, outputs: Sequence[str]) -> Callable[[], list[float]]:
    """Make the function that reads the outputs of an instance; if all are real variables, in one call."""
    if all(instance.variables[name].type in REAL_TYPES for name in outputs):
        return instance.group_real_variables(outputs).get_values
    return lambda: [float(instance.get_value(name)) for name in outputs]
