"""Natural frequencies, ringing, wind-up and tip error of a robot with elastic axes, at given poses."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import brentq

from jointfmu.quantity import Array

from . import bristles
from .elastic import ElasticAxis, compute_mass_matrix
from .spring_fit import FittedSpring

if TYPE_CHECKING:
    from mujoco import MjModel


def find_axis_dofs(robot_model: "MjModel", robot_axes: Sequence[ElasticAxis]) -> list[int]:
    """Indices (n) of the degrees of freedom of the axes in the rigid robot."""
    return [int(robot_model.joint(axis.joint_name).dofadr[0]) for axis in robot_axes]


def compute_weight_torques(
    robot_model: "MjModel",
    robot_axes: Sequence[ElasticAxis],
    robot_pose: Array,
    payload_mass: float,
    tip_body: int,
) -> tuple[Array, Array]:
    """Static drive torques (n) [N.m] under weight, and the Jacobian (3, n) [m/rad] of the body `tip_body`.

    A payload [kg] acts at the origin of this body.
    """
    import mujoco

    data = mujoco.MjData(robot_model)
    data.qpos[:] = robot_pose
    mujoco.mj_forward(robot_model, data)
    jacobian = np.zeros((3, robot_model.nv))
    mujoco.mj_jac(robot_model, data, jacobian, None, data.xpos[tip_body], tip_body)
    indices = find_axis_dofs(robot_model, robot_axes)
    weight = -data.qfrc_bias + jacobian.T @ (payload_mass * robot_model.opt.gravity)
    return weight[indices], jacobian[:, indices]


def compute_link_mass_matrix(
    robot_model: "MjModel",
    robot_axes: Sequence[ElasticAxis],
    robot_pose: Array,
    payload_mass: float,
    tip_body: int,
) -> Array:
    """Mass matrix (n, n) [kg.m2] of the links without rotors, with a payload (point mass) [kg] at the tip."""
    indices = find_axis_dofs(robot_model, robot_axes)
    _, jacobian = compute_weight_torques(robot_model, robot_axes, robot_pose, payload_mass, tip_body)
    mass = compute_mass_matrix(robot_model, robot_pose)[np.ix_(indices, indices)] - np.diag(
        robot_model.dof_armature[indices]
    )
    return np.asarray(mass + payload_mass * jacobian.T @ jacobian)


def compute_frequencies(
    robot_model: "MjModel",
    robot_axes: Sequence[ElasticAxis],
    robot_pose: Array,
    payload_mass: float,
    tip_body: int,
) -> Array:
    """Natural frequencies (n) [Hz], ascending, at a pose under weight, with locked motors and other joints.

    (K - omega^2 M) x = 0 with the tangent stiffness K of the drives and the mass matrix M of the links
    without rotors; the payload is a point mass. The geometric stiffness of the weight is neglected.
    """
    load, _ = compute_weight_torques(robot_model, robot_axes, robot_pose, payload_mass, tip_body)
    mass = compute_link_mass_matrix(robot_model, robot_axes, robot_pose, payload_mass, tip_body)
    scale = 1.0 / np.sqrt(
        [axis.stiffness_at_torque(t) for axis, t in zip(robot_axes, load.tolist(), strict=True)]
    )
    squares = np.linalg.eigvalsh(scale[:, None] * mass * scale)
    return np.asarray(np.sort(1.0 / (2.0 * np.pi * np.sqrt(squares))))


@dataclass(frozen=True, slots=True)
class Ringing:
    """Free vibration of an arm about its position under weight, after one motor stopped.

    times_after_stop : (n) [s] from the stop
    tip_displacement : (n, 3) [m] of the tip, from its position at rest
    """

    times_after_stop: Array
    tip_displacement: Array

    @property
    def tip_distance(self) -> Array:
        """Distance (n) [m] of the tip from its position at rest."""
        return np.asarray(np.linalg.norm(self.tip_displacement, axis=1))

    @property
    def final_tip_amplitude(self) -> float:
        """Largest distance [m] of the tip in the last tenth of the time."""
        return float(self.tip_distance[-self.times_after_stop.size // 10 :].max())


def compute_ringing(
    robot_model: "MjModel",
    robot_axes: Sequence[ElasticAxis],
    robot_pose: Array,
    payload_mass: float,
    tip_body: int,
    times_after_stop: Array,
) -> list[Ringing]:
    """Vibration of the arm after the stop of each motor, at a pose under weight, the other motors held.

    The motor of the axis brakes at a constant rate: its drive carries its rated torque in addition to the
    weight. When the motor stands still, the arm is released from the wind-up of braking. The equations are
    M x" + D x' + K x = 0 for the wind-ups x, with the mass matrix M of the links, and diagonal matrices of
    damping D and tangent stiffness K of the drives. Hysteresis and friction of the drives are neglected: they
    make the decay faster.

    times_after_stop : (n) [s] from the stop, evenly spaced from 0
    """
    load, jacobian = compute_weight_torques(robot_model, robot_axes, robot_pose, payload_mass, tip_body)
    mass = compute_link_mass_matrix(robot_model, robot_axes, robot_pose, payload_mass, tip_body)
    stiffness = np.array(
        [axis.stiffness_at_torque(t) for axis, t in zip(robot_axes, load.tolist(), strict=True)]
    )
    damping = np.array([axis.drive.output_damping for axis in robot_axes])
    n = len(robot_axes)
    rates = np.zeros((2 * n, 2 * n))  # of wind-ups, then of their speeds
    rates[:n, n:] = np.eye(n)
    rates[n:, :n] = -np.linalg.solve(mass, np.diag(stiffness))
    rates[n:, n:] = -np.linalg.solve(mass, np.diag(damping))
    values, modes = np.linalg.eig(rates)
    decay = np.exp(np.outer(times_after_stop, values))
    results = []
    for k, axis in enumerate(robot_axes):
        start = np.zeros(2 * n)
        start[:n] = mass[:, k] * axis.drive.rated_torque / mass[k, k] / stiffness
        wind_up = ((decay * np.linalg.solve(modes, start)) @ modes[:n].T).real
        results.append(Ringing(times_after_stop, wind_up @ jacobian.T))
    return results


def find_largest_stable_step(
    robot_model: "MjModel", robot_axes: Sequence[ElasticAxis], robot_pose: Array
) -> float:
    """Largest time step h [s] at which the plain MJCF is stable with MuJoCo's default integrator (Euler).

    That is for links and free motors at a pose, with the stiffness at the largest fit torques. The vibrations
    M x" + C x' + K x = 0 are stable if no eigenvalue of M^-1 (h^2 K + 2 h C) exceeds 4: a sufficient
    condition for symmetric matrices and forces that are taken from the start of a step. C has the damping of
    the drives and the largest damping of the motor friction. The latter depends on the step for which the
    friction is written, which is h, or the step of `robot_model` if that is shorter.
    """
    indices = find_axis_dofs(robot_model, robot_axes)
    n, rotors = len(robot_axes), np.zeros(robot_model.nv)
    rotors[indices] = robot_model.dof_armature[indices]
    link_mobility = np.linalg.inv(compute_mass_matrix(robot_model, robot_pose) - np.diag(rotors))
    rotor_mobility = np.diag([1.0 / axis.rotor_inertia for axis in robot_axes])
    root = np.zeros((2 * n, 2 * n))  # links, then rotors; all coordinates at the joints
    root[:n, :n] = np.linalg.cholesky(link_mobility[np.ix_(indices, indices)])
    root[n:, n:] = np.sqrt(rotor_mobility)
    wind_up = np.hstack([np.eye(n), -np.eye(n)])
    springs = [axis.fitted_spring.stiffness_at_torque(axis.fitted_spring.max_torque) for axis in robot_axes]
    stiffness = wind_up.T @ np.diag(springs) @ wind_up
    drive_damping = wind_up.T @ np.diag([axis.drive.output_damping for axis in robot_axes]) @ wind_up
    has_bristles = bristles.is_integrator_stable(robot_model.opt)

    def stability_margin(step: float) -> float:
        """Largest eigenvalue of M^-1 (h^2 K + 2 h C) minus 4 [1] at a step h [s]."""
        damping = drive_damping.copy()
        for i, axis in enumerate(robot_axes, n):
            ratio, friction = axis.drive.ratio, axis.drive.viscous_friction
            if has_bristles and axis.drive.static_friction:
                inertia = axis.rotor_inertia / ratio**2
                friction = bristles.compute_max_damping(
                    axis.drive, inertia, min(step, robot_model.opt.timestep)
                )
            damping[i, i] += ratio**2 * friction
        matrix = root.T @ (step**2 * stiffness + 2.0 * step * damping) @ root
        return float(np.linalg.eigvalsh(matrix)[-1] - 4.0)

    undamped = 2.0 / np.sqrt(np.linalg.eigvalsh(root.T @ stiffness @ root)[-1])
    return float(brentq(stability_margin, 1e-9 * undamped, 1.01 * undamped, rtol=1e-9))


def compute_weight_deflection(
    robot_model: "MjModel",
    robot_axes: Sequence[ElasticAxis],
    robot_pose: Array,
    payload_mass: float,
    tip_body: int,
    fitted_springs: Sequence[FittedSpring] | None = None,
) -> tuple[Array, float]:
    """Wind-ups (n) [rad] under weight at a pose with locked motors, and the tip displacement [m] they cause.

    fitted_springs : fitted springs (n) to use instead of the laws of the drives
    """
    load, jacobian = compute_weight_torques(robot_model, robot_axes, robot_pose, payload_mass, tip_body)
    laws: Sequence[ElasticAxis | FittedSpring] = fitted_springs or robot_axes
    x = np.array([law.solve_wind_up(t) for law, t in zip(laws, load.tolist(), strict=True)])
    return x, float(np.linalg.norm(jacobian @ x))
