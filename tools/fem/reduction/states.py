"""States of a joint in monotonic loading into slip and opening: the snapshots for the modes of its bodies.

The contact is divided into cells, one for each point of the reduced joint: the part of the contact that is
nearest to the point. The compliance of the bodies under loads on cells and bolts comes from finite elements.
With the interface law in each cell, motions along and about all axes give states of the complete joint.
States in shear alone are then brought to equilibrium with the law at all quadrature points: cells alone miss
the tangential displacement at the edge of slip, and with it part of the loss.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from scipy.linalg import cho_factor, cho_solve
from scipy.spatial import cKDTree

from jointfmu.joints.bolted_joint.joint import BoltedJointSpring
from jointfmu.joints.bolted_joint.law import working_preload
from jointfmu.quantity import Array

from ..symmetric_factorisation import SymmetricFactorisation, find_reflections
from ..whole_joint import AXIS_INDICES, MIRROR_SIGNS, JointFiniteElements, LinearJoint
from .patch_work import MIN_TANGENTIAL_DISPLACEMENT

SHEAR_MOTIONS_OVER_SLIP_MOTION = (0.05, 0.2, 0.4, 0.6, 0.8, 1.0, 1.3)
"""Motions along x, y and about z over the motion at which the linear joint reaches its friction limit [1]."""
OPENING_MOTIONS_OVER_UNLOADING_MOTION = (-0.6, -0.2, 0.3, 0.6, 0.9, 1.2)
"""Motions along z and about x, y, over the motion at which the linear joint loses its preload force [1]."""
COMBINED_MOTION_COUNT = 12
"""Number of motions along and about all axes at once."""
MAX_NEWTON_STEPS, RELATIVE_TOLERANCE = 40, 1e-9
"""Largest number of steps of Newton's method; residual over the largest prescribed motion [1] at its end."""
EQUILIBRIUM_ITERATION_COUNT = 3
"""Number of steps that bring the states in shear to equilibrium at all quadrature points."""


def compute_deformation_states(
    linear_joint: LinearJoint, reduced_joint: BoltedJointSpring, normal_stiffness: Array, preload: float
) -> tuple[Array, Array]:
    """Compute deformation states of a joint, from which the modes of its bodies are chosen.

    Each state is the equilibrium of the preloaded joint after one motion of side 2 (a translation, a rotation
    or a combination, up to slip or opening).

    Returns the motions (s, 6) [m, rad] of side 2 in s states, and the displacements (n, s) [m] of the
    degrees of freedom of the bodies, relative to the preloaded joint, with reversed sign.

    linear_joint     : linear finite-element model of the joint
    reduced_joint    : joint with rigid bodies: contact points with the interface law
    normal_stiffness : (q) [Pa/m] of the preloaded interface at the quadrature points
    preload          : [N] per bolt

    Raises RuntimeError if a body can move freely.
    """
    cells = UnitLoadResponse.from_joint(linear_joint.joint_model, reduced_joint, normal_stiffness)
    joint_states = CellwiseJoint.from_cells(
        cells,
        linear_joint.joint_model.bolt_positions - linear_joint.joint_model.contact_interface.centroid,
        preload,
    )
    motions = np.array(list(joint_states.generate_attachment_motions()))
    deformation = cells.unit_load_displacement @ np.stack(
        [joint_states.solve_forces(motion) for motion in motions], axis=1
    )
    sheared = ~np.any(motions[:, 2:5], axis=1)
    deformation[:, sheared] = refine_equilibrium(
        linear_joint, reduced_joint, normal_stiffness, motions[sheared], deformation[:, sheared]
    )
    return motions, deformation


