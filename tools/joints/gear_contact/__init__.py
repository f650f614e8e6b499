"""What the tools know of the gear contact."""

from ...joint_parts import ToolParts

PARTS = ToolParts(
    __name__,
    ("modelica", "new", "published", "reduced"),
    checks="job",
    figures="job",
    export="load",
    laboratory="load",
    pressure="load",
)
