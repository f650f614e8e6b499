"""The toy joint, for the tools."""

from jointfmu_tools.joint_parts import Parts

PARTS = Parts(__name__, ("export", "reduced"))
