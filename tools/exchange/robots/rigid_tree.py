"""Tree of rigid links of a robot, from the model that MuJoCo compiles from MJCF or URDF."""

from collections.abc import Collection
from typing import TYPE_CHECKING, Any

import numpy as np

from jointfmu.quantity import Array

from ...systems.multibody import GROUND, Frame, Link

if TYPE_CHECKING:
    from mujoco import MjModel

ROUNDING = 1e-14
"""Entries of rotations and origins below this size are rounding errors and become zero."""


def read_links(model: "MjModel", driven_joints: Collection[str]) -> list[Link]:
    """Links of a robot, in the order of its degrees of freedom; bodies without a joint between them are one.

    driven_joints : joints with a drive; their armature belongs to the rotor and not to the link
    """
    import mujoco

    data = _place_at_zero(model)
    frames: list[tuple[Array, Array]] = []
    links = []
    for k in range(model.njnt):
        parent = int(model.dof_parentid[k])
        carrier, start = frames[parent] if parent != GROUND else (np.eye(3), np.zeros(3))
        axes, origin = _joint_axes(data.xaxis[k], carrier), data.xanchor[k].copy()
        frames.append((axes, origin))
        mass, centre, inertia = _merge_bodies(model, data, k, axes, origin)
        name = model.joint(k).name
        links.append(
            Link(
                name=name,
                parent=parent,
                is_slide=bool(model.jnt_type[k] == mujoco.mjtJoint.mjJNT_SLIDE),
                rotation=_clear_rounding_errors(carrier.T @ axes),
                origin=_clear_rounding_errors(carrier.T @ (origin - start)),
                mass=mass,
                centre=centre,
                inertia=inertia,
                armature=0.0 if name in driven_joints else float(model.dof_armature[k]),
                damping=_first(model.dof_damping[k]),
                stiffness=_first(model.jnt_stiffness[k]),
                spring_position=float(model.qpos_spring[k]),
            )
        )
    return links


def find_frame(model: "MjModel", body: int) -> Frame:
    """Frame of a body, fixed to the link that carries it."""
    data = _place_at_zero(model)
    link, axes, origin = _find_link(model, body), np.eye(3), np.zeros(3)
    chain = [link]
    while chain[-1] != GROUND:
        chain.append(int(model.dof_parentid[chain[-1]]))
    for k in reversed(chain[:-1]):
        axes, origin = _joint_axes(data.xaxis[k], axes), data.xanchor[k]
    return Frame(
        link,
        _clear_rounding_errors(axes.T @ data.xmat[body].reshape(3, 3)),
        _clear_rounding_errors(axes.T @ (data.xpos[body] - origin)),
    )


def list_omissions(model: "MjModel") -> list[str]:
    """Effects of the robot file that the rigid-body dynamics do not include, as texts."""
    texts = []
    if rubbing := [model.joint(k).name for k in range(model.njnt) if _first(model.dof_frictionloss[k])]:
        texts.append(f"dry friction (frictionloss) of {', '.join(rubbing)}")
    if coupled := _list_constraints(model, are_couplings=True):
        texts.append(f"couplings of joints (equality {', '.join(coupled)}): the joints move independently")
    if model.ntendon:
        texts.append("tendons")
    if np.any(model.body_gravcomp):
        texts.append("compensation of gravity (gravcomp)")
    return texts


def list_massless_bodies(model: "MjModel") -> list[str]:
    """Names of bodies with a joint but without mass of their own, in the order of the joints.

    Bodies that are fixed to such a body have the mass of its link.
    """
    bodies = dict.fromkeys(model.jnt_bodyid.tolist())
    return [model.body(k).name for k in bodies if not model.body_mass[k]]


def check_tree(model: "MjModel") -> None:
    """Raise ValueError, one line, for a joint that is no hinge or slide, and for a closed loop."""
    import mujoco

    allowed = {int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE)}
    for k in range(model.njnt):
        if int(model.jnt_type[k]) not in allowed:
            kind = mujoco.mjtJoint(model.jnt_type[k]).name.removeprefix("mjJNT_").lower()
            joint = f"joint {model.joint(k).name!r} of body {model.body(model.jnt_bodyid[k]).name!r}"
            raise ValueError(f"{joint} is of type {kind}; allowed are hinge and slide")
    for name in _list_constraints(model, are_couplings=False):
        raise ValueError(
            f"the constraint {name} closes a loop; allowed are trees of links: remove it from the robot file"
        )


def _list_constraints(model: "MjModel", are_couplings: bool) -> list[str]:
    """Active equality constraints: those that couple joints or tendons, or those that close loops."""
    import mujoco

    couplings = {int(mujoco.mjtEq.mjEQ_JOINT), int(mujoco.mjtEq.mjEQ_TENDON)}
    return [
        model.equality(k).name or str(k)
        for k in range(model.neq)
        if model.eq_active0[k] and (int(model.eq_type[k]) in couplings) == are_couplings
    ]


def _place_at_zero(model: "MjModel") -> Any:
    """Data of the robot with all joint positions at zero."""
    import mujoco

    data = mujoco.MjData(model)
    data.qpos[:] = 0.0
    mujoco.mj_kinematics(model, data)
    return data


def _find_link(model: "MjModel", body: int) -> int:
    """Index of the link that a body belongs to; GROUND: it does not move."""
    root = int(model.body_weldid[body])
    return int(model.body_dofadr[root] + model.body_dofnum[root] - 1) if root else GROUND


def _joint_axes(axis: Array, carrier: Array) -> Array:
    """Axes (3, 3) of a joint's frame: z along the joint axis, x normal to it and to z of `carrier`.

    carrier : axes of the link that carries the joint
    """
    z = axis / np.linalg.norm(axis)
    x = np.cross(carrier[:, 2], z)
    if np.linalg.norm(x) < 1e-9:  # parallel
        x = carrier[:, 0] - z * (z @ carrier[:, 0])
    x = x / np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z])


def _merge_bodies(
    model: "MjModel", data: Any, link: int, axes: Array, origin: Array
) -> tuple[float, Array, Array]:
    """Mass [kg], centre (3) [m] and inertia (3, 3) [kg.m2] of all bodies of a link, in its frame."""
    bodies = [b for b in range(1, model.nbody) if _find_link(model, b) == link]
    masses = model.body_mass[bodies]
    mass = float(masses.sum())
    centres = data.xipos[bodies]
    centre = masses @ centres / mass if mass else origin
    inertia = np.zeros((3, 3))
    for b, own_mass, own_centre in zip(bodies, masses, centres, strict=True):
        own_axes, lever = data.ximat[b].reshape(3, 3), own_centre - centre
        inertia += own_axes @ np.diag(model.body_inertia[b]) @ own_axes.T
        inertia += own_mass * (lever @ lever * np.eye(3) - np.outer(lever, lever))
    return (
        mass,
        _clear_rounding_errors(axes.T @ (centre - origin)),
        _clear_rounding_errors(axes.T @ inertia @ axes, np.abs(inertia).max()),
    )


def _clear_rounding_errors(values: Array, scale: float = 1.0) -> Array:
    """Copy of an array whose entries at rounding error are zero."""
    return np.where(np.abs(values) <= ROUNDING * scale, 0.0, values)


def _first(value: Any) -> float:
    """Linear coefficient of a stiffness or damping that MuJoCo stores as a number or as a polynomial."""
    return float(np.ravel(value)[0])
