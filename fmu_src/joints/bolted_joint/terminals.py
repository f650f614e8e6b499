"""Flanges of the bolted joint."""

from ...joint_parts.terminals import axis, rotation

TERMINALS = {
    "BoltedJoint": (
        *(axis(name, y) for name, y in zip("xyz", (75.0, 45.0, 15.0), strict=True)),
        *(rotation(name, y) for name, y in zip("xyz", (-15.0, -45.0, -75.0), strict=True)),
    )
}
