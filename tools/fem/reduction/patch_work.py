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
from scipy.spatial import cKDTree

from jointfmu.mechanics.footprint.friction import CIRCLE
from jointfmu.mechanics.footprint.shape import FrictionPatches
from jointfmu.mechanics.sliders import Foundation
from jointfmu.quantity import Array

PART = np.sqrt(0.5)
"""Weight of each of two motions that are combined [1]."""
STAY = 0.1
"""Weight of the change of the patch displacements (regularisation) over the weight of the forces [1]."""
STEPS = 10
"""Largest number of steps of the Levenberg-Marquardt method."""
FIRST_DAMPING, LESS, MORE, MOST_DAMPING = 1e-3, 0.2, 5.0, 1e6
"""Levenberg-Marquardt damping over the diagonal of the normal equations [1]: initial value, factor after a
successful step, factor after a failed step, largest value."""
EXACT = 300.0
"""Weight of the error of the stick stiffness, relative to the joint stiffness, over the weight of forces and
losses [1]. The stiffness error stays below 2e-4. A larger weight makes the valley of the objective too narrow
for the steps."""
TINY = 1e-15
"""Smallest tangential displacement in divisions [m]; also the smallest relative loss in scales [1]."""
LEAST = 0.03
"""Displacement of the patches by a mode over that by the most effective mode [1]: lower limit for scales."""


def into_slip(motion: Array) -> Array:
    """Coefficients (w, s) that combine s states to w states in shear.

    The combinations are the states along x, along y and about z alone (the same number for each axis), then
    sums and differences of two of these axes.

    motion : (s, 6) [m, rad] of the states
    """
    single = np.flatnonzero(~np.any(motion[:, 2:5], axis=1))
    single = single[np.count_nonzero(motion[single], axis=1) == 1]
    identity = np.eye(len(motion))
    axes = [identity[single[motion[single][:, axis] != 0.0]] for axis in (0, 1, 5)]
    pairs = [(axes[i], axes[j], sign) for i, j in ((0, 1), (0, 2), (1, 2)) for sign in (1.0, -1.0)]
    return np.concatenate([*axes, *(PART * (a + sign * b) for a, b, sign in pairs)])


@dataclass(frozen=True)
class Shears:
    """States of the joint in shear.

    motion            : (s, 3) [m, rad] of side 2 along x, along y and about z
    modal_coordinates : (s, k) [m]
    """

    motion: Array
    amplitude: Array


@dataclass(frozen=True)
class Surface:
    """Points (n) with friction: quadrature points of the contact, or sliders of the patches.

    area               : (n) [m2]
    approach           : (n) [m] in the preloaded joint
    rigid_displacement : (2 n, 3) displacement along x (n), then along y (n), by rigid-body motions along x,
                         along y and about z
    """

    area: Array
    approach: Array
    rigid: Array


@dataclass(frozen=True)
class Work:
    """Friction forces and loss in s states in shear.

    forces       : generalised friction forces (s, 3 + k) [N, N.m] on three motions and k modes
    stick_forces : the same (s, 3 + k) if no point slipped
    loss         : (s) [J] per cycle with this amplitude
    """

    forces: Array
    stuck: Array
    loss: Array

    @cached_property
    def scale(self) -> tuple[Array, Array, Array]:
        """Scales of forces, stick forces (s, 3 + k) and losses (s): their relative errors count alike."""
        return _size(self.forces), _size(self.stuck), np.maximum(self.loss, TINY * np.max(self.loss))


def _size(forces: Array) -> Array:
    """Scale (s, 3 + k) of generalised forces: in each state for x and y, for the moment, for the modes."""
    force, moment, modes = (np.linalg.norm(f, axis=1) for f in (forces[:, :2], forces[:, 2:3], forces[:, 3:]))
    lever_arm = np.max(moment) / np.max(force)
    force = np.hypot(force, moment / lever_arm)
    modes = np.maximum(modes, LEAST * np.max(modes / force) * force)
    return np.stack([force, force, lever_arm * force, *[modes] * (forces.shape[1] - 3)], axis=1)


