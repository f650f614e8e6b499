"""Parameters of a bolted joint from the drawing of its plates."""

from dataclasses import dataclass

import numpy as np

from jointfmu.joints.bolted_joint import KIND
from jointfmu.joints.bolted_joint.joint import BoltedJointSpring
from jointfmu.joints.bolted_joint.law import TIGHTENING_TEMPERATURE, preload_at_temperature
from jointfmu.mechanics.footprint.plate import BoltedPlate
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array

from ....inputs.drawing import faces, vdi2230
from ....inputs.drawing.part import DrawingOptions, NewJoint, ParameterSheet
from ....inputs.drawing.quantities import parse_quantity, parse_value, parse_values
from ....inputs.drawing.tables import Thread, find_row, thread_source
from ..gross_slip import PRELOAD_ENTRY, friction_results, preload_results
from . import ATTACHMENTS, layout, plate_finite_elements
from .plate_finite_elements import BoltedPlates, compute_pressure_field
from .tightening import AssemblyPreload, find_preload
from .washers import (
    MAX_BEARING_OVER_THREAD_DIAMETER,
    BoltWashers,
    bolt_distances,
    check_washers,
    find_washers,
)

ZERO_MOTION = (0.0, 0.0, 0.0)
"""Zero displacement [m] or rotation [rad] along x, y, z."""
THICKNESS_TOLERANCE = 1e-6
"""Relative difference [1] allowed between the grip and the sum of the thicknesses."""
MAX_GRIP_OVER_THREAD_DIAMETER = 50
"""Largest grip over the diameter of the thread [1]: a longer bolt is a tie rod."""
MAX_HOLE_OVER_THREAD_DIAMETER = 3.0
"""Largest diameter of the hole over diameter of the thread [1]."""
UNSTATED_RZ = 10e-6
"""Maximum height Rz [m] of faces whose roughness is not stated, for embedding: the usual one of Ra 1.6 um."""
THREAD_DEPTH_OVER_DIAMETER = 1.0
"""Depth of a tapped thread over the diameter of the thread [1]: a usual value in steel."""


@dataclass(frozen=True, slots=True)
class ClampedBolt:
    """One bolt with the parts that it clamps, by VDI 2230.

    grip              : [m] thickness of the plates between head and nut, or between head and tapped thread
    clamped_parts     : plates, thickness and modulus
    washers           : None if there are none
    hole_diameter     : [m] of the clearance hole
    head_diameter     : [m] outer diameter d_w of the bearing face of the head
    bearing_diameter  : [m] of the bearing face on the plates: d_w, or the deformation cone below the washers
    outer_diameter    : [m] D_A of the clamped parts
    cone_slope        : tan(phi) of the deformation cone [1]
    cone_diameter     : [m] of the deformation cone at the interface
    bolt_stiffness    : [N/m] 1/delta_S of the bolt alone
    washer_compliance : [m/N] delta_W of all washers; 0 without washers
    spring_stiffness  : [N/m] 1/(delta_S + delta_W) of the bolt in series with its washers
    member_stiffness  : [N/m] 1/delta_P of plates and washers
    """

    grip: float
    clamped_parts: tuple[vdi2230.ClampedPart, ...]
    washers: BoltWashers | None
    hole_diameter: float
    head_diameter: float
    bearing_diameter: float
    outer_diameter: float
    cone_slope: float
    cone_diameter: float
    bolt_stiffness: float
    washer_compliance: float
    spring_stiffness: float
    member_stiffness: float

    @property
    def head_hole_diameter(self) -> float:
        """Hole diameter [m] of the part under the bolt head: washer or plate."""
        return self.washers.washer.hole_diameter if self.washers else self.hole_diameter


@dataclass(frozen=True, slots=True)
class DrawnJoint:
    """Joint of two plates from a drawing, before finite elements.

    file         : parameters of the interface alone
    plates       : from which finite elements are made
    clamped_bolt : one bolt with its clamped parts
    tightening   : preload with its range
    heights      : maximum height of the faces; None: not stated
    """

    file: ParameterFile
    plates: BoltedPlates
    clamped_bolt: ClampedBolt
    tightening: AssemblyPreload
    heights: faces.HeightRange | None


