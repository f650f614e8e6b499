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
from ....inputs.drawing.quantities import parse_quantity, parse_quantity_value, parse_quantity_values
from ....inputs.drawing.tables import Thread, find_bolt_column_source, find_table_row
from ..gross_slip import PRELOAD_ENTRY_NAME, compute_friction_results, compute_preload_results
from . import ATTACHMENT_SURFACES, layout, plate_finite_elements
from .plate_finite_elements import BoltedPlates, compute_pressure_field
from .tightening import AssemblyPreload, find_assembly_preload
from .washers import (
    MAX_BEARING_OVER_THREAD_DIAMETER,
    BoltWashers,
    check_washers,
    distances_to_next_bolt,
    find_washers,
)

ZERO_DISPLACEMENT = (0.0, 0.0, 0.0)
"""Zero displacement [m] or rotation [rad] along x, y, z."""
RELATIVE_GRIP_LENGTH_TOLERANCE = 1e-6
"""Relative difference [1] allowed between the grip and the sum of the thicknesses."""
MAX_GRIP_OVER_THREAD_DIAMETER = 50
"""Largest grip over the diameter of the thread [1]: a longer bolt is a tie rod."""
MAX_HOLE_OVER_THREAD_DIAMETER = 3.0
"""Largest diameter of the hole over diameter of the thread [1]."""
DEFAULT_ROUGHNESS_HEIGHT_RZ = 10e-6
"""Maximum height Rz [m] of faces whose roughness is not stated, for embedding: the usual one of Ra 1.6 um."""
LARGE_BED_THICKNESS_RATIO = 0.3
"""Thickness T of plate 2 over the square root of the plate area [1] at which plate 2 is about as stiff as a
large solid bed: T = 3 pi (1 - nu^2) a/16 for a disc of radius a and the same area. Then a column of length T
has the rotational stiffness of a rigid disc on a half-space, 8 G a^3/(3 (1 - nu)) (Johnson, Contact
Mechanics)."""
THREAD_DEPTH_OVER_DIAMETER = 1.0
"""Depth of a tapped thread over the diameter of the thread [1]: a usual value in steel."""


@dataclass(frozen=True, slots=True)
class ClampedBolt:
    """One bolt with the parts that it clamps, by VDI 2230.

    clamped_length    : [m] thickness of the plates between head and nut, or between head and tapped thread
    clamped_parts     : plates, thickness and modulus
    bolt_washers      : None if there are none
    hole_diameter     : [m] of the clearance hole
    head_diameter     : [m] outer diameter d_w of the bearing face of the head
    bearing_diameter  : [m] of the bearing face on the plates: d_w, or the deformation cone below the washers
    clamped_part_diameter : [m] outer diameter D_A of the clamped parts
    cone_slope        : tan(phi) of the deformation cone [1]
    cone_diameter     : [m] of the deformation cone at the interface
    bolt_stiffness    : [N/m] 1/delta_S of the bolt alone
    washer_compliance : [m/N] delta_W of all washers; 0 without washers
    bolt_and_washer_stiffness : [N/m] 1/(delta_S + delta_W) of the bolt in series with its washers
    member_stiffness  : [N/m] 1/delta_P of plates and washers
    """

    clamped_length: float
    clamped_parts: tuple[vdi2230.ClampedPart, ...]
    bolt_washers: BoltWashers | None
    hole_diameter: float
    head_diameter: float
    bearing_diameter: float
    clamped_part_diameter: float
    cone_slope: float
    cone_diameter: float
    bolt_stiffness: float
    washer_compliance: float
    bolt_and_washer_stiffness: float
    member_stiffness: float

    @property
    def head_hole_diameter(self) -> float:
        """Hole diameter [m] of the part under the bolt head: washer or plate."""
        return self.bolt_washers.washer_size.hole_diameter if self.bolt_washers else self.hole_diameter


@dataclass(frozen=True, slots=True)
class DrawnJoint:
    """Joint of two plates from a drawing, before finite elements.

    parameter_file   : parameters of the interface alone
    bolted_plates    : plates from which finite elements are made
    clamped_bolt     : one bolt with its clamped parts
    assembly_preload : preload with its range
    height_range     : range of the maximum roughness height Rz of the faces; None: not stated
    """

    parameter_file: ParameterFile
    bolted_plates: BoltedPlates
    clamped_bolt: ClampedBolt
    assembly_preload: AssemblyPreload
    height_range: faces.HeightRange | None


