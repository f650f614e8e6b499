"""Plates and bolts for an imported contact field: two plates of stated thickness."""

import argparse
from typing import TYPE_CHECKING

import numpy as np

from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array

from ....inputs.drawing.reading import parse_number, parse_numbers
from ....inputs.drawing.tables import read_threads
from ....inputs.fields.nodal_result import ContactPressureField
from ....joints.bolted_joint.field import PlaneLayout
from ...command import declare_argument
from . import check_bolt_stiffness

if TYPE_CHECKING:
    from ....fem.geometry import Assembly

BOLT_POSITION_TOLERANCE = 1e-6
"""Largest distance [m] of a bolt outside the bounding rectangle of the contact."""
MAX_NODE_DISTANCE_OVER_HOLE_DIAMETER = 0.9
"""Diameter over that of a hole [1], within which a node shows that the contact has no hole there."""
MIN_CONTACT_OVER_PLATE_AREA, MAX_CENTROID_OFFSET_OVER_PLATE_SIZE = 0.9, 0.01
"""Limits for a warning: contact area over the area of the plates [1], at least, and distance between the
centroids of contact and plates over the plate size [1], at most."""


def declare_body_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options that describe the plates and the bolts."""
    parser.add_argument(
        "--thickness",
        nargs=2,
        metavar=("T1", "T2"),
        help="thicknesses of both plates [mm]: write the complete joint (sides = elastic) with rectangular "
        "plates that enclose the contact (default: write the interface only)",
    )
    parser.add_argument(
        "--attached",
        choices=("faces", "edge", "heads"),
        help="for --thickness: surfaces that move rigidly with the connected bodies: outer faces, edges "
        "(side 1 at -x, side 2 at +x), or faces under heads and nuts (default: faces)",
    )
    text = (
        "position of each bolt along rows and across, in the coordinates of the contact result [mm], as in "
    )
    text += "-80,0 80,0 (default: positions of --params, relative to the centroid of the contact)"
    declare_argument(parser, "--bolts", str, text, "X,Y", nargs="+")
    declare_argument(
        parser,
        "--hole",
        str,
        "for --thickness: diameter of the clearance holes [mm] (default: from --params)",
        "D",
    )
    text = (
        "for --thickness: outer diameter of head or washer [mm] (default: from --params, else the hexagon "
        "head of the largest bolt that passes the hole)"
    )
    declare_argument(parser, "--head", str, text, "D")


def check_body_arguments(args: argparse.Namespace, parameter_file: ParameterFile) -> None:
    """Raise ValueError before the work starts if the options do not describe a complete joint."""
    if args.attached and not args.thickness:
        raise ValueError(f"--attached {args.attached} needs --thickness, the thickness of both plates")
    for name in ("hole", "head"):
        if getattr(args, name) and not args.thickness:
            raise ValueError(f"--{name} needs --thickness, the thickness of both plates")
    if args.thickness and not args.out:
        raise ValueError("--thickness needs --out, the file for the complete joint")
    if args.thickness:
        check_bolt_stiffness("--thickness", parameter_file)


def find_bolt_positions(
    args: argparse.Namespace, parameter_file: ParameterFile, contact_field: ContactPressureField
) -> Array | None:
    """Positions (b, 2) [m] of the b bolts in the plane of the contact; None if they are not known.

    Without `--bolts` the positions are those of the parameter file, relative to the centroid of the contact.
    If one of these positions is outside the contact, the file describes another one, and the result is None.

    Raises ValueError if `--bolts` has too few or too many positions, or one outside the contact.
    """
    low = np.min(contact_field.node_positions, axis=0) - BOLT_POSITION_TOLERANCE
    high = np.max(contact_field.node_positions, axis=0) + BOLT_POSITION_TOLERANCE
    if not args.bolts:
        positions = (
            PlaneLayout.from_joint_parameters(parameter_file.values).bolt_positions
            + contact_field.contact_centroid
        )
        inside = np.all((positions > low) & (positions < high))
        return positions if len(positions) == parameter_file.values.n_bolts and inside else None
    stated = np.array(
        [
            parse_numbers(
                "bolts", text, "mm", "m", number_separator=",", expected_number_count=2, lower_bound=None
            )
            for text in args.bolts
        ]
    )
    if len(stated) != parameter_file.values.n_bolts:
        raise ValueError(
            f"--bolts has {len(stated)} positions, expected {parameter_file.values.n_bolts:g}: n_bolts of "
            "--params"
        )
    for i, place in enumerate(stated):
        if not np.all((place > low) & (place < high)):
            x, y = 1e3 * place
            (x1, y1), (x2, y2) = 1e3 * low, 1e3 * high
            raise ValueError(
                f"--bolts: bolt {i + 1} at ({x:g}, {y:g}) mm is outside the contact, which reaches from "
                f"({x1:.4g}, {y1:.4g}) to ({x2:.4g}, {y2:.4g}) mm"
            )
    return stated


def build_assembly(
    args: argparse.Namespace,
    parameter_file: ParameterFile,
    contact_field: ContactPressureField,
    bolt_positions: Array | None,
) -> tuple["Assembly", list[str]]:
    """Build two plates with bolts whose contact area is the area of a pressure field.

    Returns the assembly and notes about its shape.

    bolt_positions : (b, 2) [m] of the b bolts in the plane of the pressure field

    Raises ValueError if positions or sizes of the bolts are missing, if heads overlap or extend beyond the
    plates, or if the plates are too thin.
    """
    from ....fem.geometry import Assembly, BoltList, Plate, check_thickness

    if bolt_positions is None:
        raise ValueError("--thickness needs the positions of the bolts; state --bolts X,Y for each")
    hole, head = _find_hole_and_head_diameters(args, parameter_file)
    thick = [parse_number("thickness", text, "mm", "m") for text in args.thickness]
    low, high = np.min(contact_field.node_positions, axis=0), np.max(contact_field.node_positions, axis=0)
    (length, width), area = high - low, float(np.sum(contact_field.nodal_area))
    hole_area = _count_holes(contact_field, bolt_positions, hole) * 0.25 * np.pi * hole**2
    # a node in the middle of its area lies half an area's width inside the edge: enlarge to the true area
    missing_area = area + hole_area - length * width
    half = 0.5 * (length + width)
    extension = np.sqrt(max(half**2 + missing_area, 0.0)) - half
    extension = float(np.clip(extension, 0.0, np.sqrt(contact_field.nodal_area.max())))
    sides = [
        Plate(
            length=float(length + extension),
            width=float(width + extension),
            thickness=thick[i],
            E=parameter_file.values_by_name[f"side{i + 1}.E"],
            nu=parameter_file.values_by_name[f"side{i + 1}.nu"],
            density=1.0,  # not used: the analysis is static
        )
        for i in range(2)
    ]
    places = bolt_positions - 0.5 * (low + high)
    bolts = BoltList(
        x=tuple(places[:, 0].tolist()), y=tuple(places[:, 1].tolist()), hole_diameter=hole, head_diameter=head
    )
    plates = Assembly(parameter_file.name, sides[0], sides[1], bolts)
    check_thickness(plates)
    share = area / (sides[0].length * sides[0].width - hole_area)
    notes = [
        f"the plates are the rectangle around the contact, {1e3 * sides[0].length:.4g} x "
        f"{1e3 * sides[0].width:.4g} mm, of which the contact covers {share:.0%}; heads {1e3 * head:.4g} mm "
        f"over holes of {1e3 * hole:.4g} mm"
    ]
    centroid = -0.25 * np.pi * hole**2 * places.sum(axis=0) / plates.contact_area
    offset = np.hypot(*(contact_field.contact_centroid - 0.5 * (low + high) - centroid)) / max(length, width)
    if share < MIN_CONTACT_OVER_PLATE_AREA or offset > MAX_CENTROID_OFFSET_OVER_PLATE_SIZE:
        notes.append(
            f"the contact covers {share:.0%} of the rectangle around it, and its centroid is {offset:.1%} of "
            "the plate size off the middle: if the plates are not rectangular, their stiffness is wrong"
        )
    return plates, notes


def _count_holes(contact_field: ContactPressureField, bolt_positions: Array, hole_diameter: float) -> int:
    """Number of bolts around which the contact has a hole: no node lies well inside it.

    bolt_positions : (b, 2) [m]
    """
    distance = np.linalg.norm(contact_field.node_positions[:, None] - bolt_positions, axis=2)
    radius = 0.5 * MAX_NODE_DISTANCE_OVER_HOLE_DIAMETER * hole_diameter
    return int(np.sum(np.min(distance, axis=0) > radius))


def _find_hole_and_head_diameters(
    args: argparse.Namespace, parameter_file: ParameterFile
) -> tuple[float, float]:
    """Diameters [m] of clearance hole and head. Raises ValueError if one of them is not known."""
    layout = PlaneLayout.from_joint_parameters(parameter_file.values)
    hole = parse_number("hole", args.hole, "mm", "m") if args.hole else layout.hole_diameter
    if not hole > 0.0:
        raise ValueError("--thickness needs the diameter of the clearance holes; state --hole D [mm]")
    if args.head:
        return hole, parse_number("head", args.head, "mm", "m")
    fitting = [thread for thread in read_threads().values() if thread.nominal_diameter < hole]
    if layout.head_diameter <= 0.0 and not fitting:
        raise ValueError(
            f"no bolt of jointfmu new bolts fits a hole of {1e3 * hole:g} mm; state --head D, the diameter "
            "of head or washer [mm]"
        )
    return hole, layout.head_diameter or max(
        fitting, key=lambda thread: thread.nominal_diameter
    ).hexagon_bearing_diameter
