"""What the page's plot of the load ramp shows."""

from ...joint_parts.page import RampPanel

_STIFFNESS = RampPanel("tau", ("K_WTS", "K_TS"))
PANELS = {
    "HarmonicDriveSpring": (RampPanel("phi_rel", ("tau",)), _STIFFNESS),
    "HarmonicDriveCompliance": (RampPanel("tau", ("phi_rel",)), _STIFFNESS),
}