def read_drawing(drawing_options: DrawingOptions) -> DrawnJoint:
    """Read the options of a drawing of two plates.

    Raises ValueError with a one-line message for options that are invalid or contradict each other.
    """
    length, width = parse_quantity_values(
        "plate", drawing_options["plate"], number_separator="x", expected_value_count=2
    )
    count, thread = layout.parse_bolts(drawing_options["bolts"])
    positions = layout.bolt_positions(drawing_options, count)
    sheet = ParameterSheet(KIND.name, faces.choose_interface_law(drawing_options))
    heights = faces.add_face_parameters(sheet, drawing_options)
    hole, hole_source = _hole_diameter(drawing_options, thread)
    moduli = (sheet.get_parameter_value("side1.E"), sheet.get_parameter_value("side2.E"))
    for name, value in (
        ("field", "computed"),
        ("sides", "elastic"),
        ("attached", drawing_options["attached"]),
    ):
        if (
            drawing_options["tapped"]
            and drawing_options["thickness"] is None
            and value
            and drawing_options[name] == value
        ):
            raise ValueError(
                f"--{name} {value} with --tapped needs the thickness of both plates; state --thickness T1 T2"
            )
    bolt = make_clamped_bolt(drawing_options, thread, (length, width), positions, hole, moduli)
    plate = BoltedPlate(
        length=length,
        width=width,
        x=tuple(positions[:, 0].tolist()),
        y=tuple(positions[:, 1].tolist()),
        hole_diameter=hole,
        cone_diameter=bolt.cone_diameter,
    )
    _add_plate_parameters(sheet, plate, bolt, hole_source)
    _add_bolt_parameters(sheet, plate, bolt, thread)
    loss = _add_embedding_loss(sheet, drawing_options, bolt, heights)
    mass = (
        plate.area
        * bolt.clamped_parts[0].thickness
        * faces.read_materials(drawing_options)[0].sourced_numbers["density"].si_value
    )
    sheet.add_parameter("mass", mass, "estimate", "mass of the plate of side 1, assumed to vibrate")
    tightening = find_assembly_preload(drawing_options, thread, bolt.head_diameter, bolt.head_hole_diameter)
    tightening.add_to_sheet(sheet)
    preload = tightening.preload_force
    if not loss < preload:
        cause, remedy = "", "--preload"
        if drawing_options["torque"] is not None:
            torque = parse_quantity("torque", drawing_options["torque"]).stated_value
            cause = f" by --torque = {drawing_options['torque']!r}, which is {torque:.4g} N.m"
            remedy = "--torque"
        raise ValueError(
            f"embedding takes {loss:.4g} N, the whole preload of {preload:.4g} N{cause}: state a larger "
            f"{remedy} or a smaller --embedding"
        )
    for choice in ("critical_area", "spot_stiffness"):
        default = {"critical_area": "continuity", "spot_stiffness": "hertz"}[choice]
        sheet.add_parameter(
            choice, default, "estimate", "nearest to the roughness of the surfaces, docs/validity.md"
        )
    file = sheet.build_parameter_file(f"plate {drawing_options['plate']} with {drawing_options['bolts']}")
    density = tuple(
        material.sourced_numbers["density"].si_value for material in faces.read_materials(drawing_options)
    )
    layers, depth = bolt.clamped_parts, 0.0
    if drawing_options["tapped"] and drawing_options["thickness"] is not None:
        layers = (*layers, vdi2230.ClampedPart(_plate_thicknesses(drawing_options)[1], moduli[1]))
        depth = THREAD_DEPTH_OVER_DIAMETER * thread.nominal_diameter
    plates = BoltedPlates(plate, layers, bolt.bearing_diameter, density, preload, preload - loss, depth)
    return DrawnJoint(file, plates, bolt, tightening, heights)


