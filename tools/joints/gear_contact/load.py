"""Gear contact under load: curves for other solvers, flank pressure, slider range of the laboratory page."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from jointfmu.joints.gear_contact import KIND
from jointfmu.joints.gear_contact.spring import ContactParameters, GearContactSpring

from ...common.pressure import FLANK_PRESSURE
from ...exchange.export.exports import Exports, LoadCurve
from ...pages.laboratory.part import LaboratoryModel

if TYPE_CHECKING:
    from jointfmu.mechanics.curve import Curve

    from ...exchange.export.tables import LoadTable


def _contact_curve(gear: ContactParameters) -> "tuple[Curve, Sequence[str]]":
    return GearContactSpring.tabulate(gear).curve, ()


def _load_table(gear: ContactParameters, _: None, max_error: float) -> "LoadTable":
    from ...exchange.export.tables import tabulate_load

    return tabulate_load(GearContactSpring.tabulate(gear).curve, gear.A_0, max_error)


EXPORTS = Exports(
    contact=_contact_curve,
    curve=LoadCurve(
        meaning="normal load over approach of the flanks from first touch; without load while apart",
        columns=tuple(KIND.variables[name] for name in ("s_rel", "f", "K_N")),
        name="force",
        compute_table=_load_table,
    ),
)


PRESSURE = FLANK_PRESSURE
LABORATORY = {"GearContact": LaboratoryModel(slider_spans={"f": (0.0, 3e3)})}
"""{FMU: contents of its laboratory page that are not variables of the FMU}."""
