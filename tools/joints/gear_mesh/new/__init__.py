"""A gear mesh from a drawing: module, teeth, width, angles and faces of two external wheels."""

from ....drawing.faces import OPTIONS
from ....drawing.part import Drawing, Given, NewJoint, Option


def _wheels(given: Given) -> NewJoint:
    from . import wheels

    return wheels.mesh(given)


NEW = Drawing(
    text="the mesh of two external involute wheels without profile shift",
    example="--module 4 --teeth 29 45 --width 20 --torque 150 --material 'hardened steel' --Ra 0.4",
    options=(
        Option(name="module", text="normal module [mm]", metavar="M", required=True),
        Option(name="teeth", text="of wheel 1 and wheel 2", metavar="Z", many=True, required=True),
        Option(name="width", text="common face width [mm]", metavar="B", required=True),
        Option(name="torque", text="of wheel 1 at work [N.m]: decides the patch", metavar="T", required=True),
        Option(name="pressure_angle", text="normal pressure angle [deg] (default: 20)", metavar="A"),
        Option(name="helix_angle", text="at the reference circle [deg] (default: 0)", metavar="A"),
        Option(
            name="backlash",
            text="along the line of action [um] (default: the least of ISO/TR 10064-2)",
            metavar="J",
        ),
        *OPTIONS,
    ),
    run=_wheels,
)
