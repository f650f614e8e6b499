"""Modal reduction of both bodies of a joint between their attachments.

The modes come from a proper orthogonal decomposition, in the energy norm, of computed load steps of the joint
(`states`). The opening or tangential displacement of a mode at a point of the reduced joint is its mean over
the cell of the point (the part of the contact nearest to it), weighted by the interface stiffness. A mean
misses the variation inside of the cell. So all means are corrected together: the preloaded interface gets the
same stiffness against all modes as in the finite-element model. At the friction patches, the displacements
are then fitted to the work of friction (`patch_work`).
"""

from typing import Any

import numpy as np
import scipy.linalg as la

from jointfmu.joints.bolted_joint.bodies import MODAL_DISPLACEMENT_DECIMALS
from jointfmu.joints.bolted_joint.joint import BoltedJointSpring
from jointfmu.joints.bolted_joint.law import MAX_MODES, ElasticBodies
from jointfmu.quantity import Array

from ..whole_joint import AXIS_INDICES, LinearJoint
from .patch_work import (
    FrictionPoints,
    PatchFit,
    ShearStates,
    StickContactStiffness,
    compute_friction_work,
    evaluate_friction,
    patch_rotations,
    place_sliders,
    rigid_displacement_matrix,
    shear_combinations,
    stick_stiffness_matrix,
)
from .states import approach_at_stiffness, averaging_matrix, compute_deformation_states

MIN_OVER_MAX_SINGULAR_VALUE = 1e-3
"""Singular value over the largest one [1], below which a mode is left out; all states have equal energy."""
UNIT_MOTION_WEIGHTS = 0.8 ** np.arange(6)
"""Weights of the responses to the six unit motions [1], in the decomposition. The weights do not change the
span of the modes. Without them, all responses of a symmetric joint would have the same energy, and the last
bits of a processor would choose the modes."""
SUCCESSIVE_STATE_WEIGHT_DIFFERENCE = 1e-6
"""Difference of the weights of successive states [1], in the decomposition: in a square plate, states along x
and along y have the same energy, see UNIT_MOTION_WEIGHTS."""
OPENING_STATE_WEIGHT = 0.5
"""Weight of states with opening over the weight of states in shear alone [1], in the decomposition: the
loss in partial slip needs more accurate modes."""
MODAL_STIFFNESS_DIGITS = 6
"""Significant digits of the stiffness of a mode: more than for its displacements, fewer than those in which
different processors agree."""
MAX_MODAL_DISPLACEMENT_CORRECTION = 10.0
"""Largest factor [1] of the correction of modal displacements at the points, and of its inverse."""


