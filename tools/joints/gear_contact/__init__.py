"""What the tools know of the gear contact."""

from ...joint_parts import ToolParts

PARTS = ToolParts(
    __name__, ("checks", "export", "figures", "laboratory", "modelica", "new", "pressure", "reduced")
)
