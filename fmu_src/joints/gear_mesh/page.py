"""What the page's plot of the load ramp shows."""

from ...joint_parts.page import Panel

PANELS = {"GearMesh": (Panel("phi1", ("f",)), Panel("s_rel", ("K",)))}