def make_joint(drawing_options: DrawingOptions) -> NewJoint:
    """Make the parameters of a bolted joint from the options of a drawing.

    Raises ValueError with a one-line message for options that are invalid or contradict each other.
    """
    drawn = read_drawing(drawing_options)
    file, bolt, tightening, shape = drawn.parameter_file, drawn.clamped_bolt, drawn.assembly_preload, None
    loss, warnings = file.values.embedding, [*tightening.preload_warnings]
    if drawing_options["field"] == "computed":
        file, shape = compute_pressure_field(file, drawn.bolted_plates)
    is_rigid = drawing_options["sides"] == "rigid" or (
        drawing_options["tapped"] and drawing_options["thickness"] is None
    )
    joint = NewJoint(file, {})
    if not is_rigid:
        attached = drawing_options["attached"] or next(iter(ATTACHMENT_SURFACES))
        joint = plate_finite_elements.compute_complete_joint(file, drawn.bolted_plates, attached, shape)
    facts = _compute_design_results(file, bolt, drawn.height_range, tightening.preload_force)
    if is_rigid:
        facts |= _compute_interface_share(facts["interface_K_zz"][0] / file.values.n_bolts, bolt)
    elif drawing_options["tapped"]:
        facts |= _compute_bed_thickness(drawn.bolted_plates.bolted_plate)
    if is_rigid and drawing_options["sides"] is None:
        warnings.append(
            "the plates of the FMU are rigid; for the complete joint, state --thickness of both plates"
        )
    facts |= {
        **tightening.describe_scatter_and_utilisation(),
        **joint.facts,
        **_compute_preload_range_results(joint.parameter_file),
    }
    if tightening.has_range and not tightening.min_preload_force > loss:
        warnings.append(
            f"embedding takes {loss:.4g} N, but the preload may be as low as "
            f"{tightening.min_preload_force:.4g} N: the joint may be loose"
        )
    return NewJoint(joint.parameter_file, facts, [*warnings, *joint.warnings])


def _hole_diameter(drawing_options: DrawingOptions, thread: Thread) -> tuple[float, tuple[str, str]]:
    """Diameter [m] of the clearance hole: stated, or from the table of threads."""
    if drawing_options["hole"] is None:
        return thread.hole_diameter, (
            "standard",
            f"{find_bolt_column_source('hole')} for {thread.thread_name}",
        )
    return parse_quantity_value("hole", drawing_options["hole"]), ("user", "stated on the drawing")


def make_clamped_bolt(
    drawing_options: DrawingOptions,
    thread: Thread,
    plate_size: tuple[float, float],
    bolt_positions: Array,
    hole_diameter: float,
    young_moduli: tuple[float, float],
) -> ClampedBolt:
    """Make one bolt with its clamped parts, for the resilience calculation of VDI 2230.

    plate_size     : length and width of the plate [m]
    bolt_positions : (b, 2) [m] of the bolts
    hole_diameter  : [m] of the clearance hole
    young_moduli   : Young's moduli [Pa] of side 1 and side 2

    Raises ValueError for thicknesses or diameters that contradict each other.
    """
    head, tapped = drawing_options["head"] or "hexagon", bool(drawing_options["tapped"])
    bearing = thread.bearing_diameter(head)
    if drawing_options["bearing"] is not None:
        bearing = parse_quantity_value("bearing", drawing_options["bearing"])
    washers = find_washers(drawing_options, thread)
    head_hole = washers.washer_size.hole_diameter if washers else hole_diameter
    for name, value, low, ratio in (
        ("hole", hole_diameter, thread.nominal_diameter, MAX_HOLE_OVER_THREAD_DIAMETER),
        ("bearing", bearing, head_hole, MAX_BEARING_OVER_THREAD_DIAMETER),
    ):
        high = ratio * thread.nominal_diameter
        if not low < value <= high:
            raise ValueError(
                f"--{name} = {value * 1e3:g} mm is outside ({low * 1e3:g}, {high * 1e3:g}] mm for "
                f"{thread.thread_name}"
            )
    thicknesses = _clamped_thicknesses(drawing_options)
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
            f"{MAX_GRIP_OVER_THREAD_DIAMETER} times the diameter of {thread.thread_name}"
        )
    outer = mean_clamped_part_diameter(plate_size, bolt_positions)
    length = grip + washers.total_thickness if washers else grip
    slope = vdi2230.cone_slope(length, bearing, outer, tapped)
    if not slope > 0.0:
        raise ValueError(
            f"--grip = {grip * 1e3:g} mm is too short for a deformation cone of VDI 2230; expected a longer "
            "grip"
        )
    seat, delta_W = bearing, 0.0
    if washers:
        check_washers(washers, thread, bearing, bolt_positions)
        seat = vdi2230.washer_cone_diameter(bearing, washers.washer_size, slope)
        delta_W = washers.washer_count * vdi2230.washer_compliance(bearing, washers.washer_size, slope)
        if not seat > hole_diameter:
            raise ValueError(
                f"--hole = {hole_diameter * 1e3:g} mm is outside ({thread.nominal_diameter * 1e3:g}, "
                f"{seat * 1e3:.4g}) mm: the deformation cone under {washers.describe_washers()} must be "
                "wider"
            )
    shank = vdi2230.unthreaded_shank_length(thread, length, head, tapped)
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
        bolt_and_washer_stiffness=1.0 / (delta_S + delta_W),
        member_stiffness=1.0 / delta_P,
    )


