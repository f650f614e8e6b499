"""Parameters of a bolted joint from the drawing of its plates."""

from dataclasses import dataclass

import numpy as np

from jointfmu.joints.bolted_joint import KIND
from jointfmu.joints.bolted_joint.spring import BoltedJointSpring
from jointfmu.mechanics.footprint.plate import BoltedPlate
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array

from ....drawing import faces, vdi2230
from ....drawing.part import Given, NewJoint, Sheet
from ....drawing.reading import number, numbers
from ....drawing.tables import Thread, strength, thread_source
from ....pressure import overload
from ..report import friction_band
from . import computed, layout
from .computed import Plates, with_computed_field

REST = (0.0, 0.0, 0.0)
"""Zero displacement [m] or rotation [rad] along x, y, z."""
SAME = 1e-6
"""Relative difference [1] allowed between the grip and the sum of the thicknesses."""
LONGEST = 50
"""Largest grip over the diameter of the thread [1]: a longer bolt is a tie rod."""
ENGAGED = 1.0
"""Depth of a tapped thread over its diameter [1]: a usual value in steel."""


@dataclass(frozen=True, slots=True)
class Clamped:
    """One bolt with the parts that it clamps, by VDI 2230.

    grip             : [m] clamped length between head and nut, or between head and tapped thread
    layers           : clamped parts, thickness and modulus
    hole_diameter    : [m]
    bearing_diameter : [m] of the surface under head or nut
    outer_diameter   : [m] D_A of the clamped parts
    cone_slope       : tan(phi) of the deformation cone [1]
    cone_diameter    : [m] of the deformation cone at the interface
    bolt_stiffness   : [N/m] 1/delta_S
    member_stiffness : [N/m] 1/delta_P
    """

    grip: float
    layers: tuple[vdi2230.ClampedPart, ...]
    hole: float
    bearing: float
    outer: float
    slope: float
    cone: float
    bolt: float
    members: float


def joint(given: Given) -> NewJoint:
    """Make the parameters of a bolted joint from the options of a drawing.

    Raises ValueError with a one-line message for options that are invalid or contradict each other.
    """
    length, width = numbers("plate", given["plate"], "mm", "m", by="x", count=2)
    count, thread = layout.bolts(given["bolts"])
    positions = layout.positions(given, count)
    law = given["law"] or "roughness"
    sheet = Sheet(KIND.name, law)
    heights = faces.put(sheet, given)
    hole, hole_source = _hole(given, thread)
    moduli = (sheet.value("side1.E"), sheet.value("side2.E"))
    for name, value in (("field", "computed"), ("sides", "elastic"), ("attached", given["attached"])):
        if given["tapped"] and given["thickness"] is None and value and given[name] == value:
            raise ValueError(f"--{name} {value} beside --tapped: expected --thickness of both plates for it")
    bolt = clamped(given, thread, (length, width), positions, hole, moduli)
    plate = BoltedPlate(
        length=length,
        width=width,
        x=tuple(positions[:, 0].tolist()),
        y=tuple(positions[:, 1].tolist()),
        hole_diameter=hole,
        cone_diameter=bolt.cone,
    )
    _put_plate(sheet, plate, bolt, hole_source)
    _put_bolts(sheet, plate, bolt, thread)
    loss = _embedding(sheet, given, bolt, heights)
    mass = plate.area * bolt.layers[0].thickness * faces.materials(given)[0].numbers["density"].value
    sheet.put("mass", mass, "estimate", "mass of the plate of side 1; what vibrates")
    preload, warnings = _preload(sheet, given, thread)
    if not loss < preload:
        raise ValueError(
            f"embedding takes {loss:.4g} N of a preload of {preload:.4g} N: expected less than all; state "
            "--embedding or more --preload"
        )
    for choice in ("critical_area", "spot_stiffness"):
        default = {"critical_area": "continuity", "spot_stiffness": "hertz"}[choice]
        sheet.put(choice, default, "estimate", "nearest to the roughness of the surfaces, docs/validity.md")
    file = sheet.file(f"plate {given['plate']} with {given['bolts']}")
    density = tuple(material.numbers["density"].value for material in faces.materials(given))
    layers, depth = bolt.layers, 0.0
    if given["tapped"] and given["thickness"] is not None:
        layers, depth = (*layers, vdi2230.ClampedPart(_each(given)[1], moduli[1])), ENGAGED * thread.d
    plates = Plates(plate, layers, bolt.bearing, density, preload, preload - loss, depth)
    shape = None
    if given["field"] == "computed":
        file, shape = with_computed_field(file, plates)
    facts = _facts(file, bolt, heights, preload)
    alone = _alone(facts["K_zz"][0] / count, bolt)
    if given["tapped"] and given["thickness"] is None:
        return NewJoint(
            file, facts, [*warnings, f"{alone}: for the whole joint state --thickness of both plates"]
        )
    attached, sides = given["attached"] or "faces", given["sides"]
    complete_joint = computed.facts(file, plates, attached, sides, alone, shape)
    return NewJoint(
        complete_joint.file, {**facts, **complete_joint.facts}, [*warnings, *complete_joint.warnings]
    )


