"""The toy joint, for the tools."""

from jointfmu_tools.common.joint_parts import ToolParts

PARTS = ToolParts(__name__, ("export", "reduced"))
