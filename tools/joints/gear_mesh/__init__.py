"""What the tools know of the gear mesh."""

from ...joint_parts import Parts

PARTS = Parts(__name__, ("checks", "export", "figures", "modelica", "new", "pressing", "reduced"))
