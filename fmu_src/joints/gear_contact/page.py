"""What the page's plot of the load ramp shows."""

from ...joint_parts.page import Panel

PANELS = {"GearContact": (Panel("f", ("s_rel",)), Panel("f", ("K_N",)))}
