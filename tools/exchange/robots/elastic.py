"""Robot (MJCF or URDF) with elastic drives in named joints: motors and tendons added, actuators moved."""

import os
import re
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape, quoteattr

import numpy as np

from jointfmu.files.reading import check_regular_file
from jointfmu.quantity import Array

from ...inputs.drawing.reading import parse_number
from . import bristles
from .mjcf import MUJOCO_DEFAULT_TIME_STEP, check_mujoco_version
from .spring_fit import FittedSpring, fit_spring
from .transmission import Transmission

ASSET_FOLDERS = ("meshdir", "texturedir")
"""Attributes of the MJCF element `<compiler>` that state the folders of meshes and textures."""
MOTOR_NAME_SUFFIX = "_motor"
"""Suffix of the name of a motor joint, after the name of the driven joint."""
MOTOR_BODY_NAME_PREFIX = "drive_motors"
"""Prefix of the names of the bodies that carry the motors."""
TIME_STEP_SAFETY_FACTOR = 2.0
"""Largest stable step over the step that is written for a robot without time step, at least [1].

Beyond the rated torque the springs are stiffer than the stable step assumes: up to four times is allowed."""
_ADVICE_BY_MUJOCO_ERROR = {
    "mjMINVAL": "; state the mass and the inertia of this link in its <inertial>",
    "could not find decoder": "; MuJoCo reads files that end in .xml or .urdf; a drive belongs to --drive",
    "Error opening file": "; expected this file in the folder of the robot file, or in its meshdir",
}
"""{part of an error of MuJoCo: what the user can do}, behind the error."""
_MAX_JOINTS_PER_BODY = 6
"""Largest number of joints of a body in MuJoCo [1]."""
_SMALL_REVERSAL_OVER_RATED_TORQUE = 1e-6
"""Torque reversal over the rated torque [1] at which the stiffness of small vibrations is computed."""
_MOTOR_BODY_MASS = 1e-12
"""Mass [kg] and inertia [kg.m2] of the bodies that carry the motors; the rotors are armatures."""


@dataclass(frozen=True, slots=True)
class ElasticAxis:
    """Joint of a robot with its elastic drive.

    rotor_inertia   : rotor inertia at the output [kg.m2]: that of the motor times the square of the ratio
    deviation_notes : texts on deviations from the robot file or from the drive
    """

    joint_name: str
    drive: Transmission
    fitted_spring: FittedSpring
    rotor_inertia: float
    deviation_notes: tuple[str, ...] = ()

    def solve_wind_up(self, torque: float) -> float:
        """Wind-up [rad] at a torque [N.m] by the law of the drive, for first loading from rest."""
        return float(self.drive.compute_wind_up([torque])[0])

    def stiffness_at_torque(self, torque: float) -> float:
        """Stiffness [N.m/rad] of small vibrations about a torque [N.m], with all sliders sticking."""
        reversal = float(np.copysign(_SMALL_REVERSAL_OVER_RATED_TORQUE * self.drive.rated_torque, torque))
        before, after = self.drive.compute_wind_up([torque, torque - reversal])
        return reversal / float(before - after)

    def list_overload_warnings(self, torque: float, pose_text: str = "") -> Iterator[str]:
        """Yield a warning if a torque [N.m] exceeds the rated or the largest torque of the drive.

        pose_text : text on the pose of the torque, before the warning
        """
        drive, size = self.drive, abs(torque)
        prefix = f"{self.joint_name}: {pose_text}{size:.4g} N.m is beyond the"
        if size > drive.max_torque:
            yield f"{prefix} max_torque, {drive.max_torque:g} N.m, of {drive.drive_name}, where its law ends"
        elif size > drive.rated_torque:
            yield f"{prefix} rated torque, {drive.rated_torque:g} N.m, of {drive.drive_name}"


def read_robot(robot_path: str | Path) -> Any:
    """Read a robot (MJCF or URDF) as an MjSpec of MuJoCo; raises ValueError if that fails."""
    import mujoco

    check_mujoco_version()
    expected = "a robot (MJCF or URDF)"
    check_regular_file(robot_path, expected)
    if not Path(robot_path).exists():
        raise ValueError(f"{robot_path}: cannot be read (no such file); expected {expected}")
    try:
        spec = mujoco.MjSpec.from_file(str(robot_path))
        spec.compiler.fusestatic = False  # keep the tool frames of a URDF, which are fixed links
        spec.compile()
    except (ValueError, OSError, mujoco.FatalError) as error:
        line = ", ".join(filter(None, map(str.strip, str(error).splitlines()))).removeprefix("Error: ")
        advice = next((text for part, text in _ADVICE_BY_MUJOCO_ERROR.items() if part in line), "")
        raise ValueError(f"{robot_path}: cannot be read as {expected}: {line}{advice}") from None
    _check_joint_names(robot_path, spec)
    return spec