def _clamped_thicknesses(drawing_options: DrawingOptions) -> list[float]:
    """Clamped thicknesses [m]: of each plate, or their sum as one value."""
    grip = [parse_quantity_value("grip", text) for text in drawing_options["grip"]]
    if drawing_options["thickness"] is None:
        return grip
    plates = _plate_thicknesses(drawing_options)
    if drawing_options["tapped"]:
        if abs(plates[0] - sum(grip)) > RELATIVE_GRIP_LENGTH_TOLERANCE * plates[0]:
            raise ValueError(
                f"--thickness = {plates[0] * 1e3:g} mm of side 1 contradicts --grip = {sum(grip) * 1e3:g} "
                "mm: expected the same thickness, because the thread is in side 2"
            )
        return grip
    if abs(sum(plates) - sum(grip)) > RELATIVE_GRIP_LENGTH_TOLERANCE * sum(grip):
        raise ValueError(
            f"--thickness = {plates[0] * 1e3:g} and {plates[1] * 1e3:g} mm contradicts --grip = "
            f"{sum(grip) * 1e3:g} mm: expected their sum"
        )
    return plates


def _plate_thicknesses(drawing_options: DrawingOptions) -> list[float]:
    """Thicknesses [m] of both plates, as the user states them."""
    thicknesses = [parse_quantity_value("thickness", text) for text in drawing_options["thickness"]]
    if len(thicknesses) != 2:
        raise ValueError(f"--thickness has {len(thicknesses)} values, expected 2: one for each plate")
    return thicknesses


def mean_clamped_part_diameter(plate_size: tuple[float, float], bolt_positions: Array) -> float:
    """Outer diameter D_A [m] of the clamped parts, mean over the bolts.

    For each bolt: twice the distance to the nearest edge, or the distance to the next bolt if this is
    smaller.

    Raises ValueError for a bolt outside the plate.
    """
    edge = np.min(np.array(plate_size) - 2.0 * np.abs(bolt_positions), axis=1)
    if np.min(edge) <= 0.0:
        i = int(np.argmin(edge))
        x, y = bolt_positions[i] * 1e3
        raise ValueError(
            f"bolt {i + 1} at ({x:g}, {y:g}) mm is not inside the plate; check the positions and --plate"
        )
    return float(np.mean(np.minimum(edge, distances_to_next_bolt(bolt_positions))))


def _add_plate_parameters(
    parameter_sheet: ParameterSheet,
    bolted_plate: BoltedPlate,
    clamped_bolt: ClampedBolt,
    hole_diameter_source: tuple[str, str],
) -> None:
    """Add the parameters of contact area and pressure cones to the parameter sheet."""
    for name in ("length", "width", "x", "y"):
        parameter_sheet.add_drawing_value(f"plate.{name}", getattr(bolted_plate, name))
    parameter_sheet.add_parameter("plate.hole_diameter", bolted_plate.hole_diameter, *hole_diameter_source)
    washers = clamped_bolt.bolt_washers
    through = f"through {washers.washer_size.thickness * 1e3:g} mm of washer and " if washers else "over "
    cone = (
        f"VDI 2230, cone from d_w = {clamped_bolt.head_diameter * 1e3:g} mm "
        f"{through}{min(layer.thickness for layer in clamped_bolt.clamped_parts) * 1e3:g} mm with tan(phi) "
        f"= {clamped_bolt.cone_slope:.4g}"
    )
    parameter_sheet.add_parameter("plate.cone_diameter", bolted_plate.cone_diameter, "derived", cone)
    parameter_sheet.add_parameter("A_0", bolted_plate.area, "derived", "area of the plate without the holes")


