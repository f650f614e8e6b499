"""Tool modules of the gear mesh."""

from ...common.joint_parts import ToolParts

PARTS = ToolParts(
    __name__,
    ("modelica", "new"),
    checks="ramp",
    figures="ramp",
    reduced="ramp",
    export="load",
    pressure="load",
)
