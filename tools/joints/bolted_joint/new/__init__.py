"""A bolted joint from a drawing: two plates and their bolts."""

from ....drawing.faces import OPTIONS
from ....drawing.part import Drawing, Given, NewJoint, Option


def _plate(given: Given) -> NewJoint:
    from . import plate

    return plate.joint(given)


ATTACHED = {
    "faces": "the outer faces",
    "edge": "the edges at -x (side 1) and +x (side 2)",
    "heads": "the faces under heads and nuts",
}
"""What moves as one with the bodies that the joint connects."""

NEW = Drawing(
    text="a bolted joint of two plates",
    example="--plate 200x100 --bolts 4xM12 --at 160x60 --grip 40 --material steel --finish ground "
    "--preload 30e3",
    options=(
        Option(name="plate", text="length along x and width along y [mm]", metavar="LxW", required=True),
        Option(name="bolts", text="number and thread", metavar="NxMd", required=True),
        Option(
            name="at",
            text="distances of the outermost bolts along x and y, LxW, or the place X,Y of each bolt from "
            "the middle of the plate [mm]",
            metavar="PLACE",
            many=True,
        ),
        Option(name="grid", text="bolts along x and y, where the distances do not tell", metavar="NxM"),
        Option(name="circle", text="pitch circle of the bolts [mm]", metavar="D"),
        Option(
            name="grip",
            text="clamped length of both plates together, or of each [mm]",
            metavar="L",
            many=True,
            required=True,
        ),
        Option(name="tapped", text="the thread is in side 2, and the grip that of side 1", flag=True),
        Option(name="head", text="of the bolts (default: hexagon)", choices=("hexagon", "socket")),
        Option(name="hole", text="clearance hole [mm] (default: ISO 273, medium)", metavar="D"),
        Option(
            name="bearing",
            text="outer diameter of the bearing surface [mm] (default: of the head)",
            metavar="D",
        ),
        Option(name="preload", text="force of each bolt [N] (default: VDI 2230)", metavar="F"),
        Option(
            name="embedding",
            text="preload that each bolt loses by embedding [N] (default: VDI 2230, Table 5)",
            metavar="F",
        ),
        Option(
            name="property_class",
            text="of the bolts, for the default of the preload (default: 8.8)",
            choices=("8.8", "10.9", "12.9"),
        ),
        Option(
            name="field",
            text="pressure by the cones of the bolts, or computed by finite elements (default: cones)",
            choices=("cones", "computed"),
        ),
        Option(
            name="thickness",
            text="of each plate [mm] (default: half the grip)",
            metavar="T",
            many=True,
        ),
        Option(
            name="sides",
            text="elastic: the whole joint, with members and bolts; rigid: the interface alone (default: "
            "elastic where the finite elements are installed)",
            choices=("elastic", "rigid"),
        ),
        Option(
            name="attached",
            text="what moves with the bodies that the joint connects: outer faces, edges (side 1 at -x, "
            "side 2 at +x), or what lies under the heads (default: faces)",
            choices=tuple(ATTACHED),
        ),
        Option(name="law", text="of the interface (default: roughness)", choices=("roughness", "zhao2018")),
        *OPTIONS,
    ),
    run=_plate,
)
