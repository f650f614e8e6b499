"""Compliance of bolt and clamped parts, deformation cone, preload, torque, embedding: VDI 2230, part 1.

The equations are valid for concentrically clamped joints with one bolt. Lengths are in m, moduli and stresses
in Pa, compliances in m/N.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from . import tables
from .tables import Thread, Washer, find_thread, property_class_strength, read_threads

E_BOLT = 205e9
"""Young's modulus [Pa] of a steel bolt."""
E_WASHER = E_BOLT
"""Young's modulus [Pa] of a steel washer."""
YIELD_UTILISATION = 0.9
"""Share of the yield strength that is used during tightening [1]."""
DEFAULT_BOLT_FRICTION, BOLT_FRICTION_INTERVAL = 0.12, (0.08, 0.16)
"""Coefficient of friction [1] in the thread and under the head if none is known, and its interval: Table A5,
friction class B."""
RZ_ROUNDING_TOLERANCE = 1e-6
"""Relative excess of Rz over Rz of a table row [1] that is ignored: 10 um belong to the row of 10 um."""
BOLT_FRICTION_SOURCE = "VDI 2230, Table A5, friction class B"
"""Source text of the coefficients of friction in thread and under head."""
MAX_YIELD_UTILISATION_EXCESS = 0.02
"""Relative excess [1] over YIELD_UTILISATION that counts as none: Table A1 prints torques with two digits."""


def pitch_diameter(thread: Thread) -> float:
    """Pitch diameter d_2 [m] of a metric thread (ISO 724)."""
    return thread.nominal_diameter - 0.64952 * thread.pitch


def minor_diameter(thread: Thread) -> float:
    """Minor diameter d_3 [m] of a metric thread (ISO 724)."""
    return thread.nominal_diameter - 1.22687 * thread.pitch


def stress_area(thread: Thread) -> float:
    """Tensile stress area A_s [m2] of a metric thread (ISO 898-1)."""
    return 0.0625 * np.pi * (pitch_diameter(thread) + minor_diameter(thread)) ** 2


def bolt_compliance(
    thread: Thread,
    grip_length: float,
    unthreaded_length: float,
    head_type: str,
    thread_modulus: float | None = None,
) -> float:
    """Compliance delta_S [m/N] of a bolt: head, shank, free thread, engaged thread and nut (section 5.1.1).

    grip_length       : clamping length l_K [m] between head and nut, or between head and tapped part
    unthreaded_length : length of the shank without thread [m]
    head_type         : "hexagon" (effective length 0.5 d) or "socket" (0.4 d)
    thread_modulus    : Young's modulus [Pa] of a tapped part; None: a nut with the modulus of the bolt
    """
    nominal = 0.25 * np.pi * thread.nominal_diameter**2
    minor = 0.25 * np.pi * minor_diameter(thread) ** 2
    length = {"hexagon": 0.5, "socket": 0.4}[head_type] * thread.nominal_diameter
    nut = (
        0.4 * thread.nominal_diameter / (E_BOLT * nominal)
        if thread_modulus is None
        else 0.33 * thread.nominal_diameter / (thread_modulus * nominal)
    )
    free = grip_length - unthreaded_length + 0.5 * thread.nominal_diameter
    return float((length + unthreaded_length) / (E_BOLT * nominal) + free / (E_BOLT * minor) + nut)


def cone_slope(grip_length: float, bearing_diameter: float, outer_diameter: float, is_tapped: bool) -> float:
    """tan(phi) [1] of the deformation cone of a through-bolted or a tapped joint (Eqs. 47 and 48).

    bearing_diameter : outer diameter d_w of the bearing face under the head [m]
    outer_diameter   : diameter D_A of the clamped parts [m], at least d_w
    """
    beta, y = grip_length / bearing_diameter, max(outer_diameter / bearing_diameter, 1.0)
    if is_tapped:
        return float(0.348 + 0.013 * np.log(beta) + 0.193 * np.log(y))
    return float(0.362 + 0.032 * np.log(0.5 * beta) + 0.153 * np.log(y))


def cone_diameter(depth_below_head: float, bearing_diameter: float, tan_phi: float) -> float:
    """Diameter [m] of the deformation cone at a distance [m] below the head."""
    return bearing_diameter + 2.0 * depth_below_head * tan_phi


