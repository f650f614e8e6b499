"""Friction of the drives in the catalogue: published, or scaled from drives with published friction.

No-load torques at the wave generator, for size D and ratio R:

    starting torque = a (D/20)^p 100/R,    running torque at 2000 rev/min and R = 100 = b (D/20)^3

a, p and b are fitted to the published torques by least squares over logarithms. Dry friction is proportional
to 1/R, like the radial deformation of the flexspline. This exponent is not fitted: only one drive with
published friction has a ratio below 100. The exponent 3 is the one of the friction moment of a rolling
bearing over its diameter (Palmgren). The difference of running and starting torque is viscous friction of the
grease, equal for all ratios. Both load-dependent losses are mean values of the published drives.

Intervals are Student's prediction intervals of the regressions: a single drive lies inside with probability
CONFIDENCE_LEVEL.
"""

import math
import re
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from jointfmu.joints.harmonic_drive.drive import Drive
from jointfmu.joints.harmonic_drive.friction import REFERENCE, limits, viscous
from jointfmu.quantity import Array

from ...catalogue import Item, Printed
from ...command_line.common import flag

LEVEL = 0.95
"""Probability of the intervals [1]."""
SIZE, RATIO = 20.0, 100.0
"""Reference size and reference ratio of the scaling laws [1]."""
POWER = 3.0
"""Exponent of the size in the scaling law of the running torque [1]."""


@dataclass(frozen=True, slots=True)
class PrintedFriction:
    """Published friction of a drive; None: not published.

    size, ratio       : [1]
    starting_torque   : [N.m] at the wave generator
    running_torque    : [N.m] at the wave generator, at 2000 rev/min
    load_loss         : friction over transmitted torque [1], if the motor drives
    load_loss_back    : friction over transmitted torque [1], if the output drives
    """

    size: float
    ratio: float
    starting: float
    running: float | None
    load_loss: float | None
    load_loss_back: float | None


class Scaled(NamedTuple):
    """Number from a scaling law, with the ends of its interval, all in the same unit."""

    value: float
    low: float
    high: float


@dataclass(frozen=True, slots=True)
class ScaledFriction:
    """Scaled friction of one drive.

    starting_torque : [N.m]
    viscous_torque  : [N.m] increase of the torque from start to 2000 rev/min
    load_loss, load_loss_back : [1]
    """

    starting: Scaled
    rise: Scaled
    load_loss: Scaled
    load_loss_back: Scaled


def scaled(size: float, ratio: float, drives: Collection[PrintedFriction]) -> ScaledFriction:
    """Scale the friction of published drives (four or more) to a drive of a size [1] and a ratio [1]."""
    starting_logs = np.array([(np.log(k.size / SIZE), np.log(k.starting * k.ratio / RATIO)) for k in drives])
    running_logs = [np.log(k.running / (k.size / SIZE) ** POWER) for k in drives if k.running is not None]
    design = np.stack([np.ones(len(starting_logs)), starting_logs[:, 0]], axis=1)
    reference = _torque(design, starting_logs[:, 1], np.array([1.0, np.log(size / SIZE)]), 1.0)
    ones = np.ones((len(running_logs), 1))
    running = _torque(ones, np.array(running_logs), np.ones(1), (size / SIZE) ** POWER)
    rise = (max(x - reference.value, 0.0) for x in running)
    starting = Scaled(*(RATIO / ratio * x for x in reference))
    losses = (_mean([getattr(k, name) for k in drives]) for name in ("load_loss", "load_loss_back"))
    return ScaledFriction(starting, Scaled(*rise), *losses)


def _torque(design: Array, logarithms: Array, at: Array, factor: float) -> Scaled:
    """Torque [N.m] from a linear regression of its logarithm, times a factor.

    design, logarithms : (n, k), (n) data of the regression
    design_row         : (k) of the drive
    """
    value, half = _predicted(design, logarithms, at)
    return Scaled(*(factor * float(np.exp(x)) for x in (value, value - half, value + half)))


def _mean(values: Sequence[float | None]) -> Scaled:
    """Mean of the published values, with an interval that is cut at zero."""
    published = np.array([value for value in values if value is not None])
    value, half = _predicted(np.ones((published.size, 1)), published, np.ones(1))
    return Scaled(value, max(value - half, 0.0), value + half)


