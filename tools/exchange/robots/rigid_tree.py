"""Tree of rigid links of a robot, from the model that MuJoCo compiles from MJCF or URDF."""

from collections.abc import Collection
from typing import TYPE_CHECKING, Any

import numpy as np

from jointfmu.quantity import Array

from ...systems.multibody import GROUND_INDEX, Frame, Link

if TYPE_CHECKING:
    from mujoco import MjModel

MAX_ROUNDING_ERROR = 1e-14
"""Entries of rotations and origins below this size are rounding errors and become zero."""


def read_links(robot_model: "MjModel", driven_joints: Collection[str]) -> list[Link]:
    """Links of a robot, in the order of its degrees of freedom; bodies without a joint between them are one.

    driven_joints : joints with a drive; their armature belongs to the rotor and not to the link
    """
    import mujoco

    data = _make_data_at_zero_position(robot_model)
    frames: list[tuple[Array, Array]] = []
    links = []
    for k in range(robot_model.njnt):
        parent = int(robot_model.dof_parentid[k])
        carrier, start = frames[parent] if parent != GROUND_INDEX else (np.eye(3), np.zeros(3))
        axes, origin = _joint_axes(data.xaxis[k], carrier), data.xanchor[k].copy()
        frames.append((axes, origin))
        mass, centre, inertia = _merge_bodies(robot_model, data, k, axes, origin)
        name = robot_model.joint(k).name
        links.append(
            Link(
                name=name,
                parent_index=parent,
                is_sliding_joint=bool(robot_model.jnt_type[k] == mujoco.mjtJoint.mjJNT_SLIDE),
                rotation=_clear_rounding_errors(carrier.T @ axes),
                origin=_clear_rounding_errors(carrier.T @ (origin - start)),
                mass=mass,
                centre_of_mass=centre,
                inertia=inertia,
                reflected_motor_inertia=0.0 if name in driven_joints else float(robot_model.dof_armature[k]),
                damping=_linear_coefficient(robot_model.dof_damping[k]),
                stiffness=_linear_coefficient(robot_model.jnt_stiffness[k]),
                spring_position=float(robot_model.qpos_spring[k]),
            )
        )
    return links


def find_body_frame(robot_model: "MjModel", body_index: int) -> Frame:
    """Frame of a body, fixed to the link that carries it."""
    data = _make_data_at_zero_position(robot_model)
    link, axes, origin = _find_link(robot_model, body_index), np.eye(3), np.zeros(3)
    chain = [link]
    while chain[-1] != GROUND_INDEX:
        chain.append(int(robot_model.dof_parentid[chain[-1]]))
    for k in reversed(chain[:-1]):
        axes, origin = _joint_axes(data.xaxis[k], axes), data.xanchor[k]
    return Frame(
        link,
        _clear_rounding_errors(axes.T @ data.xmat[body_index].reshape(3, 3)),
        _clear_rounding_errors(axes.T @ (data.xpos[body_index] - origin)),
    )


def list_omitted_effects(robot_model: "MjModel") -> list[str]:
    """Effects of the robot file that the rigid-body dynamics do not include, as texts."""
    texts = []
    if np.any(robot_model.jnt_limited):
        texts.append("limits of joint angles (range)")
    if np.any(robot_model.jnt_actfrclimited):
        texts.append("limits of joint torques (actuatorfrcrange; effort of a URDF)")
    if robot_model.nu:
        names = ", ".join(robot_model.actuator(k).name or f"number {k + 1}" for k in range(robot_model.nu))
        texts.append(f"actuators ({names}): the inputs are the torques or angles of the motors")
    if rubbing := [
        robot_model.joint(k).name
        for k in range(robot_model.njnt)
        if _linear_coefficient(robot_model.dof_frictionloss[k])
    ]:
        texts.append(f"dry friction (frictionloss) of {', '.join(rubbing)}")
    if coupled := _list_constraints(robot_model, selects_couplings=True):
        texts.append(f"couplings of joints (equality {', '.join(coupled)}): the joints move independently")
    if robot_model.ntendon:
        texts.append("tendons")
    if np.any(robot_model.body_gravcomp):
        texts.append("compensation of gravity (gravcomp)")
    return texts


def list_massless_bodies(robot_model: "MjModel") -> list[str]:
    """Names of bodies with a joint but without mass of their own, in the order of the joints.

    Bodies that are fixed to such a body have the mass of its link.
    """
    bodies = dict.fromkeys(robot_model.jnt_bodyid.tolist())
    return [robot_model.body(k).name for k in bodies if not robot_model.body_mass[k]]


