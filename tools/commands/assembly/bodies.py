"""Bodies of an imported contact: plates of stated thickness, by the bolts' places and heads."""

import argparse
from typing import TYPE_CHECKING

import numpy as np

from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array

from ...command_line.common import argument
from ...drawing.reading import number, numbers
from ...drawing.tables import threads
from ...fields.clamped import clamping
from ...fields.nodal_result import ContactField
from . import check_bolts

if TYPE_CHECKING:
    from ...fem.geometry import Assembly

OUTSIDE = 1e-6
"""Distance [m] by which a bolt may lie outside the contact's rectangle."""
COVERED, MOVED = 0.9, 0.01
"""Part of its rectangle [1] that a contact has at least, and distance of both centroids over its size [1]
below which nothing is said."""


def arguments(step: argparse.ArgumentParser) -> None:
    """Declare what is stated of the bodies."""
    step.add_argument(
        "--thickness",
        nargs=2,
        metavar=("T1", "T2"),
        help="of both plates [mm]: write the whole joint (sides = elastic), its plates as large as the "
        "rectangle around the contact (default: the interface alone)",
    )
    step.add_argument(
        "--attached",
        choices=("faces", "edge", "heads"),
        help="what moves with the bodies that the joint connects (default: faces)",
    )
    text = "place of each bolt in the plane of the file [mm] (default: of --params, about the centroid)"
    argument(step, "--bolts", str, text, "X,Y", nargs="+")
    argument(step, "--hole", str, "clearance hole [mm] (default: of --params)", "D")
    text = "outer diameter of what presses [mm] (default: of --params, else the hexagon head of the "
    argument(step, "--head", str, text + "largest bolt that passes the hole)", "D")


def check(args: argparse.Namespace, file: ParameterFile) -> None:
    """Refuse what cannot be a whole joint before the work."""
    if args.attached and not args.thickness:
        raise ValueError(f"--attached {args.attached} without --thickness: expected that of both plates")
    for name in ("hole", "head"):
        if getattr(args, name) and not args.thickness:
            raise ValueError(f"--{name} without --thickness: expected that of both plates")
    if args.thickness and not args.out:
        raise ValueError("--thickness without --out: expected the file for the whole joint")
    if args.thickness:
        check_bolts("--thickness", file)


def places(args: argparse.Namespace, file: ParameterFile, field: ContactField) -> Array | None:
    """Places (b, 2) [m] of the bolts in the plane of the field; None if they are not known.

    Those of the parameter file lie about the centroid of its contact as in the field; if one of them is
    outside the field, it is another contact.

    Raises ValueError for stated ones that are too few, too many, or outside.
    """
    low, high = np.min(field.position, axis=0) - OUTSIDE, np.max(field.position, axis=0) + OUTSIDE
    if not args.bolts:
        found = clamping(file.joint).layout(file.values).bolts + field.centroid
        inside = np.all((found > low) & (found < high))
        return found if len(found) == file.values.n_bolts and inside else None
    stated = np.array([numbers("bolts", text, "mm", "m", by=",", count=2, least=None) for text in args.bolts])
    if len(stated) != file.values.n_bolts:
        raise ValueError(f"--bolts has {len(stated)} places, expected {file.values.n_bolts:g}: n_bolts")
    for i, place in enumerate(stated):
        if not np.all((place > low) & (place < high)):
            x, y = 1e3 * place
            (x1, y1), (x2, y2) = 1e3 * low, 1e3 * high
            raise ValueError(
                f"--bolts: bolt {i + 1} at ({x:g}, {y:g}) mm is outside the contact, ({x1:.4g}, {y1:.4g}) to "
                f"({x2:.4g}, {y2:.4g}) mm"
            )
    return stated


def assembly(
    args: argparse.Namespace, file: ParameterFile, field: ContactField, at: Array | None
) -> tuple["Assembly", list[str]]:
    """The plates of a field with bolts at (b, 2) [m], and what is to be known of them.

    Raises ValueError if places or sizes of the bolts are missing, heads overlap or leave the plates, or
    these are too thin.
    """
    from ...fem.geometry import Assembly, BoltList, Plate, check_thickness

    if at is None:
        raise ValueError("--thickness without the places of the bolts: expected --bolts X,Y for each")
    hole, head = _sizes(args, file)
    thick = [number("thickness", text, "mm", "m") for text in args.thickness]
    low, high = np.min(field.position, axis=0), np.max(field.position, axis=0)
    (length, width), area = high - low, float(np.sum(field.area))
    # nodes in the middle of their areas end half of one before the edge
    more = area + len(at) * 0.25 * np.pi * hole**2 - length * width
    half = 0.5 * (length + width)
    grown = float(np.clip(np.sqrt(max(half**2 + more, 0.0)) - half, 0.0, np.sqrt(field.area.max())))
    sides = [
        Plate(
            length=float(length + grown),
            width=float(width + grown),
            thickness=thick[i],
            E=file.flat[f"side{i + 1}.E"],
            nu=file.flat[f"side{i + 1}.nu"],
            density=1.0,  # nothing moves here
        )
        for i in range(2)
    ]
    places = at - 0.5 * (low + high)
    bolts = BoltList(
        x=tuple(places[:, 0].tolist()), y=tuple(places[:, 1].tolist()), hole_diameter=hole, head_diameter=head
    )
    made = Assembly(file.name, sides[0], sides[1], bolts)
    check_thickness(made)
    told = [
        f"the plates are the rectangle around the contact, {1e3 * sides[0].length:.4g} x "
        f"{1e3 * sides[0].width:.4g} mm, heads {1e3 * head:.4g} mm over holes of {1e3 * hole:.4g} mm"
    ]
    centroid = -0.25 * np.pi * hole**2 * places.sum(axis=0) / made.contact_area
    moved = np.hypot(*(field.centroid - 0.5 * (low + high) - centroid)) / max(length, width)
    if (part := area / made.contact_area) < COVERED or moved > MOVED:
        told.append(
            f"the contact has {part:.0%} of that rectangle, its centroid lies {moved:.1%} of its size "
            "beside: plates of another outline are not as stiff"
        )
    return made, told


def _sizes(args: argparse.Namespace, file: ParameterFile) -> tuple[float, float]:
    """Diameters [m] of hole and head."""
    own = clamping(file.joint).layout(file.values)
    hole = number("hole", args.hole, "mm", "m") if args.hole else own.hole
    if not hole > 0.0:
        raise ValueError("--thickness without the holes of the bolts: expected --hole")
    if args.head:
        return hole, number("head", args.head, "mm", "m")
    fitting = [thread for thread in threads().values() if thread.d < hole]
    if own.head <= 0.0 and not fitting:
        raise ValueError(f"no bolt of the tables passes a hole of {1e3 * hole:g} mm: expected --head")
    return hole, own.head or max(fitting, key=lambda thread: thread.d).hexagon