@dataclass(frozen=True)
class UnitLoadResponse:
    """Response of the bodies to unit loads on the n cells of the contact and on the b bolts.

    joint_model            : finite-element model of the joint
    reduced_joint          : joint with rigid bodies; its contact points are the centres of the cells
    normal_stiffness       : (q) [Pa/m] of the preloaded interface at the quadrature points
    averaging_operators    : (3 n + b, unknowns) [1] averaging operators: mean displacement of each cell along
                             z, x and y, then elongation of each bolt; the transpose distributes unit loads
    unit_load_displacement : (unknowns, 3 n + b) [m/N] under unit loads
    """

    joint_model: JointFiniteElements
    reduced_joint: BoltedJointSpring
    normal_stiffness: Array
    averaging_operators: sp.csr_matrix
    unit_load_displacement: Array

    @classmethod
    def from_joint(
        cls, joint_model: JointFiniteElements, reduced_joint: BoltedJointSpring, normal_stiffness: Array
    ) -> "UnitLoadResponse":
        """Compute the displacement under all unit loads. Raises RuntimeError if a body can move freely."""
        means = averaging_matrix(joint_model, reduced_joint.points.position, normal_stiffness)
        stretch = sp.csr_matrix(joint_model.elongation_matrix.T)
        loads = sp.vstack(
            [*(means @ joint_model.relative_displacement_matrix(axis) for axis in (2, 0, 1)), stretch]
        ).tocsr()
        count = joint_model.bodies[0].unknown_count
        displacement = np.zeros(loads.shape[::-1])
        displacement1, displacement2 = displacement[:count], displacement[count:]
        _solve_body(joint_model, 0, loads[:, :count], displacement1)
        if joint_model.is_mirrored:
            sign = np.repeat([1.0, -1.0, 1.0], (means.shape[0], 2 * means.shape[0], stretch.shape[0]))
            np.multiply(displacement1, sign, out=displacement2)
            for axis, mirror_sign in enumerate(MIRROR_SIGNS):
                displacement2[axis::3] *= mirror_sign
        else:
            _solve_body(joint_model, 1, loads[:, count:], displacement2)
        return cls(joint_model, reduced_joint, normal_stiffness, loads, displacement)


def _solve_body(
    joint_model: JointFiniteElements, body_index: int, unit_loads: sp.csr_matrix, body_displacement: Array
) -> None:
    """Solve for displacements (n, k) [m/N] of a body under unit loads (k, n) [1]; its attachment is fixed.

    body_index        : index of the body
    body_displacement : (n, k) of zeros, to which the result is written
    """
    stiffness, fixed_unknowns = (
        joint_model.stiffness_matrices[body_index],
        joint_model.attachment_unknowns[body_index],
    )
    free = np.setdiff1d(np.arange(len(body_displacement)), fixed_unknowns)
    matrix = stiffness[free][:, free]
    reflections = find_reflections(matrix, [joint_model.bodies[body_index]], free)
    body_displacement[free] = SymmetricFactorisation(matrix, reflections).solve_linear_system(
        unit_loads[:, free].T.tocsc()
    )


def averaging_matrix(
    joint_model: JointFiniteElements, cell_centres: Array, normal_stiffness: Array
) -> sp.csr_matrix:
    """Matrix (n, q) [1] that averages values at q quadrature points over n cells of the contact.

    The weights are area times normal stiffness. A quadrature point belongs to the cell with the nearest
    centre. A cell without quadrature points takes the value at the nearest one.

    cell_centres     : (n, 2) [m] of the cells
    normal_stiffness : (q) [Pa/m] of the preloaded interface at the quadrature points
    """
    interface = joint_model.contact_interface
    position = interface.centred_position
    cell = cKDTree(cell_centres).query(position)[1]
    weight = interface.quadrature_area * np.maximum(normal_stiffness, 1e-6 * normal_stiffness.max())
    empty = np.flatnonzero(np.bincount(cell, weight, minlength=len(cell_centres)) == 0.0)
    nearest = cKDTree(position).query(cell_centres[empty])[1]
    rows, columns = np.append(cell, empty), np.append(np.arange(cell.size), nearest)
    sums = sp.csr_matrix(
        (np.append(weight, np.ones(empty.size)), (rows, columns)), shape=(len(cell_centres), cell.size)
    )
    return (sp.diags(1.0 / np.asarray(sums.sum(axis=1)).ravel()) @ sums).tocsr()


