"""The toy joint, for the tools."""

from jointfmu_tools.joint_parts import ToolParts

PARTS = ToolParts(__name__, ("export", "uncertainty"))
