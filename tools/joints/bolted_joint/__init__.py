"""Tool modules of the bolted joint."""

from ...common.joint_parts import ToolParts

PARTS = ToolParts(
    __name__,
    ("export", "fit", "modelica", "new", "published", "reduced", "report"),
    checks="job",
    figures="job",
    laboratory="job",
    ringing="job",
    pressure="field",
)
