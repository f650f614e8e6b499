"""A file's measurement of a joint with memory: loops, free vibration or a response."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from . import heads
from .branches import Loops, cut
from .decay import Points, points
from .least_squares import Array
from .oscillator import Free, Response


@dataclass(frozen=True, slots=True)
class Measurement:
    """A file's measurement.

    kind : one of those of `heads.read`
    span : over which motions, in words
    units : {column: unit in the heading}
    """

    path: Path
    kind: str
    heads: heads.Heads
    data: Loops | Free | Response
    units: Mapping[str, str]

    @property
    def motion(self) -> Array:
        """Motions (n): of the samples, or amplitudes."""
        match self.data:
            case Loops():
                return self.data.motion
            case Free():
                return self.data.points.amplitude
            case Response():
                return self.data.amplitude

    @property
    def amplitude(self) -> float:
        """Largest amplitude: half the range of loops."""
        return float(0.5 * np.ptp(self.motion) if self.kind == "loops" else np.max(self.motion))

    def rest_stiffness(self, inertia: float | None) -> float:
        """Stiffness [N/m or N.m/rad] of tiny motions, roughly; what vibrates is needed unless it is loops."""
        if isinstance(self.data, Loops):
            return self.data.rest_stiffness
        if isinstance(self.data, Free):
            frequency = self.data.points.frequency[np.argmin(self.data.points.amplitude)]
        else:
            least = np.where(self.data.force == self.data.force.min(), self.data.amplitude, 0.0)
            frequency = self.data.frequency[np.argmax(least)]
        assert inertia is not None
        return float(inertia * (2.0 * np.pi * frequency) ** 2)

    @property
    def span(self) -> str:
        """What it is and up to which amplitude."""
        return f"{self.kind} up to {self.heads.motion} {self.amplitude:.4g} {self.heads.unit[1]}"


def measured(path: str | Path, columns: heads.Heads) -> Measurement:
    """Read and check a file, see `heads.read`; ValueError, one line, beginning with the path."""
    kind, table = heads.read(path, columns)
    runs = heads.runs(table)
    data: Loops | Free | Response
    try:
        if kind == "loops":
            data = cut([(name, run[columns.motion], run[columns.force]) for name, run in runs])
        elif kind == "decay":
            data = Free(_joined([points(run["time"], run[columns.motion], name) for name, run in runs]))
        elif kind == "backbone":
            a, f, damping = (table.columns[name] for name in (columns.motion, "frequency", "damping"))
            data = Free(Points(a, f, damping, np.ones_like(f), damping))
        else:
            data = Response(*(table.columns[name] for name in ("frequency", columns.force, columns.motion)))
    except ValueError as error:
        raise ValueError(f"{table.path}: {error}") from None
    return Measurement(table.path, kind, columns, data, table.units)


def _joined(parts: Sequence[Points]) -> Points:
    return Points(
        *(np.concatenate([getattr(part, name) for part in parts]) for name in Points.__dataclass_fields__)
    )
