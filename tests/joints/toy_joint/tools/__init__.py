"""The toy joint, for the tools."""

from jointfmu_tools.common.joint_parts import ToolParts

TOOL_PARTS = ToolParts(__name__, ("export", "uncertainty"))
