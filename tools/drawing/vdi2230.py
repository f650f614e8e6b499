"""Bolt and clamped parts as springs, the pressure cone and the preload of a bolt: VDI 2230, part 1.

Concentrically clamped joints with one bolt. Lengths [m], moduli and stresses [Pa], compliances [m/N].
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from . import tables
from .tables import Thread, strength, threads

E_BOLT = 205e9
"""Young's modulus [Pa] of a steel bolt."""
USE = 0.9
"""Part of the yield strength that tightening uses [1]."""
FRICTION = 0.12
"""Coefficient of friction in the thread, without a better one [1]: Table A5, class B."""


def pitch_diameter(thread: Thread) -> float:
    """d_2 [m] (ISO 724)."""
    return thread.d - 0.64952 * thread.pitch


def minor_diameter(thread: Thread) -> float:
    """d_3 [m] (ISO 724)."""
    return thread.d - 1.22687 * thread.pitch


def stress_area(thread: Thread) -> float:
    """A_s [m2] (ISO 898-1)."""
    return 0.0625 * np.pi * (pitch_diameter(thread) + minor_diameter(thread)) ** 2


def bolt_compliance(
    thread: Thread, grip: float, shank: float, head: str, tapped: float | None = None
) -> float:
    """delta_S [m/N] of a bolt: head, shank, free thread, engaged thread and nut (section 5.1.1).

    grip   : l_K between head and nut, or tapped part
    shank  : length without thread in it
    head   : "hexagon" (0.5 d of length) or "socket" (0.4 d)
    tapped : modulus of the part with the thread; None: a nut of the bolt's modulus
    """
    nominal = 0.25 * np.pi * thread.d**2
    minor = 0.25 * np.pi * minor_diameter(thread) ** 2
    length = {"hexagon": 0.5, "socket": 0.4}[head] * thread.d
    nut = 0.4 * thread.d / (E_BOLT * nominal) if tapped is None else 0.33 * thread.d / (tapped * nominal)
    free = grip - shank + 0.5 * thread.d
    return float((length + shank) / (E_BOLT * nominal) + free / (E_BOLT * minor) + nut)


def cone_slope(grip: float, bearing: float, outer: float, tapped: bool) -> float:
    """tan(phi) of the deformation cone [1] (Eqs. 47 and 48): of a through-bolted or a tapped joint.

    bearing : outer diameter d_w under the head; outer: D_A of the parts, at least d_w
    """
    beta, y = grip / bearing, max(outer / bearing, 1.0)
    if tapped:
        return float(0.348 + 0.013 * np.log(beta) + 0.193 * np.log(y))
    return float(0.362 + 0.032 * np.log(0.5 * beta) + 0.153 * np.log(y))


def cone_diameter(height: float, bearing: float, slope: float) -> float:
    """Diameter [m] of a cone at a height [m] below the head."""
    return bearing + 2.0 * height * slope


@dataclass(frozen=True, slots=True)
class ClampedPart:
    """A clamped part: thickness [m] and Young's modulus [Pa]."""

    thickness: float
    E: float


def members_compliance(
    layers: Sequence[ClampedPart], bearing: float, hole: float, outer: float, slope: float, tapped: bool
) -> float:
    """delta_P [m/N] of the clamped parts: cones that widen from the head (and the nut), inside D_A a sleeve.

    Equal to Eqs. 36 and 38 for one modulus; layers from the head on, of a tapped joint up to the thread. From
    D_1 to D_2 a cone has ln[(D_1 + d_h)(D_2 - d_h)/((D_1 - d_h)(D_2 + d_h))]/(pi E d_h tan phi).
    """
    grip = sum(layer.thickness for layer in layers)
    free = max(0.5 * (outer - bearing) / slope, 0.0)
    ends = {0.0, grip, *np.cumsum([layer.thickness for layer in layers]).tolist(), free}
    ends |= set() if tapped else {0.5 * grip, grip - free}
    places = sorted(z for z in ends if 0.0 <= z <= grip)
    total, begins = 0.0, np.cumsum([0.0, *(layer.thickness for layer in layers)])
    for low, high in pairwise(places):
        middle = 0.5 * (low + high)
        E = layers[int(np.searchsorted(begins, middle)) - 1].E
        D = [
            min(cone_diameter(z if tapped else min(z, grip - z), bearing, slope), max(outer, hole * 1.001))
            for z in (low, high)
        ]
        if abs(D[1] - D[0]) < 1e-9 * D[0]:
            total += (high - low) / (E * 0.25 * np.pi * (D[0] ** 2 - hole**2))
        else:
            term = np.log((min(D) + hole) * (max(D) - hole) / ((min(D) - hole) * (max(D) + hole)))
            total += float(term) / (np.pi * E * hole * slope)
    return total


def assembly_preload(thread: Thread, yield_strength: float) -> float:
    """F_M [N] that uses USE of the yield strength under tension and torsion (Table A1), shank bolt."""
    d_2, d_0 = pitch_diameter(thread), 0.5 * (pitch_diameter(thread) + minor_diameter(thread))
    twist = 1.5 * d_2 / d_0 * (thread.pitch / (np.pi * d_2) + 1.155 * FRICTION)
    return float(stress_area(thread) * USE * yield_strength / np.sqrt(1.0 + 3.0 * twist**2))


def embedding(Rz: float, interfaces: int, tapped: bool) -> float:
    """f_Z [m], by which thread, head and nut and the interfaces of the parts come closer (Table 5).

    Rz : of the roughest face [m]; beyond the table its last row
    """
    rows = tables.embedding()
    thread, seat, interface = next((row for most, row in rows if most >= Rz), rows[-1][1])
    return thread + (1 if tapped else 2) * seat + interfaces * interface


def shank_length(thread: Thread, grip: float, head: str, tapped: bool) -> float:
    """Length [m] without thread inside the grip of a bolt that reaches two pitches beyond its nut.

    Length of the thread as in ISO 4014 (2 d + 6 mm) and ISO 4762 (2 d + 12 mm), up to 125 mm of bolt.
    """
    length = grip + (thread.d if tapped else 0.8 * thread.d + 2.0 * thread.pitch)
    return float(np.clip(length - 2.0 * thread.d - {"hexagon": 6e-3, "socket": 12e-3}[head], 0.0, grip))


STRONGEST = "12.9"
"""The strongest property class of ISO 898-1."""


def proof_load(hole: float) -> tuple[float, str] | None:
    """Proof load [N] of the largest bolt that passes a hole [m], and what that is; None if none is known."""
    fitting = [thread for thread in threads().values() if thread.d < hole]
    largest = max(threads().values(), key=lambda thread: thread.d)
    if not fitting or hole > 1.2 * largest.d:
        return None
    bolt = max(fitting, key=lambda thread: thread.d)
    load = strength(STRONGEST, "proof", bolt) * stress_area(bolt)
    name = f"{bolt.name}, class {STRONGEST} (ISO 898-1)"
    return load, f"the proof load of {name}, the largest bolt that passes the hole"
