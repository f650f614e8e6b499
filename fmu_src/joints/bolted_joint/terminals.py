"""Flanges of the bolted joint."""

from ...native.terminals import axis

TERMINALS = {"BoltedJoint": (axis("x", 60.0), axis("y", 0.0), axis("z", -60.0))}
