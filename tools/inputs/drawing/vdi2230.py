"""Compliance of bolt and clamped parts, deformation cone, assembly preload, embedding: VDI 2230, part 1.

Valid for concentrically clamped joints with one bolt. Lengths in m, moduli and stresses in Pa, compliances
in m/N.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from . import tables
from .tables import Thread, property_class_strength, read_threads

E_BOLT = 205e9
"""Young's modulus [Pa] of a steel bolt."""
YIELD_UTILISATION = 0.9
"""Share of the yield strength that is used during tightening [1]."""
THREAD_FRICTION = 0.12
"""Default coefficient of friction in the thread [1]: Table A5, class B."""


def pitch_diameter(thread: Thread) -> float:
    """Pitch diameter d_2 [m] (ISO 724)."""
    return thread.d - 0.64952 * thread.pitch


def minor_diameter(thread: Thread) -> float:
    """Minor diameter d_3 [m] (ISO 724)."""
    return thread.d - 1.22687 * thread.pitch


def stress_area(thread: Thread) -> float:
    """Stress area A_s [m2] (ISO 898-1)."""
    return 0.0625 * np.pi * (pitch_diameter(thread) + minor_diameter(thread)) ** 2


def bolt_compliance(
    thread: Thread, grip: float, shank: float, head: str, thread_modulus: float | None = None
) -> float:
    """Compliance delta_S [m/N] of a bolt: head, shank, free thread, engaged thread and nut (section 5.1.1).

    grip           : clamping length l_K [m] between head and nut, or between head and tapped part
    shank          : length of the shank without thread [m]
    head           : "hexagon" (effective length 0.5 d) or "socket" (0.4 d)
    thread_modulus : Young's modulus [Pa] of a tapped part; None: a nut with the modulus of the bolt
    """
    nominal = 0.25 * np.pi * thread.d**2
    minor = 0.25 * np.pi * minor_diameter(thread) ** 2
    length = {"hexagon": 0.5, "socket": 0.4}[head] * thread.d
    nut = (
        0.4 * thread.d / (E_BOLT * nominal)
        if thread_modulus is None
        else 0.33 * thread.d / (thread_modulus * nominal)
    )
    free = grip - shank + 0.5 * thread.d
    return float((length + shank) / (E_BOLT * nominal) + free / (E_BOLT * minor) + nut)


def cone_slope(grip: float, bearing_diameter: float, outer_diameter: float, is_tapped: bool) -> float:
    """tan(phi) [1] of the deformation cone of a through-bolted or a tapped joint (Eqs. 47 and 48).

    bearing_diameter : outer diameter d_w of the bearing face under the head [m]
    outer_diameter   : diameter D_A of the clamped parts [m], at least d_w
    """
    beta, y = grip / bearing_diameter, max(outer_diameter / bearing_diameter, 1.0)
    if is_tapped:
        return float(0.348 + 0.013 * np.log(beta) + 0.193 * np.log(y))
    return float(0.362 + 0.032 * np.log(0.5 * beta) + 0.153 * np.log(y))


def cone_diameter(depth: float, bearing_diameter: float, slope: float) -> float:
    """Diameter [m] of the deformation cone at a distance [m] below the head."""
    return bearing_diameter + 2.0 * depth * slope


@dataclass(frozen=True, slots=True)
class ClampedPart:
    """A clamped part: thickness [m] and Young's modulus [Pa]."""

    thickness: float
    E: float


def members_compliance(
    layers: Sequence[ClampedPart],
    bearing_diameter: float,
    hole_diameter: float,
    outer_diameter: float,
    slope: float,
    is_tapped: bool,
) -> float:
    """Compliance delta_P [m/N] of the clamped parts: deformation cones, and a sleeve beyond diameter D_A.

    layers : clamped parts, starting at the head; of a tapped joint up to the thread

    A cone widens from the head, and one from the nut. For one modulus the result equals Eqs. 36 and 38. A
    section of a cone from diameter D_1 to D_2 around a hole d_h has the compliance
    ln[(D_1 + d_h)(D_2 - d_h)/((D_1 - d_h)(D_2 + d_h))]/(pi E d_h tan phi).
    """
    grip = sum(layer.thickness for layer in layers)
    free = max(0.5 * (outer_diameter - bearing_diameter) / slope, 0.0)
    ends = {0.0, grip, *np.cumsum([layer.thickness for layer in layers]).tolist(), free}
    ends |= set() if is_tapped else {0.5 * grip, grip - free}
    heights = sorted(z for z in ends if 0.0 <= z <= grip)
    total, layer_starts = 0.0, np.cumsum([0.0, *(layer.thickness for layer in layers)])
    for low, high in pairwise(heights):
        middle = 0.5 * (low + high)
        E = layers[int(np.searchsorted(layer_starts, middle)) - 1].E
        D = [
            min(
                cone_diameter(z if is_tapped else min(z, grip - z), bearing_diameter, slope),
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
            total += float(term) / (np.pi * E * hole_diameter * slope)
    return total


def assembly_preload(thread: Thread, yield_strength: float) -> float:
    """Assembly preload F_M [N] of a shank bolt (Table A1).

    Tension and torsion together use the share YIELD_UTILISATION of the yield strength.
    """
    d_2, d_0 = pitch_diameter(thread), 0.5 * (pitch_diameter(thread) + minor_diameter(thread))
    twist = 1.5 * d_2 / d_0 * (thread.pitch / (np.pi * d_2) + 1.155 * THREAD_FRICTION)
    return float(stress_area(thread) * YIELD_UTILISATION * yield_strength / np.sqrt(1.0 + 3.0 * twist**2))


def embedding_depth(Rz: float, interface_count: int, is_tapped: bool) -> float:
    """Embedding f_Z [m]: loss of length in the thread, under head and nut, and in the interfaces (Table 5).

    Rz              : maximum height of the roughest face [m]; above the table its last row holds
    interface_count : number of interfaces between clamped parts
    """
    rows = tables.read_embedding()
    thread, seat, interface = next((row for limit, row in rows if limit >= Rz), rows[-1][1])
    return thread + (1 if is_tapped else 2) * seat + interface_count * interface


def shank_length(thread: Thread, grip: float, head: str, is_tapped: bool) -> float:
    """Length [m] of the shank without thread inside the grip; the bolt ends two pitches beyond its nut.

    The thread length is that of ISO 4014 (2 d + 6 mm) and ISO 4762 (2 d + 12 mm), for bolts up to 125 mm.
    """
    length = grip + (thread.d if is_tapped else 0.8 * thread.d + 2.0 * thread.pitch)
    return float(np.clip(length - 2.0 * thread.d - {"hexagon": 6e-3, "socket": 12e-3}[head], 0.0, grip))


STRONGEST_CLASS = "12.9"
"""The strongest property class of ISO 898-1."""


def proof_load(hole_diameter: float) -> tuple[float, str] | None:
    """Proof load [N] of the largest bolt that passes a hole [m], and its description.

    None if no bolt of the tables fits the hole.
    """
    fitting = [thread for thread in read_threads().values() if thread.d < hole_diameter]
    largest = max(read_threads().values(), key=lambda thread: thread.d)
    if not fitting or hole_diameter > 1.2 * largest.d:
        return None
    bolt = max(fitting, key=lambda thread: thread.d)
    load = property_class_strength(STRONGEST_CLASS, "proof", bolt) * stress_area(bolt)
    name = f"{bolt.name}, class {STRONGEST_CLASS} (ISO 898-1)"
    return load, f"the proof load of {name}, the largest bolt that passes the hole"
