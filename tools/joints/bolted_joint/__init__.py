"""What the tools know of the bolted joint."""

from ...joint_parts import ToolParts

PARTS = ToolParts(
    __name__,
    ("export", "field", "fit", "laboratory", "modelica", "new", "reduced", "report", "ringing"),
    checks="job",
    figures="job",
    frequencies="field",
    pressure="field",
)
