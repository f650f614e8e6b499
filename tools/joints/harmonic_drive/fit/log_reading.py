"""A robot's logs: columns, checks, filtered samples.

A log with a time is dynamic: motion and torque pass one filter, a polynomial over WINDOW (Savitzky and Golay
1964), which gives the derivatives too; kept are samples so far apart that their noise is independent, and
marked are those where the drive has turned on since its last reversal. A log without one is a table of steady
speeds, taken as it is.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.signal import savgol_coeffs, savgol_filter

from jointfmu.joints.harmonic_drive.drive import Drive
from jointfmu.quantity import Array
from jointfmu.quantity.units import KELVIN_AT_ZERO, Sizes, sizes

from .... import columns

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


COLUMNS: Mapping[str, Sizes] = {
    "time": sizes("s", "ms"),
    "q": sizes("rad", "deg"),
    "dq": sizes("rad/s", "deg/s", "rev/min"),
    "i": {"A": 1.0, "mA": 1e-3},
    "tau": sizes("N.m", "mN.m"),
    "gravity": sizes("N.m", "mN.m"),
    "q_motor": sizes("rad", "deg", "rev"),
    "link_torque": sizes("N.m", "mN.m"),
    "temperature": {"K": 1.0, "degC": 1.0, "°C": 1.0, "C": 1.0},
}
"""Angle and speed of the joint, current and torque of the motor, torque at the joint that holds the arm; the
motor's own angle, and the torque at the joint that a sensor measures."""
OTHERS: Mapping[str, Sequence[str]] = {
    "time": ("t", "timestamp", "zeit"),
    "q": ("position", "angle", "actual_q", "joint_position"),
    "dq": ("qd", "speed", "velocity", "actual_qd", "joint_speed", "joint_velocity"),
    "i": ("current", "actual_current", "motor_current"),
    "tau": ("torque", "motor_torque"),
    "gravity": ("tau_g", "gravity_torque"),
    "q_motor": ("motor_angle", "motor_position", "theta"),
    "link_torque": ("joint_torque", "torque_sensor"),
    "temperature": ("temp", "motor_temperature", "joint_temperature"),
}
LEAST = 6
"""Fewest rows of a log."""
MOST_SPEED = 2000.0
"""Speed of a wave generator [rad/s] that none has: catalogues allow up to 14 000 rev/min."""
MOST_CURRENT = 1e3
"""Current [A] that no joint's motor takes."""
MOST_TORQUE = 3.0
"""Torque of a motor over that of the drive at max_torque [1] that none has."""
STILL = 1e-3
"""Speed of the motor [rad/s] that is no motion."""
EVEN, GAP = 0.2, 10.0
"""Steps of time off their median [1] up to which a log is evenly sampled; step over it that is a gap."""
SAME = (0.5, 2.0)
"""dq over the derivative of q [1] between which they are of one motion."""


def named(words: Sequence[str]) -> dict[str, tuple[str, str | None]]:
    """{column: heading in the file and its unit, where it is stated} from `q=HEADING` or `q=HEADING [UNIT]`.

    Raises ValueError for other words and columns.
    """
    found = {}
    for word in words:
        name, _, text = word.partition("=")
        if name not in COLUMNS or not text.strip():
            raise ValueError(f"--columns {word!r}: expected NAME=HEADING with one of {', '.join(COLUMNS)}")
        found[name] = columns.head(text)
    return found


def read(
    path: Path, names: Mapping[str, tuple[str, str | None]], constant: float | None, drive: Drive
) -> Samples:
    """The samples of a file.

    constant : motor torque over current [N.m/A]
    drive    : whose ratio and torques tell what cannot be

    Raises ValueError, one line that begins with the path.
    """
    table = columns.read(path, COLUMNS, LEAST, OTHERS, names)
    have = dict(table.columns)
    torque = _torque(table, constant)
    if "temperature" in have and table.units["temperature"] != "K":
        have["temperature"] = have["temperature"] + KELVIN_AT_ZERO
    if "time" in have:
        return _of_motion(table, have, torque, drive)
    table.require("dq", COLUMNS)
    samples = steady(have, torque)
    _check(path, samples, drive)
    return samples


