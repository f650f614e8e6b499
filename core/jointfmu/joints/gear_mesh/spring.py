"""Gear mesh: stiffness of rough flanks and of bending teeth in series, for each tooth pair in contact."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from ...contact.laws.roughness import RoughnessLaw
from ...contact.laws.table import TableLaw
from ...contact.laws.yu2022 import Yu2022
from ...mechanics.curve import Curve, assemble_curve, refine_curve, tabulate_approach
from ...mechanics.stable_steps import largest_stable_steps, mobility
from ...quantity import Array, Number, quantity_field, smooth_step, smooth_step_integral, smooth_step_slopes

CONTACT_CLOSING_STEPS = 96
"""Steps [1] of a tooth pair's table while the contact closes; doubled until the table is accurate."""


@dataclass(frozen=True, kw_only=True)
class GearWheelParameters:
    """Geometry, inertia, damping and tooth stiffness of the two wheels."""

    r_b1: float = quantity_field("m", "base radius of wheel 1", gt=0.0)
    r_b2: float = quantity_field("m", "base radius of wheel 2", gt=0.0)
    teeth1: float = quantity_field("1", "number of teeth of wheel 1", ge=1.0, is_integer=True)
    backlash: float = quantity_field("m", "backlash along the line of action", ge=0.0)
    K_tooth: float = quantity_field(
        "N/m", "stiffness of one tooth pair with smooth flanks, in series with their roughness", gt=0.0
    )
    contact_ratio: float = quantity_field("1", "mean number of tooth pairs in contact", ge=1.0, lt=3.0)
    engagement: float = quantity_field(
        "1",
        "time over which a pair takes up its load, divided by the shorter of the times with and without the "
        "pair",
        gt=0.0,
        le=1.0,
    )
    d: float = quantity_field("N.s/m", "damping along the line of action while the flanks touch", ge=0.0)
    overlap_ratio: float = quantity_field(
        "1", "overlap ratio: face width divided by axial pitch; 0: spur gears", ge=0.0, default=0.0
    )
    inertia1: float = quantity_field(
        "kg.m2",
        "inertia of wheel 1 and its load, used only for the outputs of stable steps; 0: fixed",
        ge=0.0,
        default=0.0,
    )
    inertia2: float = quantity_field(
        "kg.m2",
        "inertia of wheel 2 and its load, used only for the outputs of stable steps; 0: fixed",
        ge=0.0,
        default=1.0,
    )


@dataclass(frozen=True, kw_only=True)
class GearMeshParameters(GearWheelParameters, Yu2022):
    """Parameters of the gear mesh with flanks by the law of Yu 2022."""


@dataclass(frozen=True, kw_only=True)
class RoughGearMeshParameters(GearWheelParameters, RoughnessLaw):
    """Parameters of the gear mesh with flanks by the law `roughness`."""


@dataclass(frozen=True, kw_only=True)
class TableGearMeshParameters(GearWheelParameters, TableLaw):
    """Parameters of the gear mesh with flanks by the law `table`."""


MeshParameters: TypeAlias = GearMeshParameters | RoughGearMeshParameters | TableGearMeshParameters
"""Parameter set of a gear mesh with any law."""


def base_pitch(mesh_parameters: MeshParameters) -> Number:
    """Base pitch [m]: distance of adjacent teeth along the line of action."""
    return 2.0 * np.pi * mesh_parameters.r_b1 / mesh_parameters.teeth1


def deflection(mesh_parameters: MeshParameters, wheel_motion: Sequence[Number]) -> Number:
    """Deflection s_rel [m] of the mesh along the line of action, at wheel motions (phi1, w1, phi2, w2).

    s_rel is r_b1 phi1 + r_b2 phi2, reduced in magnitude by half the backlash; 0 within the backlash.
    """
    phi1, _, phi2, _ = wheel_motion
    rolling = mesh_parameters.r_b1 * phi1 + mesh_parameters.r_b2 * phi2
    half_backlash = 0.5 * mesh_parameters.backlash
    return rolling - np.minimum(np.maximum(rolling, 0.0 - half_backlash), half_backlash)


def mesh_phase(mesh_parameters: MeshParameters, wheel_motion: Sequence[Number]) -> Number:
    """Phase xi [1] of the mesh cycle at wheel motions (phi1, w1, phi2, w2).

    The phase is the mean rolling distance over the base pitch.
    """
    phi1, _, phi2, _ = wheel_motion
    return 0.5 * (mesh_parameters.r_b1 * phi1 - mesh_parameters.r_b2 * phi2) / base_pitch(mesh_parameters)


