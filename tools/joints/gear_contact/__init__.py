"""What the tools know of the gear contact."""

from ...joint_parts import Parts

PARTS = Parts(
    __name__, ("checks", "export", "figures", "laboratory", "modelica", "new", "pressing", "reduced")
)