@dataclass(frozen=True)
class Friction:
    """Friction law in monotonic loading at s states and n points; all arrays (s, n).

    u, v              : tangential displacement along x and y [m]
    magnitude         : of the tangential displacement [m]
    secant_stiffness  : traction over displacement [Pa/m]
    tangent_stiffness : derivative of the traction [Pa/m]
    stick_stiffness   : stiffness without slip [Pa/m]
    loss              : per cycle with this amplitude [J/m2]
    loss_derivative   : with respect to the magnitude [Pa]
    """

    u: Array
    v: Array
    size: Array
    secant: Array
    tangent: Array
    stick: Array
    loss: Array
    rate: Array

    @classmethod
    def of(cls, law: Foundation, approach: Array, shift: Array) -> "Friction":
        """Friction at approaches (n) [m] and tangential displacements (s, 2 n) [m]: along x, then along y."""
        u, v = np.split(shift, 2, axis=1)
        size = np.maximum(np.hypot(u, v), TINY)
        stick, tangent = (
            law.ratio * law.curve.derivatives(x, 1)[1]
            for x in (approach, approach - law.ratio / law.friction * size)
        )
        stick = np.broadcast_to(stick, size.shape)
        force = np.minimum(law.backbone(approach, size), stick * size)
        rate = 4.0 * (force - tangent * size)
        return cls(u, v, size, force / size, tangent, stick, law.loop(approach, size)[0], rate)


@dataclass(frozen=True)
class LinearContact:
    """Tangential stiffness of the contact in the linear joint, where no point slips.

    unit_states       : w = 3 states of the linear joint, a unit motion along x, along y and about z
    contact_stiffness : (w, w) [N/m, N, N.m] twice the strain energy of the contact for each pair of states
    joint_stiffness   : (w) [N/m, N.m] of the joint along each motion
    """

    ways: Shears
    shear: Array
    joint: Array

    @cached_property
    def size(self) -> Array:
        """Scale (w, w) [N/m, N, N.m] of stiffness errors: geometric mean of the joint stiffnesses."""
        return np.sqrt(np.outer(self.joint, self.joint))


