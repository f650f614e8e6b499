"""What the tools know of the gear mesh."""

from ...joint_parts import ToolParts

PARTS = ToolParts(__name__, ("checks", "export", "figures", "modelica", "new", "pressure", "reduced"))