def check_joint_tree(robot_model: "MjModel") -> None:
    """Raise ValueError, one line, for a joint that is no hinge or slide, and for a closed loop."""
    import mujoco

    allowed = {int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE)}
    for k in range(robot_model.njnt):
        if int(robot_model.jnt_type[k]) not in allowed:
            kind = mujoco.mjtJoint(robot_model.jnt_type[k]).name.removeprefix("mjJNT_").lower()
            body = robot_model.body(robot_model.jnt_bodyid[k])
            joint = f"joint {robot_model.joint(k).name!r} of body {body.name!r}"
            raise ValueError(f"{joint} is of type {kind}; allowed are hinge and slide")
    for name in _list_constraints(robot_model, selects_couplings=False):
        raise ValueError(
            f"the constraint {name} closes a loop; allowed are trees of links: remove it from the robot file"
        )


def _list_constraints(robot_model: "MjModel", selects_couplings: bool) -> list[str]:
    """Active equality constraints: those that couple joints or tendons, or those that close loops."""
    import mujoco

    couplings = {int(mujoco.mjtEq.mjEQ_JOINT), int(mujoco.mjtEq.mjEQ_TENDON)}
    return [
        robot_model.equality(k).name or str(k)
        for k in range(robot_model.neq)
        if robot_model.eq_active0[k] and (int(robot_model.eq_type[k]) in couplings) == selects_couplings
    ]


def _make_data_at_zero_position(robot_model: "MjModel") -> Any:
    """Data of the robot with all joint positions at zero."""
    import mujoco

    data = mujoco.MjData(robot_model)
    data.qpos[:] = 0.0
    mujoco.mj_kinematics(robot_model, data)
    return data


def _find_link(robot_model: "MjModel", body_index: int) -> int:
    """Index of the link that a body belongs to; GROUND: it does not move."""
    root = int(robot_model.body_weldid[body_index])
    return int(robot_model.body_dofadr[root] + robot_model.body_dofnum[root] - 1) if root else GROUND_INDEX


def _joint_axes(joint_axis: Array, carrier_axes: Array) -> Array:
    """Axes (3, 3) of a joint's frame: z along the joint axis, x normal to it and to z of `carrier_axes`.

    carrier_axes : axes of the link that carries the joint
    """
    z = joint_axis / np.linalg.norm(joint_axis)
    x = np.cross(carrier_axes[:, 2], z)
    if np.linalg.norm(x) < 1e-9:  # parallel
        x = carrier_axes[:, 0] - z * (z @ carrier_axes[:, 0])
    x = x / np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z])


def _merge_bodies(
    robot_model: "MjModel", robot_data: Any, link_index: int, link_axes: Array, link_origin: Array
) -> tuple[float, Array, Array]:
    """Mass [kg], centre (3) [m] and inertia (3, 3) [kg.m2] of all bodies of a link, in its frame."""
    bodies = [b for b in range(1, robot_model.nbody) if _find_link(robot_model, b) == link_index]
    masses = robot_model.body_mass[bodies]
    mass = float(masses.sum())
    centres = robot_data.xipos[bodies]
    centre = masses @ centres / mass if mass else link_origin
    inertia = np.zeros((3, 3))
    for b, own_mass, own_centre in zip(bodies, masses, centres, strict=True):
        own_axes, lever = robot_data.ximat[b].reshape(3, 3), own_centre - centre
        inertia += own_axes @ np.diag(robot_model.body_inertia[b]) @ own_axes.T
        inertia += own_mass * (lever @ lever * np.eye(3) - np.outer(lever, lever))
    return (
        mass,
        _clear_rounding_errors(link_axes.T @ (centre - link_origin)),
        _clear_rounding_errors(link_axes.T @ inertia @ link_axes, np.abs(inertia).max()),
    )


def _clear_rounding_errors(array_entries: Array, rounding_scale: float = 1.0) -> Array:
    """Copy of an array in which entries as small as rounding errors of `rounding_scale` are set to zero."""
    return np.where(np.abs(array_entries) <= MAX_ROUNDING_ERROR * rounding_scale, 0.0, array_entries)


def _linear_coefficient(coefficients: Any) -> float:
    """Linear coefficient of a stiffness or damping that MuJoCo stores as a number or as a polynomial."""
    return float(np.ravel(coefficients)[0])
