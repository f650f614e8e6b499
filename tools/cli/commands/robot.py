"""`jointfmu robot`: add elastic drives to the joints of a robot file (MJCF or URDF)."""

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from jointfmu.files.outputs import (
    ACTUATOR_FILE,
    ARCHIVE_FILE,
    EXPORTED_TEXT_FILE,
    OUTPUT_FOLDER,
    PICTURE_FILE,
    PROGRAM_MARK,
    check_output,
    check_outputs,
)
from jointfmu.files.writing import write_text

from ...common import plots
from ...common.options import require_package
from ...inputs.drawing.reading import parse_number
from ..command import CommandResult, SubParsers, declare_argument, declare_command
from ..outputs import check_input_overwrite, declare_output

MAX_PAYLOAD = 1e4
"""Largest payload that the option `--payload` may have [kg]."""
RINGING_DURATION, RINGING_TIME_STEP = 1.0, 2e-4
"""Time after a stop, and interval of its results [s]."""


def add_command(command_parsers: SubParsers) -> None:
    """Declare the command `jointfmu robot` with its options."""
    text = "add elastic drives to joints of a robot (MJCF, URDF)"
    sub = declare_command(command_parsers, "robot", _run_robot, text)
    several: dict[str, Any] = {"nargs": "+", "action": "extend"}
    declare_argument(sub, "robot", Path, "robot file, MJCF or URDF", "ROBOT")
    text = (
        "joint of the robot and its drive: a name of jointfmu catalogue or a parameter file, as in "
        "joint2=CSG-40-100"
    )
    declare_argument(sub, "--drive", str, text, "JOINT=NAME", required=True, **several)
    declare_argument(
        sub, "--payload", str, "mass of the payload, a point mass at the tip [kg]", "M", default="1"
    )
    text = "body whose origin is the tip (default: the last body after the last axis)"
    declare_argument(sub, "--tip", str, text, "BODY")
    sub.add_argument(
        "--pose",
        nargs="+",
        action="extend",
        default=[],
        metavar="JOINT=ANGLE",
        help=(
            "joint angles [rad, or with a unit as in 90deg] of the pose for deflection and vibration; other "
            "joints are at zero or as in the first keyframe (default: of a grid of poses, the one with the "
            "largest deflection of the tip)"
        ),
    )
    text = "also write the robot with its drives as MuJoCo plugins, compiled on this machine"
    sub.add_argument("--plugin", action="store_true", help=text)
    text = "also write the robot as one FMU, NAME.fmu in FMI 2.0 and 3.0, with its rigid-body dynamics"
    sub.add_argument("--fmu", action="store_true", help=text)
    text = "with --fmu: inputs of the motors: torque; or angle, with speed and acceleration (default: torque)"
    sub.add_argument("--motors", choices=("torque", "angle"), help=text)
    declare_output(sub, "--out", OUTPUT_FOLDER, "folder to write", required=True)


