"""Gear contact under load: curves for other solvers, flank pressure, slider range of the laboratory page."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from jointfmu.joints.gear_contact import KIND
from jointfmu.joints.gear_contact.spring import Contact, GearContactSpring

from ...export.exports import Exports, LoadCurve
from ...laboratory.part import LaboratoryModel
from ...pressure import FLANKS

if TYPE_CHECKING:
    from jointfmu.mechanics.curve import Curve

    from ...export.tables import LoadTable


def _contact(gear: Contact) -> "tuple[Curve, Sequence[str]]":
    return GearContactSpring.of(gear).curve, ()


def _load(gear: Contact, _: None, error: float) -> "LoadTable":
    from ...export.tables import load_table

    return load_table(GearContactSpring.of(gear).curve, gear.A_0, error)


EXPORTS = Exports(
    contact=_contact,
    curve=LoadCurve(
        meaning="normal load over approach of the flanks from first touch; without load while apart",
        columns=tuple(KIND.variables[name] for name in ("s_rel", "f", "K_N")),
        name="force",
        table=_load,
    ),
)


PRESSURE = FLANKS
LABORATORY = {"GearContact": LaboratoryModel(spans={"f": (0.0, 3e3)})}
"""{FMU: contents of its laboratory page that are not variables of the FMU}."""
