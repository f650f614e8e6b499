"""Tool modules of the harmonic drive."""

from ...common.joint_parts import JointToolModules

TOOL_MODULES = JointToolModules(
    __name__,
    ("fit", "modelica", "new", "published", "report", "uncertainty"),
    checks="job",
    figures="job",
    laboratory="job",
    ringing="job",
    export="load",
    pressure="load",
)
"""Which module of this folder serves which tool."""
