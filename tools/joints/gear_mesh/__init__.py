"""Tool modules of the gear mesh."""

from ...common.joint_parts import JointToolModules

TOOL_MODULES = JointToolModules(
    __name__,
    ("modelica", "new", "uncertainty"),
    checks="ramp",
    figures="ramp",
    export="load",
    pressure="load",
)
"""Which module of this folder serves which tool."""