def combine_flanks_and_teeth(
    mesh_parameters: MeshParameters,
    flank_approach: Number,
    flank_pressure: Number,
    flank_stiffness: Number,
    flank_stiffness_slope: Number,
) -> tuple[Number, Number, Number, Number]:
    """Combine flanks and teeth in series: deflection [m], load [N], stiffness [N/m], its derivative [N/m2].

    flank_approach  : delta [m] of the flanks from first contact
    flank_pressure  : p [Pa] at this approach
    flank_stiffness : dp/d delta [N/m3]
    flank_stiffness_slope : d^2 p/d delta^2 [N/m4]
    """
    load, contact = mesh_parameters.A_0 * flank_pressure, mesh_parameters.A_0 * flank_stiffness
    share = mesh_parameters.K_tooth / (contact + mesh_parameters.K_tooth)  # of the flanks in the deflection
    return (
        flank_approach + load / mesh_parameters.K_tooth,
        load,
        contact * share,
        mesh_parameters.A_0 * flank_stiffness_slope * share**3,
    )


def tabulate_tooth_pair(mesh_parameters: MeshParameters) -> tuple[Curve, float]:
    """Load-deflection table of one tooth pair [N, m], and its deflection [m] at the end of the closing.

    Closing is the first part of the contact: the pressure of the flanks rises from zero to the point where
    the contact law begins, see `curve.closing_pressure`. Deflections count from first contact. The nodes are
    those of the flanks' curve, where load, stiffness and its derivative are exact; the steps of the closing
    shrink towards first contact.

    Raises ValueError and RuntimeError as `curve.tabulate_approach` and `curve.refine_curve` do.
    """
    flanks = tabulate_approach(mesh_parameters)
    length = -flanks.displacement[0]
    closing = combine_flanks_and_teeth(mesh_parameters, length, flanks.closing_end_pressure, 0.0, 0.0)[0]
    return refine_curve(lambda parts: _tabulate_with_steps(mesh_parameters, flanks, parts), 1), float(closing)


def _tabulate_with_steps(
    mesh_parameters: MeshParameters, flank_curve: Curve, steps_per_segment: int
) -> Curve:
    """Load-deflection table of a tooth pair [N, m].

    steps_per_segment : number of equal steps in each segment of the flanks' curve beyond the closing
    """
    nodes = flank_curve.displacement
    closing_index = int(np.searchsorted(nodes, 0.0))
    t = np.linspace(0.0, 1.0, CONTACT_CLOSING_STEPS * steps_per_segment + 1)
    kinks = 1 + np.flatnonzero(flank_curve.stiffness_slope_end[:-1] != flank_curve.stiffness_slope_start[1:])
    ends = [closing_index, *(int(i) for i in kinks if i > closing_index), nodes.size - 1]
    abscissas = [(t**2 - 1.0) * -nodes[0]]
    for first, end in pairwise(ends):
        steps = np.diff(nodes[first : end + 1])[:, None] * np.arange(steps_per_segment) / steps_per_segment
        abscissas.append(np.append((nodes[first:end, None] + steps).ravel(), nodes[end]))
    pieces = []
    for x, end in zip(abscissas, ends, strict=True):
        pressure, stiffness, bend = flank_curve.derivatives(x, 2)
        bend[-1] = flank_curve.stiffness_slope_end[
            end - 1
        ]  # from below: the derivative jumps where a regime ends
        pieces.append(combine_flanks_and_teeth(mesh_parameters, x - nodes[0], pressure, stiffness, bend))
    return assemble_curve(pieces, flank_curve.interpolation_error)


@dataclass(frozen=True, slots=True)
class GearMeshSpring:
    """Tabulated gear mesh: motion of the wheels in, torques out.

    With V(s) the elastic energy of a tooth pair and N(xi) the number of pairs in contact at the phase xi of
    the mesh cycle, the torques are the negative gradient of the potential

        U(phi1, phi2) = N(xi) V(|s_rel|),

    plus viscous damping while the flanks touch. The damping grows from zero while the contact closes.

    curve       : load [N] of one tooth pair as a function of its deflection [m]
    closing_end_deflection : [m] deflection at which the closing of the contact ends
    """

    joint: MeshParameters
    curve: Curve
    closing_end_deflection: float

    @classmethod
    def tabulate(cls, mesh_parameters: MeshParameters) -> "GearMeshSpring":
        """Tabulate the load of a tooth pair as a function of its deflection, for a parameter set."""
        return cls(mesh_parameters, *tabulate_tooth_pair(mesh_parameters))

    def evaluate(self, phi1: ArrayLike, w1: ArrayLike, phi2: ArrayLike, w2: ArrayLike) -> dict[str, Array]:
        """Outputs at wheel angles phi1, phi2 (...) [rad] and speeds w1, w2 (...) [rad/s]."""
        motion = tuple(np.asarray(x, dtype=np.float64) for x in (phi1, w1, phi2, w2))
        s = np.abs(deflection(self.joint, motion))
        load, stiffness = self.curve.derivatives(s, 1)
        return mesh_outputs(
            self.joint, motion, load, stiffness, self.curve.energy(s), self.closing_end_deflection
        )