def _predicted(design: Array, values: Array, at: Array) -> tuple[float, float]:
    """Predict a value by linear regression; value, and half width of its prediction interval.

    design, values : (n, k), (n) data of the regression
    design_row     : (k) of the predicted value
    """
    from scipy.special import stdtrit

    law = np.linalg.lstsq(design, values)[0]
    freedom = values.size - law.size
    residuals = values - design @ law
    deviation = np.sqrt(residuals @ residuals / freedom * (1.0 + at @ np.linalg.inv(design.T @ design) @ at))
    return float(at @ law), float(stdtrit(freedom, 0.5 + 0.5 * LEVEL) * deviation)


SPEED = 2000.0 * math.pi / 30.0
"""Speed [rad/s] of the wave generator at which catalogues state running torque and efficiency: 2000
rev/min."""
QUOTED = ("starting_torque", "running_torque", "back_driving_torque", "efficiency")
"""Columns of the catalogue that describe friction."""
_MET = 1e-5
"""Relative tolerance [1] of limits, so that a user can type a limit as an error message shows it."""
_DIGITS = 12
"""Decimals to which ends of intervals in SI units are rounded, so that round-off does not hide a zero."""
SET_BY: Mapping[str, tuple[str, str]] = {
    "starting_torque": ("friction_coulomb", "starting torque"),
    "running_torque": ("friction_viscous", "rise from starting to running torque"),
    "back_driving_torque": ("load_loss_back", "back-driving torque"),
    "efficiency": ("load_loss", "efficiency at rated torque"),
}
"""{column: (parameter that follows from it, text for the source of the parameter)}."""


def friction(printed: Mapping[str, Printed], stated: Collection[str] = ()) -> dict[str, Printed]:
    """Friction parameters of a drive from catalogue numbers: {parameter: number}.

    numbers      : ratio, rated_torque and FRICTION_COLUMNS, as far as they are known
    stated_names : of FRICTION_COLUMNS; contradictions of these numbers are errors

    friction_coulomb = starting torque
    friction_viscous = (running torque - starting torque)/QUOTED_SPEED
    load_loss        = 1/efficiency - 1 - running torque ratio/rated torque, at least 0
    load_loss_back   = 1 - ratio starting torque/back-driving torque, at least 0

    Without an efficiency, load_loss is load_loss_back. Without a starting torque the result is empty.

    Raises ValueError if a stated number would make a parameter negative.
    """
    if "starting_torque" not in printed:
        return {}
    start, running = printed["starting_torque"], printed.get("running_torque")
    ratio, rated = abs(printed["ratio"].value), printed.get("rated_torque")
    _check_met(printed, stated)
    values: dict[str, tuple[Callable[[float], float], str]] = {"starting_torque": (lambda torque: torque, "")}
    if running is not None:
        text = f" over {SPEED:.4g} rad/s"
        values["running_torque"] = (lambda torque: (torque - start.value) / SPEED, text)
    if (output := printed.get("efficiency")) is not None and rated is not None:
        idle = _idle(printed)
        values["efficiency"] = (
            lambda part: 1.0 / part - 1.0 - idle,
            f" {output.value:.4g}, less the running torque",
        )
    if (back := printed.get("back_driving_torque")) is not None:
        values["back_driving_torque"] = (
            lambda torque: 1.0 - ratio * start.value / torque,
            f" {back.value:.4g} N.m over ratio times starting torque",
        )
    parameters = {SET_BY[name][0]: _set(name, printed[name], *value) for name, value in values.items()}
    if "load_loss_back" in parameters and "load_loss" not in parameters:
        parameters["load_loss"] = parameters["load_loss_back"]
    return parameters


def _idle(printed: Mapping[str, Printed]) -> float:
    """Running torque over rated torque at the motor [1]; starting torque if no running torque is known."""
    torque = printed.get("running_torque", printed["starting_torque"]).value
    return torque * abs(printed["ratio"].value) / printed["rated_torque"].value


def _check_met(printed: Mapping[str, Printed], stated: Collection[str]) -> None:
    """Check stated numbers. Raises ValueError if one of them would make a friction parameter negative."""
    start, ratio = printed["starting_torque"].value, abs(printed["ratio"].value)
    ends = {
        "running_torque": (start, "the starting torque"),
        "back_driving_torque": (ratio * start, "ratio times starting torque"),
    }
    for name, (lowest, bound_text) in ends.items():
        if name in stated and printed[name].value < (1.0 - _MET) * lowest:
            value = f"{flag(name)} = {printed[name].value:g} N.m"
            raise ValueError(f"{value} is outside [{lowest:.6g}, inf) N.m: it is at least {bound_text}")
    if "efficiency" in stated and "rated_torque" in printed:
        highest, stated_value = 1.0 / (1.0 + _idle(printed)), printed["efficiency"].value
        if stated_value > (1.0 + _MET) * highest:
            raise ValueError(
                f"--efficiency = {stated_value:g} is outside (0, {highest:.6g}]: the torque without load "
                "takes the rest"
            )