def _run_robot(args: argparse.Namespace) -> CommandResult:
    """Run the command `jointfmu robot`."""
    names, angles = (
        _parse_joint_values(args.drive, "--drive", "NAME"),
        _parse_joint_values(args.pose, "--pose", "ANGLE"),
    )
    args.payload = parse_number("payload", args.payload, "kg", "kg", lower_bound=None)
    if not 0.0 <= args.payload <= MAX_PAYLOAD:
        raise ValueError(f"--payload = {args.payload:g} kg is outside [0, {MAX_PAYLOAD:g}] kg")
    pictures = [args.out / f"{name}.png" for name in ("frequencies", "payload", "ringing")]
    plots.check_picture_path(pictures[0])
    check_outputs(pictures, PICTURE_FILE, args.force)
    written = args.out / f"{args.robot.stem}_elastic.xml"
    rigid = args.out / f"{args.robot.stem}_rigid.xml"
    actuators = args.out / f"{args.robot.stem}_actuators.json"
    models = [written, rigid, *([args.out / f"{args.robot.stem}_plugin.xml"] if args.plugin else [])]
    check_input_overwrite(models, args, ("out",))
    check_outputs(models, EXPORTED_TEXT_FILE, args.force)
    check_output(actuators, ACTUATOR_FILE, args.force)
    with require_package("read robots", "mujoco"):
        import mujoco  # noqa: F401
    from ...api import load
    from ...exchange.robots import elastic, poses, rigid_joints, rigid_tree, robot_system
    from ...exchange.robots import pictures as drawn
    from ...exchange.robots.names import check_plugin_names, make_identifier
    from ...joints.harmonic_drive.transmission import make_transmission
    from ...systems.fmu.build import build_system_fmus, list_system_fmu_paths

    spec = elastic.read_robot(args.robot)
    loaded = {name: load(name).file for name in dict.fromkeys(names.values())}  # axes may share a drive
    files = {joint: loaded[name] for joint, name in names.items()}
    if args.plugin:
        check_plugin_names(files)
    if args.motors and not args.fmu:
        raise ValueError(f"--motors {args.motors} has no effect without --fmu")
    title = make_identifier(args.robot.stem)
    drives = {name: make_transmission(file) for name, file in loaded.items()}
    axes = elastic.make_axes(spec, {joint: drives[name] for joint, name in names.items()})
    model = spec.compile()
    pose, tip = elastic.make_robot_pose(model, angles), elastic.find_body(model, args.tip, axes)
    if args.fmu:
        robot_system.list_joint_names(model)
        check_outputs(list_system_fmu_paths(title, args.out), ARCHIVE_FILE, args.force)
    grid, found = drawn.compute_frequencies_over_grid(model, axes, pose, args.payload, tip)
    drawn.draw_frequencies(pictures[0], axes, grid, found)
    if not angles:
        pose = drawn.find_worst_pose(model, axes, pose, grid, args.payload, tip)
    elastic.set_default_time_step(spec, args.robot, poses.find_largest_stable_step(model, axes, pose))
    has_new_step, model.opt.timestep = spec.option.timestep != model.opt.timestep, spec.option.timestep
    longest = poses.find_largest_stable_step(model, axes, pose)
    _write_robot(written, elastic.add_drives(spec, axes), args)
    _write_robot(rigid, rigid_joints.add_rigid_drives(spec, axes), args)
    write_text(actuators, rigid_joints.format_actuators(axes))
    wound, sunk = drawn.draw_deflection_over_payload(pictures[1], model, axes, pose, args.payload, tip)
    ringing = poses.compute_ringing(
        model, axes, pose, args.payload, tip, np.arange(0.0, RINGING_DURATION, RINGING_TIME_STEP)
    )
    drawn.draw_ringing(pictures[2], axes, ringing)
    more = []
    with require_package("compile", "mujoco"):
        if args.plugin:
            more += _write_robot_with_plugins(args, spec, axes, files)
        if args.fmu:
            arm = robot_system.read_arm(
                model,
                axes,
                files,
                pose,
                args.payload,
                tip,
                has_prescribed_motor_motion=args.motors == "angle",
            )
            text = f"{args.robot.stem} with elastic drives"
            more += build_system_fmus(
                robot_system.make_robot_system(arm, title, text, args.payload), args.out, overwrite=args.force
            )
    weight, jacobian = poses.compute_weight_torques(model, axes, pose, args.payload, tip)
    plain, plain_sunk = poses.compute_weight_deflection(
        model, axes, pose, args.payload, tip, [axis.fitted_spring for axis in axes]
    )
    under = list(zip(axes, weight.tolist(), strict=True))
    notes = []
    if has_new_step:
        notes.append(
            f"{args.robot} states no timestep; the written files have {model.opt.timestep:g} s. MuJoCo can "
            f"diverge with steps above {longest:.3g} s"
        )
    elif model.opt.timestep > longest:
        notes.append(
            f"the timestep of {args.robot}, {model.opt.timestep:g} s, is too long for the drives: MuJoCo can "
            f"diverge; use at most {longest:.3g} s, and write the files again"
        )
    notes += [line for axis in axes for line in axis.deviation_notes]
    notes += elastic.list_presliding_notes(spec, axes)
    notes += [line for axis, torque in under for line in axis.list_overload_warnings(torque)]
    largest = drawn.compute_largest_torques(model, axes, pose, grid, args.payload, tip).tolist()
    notes += _describe_other_poses(under, largest)
    if not any(map(drawn.is_loaded_by_weight, axes, largest)):
        notes.append(
            f"{', '.join(axis.joint_name for axis in axes)}: weight and payload load no drive in any pose of "
            "the grid; the payload changes only the natural frequencies, by its inertia"
        )
    last = axes[-1].joint_name
    if args.payload and not jacobian[:, -1].any() and model.jnt_bodyid[model.joint(last).id] == tip:
        notes.append(
            f"the payload is at the origin of {model.body(tip).name}, on the axis of {last}, and does not "
            "load that axis; state another body (a link of a URDF) with --tip BODY"
        )
    notes += [
        f"{body}: no mass in the file; only bodies that are fixed to it have mass"
        for body in rigid_tree.list_massless_bodies(model)
    ]
    if args.fmu and (omitted := rigid_tree.list_omitted_effects(model)):
        notes.append(f"the FMU does not include {', '.join(omitted)}")
    lacking = (
        f"{axis.drive.drive_name}: the MJCF does not include {line}"
        for axis in axes
        for line in axis.drive.omitted_effects
    )
    notes += dict.fromkeys(lacking)
    facts = {
        "written": [str(path) for path in (written, rigid, actuators, *pictures, *more)],
        "payload": args.payload,
        "tip": model.body(tip).name,
        "pose": {
            name: float(pose[model.joint(name).qposadr[0]])
            for name in dict.fromkeys([*(axis.joint_name for axis in axes), *angles])
        },
        "frequencies": {"lowest": float(found.min()), "highest": float(found.max())},
        "torque": {axis.joint_name: torque for axis, torque in under},
        "wind_up": dict(zip([axis.joint_name for axis in axes], wound.tolist(), strict=True)),
        "stiffness": {axis.joint_name: axis.stiffness_at_torque(torque) for axis, torque in under},
        "tip_error": sunk,
        "ringing": {
            axis.joint_name: {
                "amplitude": float(result.tip_distance[0]),
                "last_amplitude": result.final_tip_amplitude,
            }
            for axis, result in zip(axes, ringing, strict=True)
        },
        "plain": {
            "wind_up": dict(zip([axis.joint_name for axis in axes], plain.tolist(), strict=True)),
            "stiffness": {
                axis.joint_name: axis.fitted_spring.stiffness_at_torque(torque) for axis, torque in under
            },
            "tip_error": plain_sunk,
        },
        "rigid_joints": {axis.joint_name: rigid_joints.rigid_drive_values(axis) for axis in axes},
        "longest_step": longest,
        "notes": notes,
    }
    return CommandResult(json_document=facts, output_lines=_format_results(facts, model))


