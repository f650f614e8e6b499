"""What the page's plot of the load ramp shows."""

from ...native.page import Panel

PANELS = {"BoltedJoint": (Panel("preload", ("K_zz", "K_xx")), Panel("preload", ("C_zz", "C_xx")))}
