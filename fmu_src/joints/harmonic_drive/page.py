"""What the page's plot of the load ramp shows."""

from ...joint_parts.page import Panel

_STIFFNESS = Panel("tau", ("K_WTS", "K_TS"))
PANELS = {
    "HarmonicDriveSpring": (Panel("phi_rel", ("tau",)), _STIFFNESS),
    "HarmonicDriveCompliance": (Panel("tau", ("phi_rel",)), _STIFFNESS),
}
