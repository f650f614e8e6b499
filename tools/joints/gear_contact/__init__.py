"""What the tools know of the gear contact."""

from ...joint_parts import ToolParts

PARTS = ToolParts(
    __name__,
    ("laboratory", "modelica", "new", "reduced"),
    checks="job",
    figures="job",
    export="load",
    pressure="load",
)
