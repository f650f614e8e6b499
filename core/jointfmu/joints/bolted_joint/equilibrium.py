"""Static equilibrium of a bolted joint with elastic members, over one load step.

The relative displacement q of side 2 is prescribed: s_x, s_y, s_z [m], theta_x, theta_y, theta_z [rad]. The
modal coordinates a [m] of the members are unknown. Both open the points of the contact, displace the friction
patches along the surface and elongate the bolts, by G_q q + G_a a. In equilibrium the residual is zero:

    r(a) = S a + G_a^T f = 0,    f = -(p - p_preload) A at points, t A at patches, k_b e at bolts

S modal stiffness, p contact pressure, t traction, A area, k_b and e stiffness and elongation of a bolt. k_b e
is at least the negative preload of the bolt, see `BoltSprings`.

Newton's method takes the part of H (below) for a as its first Jacobian, and corrects it by Broyden's update.
It computes J after an iteration that reduces the residual too little (see
MAX_RESIDUAL_RATIO_FOR_JACOBIAN_REUSE), and after a correction that the line search shortens or drops. A load
step that does not converge is divided: q is
then prescribed at step fractions between 0 (start of the load step) and 1 (end). The fractions only lead a to
the solution: friction always gets one straight increment from the start of the load step to the trial state,
so its history does not contain them. Shapes: n points, m patches, b bolts, k modes.

Five derivatives of forces occur in this module. Where the C code has them, they have the same names:

- tangent stiffness H (6 + k, 6 + k): of the assembly with respect to q and a, at fixed friction limits,
  symmetric. `compliances.py` condenses it to q, for outputs; the equilibrium does not need the result.
- residual Jacobian J = dr/da (k, k): with the change of the friction limits by the pressure, not symmetric.
- friction tangent (m, 6): of the traction of each patch, with respect to its tangential displacement.
- active bolt stiffness (b): k_b of a bolt, 0 if its head has lifted off.
- continued-motion stiffness (3), `friction.py`: of the shear forces of the joint with rigid members, if the
  motion goes on. It is an output.

An assembly is a `JointAssembly`: members, contact and bolts as one mechanical system. The state after the
bolts are tightened is called preload state.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ...quantity import Array
from .bodies import MemberModes
from .bolts import BoltSprings
from .contact import Contact, NormalState, PreloadState
from .friction import FrictionUpdate
from .kinematics import opening_jacobian, rigid_opening, tangential_displacement, tangential_jacobian

RELATIVE_RESIDUAL_TOLERANCE = 1e-13
"""Residual over the sum of all forces [1] that counts as equilibrium: the round-off of the sum. The force at
which the closing of the contact ends is part of the sum: all other forces vanish if the joint is open."""
RIGID_OPENING_WEIGHT_IN_TOLERANCE = 0.02
"""Share [1] of a force that counts in the sum of RELATIVE_RESIDUAL_TOLERANCE: contact stiffness times the
largest opening by rigid motion. The deformation of the members nearly cancels this force."""
INTERMEDIATE_TOLERANCE_FACTOR = 1e7
"""Tolerance inside a divided load step over the tolerance at its end [1]."""
MAX_NEWTON_ITERATIONS, MAX_LINE_SEARCH_TRIALS = 16, 6
"""Newton iterations at one step fraction [1], and trial lengths in each iteration [1]."""
MAX_RESIDUAL_RATIO_FOR_JACOBIAN_REUSE = 0.03
"""Residual after an iteration over the residual before [1], below which J is reused."""
MAX_FINAL_OVER_INITIAL_ENERGY_SLOPE = 0.5
"""Energy slope at the end of a correction over its initial size [1], above which the step is too long."""
MIN_SHORTENING_FACTOR = 0.1
"""Smallest factor [1] by which the line search shortens a correction of the modal coordinates at once."""
MIN_STEP_FRACTION_INCREMENT = 1e-4
"""Increment of the step fraction [1] below which Newton's method gives up a load step. The step fraction runs
from 0 at the start of the load step to 1 at its end."""
TRACTION_FINITE_DIFFERENCE_STEP = 1e-7
"""Displacement step of the finite differences of the tractions, over the largest patch approach after
tightening, counted from first contact [1].

