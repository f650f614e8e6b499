"""Tool modules of the toy joint."""

from jointfmu_tools.common.joint_parts import JointToolModules

TOOL_MODULES = JointToolModules(__name__, ("export", "uncertainty"))
