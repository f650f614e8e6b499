"""Tool modules of the gear contact."""

from ...common.joint_parts import ToolParts

PARTS = ToolParts(
    __name__,
    ("modelica", "new", "published"),
    checks="ramp",
    figures="ramp",
    reduced="ramp",
    export="load",
    laboratory="load",
    pressure="load",
)