def washer_cone_diameter(bearing_diameter: float, washer: Washer, tan_phi: float) -> float:
    """Diameter [m] of the deformation cone below a washer, at most the outer diameter of the washer.

    bearing_diameter : outer diameter d_w of the bearing face under the head [m]
    """
    return min(cone_diameter(washer.thickness, bearing_diameter, tan_phi), washer.outer_diameter)


@dataclass(frozen=True, slots=True)
class ClampedPart:
    """A clamped part: thickness [m] and Young's modulus [Pa]."""

    thickness: float
    E: float


def members_compliance(
    clamped_parts: Sequence[ClampedPart],
    bearing_diameter: float,
    hole_diameter: float,
    outer_diameter: float,
    tan_phi: float,
    is_tapped: bool,
) -> float:
    """Compliance delta_P [m/N] of the clamped parts: deformation cones, and a sleeve of diameter D_A.

    clamped_parts : clamped parts, starting at the head; of a tapped joint up to the thread

    A cone widens from the head, and one from the nut. If all parts have the same Young's modulus E, the
    result equals Eqs. 36 and 38 of VDI 2230. A
    section of a cone from diameter D_1 to D_2 around a hole d_h has the compliance
    ln[(D_1 + d_h)(D_2 - d_h)/((D_1 - d_h)(D_2 + d_h))]/(pi E d_h tan phi).
    """
    grip = sum(layer.thickness for layer in clamped_parts)
    free = max(0.5 * (outer_diameter - bearing_diameter) / tan_phi, 0.0)
    ends = {0.0, grip, *np.cumsum([layer.thickness for layer in clamped_parts]).tolist(), free}
    ends |= set() if is_tapped else {0.5 * grip, grip - free}
    heights = sorted(z for z in ends if 0.0 <= z <= grip)
    total, layer_starts = 0.0, np.cumsum([0.0, *(layer.thickness for layer in clamped_parts)])
    for low, high in pairwise(heights):
        middle = 0.5 * (low + high)
        E = clamped_parts[int(np.searchsorted(layer_starts, middle)) - 1].E
        D = [
            min(
                cone_diameter(z if is_tapped else min(z, grip - z), bearing_diameter, tan_phi),
                max(outer_diameter, hole_diameter * 1.001),
            )
            for z in (low, high)
        ]
        if abs(D[1] - D[0]) < 1e-9 * D[0]:
            total += (high - low) / (E * 0.25 * np.pi * (D[0] ** 2 - hole_diameter**2))
        else:
            term = np.log(
                (min(D) + hole_diameter)
                * (max(D) - hole_diameter)
                / ((min(D) - hole_diameter) * (max(D) + hole_diameter))
            )
            total += float(term) / (np.pi * E * hole_diameter * tan_phi)
    return total


def washer_compliance(bearing_diameter: float, washer: Washer, tan_phi: float) -> float:
    """Compliance [m/N] of a steel washer: deformation cone from the head, cut off at the washer's diameter.

    bearing_diameter : outer diameter d_w of the bearing face under the head [m]
    """
    layers = [ClampedPart(washer.thickness, E_WASHER)]
    sizes = (bearing_diameter, washer.hole_diameter, washer.outer_diameter)
    return members_compliance(layers, *sizes, tan_phi, is_tapped=True)


def comparative_stress(
    thread: Thread, preload: float, thread_friction: float = DEFAULT_BOLT_FRICTION
) -> float:
    """Comparative stress sigma_red,M [Pa] of a shank bolt in tightening: von Mises, tension and torsion.

    preload         : assembly preload F_M [N]
    thread_friction : coefficient of friction mu_G in the thread [1]

    The torsion section is fully plastic, W_P = pi d_0^3/12, as in Table A1.
    """
    d_2, d_0 = pitch_diameter(thread), 0.5 * (pitch_diameter(thread) + minor_diameter(thread))
    torsion = 1.5 * d_2 / d_0 * (thread.pitch / (np.pi * d_2) + 1.155 * thread_friction)
    return float(preload / stress_area(thread) * np.sqrt(1.0 + 3.0 * torsion**2))


def assembly_preload(
    thread: Thread, yield_strength: float, thread_friction: float = DEFAULT_BOLT_FRICTION
) -> float:
    """Assembly preload F_M [N] of a shank bolt (Table A1).

    Tension and torsion together use the share YIELD_UTILISATION of the yield strength.
    """
    return YIELD_UTILISATION * yield_strength / comparative_stress(thread, 1.0, thread_friction)


