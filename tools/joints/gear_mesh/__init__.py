"""Tool modules of the gear mesh."""

from ...common.joint_parts import ToolParts

TOOL_PARTS = ToolParts(
    __name__,
    ("modelica", "new", "uncertainty"),
    checks="ramp",
    figures="ramp",
    export="load",
    pressure="load",
)
