"""A file's measurement of a joint with memory: loops, free vibration or a response; its columns."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array
from jointfmu.quantity.refusal import Refusal
from jointfmu.quantity.units import Sizes, sizes
from jointfmu.quantity.units import measured as measured_in

from .. import columns
from .branches import Loops, cut
from .decay import Points, points
from .hysteresis import Free, Response

LEAST = 8
"""Fewest rows of a file."""
RUN = "run"
"""Column that tells measurements apart: one number for all rows of one."""
OTHERS = {
    "displacement": ("x", "s", "u", "weg", "verschiebung"),
    "force": ("kraft", "load", "f"),
    "angle": ("phi", "theta", "winkel", "drehwinkel", "rotation"),
    "torque": ("tau", "moment", "drehmoment", "torsionsmoment"),
    "time": ("t", "zeit"),
    "frequency": ("freq", "frequenz", "f"),
    "damping": ("zeta", "dämpfung", "dämpfungsgrad"),
}
"""{column: other names of it, in lower case}."""
FAR = 50.0
"""Stiffness of a measurement over the start's [1], either way, from which on a wrong unit is likelier than
such a joint: less than degrees in the place of radians make, 57."""
NEAR = 5.0
"""The same [1] within which another unit explains it."""


@dataclass(frozen=True, slots=True)
class Heads:
    """Names and units of force and motion of a joint: force or torque, displacement or angle."""

    force: str
    motion: str
    forces: Sizes
    motions: Sizes

    @property
    def columns(self) -> Mapping[str, Sizes]:
        return {
            self.motion: self.motions,
            self.force: self.forces,
            "time": sizes("s", "ms"),
            "frequency": sizes("Hz", "kHz"),
            "damping": sizes("1"),
            RUN: sizes("1"),
        }

    @property
    def unit(self) -> tuple[str, str]:
        """SI units of force and motion."""
        return next(iter(self.forces)), next(iter(self.motions))

    def check_level(self, path: Path, ratio: float, units: Mapping[str, str], start: ParameterFile) -> None:
        """Refuse a measurement whose stiffness is `ratio` times the start's, if that is FAR off.

        units : {column: unit in the heading}
        """
        if 1.0 / FAR < ratio < FAR:
            return
        raise Refusal(
            f"{path}: the stiffness is {ratio:.3g} times that of {start.name}, "
            f"allowed are {1.0 / FAR:g} to {FAR:g}: "
            f"{self.likely_unit(ratio, units)}; if both are right, start from a joint of its size",
            "params",
        )

    def likely_unit(self, ratio: float, units: Mapping[str, str]) -> str:
        """Which unit of a column, or of either where both do as well, would bring a stiffness that is `ratio`
        times what it should be to its place."""
        found = []
        for column, power, own in ((self.motion, -1.0, self.motions), (self.force, 1.0, self.forces)):
            said, text = measured_in(units[column], own), f"where the heading says {units[column]}"
            left = {unit: abs(np.log(ratio * (size / said) ** power)) for unit, size in own.items()}
            unit = min(left, key=left.__getitem__)
            found.append((float(left[unit]), f"the {column} is in {unit}, {text}"))
        least = min(found)[0]
        if not least < np.log(NEAR):
            return "check the units of both columns, no usual one explains it"
        return "likely " + ", or ".join(text for left, text in found if left < least + 1e-6)


def read(path: str | Path, heads: Heads) -> tuple[str, columns.Columns]:
    """One of "loops", "response", "backbone", "decay" and the columns of the file.

    loops    : motion, force
    response : motion (amplitude), force (amplitude), frequency
    backbone : motion (amplitude), frequency, damping
    decay    : motion, time

    Raises ValueError, one line, for anything else.
    """
    table = columns.read(path, heads.columns, LEAST, OTHERS)
    table.require(heads.motion, heads.columns)
    have = set(table.columns)
    if {"frequency", heads.force} <= have:
        return "response", table.positive((heads.motion, "frequency", heads.force), heads.columns)
    if {"frequency", "damping"} <= have:
        return "backbone", table.positive((heads.motion, "frequency", "damping"), heads.columns)
    if "frequency" not in have and heads.force in have:
        return "loops", table
    if "frequency" not in have and "time" in have:
        return "decay", table
    beside = (heads.force,), ("time",), ("frequency", heads.force), ("frequency", "damping")
    raise ValueError(
        f"{table.path}: has {', '.join(table.columns)} alone; expected {heads.motion} with "
        f"{', or with '.join(' and '.join(names) for names in beside)}"
    )


def runs(table: columns.Columns) -> list[tuple[str, dict[str, Array]]]:
    """The measurements of a file, told apart by the column `run`: how a message calls each, its columns."""
    if RUN not in table.columns:
        return [("", dict(table.columns))]
    number = table.columns[RUN]
    parts = []
    for each in dict.fromkeys(number.tolist()):
        rows = number == each
        parts.append((f"run {each:g}: ", {name: column[rows] for name, column in table.columns.items()}))
    return parts


@dataclass(frozen=True, slots=True)
class Measurement:
    """A file's measurement.

    kind : one of those of `heads.read`
    span : over which motions, in words
    units : {column: unit in the heading}
    """

    path: Path
    kind: str
    heads: Heads
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
        return f"{self.kind} up to {self.heads.motion} {self.amplitude:.4g} {self.heads.unit[1]}"


def measured(path: str | Path, columns: Heads) -> Measurement:
    """Read and check a file, see `heads.read`; ValueError, one line, beginning with the path."""
    kind, table = read(path, columns)
    parts = runs(table)
    data: Loops | Free | Response
    try:
        if kind == "loops":
            data = cut([(name, run[columns.motion], run[columns.force]) for name, run in parts])
        elif kind == "decay":
            data = Free(_joined([points(run["time"], run[columns.motion], name) for name, run in parts]))
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