def head_friction_diameter(bearing_diameter: float, hole_diameter: float) -> float:
    """Mean friction diameter D_Km [m] of the bearing face under the head: (d_w + d_h)/2."""
    return 0.5 * (bearing_diameter + hole_diameter)


def torque_per_preload(
    pitch: float,
    pitch_diameter: float,
    head_friction_diameter: float,
    thread_friction: float,
    head_friction: float,
) -> float:
    """Tightening torque per preload M_A/F_M [m]: 0.16 P + 0.58 d_2 mu_G + D_Km mu_K/2 (section 5.4.3).

    pitch                  : P [m]
    pitch_diameter         : d_2 [m]
    head_friction_diameter : D_Km [m]
    thread_friction        : mu_G [1]
    head_friction          : mu_K [1]
    """
    return (
        0.16 * pitch + 0.58 * pitch_diameter * thread_friction + 0.5 * head_friction_diameter * head_friction
    )


def preload_scatter(tightening_factor: float) -> float:
    """Relative scatter [1] of the preload about its mean, from alpha_A = F_Mmax/F_Mmin (Table A8)."""
    return (tightening_factor - 1.0) / (tightening_factor + 1.0)


def embedding_depth(Rz: float, interface_count: int, is_tapped: bool) -> float:
    """Embedding f_Z [m]: loss of length in the thread, under head and nut, and in the interfaces (Table 5).

    Rz              : maximum height of the roughest face [m]; above the table its last row holds
    interface_count : number of interfaces between clamped parts
    """
    rows = tables.read_embedding()
    thread, seat, interface = next(
        (row for limit, row in rows if limit * (1.0 + RZ_ROUNDING_TOLERANCE) >= Rz), rows[-1][1]
    )
    return thread + (1 if is_tapped else 2) * seat + interface_count * interface


def unthreaded_shank_length(thread: Thread, grip_length: float, head_type: str, is_tapped: bool) -> float:
    """Length [m] of the shank without thread inside the grip; the bolt ends two pitches beyond its nut.

    The thread length is that of ISO 4014 (2 d + 6 mm) and ISO 4762 (2 d + 12 mm), for bolts up to 125 mm.
    """
    length = grip_length + (
        thread.nominal_diameter if is_tapped else 0.8 * thread.nominal_diameter + 2.0 * thread.pitch
    )
    return float(
        np.clip(
            length - 2.0 * thread.nominal_diameter - {"hexagon": 6e-3, "socket": 12e-3}[head_type],
            0.0,
            grip_length,
        )
    )


STRONGEST_PROPERTY_CLASS = "12.9"
"""The strongest property class of ISO 898-1."""


def describe_stated_bolt(thread_name: str, property_class: str) -> str:
    """Text with thread and property class of the bolt that the user states, for the source of a preload."""
    return f"bolts {thread_name}-{property_class} as stated"


def proof_load(hole_diameter: float, preload_source: str = "") -> tuple[float, str] | None:
    """Proof load [N] of the bolt that the source text of a preload names, and the name of this load.

    If the text names no bolt: proof load of the largest bolt that fits through the hole, in the strongest
    property class. None if no bolt of the tables fits.

    hole_diameter  : [m] of the clearance hole
    preload_source : source text of the preload in a parameter file
    """
    threads = read_threads()
    stated = re.search(
        describe_stated_bolt(r"(M[\d.]+)(?:x([\d.]+))?", r"(8\.8|10\.9|12\.9)"), preload_source
    )
    if stated and stated[1] in threads:
        bolt = find_thread(stated[1], float(stated[2]) * 1e-3 if stated[2] else None)
        load = property_class_strength(stated[3], "proof", bolt) * stress_area(bolt)
        return load, f"the proof load of {bolt.thread_name}-{stated[3]} (ISO 898-1)"
    fitting = [thread for thread in threads.values() if thread.nominal_diameter < hole_diameter]
    largest = max(threads.values(), key=lambda thread: thread.nominal_diameter)
    if not fitting or hole_diameter > 1.2 * largest.nominal_diameter:
        return None
    bolt = max(fitting, key=lambda thread: thread.nominal_diameter)
    load = property_class_strength(STRONGEST_PROPERTY_CLASS, "proof", bolt) * stress_area(bolt)
    name = f"{bolt.thread_name}, class {STRONGEST_PROPERTY_CLASS} (ISO 898-1)"
    return load, f"the proof load of {name}, the largest bolt that passes the hole"
