"""Parameters of a bolted joint from the drawing of its plates."""

from dataclasses import dataclass

import numpy as np

from jointfmu.joints.bolted_joint import KIND
from jointfmu.joints.bolted_joint.joint import BoltedJointSpring
from jointfmu.mechanics.footprint.plate import BoltedPlate
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array

from ....common.pressure import warn_overload
from ....inputs.drawing import faces, vdi2230
from ....inputs.drawing.part import DrawingOptions, NewJoint, ParameterSheet
from ....inputs.drawing.reading import parse_number, parse_numbers
from ....inputs.drawing.tables import Thread, property_class_strength, thread_source
from ..report import friction_results
from . import layout, plate_finite_elements
from .plate_finite_elements import BoltedPlates, compute_pressure_field

ZERO_MOTION = (0.0, 0.0, 0.0)
"""Zero displacement [m] or rotation [rad] along x, y, z."""
THICKNESS_TOLERANCE = 1e-6
"""Relative difference [1] allowed between the grip and the sum of the thicknesses."""
MAX_GRIP_RATIO = 50
"""Largest grip over the diameter of the thread [1]: a longer bolt is a tie rod."""
THREAD_DEPTH_RATIO = 1.0
"""Depth of a tapped thread over its diameter [1]: a usual value in steel."""


@dataclass(frozen=True, slots=True)
class ClampedBolt:
    """One bolt with the parts that it clamps, by VDI 2230.

    grip             : [m] clamped length between head and nut, or between head and tapped thread
    clamped_parts    : clamped parts, thickness and modulus
    hole_diameter    : [m]
    bearing_diameter : [m] of the surface under head or nut
    outer_diameter   : [m] D_A of the clamped parts
    cone_slope       : tan(phi) of the deformation cone [1]
    cone_diameter    : [m] of the deformation cone at the interface
    bolt_stiffness   : [N/m] 1/delta_S
    member_stiffness : [N/m] 1/delta_P
    """

    grip: float
    clamped_parts: tuple[vdi2230.ClampedPart, ...]
    hole_diameter: float
    bearing_diameter: float
    outer_diameter: float
    cone_slope: float
    cone_diameter: float
    bolt_stiffness: float
    member_stiffness: float


def make_joint(options: DrawingOptions) -> NewJoint:
    """Make the parameters of a bolted joint from the options of a drawing.

    Raises ValueError with a one-line message for options that are invalid or contradict each other.
    """
    length, width = parse_numbers("plate", options["plate"], "mm", "m", separator="x", count=2)
    count, thread = layout.parse_bolts(options["bolts"])
    positions = layout.bolt_positions(options, count)
    law = options["law"] or "roughness"
    sheet = ParameterSheet(KIND.name, law)
    heights = faces.add_faces(sheet, options)
    hole, hole_source = _hole_diameter(options, thread)
    moduli = (sheet.value_of("side1.E"), sheet.value_of("side2.E"))
    for name, value in (("field", "computed"), ("sides", "elastic"), ("attached", options["attached"])):
        if options["tapped"] and options["thickness"] is None and value and options[name] == value:
            raise ValueError(f"--{name} {value} beside --tapped: expected --thickness of both plates for it")
    bolt = clamp_bolt(options, thread, (length, width), positions, hole, moduli)
    plate = BoltedPlate(
        length=length,
        width=width,
        x=tuple(positions[:, 0].tolist()),
        y=tuple(positions[:, 1].tolist()),
        hole_diameter=hole,
        cone_diameter=bolt.cone_diameter,
    )
    _add_plate(sheet, plate, bolt, hole_source)
    _add_bolts(sheet, plate, bolt, thread)
    loss = _add_embedding_loss(sheet, options, bolt, heights)
    mass = (
        plate.area
        * bolt.clamped_parts[0].thickness
        * faces.read_materials(options)[0].numbers["density"].value
    )
    sheet.add("mass", mass, "estimate", "mass of the plate of side 1, assumed to vibrate")
    preload, warnings = _add_preload(sheet, options, thread)
    if not loss < preload:
        raise ValueError(
            f"embedding takes {loss:.4g} N of a preload of {preload:.4g} N: expected less than all; state "
            "--embedding or more --preload"
        )
    for choice in ("critical_area", "spot_stiffness"):
        default = {"critical_area": "continuity", "spot_stiffness": "hertz"}[choice]
        sheet.add(choice, default, "estimate", "nearest to the roughness of the surfaces, docs/validity.md")
    file = sheet.build_file(f"plate {options['plate']} with {options['bolts']}")
    density = tuple(material.numbers["density"].value for material in faces.read_materials(options))
    layers, depth = bolt.clamped_parts, 0.0
    if options["tapped"] and options["thickness"] is not None:
        layers = (*layers, vdi2230.ClampedPart(_plate_thicknesses(options)[1], moduli[1]))
        depth = THREAD_DEPTH_RATIO * thread.nominal_diameter
    plates = BoltedPlates(plate, layers, bolt.bearing_diameter, density, preload, preload - loss, depth)
    shape = None
    if options["field"] == "computed":
        file, shape = compute_pressure_field(file, plates)
    facts = _design_facts(file, bolt, heights, preload)
    alone = _interface_only_text(facts["interface_K_zz"][0] / count, bolt)
    if options["tapped"] and options["thickness"] is None:
        return NewJoint(
            file, facts, [*warnings, f"{alone}: for the complete joint state --thickness of both plates"]
        )
    attached, sides = options["attached"] or "faces", options["sides"]
    complete_joint = plate_finite_elements.compute_facts(file, plates, attached, sides, alone, shape)
    return NewJoint(
        complete_joint.file, {**facts, **complete_joint.facts}, [*warnings, *complete_joint.warnings]
    )