def _torque(table: columns.Columns, constant: float | None) -> Array:
    """Torque (n) of the motor [N.m]."""
    if "tau" in table.columns:
        return table.columns["tau"]
    if "i" not in table.columns:
        wanted = columns.heading({name: COLUMNS[name] for name in ("tau", "i")})
        raise ValueError(f"{table.path}: has no torque and no current of the motor; expected {wanted}")
    current = table.columns["i"]
    if np.max(np.abs(current)) > MOST_CURRENT:
        raise ValueError(
            f"{table.path}: a current of {np.max(np.abs(current)):.4g} A is outside "
            f"[-{MOST_CURRENT:g}, {MOST_CURRENT:g}] A; likely i is in mA"
        )
    if constant is None:
        raise ValueError(f"{table.path}: has a current alone; expected --torque-constant [N.m/A] beside it")
    return constant * current


def _of_motion(table: columns.Columns, have: Mapping[str, Array], torque: Array, drive: Drive) -> Samples:
    """Filtered samples as far apart as the filter is wide."""
    if "q" not in have and "dq" not in have:
        raise ValueError(f"{table.path}: has neither q nor dq; expected {columns.heading(COLUMNS)}")
    time, step = _clock(table)
    even = np.arange(time[0], time[-1] + 0.5 * step, step)
    have = {name: np.interp(even, time, x) for name, x in (*have.items(), ("tau", torque))}
    width = window(step)
    if even.size < 2 * width:
        raise ValueError(
            f"{table.path}: takes {time[-1] - time[0]:.4g} s, expected at least {2 * width * step:.3g} s"
        )
    samples = moving(even, step, have, drive)
    if "dq" in have and "q" in have:
        _same_motion(table, smoothed(have["q"], step, 1), samples.dq)
    _check(table.path, samples, drive)
    return samples.part(np.arange(width // 2, even.size - width // 2, width))


def _clock(table: columns.Columns) -> tuple[Array, float]:
    """Times (n) [s] and the even step between them."""
    time = table.columns["time"]
    steps = np.diff(time)
    if np.any(wrong := steps <= 0.0):
        first = int(np.argmax(wrong))
        raise ValueError(
            f"{table.path}: line {table.lines[first + 1]}: time = {time[first + 1]:.9g} s after "
            f"{time[first]:.9g} s runs back; expected rising times"
        )
    step = float(np.median(steps))
    if np.any(wrong := steps > GAP * step):
        first = int(np.argmax(wrong))
        raise ValueError(
            f"{table.path}: line {table.lines[first + 1]}: a gap of {steps[first]:.4g} s, allowed is "
            f"{GAP * step:.4g} s; cut the log there, several files are read at once"
        )
    if np.max(np.abs(steps - step)) < EVEN * step:
        step = float(time[-1] - time[0]) / (time.size - 1)
    return time, step


def _same_motion(table: columns.Columns, of_q: Array, dq: Array) -> None:
    """Raise ValueError if dq is not the derivative of q."""
    most = float(np.max(np.abs(of_q)))
    scale = float(dq @ of_q / (of_q @ of_q)) if most else 0.0
    if np.max(np.abs(dq)) and not SAME[0] <= scale <= SAME[1]:
        hint = (
            "; likely one of them is in degrees"
            if 40.0 < max(abs(scale), 1.0 / abs(scale or 1.0)) < 80.0
            else ""
        )
        raise ValueError(
            f"{table.path}: dq is {scale:.3g} times the derivative of q over time, expected 1{hint}"
        )


def _check(path: Path, samples: Samples, drive: Drive) -> None:
    """Raise ValueError for logs without motion, and for numbers that contradict their units."""
    ratio = abs(drive.ratio)
    fastest = ratio * float(np.max(np.abs(samples.dq)))
    if fastest > MOST_SPEED:
        raise ValueError(
            f"{path}: the joint's speed of {fastest / ratio:.4g} rad/s turns the motor with {fastest:.4g} "
            f"rad/s, outside [0, {MOST_SPEED:g}]; likely angles are in degrees"
        )
    if fastest < STILL:
        raise ValueError(
            f"{path}: has no motion; expected speeds of the joint above {STILL / ratio:.2g} rad/s"
        )
    most = MOST_TORQUE * float(drive.reach) / ratio
    largest = float(np.max(np.abs(samples.torque)))
    if largest > most:
        raise ValueError(
            f"{path}: a motor torque of {largest:.4g} N.m is outside [-{most:.4g}, {most:.4g}] N.m; expected "
            "that of the motor, not of the joint, of a drive as stated"
        )
