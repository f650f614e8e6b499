"""Tool modules of the gear contact."""

from ...common.joint_parts import JointToolModules

TOOL_MODULES = JointToolModules(
    __name__,
    ("modelica", "new", "published", "uncertainty"),
    checks="ramp",
    figures="ramp",
    export="load",
    laboratory="load",
    pressure="load",
)
"""Which module of this folder serves which tool."""
