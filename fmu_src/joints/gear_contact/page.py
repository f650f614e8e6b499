"""What the page's plot of the load ramp shows."""

from ...joint_parts.page import RampPanel

PANELS = {"GearContact": (RampPanel("f", ("s_rel",)), RampPanel("f", ("K_N",)))}
