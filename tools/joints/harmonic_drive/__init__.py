"""What the tools know of the harmonic drive."""

from ...joint_parts import ToolParts

PARTS = ToolParts(
    __name__,
    (
        *("catalogue", "fit", "interface", "laboratory", "modelica", "new"),
        *("published", "reduced", "report", "transmission"),
    ),
    checks="job",
    figures="job",
    ringing="job",
    export="load",
    pressure="load",
)