def _hole_diameter(options: DrawingOptions, thread: Thread) -> tuple[float, tuple[str, str]]:
    if options["hole"] is None:
        return thread.hole, ("standard", f"{thread_source('hole')} for {thread.name}")
    return parse_number("hole", options["hole"], "mm", "m"), ("user", "stated on the drawing")


def clamp_bolt(
    options: DrawingOptions,
    thread: Thread,
    plate_size: tuple[float, float],
    bolt_positions: Array,
    hole_diameter: float,
    young_moduli: tuple[float, float],
) -> ClampedBolt:
    """Compute one bolt with its clamped parts by VDI 2230.

    plate_size     : length and width of the plate [m]
    bolt_positions : (b, 2) [m] of the bolts
    hole_diameter  : [m] of the clearance hole
    young_moduli   : Young's moduli [Pa] of side 1 and side 2

    Raises ValueError for thicknesses or diameters that contradict each other.
    """
    head, tapped = options["head"] or "hexagon", bool(options["tapped"])
    bearing = getattr(thread, head)
    if options["bearing"] is not None:
        bearing = parse_number("bearing", options["bearing"], "mm", "m")
    for name, value, low in (
        ("hole", hole_diameter, thread.nominal_diameter),
        ("bearing", bearing, hole_diameter),
    ):
        if not value > low:
            raise ValueError(f"--{name} = {value * 1e3:g} mm is outside ({low * 1e3:g}, inf) mm")
    thicknesses = _clamped_thicknesses(options)
    if len(thicknesses) > (1 if tapped else 2):
        expected = "that of side 1" if tapped else "both plates together, or each"
        raise ValueError(f"--grip has {len(thicknesses)} values, expected {expected}")
    if tapped:
        layers: tuple[vdi2230.ClampedPart, ...] = (vdi2230.ClampedPart(thicknesses[0], young_moduli[0]),)
    else:
        pair = thicknesses if len(thicknesses) == 2 else [0.5 * thicknesses[0]] * 2
        layers = tuple(vdi2230.ClampedPart(t, E) for t, E in zip(pair, young_moduli, strict=True))
    grip = float(sum(layer.thickness for layer in layers))
    if grip > MAX_GRIP_RATIO * thread.nominal_diameter:
        longest_grip = MAX_GRIP_RATIO * thread.nominal_diameter * 1e3
        raise ValueError(
            f"--grip = {grip * 1e3:g} mm is outside (0, {longest_grip:g}] mm: {MAX_GRIP_RATIO} "
            f"times {thread.name}"
        )
    outer = outer_diameter(plate_size, bolt_positions)
    slope = vdi2230.cone_slope(grip, bearing, outer, tapped)
    if not slope > 0.0:
        raise ValueError(f"--grip = {grip * 1e3:g} mm is too short for a deformation cone of VDI 2230")
    shank = vdi2230.shank_length(thread, grip, head, tapped)
    delta_S = vdi2230.bolt_compliance(thread, grip, shank, head, young_moduli[1] if tapped else None)
    delta_P = vdi2230.members_compliance(layers, bearing, hole_diameter, outer, slope, tapped)
    cone = vdi2230.cone_diameter(min(layer.thickness for layer in layers), bearing, slope)
    return ClampedBolt(grip, layers, hole_diameter, bearing, outer, slope, cone, 1.0 / delta_S, 1.0 / delta_P)