Without preload all patches are open: then over the approach from first contact to the end of the closing."""


@dataclass(frozen=True, slots=True)
class TrialState:
    """Contact, friction and residual at trial modal coordinates: k modes, m friction patches, b bolts.
    modal_coordinates    : a (k) [m]
    normal_state         : contact of points and patches
    tangential_increment : displacement (m, 3) [m] of the patches since the start of the load step
    friction_update      : tractions, tangent and history variables of the patches
    elongation           : (b) [m] of the bolts since tightening
    residual             : r (k) [N]
    residual_tolerance   : [N] the state is in equilibrium if no entry of r is larger, see
                           RELATIVE_RESIDUAL_TOLERANCE
    """

    modal_coordinates: Array
    normal_state: NormalState
    tangential_increment: Array
    friction_update: FrictionUpdate
    elongation: Array
    residual: Array
    residual_tolerance: float

    @property
    def residual_norm(self) -> float:
        """Largest magnitude of an entry of the residual r [N]."""
        return float(np.max(np.abs(self.residual)))


@dataclass(frozen=True)
class JointAssembly:
    """Members, contact interface and bolts of a joint as one mechanical system.

    The Jacobians G = [G_q G_a] are derivatives of openings, tangential displacements and bolt elongations
    with respect to the relative displacement q and the modal coordinates a.

    nominal_area : nominal area of the interface [m2]
    """

    contact: Contact
    modes: MemberModes
    bolts: BoltSprings
    nominal_area: float

    @cached_property
    def point_area(self) -> Array:
        """Nominal areas (n) [m2] of the n contact points."""
        return self.nominal_area * self.contact.points.area_share

    @cached_property
    def patch_area(self) -> Array:
        """Nominal areas (m) [m2] of the m friction patches."""
        return self.nominal_area * self.contact.patches.area_share

    @cached_property
    def full_opening_jacobian(self) -> Array:
        """Derivatives G (n, 6 + k) [1, m] of the opening of the n contact points with respect to q and a."""
        return np.hstack([opening_jacobian(self.contact.points.position), self.modes.point_opening])

    @cached_property
    def full_tangential_jacobian(self) -> Array:
        """Derivatives G (3, m, 6 + k) [1, m] of the tangential displacement of m patches by q and a.

        Displacement along x, along y, and rotation times the patch radius; derivatives with respect to the
        relative displacement q (6) and the modal coordinates a (k).
        """
        rigid = tangential_jacobian(self.contact.patches)
        return np.concatenate([rigid, self.modes.patch_displacement], axis=-1)

    @cached_property
    def full_elongation_jacobian(self) -> Array:
        """Derivatives G (b, 6 + k) [1, m] of the elongation of the b bolts with respect to q and a."""
        return np.hstack([opening_jacobian(self.bolts.position), self.modes.bolt_elongation])

    def evaluate_normal(
        self, preload_state: PreloadState, relative_displacement: Array, modal_coordinates: Array
    ) -> NormalState:
        """Approach and pressure of the contact at displacement q (6) and modal coordinates a (k) [m]."""
        return self.contact.evaluate_normal(
            preload_state, relative_displacement, self.modes.point_opening @ modal_coordinates
        )

    def tangential_displacement(self, relative_displacement: Array, modal_coordinates: Array) -> Array:
        """Displacement (m, 3) [m] of the patches: along x, along y, and rotation times the patch radius."""
        elastic = (self.modes.patch_displacement @ modal_coordinates).T
        return np.asarray(tangential_displacement(self.contact.patches, relative_displacement) + elastic)

    def elongation(self, relative_displacement: Array, modal_coordinates: Array) -> Array:
        """Elongation (b) [m] of the bolts."""
        return np.asarray(
            rigid_opening(self.bolts.position, relative_displacement)
            + self.modes.bolt_elongation @ modal_coordinates
        )

    def residual(
        self, modal_coordinates: Array, pressure_change: Array, traction: Array, bolt_force_change: Array
    ) -> Array:
        """Residual r (k) [N] of the static equilibrium at modal coordinates a (k) [m].

        traction                           : t (m, 3) [Pa] against the displacement of the patches
        pressure_change, bolt_force_change : (n) [Pa], (b) [N] since tightening
        """
        modes = self.modes
        r = modes.modal_stiffness * modal_coordinates + modes.bolt_elongation.T @ bolt_force_change
        r = r - modes.point_opening.T @ (self.point_area * pressure_change)
        for axis in range(3):
            r = r + modes.patch_displacement[axis].T @ (self.patch_area * traction[:, axis])
        return np.asarray(r)

    def tangent_stiffness(
        self, contact_stiffness: Array, friction_tangent: Array, active_bolt_stiffness: Array
    ) -> Array:
        """Tangent stiffness H (6 + k, 6 + k) [N/m, N, N.m] with respect to q and a, at fixed friction limits.

        contact_stiffness     : (n) [Pa/m] of the points
        friction_tangent      : (m, 6) [Pa/m] of the patches: xx, xy, yy, xr, yr, rr; r: rotation of a patch
        active_bolt_stiffness : (b) [N/m] of the bolts
        """
        normal, (u, v, w), bolts = (
            self.full_opening_jacobian,
            self.full_tangential_jacobian,
            self.full_elongation_jacobian,
        )
        xx, xy, yy, xr, yr, rr = (self.patch_area * friction_tangent.T)[:, :, None]
        H = normal.T @ ((self.point_area * contact_stiffness)[:, None] * normal)
        H += (active_bolt_stiffness * bolts.T) @ bolts
        H += u.T @ (xx * u + xy * v + xr * w) + v.T @ (xy * u + yy * v + yr * w)
        H += w.T @ (xr * u + yr * v + rr * w)
        H[6:, 6:] += np.diag(self.modes.modal_stiffness)
        return np.asarray(H)


@dataclass(frozen=True, slots=True)
class LoadStep:
    """Straight path of the relative displacement q, from the last equilibrium to the prescribed inputs.

    Preload, bending moment and temperature have their values at the end from the start of the step on.

    preload_state, preload_bolt_force    : contact, and force (b) [N] of the bolts, at tightening
    start_displacement, end_displacement : q (6) [m, rad] at step fractions 0 and 1
    modal_coordinates                    : a (k) [m] at the start
    friction_tangent                     : (m, 6) [Pa/m] of the patches at the start
    update_friction                      : friction law with the history at the start, a function of the patch
                                           approach (m) [m] and tangential displacement (m, 3) [m] since then
    input_summary                        : inputs at the end, for the error message
    """

    assembly: JointAssembly
    preload_state: PreloadState
    preload_bolt_force: Array
    start_displacement: Array
    end_displacement: Array
    modal_coordinates: Array
    friction_tangent: Array
    update_friction: Callable[[Array, Array], FrictionUpdate]
    input_summary: str

    def displacement_at(self, step_fraction: float) -> Array:
        """Relative displacement q (6) [m, rad] at a step fraction [1]."""
        return (
            self.end_displacement
            if step_fraction == 1.0
            else self.start_displacement + step_fraction * (self.end_displacement - self.start_displacement)
        )

    def evaluate_trial(self, relative_displacement: Array, modal_coordinates: Array) -> TrialState:
        """Contact, friction and residual at relative displacement q (6) and modal coordinates a (k) [m]."""
        assembly, bolts = self.assembly, self.assembly.bolts
        normal = assembly.evaluate_normal(self.preload_state, relative_displacement, modal_coordinates)
        increment = assembly.tangential_displacement(
            relative_displacement - self.start_displacement, modal_coordinates - self.modal_coordinates
        )
        friction = self.update_friction(normal.patch_approach, increment)
        elongation = assembly.elongation(relative_displacement, modal_coordinates)
        traction, preload_pressure = friction.traction, self.preload_state.pressure
        # without bolts_per_position: elastic members state the position of every bolt, so it is 1
        bolt_force_change = bolts.stiffness * (
            elongation + bolts.head_gap(self.preload_bolt_force, elongation)
        )
        residual = assembly.residual(
            modal_coordinates, normal.pressure - preload_pressure, traction, bolt_force_change
        )

        force_sum = assembly.point_area @ (normal.pressure + preload_pressure)
        force_sum += np.sum(np.abs(bolt_force_change)) + np.sum(assembly.patch_area @ np.abs(traction))
        rigid = np.max(np.abs(rigid_opening(assembly.contact.points.position, relative_displacement)))
        force_sum += (assembly.point_area @ normal.stiffness) * rigid * RIGID_OPENING_WEIGHT_IN_TOLERANCE
        force_sum += assembly.nominal_area * assembly.contact.pressure_curve.closing_end_pressure
        tolerance = float(RELATIVE_RESIDUAL_TOLERANCE * force_sum)
        return TrialState(modal_coordinates, normal, increment, friction, elongation, residual, tolerance)

    def residual_jacobian(self, trial_state: TrialState) -> Array:
        """Jacobian J = dr/da (k, k) [N/m] of the residual with respect to the modal coordinates."""
        assembly, modes = self.assembly, self.assembly.modes
        active_bolt_stiffness = assembly.bolts.active_stiffness(
            self.preload_bolt_force, trial_state.elongation
        )
        J = (
            np.diag(modes.modal_stiffness)
            + (active_bolt_stiffness * modes.bolt_elongation.T) @ modes.bolt_elongation
        )
        J += modes.point_opening.T @ (
            (assembly.point_area * trial_state.normal_state.stiffness)[:, None] * modes.point_opening
        )
        motions = np.concatenate(
            [modes.patch_displacement, self.patch_opening_jacobian(trial_state.normal_state)[None]]
        )
        derivatives = self.traction_derivatives(trial_state)
        for axis in range(3):
            J += modes.patch_displacement[axis].T @ np.einsum(
                "m,mc,cmk->mk", assembly.patch_area, derivatives[:, axis], motions
            )
        return np.asarray(J)

    def patch_opening_jacobian(self, normal_state: NormalState) -> Array:
        """Derivative (m, k) [1] of the patch openings with respect to the modal coordinates a (k).

        The opening of a patch changes its pressure as much as the points that transfer pressure to it do.
        """
        contact = self.assembly.contact
        stiffness = contact.pressure_curve.derivatives(normal_state.patch_approach, 1)[1][:, None]
        closed = stiffness > 0.0
        pressure = (contact.pressure_transfer * normal_state.stiffness) @ self.assembly.modes.point_opening
        return np.asarray(np.where(closed, pressure / np.where(closed, stiffness, 1.0), 0.0))

    def traction_derivatives(self, trial_state: TrialState) -> Array:
        """Derivatives (m, 3, 4) [Pa/m] of the friction tractions, by finite differences.

        For each of m patches: its three tractions (along x, along y, around its centre), differentiated with
        respect to the three tangential displacements and the opening.
        """
        first = self.assembly.contact.pressure_curve.displacement[0]
        size = TRACTION_FINITE_DIFFERENCE_STEP * float(
            np.max(np.maximum(self.preload_state.patch_approach, 0.0) - first)
        )
        traction, columns = trial_state.friction_update.traction, []
        for motion in size * np.eye(4):
            increment = trial_state.tangential_increment + motion[:3]
            friction = self.update_friction(trial_state.normal_state.patch_approach - motion[3], increment)
            columns.append((friction.traction - traction) / size)
        return np.stack(columns, axis=-1)


class ModalPredictor(NamedTuple):
    """Modal coordinates at the end of a load step, predicted with the tangent stiffness H at its start.

    modal_coordinates       : (k) [m] predicted values
    modal_tangent_stiffness : (k, k) [N/m] part of H for the modal coordinates, the first J of Newton's method
    """

    modal_coordinates: Array
    modal_tangent_stiffness: Array


def solve_equilibrium(load_step: LoadStep) -> TrialState:
    """Equilibrium at the end of a load step, which is divided where Newton's method does not converge.

    Raises ValueError if there is no equilibrium, with the inputs, the step fraction and the residual.
    """
    a, step_fraction, increment = load_step.modal_coordinates, 0.0, 1.0
    predictor = predict_by_tangent(load_step)
    rate = predictor.modal_coordinates - a
    while True:
        target = min(step_fraction + increment, 1.0)
        state, converged = solve_newton(
            load_step, target, a + (target - step_fraction) * rate, predictor.modal_tangent_stiffness
        )
        if not converged:
            increment *= 0.5
            if increment < MIN_STEP_FRACTION_INCREMENT:
                raise ValueError(
                    f"{load_step.input_summary}: no equilibrium of the joint was found: the solution stopped "
                    f"after a fraction {step_fraction:.3g} of the load step, with a residual force of "
                    f"{state.residual_norm:.2g} N; check the size of the inputs, and [bodies]"
                )
        elif target == 1.0:
            return state
        else:
            rate = (state.modal_coordinates - a) / (target - step_fraction)
            a, step_fraction, increment = state.modal_coordinates, target, 2.0 * increment


def predict_by_tangent(load_step: LoadStep) -> ModalPredictor:
    """Predict the modal coordinates at the end of a load step, with the tangent stiffness at its start.

    Raises ValueError if this tangent is singular.
    """
    assembly, a = load_step.assembly, load_step.modal_coordinates
    normal = assembly.evaluate_normal(load_step.preload_state, load_step.start_displacement, a)
    active_bolt_stiffness = assembly.bolts.active_stiffness(
        load_step.preload_bolt_force, assembly.elongation(load_step.start_displacement, a)
    )
    H = assembly.tangent_stiffness(normal.stiffness, load_step.friction_tangent, active_bolt_stiffness)
    try:
        negative_change = np.linalg.solve(
            H[6:, 6:], H[6:, :6] @ (load_step.end_displacement - load_step.start_displacement)
        )
    except np.linalg.LinAlgError:  # by round-off only: without it, H is positive definite in a
        raise ValueError(
            f"{load_step.input_summary}: no equilibrium of the joint was found: the tangent stiffness at the "
            "start of the load step is singular; check [bodies]"
        ) from None
    return ModalPredictor(np.asarray(a - negative_change), H[6:, 6:])


def solve_newton(
    load_step: LoadStep, step_fraction: float, modal_coordinates: Array, first_jacobian: Array
) -> tuple[TrialState, bool]:
    """Newton's method for the modal coordinates at a step fraction [1] of a load step.

    Returns the last trial state, and whether the method converged.

    modal_coordinates : (k) [m] initial values
    first_jacobian    : (k, k) [N/m] Jacobian of the first iteration: part of H for a at the start of the load
                        step, also if the step is divided

    The Jacobian is reused, with Broyden's update, after a full correction that reduces the residual to less
    than MAX_RESIDUAL_RATIO_FOR_JACOBIAN_REUSE of the last one; otherwise it is computed.
    """
    q = load_step.displacement_at(step_fraction)
    tolerance_factor = 1.0 if step_fraction == 1.0 else INTERMEDIATE_TOLERANCE_FACTOR
    state, jacobian = load_step.evaluate_trial(q, modal_coordinates), first_jacobian
    jacobian_is_current, last_norm = False, np.inf  # inf: the first iteration uses first_jacobian
    corrections: list[Array] = []  # since J was computed
    for iteration in range(MAX_NEWTON_ITERATIONS + 1):
        norm = state.residual_norm
        if norm <= tolerance_factor * state.residual_tolerance:
            return state, True
        if iteration == MAX_NEWTON_ITERATIONS:
            break
        if not norm < MAX_RESIDUAL_RATIO_FOR_JACOBIAN_REUSE * last_norm:  # also if the norm is NaN
            jacobian, corrections, jacobian_is_current = load_step.residual_jacobian(state), [], True
        try:
            correction = apply_broyden(np.asarray(-np.linalg.solve(jacobian, state.residual)), corrections)
        except np.linalg.LinAlgError:  # J is singular
            break
        corrections.append(correction)
        state, is_full = search_line(load_step, q, state, correction, jacobian_is_current)
        last_norm = norm if is_full else 0.0  # 0: the next iteration computes J, as no norm is below 0
        jacobian_is_current = False
    return state, False


def search_line(
    load_step: LoadStep,
    relative_displacement: Array,
    trial_state: TrialState,
    newton_correction: Array,
    jacobian_is_current: bool,
) -> tuple[TrialState, bool]:
    """Trial state after a correction (k) [m] of the modal coordinates, shortened if it overshoots.

    Returns also whether the correction was applied in full: False if it was shortened or dropped.

    The energy slope [J] is residual . correction: where friction sticks, the derivative of the potential
    energy along the correction. With slip there is no potential, but the slope still vanishes at the
    solution. If it exceeds MAX_FINAL_OVER_INITIAL_ENERGY_SLOPE times its first value at the end, the
    correction is shortened by regula falsi, or dropped if the Jacobian was computed at an earlier state. If
    the first value is positive, too, regula falsi has no zero: the correction is multiplied by
    MIN_SHORTENING_FACTOR. After MAX_LINE_SEARCH_TRIALS the last trial is returned, though it is too long.
    """
    length, energy_slope_0 = 1.0, float(trial_state.residual @ newton_correction)
    for shortenings in range(MAX_LINE_SEARCH_TRIALS):
        trial = load_step.evaluate_trial(
            relative_displacement, trial_state.modal_coordinates + length * newton_correction
        )
        energy_slope_1 = float(trial.residual @ newton_correction)
        if not energy_slope_1 > MAX_FINAL_OVER_INITIAL_ENERGY_SLOPE * abs(energy_slope_0):
            return trial, shortenings == 0
        if not jacobian_is_current:
            return trial_state, False
        has_zero = energy_slope_0 < 0.0 < energy_slope_1
        zero = energy_slope_0 / (energy_slope_0 - energy_slope_1) if has_zero else 0.0
        length *= max(zero, MIN_SHORTENING_FACTOR)
    return trial, False


def apply_broyden(newton_correction: Array, earlier_corrections: Sequence[Array]) -> Array:
    """Improve a Newton correction (k) [m] by Broyden's good update of J (Kelley 1995, chapter 7)."""
    for last, following in pairwise(earlier_corrections):
        newton_correction = newton_correction + (last @ newton_correction) / (last @ last) * following
    if earlier_corrections:
        last = earlier_corrections[-1]
        newton_correction = newton_correction / (1.0 - last @ newton_correction / (last @ last))
    return np.asarray(newton_correction)
