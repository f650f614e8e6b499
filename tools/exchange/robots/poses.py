"""Natural frequencies, ringing, wind-up and tip error of a robot with elastic axes, at given poses."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from jointfmu.quantity import Array

from .elastic import ElasticAxis, compute_mass_matrix
from .spring_fit import FittedSpring

if TYPE_CHECKING:
    from mujoco import MjModel


def find_dofs(model: "MjModel", axes: Sequence[ElasticAxis]) -> list[int]:
    """Indices (n) of the degrees of freedom of the axes in the rigid robot."""
    return [int(model.joint(axis.joint).dofadr[0]) for axis in axes]


def compute_torques(
    model: "MjModel", axes: Sequence[ElasticAxis], pose: Array, payload: float, tip_body: int
) -> tuple[Array, Array]:
    """Static drive torques (n) [N.m] under weight, and the Jacobian (3, n) [m/rad] of the body `tip_body`.

    A payload [kg] acts at the origin of this body.
    """
    import mujoco

    data = mujoco.MjData(model)
    data.qpos[:] = pose
    mujoco.mj_forward(model, data)
    jacobian = np.zeros((3, model.nv))
    mujoco.mj_jac(model, data, jacobian, None, data.xpos[tip_body], tip_body)
    indices = find_dofs(model, axes)
    weight = -data.qfrc_bias + jacobian.T @ (payload * model.opt.gravity)
    return weight[indices], jacobian[:, indices]


def compute_link_inertia(
    model: "MjModel", axes: Sequence[ElasticAxis], pose: Array, payload: float, tip_body: int
) -> Array:
    """Mass matrix (n, n) [kg.m2] of the links without rotors, with a payload (point mass) [kg] at the tip."""
    indices = find_dofs(model, axes)
    _, jacobian = compute_torques(model, axes, pose, payload, tip_body)
    mass = compute_mass_matrix(model, pose)[np.ix_(indices, indices)] - np.diag(model.dof_armature[indices])
    return np.asarray(mass + payload * jacobian.T @ jacobian)


def compute_frequencies(
    model: "MjModel", axes: Sequence[ElasticAxis], pose: Array, payload: float, tip_body: int
) -> Array:
    """Natural frequencies (n) [Hz], ascending, at a pose under weight, with locked motors and other joints.

    (K - omega^2 M) x = 0 with the tangent stiffness K of the drives and the mass matrix M of the links
    without rotors; the payload is a point mass. The geometric stiffness of the weight is neglected.
    """
    load, _ = compute_torques(model, axes, pose, payload, tip_body)
    mass = compute_link_inertia(model, axes, pose, payload, tip_body)
    scale = 1.0 / np.sqrt([axis.stiffness(t) for axis, t in zip(axes, load.tolist(), strict=True)])
    squares = np.linalg.eigvalsh(scale[:, None] * mass * scale)
    return np.asarray(np.sort(1.0 / (2.0 * np.pi * np.sqrt(squares))))


@dataclass(frozen=True, slots=True)
class Ringing:
    """Free vibration of an arm about its position under weight, after one motor stopped.

    times             : (n) [s] from the stop
    tip_displacement  : (n, 3) [m] of the tip, from its position at rest
    """

    times: Array
    tip_displacement: Array

    @property
    def distance(self) -> Array:
        """Distance (n) [m] of the tip from its position at rest."""
        return np.asarray(np.linalg.norm(self.tip_displacement, axis=1))

    @property
    def last_amplitude(self) -> float:
        """Largest distance [m] of the tip in the last tenth of the time."""
        return float(self.distance[-self.times.size // 10 :].max())


def compute_ringing(
    model: "MjModel", axes: Sequence[ElasticAxis], pose: Array, payload: float, tip_body: int, times: Array
) -> list[Ringing]:
    """Vibration of the arm after the stop of each motor, at a pose under weight, the other motors held.

    The motor of the axis brakes at a constant rate: its drive carries its rated torque in addition to the
    weight. When the motor stands still, the arm is released from the wind-up of braking. The equations are
    M x" + D x' + K x = 0, with the mass matrix M of the links, and damping d and tangent stiffness of the
    drives. Hysteresis and friction of the drives are neglected: they make the decay faster.

    times : (n) [s] from the stop, evenly spaced from 0
    """
    load, jacobian = compute_torques(model, axes, pose, payload, tip_body)
    mass = compute_link_inertia(model, axes, pose, payload, tip_body)
    stiffness = np.array([axis.stiffness(t) for axis, t in zip(axes, load.tolist(), strict=True)])
    damping = np.array([axis.drive.damping for axis in axes])
    n = len(axes)
    rates = np.zeros((2 * n, 2 * n))  # of wind-ups, then of their speeds
    rates[:n, n:] = np.eye(n)
    rates[n:, :n] = -np.linalg.solve(mass, np.diag(stiffness))
    rates[n:, n:] = -np.linalg.solve(mass, np.diag(damping))
    values, modes = np.linalg.eig(rates)
    decay = np.exp(np.outer(times, values))
    results = []
    for k, axis in enumerate(axes):
        start = np.zeros(2 * n)
        start[:n] = mass[:, k] * axis.drive.rated_torque / mass[k, k] / stiffness
        wind_up = ((decay * np.linalg.solve(modes, start)) @ modes[:n].T).real
        results.append(Ringing(times, wind_up @ jacobian.T))
    return results


def find_largest_stable_step(model: "MjModel", axes: Sequence[ElasticAxis], pose: Array) -> float:
    """Largest stable time step [s] of MuJoCo's default integrator, 2 over the highest natural frequency.

    It is the frequency of links and free motors at a pose, with the stiffness at the largest fit torques.
    """
    indices = find_dofs(model, axes)
    rotors = np.zeros(model.nv)
    rotors[indices] = model.dof_armature[indices]
    mobility = np.linalg.inv(compute_mass_matrix(model, pose) - np.diag(rotors))[np.ix_(indices, indices)]
    mobility += np.diag([1.0 / axis.rotor_inertia for axis in axes])
    scale = np.sqrt([axis.spring.stiffness(axis.spring.max_torque) for axis in axes])
    return float(2.0 / np.sqrt(np.linalg.eigvalsh(scale[:, None] * mobility * scale)[-1]))


def compute_weight_deflection(
    model: "MjModel",
    axes: Sequence[ElasticAxis],
    pose: Array,
    payload: float,
    tip_body: int,
    springs: Sequence[FittedSpring] | None = None,
) -> tuple[Array, float]:
    """Wind-ups (n) [rad] under weight at a pose with locked motors, and the tip displacement [m] they cause.

    springs : fitted springs (n) to use instead of the laws of the drives
    """
    load, jacobian = compute_torques(model, axes, pose, payload, tip_body)
    laws: Sequence[ElasticAxis | FittedSpring] = springs or axes
    x = np.array([law.solve_wind_up(t) for law, t in zip(laws, load.tolist(), strict=True)])
    return x, float(np.linalg.norm(jacobian @ x))