def _add_bolt_parameters(
    parameter_sheet: ParameterSheet, bolted_plate: BoltedPlate, clamped_bolt: ClampedBolt, thread: Thread
) -> None:
    """Add the parameters of number, rows and stiffness of the bolts to the parameter sheet."""
    row_bolts, row_distance = bolted_plate.equivalent_bolt_rows
    rows = "from the bolt positions: two equivalent rows that carry the same moment about x"
    parameter_sheet.add_parameter("n_bolts", float(len(bolted_plate.x)), "user", "stated on the drawing")
    parameter_sheet.add_parameter("row_bolts", row_bolts, "derived", rows)
    parameter_sheet.add_parameter("row_distance", row_distance, "derived", rows)
    text = (
        f"VDI 2230, 1/delta_S of {thread.thread_name} over {clamped_bolt.clamped_length * 1e3:g} mm of grip"
    )
    if washers := clamped_bolt.bolt_washers:
        text = (
            f"VDI 2230, 1/(delta_S + delta_W): {thread.thread_name} over "
            f"{clamped_bolt.clamped_length * 1e3:g} mm of grip and {washers.total_thickness * 1e3:g} mm of "
            f"washers, in series with {washers.describe_washers()}"
        )
    parameter_sheet.add_parameter("bolt_stiffness", clamped_bolt.bolt_and_washer_stiffness, "derived", text)
    _add_thermal_parameters(parameter_sheet, clamped_bolt)


def _add_thermal_parameters(parameter_sheet: ParameterSheet, clamped_bolt: ClampedBolt) -> None:
    """Add clamped lengths and thermal expansion of bolts and plates to the parameter sheet.

    With these parameters, the temperature changes the preload.
    """
    steel = find_table_row("materials", "steel")
    alpha, text = (
        steel.sourced_numbers["alpha"],
        "bolts of steel" + (" with washers" if clamped_bolt.bolt_washers else ""),
    )
    parameter_sheet.add_parameter(
        "bolt.alpha", alpha.si_value, alpha.value_origin, f"{text}: {alpha.value_source}"
    )
    plates = 1.0 / (1.0 / clamped_bolt.member_stiffness - clamped_bolt.washer_compliance)
    text = "VDI 2230, 1/delta_P" + (" without the washers" if clamped_bolt.bolt_washers else "")
    parameter_sheet.add_parameter("plate_stiffness", plates, "derived", text)
    lengths = [part.thickness for part in clamped_bolt.clamped_parts]
    for name, length in zip(("side1", "side2"), [*lengths, 0.0], strict=False):
        text = "thickness of the plate" if length else "the thread is tapped in this side"
        parameter_sheet.add_parameter(f"{name}.clamped_length", length, "user", text)


def _add_embedding_loss(
    parameter_sheet: ParameterSheet,
    drawing_options: DrawingOptions,
    clamped_bolt: ClampedBolt,
    height_range: faces.HeightRange | None,
) -> float:
    """Add the preload loss [N] by embedding to the parameter sheet, and return it."""
    if drawing_options["embedding"] is not None:
        stated = parse_quantity("embedding", drawing_options["embedding"])
        parameter_sheet.add_drawing_number("embedding", stated)
        return stated.stated_value
    interfaces = 1 + (clamped_bolt.bolt_washers.washer_count if clamped_bolt.bolt_washers else 0)
    Rz = height_range.Rz if height_range else DEFAULT_ROUGHNESS_HEIGHT_RZ
    depth = vdi2230.embedding_depth(Rz, interfaces, bool(drawing_options["tapped"]))
    loss = depth / (1.0 / clamped_bolt.bolt_stiffness + 1.0 / clamped_bolt.member_stiffness)
    interface_text = {
        1: "one interface",
        2: "two interfaces (plates, washer)",
        3: "three interfaces (plates, two washers)",
    }[interfaces]
    text = (
        f"VDI 2230: {depth * 1e6:.3g} um (Table 5: thread, "
        f"{'head' if drawing_options['tapped'] else 'head and nut'}, {interface_text}, Rz {Rz * 1e6:.2g} "
        f"um{'' if height_range else ', not stated'}, load along the bolt) over delta_S + delta_P"
    )
    parameter_sheet.add_parameter("embedding", loss, "estimate", text)
    return loss


def _compute_friction_results(
    parameter_file: ParameterFile, preload: float
) -> dict[str, tuple[float, str, str]]:
    """Results for the user: gross-slip force and loss factor at the friction coefficient and its range."""
    shear, rows = compute_friction_results(parameter_file, preload)
    slip = "shear force at which the whole interface slips"
    loss = f"loss factor of the interface between rigid sides at {shear:.3g} N of shear"
    facts = {}
    for name, row in zip(("", "_low", "_high"), rows, strict=False):
        text = f"; with mu = {row.friction_coefficient:g}"
        facts[f"slip_force{name}"] = (row.slip_force, "N", slip + text)
        facts[f"loss_factor{name}"] = (row.loss_factor, "1", loss + text)
    return facts