def read_drawing(options: DrawingOptions) -> DrawnJoint:
    """Read the options of a drawing of two plates.

    Raises ValueError with a one-line message for options that are invalid or contradict each other.
    """
    length, width = parse_values("plate", options["plate"], separator="x", value_count=2)
    count, thread = layout.parse_bolts(options["bolts"])
    positions = layout.bolt_positions(options, count)
    sheet = ParameterSheet(KIND.name, faces.find_law(options))
    heights = faces.add_faces(sheet, options)
    hole, hole_source = _hole_diameter(options, thread)
    moduli = (sheet.get_value("side1.E"), sheet.get_value("side2.E"))
    for name, value in (("field", "computed"), ("sides", "elastic"), ("attached", options["attached"])):
        if options["tapped"] and options["thickness"] is None and value and options[name] == value:
            raise ValueError(f"--{name} {value} with --tapped: expected --thickness of both plates for it")
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
    sheet.add_parameter("mass", mass, "estimate", "mass of the plate of side 1, assumed to vibrate")
    tightening = find_preload(options, thread, bolt.head_diameter, bolt.head_hole_diameter)
    tightening.add_to(sheet)
    preload = tightening.force
    if not loss < preload:
        raise ValueError(
            f"embedding takes {loss:.4g} N of a preload of {preload:.4g} N: expected less than all; state "
            "--embedding or more --preload"
        )
    for choice in ("critical_area", "spot_stiffness"):
        default = {"critical_area": "continuity", "spot_stiffness": "hertz"}[choice]
        sheet.add_parameter(
            choice, default, "estimate", "nearest to the roughness of the surfaces, docs/validity.md"
        )
    file = sheet.build_file(f"plate {options['plate']} with {options['bolts']}")
    density = tuple(material.numbers["density"].value for material in faces.read_materials(options))
    layers, depth = bolt.clamped_parts, 0.0
    if options["tapped"] and options["thickness"] is not None:
        layers = (*layers, vdi2230.ClampedPart(_plate_thicknesses(options)[1], moduli[1]))
        depth = THREAD_DEPTH_OVER_DIAMETER * thread.nominal_diameter
    plates = BoltedPlates(plate, layers, bolt.bearing_diameter, density, preload, preload - loss, depth)
    return DrawnJoint(file, plates, bolt, tightening, heights)


def make_joint(options: DrawingOptions) -> NewJoint:
    """Make the parameters of a bolted joint from the options of a drawing.

    Raises ValueError with a one-line message for options that are invalid or contradict each other.
    """
    drawn = read_drawing(options)
    file, bolt, tightening, shape = drawn.file, drawn.clamped_bolt, drawn.tightening, None
    loss, warnings = file.values.embedding, [*tightening.warnings]
    if options["field"] == "computed":
        file, shape = compute_pressure_field(file, drawn.plates)
    is_rigid = options["sides"] == "rigid" or (options["tapped"] and options["thickness"] is None)
    joint = NewJoint(file, {})
    if not is_rigid:
        attached = options["attached"] or next(iter(ATTACHMENTS))
        joint = plate_finite_elements.compute_joint_or_warning(file, drawn.plates, attached, shape)
    facts = _design_facts(file, bolt, drawn.heights, tightening.force)
    if is_rigid:
        facts |= _interface_share_facts(facts["interface_K_zz"][0] / file.values.n_bolts, bolt)
    if is_rigid and options["sides"] is None:
        warnings.append(
            "the FMU is the interface alone; for the complete joint state --thickness of both plates"
        )
    facts |= {**tightening.facts(), **joint.facts, **_preload_range_facts(joint.file)}
    if tightening.has_range and not tightening.min_force > loss:
        warnings.append(
            f"embedding takes {loss:.4g} N, but the preload may be {tightening.min_force:.4g} N: the joint "
            "may be loose"
        )
    return NewJoint(joint.file, facts, [*warnings, *joint.warnings])


