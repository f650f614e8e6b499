"""A robot as MJCF or URDF whose named joints become elastic: motor, tendons of the drive, actuators moved."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from jointfmu.files.reading import check_regular
from jointfmu.quantity import Array

from . import bristles
from .fitted import FittedTendons, fit
from .mjcf import check_version
from .transmission import Transmission

MOTOR = "_motor"
"""What the motor's coordinate has after the name of the joint."""
MOTORS = "drive_motors"
"""What the name of their bodies begins with."""
_ROOM = 6
"""Coordinates that MuJoCo allows in a body."""
_BACK = 1e-6
"""Step back [1] over the rated torque that small vibrations make."""
_LIGHT = 1e-12
"""Mass [kg] and inertia [kg.m2] of the motors' body; their rotors are armatures."""


@dataclass(frozen=True, slots=True)
class ElasticAxis:
    """A joint of the robot with its drive.

    rotor : inertia at the output [kg.m2], that of the motor times the square of the ratio
    noted : what is not as the robot or the drive has it
    """

    joint: str
    drive: Transmission
    fitted: FittedTendons
    rotor: float
    noted: tuple[str, ...] = ()

    def wind_up(self, torque: float) -> float:
        """[rad] by the drive's own law, on the way from rest at a torque [N.m]."""
        return float(self.drive.wind_up([torque])[0])

    def stiffness(self, torque: float) -> float:
        """[N.m/rad] of small vibrations about a torque [N.m]: what slides sticks again."""
        back = float(np.copysign(_BACK * self.drive.rated_torque, torque))
        there, after = self.drive.wind_up([torque, torque - back])
        return back / float(there - after)

    def overload(self, torque: float) -> Iterator[str]:
        """What to say of a torque [N.m] beyond those of the drive."""
        drive, size = self.drive, abs(torque)
        what = f"{self.joint}: {size:.4g} N.m is beyond the"
        if size > drive.max_torque:
            yield f"{what} max_torque, {drive.max_torque:g} N.m, of {drive.name}, where its law ends"
        elif size > drive.rated_torque:
            yield f"{what} rated torque, {drive.rated_torque:g} N.m, of {drive.name}"


def read(path: str | Path) -> Any:
    """The robot of a file, MJCF or URDF, as MuJoCo's MjSpec. ValueError if it cannot be read."""
    import mujoco

    check_version()
    check_regular(path, "a robot (MJCF or URDF)")
    try:
        spec = mujoco.MjSpec.from_file(str(path))
        spec.compiler.fusestatic = False  # of a URDF, whose tool frames are links that do not move
        spec.compile()
    except (ValueError, OSError, mujoco.FatalError) as error:
        line = " ".join(str(error).split())
        raise ValueError(f"{path}: cannot be read as a robot (MJCF or URDF): {line}") from None
    return spec


def axes(spec: Any, drives: Mapping[str, Transmission]) -> list[ElasticAxis]:
    """The joints that get a drive, in the robot's order.

    Raises ValueError for a name that is no hinge.
    """
    import mujoco

    model = spec.compile()
    hinges = [model.joint(i) for i in range(model.njnt) if model.jnt_type[i] == mujoco.mjtJoint.mjJNT_HINGE]
    known = [joint.name for joint in hinges]
    for name in drives:
        if name not in known:
            raise ValueError(
                f"{name!r} is no hinge of the robot; allowed are {', '.join(filter(None, known))}"
            )
    matrix = mass_matrix(model, model.qpos0)
    found = []
    for joint in hinges:
        if joint.name in drives:
            drive, dof = drives[joint.name], joint.dofadr[0]
            own = float(model.dof_armature[dof])
            rotor, noted = own, []
            if own <= 0.0:
                rotor = float(matrix[dof, dof])
                noted.append("no armature; the rotor is taken as large as what the axis turns")
            if drive.static and bristles.borne(model.opt):
                angle = bristles.presliding(drive, rotor / drive.ratio**2, model.opt.timestep)
                if angle > 1.01 * drive.presliding:
                    noted.append(
                        f"friction builds up over {angle:.3g} rad of the motor, as the step asks, "
                        f"{drive.presliding:g} rad in the FMU"
                    )
            lines = tuple(f"{joint.name}: {line}" for line in noted)
            found.append(ElasticAxis(joint.name, drive, fit(drive, drive.rated_torque), rotor, lines))
    return found


def mass_matrix(model: Any, pose: Array) -> Array:
    """Of all degrees of freedom (n, n) at a pose."""
    import mujoco

    data = mujoco.MjData(model)
    data.qpos[:] = pose
    mujoco.mj_forward(model, data)
    columns = []
    for unit in np.eye(model.nv):
        column = np.zeros(model.nv)
        mujoco.mj_mulM(model, data, column, unit)
        columns.append(column)
    return np.array(columns)


def with_drives(spec: Any, chosen: list[ElasticAxis], springs: bool = True) -> Any:
    """A copy of the robot with motors, drives as `mjcf` writes them, and the actuators at the motors.

    Keyframes are left out, whose positions are of fewer joints.

    springs : False leaves out the drives, and the friction of their motors
    """
    made, model = spec.copy(), spec.compile()
    for key in [*made.keys]:
        made.delete(key)
    for i, axis in enumerate(chosen):
        if i % _ROOM == 0:
            motors = _motors(made, f"{MOTORS}{i // _ROOM + 1}")
        motor = _add_motor(made, motors, axis, model)
        if not springs:
            continue
        motor.damping = [axis.drive.viscous, 0.0, 0.0]
        if not bristles.borne(made.option):
            motor.frictionloss = axis.drive.dry
        elif axis.drive.static:
            bristles.add(made, axis.drive, motor.name, motor.armature, made.option.timestep)
        for name, stiffness, damping, limit in _springs(axis):
            tendon = made.add_tendon(name=name, stiffness=stiffness, damping=damping, springlength=[0.0, 0.0])
            tendon.springyield = limit
            tendon.wrap_joint(axis.joint, 1.0)
            tendon.wrap_joint(axis.joint + MOTOR, -1.0 / axis.drive.ratio)
    return made


