"""Tool modules of the harmonic drive."""

from ...common.joint_parts import ToolParts

PARTS = ToolParts(
    __name__,
    ("fit", "modelica", "new", "published", "reduced", "report"),
    checks="job",
    figures="job",
    laboratory="job",
    ringing="job",
    export="load",
    pressure="load",
)