def reduce_bodies(
    linear_joint: LinearJoint, reduced_joint: BoltedJointSpring, normal_stiffness: Array, preload: float
) -> ElasticBodies:
    """Reduce the elastic bodies to modes: displacements of contact points, friction patches and bolts.

    linear_joint     : linear finite-element model of the joint
    reduced_joint    : joint with rigid bodies: contact points and friction patches with the interface law
    preload          : [N] per bolt
    normal_stiffness : (q) [Pa/m] of the preloaded interface at the quadrature points

    Raises RuntimeError if a body can move freely.
    """
    joint = linear_joint.joint_model
    interface = joint.contact_interface
    bolts = joint.bolt_positions - interface.centroid
    motions, deformed = compute_deformation_states(linear_joint, reduced_joint, normal_stiffness, preload)
    body_forces = linear_joint.body_stiffness_matrix @ deformed
    fields = _compute_energy_modes(linear_joint, deformed, body_forces, motions)
    stretch = joint.elongation_matrix.T @ fields
    patches = reduced_joint.patches
    start = reduced_joint.preloaded_approach(preload, 0.0)
    point_stiffness = reduced_joint.curve.derivatives(start, 1)[1]
    patch_approach = reduced_joint.contact.patch_approach(start)
    ratio = reduced_joint.friction_law.foundation().stiffness_ratio
    patch_shear = ratio * reduced_joint.curve.derivatives(patch_approach, 1)[1]
    x, y = patches.position.T
    traces = [joint.relative_displacement_matrix(axis) @ fields for axis in AXIS_INDICES]
    springs, area = interface.quadrature_area * normal_stiffness, reduced_joint.joint.A_0
    opening = _match_stiffness(
        averaging_matrix(joint, reduced_joint.points.position, normal_stiffness) @ traces[2],
        _rigid_motion_opening(reduced_joint.points.position),
        area * reduced_joint.points.area_share * point_stiffness,
        _rigid_motion_opening(interface.centred_position),
        traces[2],
        springs,
    )
    combinations = shear_combinations(motions)
    shears = ShearStates((combinations @ motions)[:, (0, 1, 5)], -(fields.T @ body_forces @ combinations.T).T)
    law, approach = (
        reduced_joint.friction_law.foundation(),
        approach_at_stiffness(reduced_joint, normal_stiffness),
    )
    surface = FrictionPoints(
        interface.quadrature_area, approach, rigid_displacement_matrix(interface.centred_position)
    )
    tangential = np.concatenate(traces[:2])
    target_friction_work = compute_friction_work(law, shears, surface, tangential)
    means = averaging_matrix(joint, patches.position, normal_stiffness)
    patch_rows = _match_stiffness(
        np.concatenate([means @ traces[0], means @ traces[1]]),
        rigid_displacement_matrix(patches.position),
        np.tile(area * patches.area_share * patch_shear, 2),
        surface.rigid_displacement,
        tangential,
        np.tile(ratio * springs, 2),
    )
    rotations = patch_rotations(interface.centred_position, patches, means, traces)
    unit = ShearStates(
        np.eye(6)[:, (0, 1, 5)],
        (
            (
                linear_joint.body_stiffness_matrix
                @ (linear_joint.unit_motion_displacement - linear_joint.rigid_displacement)
            ).T
            @ fields
        ),
    )
    linear_contact = StickContactStiffness(
        unit,
        stick_stiffness_matrix(
            evaluate_friction(law, unit, surface, tangential)[1], interface.quadrature_area
        ),
        linear_joint.stiffness_matrix.diagonal(),
    )
    sliders = place_sliders(patches, area, patch_approach, rotations)
    patch_rows = PatchFit(law, shears, *sliders, target_friction_work, linear_contact).fit_patches(patch_rows)
    displacements = {"opening": opening, "stretch": stretch}
    displacements |= dict(zip(("patch_x", "patch_y"), np.split(patch_rows, 2), strict=True))
    displacements["patch_around"] = patches.slider_circle_radius[:, None] * rotations
    largest, values = _normalise_modes(displacements)
    positions = {"x": x, "y": y, "bolt_x": bolts[:, 0], "bolt_y": bolts[:, 1]}
    values |= {name: _convert_to_tuple(coordinates) for name, coordinates in positions.items()}
    modal_stiffness = tuple(float(f"{k:.{MODAL_STIFFNESS_DIGITS}g}") for k in 1.0 / largest**2)
    return ElasticBodies(stiffness=modal_stiffness, **values)


def _normalise_modes(modal_displacements: dict[str, Array]) -> tuple[Array, dict[str, Any]]:
    """Normalise the modes to a largest displacement of 1 and round them.

    The sign makes the first largest displacement positive: otherwise the last bits of a processor would
    choose between a mode and its opposite.

    modal_displacements : {name: rows (n, k) of all modes}

    Returns the largest displacement (k) of each mode, and the normalised rows as flat tuples.
    """
    largest = np.max(np.abs(np.concatenate(list(modal_displacements.values()))), axis=0)
    rounded = {
        name: np.round(rows / largest, MODAL_DISPLACEMENT_DECIMALS)
        for name, rows in modal_displacements.items()
    }
    all_rows = np.concatenate(list(rounded.values()))
    first = np.argmax(np.abs(all_rows), axis=0)
    sign = np.sign(all_rows[first, np.arange(len(first))])
    return largest, {name: _convert_to_tuple((sign * rows).ravel()) for name, rows in rounded.items()}


def _convert_to_tuple(array_values: Array) -> tuple[float, ...]:
    """Convert an array (n) to a tuple, with 0.0 for -0.0."""
    return tuple((array_values + 0.0).tolist())


def _compute_energy_modes(
    linear_joint: LinearJoint, state_deformations: Array, state_forces: Array, state_motions: Array
) -> Array:
    """Compute k modes (n, k) of the n body displacements, orthonormal in the energy norm (strain energy).

    The first modes span the response of the linear joint to unit motions; the others come from the proper
    orthogonal decomposition of the remaining deformation.

    state_deformations : (n, s) [m] deformation of the bodies in s states of the joint
    state_forces       : (n, s) [N] stiffness matrix of the bodies times this deformation
    state_motions      : (s, 6) [m, rad] of side 2 in these states
    """
    linear_deformations = linear_joint.unit_motion_displacement - linear_joint.rigid_displacement
    responses = _scale_to_unit_energy(
        linear_deformations, linear_joint.body_stiffness_matrix @ linear_deformations
    )
    linear_modes, linear_forces = _decompose_orthogonally(*(UNIT_MOTION_WEIGHTS * f for f in responses))
    states, forces = _scale_to_unit_energy(state_deformations, state_forces)
    for _ in range(2):  # repeated Gram-Schmidt: two passes are enough
        shares = linear_modes.T @ forces
        states, forces = states - linear_modes @ shares, forces - linear_forces @ shares
    weight = np.where(np.any(state_motions[:, 2:5], axis=1), OPENING_STATE_WEIGHT, 1.0)
    weight *= 1.0 - SUCCESSIVE_STATE_WEIGHT_DIFFERENCE * np.arange(weight.size)
    other_modes, _ = _decompose_orthogonally(weight * states, weight * forces)
    return np.concatenate([linear_modes, other_modes[:, : MAX_MODES - linear_modes.shape[1]]], axis=1)


