"""A measured torque-angle curve as the table of the law `table`: its mid-line itself, nothing fitted."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from jointfmu.joints.harmonic_drive.drive import Drive
from jointfmu.joints.harmonic_drive.given import TableDrive
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import build, flat_fields

from ....fitting import loop
from ....fitting.least_squares import Array, Solution
from ....fitting.outcome import FitResult, fitted
from . import drive as own
from . import torque_angle

MOST, FEWEST = 24, 4
"""Points of a table [1]: fewer where the curve would not rise from one to the next for its noise."""
CROWDING = 1.5
"""Power by which the points crowd towards zero torque [1], where the stiffness changes most."""
_NOTHING = Solution((), {}, np.zeros(0), 1.0, np.zeros((0, 0)), np.zeros((0, 0)), (), None)
"""No unknowns."""


def fit(path: str | Path, start: ParameterFile | None = None, rated_torque: float | None = None) -> FitResult:
    """The table of a file with the columns torque and angle, as `torque_angle.fit` reads it.

    Both directions of the torque are folded upon each other, the law is odd.

    Raises ValueError as `torque_angle.fit`, and for a curve that does not pass zero torque or does not rise.
    """
    record = torque_angle.read(path, start, rated_torque)
    line, begun = record.line, record.start
    try:
        torque, angle, shift = points(line)
    except ValueError as error:
        raise ValueError(f"{record.path}: {error}") from None
    shared = [name for name, _ in flat_fields(Drive) if name in begun.flat]
    values = {name: begun.flat[name] for name in shared}
    values |= {"table.torque": tuple(torque.tolist()), "table.angle": tuple(angle.tolist())}
    origins = {name: text for name, text in begun.origins.items() if name in shared}
    sources = {name: text for name, text in begun.sources.items() if name in shared}
    file = ParameterFile(begun.joint, record.path.name, build(TableDrive, values), origins, sources)
    columns = {name: values[name] for name in ("table.torque", "table.angle")}
    file = fitted(file, columns, "calibration", record.path.name, torque_angle.span(line))
    file = replace(file, name=record.path.name)
    rest = line.angle - shift - own.windup(file.values, line.torque)
    noise = float(np.sqrt(np.average(line.count * rest**2)))
    return torque_angle.outcome(record, file, _NOTHING, shift, noise)


def points(line: loop.Backbone) -> tuple[Array, Array, float]:
    """Torques and angles (n) of a table, and the angle at zero torque that is taken off.

    Raises ValueError if the mid-line does not pass zero torque or does not rise.
    """
    low, high = line.torque[0], line.torque[-1]
    if low * high > 0.0 and min(abs(low), abs(high)) > 0.05 * (high - low):
        raise ValueError(f"the torque goes from {low:.4g} to {high:.4g} N.m; a table needs it to pass zero")
    both = np.linspace(0.0, max(min(-low, high), 0.0), 41)
    shift = float(np.mean([np.interp(sign * both, line.torque, line.angle) for sign in (-1.0, 1.0)]))
    size, angle = np.abs(line.torque), np.sign(line.torque) * (line.angle - shift)
    for count in range(MOST, FEWEST - 1, -1):
        edges = size.max() * np.linspace(0.0, 1.0, count + 1) ** CROWDING
        place = np.clip(np.searchsorted(edges, size, side="left") - 1, 0, count - 1)
        weight = np.bincount(place, line.count, count)
        some = weight > 0.0
        means = [np.bincount(place, line.count * x, count)[some] / weight[some] for x in (size, angle)]
        if all(x[0] > 0.0 and np.all(np.diff(x) > 0.0) for x in means):
            return means[0], means[1], shift
    raise ValueError(f"the mid-line does not rise from one of {FEWEST} points to the next")
