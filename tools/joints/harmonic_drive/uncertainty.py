"""Stiffness and wind-up of the harmonic drive over its torque, for `jointfmu uncertainty`."""

from jointfmu.joints.harmonic_drive import KIND

from ...studies.uncertainty.curves import LoadCurves

UNCERTAINTY_CURVES = LoadCurves(
    fmu_name="HarmonicDriveCompliance",
    ramped_input=KIND.variables["tau"],
    outputs=tuple(KIND.variables[name] for name in ("K_WTS", "phi_rel")),
    default_ramp_end=lambda drive: float(drive.rated_torque),
    max_load=lambda drive: drive.max_table_torque,
    fixed_parameters={"hysteresis_loss": 0.0},
)
"""Quantities of the harmonic drive along its load ramp."""
