"""What the page's plot of the load ramp shows."""

from ...joint_parts.page import RampPanel

PANELS = {"GearMesh": (RampPanel("phi1", ("f",)), RampPanel("s_rel", ("K",)))}