@dataclass(frozen=True)
class CellwiseJoint:
    """Joint with the interface law in n cells of the contact and b bolts, for monotonic motions of side 2.

    reduced_joint      : joint with rigid bodies, with the interface law of the cells
    body_compliance    : compliance of the bodies (3 n + b, 3 n + b) [m/N]
    rigid_displacement : (3 n + b, 6) displacement of cells and bolts by rigid-body motions of side 2
    preload_approach   : approach (n) [m] of the cells in the preloaded joint
    preload            : [N] per bolt
    """

    reduced_joint: BoltedJointSpring
    body_compliance: Array
    rigid_displacement: Array
    preload_approach: Array
    preload: float

    @classmethod
    def from_cells(
        cls, unit_load_response: UnitLoadResponse, bolt_positions: Array, preload: float
    ) -> "CellwiseJoint":
        """Joint preloaded by bolts at positions (b, 2) [m], with the compliance of its elastic bodies.

        The compliance is between loads on the cells (parts of the contact around the points) and on the
        bolts.
        """
        spring = unit_load_response.reduced_joint
        compliance = np.asarray(
            unit_load_response.averaging_operators @ unit_load_response.unit_load_displacement
        )
        x, y = spring.points.position.T
        n, b = x.size, len(bolt_positions)
        rigid = np.zeros((3 * n + b, 6))
        rigid[:n, 2:5] = np.stack([np.ones(n), y, -x], axis=1)
        rigid[n : 2 * n, [0, 5]] = np.stack([np.ones(n), -y], axis=1)
        rigid[2 * n : 3 * n, [1, 5]] = np.stack([np.ones(n), x], axis=1)
        rigid[3 * n :, 2:5] = np.stack([np.ones(b), bolt_positions[:, 1], -bolt_positions[:, 0]], axis=1)
        start = spring.preloaded_approach(preload, 0.0)
        return cls(spring, 0.5 * (compliance + compliance.T), rigid, start, preload)

    @cached_property
    def _preload_pressure(self) -> Array:
        """Pressure (n) [Pa] on the contact cells of the preloaded joint."""
        return self.reduced_joint.curve.derivatives(self.preload_approach, 0)[0]

    def contact_cell_forces(self, displacements: Array) -> tuple[Array, "CellTangentStiffness"]:
        """Forces (3 n + b) [N] at displacements (3 n + b) [m] of cells and bolts, and their tangent.

        Forces are changes from the preloaded joint. The order is: opening (n), displacement along x (n),
        displacement along y (n), elongation of the bolts (b).
        """
        spring, n = self.reduced_joint, self.preload_approach.size
        joint, area = spring.joint, spring.joint.A_0 * spring.points.area_share
        foundation = spring.friction_law.foundation()
        ratio = foundation.stiffness_ratio
        slip_ratio = foundation.friction_coefficient / foundation.stiffness_ratio
        approach = self.preload_approach - displacements[:n]
        p, k = spring.curve.derivatives(approach, 1)
        u, v = displacements[n : 2 * n], displacements[2 * n : 3 * n]
        size = np.maximum(np.hypot(u, v), 1e-30)
        secant = foundation.virgin_traction(approach, size) / size
        tangent = ratio * spring.curve.derivatives(approach - size / slip_ratio, 1)[1]
        secant = np.where(size < 1e-6 * np.max(np.abs(self.preload_approach)), ratio * k, secant)
        softening = (tangent - secant) / size**2
        preload = np.full(displacements.size - 3 * n, float(working_preload(joint, self.preload)))
        bolts, elongation = spring.bolts, displacements[3 * n :]
        bolt = bolts.active_stiffness(preload, elongation)
        pull = bolts.stiffness * (elongation + bolts.head_gap(preload, elongation))
        force = np.concatenate(
            [-area * (p - self._preload_pressure), area * secant * u, area * secant * v, pull]
        )
        diagonal = [area * k, area * (secant + softening * u * u), area * (secant + softening * v * v), bolt]
        return force, CellTangentStiffness(np.concatenate(diagonal), area * softening * u * v)

    def compute_stiffness(self) -> Array:
        """Stiffness (6, 6) [N/m, N, N.m] of the preloaded joint between its attachments."""
        tangent = self.contact_cell_forces(np.zeros(len(self.rigid_displacement)))[1]
        displacement = tangent.solve_with_compliance(self.body_compliance, self.rigid_displacement)
        return np.asarray(self.rigid_displacement.T @ tangent.multiply_by_tangent(displacement))

    def solve_forces(self, attachment_motion: Array) -> Array:
        """Solve for the forces (3 n + b) [N] at a motion (6) [m, rad] of side 2's attachment.

        Newton's method may stop before it has converged: the result is one of the sampled states from which a
        reduced basis is made, and these need no exact equilibrium.
        """
        prescribed = self.rigid_displacement @ attachment_motion
        g = np.zeros_like(prescribed)
        force, tangent = self.contact_cell_forces(g)
        residual = g + self.body_compliance @ force - prescribed
        for _ in range(MAX_NEWTON_STEPS):
            step = -tangent.solve_with_compliance(self.body_compliance, residual)
            for halvings in range(5):
                g_trial = g + 0.5**halvings * step
                force, tangent = self.contact_cell_forces(g_trial)
                trial_residual = g_trial + self.body_compliance @ force - prescribed
                if np.linalg.norm(trial_residual) < np.linalg.norm(residual):
                    break
            g, residual = g_trial, trial_residual
            if np.max(np.abs(residual)) < RELATIVE_TOLERANCE * np.max(np.abs(prescribed)):
                break
        return force

    def generate_attachment_motions(self) -> Iterator[Array]:
        """Generate motions of side 2 up to slip and opening: along each axis, then along all at once.

        Each motion is a vector (6): translations along and rotations about x, y, z [m, rad].
        """
        joint, K = self.reduced_joint.joint, np.diag(self.compute_stiffness())
        radius = np.sqrt(
            self.reduced_joint.points.area_share @ np.sum(self.reduced_joint.points.position**2, axis=1)
        )
        clamping = joint.n_bolts * float(working_preload(joint, self.preload))
        load = clamping * np.array([joint.mu, joint.mu, 1.0, radius, radius, joint.mu * radius])
        unit = load / K
        for axis in range(6):
            for factor in (
                OPENING_MOTIONS_OVER_UNLOADING_MOTION if axis in (2, 3, 4) else SHEAR_MOTIONS_OVER_SLIP_MOTION
            ):
                yield factor * unit * (np.arange(6) == axis)
        for number in range(COMBINED_MOTION_COUNT):
            yield (2.0 * ((0.5 + (number + 1.0) * LOW_DISCREPANCY_SEQUENCE_STEPS) % 1.0) - 1.0) * unit


