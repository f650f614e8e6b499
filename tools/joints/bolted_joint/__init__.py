"""Tool modules of the bolted joint."""

from ...joint_parts import ToolParts

PARTS = ToolParts(
    __name__,
    ("export", "field", "fit", "modelica", "new", "published", "report", "uncertainty"),
    checks="job",
    figures="job",
    laboratory="job",
    ringing="job",
    frequencies="field",
    pressure="field",
)
