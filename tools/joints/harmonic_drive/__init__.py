"""Tool modules of the harmonic drive."""

from ...joint_parts import ToolParts

PARTS = ToolParts(
    __name__,
    ("catalogue", "fit", "modelica", "new", "published", "report", "uncertainty"),
    checks="job",
    figures="job",
    laboratory="job",
    ringing="job",
    export="load",
    pressure="load",
    interface="load",
    transmission="load",
)
