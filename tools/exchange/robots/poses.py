"""Natural frequencies, wind-up and tip error of a robot with elastic axes, at given poses."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from jointfmu.quantity import Array

from .elastic import ElasticAxis, compute_mass_matrix
from .fitted import FittedSpring

if TYPE_CHECKING:
    from mujoco import MjModel


def find_dofs(model: "MjModel", axes: Sequence[ElasticAxis]) -> list[int]:
    """Indices (n) of the degrees of freedom of the axes in the rigid robot."""
    return [int(model.joint(axis.joint).dofadr[0]) for axis in axes]


def compute_torques(
    model: "MjModel", axes: Sequence[ElasticAxis], pose: Array, payload: float, tip: int
) -> tuple[Array, Array]:
    """Static drive torques (n) [N.m] under weight, and the Jacobian (3, n) [m/rad] of the body `tip`.

    A payload [kg] acts at the origin of this body.
    """
    import mujoco

    data = mujoco.MjData(model)
    data.qpos[:] = pose
    mujoco.mj_forward(model, data)
    jacobian = np.zeros((3, model.nv))
    mujoco.mj_jac(model, data, jacobian, None, data.xpos[tip], tip)
    indices = find_dofs(model, axes)
    weight = -data.qfrc_bias + jacobian.T @ (payload * model.opt.gravity)
    return weight[indices], jacobian[:, indices]


def compute_link_inertia(
    model: "MjModel", axes: Sequence[ElasticAxis], pose: Array, payload: float, tip: int
) -> Array:
    """Mass matrix (n, n) [kg.m2] of the links without rotors, with a point mass payload [kg] at `tip`."""
    indices = find_dofs(model, axes)
    _, jacobian = compute_torques(model, axes, pose, payload, tip)
    mass = compute_mass_matrix(model, pose)[np.ix_(indices, indices)] - np.diag(model.dof_armature[indices])
    return np.asarray(mass + payload * jacobian.T @ jacobian)


def compute_frequencies(
    model: "MjModel", axes: Sequence[ElasticAxis], pose: Array, payload: float, tip: int
) -> Array:
    """Natural frequencies (n) [Hz], ascending, at a pose under weight, with locked motors and other joints.

    (K - omega^2 M) x = 0 with the tangent stiffness K of the drives and the mass matrix M of the links
    without rotors; the payload is a point mass. The geometric stiffness of the weight is neglected.
    """
    load, _ = compute_torques(model, axes, pose, payload, tip)
    mass = compute_link_inertia(model, axes, pose, payload, tip)
    scale = 1.0 / np.sqrt([axis.stiffness(t) for axis, t in zip(axes, load.tolist(), strict=True)])
    squares = np.linalg.eigvalsh(scale[:, None] * mass * scale)
    return np.asarray(np.sort(1.0 / (2.0 * np.pi * np.sqrt(squares))))


def find_largest_stable_step(model: "MjModel", axes: Sequence[ElasticAxis], pose: Array) -> float:
    """Largest stable time step [s] of MuJoCo's default integrator, 2 over the highest natural frequency.

    The frequency is that of links and free motors at a pose, with the stiffness at the largest fit torques.
    """
    indices = find_dofs(model, axes)
    rotors = np.zeros(model.nv)
    rotors[indices] = model.dof_armature[indices]
    mobility = np.linalg.inv(compute_mass_matrix(model, pose) - np.diag(rotors))[np.ix_(indices, indices)]
    mobility += np.diag([1.0 / axis.rotor_inertia for axis in axes])
    scale = np.sqrt([axis.spring.stiffness(axis.spring.max_torque) for axis in axes])
    return float(2.0 / np.sqrt(np.linalg.eigvalsh(scale[:, None] * mobility * scale)[-1]))


def compute_sag(
    model: "MjModel",
    axes: Sequence[ElasticAxis],
    pose: Array,
    payload: float,
    tip: int,
    springs: Sequence[FittedSpring] | None = None,
) -> tuple[Array, float]:
    """Wind-ups (n) [rad] under weight at a pose with locked motors, and the tip displacement [m] they cause.

    springs : fitted springs (n) to use instead of the laws of the drives
    """
    load, jacobian = compute_torques(model, axes, pose, payload, tip)
    laws: Sequence[ElasticAxis | FittedSpring] = springs or axes
    x = np.array([law.solve_wind_up(t) for law, t in zip(laws, load.tolist(), strict=True)])
    return x, float(np.linalg.norm(jacobian @ x))