def _check_joint_names(robot_path: str | Path, robot_spec: Any) -> None:
    """Raise ValueError if joints of a URDF have the same name: MuJoCo keeps only one of these names."""
    unnamed = [joint.parent.name for joint in robot_spec.joints if not joint.name]
    if unnamed and b"<robot" in Path(robot_path).read_bytes():
        raise ValueError(
            f"{robot_path}: the joint of link {unnamed[0]!r} has the name of another joint; "
            "expected a name of its own"
        )


def make_axes(robot_spec: Any, drive_by_joint: Mapping[str, Transmission]) -> list[ElasticAxis]:
    """Make the elastic axes of the joints in `drive_by_joint`, in the order of the robot.

    Raises ValueError for a name that is not a hinge of the robot.
    """
    import mujoco

    model = robot_spec.compile()
    hinges = [model.joint(i) for i in range(model.njnt) if model.jnt_type[i] == mujoco.mjtJoint.mjJNT_HINGE]
    known = [joint.name for joint in hinges]
    for name in drive_by_joint:
        if name not in known:
            raise ValueError(
                f"{name!r} is not a hinge of the robot; allowed are {', '.join(filter(None, known))}"
            )
    matrix = compute_mass_matrix(model, model.qpos0)
    fit_drive = cache(fit_spring)  # axes may share a drive
    elastic_axes = []
    for joint in hinges:
        if joint.name in drive_by_joint:
            drive, dof = drive_by_joint[joint.name], joint.dofadr[0]
            rotor, notes = float(model.dof_armature[dof]), list[str]()
            if rotor <= 0.0:
                rotor = float(matrix[dof, dof])
                notes.append(
                    f"no armature in the file; it is set to {rotor:.4g} kg.m2, the inertia that the axis "
                    "moves in the reference pose of the file; the rotor inertia is then "
                    f"{rotor / drive.ratio**2:.4g} kg.m2"
                )
            lines = tuple(f"{joint.name}: {line}" for line in notes)
            spring = fit_drive(drive, drive.rated_torque)
            elastic_axes.append(ElasticAxis(joint.name, drive, spring, rotor, lines))
    return elastic_axes


def list_presliding_notes(robot_spec: Any, robot_axes: Iterable[ElasticAxis]) -> Iterator[str]:
    """Yield a text for each motor whose presliding angle in the MJCF exceeds that in the FMU."""
    for axis in robot_axes:
        drive, inertia = axis.drive, axis.rotor_inertia / axis.drive.ratio**2
        if drive.static_friction and bristles.is_integrator_stable(robot_spec.option):
            angle = bristles.compute_presliding_angle(drive, inertia, robot_spec.option.timestep)
            if angle > 1.01 * drive.presliding_angle:
                yield (
                    f"{axis.joint_name}: friction builds up over {angle:.3g} rad of the motor in the MJCF, "
                    f"because its steps are long, and over {drive.presliding_angle:g} rad in the FMU"
                )


def set_default_time_step(robot_spec: Any, robot_path: str | Path, largest_stable_step: float) -> None:
    """Set a step of 1, 2, 5, 10, ... for a robot whose file states none, if MuJoCo's default is too long.

    A step in an included file is found unless it is MuJoCo's default.

    largest_stable_step : of the robot with its drives [s]
    """
    if robot_spec.option.timestep != MUJOCO_DEFAULT_TIME_STEP or b"timestep" in Path(robot_path).read_bytes():
        return
    allowed = largest_stable_step / TIME_STEP_SAFETY_FACTOR
    if allowed < MUJOCO_DEFAULT_TIME_STEP:
        decade = 10.0 ** np.floor(np.log10(allowed))
        digit = max(x for x in (1.0, 2.0, 5.0) if x * decade <= allowed)
        robot_spec.option.timestep = float(f"{digit * decade:.1g}")


def compute_mass_matrix(robot_model: Any, robot_pose: Array) -> Array:
    """Mass matrix (n, n) of all degrees of freedom at a pose."""
    import mujoco

    data = mujoco.MjData(robot_model)
    data.qpos[:] = robot_pose
    mujoco.mj_forward(robot_model, data)
    columns = []
    for unit in np.eye(robot_model.nv):
        column = np.zeros(robot_model.nv)
        mujoco.mj_mulM(robot_model, data, column, unit)
        columns.append(column)
    return np.array(columns)