def _compute_preload_range_results(parameter_file: ParameterFile) -> dict[str, tuple[float, str, str]]:
    """Results for the user: stiffness, slip force and opening load at both ends of the preload range.

    The result is empty if the file states no range.
    """
    ends = parameter_file.ranges.get(PRELOAD_ENTRY_NAME)
    if ends is None:
        return {}
    facts = {}
    for result in compute_preload_results(parameter_file):
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


def _compute_interface_share(
    interface_stiffness: float, clamped_bolt: ClampedBolt
) -> dict[str, tuple[float, str, str]]:
    """Result for the user: share of the interface in the compliance of the joint, by VDI 2230.

    Used for joints with rigid sides, whose FMU contains the interface only.

    interface_stiffness : [N/m] normal stiffness of the interface per bolt
    """
    share = clamped_bolt.member_stiffness / (clamped_bolt.member_stiffness + interface_stiffness)
    text = (
        "share of the interface in the compliance along z that it has in series with the members of VDI "
        "2230, loaded at the heads; the members of the FMU are rigid (sides = rigid)"
    )
    return {"interface_share": (share, "1", text)}


def _compute_bed_thickness(bolted_plate: BoltedPlate) -> dict[str, tuple[float, str, str]]:
    """Result for the user: thickness of plate 2 that stands for a bed larger than the plate."""
    thickness = LARGE_BED_THICKNESS_RATIO * float(np.sqrt(bolted_plate.length * bolted_plate.width))
    text = (
        "thickness T2 that gives plate 2 about the stiffness of a large solid bed; another T2 changes all "
        "stiffnesses of the joint, see --thickness and --attached"
    )
    return {"bed_thickness": (thickness, "m", text)}


def _describe_bolt_with_washers(clamped_bolt: ClampedBolt) -> dict[str, tuple[float, str, str]]:
    """Stiffnesses of bolt, washers and members for the user, if the bolt has washers."""
    assert clamped_bolt.bolt_washers
    sizes = clamped_bolt.bolt_washers.describe_washers()
    return {
        "bolt_stiffness": (
            clamped_bolt.bolt_and_washer_stiffness,
            "N/m",
            f"stiffness of one bolt in series with {sizes}: 1/(delta_S + delta_W); 1/delta_S of VDI 2230 is "
            f"{clamped_bolt.bolt_stiffness:.4g} N/m",
        ),
        "washer_stiffness": (1.0 / clamped_bolt.washer_compliance, "N/m", f"stiffness of {sizes}, 1/delta_W"),
        "member_stiffness": (
            clamped_bolt.member_stiffness,
            "N/m",
            "stiffness of the members and washers that one bolt clamps, 1/delta_P of VDI 2230 with delta_W",
        ),
    }


def _compute_design_results(
    parameter_file: ParameterFile,
    clamped_bolt: ClampedBolt,
    height_range: faces.HeightRange | None,
    preload: float,
) -> dict[str, tuple[float, str, str]]:
    """Compute results for the designer: preload, pressures, stiffnesses, load factor, friction."""
    values = parameter_file.values
    state = BoltedJointSpring.from_joint(values).evaluate(preload, 0.0, ZERO_DISPLACEMENT, ZERO_DISPLACEMENT)
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
        **faces.derive_rms_height(parameter_file),
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
    if clamped_bolt.bolt_washers:
        facts |= _describe_bolt_with_washers(clamped_bolt)
    if per_kelvin := preload_at_temperature(values, 0.0, TIGHTENING_TEMPERATURE + 1.0):
        facts["preload_per_kelvin"] = (
            per_kelvin,
            "N/K",
            "change of the preload of each bolt with the temperature of bolts and members, VDI 2230",
        )
    facts |= _compute_friction_results(parameter_file, preload)
    if height_range and height_range.h_max > height_range.h_min and parameter_file.law == "roughness":
        h = float(parameter_file.values_by_name["h"])
        facts["interface_K_zz_low"] = (K * h / height_range.h_max, "N/m", "with the largest of the heights")
        facts["interface_K_zz_high"] = (K * h / height_range.h_min, "N/m", "with the smallest of the heights")
    return {name: fact for name, fact in facts.items() if np.isfinite(fact[0])}
