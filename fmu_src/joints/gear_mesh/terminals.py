"""Flanges of the gear mesh."""

from ...joint_parts.terminals import shaft

TERMINALS = {"GearMesh": (shaft(1, "a", "wheel 1"), shaft(2, "b", "wheel 2"))}
