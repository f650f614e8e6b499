"""Samples of a robot's log, filtered.

Motion and torque pass one filter, a polynomial over WINDOW (Savitzky and Golay 1964), which gives the
derivatives too; kept are samples so far apart that their noise is independent, and marked are those where the
drive has turned on since its last reversal. A table of steady speeds is taken as it is.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.signal import savgol_coeffs, savgol_filter

from jointfmu.joints.harmonic_drive.drive import Drive

from ....fitting.least_squares import Array

Places: TypeAlias = NDArray[np.int_]
WINDOW, ORDER = 0.04, 4
"""Of the filter [s], and of its polynomial [1]."""
NODES = 9
"""Speeds [1] within a window by which friction is filtered; fewest samples of a window."""
TURNED = 5.0
"""Way of the motor since a reversal over `presliding` [1] after which friction has built up but for 1 %."""
ONE_SPEED = 1.2
"""Largest over smallest speed [1] below which a log has one speed only."""


@dataclass(frozen=True, slots=True)
class Samples:
    """Samples (n) of logs, SI; NaN where a log has no such column.

    dq, ddq  : speed and acceleration of the joint
    speeds   : (n, NODES) of the joint within the filter's window
    weights  : (n, NODES) [1] of the filter there: friction is filtered as the torque is
    torque   : of the motor
    gravity  : torque at the joint that holds the arm
    motor, sensed : angle of the motor, torque at the joint
    later    : of the last part of a log, which is held out
    dynamic  : of a log with a time
    built    : friction has built up
    """

    time: Array
    q: Array
    dq: Array
    ddq: Array
    speeds: Array
    weights: Array
    torque: Array
    gravity: Array
    temperature: Array
    motor: Array
    sensed: Array
    later: NDArray[np.bool_]
    dynamic: NDArray[np.bool_]
    built: NDArray[np.bool_]

    def part(self, rows: NDArray[np.bool_] | Places) -> "Samples":
        """The samples of some rows."""
        return Samples(*(getattr(self, field.name)[rows] for field in fields(self)))


def joined(parts: Sequence[Samples]) -> Samples:
    """The samples of several logs, one after the other."""
    return Samples(*(np.concatenate([getattr(p, f.name) for p in parts]) for f in fields(Samples)))


def steady(have: Mapping[str, Array], torque: Array) -> Samples:
    """Rows of steady speeds; every third one is held out."""
    none = np.full(torque.size, np.nan)
    return Samples(
        time=none,
        q=have.get("q", none),
        dq=have["dq"],
        ddq=np.zeros(torque.size),
        speeds=np.repeat(have["dq"][:, None], NODES, axis=1),
        weights=np.repeat(np.eye(1, NODES), torque.size, axis=0),
        torque=torque,
        gravity=have.get("gravity", none),
        temperature=have.get("temperature", none),
        motor=none,
        sensed=none,
        later=np.arange(torque.size) % 3 == 1,
        dynamic=np.zeros(torque.size, dtype=bool),
        built=have["dq"] != 0.0,
    )


def window(step: float) -> int:
    """Samples of the filter's window at a step [s]."""
    return max(2 * round(0.5 * WINDOW / step) + 1, NODES)


def smoothed(values: Array, step: float, derivative: int = 0) -> Array:
    """Samples (n) at even steps [s] through the filter, or their derivative [1/s^derivative]."""
    return np.asarray(savgol_filter(values, window(step), ORDER, derivative, step))


def moving(time: Array, step: float, have: Mapping[str, Array], drive: Drive) -> Samples:
    """Filtered samples (n) at even times [s], marked where friction has built up."""
    none = np.full(time.size, np.nan)

    def smooth(name: str) -> Array:
        return smoothed(have[name], step) if name in have else none

    of_q = "dq" not in have
    dq = smoothed(have["q"], step, 1) if of_q else smooth("dq")
    nodes, weights = _nodes(window(step))
    return Samples(
        time=time,
        q=smooth("q"),
        dq=dq,
        ddq=smoothed(have["q"], step, 2) if of_q else smoothed(have["dq"], step, 1),
        speeds=dq[np.clip(np.arange(time.size)[:, None] + nodes, 0, time.size - 1)],
        weights=np.repeat(weights[None, :], time.size, axis=0),
        torque=smooth("tau"),
        gravity=smooth("gravity"),
        temperature=have.get("temperature", none),
        motor=smooth("q_motor"),
        sensed=smooth("link_torque"),
        later=time > time[0] + 0.7 * (time[-1] - time[0]),
        dynamic=np.ones(time.size, dtype=bool),
        built=_built_up(dq, step, window(step), drive),
    )


def _nodes(width: int) -> tuple[Places, Array]:
    """Places (NODES) in the filter's window, in samples off its middle, and the filter's weights for what is
    straight between them.
    """
    half = width // 2
    nodes = np.round(np.linspace(-half, half, NODES)).astype(int)
    hats = [np.interp(np.arange(-half, half + 1), nodes, row) for row in np.eye(NODES)]
    return nodes, np.array(hats) @ savgol_coeffs(width, ORDER, use="dot")


def _built_up(dq: Array, step: float, width: int, drive: Drive) -> NDArray[np.bool_]:
    """Whether (n) the motor has turned on, by more than the filter and presliding blur."""
    sign = np.sign(dq)
    run = np.concatenate([[0], np.cumsum(np.diff(sign) != 0.0)])
    first = np.concatenate([[0], np.flatnonzero(np.diff(run)) + 1])
    last = np.concatenate([first[1:], [dq.size]])
    place = np.arange(dq.size)
    way = np.concatenate([[0.0], np.cumsum(np.abs(dq[1:]))]) * step * abs(drive.ratio)
    since, left = place - first[run], last[run] - 1 - place
    turned = way - way[first[run]] > TURNED * drive.presliding
    return np.asarray(turned & (since > width // 2) & (left > width // 2) & (sign != 0.0))