def _set(column: str, number: Printed, value: Callable[[float], float], text: str) -> Printed:
    """Friction parameter from a catalogue number, with source and interval.

    convert : number -> parameter
    """
    kind = "derived" if text and number.kind != "estimate" else number.kind
    source, interval = f"{number.source}; {SET_BY[column][1]}{text}", None
    if number.interval is not None:
        low, high = sorted(max(round(value(end), _DIGITS), 0.0) for end in number.interval)
        interval = low, high
        source += f"; {interval_text(interval)}"
    return Printed(max(value(number.value), 0.0), kind, source, interval=interval)


def interval_text(interval: tuple[float, float]) -> str:
    """Text of an interval for the source of a parameter."""
    return f"{100.0 * LEVEL:g} % interval {interval[0]:.4g} to {interval[1]:.4g}"


def efficiency(drive: Drive, temperature: float = REFERENCE) -> float:
    """Efficiency [1] of a drive at rated torque and QUOTED_SPEED, without hysteresis.

    temperature : [K] of the lubricant
    """
    transmitted = drive.rated_torque / abs(drive.ratio)
    load = -math.copysign(drive.rated_torque, drive.ratio)
    friction_torque = limits(drive, SPEED, load, temperature)[0] + viscous(drive, SPEED, temperature)
    return float(transmitted / (transmitted + friction_torque))


def known(items: Iterable[Item]) -> dict[str, tuple[PrintedFriction, str]]:
    """Published friction {drive: (friction, maker)} of all drives with a published starting torque."""
    found = {}
    for item in items:
        printed = {name: number for name, number in item.numbers.items() if number.kind == "catalogue"}
        if "starting_torque" in printed:
            maker = printed["starting_torque"].source.partition(": ")[2].partition(",")[0]
            found[item.name] = _known(item.name, item.numbers["ratio"].value, printed), maker
    return found


def _known(name: str, ratio: float, printed: Mapping[str, Printed]) -> PrintedFriction:
    """Published friction of one drive; the losses follow from its numbers by `friction_parameters`."""
    losses = friction({"ratio": Printed(ratio, "catalogue", ""), **printed})
    running = printed.get("running_torque")
    return PrintedFriction(
        size(name),
        ratio,
        printed["starting_torque"].value,
        running.value if running else None,
        losses["load_loss"].value if "efficiency" in printed else None,
        losses["load_loss_back"].value if "back_driving_torque" in printed else None,
    )


def size(name: str) -> float:
    """Size [1] in the name SERIES-SIZE-RATIO of a drive; a letter after the size, as in 14A, is ignored."""
    match = re.search(r"-(\d+)[A-Z]?-\d+$", name)
    assert match, name
    return float(match[1])


def with_friction(item: Item, drives: Mapping[str, tuple[PrintedFriction, str]]) -> Item:
    """Add estimates of the friction numbers that are not published for a drive.

    published_drives : result of `collect_published`

    Without a rated torque there is no estimate of the efficiency.
    """
    numbers, ratio = dict(item.numbers), item.numbers["ratio"].value
    law = scaled(size(item.name), ratio, [each for each, _ in drives.values()])
    makers: dict[str, list[str]] = {}
    for name, (_, maker) in drives.items():
        makers.setdefault(maker, []).append(name)
    text = " and ".join(f"{maker} ({', '.join(names)})" for maker, names in makers.items())
    text += ", scaled by size and ratio"

    def estimate(column: str, value: float, *ends: float) -> None:
        """Add the estimate of a column, unless the drive has this column."""
        interval = min(ends), max(ends)
        numbers.setdefault(column, Printed(value, "estimate", text, interval=interval))

    estimate("starting_torque", *law.starting)
    start = numbers["starting_torque"].value
    estimate("running_torque", *(start + x for x in law.rise))
    estimate("back_driving_torque", *(ratio * start / (1.0 - x) for x in law.load_loss_back))
    if rated := numbers.get("rated_torque"):
        idle = 1.0 + numbers["running_torque"].value * ratio / rated.value
        estimate("efficiency", *(1.0 / (idle + x) for x in law.load_loss))
    return Item(item.name, numbers)