def _scale_to_unit_energy(displacement_fields: Array, field_forces: Array) -> tuple[Array, Array]:
    """Scale displacement fields (n, s) [m] to unit energy norm, and their forces (n, s) [N] in proportion.

    The energy norm of a field is the sum of displacement times force; forces = stiffness times displacements.
    """
    norm = np.sqrt(np.sum(displacement_fields * field_forces, axis=0))
    return displacement_fields / norm, field_forces / norm


def _decompose_orthogonally(displacement_fields: Array, field_forces: Array) -> tuple[Array, Array]:
    """Proper orthogonal decomposition of s displacement fields (n, s) in the energy norm.

    field_forces : (n, s) stiffness matrix times the displacement fields

    Returns orthonormal modes (n, k), the largest singular value first, without those below
    MIN_OVER_MAX_SINGULAR_VALUE, and their forces (n, k).
    """
    energy, vectors = np.linalg.eigh(displacement_fields.T @ field_forces)
    energy, vectors = energy[::-1], vectors[:, ::-1]
    count = int(np.sum(energy > MIN_OVER_MAX_SINGULAR_VALUE**2 * energy[0]))
    factors = vectors[:, :count] / np.sqrt(energy[:count])
    return displacement_fields @ factors, field_forces @ factors


def _rigid_motion_opening(contact_position: Array) -> Array:
    """Opening (n, 3) [1, m] of the contact at positions (n, 2) [m] by unit motions along z, about x and y."""
    x, y = contact_position.T
    return np.stack([np.ones_like(x), y, -x], axis=1)


def _match_stiffness(
    reduced_modal_displacement: Array,
    reduced_rigid_displacement: Array,
    reduced_stiffness: Array,
    full_rigid_displacement: Array,
    full_modal_displacement: Array,
    full_stiffness: Array,
) -> Array:
    """Corrected modal displacements (n, k) of a reduced set of n springs, for k modes.

    With them, the reduced set has the same modal stiffness, and the same coupling of modes and rigid-body
    motions, as the full set of q springs.

    reduced_modal_displacement : (n, k) mean displacement of each spring of the reduced set by the modes
    reduced_rigid_displacement : (n, 3) displacement of the reduced set by rigid-body motions
    reduced_stiffness          : (n) [N/m] of the reduced set
    full_rigid_displacement    : (q, 3) displacement of all springs by rigid-body motions
    full_modal_displacement    : (q, k) displacement of all springs by the modes
    full_stiffness             : (q) [N/m] of all springs
    """
    few_rigid_part = np.linalg.solve(
        reduced_rigid_displacement.T @ (reduced_stiffness[:, None] * reduced_rigid_displacement),
        reduced_rigid_displacement.T @ (reduced_stiffness[:, None] * reduced_modal_displacement),
    )
    all_rigid_part = np.linalg.solve(
        full_rigid_displacement.T @ (full_stiffness[:, None] * full_rigid_displacement),
        full_rigid_displacement.T @ (full_stiffness[:, None] * full_modal_displacement),
    )
    few_bending = reduced_modal_displacement - reduced_rigid_displacement @ few_rigid_part
    all_bending = full_modal_displacement - full_rigid_displacement @ all_rigid_part
    target = all_bending.T @ (full_stiffness[:, None] * all_bending)
    target += 1e-6 * np.trace(target) / len(target) * np.eye(len(target))
    ratio, vectors = la.eigh(few_bending.T @ (reduced_stiffness[:, None] * few_bending), target)
    gain = np.minimum(
        1.0 / np.sqrt(np.maximum(ratio, MAX_MODAL_DISPLACEMENT_CORRECTION**-2)),
        MAX_MODAL_DISPLACEMENT_CORRECTION,
    )
    return np.asarray(
        reduced_rigid_displacement @ all_rigid_part + few_bending @ (vectors * gain) @ vectors.T @ target
    )
