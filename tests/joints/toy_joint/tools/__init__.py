"""The toy joint, for the tools."""

from jointfmu_tools.common.joint_parts import JointToolModules

TOOL_MODULES = JointToolModules(__name__, ("export", "uncertainty"))
