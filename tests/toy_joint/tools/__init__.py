"""The toy joint, for the tools."""

from jointfmu_tools.parts import Parts

PARTS = Parts(__name__, ("export", "reduced"))