@dataclass(frozen=True)
class PatchWork:
    """Least-squares problem: friction of m patches that equals the friction of all quadrature points.

    law            : friction law of the interface
    states         : states in shear in which the friction is compared
    sliders        : c sliders of each patch: the first of all patches, then the second of all patches, ...
    rotation_displacement : (2 c m, k) [1] displacement of the sliders by the modal rotation of the patches
    target_work    : friction at all quadrature points
    linear_contact : stick stiffness of the complete contact, which the patches keep
    """

    law: Foundation
    shears: Shears
    places: Surface
    turned: Array
    aim: Work
    tight: LinearContact

    def moved(self, shears: Shears, rows: Array) -> tuple[Array, Friction]:
        """Evaluate the friction of all sliders in states of the joint.

        patch_displacement : (2 m, k) [1] displacement of the patches along x, then along y, by the modes

        Returns the displacement (2 c m, 3 + k) of the sliders by motions and modes, and their friction.
        """
        count = len(self.turned) // len(rows)
        by_modes = np.concatenate([np.tile(half, (count, 1)) for half in np.split(rows, 2)]) + self.turned
        return moved(self.law, shears, self.places, by_modes)

    def fitted(self, rows: Array) -> Array:
        """Fit the patch displacements (2 m, k) by the Levenberg-Marquardt method, from given initial values.

        The preloaded joint keeps the stiffness of its finite elements: in the equilibrium of the linear
        joint, the contact stores the same energy. There, forces on modes have only an effect of second order.
        """
        typical = np.sqrt(np.mean(rows**2, axis=0))
        weight = STAY * np.sqrt(len(self.aim.loss) / rows.size) / np.maximum(typical, LEAST * typical.max())
        weight, initial, damping = np.broadcast_to(weight, rows.shape), rows, FIRST_DAMPING
        work_residual = self._missed(rows, weight * (rows - initial))
        stiffness_residual = self._tightened(rows)
        for _ in range(STEPS):
            work_jacobian = np.concatenate([self._slopes(rows), np.diag(weight.ravel())])
            stiffness_jacobian = self._tightened_slopes(rows)
            hessian = work_jacobian.T @ work_jacobian
            gradient = work_jacobian.T @ work_residual + stiffness_jacobian.T @ stiffness_residual
            objective = work_residual @ work_residual + stiffness_residual @ stiffness_residual
            while damping < MOST_DAMPING:
                damped = hessian + stiffness_jacobian.T @ stiffness_jacobian
                damped += damping * np.diag(np.diag(hessian))
                trial = rows + np.linalg.solve(damped, -gradient).reshape(rows.shape)
                residuals = self._missed(trial, weight * (trial - initial)), self._tightened(trial)
                if sum(residual @ residual for residual in residuals) < objective:
                    break
                damping *= MORE
            else:
                return rows
            rows, (work_residual, stiffness_residual), damping = trial, residuals, LESS * damping
        return rows

    def _tightened(self, rows: Array) -> Array:
        """Weighted relative error (w (w + 1) / 2) [1] of the stick stiffness of the patches."""
        _, friction = self.moved(self.tight.ways, rows)
        error = (stiffness(friction, self.places.area) - self.tight.shear) / self.tight.size
        return np.asarray(EXACT * error[np.triu_indices(len(error))])

    def _tightened_slopes(self, rows: Array) -> Array:
        """Derivative of the stiffness residual with respect to the patch displacements."""
        _, friction = self.moved(self.tight.ways, rows)
        force = (self.places.area * friction.stick * np.stack([friction.u, friction.v])).swapaxes(0, 1)
        force = force.reshape(len(force), 2, -1, len(rows) // 2).sum(axis=2).reshape(len(force), -1)
        half = np.einsum("im,jk->ijmk", force, self.tight.ways.amplitude)
        slope = (half + half.swapaxes(0, 1)) / self.tight.size[:, :, None, None]
        return np.asarray(EXACT * slope[np.triu_indices(len(slope))].reshape(-1, rows.size))

    def _missed(self, rows: Array, change: Array) -> Array:
        """Relative errors [1] of forces, stick forces and loss of the patches, then their weighted change."""
        displacement, friction = self.moved(self.shears, rows)
        actual, target = work(friction, self.places.area, displacement), self.aim
        pairs = (
            (actual.forces, target.forces),
            (actual.stuck, target.stuck),
            (actual.loss, target.loss),
        )
        errors = [((a - b) / size).ravel() for (a, b), size in zip(pairs, target.scale, strict=True)]
        return np.concatenate([*errors, change.ravel()])

    def _slopes(self, rows: Array) -> Array:
        """Derivative of the relative errors of forces and loss with respect to the patch displacements."""
        displacement, friction = self.moved(self.shears, rows)
        area, amplitude = self.places.area, self.shears.amplitude
        (n_states, modes), count = amplitude.shape, len(rows) // 2
        u, v, size = friction.u, friction.v, friction.size
        direction, halves = (u / size, v / size), np.split(displacement, 2)
        secant, tangent = friction.secant, friction.tangent

        def of_patches(slope: Array, half: Array) -> Array:
            """Product of tangent and displacement (s, 3 + k, m), summed over the sliders of each patch."""
            factors = slope.reshape(n_states, -1, count), half.reshape(-1, count, 3 + modes)
            return np.einsum("scm,cmh->shm", *factors)

        def sums(each: Array) -> Array:
            """Sum (s, m) over the sliders of each patch."""
            return each.reshape(n_states, -1, count).sum(axis=1)

        forces, loss = np.zeros((2, n_states, 3 + modes, 2, count)), np.zeros((n_states, 2, count))
        patch_forces, springs = np.zeros((2, n_states, 2, count)), area * friction.stick
        for i, shift in enumerate((u, v)):
            for j in range(2):
                slope = area * ((i == j) * secant + (tangent - secant) * direction[i] * direction[j])
                forces[0, :, :, i] += of_patches(slope, halves[j])
            forces[1, :, :, i] = of_patches(springs, halves[i])
            patch_forces[:, :, i] = sums(area * secant * shift), sums(springs * shift)
            loss[:, i] = sums(area * friction.rate * direction[i])
        force_derivative, mode = forces[..., None] * amplitude[:, None, None, None], np.arange(modes)
        force_derivative[:, :, 3 + mode, :, :, mode] += patch_forces
        derivatives = *force_derivative, loss[..., None] * amplitude[:, None, None]
        pairs = zip(derivatives, self.aim.scale, strict=True)
        return np.concatenate([(x / s.reshape(s.shape + (1,) * 3)).reshape(-1, rows.size) for x, s in pairs])


def rigid_shifts(place: Array) -> Array:
    """Displacement (2 n, 3) of positions (n, 2) [m] by unit motions along x, along y and about z.

    The first n rows are the displacement along x, the others along y.
    """
    x, y = place.T
    unit, zero = np.ones_like(x), np.zeros_like(x)
    return np.concatenate([np.stack([unit, zero, -y], axis=1), np.stack([zero, unit, x], axis=1)])


def turned(place: Array, patches: FrictionPatches, means: sp.csr_matrix, traces: list[Array]) -> Array:
    """Rotation (m, k) [1/m] of the patches about their centres by the modes.

    The rotation is a mean over the cell of each patch, weighted by the averaging matrix and the squared
    distance from the centre.

    position : (q, 2) [m] of the quadrature points
    means    : averaging matrix (m, q) [1]
    traces   : displacement (q, k) [1] of the quadrature points along x and y by the modes
    """
    cell = cKDTree(patches.position).query(place)[1]
    x, y = (place - (means @ place)[cell]).T
    lever, square = x[:, None] * traces[1] - y[:, None] * traces[0], means @ (x * x + y * y)
    extended = square > 0.0
    inverse = np.where(extended, 1.0 / np.where(extended, square, 1.0), 0.0)
    return np.asarray(inverse[:, None] * (means @ lever))


def on_circles(patches: FrictionPatches, area: float, approach: Array, turns: Array) -> tuple[Surface, Array]:
    """Sliders of the patches: c = 1 at the centre, or c on a circle around it if patches have a radius.

    area      : nominal contact area [m2]
    approach  : (m) [m] of the patches in the preloaded joint
    rotations : (m, k) [1/m] of the patches by the modes

    Returns the sliders (c m), and their displacement (2 c m, k) [1] by the rotation of the patches.
    """
    circle = CIRCLE if np.any(patches.radius) else 0.0 * CIRCLE[:1]
    offset = circle[:, None] * patches.radius[:, None]
    count, (x, y) = len(circle), offset.reshape(-1, 2).T[:, :, None]
    slider_rotations = np.tile(turns, (count, 1))
    sliders = Surface(
        np.tile(area * patches.share / count, count),
        np.tile(approach, count),
        rigid_shifts((patches.position + offset).reshape(-1, 2)),
    )
    return sliders, np.concatenate([-y * slider_rotations, x * slider_rotations])


def moved(law: Foundation, shears: Shears, surface: Surface, rows: Array) -> tuple[Array, Friction]:
    """Evaluate the friction of n points in states of the joint.

    modal_displacement : (2 n, k) [1] of the points along x, then along y, by the modes

    Returns the displacement (2 n, 3 + k) of the points by motions and modes, and their friction.
    """
    displacement = np.concatenate([surface.rigid, rows], axis=1)
    coordinates = np.concatenate([shears.motion, shears.amplitude], axis=1)
    return displacement, Friction.of(law, surface.approach, coordinates @ displacement.T)


def work(at: Friction, area: Array, every: Array) -> Work:
    """Generalised forces and loss of the friction of n points.

    area         : (n) [m2]
    displacement : (2 n, 3 + k) of the points by motions and modes
    """
    forces, stick_forces = (
        np.concatenate([area * slope * shift for shift in (at.u, at.v)], axis=1) @ every
        for slope in (at.secant, at.stick)
    )
    return Work(forces, stick_forces, at.loss @ area)


def stiffness(at: Friction, area: Array) -> Array:
    """Stick stiffness (w, w) [N/m, N, N.m] of points with areas (n) [m2] for each pair of w states."""
    return np.asarray(sum((area * at.stick * shift) @ shift.T for shift in (at.u, at.v)))


def work_of(law: Foundation, shears: Shears, surface: Surface, rows: Array) -> Work:
    """Generalised forces and loss of the friction of n points in states of the joint.

    modal_displacement : (2 n, k) [1] of the points along x, then along y, by the modes
    """
    displacement, friction = moved(law, shears, surface, rows)
    return work(friction, surface.area, displacement)