def _hole_diameter(options: DrawingOptions, thread: Thread) -> tuple[float, tuple[str, str]]:
    """Diameter [m] of the clearance hole: stated, or from the table of threads."""
    if options["hole"] is None:
        return thread.hole, ("standard", f"{thread_source('hole')} for {thread.name}")
    return parse_value("hole", options["hole"]), ("user", "stated on the drawing")


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
        bearing = parse_value("bearing", options["bearing"])
    washers = find_washers(options, thread)
    head_hole = washers.washer.hole_diameter if washers else hole_diameter
    for name, value, low, ratio in (
        ("hole", hole_diameter, thread.nominal_diameter, MAX_HOLE_OVER_THREAD_DIAMETER),
        ("bearing", bearing, head_hole, MAX_BEARING_OVER_THREAD_DIAMETER),
    ):
        high = ratio * thread.nominal_diameter
        if not low < value <= high:
            raise ValueError(
                f"--{name} = {value * 1e3:g} mm is outside ({low * 1e3:g}, {high * 1e3:g}] mm of "
                f"{thread.name}"
            )
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
    if grip > MAX_GRIP_OVER_THREAD_DIAMETER * thread.nominal_diameter:
        longest_grip = MAX_GRIP_OVER_THREAD_DIAMETER * thread.nominal_diameter * 1e3
        raise ValueError(
            f"--grip = {grip * 1e3:g} mm is outside (0, {longest_grip:g}] mm: "
            f"{MAX_GRIP_OVER_THREAD_DIAMETER} times {thread.name}"
        )
    outer = outer_diameter(plate_size, bolt_positions)
    length = grip + washers.length if washers else grip
    slope = vdi2230.cone_slope(length, bearing, outer, tapped)
    if not slope > 0.0:
        raise ValueError(f"--grip = {grip * 1e3:g} mm is too short for a deformation cone of VDI 2230")
    seat, delta_W = bearing, 0.0
    if washers:
        check_washers(washers, thread, bearing, bolt_positions)
        seat = vdi2230.washer_cone_diameter(bearing, washers.washer, slope)
        delta_W = washers.count * vdi2230.washer_compliance(bearing, washers.washer, slope)
        if not seat > hole_diameter:
            raise ValueError(
                f"--hole = {hole_diameter * 1e3:g} mm is outside ({thread.nominal_diameter * 1e3:g}, "
                f"{seat * 1e3:.4g}) mm: the deformation cone under {washers.describe()} must be wider"
            )
    shank = vdi2230.shank_length(thread, length, head, tapped)
    delta_S = vdi2230.bolt_compliance(thread, length, shank, head, young_moduli[1] if tapped else None)
    delta_P = delta_W + vdi2230.members_compliance(layers, seat, hole_diameter, outer, slope, tapped)
    return ClampedBolt(
        grip,
        layers,
        washers,
        hole_diameter,
        bearing,
        seat,
        outer,
        slope,
        cone_diameter=vdi2230.cone_diameter(min(layer.thickness for layer in layers), seat, slope),
        bolt_stiffness=1.0 / delta_S,
        washer_compliance=delta_W,
        spring_stiffness=1.0 / (delta_S + delta_W),
        member_stiffness=1.0 / delta_P,
    )


def _clamped_thicknesses(options: DrawingOptions) -> list[float]:
    """Clamped thicknesses [m]: of each plate, or their sum as one value."""
    grip = [parse_value("grip", text) for text in options["grip"]]
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
    """Thicknesses [m] of both plates, as the user states them."""
    thicknesses = [parse_value("thickness", text) for text in options["thickness"]]
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
    return float(np.mean(np.minimum(edge, bolt_distances(bolt_positions))))


def _add_plate(
    parameter_sheet: ParameterSheet,
    bolted_plate: BoltedPlate,
    clamped_bolt: ClampedBolt,
    hole_diameter_source: tuple[str, str],
) -> None:
    """Add the parameters of contact area and pressure cones to the sheet."""
    for name in ("length", "width", "x", "y"):
        parameter_sheet.add_drawing_value(f"plate.{name}", getattr(bolted_plate, name))
    parameter_sheet.add_parameter("plate.hole_diameter", bolted_plate.hole_diameter, *hole_diameter_source)
    washers = clamped_bolt.washers
    through = f"through {washers.washer.thickness * 1e3:g} mm of washer and " if washers else "over "
    cone = (
        f"VDI 2230, cone from d_w = {clamped_bolt.head_diameter * 1e3:g} mm {through}"
        f"{min(layer.thickness for layer in clamped_bolt.clamped_parts) * 1e3:g} mm with tan(phi) = "
        f"{clamped_bolt.cone_slope:.4g}"
    )
    parameter_sheet.add_parameter("plate.cone_diameter", bolted_plate.cone_diameter, "derived", cone)
    parameter_sheet.add_parameter("A_0", bolted_plate.area, "derived", "area of the plate without the holes")