def _springs(axis: ElasticAxis) -> Iterator[tuple[str, list[float], list[float], float]]:
    """Name, stiffness, damping and yield of each tendon."""
    fitted, none = axis.fitted, [0.0, 0.0, 0.0]
    name = f"{axis.joint}_drive"
    yield name, [fitted.linear, 0.0, fitted.cubic], [axis.drive.damping, 0.0, 0.0], 0.0
    for i, (spring, limit) in enumerate(fitted.sliders, 1):
        yield f"{name}_slider{i}", [spring, 0.0, 0.0], none, limit


def _motors(spec: Any, name: str) -> Any:
    """A body of the world for motors: what turns in it moves nothing else, as the rotor of an armature."""
    body = spec.worldbody.add_body(name=name)
    body.mass, body.inertia, body.explicitinertial = _LIGHT, [_LIGHT] * 3, True
    body.ipos, body.iquat = [0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]
    return body


def _add_motor(spec: Any, motors: Any, axis: ElasticAxis, rigid: Any) -> Any:
    """The motor's angle [rad], and the joint's actuators at it, each within the joint's own limit of all,
    as friction is an actuator too. It is a slide, which costs MuJoCo no rotation and has a place of its own
    on the diagonal of the mass matrix.

    rigid : the robot's MjModel
    """
    import mujoco

    joint, ratio, number = spec.joint(axis.joint), axis.drive.ratio, rigid.joint(axis.joint).id
    motor = motors.add_joint(name=axis.joint + MOTOR, type=mujoco.mjtJoint.mjJNT_SLIDE)
    motor.armature = axis.rotor / ratio**2
    joint.armature = 0.0
    for actuator in spec.actuators:
        if actuator.trntype == mujoco.mjtTrn.mjTRN_JOINT and actuator.target == axis.joint:
            if rigid.jnt_actfrclimited[number] and actuator.gear[0]:
                _limit(actuator, rigid.jnt_actfrcrange[number] / actuator.gear[0])
            actuator.target = axis.joint + MOTOR
            actuator.gear = np.asarray(actuator.gear) / ratio
    return motor


def _limit(actuator: Any, ends: Array) -> None:
    """Keep an actuator's force between two ends, and its own where it has some."""
    low, high = np.sort(ends)
    own = np.asarray(actuator.forcerange)
    if own[0] < own[1] and actuator.forcelimited != 0:
        low, high = max(low, own[0]), min(high, own[1])
    actuator.forcelimited, actuator.forcerange = 1, [low, high]


def unit(model: Any, name: str) -> str:
    """Of the coordinate of a hinge or a slide."""
    import mujoco

    return "m" if model.joint(name).type[0] == mujoco.mjtJoint.mjJNT_SLIDE else "rad"


def posed(model: Any, angles: Mapping[str, str]) -> Array:
    """Positions of the rigid robot: its first keyframe, or as it is drawn, with stated angles [rad].

    Raises ValueError for a joint that it has not or an angle that is no number within the joint's range.
    """
    import mujoco

    single = {int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE)}
    pose = np.array(model.key_qpos[0] if model.nkey else model.qpos0)
    known = {
        model.joint(i).name: int(model.jnt_qposadr[i])
        for i in range(model.njnt)
        if int(model.jnt_type[i]) in single
    }
    for name, text in angles.items():
        if name not in known:
            raise ValueError(f"--pose {name}: no joint of the robot; allowed are {', '.join(known)}")
        try:
            value = float(text)
        except ValueError:
            raise ValueError(f"--pose {name} = {text!r} is no number") from None
        joint = model.joint(name).id
        low, high = model.jnt_range[joint] if model.jnt_limited[joint] else (-np.inf, np.inf)
        if not (np.isfinite(value) and low <= value <= high):
            allowed = f"[{low:g}, {high:g}]" if model.jnt_limited[joint] else "(-inf, inf)"
            raise ValueError(
                f"--pose {name} = {text} {unit(model, name)} is outside {allowed} {unit(model, name)}"
            )
        pose[known[name]] = value
    return pose


def body(model: Any, name: str | None, chosen: list[ElasticAxis]) -> int:
    """The body of a name; without one that at the end of what the last axis carries."""
    known = [model.body(i).name for i in range(model.nbody)]
    if name is not None:
        if name not in known:
            raise ValueError(f"--tip {name!r}: no body of the robot; allowed are {', '.join(known[1:])}")
        return known.index(name)
    end = int(model.jnt_bodyid[model.joint(chosen[-1].joint).id])
    while (children := np.flatnonzero(model.body_parentid[1:] == end) + 1).size:
        end = int(children[-1])
    return end


def keep_folders(spec: Any, path: Path) -> None:
    """Let meshes and textures be found from another folder."""
    for name in ("meshdir", "texturedir"):
        setattr(spec, name, str((path.parent / getattr(spec, name)).resolve()))
