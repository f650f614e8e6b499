"""What the page's plot of the load ramp shows."""

from ...native.page import Panel

PANELS = {"GearMesh": (Panel("phi1", ("f",)), Panel("phi1", ("K",)), Panel("phi1", ("pairs",)))}
