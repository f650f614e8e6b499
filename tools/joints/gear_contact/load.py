"""Gear contact under load: curves for other solvers, flank pressure, slider range of the laboratory page."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from jointfmu.joints.gear_contact import KIND
from jointfmu.joints.gear_contact.spring import ContactParameters, GearContactSpring

from ...common.pressure import FLANK_PRESSURE_MODEL
from ...exchange.export.exports import JointExports, LoadCurveExport
from ...pages.laboratory.joint_additions import LaboratoryModel

if TYPE_CHECKING:
    from jointfmu.mechanics.curve import Curve

    from ...exchange.export.tables import LoadTable


def _contact_curve(contact_parameters: ContactParameters) -> "tuple[Curve, Sequence[str]]":
    """Contact law of the flanks: pressure [Pa] as a function of the approach [m]."""
    return GearContactSpring.tabulate(contact_parameters).curve, ()


def _load_table(
    contact_parameters: ContactParameters, _working_point: None, max_table_error: float
) -> "LoadTable":
    """Table of the normal force [N] as a function of the approach [m], for other solvers."""
    from ...exchange.export.tables import tabulate_load

    return tabulate_load(
        GearContactSpring.tabulate(contact_parameters).curve, contact_parameters.A_0, max_table_error
    )


EXPORTS = JointExports(
    contact=_contact_curve,
    curve=LoadCurveExport(
        curve_meaning="normal load over approach of the flanks from first touch; without load while apart",
        curve_variables=tuple(KIND.variables[name] for name in ("s_rel", "f", "K_N")),
        table_name="force",
        compute_table=_load_table,
    ),
)
"""Exports that the gear contact offers."""


NOMINAL_PRESSURE = FLANK_PRESSURE_MODEL
"""Nominal contact pressure of the flanks over the normal force."""
LABORATORY_MODELS = {"GearContact": LaboratoryModel(slider_spans={"f": (0.0, 3e3)})}
"""{FMU: contents of its laboratory page that are not variables of the FMU}."""
