"""Friction of every drive of the catalogue: as it is printed, or scaled from drives that print it.

Without load, at the wave generator of a drive of size D and ratio R,

    starting torque = a (D/20)^p 100/R,    running torque at 2000 rev/min and R = 100 = b (D/20)^3

a, p and b by least squares in logarithms over what is printed. Dry friction goes with 1/R, as the radial
deformation of the flexspline does that every turn of the wave generator makes; of the printed drives one
alone has a ratio below 100, so that this power is not fitted. The cube is that of a rolling bearing's moment
over its diameter (Palmgren). What the running torque has beyond the starting torque is the grease's, alike
for all ratios. Both losses with load are the mean of those that are printed.

Intervals are to hold LEVEL of all single drives: Student's prediction intervals of the regressions.
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
SIZE, RATIO = 20.0, 100.0
"""To which the law refers [1]."""
POWER = 3.0
"""Of the running torque over the size [1]."""


@dataclass(frozen=True, slots=True)
class PrintedFriction:
    """What is printed of a drive: torques [N.m], losses over the torque transmitted [1]; None: it is not."""

    size: float
    ratio: float
    starting: float
    running: float | None
    load_loss: float | None
    load_loss_back: float | None


class Scaled(NamedTuple):
    """A scaled number and its interval, in the unit of the number."""

    value: float
    low: float
    high: float


@dataclass(frozen=True, slots=True)
class ScaledFriction:
    """Of one drive: starting torque and what a speed of 2000 rev/min adds [N.m], losses [1]."""

    starting: Scaled
    rise: Scaled
    load_loss: Scaled
    load_loss_back: Scaled


def scaled(size: float, ratio: float, drives: Collection[PrintedFriction]) -> ScaledFriction:
    """The friction of a drive of a size and ratio [1] from those that are known, four or more."""
    dry = np.array([(np.log(k.size / SIZE), np.log(k.starting * k.ratio / RATIO)) for k in drives])
    wet = [np.log(k.running / (k.size / SIZE) ** POWER) for k in drives if k.running is not None]
    line = np.stack([np.ones(len(dry)), dry[:, 0]], axis=1)
    usual = _torque(line, dry[:, 1], np.array([1.0, np.log(size / SIZE)]), 1.0)
    running = _torque(np.ones((len(wet), 1)), np.array(wet), np.ones(1), (size / SIZE) ** POWER)
    rise = (max(x - usual.value, 0.0) for x in running)
    part = RATIO / ratio
    starting = Scaled(*(part * x for x in usual))
    losses = (_mean([getattr(k, name) for k in drives]) for name in ("load_loss", "load_loss_back"))
    return ScaledFriction(starting, Scaled(*rise), *losses)


def _torque(design: Array, logarithms: Array, at: Array, factor: float) -> Scaled:
    """A torque [N.m] by a law of its logarithm, times a factor."""
    value, half = _predicted(design, logarithms, at)
    return Scaled(*(factor * float(np.exp(x)) for x in (value, value - half, value + half)))


def _mean(values: Sequence[float | None]) -> Scaled:
    """The mean of what is known; the interval has nothing below zero."""
    found = np.array([value for value in values if value is not None])
    value, half = _predicted(np.ones((found.size, 1)), found, np.ones(1))
    return Scaled(value, max(value - half, 0.0), value + half)


def _predicted(design: Array, values: Array, at: Array) -> tuple[float, float]:
    """A linear law (k) through values (n) at a place, and half of the interval of a single value there."""
    from scipy.special import stdtrit

    law = np.linalg.lstsq(design, values)[0]
    free = values.size - law.size
    rest = values - design @ law
    spread = np.sqrt(rest @ rest / free * (1.0 + at @ np.linalg.inv(design.T @ design) @ at))
    return float(at @ law), float(stdtrit(free, 0.5 + 0.5 * LEVEL) * spread)


SPEED = 2000.0 * math.pi / 30.0
"""[rad/s] of the wave generator, at which catalogues quote running torque and efficiency."""
QUOTED = ("starting_torque", "running_torque", "back_driving_torque", "efficiency")
"""Columns of the catalogue that this takes."""
_MET = 1e-5
"""Part [1] of a limit by which a stated number may miss it: it may be typed as the refusal prints it."""
_DIGITS = 12
"""Decimals of the ends of intervals in SI units: a bound of zero is one."""
SET_BY: Mapping[str, tuple[str, str]] = {
    "starting_torque": ("friction_coulomb", "starting torque"),
    "running_torque": ("friction_viscous", "rise from starting to running torque"),
    "back_driving_torque": ("load_loss_back", "back-driving torque"),
    "efficiency": ("load_loss", "efficiency at rated torque"),
}
"""{column: parameter that it sets, what the source of that says of it}."""


def friction(printed: Mapping[str, Printed], stated: Collection[str] = ()) -> dict[str, Printed]:
    """friction_coulomb, friction_viscous and both load losses of a drive; nothing without a starting torque.

    printed : ratio, QUOTED and rated_torque, as far as they are known
    stated  : those of QUOTED that must be met

    The starting torque is the dry friction at rest, and the rise to the running torque at SPEED is viscous.
    load_loss is what the efficiency at rated torque leaves, 1/efficiency - 1 - running torque ratio/rated
    torque, load_loss_back what the back-driving torque tells, 1 - ratio starting torque/back-driving torque;
    at least 0. Where one of the two is known it stands for both.

    Raises ValueError where a stated number leaves less than 0.
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
    found = {SET_BY[name][0]: _set(name, printed[name], *value) for name, value in values.items()}
    if "load_loss_back" in found and "load_loss" not in found:
        found["load_loss"] = found["load_loss_back"]
    return found