@dataclass(frozen=True, slots=True)
class CellTangentStiffness:
    """Symmetric tangent (3 n + b, 3 n + b) [N/m] of the forces on n cells and b bolts.

    diagonal_stiffness  : (3 n + b) [N/m]
    tangential_coupling : (n) [N/m] derivative of the force along x by the displacement along y of the same
                          cell
    """

    diagonal_stiffness: Array
    tangential_coupling: Array

    def multiply_by_tangent(self, displacements: Array) -> Array:
        """Product (3 n + b, k) of the tangent stiffness and a matrix of displacements (3 n + b, k)."""
        n = self.tangential_coupling.size
        product = self.diagonal_stiffness[:, None] * displacements
        product[n : 2 * n] += self.tangential_coupling[:, None] * displacements[2 * n : 3 * n]
        product[2 * n : 3 * n] += self.tangential_coupling[:, None] * displacements[n : 2 * n]
        return product

    def solve_with_compliance(self, body_compliance: Array, right_side: Array) -> Array:
        """Solve (I + C T) x = r for x (3 n + b, ...), with this tangent T and a compliance C.

        Both matrices are symmetric and positive semidefinite. With T = L L^T the symmetric system
        (I + L^T C L) y = L^T r gives x = r - C L y. Neither T nor C needs an inverse.
        """
        n = self.tangential_coupling.size
        root = np.sqrt(np.maximum(self.diagonal_stiffness, 0.0))
        along_x = root[n : 2 * n]
        below = np.divide(self.tangential_coupling, along_x, out=np.zeros(n), where=along_x > 0.0)
        root[2 * n : 3 * n] = np.sqrt(np.maximum(self.diagonal_stiffness[2 * n : 3 * n] - below**2, 0.0))

        def multiply_by_cholesky_factor(displacements: Array) -> Array:
            """Product of L^T and a matrix (3 n + b, ...); L: Cholesky factor of the tangent stiffness."""
            product = (root * displacements.T).T
            product[n : 2 * n] += (below * displacements[2 * n : 3 * n].T).T
            return product

        spread = multiply_by_cholesky_factor(body_compliance)
        system = multiply_by_cholesky_factor(spread.T)
        system[np.diag_indices(len(system))] += 1.0
        factor = cho_factor(system, overwrite_a=True, check_finite=False)
        y = cho_solve(factor, multiply_by_cholesky_factor(right_side), overwrite_b=True, check_finite=False)
        return np.asarray(right_side - spread.T @ y)


