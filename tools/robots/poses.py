"""What elastic axes make of a robot: natural frequencies over poses, wind-up and tip error under weight."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from jointfmu.quantity import Array

from .elastic import ElasticAxis, mass_matrix
from .fitted import FittedTendons

if TYPE_CHECKING:
    from mujoco import MjModel


def dofs(model: "MjModel", axes: Sequence[ElasticAxis]) -> list[int]:
    """The degrees of freedom of the axes in the rigid robot."""
    return [int(model.joint(axis.joint).dofadr[0]) for axis in axes]


def torques(
    model: "MjModel", axes: Sequence[ElasticAxis], pose: Array, payload: float, tip: int
) -> tuple[Array, Array]:
    """What weight asks of the drives (n) [N.m] with a payload [kg] at the origin of a body, and the rows of
    the body's Jacobian (3, n) [m/rad].
    """
    import mujoco

    data = mujoco.MjData(model)
    data.qpos[:] = pose
    mujoco.mj_forward(model, data)
    jacobian = np.zeros((3, model.nv))
    mujoco.mj_jac(model, data, jacobian, None, data.xpos[tip], tip)
    own = dofs(model, axes)
    weight = -data.qfrc_bias + jacobian.T @ (payload * model.opt.gravity)
    return weight[own], jacobian[:, own]


def inertia(model: "MjModel", axes: Sequence[ElasticAxis], pose: Array, payload: float, tip: int) -> Array:
    """Mass matrix (n, n) [kg.m2] of the links, without rotors, with a payload [kg] as a point of a body."""
    own = dofs(model, axes)
    _, jacobian = torques(model, axes, pose, payload, tip)
    mass = mass_matrix(model, pose)[np.ix_(own, own)] - np.diag(model.dof_armature[own])
    return np.asarray(mass + payload * jacobian.T @ jacobian)


def frequencies(
    model: "MjModel", axes: Sequence[ElasticAxis], pose: Array, payload: float, tip: int
) -> Array:
    """Natural frequencies (n) [Hz], ascending, about a pose under weight: motors and other joints held.

    (K - omega^2 M) x = 0 with the drives' tangents K and the links' masses M, without rotors; the payload
    is a point. What weight adds to K as the links turn is left out.
    """
    load, _ = torques(model, axes, pose, payload, tip)
    mass = inertia(model, axes, pose, payload, tip)
    scale = 1.0 / np.sqrt([axis.stiffness(t) for axis, t in zip(axes, load.tolist(), strict=True)])
    squares = np.linalg.eigvalsh(scale[:, None] * mass * scale)
    return np.asarray(np.sort(1.0 / (2.0 * np.pi * np.sqrt(squares))))


def longest_step(model: "MjModel", axes: Sequence[ElasticAxis], pose: Array) -> float:
    """Step [s] beyond which MuJoCo's default integrator diverges: 2 over the highest natural frequency of
    links and free motors at a pose, its springs at the torques of their fits.
    """
    own = dofs(model, axes)
    rotors = np.zeros(model.nv)
    rotors[own] = model.dof_armature[own]
    mobility = np.linalg.inv(mass_matrix(model, pose) - np.diag(rotors))[np.ix_(own, own)]
    mobility += np.diag([1.0 / axis.rotor for axis in axes])
    scale = np.sqrt([axis.fitted.stiffness(axis.fitted.torque) for axis in axes])
    return float(2.0 / np.sqrt(np.linalg.eigvalsh(scale[:, None] * mobility * scale)[-1]))


def sag(
    model: "MjModel",
    axes: Sequence[ElasticAxis],
    pose: Array,
    payload: float,
    tip: int,
    springs: Sequence[FittedTendons] | None = None,
) -> tuple[Array, float]:
    """Wind-ups (n) [rad] under weight at a pose, motors held, and how far the tip sinks by them [m]; with the
    drives' own laws, or with springs (n) in their place.
    """
    load, jacobian = torques(model, axes, pose, payload, tip)
    laws: Sequence[ElasticAxis | FittedTendons] = springs or axes
    x = np.array([law.wind_up(t) for law, t in zip(laws, load.tolist(), strict=True)])
    return x, float(np.linalg.norm(jacobian @ x))