def add_drives(robot_spec: Any, axes_with_drive: list[ElasticAxis], has_springs: bool = True) -> Any:
    """Copy the robot, add motors and drives (tendons, see `mjcf`), and move the actuators to the motors.

    Keyframes are omitted: they have no positions for the motors.

    axes_with_drive : axes that get a motor and a drive
    has_springs     : whether to add the drives and the friction of the motors
    """
    elastic_spec, model = robot_spec.copy(), robot_spec.compile()
    for key in [*elastic_spec.keys]:
        elastic_spec.delete(key)
    for i, axis in enumerate(axes_with_drive):
        if i % _MAX_JOINTS_PER_BODY == 0:
            motors = _add_motor_body(elastic_spec, f"{MOTOR_BODY_NAME_PREFIX}{i // _MAX_JOINTS_PER_BODY + 1}")
        motor = _add_motor(elastic_spec, motors, axis, model)
        if not has_springs:
            continue
        motor.damping = [axis.drive.viscous_friction, 0.0, 0.0]
        if not bristles.is_integrator_stable(elastic_spec.option):
            motor.frictionloss = axis.drive.dry_friction
        elif axis.drive.static_friction:
            bristles.add_friction(
                elastic_spec, axis.drive, motor.name, motor.armature, elastic_spec.option.timestep
            )
        for name, stiffness, damping, limit in _list_tendons(axis):
            tendon = elastic_spec.add_tendon(
                name=name, stiffness=stiffness, damping=damping, springlength=[0.0, 0.0]
            )
            tendon.springyield = limit
            tendon.wrap_joint(axis.joint_name, 1.0)
            tendon.wrap_joint(axis.joint_name + MOTOR_NAME_SUFFIX, -1.0 / axis.drive.ratio)
    return elastic_spec


def _list_tendons(robot_axis: ElasticAxis) -> Iterator[tuple[str, list[float], list[float], float]]:
    """List the MuJoCo tendons of a drive: name, stiffness, damping, wind-up [rad] at which each yields."""
    fitted, zero = robot_axis.fitted_spring, [0.0, 0.0, 0.0]
    name = f"{robot_axis.joint_name}_drive"
    yield (
        name,
        [fitted.linear_stiffness, 0.0, fitted.cubic_stiffness],
        [robot_axis.drive.output_damping, 0.0, 0.0],
        0.0,
    )
    for i, (spring, limit) in enumerate(fitted.yielding_springs, 1):
        yield f"{name}_slider{i}", [spring, 0.0, 0.0], zero, limit


def _add_motor_body(robot_spec: Any, body_name: str) -> Any:
    """Add a body for motor joints to the world. No link moves with this body: the rotors are armatures."""
    body = robot_spec.worldbody.add_body(name=body_name)
    body.mass, body.inertia, body.explicitinertial = _MOTOR_BODY_MASS, [_MOTOR_BODY_MASS] * 3, True
    body.ipos, body.iquat = [0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]
    return body


def _add_motor(robot_spec: Any, motor_body: Any, robot_axis: ElasticAxis, rigid_model: Any) -> Any:
    """Add the motor of an axis, whose coordinate is the motor angle [rad], and move the actuators to it.

    The force limit of the robot's joint is applied to each actuator, not to the motor joint as a whole, as
    the friction of the motor is an actuator too. The motor joint is a slide: MuJoCo then computes no
    rotation, and the motor is uncoupled in the mass matrix.

    rigid_model : MjModel of the robot without drives
    """
    import mujoco

    joint, ratio, number = (
        robot_spec.joint(robot_axis.joint_name),
        robot_axis.drive.ratio,
        rigid_model.joint(robot_axis.joint_name).id,
    )
    motor = motor_body.add_joint(
        name=robot_axis.joint_name + MOTOR_NAME_SUFFIX, type=mujoco.mjtJoint.mjJNT_SLIDE
    )
    motor.armature = robot_axis.rotor_inertia / ratio**2
    joint.armature = 0.0
    for actuator in robot_spec.actuators:
        if actuator.trntype == mujoco.mjtTrn.mjTRN_JOINT and actuator.target == robot_axis.joint_name:
            if rigid_model.jnt_actfrclimited[number] and actuator.gear[0]:
                _limit_force(actuator, rigid_model.jnt_actfrcrange[number] / actuator.gear[0])
            actuator.target = robot_axis.joint_name + MOTOR_NAME_SUFFIX
            actuator.gear = np.asarray(actuator.gear) / ratio
    return motor