def _idle(printed: Mapping[str, Printed]) -> float:
    """Running torque, or where it is not known starting torque, over rated torque at the motor [1]."""
    torque = printed.get("running_torque", printed["starting_torque"]).value
    return torque * abs(printed["ratio"].value) / printed["rated_torque"].value


def _check_met(printed: Mapping[str, Printed], stated: Collection[str]) -> None:
    """Raise ValueError for a stated number beside which the rest leaves a friction below zero."""
    start, ratio = printed["starting_torque"].value, abs(printed["ratio"].value)
    ends = {
        "running_torque": (start, "the starting torque"),
        "back_driving_torque": (ratio * start, "ratio times starting torque"),
    }
    for name, (least, what) in ends.items():
        if name in stated and printed[name].value < (1.0 - _MET) * least:
            value = f"{flag(name)} = {printed[name].value:g} N.m"
            raise ValueError(f"{value} is outside [{least:.6g}, inf) N.m: it is at least {what}")
    if "efficiency" in stated and "rated_torque" in printed:
        most, own = 1.0 / (1.0 + _idle(printed)), printed["efficiency"].value
        if own > (1.0 + _MET) * most:
            raise ValueError(
                f"--efficiency = {own:g} is outside (0, {most:.6g}]: the torque without load takes the rest"
            )


def _set(column: str, number: Printed, value: Callable[[float], float], text: str) -> Printed:
    """The parameter that a column sets, with its interval where the column has one."""
    kind = "derived" if text and number.kind != "estimate" else number.kind
    source, interval = f"{number.source}; {SET_BY[column][1]}{text}", None
    if number.interval is not None:
        low, high = sorted(max(round(value(end), _DIGITS), 0.0) for end in number.interval)
        interval = low, high
        source += f"; {interval_text(interval)}"
    return Printed(max(value(number.value), 0.0), kind, source, interval=interval)


def interval_text(interval: tuple[float, float]) -> str:
    """An interval as the sources of parameters have it."""
    return f"{100.0 * LEVEL:g} % interval {interval[0]:.4g} to {interval[1]:.4g}"


def efficiency(drive: Drive, temperature: float = REFERENCE) -> float:
    """Efficiency [1] of a drive at rated torque and QUOTED_SPEED, without hysteresis.

    temperature : [K] of the lubricant
    """
    carried = drive.rated_torque / abs(drive.ratio)
    against = -math.copysign(drive.rated_torque, drive.ratio)
    braked = limits(drive, SPEED, against, temperature)[0] + viscous(drive, SPEED, temperature)
    return float(carried / (carried + braked))


def known(items: Iterable[Item]) -> dict[str, tuple[PrintedFriction, str]]:
    """{drive: what is printed of its friction, and by whom} of those whose starting torque is printed."""
    found = {}
    for item in items:
        printed = {name: number for name, number in item.numbers.items() if number.kind == "catalogue"}
        if "starting_torque" in printed:
            maker = printed["starting_torque"].source.partition(": ")[2].partition(",")[0]
            found[item.name] = _known(item.name, item.numbers["ratio"].value, printed), maker
    return found


def _known(name: str, ratio: float, printed: Mapping[str, Printed]) -> PrintedFriction:
    """The losses are those that `friction` makes of the columns."""
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
    """Size [1] of a drive SERIES-SIZE-RATIO: the number of 14A too."""
    match = re.search(r"-(\d+)[A-Z]?-\d+$", name)
    assert match, name
    return float(match[1])


def with_friction(item: Item, drives: Mapping[str, tuple[PrintedFriction, str]]) -> Item:
    """The drive with estimates of the friction that is not printed of it.

    drives : as `known` gives them

    The efficiency is left out where no rated torque is known.
    """
    own, ratio = dict(item.numbers), item.numbers["ratio"].value
    law = scaled(size(item.name), ratio, [each for each, _ in drives.values()])
    makers: dict[str, list[str]] = {}
    for name, (_, maker) in drives.items():
        makers.setdefault(maker, []).append(name)
    text = " and ".join(f"{maker} ({', '.join(names)})" for maker, names in makers.items())
    text += ", scaled by size and ratio"

    def estimate(column: str, value: float, *ends: float) -> None:
        """Unless it is printed."""
        interval = min(ends), max(ends)
        own.setdefault(column, Printed(value, "estimate", text, interval=interval))

    estimate("starting_torque", *law.starting)
    start = own["starting_torque"].value
    estimate("running_torque", *(start + x for x in law.rise))
    estimate("back_driving_torque", *(ratio * start / (1.0 - x) for x in law.load_loss_back))
    if rated := own.get("rated_torque"):
        idle = 1.0 + own["running_torque"].value * ratio / rated.value
        estimate("efficiency", *(1.0 / (idle + x) for x in law.load_loss))
    return Item(item.name, own)