def _hole(given: Given, thread: Thread) -> tuple[float, tuple[str, str]]:
    if given["hole"] is None:
        return thread.hole, ("published", f"{thread_source('hole')} for {thread.name}")
    return number("hole", given["hole"], "mm", "m"), ("user", "stated on the drawing")


def clamped(
    given: Given,
    thread: Thread,
    size: tuple[float, float],
    at: Array,
    hole: float,
    moduli: tuple[float, float],
) -> Clamped:
    """Compute one bolt with its clamped parts by VDI 2230.

    size      : length and width of the plate [m]
    positions : (b, 2) [m] of the bolts
    hole      : diameter [m]
    moduli    : Young's moduli [Pa] of side 1 and side 2

    Raises ValueError for thicknesses or diameters that contradict each other.
    """
    head, tapped = given["head"] or "hexagon", bool(given["tapped"])
    bearing = getattr(thread, head)
    if given["bearing"] is not None:
        bearing = number("bearing", given["bearing"], "mm", "m")
    for name, value, low in (("hole", hole, thread.d), ("bearing", bearing, hole)):
        if not value > low:
            raise ValueError(f"--{name} = {value * 1e3:g} mm is outside ({low * 1e3:g}, inf) mm")
    thicknesses = _thicknesses(given)
    if len(thicknesses) > (1 if tapped else 2):
        expected = "that of side 1" if tapped else "both plates together, or each"
        raise ValueError(f"--grip has {len(thicknesses)} values, expected {expected}")
    if tapped:
        layers: tuple[vdi2230.ClampedPart, ...] = (vdi2230.ClampedPart(thicknesses[0], moduli[0]),)
    else:
        pair = thicknesses if len(thicknesses) == 2 else [0.5 * thicknesses[0]] * 2
        layers = tuple(vdi2230.ClampedPart(t, E) for t, E in zip(pair, moduli, strict=True))
    grip = float(sum(layer.thickness for layer in layers))
    if grip > LONGEST * thread.d:
        longest_grip = LONGEST * thread.d * 1e3
        raise ValueError(
            f"--grip = {grip * 1e3:g} mm is outside (0, {longest_grip:g}] mm: {LONGEST} times {thread.name}"
        )
    outer = outer_diameter(size, at)
    slope = vdi2230.cone_slope(grip, bearing, outer, tapped)
    if not slope > 0.0:
        raise ValueError(f"--grip = {grip * 1e3:g} mm is too short for a deformation cone of VDI 2230")
    shank = vdi2230.shank_length(thread, grip, head, tapped)
    delta_S = vdi2230.bolt_compliance(thread, grip, shank, head, moduli[1] if tapped else None)
    delta_P = vdi2230.members_compliance(layers, bearing, hole, outer, slope, tapped)
    cone = vdi2230.cone_diameter(min(layer.thickness for layer in layers), bearing, slope)
    return Clamped(grip, layers, hole, bearing, outer, slope, cone, 1.0 / delta_S, 1.0 / delta_P)