def _clamped_thicknesses(options: DrawingOptions) -> list[float]:
    """Thickness [m] of each plate, or one value for both plates together."""
    grip = [parse_number("grip", text, "mm", "m") for text in options["grip"]]
    if options["thickness"] is None:
        return grip
    plates = _plate_thicknesses(options)
    if options["tapped"]:
        if abs(plates[0] - sum(grip)) > THICKNESS_TOLERANCE * plates[0]:
            raise ValueError(
                f"--thickness = {plates[0] * 1e3:g} mm of side 1 contradicts --grip = {sum(grip) * 1e3:g} mm"
                ": expected the same, the thread is in side 2"
            )
        return grip
    if abs(sum(plates) - sum(grip)) > THICKNESS_TOLERANCE * sum(grip):
        raise ValueError(
            f"--thickness = {plates[0] * 1e3:g} and {plates[1] * 1e3:g} mm contradicts --grip = "
            f"{sum(grip) * 1e3:g} mm: expected their sum"
        )
    return plates


def _plate_thicknesses(options: DrawingOptions) -> list[float]:
    thicknesses = [parse_number("thickness", text, "mm", "m") for text in options["thickness"]]
    if len(thicknesses) != 2:
        raise ValueError(f"--thickness has {len(thicknesses)} values, expected that of each plate")
    return thicknesses


def outer_diameter(plate_size: tuple[float, float], bolt_positions: Array) -> float:
    """Outer diameter D_A [m] of the clamped parts, mean over the bolts.

    For each bolt: twice the distance to the nearest edge, or the distance to the next bolt if this is
    smaller.

    Raises ValueError for a bolt outside the plate.
    """
    edge = np.min(np.array(plate_size) - 2.0 * np.abs(bolt_positions), axis=1)
    if np.min(edge) <= 0.0:
        i = int(np.argmin(edge))
        x, y = bolt_positions[i] * 1e3
        raise ValueError(f"bolt {i + 1} at ({x:g}, {y:g}) mm is not inside the plate")
    distance = np.hypot(*np.moveaxis(bolt_positions[:, None, :] - bolt_positions, -1, 0)) + np.diag(
        np.full(len(bolt_positions), np.inf)
    )
    return float(np.mean(np.minimum(edge, np.min(distance, axis=1))))


def _add_plate(
    parameter_sheet: ParameterSheet,
    bolted_plate: BoltedPlate,
    clamped_bolt: ClampedBolt,
    hole_source: tuple[str, str],
) -> None:
    for name in ("length", "width", "x", "y"):
        parameter_sheet.add_drawing_value(f"plate.{name}", getattr(bolted_plate, name))
    parameter_sheet.add("plate.hole_diameter", bolted_plate.hole_diameter, *hole_source)
    cone = (
        f"VDI 2230, cone from d_w = {clamped_bolt.bearing_diameter * 1e3:g} mm over "
        f"{min(layer.thickness for layer in clamped_bolt.clamped_parts) * 1e3:g} mm with tan(phi) = "
        f"{clamped_bolt.cone_slope:.4g}"
    )
    parameter_sheet.add("plate.cone_diameter", bolted_plate.cone_diameter, "derived", cone)
    parameter_sheet.add("A_0", bolted_plate.area, "derived", "area of the plate without the holes")


def _add_bolts(
    parameter_sheet: ParameterSheet, bolted_plate: BoltedPlate, clamped_bolt: ClampedBolt, thread: Thread
) -> None:
    row_bolts, row_distance = bolted_plate.equivalent_bolt_rows
    rows = "from the bolt positions: two equivalent rows that carry the same moment about x"
    parameter_sheet.add("n_bolts", float(len(bolted_plate.x)), "user", "stated on the drawing")
    parameter_sheet.add("row_bolts", row_bolts, "derived", rows)
    parameter_sheet.add("row_distance", row_distance, "derived", rows)
    text = f"VDI 2230, 1/delta_S of {thread.name} over {clamped_bolt.grip * 1e3:g} mm of grip"
    parameter_sheet.add("bolt_stiffness", clamped_bolt.bolt_stiffness, "derived", text)


def _add_preload(
    parameter_sheet: ParameterSheet, options: DrawingOptions, thread: Thread
) -> tuple[float, list[str]]:
    """Add the preload [N] to the sheet.

    Returns the preload, and a warning if it exceeds the proof load of the bolt.
    """
    name = options["property_class"] or "8.8"
    if options["preload"] is None:
        preload = vdi2230.assembly_preload(thread, property_class_strength(name, "yield", thread))
        text = f"VDI 2230, Table A1: {thread.name}-{name}, 90 % of the yield strength, mu_G = 0.12"
        parameter_sheet.add("inputs.preload", preload, "estimate", text)
    else:
        preload = parse_number("preload", options["preload"], "N", "N")
        parameter_sheet.add_drawing_value("inputs.preload", preload)
    if options["property_class"] is None:
        return preload, []
    proof_load = property_class_strength(name, "proof", thread) * vdi2230.stress_area(thread)
    return preload, warn_overload(
        "preload", preload, (proof_load, f"the proof load of {thread.name}-{name} (ISO 898-1)")
    )


