"""What an importer is given: an experiment as plain numbers, which go to its process as JSON."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from ..host import Instance

REAL = ("Real", "Float64")
"""Types of real numbers."""


@dataclass(frozen=True, slots=True)
class Task:
    """An experiment, ready to be executed.

    fmu, folder : path of the FMU, and of the folder where it is unpacked
    interface : one of INTERFACES
    settings : {variable: start value}
    times    : (n) communication points [s]
    inputs   : {variable: (n) values}, where one jumps the later
    before   : the same, where one jumps the earlier
    outputs  : variables that are read
    kinds    : {variable: its kind} of inputs and outputs, see `jointfmu_tools.proof.values`
    tolerance : relative, of a solver [1]
    due      : times [s] at which outputs are compared; none if all communication points are asked for
    """

    fmu: str
    folder: str
    interface: str
    settings: Mapping[str, object] = field(default_factory=dict)
    times: Sequence[float] = ()
    inputs: Mapping[str, Sequence[float]] = field(default_factory=dict)
    before: Mapping[str, Sequence[float]] = field(default_factory=dict)
    outputs: Sequence[str] = ()
    kinds: Mapping[str, str] = field(default_factory=dict)
    tolerance: float = 1e-5
    due: Sequence[float] = ()

    def given(self, i: int) -> dict[str, float]:
        """Inputs at a communication point."""
        return {name: values[i] for name, values in self.inputs.items()}

    @property
    def step(self) -> float:
        """The step [s], for importers that know one step only.

        Raises ValueError if steps differ or do not begin at zero.
        """
        if self.times[0] != 0.0:
            raise ValueError(f"begins at {self.times[0]:g} s, this importer begins at 0")
        size = (self.times[-1] - self.times[0]) / max(len(self.times) - 1, 1)
        if any(abs(time - i * size) > 1e-6 * size for i, time in enumerate(self.times)):
            raise ValueError("has steps of different size, this importer has one")
        return size

    def compared(self, rows: "Rows") -> "Rows":
        """None in place of what lies neither at nor beside a time that is due, but for the first and last."""
        shown = np.array([i for i, row in enumerate(rows) if row is not None], dtype=int)
        if not (len(self.due) and shown.size):
            return rows
        after = np.searchsorted(np.take(self.times, shown), self.due, side="right")
        around = np.clip([after - 1, after], 0, shown.size - 1)
        kept = {*shown[around.ravel()].tolist(), int(shown[0]), int(shown[-1])}
        return [row if i in kept else None for i, row in enumerate(rows)]


Rows = list[list[float] | None]
"""Outputs at each communication point; None where the importer does not show them, or none is due."""
Execute = Callable[[Task, list[str]], Rows]
"""(task, messages, to which those of the FMU are added) -> outputs."""


def reader(instance: Instance, outputs: Sequence[str]) -> Callable[[], list[float]]:
    """What reads outputs of an instance, real numbers in one call."""
    if all(instance.variables[name].type in REAL for name in outputs):
        return instance.reals(outputs).get
    return lambda: [float(instance.value(name)) for name in outputs]