def _thicknesses(given: Given) -> list[float]:
    """Thickness [m] of each plate, or one value for both plates together."""
    grip = [number("grip", text, "mm", "m") for text in given["grip"]]
    if given["thickness"] is None:
        return grip
    plates = _each(given)
    if given["tapped"]:
        if abs(plates[0] - sum(grip)) > SAME * plates[0]:
            raise ValueError(
                f"--thickness = {plates[0] * 1e3:g} mm of side 1 contradicts --grip = {sum(grip) * 1e3:g} mm"
                ": expected the same, the thread is in side 2"
            )
        return grip
    if abs(sum(plates) - sum(grip)) > SAME * sum(grip):
        raise ValueError(
            f"--thickness = {plates[0] * 1e3:g} and {plates[1] * 1e3:g} mm contradicts --grip = "
            f"{sum(grip) * 1e3:g} mm: expected their sum"
        )
    return plates


def _each(given: Given) -> list[float]:
    thicknesses = [number("thickness", text, "mm", "m") for text in given["thickness"]]
    if len(thicknesses) != 2:
        raise ValueError(f"--thickness has {len(thicknesses)} values, expected that of each plate")
    return thicknesses


def outer_diameter(size: tuple[float, float], at: Array) -> float:
    """Outer diameter D_A [m] of the clamped parts, mean over the bolts.

    For each bolt: twice the distance to the nearest edge, or the distance to the next bolt if this is
    smaller.

    Raises ValueError for a bolt outside the plate.
    """
    edge = np.min(np.array(size) - 2.0 * np.abs(at), axis=1)
    if np.min(edge) <= 0.0:
        i = int(np.argmin(edge))
        x, y = at[i] * 1e3
        raise ValueError(f"bolt {i + 1} at ({x:g}, {y:g}) mm leaves the plate")
    distance = np.hypot(*np.moveaxis(at[:, None, :] - at, -1, 0)) + np.diag(np.full(len(at), np.inf))
    return float(np.mean(np.minimum(edge, np.min(distance, axis=1))))


def _put_plate(sheet: Sheet, plate: BoltedPlate, one: Clamped, hole_source: tuple[str, str]) -> None:
    for name in ("length", "width", "x", "y"):
        sheet.stated(f"plate.{name}", getattr(plate, name))
    sheet.put("plate.hole_diameter", plate.hole_diameter, *hole_source)
    cone = (
        f"VDI 2230, cone from d_w = {one.bearing * 1e3:g} mm over "
        f"{min(layer.thickness for layer in one.layers) * 1e3:g} mm with tan(phi) = {one.slope:.4g}"
    )
    sheet.put("plate.cone_diameter", plate.cone_diameter, "derived", cone)
    sheet.put("A_0", plate.area, "derived", "the plate without its holes")


def _put_bolts(sheet: Sheet, plate: BoltedPlate, one: Clamped, thread: Thread) -> None:
    row_bolts, row_distance = plate.rows
    rows = "the places of the bolts: two rows that would carry a moment about x as they do"
    sheet.put("n_bolts", float(len(plate.x)), "user", "stated on the drawing")
    sheet.put("row_bolts", row_bolts, "derived", rows)
    sheet.put("row_distance", row_distance, "derived", rows)
    text = f"VDI 2230, 1/delta_S of {thread.name} over {one.grip * 1e3:g} mm of grip"
    sheet.put("bolt_stiffness", one.bolt, "derived", text)


def _preload(sheet: Sheet, given: Given, thread: Thread) -> tuple[float, list[str]]:
    """Add the preload [N] to the sheet.

    Returns the preload, and a warning if it exceeds the proof load of the bolt.
    """
    name = given["property_class"] or "8.8"
    if given["preload"] is None:
        preload = vdi2230.assembly_preload(thread, strength(name, "yield", thread))
        text = f"VDI 2230, Table A1: {thread.name}-{name}, 90 % of the yield strength, mu_G = 0.12"
        sheet.put("inputs.preload", preload, "estimate", text)
    else:
        preload = number("preload", given["preload"], "N", "N")
        sheet.stated("inputs.preload", preload)
    if given["property_class"] is None:
        return preload, []
    proof_load = strength(name, "proof", thread) * vdi2230.stress_area(thread)
    return preload, overload(
        "preload", preload, (proof_load, f"the proof load of {thread.name}-{name} (ISO 898-1)")
    )


