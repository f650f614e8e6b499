"""What the tools know of the bolted joint."""

from ...joint_parts import ToolParts

PARTS = ToolParts(
    __name__,
    (
        "checks",
        "export",
        "field",
        "figures",
        "fit",
        "frequencies",
        "laboratory",
        "modelica",
        "new",
        "pressure",
        "reduced",
        "report",
        "ringing",
    ),
)
