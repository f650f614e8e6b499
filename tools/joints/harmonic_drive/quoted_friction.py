"""Friction parameters from what catalogues quote of a drive: starting torque, and what is known beside it."""

import math
from collections.abc import Mapping

from jointfmu.joints.harmonic_drive.drive import Drive
from jointfmu.joints.harmonic_drive.friction import limits, viscous

from ...catalogue import Printed

SPEED = 2000.0 * math.pi / 30.0
"""[rad/s] of the wave generator, at which catalogues quote running torque and efficiency."""
QUOTED = ("starting_torque", "running_torque", "back_driving_torque", "efficiency")
"""Columns of the catalogue that this takes."""
SET_BY: Mapping[str, tuple[str, str]] = {
    "starting_torque": ("friction_coulomb", "starting torque of "),
    "running_torque": ("friction_viscous", "rise from starting to running torque "),
    "back_driving_torque": ("load_loss_back", "back-driving torque "),
    "efficiency": ("load_loss", "efficiency at rated torque "),
}
"""{column: parameter that it sets, how the source of that begins then}."""


def friction(printed: Mapping[str, Printed]) -> dict[str, Printed]:
    """friction_coulomb, friction_viscous and both load losses of a drive; nothing without a starting torque.

    printed : QUOTED, ratio and rated_torque, as far as they are known

    The starting torque is the dry friction at rest, and the rise to the running torque at SPEED is viscous.
    load_loss is what the efficiency at rated torque leaves, 1/efficiency - 1 - running torque ratio/rated
    torque, load_loss_back what the back-driving torque tells, 1 - ratio starting torque/back-driving torque;
    at least 0. Where one of the two is known it stands for both.
    """
    if "starting_torque" not in printed:
        return {}
    start, running = printed["starting_torque"], printed.get("running_torque")
    values = {"starting_torque": (start.value, "")}
    if running is not None:
        rise = (running.value - start.value) / SPEED
        values["running_torque"] = (rise, f"over {SPEED:.4g} rad/s; ")
    ratio, rated = abs(printed["ratio"].value), printed["rated_torque"].value
    if (output := printed.get("efficiency")) is not None:
        loss = 1.0 / output.value - 1.0 - (running or start).value * ratio / rated
        values["efficiency"] = (loss, f"{output.value:g}, less the running torque; ")
    if (back := printed.get("back_driving_torque")) is not None:
        loss = 1.0 - ratio * start.value / back.value
        values["back_driving_torque"] = (loss, f"{back.value:g} N.m over ratio times starting torque; ")
    found = {}
    for column, (value, text) in values.items():
        (parameter, beginning), number = SET_BY[column], printed[column]
        kind = "derived" if text and number.kind != "estimate" else number.kind
        found[parameter] = Printed(max(value, 0.0), kind, beginning + text + number.source)
    if "load_loss_back" in found and "load_loss" not in found:
        found["load_loss"] = found["load_loss_back"]
    return found


def efficiency(drive: Drive) -> float:
    """Output power over motor power [1] of a drive at rated torque and SPEED, without hysteresis."""
    carried = drive.rated_torque / abs(drive.ratio)
    against = -math.copysign(drive.rated_torque, drive.ratio)
    braked = limits(drive, SPEED, against)[0] + viscous(drive, SPEED)
    return float(carried / (carried + braked))
