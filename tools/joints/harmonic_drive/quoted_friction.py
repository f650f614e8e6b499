"""Friction parameters from what catalogues quote of a drive: starting torque, and what is known beside it."""

import math
from collections.abc import Callable, Mapping

from jointfmu.joints.harmonic_drive.drive import Drive
from jointfmu.joints.harmonic_drive.friction import limits, viscous

from ...catalogue import Printed
from .scaling import LEVEL

SPEED = 2000.0 * math.pi / 30.0
"""[rad/s] of the wave generator, at which catalogues quote running torque and efficiency."""
QUOTED = ("starting_torque", "running_torque", "back_driving_torque", "efficiency")
"""Columns of the catalogue that this takes."""
_DIGITS = 12
"""Decimals of the ends of intervals in SI units: a bound of zero is one."""
SET_BY: Mapping[str, tuple[str, str]] = {
    "starting_torque": ("friction_coulomb", "starting torque"),
    "running_torque": ("friction_viscous", "rise from starting to running torque"),
    "back_driving_torque": ("load_loss_back", "back-driving torque"),
    "efficiency": ("load_loss", "efficiency at rated torque"),
}
"""{column: parameter that it sets, what the source of that says of it}."""


def friction(printed: Mapping[str, Printed]) -> dict[str, Printed]:
    """friction_coulomb, friction_viscous and both load losses of a drive; nothing without a starting torque.

    printed : ratio, QUOTED and rated_torque, as far as they are known

    The starting torque is the dry friction at rest, and the rise to the running torque at SPEED is viscous.
    load_loss is what the efficiency at rated torque leaves, 1/efficiency - 1 - running torque ratio/rated
    torque, load_loss_back what the back-driving torque tells, 1 - ratio starting torque/back-driving torque;
    at least 0. Where one of the two is known it stands for both.
    """
    if "starting_torque" not in printed:
        return {}
    start, running = printed["starting_torque"], printed.get("running_torque")
    ratio, rated = abs(printed["ratio"].value), printed.get("rated_torque")
    values: dict[str, tuple[Callable[[float], float], str]] = {"starting_torque": (lambda torque: torque, "")}
    if running is not None:
        text = f" over {SPEED:.4g} rad/s"
        values["running_torque"] = (lambda torque: (torque - start.value) / SPEED, text)
    if (output := printed.get("efficiency")) is not None and rated is not None:
        idle = (running or start).value * ratio / rated.value
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


def efficiency(drive: Drive) -> float:
    """Output power over motor power [1] of a drive at rated torque and SPEED, without hysteresis."""
    carried = drive.rated_torque / abs(drive.ratio)
    against = -math.copysign(drive.rated_torque, drive.ratio)
    braked = limits(drive, SPEED, against)[0] + viscous(drive, SPEED)
    return float(carried / (carried + braked))
