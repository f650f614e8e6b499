"""`jointfmu new` for a bolted joint: two plates and their bolts, from a drawing."""

from ....common.options import Option
from ....inputs.drawing.faces import FACE_OPTIONS
from ....inputs.drawing.part import DrawingOptions, NewJoint, NewJointCommand


def _make_joint(options: DrawingOptions) -> NewJoint:
    """Make a bolted joint from the options of a drawing; loads finite elements when they are needed."""
    from . import plate

    return plate.make_joint(options)


STANDARD_WASHERS = "ISO 7089"
"""Value of the option `washers` for the washers of this standard."""

ATTACHMENTS = {
    "faces": "the outer faces",
    "edge": "the edges at -x (side 1) and +x (side 2)",
    "heads": "the faces under heads and nuts",
}
"""{name: surfaces of both plates that move rigidly with the connected bodies}."""

TIGHTENING_METHODS = ("torque-wrench", "angle", "yield", "impact")
"""Methods of tightening, keys of the table `tightening` in models/tables/bolts.toml."""

NEW_JOINT_COMMAND = NewJointCommand(
    description="a bolted joint of two plates",
    example="--plate 200x100 --bolts 4xM12 --at 160x60 --grip 40 --material steel --finish ground "
    "--preload 30e3",
    options=(
        Option("plate", "length along x and width along y [mm]", "LxW", separator="x", is_required=True),
        Option(
            "bolts",
            "number and thread, as in 4xM12; with a fine pitch in mm: 4xM12x1.25",
            "NxMd",
            separator="x",
            is_required=True,
        ),
        Option(
            "at",
            "distances of the outermost bolts along x and y, LxW, or the position X,Y of each bolt from "
            "the middle of the plate [mm]",
            "PLACE",
            is_list=True,
            separator="x",
        ),
        Option("grid", "number of bolts along x and y, if --at LxW leaves it open", "NxM", separator="x"),
        Option("circle", "diameter of the pitch circle of the bolts [mm]", "D"),
        Option(
            "grip",
            "clamped length of both plates together, or of each [mm]",
            "L",
            is_list=True,
            is_required=True,
        ),
        Option("tapped", "the thread is tapped in side 2; --grip is the thickness of side 1", is_flag=True),
        Option("head", "head of the bolts (default: hexagon)", choices=("hexagon", "socket")),
        Option("hole", "diameter of the clearance holes [mm] (default: ISO 273, medium)", "D"),
        Option("bearing", "outer diameter of the bearing surface [mm] (default: of the head)", "D"),
        Option(
            "washers",
            "steel washers under heads and nuts: outer diameter and thickness [mm]; without a value those of "
            f"{STANDARD_WASHERS} (default: none)",
            "DxT",
            separator="x",
            lone_value=STANDARD_WASHERS,
        ),
        Option("preload", "preload of each bolt [N] (default: VDI 2230, or from --torque)", "F"),
        Option(
            "torque",
            "tightening torque of each bolt [N.m], in place of --preload: VDI 2230 gives the preload and its "
            "range",
            "M",
        ),
        Option(
            "thread_friction",
            "coefficient of friction in the thread [1] (default: 0.12, 0.08 to 0.16, VDI 2230, Table A5)",
            "MU",
        ),
        Option(
            "head_friction",
            "coefficient of friction under the head [1], for --torque (default: 0.12, 0.08 to 0.16)",
            "MU",
        ),
        Option(
            "tightening",
            "method of tightening, which gives the scatter of the preload by VDI 2230, Table A8 (default: "
            "torque-wrench with --torque, else no scatter)",
            choices=TIGHTENING_METHODS,
        ),
        Option(
            "embedding", "preload that each bolt loses by embedding [N] (default: VDI 2230, Table 5)", "F"
        ),
        Option(
            "property_class",
            "property class of the bolts: for the default preload (default: 8.8), and for the share of "
            "the yield strength that tightening may use (0.9)",
            choices=("8.8", "10.9", "12.9"),
        ),
        Option(
            "field",
            "contact pressure from the cones of the bolts, or computed by finite elements (default: cones)",
            choices=("cones", "computed"),
        ),
        Option("thickness", "thickness of each plate [mm] (default: half the grip)", "T", is_list=True),
        Option(
            "sides",
            "elastic: the complete joint, with members and bolts, which needs the extra fem; rigid: the "
            "interface only (default: elastic)",
            choices=("elastic", "rigid"),
        ),
        Option(
            "attached",
            "surfaces that move rigidly with the connected bodies: outer faces, edges (side 1 at -x, "
            "side 2 at +x), or faces under heads and nuts (default: faces)",
            choices=tuple(ATTACHMENTS),
        ),
        Option("law", "law of the interface (default: roughness)", choices=("roughness", "zhao2018")),
        *FACE_OPTIONS,
    ),
    make_joint=_make_joint,
)
"""Drawing of a bolted joint: its options, and the function that makes the joint."""
