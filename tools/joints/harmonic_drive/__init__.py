"""What the tools know of the harmonic drive."""

from ...joint_parts import Parts

PARTS = Parts(
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
        "pressing",
        "reduced",
        "report",
        "ringing",
    ),
)