def _embedding(sheet: Sheet, given: Given, one: Clamped, heights: faces.Heights) -> float:
    """Add the preload loss [N] by embedding to the sheet, and return it."""
    if given["embedding"] is not None:
        loss = number("embedding", given["embedding"], "N", "N", None)
        sheet.stated("embedding", loss)
        return loss
    depth = vdi2230.embedding(heights.Rz, 1, bool(given["tapped"]))
    loss = depth / (1.0 / one.bolt + 1.0 / one.members)
    text = (
        f"VDI 2230: {depth * 1e6:.3g} um (Table 5: thread, {'head' if given['tapped'] else 'head and nut'}, "
        f"one interface, Rz {heights.Rz * 1e6:.2g} um, load along the bolt) over delta_S + delta_P"
    )
    sheet.put("embedding", loss, "estimate", text)
    return loss


def _friction(file: ParameterFile, preload: float) -> dict[str, tuple[float, str, str]]:
    """Facts about friction: gross-slip force and loss factor, at mu and at both ends of its range."""
    shear, rows = friction_band(file, preload)
    slip = "shear force at which the whole interface slips"
    loss = f"loss factor of the interface between rigid sides at {shear:.3g} N of shear"
    facts = {}
    for name, row in zip(("", "_low", "_high"), rows, strict=False):
        text = f"; with mu = {row.mu:g}"
        facts[f"slip_force{name}"] = (row.slip_force, "N", slip + text)
        facts[f"loss_factor{name}"] = (row.loss_factor, "1", loss + text)
    return facts


def _alone(interface: float, one: Clamped) -> str:
    """Warning that the FMU contains the interface only, with its share of the compliance.

    interface_stiffness : [N/m] normal stiffness of the interface per bolt
    """
    share = one.members / (one.members + interface)
    return (
        f"the FMU is the interface alone ({share:.1%} of the compliance along z that it has in series with "
        "the members of VDI 2230, loaded at the heads)"
    )


def _facts(
    file: ParameterFile, one: Clamped, heights: faces.Heights, preload: float
) -> dict[str, tuple[float, str, str]]:
    """Facts for the designer: preload, pressures, stiffnesses, load factor, friction."""
    values = file.values
    state = BoltedJointSpring.of(values).motion(preload, 0.0, REST, REST)
    bolts = values.n_bolts * one.bolt
    K = float(state["K_zz"]) - bolts
    facts = {
        "preload": (preload, "N", "force of each bolt as it is tightened"),
        "embedding": (
            values.embedding,
            "N",
            f"preload lost by embedding ({values.embedding / preload:.1%}); stiffness and slip are those of "
            "the remaining preload",
        ),
        "p_mean": (float(state["p_mean"]), "Pa", "mean pressure on the plate"),
        "p_max": (float(state["p_max"]), "Pa", "largest pressure, near a bolt"),
        "h": (float(file.flat.get("h", np.nan)), "m", "combined rms height of both faces"),
        "K_zz": (K, "N/m", "normal stiffness of the interface at this preload, without the bolts"),
        "K_xx": (float(state["K_xx"]), "N/m", "tangential stiffness of the interface"),
        "bolt_stiffness": (one.bolt, "N/m", "of one bolt, 1/delta_S of VDI 2230"),
        "member_stiffness": (one.members, "N/m", "of the parts that one bolt clamps, 1/delta_P of VDI 2230"),
        "load_factor": (
            one.bolt / (one.bolt + one.members),
            "1",
            "Phi_K = delta_P/(delta_S + delta_P): share of an external force that the bolts carry",
        ),
    }
    facts |= _friction(file, preload)
    if heights.high > heights.low and file.law == "roughness":
        h = float(file.flat["h"])
        facts["K_zz_low"] = (K * h / heights.high, "N/m", "with the roughest usual finish")
        facts["K_zz_high"] = (K * h / heights.low, "N/m", "with the finest usual finish")
    return {name: fact for name, fact in facts.items() if np.isfinite(fact[0])}
