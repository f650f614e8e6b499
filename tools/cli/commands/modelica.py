"""`jointfmu modelica`: write the Modelica library from parameters."""

import argparse
from pathlib import Path

from jointfmu.files.outputs import OUTPUT_FOLDER
from jointfmu.joints import KINDS
from jointfmu.joints.kind import JointKind
from jointfmu.parameters import ParameterFile, load_parameter_file

from ...common.judgement import Plausibility
from ...common.options import format_option_flag, require_package
from ...common.pressure import judge_joint_stiffness, warn_missing_members
from ..command import CommandResult, SubParsers, declare_argument, declare_command
from ..outputs import declare_output


def add_command(command_parsers: SubParsers) -> None:
    """Declare the command `jointfmu modelica` with its options."""
    make = declare_command(
        command_parsers,
        "modelica",
        _run_modelica,
        "write the Modelica library JointStiffness with all joints",
    )
    declare_argument(
        make, "--params", Path, "parameter file of one joint, in place of its default parameters (TOML)"
    )
    for name, kinds in _working_point_inputs().items():
        first = any(name == kind.working_point[0] for kind in kinds)
        text = "; ".join(f"{kind.title}: {_describe_working_point_input(kind, name)}" for kind in kinds)
        text += (
            ", one record of the joint for each value (default: that of --params, and 9000 and 15000)"
            if first
            else f" (default: {kinds[0].variables[name].start:g})"
        )
        declare_argument(make, format_option_flag(name), float, text, nargs="+" if first else None)
    declare_output(make, "--out", OUTPUT_FOLDER, "folder to write", default=Path("dist"))


def _run_modelica(args: argparse.Namespace) -> CommandResult:
    """Run `jointfmu modelica`: write the Modelica library."""
    file = load_parameter_file(args.params) if args.params else None
    points = {kind.name: _read_working_points(kind, args) for kind in KINDS.values() if kind.working_point}
    with require_package("write the library"):
        from ...exchange.modelica import library

        written = library.write_library(args.out, file, points, overwrite=args.force)
    return CommandResult(
        json_document={"written": [str(path) for path in written]},
        output_lines=[f"wrote {args.out / library.LIBRARY_NAME}: {len(written)} files"],
        stiffness_judgement=_judge_working_point_stiffness(file, points) if file else None,
    )


def _judge_working_point_stiffness(
    parameter_file: ParameterFile, working_points: dict[str, list[tuple[float, ...]]]
) -> Plausibility:
    """Assess whether the stiffness of the user's joint is plausible at the loads of its Modelica records."""
    judgement = judge_joint_stiffness(
        parameter_file, [point[0] for point in working_points.get(parameter_file.joint, [])] or None
    )
    return judgement.prepend_warnings(warn_missing_members(parameter_file))


def _working_point_inputs() -> dict[str, list[JointKind]]:
    """Inputs (load, temperature) whose values each Modelica record states: {input: joints that have it}."""
    names = dict.fromkeys(name for kind in KINDS.values() for name in kind.working_point)
    return {name: [kind for kind in KINDS.values() if name in kind.working_point] for name in names}


def _describe_working_point_input(joint_kind: JointKind, input_name: str) -> str:
    """Help text of the option for an input (load, temperature) whose value each Modelica record states."""
    variable = joint_kind.variables[input_name]
    meaning, *remarks = variable.doc.split(";")
    return ";".join([f"{meaning} [{variable.unit}]", *remarks])


def _read_working_points(joint_kind: JointKind, args: argparse.Namespace) -> list[tuple[float, ...]]:
    """Read the working points of a joint's records: one for each value of its first input (load).

    All records have the same values of the other inputs; an input that is not set has its start value. Raises
    ValueError if another input is set but not the first.
    """
    first, *others = joint_kind.working_point
    stated = {name: getattr(args, name) for name in others if getattr(args, name) is not None}
    values: list[float] = getattr(args, first) or []
    if stated and not values:
        needed = f"{format_option_flag(first)}, the {_describe_working_point_input(joint_kind, first)}"
        raise ValueError(f"{format_option_flag(next(iter(stated)))} needs {needed}")
    defaults = joint_kind.variables
    return [(value, *(stated.get(name, defaults[name].start) for name in others)) for value in values]