def mesh_outputs(
    mesh_parameters: MeshParameters,
    wheel_motion: Sequence[Number],
    tooth_pair_load: Number,
    tooth_pair_stiffness: Number,
    tooth_pair_energy: Number,
    closing_end_deflection: Number,
) -> dict[str, Number]:
    """Outputs of the gear mesh at a motion (phi1, w1, phi2, w2).

    tooth_pair_load, tooth_pair_stiffness, tooth_pair_energy : [N], [N/m], [J] of one tooth pair at |s_rel|
    closing_end_deflection : [m] deflection at which the closing of the contact ends
    """
    _, w1, _, w2 = wheel_motion
    s = deflection(mesh_parameters, wheel_motion)
    count, slope = pairs_in_contact(
        mesh_parameters.contact_ratio,
        mesh_parameters.engagement,
        mesh_parameters.overlap_ratio,
        mesh_phase(mesh_parameters, wheel_motion),
    )
    contact_factor = smooth_step(np.abs(s) / closing_end_deflection)
    force = count * tooth_pair_load * np.sign(s) + mesh_parameters.d * contact_factor * (
        mesh_parameters.r_b1 * w1 + mesh_parameters.r_b2 * w2
    )
    w = mobility(mesh_parameters.inertia1, mesh_parameters.r_b1) + mobility(
        mesh_parameters.inertia2, mesh_parameters.r_b2
    )
    at_once, side_by_side = largest_stable_steps(
        count * tooth_pair_stiffness, mesh_parameters.d * contact_factor, w
    )
    # -dU/d(r_b phi) of one wheel by the change of the phase
    change = 0.5 * slope * tooth_pair_energy / base_pitch(mesh_parameters)
    return {
        "tau1": 0.0 - mesh_parameters.r_b1 * (force + change),
        "tau2": 0.0 - mesh_parameters.r_b2 * (force - change),
        "s_rel": s,
        "transmission_error": s,
        "f": force,
        "K": count * tooth_pair_stiffness,
        "pairs": count,
        "E": count * tooth_pair_energy,
        "step_at_once": at_once,
        "step_side_by_side": side_by_side,
    }


_MIN_OVERLAP_RATIO = 1e-6
"""Overlap ratio [1] below which a helical mesh counts as a spur mesh. The mean over the face width then
differs from the value at mid-width by less than round-off: by 1/24 of the squared ratio times the curvature,
which is at most 6/width^2.
"""


def pairs_in_contact(
    contact_ratio: Number, engagement: Number, overlap_ratio: Number, mesh_cycle_phase: Number
) -> tuple[Number, Number]:
    """Number of tooth pairs in contact [1] at phases (...) [1] of the mesh cycle, and its derivative [1].

    Each transverse section of a helical mesh is a spur mesh, see `_pairs_in_section`. The phases of the
    sections are spread evenly over `overlap_ratio` cycles, so the number of pairs is the mean over this
    range. Its mean over a cycle stays the contact ratio; its fluctuation is smaller than in a spur mesh.
    """
    helical = overlap_ratio > _MIN_OVERLAP_RATIO
    length = np.where(helical, overlap_ratio, 1.0)
    spur_pairs, slope, _ = _pairs_in_section(contact_ratio, engagement, mesh_cycle_phase)
    pairs_after, _, integral_after = _pairs_in_section(
        contact_ratio, engagement, mesh_cycle_phase + 0.5 * length
    )
    pairs_before, _, integral_before = _pairs_in_section(
        contact_ratio, engagement, mesh_cycle_phase - 0.5 * length
    )
    mean = contact_ratio + (integral_after - integral_before) / length
    return np.where(helical, mean, spur_pairs), np.where(
        helical, (pairs_after - pairs_before) / length, slope
    )


def _pairs_in_section(
    contact_ratio: Number, engagement: Number, mesh_cycle_phase: Number
) -> tuple[Number, Number, Number]:
    """Number N of tooth pairs in a transverse section [1], dN/d(phase), and integral of N - contact_ratio.

    floor(contact_ratio) pairs are always in contact. One more pair is in contact during the fractional part
    of the cycle, centred at integer phases. It engages and disengages by `smooth_step`, over `engagement`
    times the shorter of the durations with and without it. N is even in the phase; its mean over a cycle is
    the contact ratio.
    """
    whole_pairs = np.floor(contact_ratio)
    fraction = contact_ratio - whole_pairs
    width = engagement * np.minimum(fraction, 1.0 - fraction)
    changing = width > 0.0
    length = np.where(changing, width, 1.0)
    distance = mesh_cycle_phase - np.floor(mesh_cycle_phase + 0.5)
    first = 0.5 + 0.5 * fraction / length
    position = first - np.abs(distance) / length
    share, (slope, _) = smooth_step(position), smooth_step_slopes(position)
    excess = length * (first - 0.5 - smooth_step_integral(position)) - fraction * np.abs(distance)
    return (
        whole_pairs + np.where(changing, share, 0.0),
        np.where(changing, -np.sign(distance) * slope / length, 0.0),
        np.where(changing, np.sign(distance) * excess, 0.0),
    )