def approach_at_stiffness(reduced_joint: BoltedJointSpring, normal_stiffness: Array) -> Array:
    """Approach (q) [m] at which the interface law has the normal stiffness (q) [Pa/m]."""
    curve = reduced_joint.curve
    return np.interp(normal_stiffness, curve.derivatives(curve.displacement, 1)[1], curve.displacement)


def refine_equilibrium(
    linear_joint: LinearJoint,
    reduced_joint: BoltedJointSpring,
    normal_stiffness: Array,
    state_motions: Array,
    negative_deformation: Array,
) -> Array:
    """Iterate s states of the joint towards equilibrium with the law at all quadrature points.

    Returns the refined deformation (n, s) [m] of the bodies with its sign reversed.

    normal_stiffness     : (q) [Pa/m] of the preloaded interface at the quadrature points
    state_motions        : (s, 6) [m, rad] of side 2
    negative_deformation : (n, s) [m] reversed deformation in equilibrium with the law in the cells

    Each iteration uses the stiffness of the preloaded joint. Slip only lowers the stiffness, so the iteration
    converges. A state whose step grows (its contact closes) is not changed.
    """
    joint = linear_joint.joint_model
    law = reduced_joint.friction_law.foundation()
    preloaded = approach_at_stiffness(reduced_joint, normal_stiffness)
    interface, curve = joint.contact_interface, reduced_joint.curve
    relative = [joint.relative_displacement_matrix(axis) for axis in AXIS_INDICES]
    stretch = sp.csr_matrix(joint.elongation_matrix)
    rigid = linear_joint.rigid_displacement @ state_motions.T
    prescribed = [rows @ rigid for rows in (*relative, stretch.T)]
    last_decrement = np.full(len(state_motions), np.inf)
    p_preload = curve.derivatives(preloaded, 0)[0][:, None]
    displacement = -negative_deformation
    for _ in range(EQUILIBRIUM_ITERATION_COUNT):
        u, v, opening, elongation = (
            start + rows @ displacement
            for start, rows in zip(prescribed, (*relative, stretch.T), strict=True)
        )
        approach = preloaded[:, None] - opening
        size = np.maximum(np.hypot(u, v), MIN_TANGENTIAL_DISPLACEMENT)
        secant = interface.quadrature_area[:, None] * law.virgin_traction(approach, size) / size
        loads = relative[0].T @ (secant * u) + relative[1].T @ (secant * v)
        loads += linear_joint.bolt_stiffness * (stretch @ elongation)
        loads -= relative[2].T @ (
            interface.quadrature_area[:, None] * (curve.derivatives(approach, 0)[0] - p_preload)
        )
        residual = -(linear_joint.body_stiffness_matrix @ displacement + loads)
        step = linear_joint.solve_displacements(residual)
        decrement = np.sum(step * residual, axis=0)
        displacement = displacement + np.where(decrement < last_decrement, step, 0.0)
        last_decrement = np.minimum(decrement, last_decrement)
    return -displacement


LOW_DISCREPANCY_SEQUENCE_STEPS = 0.8566748838545029 ** np.arange(1.0, 7.0)
"""Steps of a low-discrepancy sequence in six dimensions: powers of the inverse root of x^7 = x + 1."""
