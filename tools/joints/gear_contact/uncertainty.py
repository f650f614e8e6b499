"""Stiffness and approach of the gear contact over its force, for `jointfmu uncertainty`."""

from jointfmu.joints.gear_contact import KIND

from ...studies.uncertainty.curves import LoadCurves

UNCERTAINTY_CURVES = LoadCurves(
    fmu_name="GearContact",
    ramped_input=KIND.variables["f"],
    outputs=tuple(KIND.variables[name] for name in ("K_N", "s_rel")),
    default_ramp_end=lambda contact: 3e3,
    max_load=lambda contact: contact.max_pressure * contact.A_0,
)
"""Quantities of the gear contact along its load ramp."""