def _add_bolts(
    parameter_sheet: ParameterSheet, bolted_plate: BoltedPlate, clamped_bolt: ClampedBolt, thread: Thread
) -> None:
    """Add the parameters of number, rows and stiffness of the bolts to the sheet."""
    row_bolts, row_distance = bolted_plate.equivalent_bolt_rows
    rows = "from the bolt positions: two equivalent rows that carry the same moment about x"
    parameter_sheet.add_parameter("n_bolts", float(len(bolted_plate.x)), "user", "stated on the drawing")
    parameter_sheet.add_parameter("row_bolts", row_bolts, "derived", rows)
    parameter_sheet.add_parameter("row_distance", row_distance, "derived", rows)
    text = f"VDI 2230, 1/delta_S of {thread.name} over {clamped_bolt.grip * 1e3:g} mm of grip"
    if washers := clamped_bolt.washers:
        text = (
            f"VDI 2230, 1/(delta_S + delta_W): {thread.name} over {clamped_bolt.grip * 1e3:g} mm of grip and "
            f"{washers.length * 1e3:g} mm of washers, in series with {washers.describe()}"
        )
    parameter_sheet.add_parameter("bolt_stiffness", clamped_bolt.spring_stiffness, "derived", text)
    _add_thermal_parameters(parameter_sheet, clamped_bolt)


def _add_thermal_parameters(parameter_sheet: ParameterSheet, clamped_bolt: ClampedBolt) -> None:
    """Add clamped lengths and expansion of the bolts to the sheet.

    With these parameters, the temperature changes the preload.
    """
    steel = find_row("materials", "steel")
    alpha, text = steel.numbers["alpha"], "bolts of steel" + (" with washers" if clamped_bolt.washers else "")
    parameter_sheet.add_parameter("bolt.alpha", alpha.value, alpha.origin, f"{text}: {alpha.source}")
    plates = 1.0 / (1.0 / clamped_bolt.member_stiffness - clamped_bolt.washer_compliance)
    text = "VDI 2230, 1/delta_P" + (" without the washers" if clamped_bolt.washers else "")
    parameter_sheet.add_parameter("plate_stiffness", plates, "derived", text)
    lengths = [part.thickness for part in clamped_bolt.clamped_parts]
    for name, length in zip(("side1", "side2"), [*lengths, 0.0], strict=False):
        text = "thickness of the plate" if length else "the thread is tapped in this side"
        parameter_sheet.add_parameter(f"{name}.clamped_length", length, "user", text)


def _add_embedding_loss(
    parameter_sheet: ParameterSheet,
    options: DrawingOptions,
    clamped_bolt: ClampedBolt,
    height_range: faces.HeightRange | None,
) -> float:
    """Add the preload loss [N] by embedding to the parameter sheet, and return it."""
    if options["embedding"] is not None:
        stated = parse_quantity("embedding", options["embedding"])
        parameter_sheet.add_drawing_number("embedding", stated)
        return stated.value
    interfaces = 1 + (clamped_bolt.washers.count if clamped_bolt.washers else 0)
    Rz = height_range.Rz if height_range else UNSTATED_RZ
    depth = vdi2230.embedding_depth(Rz, interfaces, bool(options["tapped"]))
    loss = depth / (1.0 / clamped_bolt.bolt_stiffness + 1.0 / clamped_bolt.member_stiffness)
    interface_text = {
        1: "one interface",
        2: "two interfaces (plates, washer)",
        3: "three interfaces (plates, two washers)",
    }[interfaces]
    text = (
        f"VDI 2230: {depth * 1e6:.3g} um (Table 5: thread, "
        f"{'head' if options['tapped'] else 'head and nut'}, "
        f"{interface_text}, Rz {Rz * 1e6:.2g} um{'' if height_range else ', not stated'}, load along the "
        "bolt) over delta_S + delta_P"
    )
    parameter_sheet.add_parameter("embedding", loss, "estimate", text)
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


