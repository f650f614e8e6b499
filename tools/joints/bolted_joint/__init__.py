"""Tool modules of the bolted joint."""

from ...common.joint_parts import JointToolModules

TOOL_MODULES = JointToolModules(
    __name__,
    ("export", "fit", "modelica", "new", "published", "report", "uncertainty"),
    checks="job",
    figures="job",
    laboratory="job",
    ringing="job",
    pressure="field",
)
"""Which module of this folder serves which tool."""