def _describe_other_poses(
    weight_torques: Sequence[tuple[Any, float]], largest_torques: Sequence[float]
) -> list[str]:
    """Warn of axes that are overloaded in a pose of the grid, but not in the pose of the results.

    weight_torques  : axes with their torques [N.m] in the pose of the results
    largest_torques : largest torques [N.m] of the poses over the grid
    """
    lines = []
    for (axis, torque), largest in zip(weight_torques, largest_torques, strict=True):
        if not list(axis.list_overload_warnings(torque)):
            lines += axis.list_overload_warnings(largest, "in another pose of the grid ")
    return lines


def _write_robot(mjcf_path: Path, robot_spec: Any, args: argparse.Namespace) -> None:
    """Write a robot as MJCF; the folders of its meshes are relative to the file."""
    from ...exchange.robots import elastic

    elastic.make_mesh_folders_absolute(robot_spec, args.robot)
    robot_spec.compile()
    text = elastic.format_with_relative_folders(robot_spec.to_xml(), robot_spec, args.out)
    write_text(mjcf_path, f"<!-- {PROGRAM_MARK} -->\n{text}")


def _write_robot_with_plugins(
    args: argparse.Namespace, robot_spec: Any, robot_axes: Any, drive_files: Any
) -> list[Path]:
    """Write the robot with MuJoCo plugins, and compile the plugins; returns the paths."""
    from ...exchange.robots import elastic, plugin_robot

    elastic.make_mesh_folders_absolute(robot_spec, args.robot)
    written = args.out / f"{args.robot.stem}_plugin.xml"
    text = plugin_robot.format_robot_with_plugins(robot_spec, robot_axes, drive_files)
    text = elastic.format_with_relative_folders(text, robot_spec, args.out)
    write_text(written, f"<!-- {PROGRAM_MARK} -->\n{text}")
    return [written, *plugin_robot.compile_plugins(drive_files, args.out).values()]


def _format_results(json_document: dict[str, Any], robot_model: Any) -> Sequence[str]:
    """Format the results of a robot with elastic drives as lines of text."""
    from ...exchange.robots.elastic import coordinate_unit
    from ...exchange.robots.rigid_joints import format_rigid_drive_values

    span, payload, plain = json_document["frequencies"], json_document["payload"], json_document["plain"]
    return [
        *(f"wrote {path}" for path in json_document["written"]),
        f"natural frequencies over the poses: {span['lowest']:.4g} to {span['highest']:.4g} Hz",
        f"with {payload:g} kg at "
        + ", ".join(
            f"{name} = {x:.4g} {coordinate_unit(robot_model, name)}"
            for name, x in json_document["pose"].items()
        ),
        *(
            f"{name}: wind-up {1e3 * x:.4g} mrad, {json_document['stiffness'][name]:.4g} N.m/rad, at "
            f"{json_document['torque'][name]:.4g} N.m; in the plain file {1e3 * plain['wind_up'][name]:.4g} "
            f"mrad, {plain['stiffness'][name]:.4g} N.m/rad"
            for name, x in json_document["wind_up"].items()
        ),
        *(
            f"{name} as a rigid joint: {format_rigid_drive_values(figures)}"
            for name, figures in json_document["rigid_joints"].items()
        ),
        f"tip error at {json_document['tip']}: {1e3 * json_document['tip_error']:.4g} mm; in the plain file "
        f"{1e3 * plain['tip_error']:.4g} mm",
        *(
            f"stop of {name} from rated torque: the tip rings with {1e3 * values['amplitude']:.3g} mm, "
            f"between {0.9 * RINGING_DURATION:g} s and {RINGING_DURATION:g} s with "
            f"{1e3 * values['last_amplitude']:.3g} mm"
            for name, values in json_document["ringing"].items()
        ),
        *json_document["notes"],
    ]


def _parse_joint_values(
    joint_value_words: Sequence[str], option_name: str, value_name: str
) -> dict[str, str]:
    """Parse JOINT=VALUE words into {joint: text}. Raises ValueError for a wrong word or a repeated joint."""
    pairs: dict[str, str] = {}
    for word in joint_value_words:
        joint, sign, text = word.partition("=")
        if not (joint and sign and text):
            raise ValueError(f"{option_name} {word!r}: expected JOINT={value_name}")
        if joint in pairs:
            raise ValueError(f"{option_name}: {joint} is given twice; state it once")
        pairs[joint] = text
    return pairs
