"""Tool modules of the harmonic drive."""

from ...common.joint_parts import ToolParts

TOOL_PARTS = ToolParts(
    __name__,
    ("fit", "modelica", "new", "published", "report", "uncertainty"),
    checks="job",
    figures="job",
    laboratory="job",
    ringing="job",
    export="load",
    pressure="load",
)
