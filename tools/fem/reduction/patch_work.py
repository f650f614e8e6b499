"""Fit of the modal displacements of few friction patches to the work of friction of the complete contact.

The tangential displacement of elastic sides varies within a patch: it increases towards the edge of the
contact disc, where slip begins. With its mean displacement, a patch slips too late and dissipates too little,
by a fifth in partial slip. So the displacement of each patch by each mode is fitted, from the mean on. The
target is the friction at all quadrature points under the preload pressure, in states of the joint in partial
slip: generalised forces on motions and modes, and the loss per cycle. This is a cubature (hyper-reduction) of
the friction work. It adds no cost to the joint model.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from scipy.linalg import cho_factor, cho_solve
from scipy.spatial import cKDTree

from jointfmu.mechanics.footprint.distribution import FrictionPatches
from jointfmu.mechanics.footprint.patch_reduction import SLIDER_CIRCLE_POINTS
from jointfmu.mechanics.sliders import Foundation
from jointfmu.quantity import Array

SHEAR_COMBINATION_WEIGHT = np.sqrt(0.5)
"""Weight of each of two states that are combined [1]."""
REGULARISATION_WEIGHT = 0.1
"""Weight of the change of the patch displacements (regularisation) over the weight of the forces [1]."""
MAX_FIT_STEPS = 10
"""Largest number of steps of the Levenberg-Marquardt method."""
INITIAL_FIT_DAMPING, FIT_DAMPING_DECREASE, FIT_DAMPING_INCREASE, MAX_FIT_DAMPING = 1e-3, 0.2, 5.0, 1e6
"""Levenberg-Marquardt damping over the diagonal of the normal equations [1]: initial value, factor after a
successful step, factor after a failed step, largest value."""
STICK_STIFFNESS_ERROR_WEIGHT = 300.0
"""Weight of the error of the stick stiffness, relative to the joint stiffness, over the weight of forces and
losses [1]. The stiffness error stays below 2e-4. A larger weight makes the valley of the objective too narrow
for the steps."""
MIN_TANGENTIAL_DISPLACEMENT = 1e-15
"""Smallest tangential displacement in divisions [m]."""
MIN_CYCLE_LOSS_OVER_STICK_WORK = 0.01
"""Loss per cycle over the work of the stick forces [1]: lower limit for scales of losses. Rough surfaces lose
more at the smallest motion; an interface of constant stiffness loses nothing below its friction limit."""
MIN_OVER_MAX_MEAN_SQUARE_DISTANCE = 1e-12
"""Mean square distance of the points of a cell from its centre over the largest one [1]; below: round-off."""
MIN_RELATIVE_DISPLACEMENT_SCALE = 0.03
"""Lower limit of the scale of patch displacements by a mode, over the largest scale of all modes [1]."""


def shear_combinations(state_motions: Array) -> Array:
    """Coefficients (w, s) [1] of w linear combinations of s states of the joint with tangential motion.

    The combinations are the states that move along x only, along y only and about z only (equally many of
    each kind), then sums and differences of states of two kinds.

    state_motions : (s, 6) [m, rad] of the states
    """
    single = np.flatnonzero(~np.any(state_motions[:, 2:5], axis=1))
    single = single[np.count_nonzero(state_motions[single], axis=1) == 1]
    identity = np.eye(len(state_motions))
    axes = [identity[single[state_motions[single][:, axis] != 0.0]] for axis in (0, 1, 5)]
    pairs = [(axes[i], axes[j], sign) for i, j in ((0, 1), (0, 2), (1, 2)) for sign in (1.0, -1.0)]
    return np.concatenate([*axes, *(SHEAR_COMBINATION_WEIGHT * (a + sign * b) for a, b, sign in pairs)])


@dataclass(frozen=True)
class ShearStates:
    """s states of the joint in shear: motion of side 2, and coordinates of the k modes of the bodies.

    rigid_motion      : (s, 3) [m, rad] of side 2 along x, along y and about z
    modal_coordinates : (s, k) [m]
    """

    rigid_motion: Array
    modal_coordinates: Array

    @property
    def generalised_coordinates(self) -> Array:
        """Motions and modal coordinates (s, 3 + k) [m, rad]."""
        return np.concatenate([self.rigid_motion, self.modal_coordinates], axis=1)


@dataclass(frozen=True)
class FrictionPoints:
    """Points (n) with friction: quadrature points of the contact, or sliders of the patches.

    point_area         : (n) [m2]
    preloaded_approach : (n) [m] in the preloaded joint
    rigid_displacement : (2 n, 3) displacement along x (n), then along y (n), by rigid-body motions along x,
                         along y and about z
    """

    point_area: Array
    preloaded_approach: Array
    rigid_displacement: Array


@dataclass(frozen=True)
class FrictionWork:
    """Generalised friction forces, and energy loss per cycle, of a joint in s states in shear.

    friction_forces : generalised friction forces (s, 3 + k) [N, N.m] on three motions and k modes
    stick_forces    : generalised friction forces (s, 3 + k) [N, N.m] if no point slipped
    cycle_loss      : (s) [J] energy loss per cycle with the displacement of the state as amplitude
    """

    friction_forces: Array
    stick_forces: Array
    cycle_loss: Array


def _generalised_force_scales(generalised_forces: Array) -> Array:
    """Divisors (s, 3 + k) for errors of generalised forces on 3 motions and k modes, in s states.

    Each state has one divisor for the motions along x and y, one for the rotation, and one for the modes.
    """
    force, moment, modes = (
        np.linalg.norm(f, axis=1)
        for f in (generalised_forces[:, :2], generalised_forces[:, 2:3], generalised_forces[:, 3:])
    )
    lever_arm = np.max(moment) / np.max(force)
    force = np.hypot(force, moment / lever_arm)
    modes = np.maximum(modes, MIN_RELATIVE_DISPLACEMENT_SCALE * np.max(modes / force) * force)
    return np.stack([force, force, lever_arm * force, *[modes] * (generalised_forces.shape[1] - 3)], axis=1)


@dataclass(frozen=True)
class MonotonicFriction:
    """Friction law in monotonic loading, evaluated in s states of the joint at n points; all arrays (s, n).

    displacement_x, displacement_y : tangential displacement along x and y [m]
    displacement_magnitude         : magnitude of the tangential displacement [m]
    secant_stiffness               : traction over displacement [Pa/m]
    tangent_stiffness              : derivative of the traction [Pa/m]
    stick_stiffness                : stiffness without slip [Pa/m]
    cycle_loss                     : energy loss per cycle whose amplitude is displacement_magnitude [J/m2]
    cycle_loss_derivative          : derivative of cycle_loss with respect to the magnitude [Pa]
    """

    displacement_x: Array
    displacement_y: Array
    displacement_magnitude: Array
    secant_stiffness: Array
    tangent_stiffness: Array
    stick_stiffness: Array
    cycle_loss: Array
    cycle_loss_derivative: Array

    @classmethod
    def evaluate_law(
        cls, friction_law: Foundation, point_approach: Array, tangential_displacement: Array
    ) -> "MonotonicFriction":
        """Friction of n points at approaches [m] and displacements (s, 2 n) [m] along x, then y."""
        u, v = np.split(tangential_displacement, 2, axis=1)
        size = np.maximum(np.hypot(u, v), MIN_TANGENTIAL_DISPLACEMENT)
        stick, tangent = (
            friction_law.stiffness_ratio * friction_law.pressure_curve.derivatives(x, 1)[1]
            for x in (
                point_approach,
                point_approach - friction_law.stiffness_ratio / friction_law.friction_coefficient * size,
            )
        )
        stick = np.broadcast_to(stick, size.shape)
        force = np.minimum(friction_law.virgin_traction(point_approach, size), stick * size)
        rate = 4.0 * (force - tangent * size)
        return cls(
            u,
            v,
            size,
            force / size,
            tangent,
            stick,
            friction_law.cycle_energies(point_approach, size)[0],
            rate,
        )


@dataclass(frozen=True)
class StickContactStiffness:
    """Tangential stiffness of the contact in the linear joint, where no point slips.

    unit_motion_states : w = 3 states of the linear joint, a unit motion along x, along y and about z
    contact_stiffness  : (w, w) [N/m, N, N.m] twice the strain energy of the contact for each pair of states
    joint_stiffness    : (w) [N/m, N.m] of the joint along each motion
    """

    unit_motion_states: ShearStates
    contact_stiffness: Array
    joint_stiffness: Array

    @cached_property
    def stiffness_scale(self) -> Array:
        """Scale (w, w) [N/m, N, N.m] of stiffness errors: geometric mean of the joint stiffnesses."""
        return np.sqrt(np.outer(self.joint_stiffness, self.joint_stiffness))


@dataclass(frozen=True)
class PatchFit:
    """Least-squares problem: the friction of m patches shall equal that at all quadrature points.

    friction_law            : friction law of the interface
    shear_states            : states in shear in which the friction is compared
    patch_sliders           : c sliders of each patch: the first of all patches, then the second of all
                              patches, ...
    rotation_displacement   : (2 c m, k) [1] displacement of the sliders along x, then y, by the rotation of
                              the patches in k modes
    target_friction_work    : friction at all quadrature points
    stick_contact_stiffness : stick stiffness of the complete contact, which the patches keep
    """

    friction_law: Foundation
    shear_states: ShearStates
    patch_sliders: FrictionPoints
    rotation_displacement: Array
    target_friction_work: FrictionWork
    stick_contact_stiffness: StickContactStiffness

    @cached_property
    def residual_scales(self) -> tuple[Array, Array, Array]:
        """Divisors of the errors of forces, stick forces (s, 3 + k) and losses (s), for equal weights."""
        target = self.target_friction_work
        work = np.sum(self.shear_states.generalised_coordinates * target.stick_forces, axis=1)
        return (
            _generalised_force_scales(target.friction_forces),
            _generalised_force_scales(target.stick_forces),
            np.maximum(target.cycle_loss, MIN_CYCLE_LOSS_OVER_STICK_WORK * work),
        )

    def evaluate_sliders(
        self, shear_states: ShearStates, patch_displacement: Array
    ) -> tuple[Array, MonotonicFriction]:
        """Evaluate the friction of all sliders in states of the joint.

        patch_displacement : (2 m, k) [1] displacement of the patches along x, then along y, by the modes

        Returns the displacement (2 c m, 3 + k) of all sliders (c on each of m patches) by 3 motions and k
        modes, and their friction.
        """
        count = len(self.rotation_displacement) // len(patch_displacement)
        by_modes = (
            np.concatenate([np.tile(half, (count, 1)) for half in np.split(patch_displacement, 2)])
            + self.rotation_displacement
        )
        return evaluate_friction(self.friction_law, shear_states, self.patch_sliders, by_modes)

    def fit_patches(self, patch_displacement: Array) -> Array:
        """Fit the displacements (2 m, k) of m patches by k modes, from initial values (Levenberg-Marquardt).

        The preloaded joint keeps the stiffness of its finite elements: in the equilibrium of the linear
        joint, the contact stores the same energy. There, forces on modes have only an effect of second order.
        """
        typical = np.sqrt(np.mean(patch_displacement**2, axis=0))
        weight = (
            REGULARISATION_WEIGHT
            * np.sqrt(len(self.target_friction_work.cycle_loss) / patch_displacement.size)
            / np.maximum(typical, MIN_RELATIVE_DISPLACEMENT_SCALE * typical.max())
        )
        weight = np.broadcast_to(weight, patch_displacement.shape)
        initial = patch_displacement
        damping = INITIAL_FIT_DAMPING
        errors, work = self._work_errors(patch_displacement)
        stiffness_errors, unit_friction = self._stiffness_errors(patch_displacement)
        for _ in range(MAX_FIT_STEPS):
            work_jacobian = self._work_jacobian(patch_displacement, *work)
            stiffness_jacobian = self._stiffness_jacobian(patch_displacement, unit_friction)
            changes = (weight * (patch_displacement - initial)).ravel()
            hessian = work_jacobian.T @ work_jacobian + np.diag(weight.ravel() ** 2)
            gradient = (
                work_jacobian.T @ errors + weight.ravel() * changes + stiffness_jacobian.T @ stiffness_errors
            )
            objective = errors @ errors + changes @ changes + stiffness_errors @ stiffness_errors
            stiff_hessian = hessian + stiffness_jacobian.T @ stiffness_jacobian
            while damping < MAX_FIT_DAMPING:
                damped = stiff_hessian + damping * np.diag(np.diag(hessian))
                factor = cho_factor(damped, overwrite_a=True, check_finite=False)
                step = cho_solve(factor, -gradient, check_finite=False)
                trial = patch_displacement + step.reshape(patch_displacement.shape)
                errors, work = self._work_errors(trial)
                stiffness_errors, unit_friction = self._stiffness_errors(trial)
                changes = (weight * (trial - initial)).ravel()
                if errors @ errors + changes @ changes + stiffness_errors @ stiffness_errors < objective:
                    break
                damping *= FIT_DAMPING_INCREASE
            else:
                return patch_displacement
            patch_displacement = trial
            damping = FIT_DAMPING_DECREASE * damping
        return patch_displacement

    def _stiffness_errors(self, patch_displacement: Array) -> tuple[Array, MonotonicFriction]:
        """Weighted relative errors [1] of the stick stiffness of the patches: upper triangle (3, 3), flat.

        Returns the errors, and the friction of the sliders for unit motions of the joint in full stick.
        """
        _, friction = self.evaluate_sliders(
            self.stick_contact_stiffness.unit_motion_states, patch_displacement
        )
        error = (
            stick_stiffness_matrix(friction, self.patch_sliders.point_area)
            - self.stick_contact_stiffness.contact_stiffness
        ) / self.stick_contact_stiffness.stiffness_scale
        return np.asarray(STICK_STIFFNESS_ERROR_WEIGHT * error[np.triu_indices(len(error))]), friction

    def _stiffness_jacobian(self, patch_displacement: Array, slider_friction: MonotonicFriction) -> Array:
        """Derivative of the errors of the stick stiffness with respect to the patch displacements.

        slider_friction : friction forces of the sliders for unit motions of the joint in full stick
        """
        force = (
            self.patch_sliders.point_area
            * slider_friction.stick_stiffness
            * np.stack([slider_friction.displacement_x, slider_friction.displacement_y])
        ).swapaxes(0, 1)
        force = (
            force.reshape(len(force), 2, -1, len(patch_displacement) // 2).sum(axis=2).reshape(len(force), -1)
        )
        half = np.einsum(
            "im,jk->ijmk", force, self.stick_contact_stiffness.unit_motion_states.modal_coordinates
        )
        slope = (half + half.swapaxes(0, 1)) / self.stick_contact_stiffness.stiffness_scale[:, :, None, None]
        return np.asarray(
            STICK_STIFFNESS_ERROR_WEIGHT
            * slope[np.triu_indices(len(slope))].reshape(-1, patch_displacement.size)
        )

    def _work_errors(self, patch_displacement: Array) -> tuple[Array, tuple[Array, MonotonicFriction]]:
        """Relative errors [1] of the patches' friction against the friction at all quadrature points.

        The errors are those of generalised friction forces, of these forces if nothing slips (stick forces),
        and of the losses per cycle, in all states in shear.

        Returns the errors, and the displacement and friction of the sliders.
        """
        displacement, friction = self.evaluate_sliders(self.shear_states, patch_displacement)
        actual = assemble_friction_work(friction, self.patch_sliders.point_area, displacement)
        target = self.target_friction_work
        pairs = (
            (actual.friction_forces, target.friction_forces),
            (actual.stick_forces, target.stick_forces),
            (actual.cycle_loss, target.cycle_loss),
        )
        errors = [((a - b) / size).ravel() for (a, b), size in zip(pairs, self.residual_scales, strict=True)]
        return np.concatenate(errors), (displacement, friction)

    def _work_jacobian(
        self, patch_displacement: Array, displacement: Array, slider_friction: MonotonicFriction
    ) -> Array:
        """Derivative of the errors of friction forces and losses with respect to the patch displacements.

        displacement, slider_friction : displacement (2 c m, 3 + k) and friction of the sliders
        """
        area, amplitude = self.patch_sliders.point_area, self.shear_states.modal_coordinates
        (n_states, modes), count = amplitude.shape, len(patch_displacement) // 2
        u, v, size = (
            slider_friction.displacement_x,
            slider_friction.displacement_y,
            slider_friction.displacement_magnitude,
        )
        direction, halves = (u / size, v / size), np.split(displacement, 2)
        secant, tangent = slider_friction.secant_stiffness, slider_friction.tangent_stiffness

        def sum_products_over_sliders(slider_stiffness: Array, slider_displacement: Array) -> Array:
            """Slider stiffness (s states) times displacement (3 + k motions and modes), summed in each patch.

            Returns an array (s, 3 + k, m) for m patches.
            """
            factors = (
                slider_stiffness.reshape(n_states, -1, count),
                slider_displacement.reshape(-1, count, 3 + modes),
            )
            return np.einsum("scm,cmh->shm", *factors)

        def sum_over_sliders(slider_values: Array) -> Array:
            """Values of the sliders in s states, summed over the sliders of each of m patches: (s, m)."""
            return slider_values.reshape(n_states, -1, count).sum(axis=1)

        forces, loss = np.zeros((2, n_states, 3 + modes, 2, count)), np.zeros((n_states, 2, count))
        patch_forces, springs = np.zeros((2, n_states, 2, count)), area * slider_friction.stick_stiffness
        for i, shift in enumerate((u, v)):
            for j in range(2):
                slope = area * ((i == j) * secant + (tangent - secant) * direction[i] * direction[j])
                forces[0, :, :, i] += sum_products_over_sliders(slope, halves[j])
            forces[1, :, :, i] = sum_products_over_sliders(springs, halves[i])
            patch_forces[:, :, i] = sum_over_sliders(area * secant * shift), sum_over_sliders(springs * shift)
            loss[:, i] = sum_over_sliders(area * slider_friction.cycle_loss_derivative * direction[i])
        force_derivative, mode = forces[..., None] * amplitude[:, None, None, None], np.arange(modes)
        force_derivative[:, :, 3 + mode, :, :, mode] += patch_forces
        derivatives = *force_derivative, loss[..., None] * amplitude[:, None, None]
        pairs = zip(derivatives, self.residual_scales, strict=True)
        return np.concatenate(
            [(x / s.reshape(s.shape + (1,) * 3)).reshape(-1, patch_displacement.size) for x, s in pairs]
        )


def rigid_displacement_matrix(point_position: Array) -> Array:
    """Displacement (2 n, 3) of positions (n, 2) [m] by unit motions along x, along y and about z.

    The first n rows are the displacement along x, the others along y.
    """
    x, y = point_position.T
    unit, zero = np.ones_like(x), np.zeros_like(x)
    return np.concatenate([np.stack([unit, zero, -y], axis=1), np.stack([zero, unit, x], axis=1)])


def patch_rotations(
    quadrature_position: Array,
    friction_patches: FrictionPatches,
    averaging_matrix: sp.csr_matrix,
    tangential_displacements: list[Array],
) -> Array:
    """Rotation (m, k) [1/m] of each of m patches about its centre by each of k modes.

    The rotation is a mean over the cell of each patch, weighted by the averaging matrix and the squared
    distance from the centre.

    quadrature_position      : (q, 2) [m] of the quadrature points
    averaging_matrix         : averaging matrix (m, q) [1]
    tangential_displacements : displacement (q, k) [1] of the quadrature points along x and y by the modes
    """
    cell = cKDTree(friction_patches.position).query(quadrature_position)[1]
    x, y = (quadrature_position - (averaging_matrix @ quadrature_position)[cell]).T
    lever = x[:, None] * tangential_displacements[1] - y[:, None] * tangential_displacements[0]
    square = averaging_matrix @ (x * x + y * y)
    extended = (
        square > MIN_OVER_MAX_MEAN_SQUARE_DISTANCE * square.max()
    )  # a cell with one point does not rotate
    inverse = np.where(extended, 1.0 / np.where(extended, square, 1.0), 0.0)
    return np.asarray(inverse[:, None] * (averaging_matrix @ lever))


def place_sliders(
    friction_patches: FrictionPatches, contact_area: float, patch_approach: Array, modal_rotations: Array
) -> tuple[FrictionPoints, Array]:
    """Place c sliders on each of m patches: one at the centre, or c on a circle if patches have a radius.

    contact_area    : nominal contact area [m2]
    patch_approach  : (m) [m] of the patches in the preloaded joint
    modal_rotations : (m, k) [1/m] of the patches by the modes

    Returns the sliders (c m), and their displacement (2 c m, k) [1] by the rotation of the patches.
    """
    circle = (
        SLIDER_CIRCLE_POINTS
        if np.any(friction_patches.slider_circle_radius)
        else 0.0 * SLIDER_CIRCLE_POINTS[:1]
    )
    offset = circle[:, None] * friction_patches.slider_circle_radius[:, None]
    count, (x, y) = len(circle), offset.reshape(-1, 2).T[:, :, None]
    slider_rotations = np.tile(modal_rotations, (count, 1))
    sliders = FrictionPoints(
        np.tile(contact_area * friction_patches.area_share / count, count),
        np.tile(patch_approach, count),
        rigid_displacement_matrix((friction_patches.position + offset).reshape(-1, 2)),
    )
    return sliders, np.concatenate([-y * slider_rotations, x * slider_rotations])


def evaluate_friction(
    friction_law: Foundation,
    shear_states: ShearStates,
    friction_points: FrictionPoints,
    modal_displacement: Array,
) -> tuple[Array, MonotonicFriction]:
    """Evaluate the friction of n points in states of the joint.

    modal_displacement : (2 n, k) [1] of the points along x, then along y, by the modes

    Returns the displacement (2 n, 3 + k) of the points by 3 motions and k modes, and their friction.
    """
    displacement = np.concatenate([friction_points.rigid_displacement, modal_displacement], axis=1)
    return displacement, MonotonicFriction.evaluate_law(
        friction_law,
        friction_points.preloaded_approach,
        shear_states.generalised_coordinates @ displacement.T,
    )


def assemble_friction_work(
    monotonic_friction: MonotonicFriction, point_area: Array, point_displacement: Array
) -> FrictionWork:
    """Generalised friction forces and energy loss of n points in contact.

    point_area         : (n) [m2]
    point_displacement : (2 n, 3 + k) of the points by motions and modes
    """
    forces, stick_forces = (
        np.concatenate(
            [
                point_area * slope * shift
                for shift in (monotonic_friction.displacement_x, monotonic_friction.displacement_y)
            ],
            axis=1,
        )
        @ point_displacement
        for slope in (monotonic_friction.secant_stiffness, monotonic_friction.stick_stiffness)
    )
    return FrictionWork(forces, stick_forces, monotonic_friction.cycle_loss @ point_area)


def stick_stiffness_matrix(monotonic_friction: MonotonicFriction, point_area: Array) -> Array:
    """Stick stiffness (w, w) [N/m, N, N.m] of points with areas (n) [m2] for each pair of w states."""
    return np.asarray(
        sum(
            (point_area * monotonic_friction.stick_stiffness * shift) @ shift.T
            for shift in (monotonic_friction.displacement_x, monotonic_friction.displacement_y)
        )
    )


def compute_friction_work(
    friction_law: Foundation,
    shear_states: ShearStates,
    friction_points: FrictionPoints,
    modal_displacement: Array,
) -> FrictionWork:
    """Generalised friction forces and energy loss of n points, in states of the joint.

    modal_displacement : (2 n, k) [1] of the points along x, then along y, by the modes
    """
    displacement, friction = evaluate_friction(
        friction_law, shear_states, friction_points, modal_displacement
    )
    return assemble_friction_work(friction, friction_points.point_area, displacement)