def _add_embedding_loss(
    parameter_sheet: ParameterSheet,
    options: DrawingOptions,
    clamped_bolt: ClampedBolt,
    height_range: faces.HeightRange,
) -> float:
    """Add the preload loss [N] by embedding to the sheet, and return it."""
    if options["embedding"] is not None:
        loss = parse_number("embedding", options["embedding"], "N", "N", None)
        parameter_sheet.add_drawing_value("embedding", loss)
        return loss
    depth = vdi2230.embedding_depth(height_range.Rz, 1, bool(options["tapped"]))
    loss = depth / (1.0 / clamped_bolt.bolt_stiffness + 1.0 / clamped_bolt.member_stiffness)
    text = (
        f"VDI 2230: {depth * 1e6:.3g} um (Table 5: thread, "
        f"{'head' if options['tapped'] else 'head and nut'}, "
        f"one interface, Rz {height_range.Rz * 1e6:.2g} um, load along the bolt) over delta_S + delta_P"
    )
    parameter_sheet.add("embedding", loss, "estimate", text)
    return loss


def _friction_facts(parameter_file: ParameterFile, preload: float) -> dict[str, tuple[float, str, str]]:
    """Facts about friction: gross-slip force and loss factor, at mu and at both ends of its range."""
    shear, rows = friction_results(parameter_file, preload)
    slip = "shear force at which the whole interface slips"
    loss = f"loss factor of the interface between rigid sides at {shear:.3g} N of shear"
    facts = {}
    for name, row in zip(("", "_low", "_high"), rows, strict=False):
        text = f"; with mu = {row.mu:g}"
        facts[f"slip_force{name}"] = (row.slip_force, "N", slip + text)
        facts[f"loss_factor{name}"] = (row.loss_factor, "1", loss + text)
    return facts


def _interface_only_text(interface_stiffness: float, clamped_bolt: ClampedBolt) -> str:
    """Warning that the FMU contains the interface only, with its share of the compliance.

    interface_stiffness : [N/m] normal stiffness of the interface per bolt
    """
    share = clamped_bolt.member_stiffness / (clamped_bolt.member_stiffness + interface_stiffness)
    return (
        f"the FMU is the interface alone ({share:.1%} of the compliance along z that it has in series with "
        "the members of VDI 2230, loaded at the heads)"
    )


def _design_facts(
    parameter_file: ParameterFile, clamped_bolt: ClampedBolt, height_range: faces.HeightRange, preload: float
) -> dict[str, tuple[float, str, str]]:
    """Facts for the designer: preload, pressures, stiffnesses, load factor, friction."""
    values = parameter_file.values
    state = BoltedJointSpring.for_joint(values).evaluate(preload, 0.0, ZERO_MOTION, ZERO_MOTION)
    bolts = values.n_bolts * clamped_bolt.bolt_stiffness
    K = float(state["K_zz"]) - bolts
    facts = {
        "preload": (preload, "N", "force of each bolt at tightening"),
        "embedding": (
            values.embedding,
            "N",
            f"preload lost by embedding ({values.embedding / preload:.1%}); stiffness and slip are those of "
            "the remaining preload",
        ),
        "p_mean": (float(state["p_mean"]), "Pa", "mean contact pressure"),
        "p_max": (float(state["p_max"]), "Pa", "largest contact pressure, near a bolt"),
        "h": (
            float(parameter_file.values_by_name.get("h", np.nan)),
            "m",
            "combined rms height of both faces",
        ),
        "interface_K_zz": (
            K,
            "N/m",
            "normal stiffness of the interface alone at this preload, without the bolts",
        ),
        "interface_K_xx": (float(state["K_xx"]), "N/m", "tangential stiffness of the interface alone"),
        "bolt_stiffness": (
            clamped_bolt.bolt_stiffness,
            "N/m",
            "stiffness of one bolt, 1/delta_S of VDI 2230",
        ),
        "member_stiffness": (
            clamped_bolt.member_stiffness,
            "N/m",
            "stiffness of the members that one bolt clamps, 1/delta_P of VDI 2230",
        ),
        "load_factor": (
            clamped_bolt.bolt_stiffness / (clamped_bolt.bolt_stiffness + clamped_bolt.member_stiffness),
            "1",
            "Phi_K = delta_P/(delta_S + delta_P): share of an external force that the bolts carry",
        ),
    }
    facts |= _friction_facts(parameter_file, preload)
    if height_range.h_max > height_range.h_min and parameter_file.law == "roughness":
        h = float(parameter_file.values_by_name["h"])
        facts["interface_K_zz_low"] = (K * h / height_range.h_max, "N/m", "with the roughest usual finish")
        facts["interface_K_zz_high"] = (K * h / height_range.h_min, "N/m", "with the finest usual finish")
    return {name: fact for name, fact in facts.items() if np.isfinite(fact[0])}