def _limit_force(actuator: Any, force_range: Array) -> None:
    """Limit the force of an actuator to a range, and to its own range if it has one."""
    low, high = np.sort(force_range)
    previous = np.asarray(actuator.forcerange)
    if previous[0] < previous[1] and actuator.forcelimited != 0:
        low, high = max(low, previous[0]), min(high, previous[1])
    actuator.forcelimited, actuator.forcerange = 1, [low, high]


def coordinate_unit(robot_model: Any, joint_name: str) -> str:
    """Unit of the coordinate of a hinge (rad) or a slide (m)."""
    import mujoco

    return "m" if robot_model.joint(joint_name).type[0] == mujoco.mjtJoint.mjJNT_SLIDE else "rad"


def make_robot_pose(robot_model: Any, position_texts: Mapping[str, str]) -> Array:
    """Joint positions of the rigid robot: first keyframe or default pose, with given angles replaced.

    position_texts : {joint: text of its position [rad or m], or with a unit}

    Raises ValueError for an unknown joint, or a position that is not a number or outside the joint's range.
    """
    import mujoco

    single = {int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE)}
    pose = np.array(robot_model.key_qpos[0] if robot_model.nkey else robot_model.qpos0)
    known = {
        robot_model.joint(i).name: int(robot_model.jnt_qposadr[i])
        for i in range(robot_model.njnt)
        if int(robot_model.jnt_type[i]) in single
    }
    for name, text in position_texts.items():
        if name not in known:
            raise ValueError(f"--pose {name}: no joint of the robot; allowed are {', '.join(known)}")
        unit = coordinate_unit(robot_model, name)
        try:
            value = parse_number("pose", text, unit, unit, lower_bound=None)
        except ValueError as error:
            raise ValueError(str(error).replace("--pose", f"--pose {name}", 1)) from None
        joint = robot_model.joint(name).id
        low, high = robot_model.jnt_range[joint] if robot_model.jnt_limited[joint] else (-np.inf, np.inf)
        if not low <= value <= high:
            is_in_degrees = unit == "rad" and text[-1].isdigit() and low <= np.deg2rad(value) <= high
            raise ValueError(
                f"--pose {name} = {value:g} {unit} is outside [{low:g}, {high:g}] {unit}"
                + (f"; an angle in degrees is {name}={text}deg" if is_in_degrees else "")
            )
        pose[known[name]] = value
    return pose


def find_body(robot_model: Any, body_name: str | None, axes_with_drive: list[ElasticAxis]) -> int:
    """Index of the body with a name; None: the last body of the chain behind the last axis."""
    known = [robot_model.body(i).name for i in range(robot_model.nbody)]
    if body_name is not None:
        if body_name not in known:
            raise ValueError(f"--tip {body_name!r}: no body of the robot; allowed are {', '.join(known[1:])}")
        return known.index(body_name)
    end = int(robot_model.jnt_bodyid[robot_model.joint(axes_with_drive[-1].joint_name).id])
    while (children := np.flatnonzero(robot_model.body_parentid[1:] == end) + 1).size:
        end = int(children[-1])
    return end


def make_mesh_folders_absolute(robot_spec: Any, robot_path: Path) -> None:
    """Make the folders of meshes and textures absolute, so that the robot compiles in every folder."""
    for name in ASSET_FOLDERS:
        setattr(robot_spec, name, str((robot_path.parent / getattr(robot_spec, name)).resolve()))


def format_with_relative_folders(mjcf_text: str, robot_spec: Any, output_folder: Path) -> str:
    """MJCF text with the folders of meshes and textures relative to the folder of the file.

    mjcf_text     : MJCF of `robot_spec`, whose folders are absolute
    output_folder : folder of the file

    On Windows, a folder on another drive stays absolute.
    """
    for name in ASSET_FOLDERS:
        folder = getattr(robot_spec, name)
        with suppress(ValueError):  # another drive
            relative = Path(os.path.relpath(folder, output_folder.resolve())).as_posix()
            for attribute in (name, "assetdir"):
                pattern = rf'\b{attribute}="{re.escape(escape(folder))}[/\\]?"'
                mjcf_text = re.sub(pattern, lambda _: f"{attribute}={quoteattr(relative + '/')}", mjcf_text)  # noqa: B023
    return mjcf_text