def _preload_range_facts(parameter_file: ParameterFile) -> dict[str, tuple[float, str, str]]:
    """Facts about the joint at both ends of the range of the preload; empty if the file states no range."""
    ends = parameter_file.ranges.get(PRELOAD_ENTRY)
    if ends is None:
        return {}
    facts = {}
    for result in preload_results(parameter_file):
        if result.preload not in ends:
            continue
        end = "low" if result.preload == ends[0] else "high"
        text = f"at preload = {result.preload:.4g} N"
        facts[f"K_zz_at_{end}_preload"] = (result.K_zz, "N/m", f"output K_zz of the FMU {text}")
        facts[f"K_xx_at_{end}_preload"] = (result.K_xx, "N/m", f"output K_xx of the FMU {text}")
        slip = f"shear force {text} at which the whole interface slips"
        facts[f"slip_force_at_{end}_preload"] = (result.slip_force, "N", slip)
        facts[f"opening_load_at_{end}_preload"] = (
            result.opening_load,
            "N",
            f"force along z {text} that opens the interface around the most loaded bolt, by linear theory",
        )
    return facts


def _interface_share_facts(
    interface_stiffness: float, clamped_bolt: ClampedBolt
) -> dict[str, tuple[float, str, str]]:
    """Share of the interface in the compliance, by VDI 2230, as a fact for the user.

    Used for joints with rigid sides, whose FMU contains the interface only.

    interface_stiffness : [N/m] normal stiffness of the interface per bolt
    """
    share = clamped_bolt.member_stiffness / (clamped_bolt.member_stiffness + interface_stiffness)
    text = (
        "share of the interface in the compliance along z that it has in series with the members of VDI "
        "2230, loaded at the heads; the FMU is the interface alone (sides = rigid)"
    )
    return {"interface_share": (share, "1", text)}


def _washer_facts(clamped_bolt: ClampedBolt) -> dict[str, tuple[float, str, str]]:
    """Facts about a bolt with washers: they replace the facts of a bolt without washers."""
    assert clamped_bolt.washers
    sizes = clamped_bolt.washers.describe()
    return {
        "bolt_stiffness": (
            clamped_bolt.spring_stiffness,
            "N/m",
            f"stiffness of one bolt in series with {sizes}: 1/(delta_S + delta_W); 1/delta_S of VDI 2230 is "
            f"{clamped_bolt.bolt_stiffness:.4g} N/m",
        ),
        "washer_stiffness": (
            1.0 / clamped_bolt.washer_compliance,
            "N/m",
            f"stiffness of {sizes}, 1/delta_W",
        ),
        "member_stiffness": (
            clamped_bolt.member_stiffness,
            "N/m",
            "stiffness of the members and washers that one bolt clamps, 1/delta_P of VDI 2230 with delta_W",
        ),
    }


def _design_facts(
    parameter_file: ParameterFile,
    clamped_bolt: ClampedBolt,
    height_range: faces.HeightRange | None,
    preload: float,
) -> dict[str, tuple[float, str, str]]:
    """Facts for the designer: preload, pressures, stiffnesses, load factor, friction."""
    values = parameter_file.values
    state = BoltedJointSpring.for_joint(values).evaluate(preload, 0.0, ZERO_MOTION, ZERO_MOTION)
    bolts = values.n_bolts * values.bolt_stiffness
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
        **faces.height_fact(parameter_file),
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
    if clamped_bolt.washers:
        facts |= _washer_facts(clamped_bolt)
    if per_kelvin := preload_at_temperature(values, 0.0, TIGHTENING_TEMPERATURE + 1.0):
        facts["preload_per_kelvin"] = (
            per_kelvin,
            "N/K",
            "change of the preload of each bolt with the temperature of bolts and members, VDI 2230",
        )
    facts |= _friction_facts(parameter_file, preload)
    if height_range and height_range.h_max > height_range.h_min and parameter_file.law == "roughness":
        h = float(parameter_file.values_by_name["h"])
        facts["interface_K_zz_low"] = (
            K * h / height_range.h_max,
            "N/m",
            "with the largest of the heights",
        )
        facts["interface_K_zz_high"] = (
            K * h / height_range.h_min,
            "N/m",
            "with the smallest of the heights",
        )
    return {name: fact for name, fact in facts.items() if np.isfinite(fact[0])}
