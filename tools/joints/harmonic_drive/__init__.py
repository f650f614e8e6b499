"""What the tools know of the harmonic drive."""

from ...joint_parts import ToolParts

PARTS = ToolParts(
    __name__,
    (
        "catalogue",
        "checks",
        "export",
        "figures",
        "fit",
        "interface",
        "laboratory",
        "modelica",
        "new",
        "pressure",
        "reduced",
        "report",
        "ringing",
        "transmission",
    ),
)
