"""`jointfmu new` for a bolted joint: two plates and their bolts, from a drawing."""

from ....common.options import Option
from ....inputs.drawing.faces import FACE_OPTIONS
from ....inputs.drawing.part import DrawingOptions, NewJoint, NewJointCommand


def _make_joint(drawing_options: DrawingOptions) -> NewJoint:
    """Make a bolted joint from the options of a drawing; imports the module that computes it when called."""
    from . import plate

    return plate.make_joint(drawing_options)


STANDARD_WASHER_OPTION = "ISO 7089"
"""Value of the option `washers` for the washers of this standard."""

ATTACHMENT_SURFACES = {
    "faces": "the outer faces",
    "edge": "the edges at -x (side 1) and +x (side 2)",
    "heads": "the faces under heads and nuts",
}
"""{name: surfaces of both plates that move rigidly with the connected bodies}."""

TIGHTENING_METHODS = ("torque-wrench", "angle", "yield", "impact")
"""Methods of tightening, keys of the table `tightening` in models/tables/bolts.toml."""

NEW_JOINT_COMMAND = NewJointCommand(
    joint_description="a bolted joint of two plates",
    example_options="--plate 200x100 --bolts 4xM12 --at 160x60 --grip 40 --material steel --finish ground "
    "--preload 30e3",
    command_options=(
        Option(
            "plate",
            "length along x and width along y of both plates [mm], as in 200x100",
            "LxW",
            separator="x",
            is_required=True,
        ),
        Option(
            "bolts",
            "number of bolts and thread, as in 4xM12; with a fine pitch in mm: 4xM12x1.25",
            "NxMd",
            separator="x",
            is_required=True,
        ),
        Option(
            "at",
            "bolt pattern [mm]: LxW, the distances between the outermost bolts along x and y, as in 160x60; "
            "or X,Y of each bolt from the middle of the plate, as in -80,0 80,0",
            "PLACE",
            is_list=True,
            separator="x",
        ),
        Option(
            "grid",
            "number of bolts along x and y, as in 3x2, if the bolts fit --at LxW in several ways",
            "NxM",
            separator="x",
        ),
        Option("circle", "bolt pattern, in place of --at: diameter of the pitch circle [mm]", "D"),
        Option(
            "grip",
            "thickness of both plates together, without washers, or of each plate [mm]",
            "L",
            is_list=True,
            is_required=True,
        ),
        Option(
            "tapped",
            "the bolts have no nuts: the thread is tapped in the plate of side 2; --grip is then the "
            "thickness of side 1",
            is_flag=True,
        ),
        Option("head", "shape of the bolt heads (default: hexagon)", choices=("hexagon", "socket")),
        Option("hole", "diameter of the clearance holes [mm] (default: medium series of ISO 273)", "D"),
        Option(
            "bearing",
            "outer diameter of the bearing surface under head and nut [mm] (default: that of the head)",
            "D",
        ),
        Option(
            "washers",
            "steel washers under heads and nuts: outer diameter and thickness [mm], as in 24x2.5; without a "
            f"value those of {STANDARD_WASHER_OPTION} (default: none)",
            "DxT",
            separator="x",
            lone_value=STANDARD_WASHER_OPTION,
        ),
        Option(
            "preload",
            "preload: force of each bolt at tightening [N], from which --embedding is subtracted (default: "
            "from --torque, else VDI 2230, Table A1)",
            "F",
        ),
        Option(
            "torque",
            "tightening torque of each bolt [N.m], in place of --preload; preload and range follow from VDI "
            "2230",
            "M",
        ),
        Option(
            "thread_friction",
            "coefficient of friction in the thread [1] (default: 0.12, with the range 0.08 to 0.16 of VDI "
            "2230)",
            "MU",
        ),
        Option(
            "head_friction",
            "with --torque: coefficient of friction under the head [1] (default: 0.12, with the range 0.08 "
            "to 0.16)",
            "MU",
        ),
        Option(
            "tightening",
            "method of tightening: gives the scatter of the preload, by VDI 2230, Table A8 (default: "
            "torque-wrench with --torque, else no scatter)",
            choices=TIGHTENING_METHODS,
        ),
        Option(
            "embedding",
            "preload that each bolt loses by embedding after tightening [N] (default: from VDI 2230, Table "
            "5)",
            "F",
        ),
        Option(
            "property_class",
            "property class of the bolts: gives the preload if you state none (default: 8.8). If you state "
            "the class, the command warns if tightening uses more than 90 % of the yield strength",
            choices=("8.8", "10.9", "12.9"),
        ),
        Option(
            "field",
            "contact pressure of the interface: from the deformation cones of VDI 2230, or computed by "
            "finite elements (default: cones)",
            choices=("cones", "computed"),
        ),
        Option(
            "thickness",
            "thickness of each plate [mm] (default: from --grip, half of it each)",
            "T",
            is_list=True,
        ),
        Option(
            "sides",
            "elastic: interface, plates and bolts (needs pip install 'jointfmu[fem]'); rigid: interface and "
            "bolts between rigid plates (default: elastic)",
            choices=("elastic", "rigid"),
        ),
        Option(
            "attached",
            "surfaces that move rigidly with the connected bodies: outer faces, edges (side 1 at -x, "
            "side 2 at +x), or faces under heads and nuts (default: faces)",
            choices=tuple(ATTACHMENT_SURFACES),
        ),
        Option(
            "law",
            "contact law of the interface: roughness, from the heights of the faces, or zhao2018, the "
            "fractal law of Zhao 2018 (default: roughness)",
            choices=("roughness", "zhao2018"),
        ),
        *FACE_OPTIONS,
    ),
    make_joint=_make_joint,
)
"""Drawing of a bolted joint: its options, and the function that makes the joint."""
