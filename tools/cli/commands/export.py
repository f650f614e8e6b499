"""`jointfmu export`: write a joint for finite-element solvers, robot simulators, Modelica tables or CSV."""

import argparse
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jointfmu.files.outputs import EXPORTED_TEXT_FILE
from jointfmu.files.writing import write_text
from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile, load_default, load_parameter_file

from ...common.judgement import Plausibility, assess_law_stiffness, find_rms_height
from ...common.options import format_option_flag, require_package
from ...common.pressure import find_nominal_pressure_model, judge_joint_stiffness, warn_missing_members
from ...exchange.export import exports
from ...exchange.export.exports import (
    CONTENTS_BY_FORMAT,
    DEFAULT_MAX_LOAD_ERROR,
    EXPORT_CONTENTS,
    INTERFACE_FORMATS,
    ROBOT_FORMATS,
    STIFFNESS_FORMATS,
)
from ...exchange.export.target_model import AXIS_ORDER, SI_UNIT_SET, UNIT_SETS, TargetModel
from ..command import CommandResult, SubParsers, declare_argument, declare_command, parse_joint_name
from ..outputs import declare_output

if TYPE_CHECKING:
    from ...exchange.export.writing import ExportedFile

_DEFAULT_NODE_POSITION = (0.0, 0.0, 0.0)
"""Default position of a node of a complete joint: the centroid of the contact."""
_FORMATS_WITH_ELEMENT_NUMBERS = {"first": ("ansys", "calculix", "abaqus"), "first_set": ("ansys",)}
"""{argument: formats that need this first number together with --nodes}."""
_FIRST_FREE_NUMBER_MEANINGS = {
    "first": "a number above all elements of your model",
    "first_set": "a number above all element types and sets of real constants of your model",
}
"""Meanings for error messages: {argument for a first free number: meaning}."""
_PRINTED_QUANTITY_UNITS = {"K_r": "N.m/rad", "K_": "N/m", "C_": "N.s/m"}
"""{first letters of a printed quantity: its SI unit}."""


def add_command(command_parsers: SubParsers) -> None:
    """Declare the command `jointfmu export` with its options."""
    export = declare_command(
        command_parsers,
        "export",
        _run_export,
        "write a joint for a finite-element solver, Modelica, a robot simulator, or as CSV",
    )
    with_springs = exports.find_joints_with_export("springs")
    forms = [*CONTENTS_BY_FORMAT, *ROBOT_FORMATS]
    export.add_argument(
        "form", choices=forms, metavar="FORMAT", help=f"program or format to write for: {', '.join(forms)}"
    )
    export.add_argument(
        "what",
        metavar="WHAT",
        help=f"springs: stiffness of the {', '.join(KINDS[joint].title for joint in with_springs)}, as a "
        "matrix between two nodes; with rigid sides or --interface as springs and dashpots between node "
        "pairs. contact: table of pressure over overclosure. curve: table of load over displacement of the "
        f"complete joint. For {', '.join(ROBOT_FORMATS)}, WHAT is the parameter file of a drive or its name "
        "in the catalogue",
    )
    joint = export.add_mutually_exclusive_group()
    declare_argument(joint, "--params", Path, "parameter file of the joint (TOML), in place of --joint")
    joint.add_argument(
        "--joint",
        type=parse_joint_name,
        choices=list(KINDS),
        default=with_springs[0],
        help=f"joint to write with its default parameters (default: {with_springs[0]})",
    )
    complete = {
        name
        for joint in exports.find_joints_with_export("stiffness")
        for name in exports.load_joint_exports(joint).working_point
    }
    for name, texts in _working_point_meanings().items():
        if name in complete:
            needed = [] if "(default" in texts[0] else ["needed for springs with rigid sides"]
            texts = [*texts, *needed, "with elastic sides, the default is the start value of --params"]
        text = "; ".join(texts)
        declare_argument(export, format_option_flag(name), float, text)
    text = "springs: write the interface alone, between node pairs, for your own model of plates and bolts"
    export.add_argument("--interface", action="store_true", default=None, help=text)
    for side in (1, 2):
        text = (
            f"springs of the complete joint: position of the node of side {side} relative to the centroid "
            "of the contact, in the axes of your model and the length unit of --units (default: 0 0 0)"
        )
        export.add_argument(f"--node-{side}", type=float, nargs=3, metavar=("X", "Y", "Z"), help=text)
    text = (
        "springs: table of your node pairs, columns node_1 [1], node_2 [1], x [mm], y [mm], area [mm2]; a "
        "column pressure [MPa] replaces --preload, --moment and --temperature"
    )
    declare_argument(export, "--nodes", Path, text, "CSV")
    declare_argument(
        export,
        "--first",
        int,
        "springs: number of the first element and node that are written; choose it above those of your "
        "model (default: 1)",
    )
    text = (
        "ansys: number of the first element type and real constant that are written; choose it above those "
        "of your model (default: 1)"
    )
    declare_argument(export, "--first-set", int, text)
    text = "springs: axis of your model that is normal to the contact (default: z)"
    export.add_argument("--normal", choices=list(AXIS_ORDER), help=text)
    text = f"units of the written file: length-force-stress-mass (default: {SI_UNIT_SET.unit_set_name})"
    export.add_argument("--units", choices=list(UNIT_SETS), default=SI_UNIT_SET.unit_set_name, help=text)
    text = (
        "contact, curve: largest relative error of linear interpolation in the table (default: "
        f"{DEFAULT_MAX_LOAD_ERROR:g}; contact for calculix: larger, if 200 rows do not suffice for it)"
    )
    declare_argument(export, "--error", float, text, "E")
    text = (
        f"{', '.join(ROBOT_FORMATS)}: largest torque [N.m] up to which the written spring is fitted to the "
        "drive (default: rated torque)"
    )
    declare_argument(export, "--torque", float, text, "T")
    declare_output(export, "--out", EXPORTED_TEXT_FILE, "file to write", required=True)


def _working_point_meanings() -> dict[str, list[str]]:
    """Quantities of a working point (load, temperature): {name: [meaning for each joint that has it]}."""
    texts: dict[str, list[str]] = {}
    for joint, kind in KINDS.items():
        for name, text in exports.load_joint_exports(joint).working_point.items():
            texts.setdefault(name, []).append(f"{kind.title}: {text}")
    return texts


def _run_export(args: argparse.Namespace) -> CommandResult:
    """Run `jointfmu export`: write the file of a joint in another program's format."""
    if args.form in ROBOT_FORMATS:
        return _export_drive(args)
    if args.what not in EXPORT_CONTENTS:
        choices = ", ".join(map(repr, EXPORT_CONTENTS))
        raise ValueError(f"argument WHAT: invalid choice: {args.what!r} (choose from {choices})")
    _refuse_unused_options(args, {"torque": f"{args.form}; it is for {', '.join(ROBOT_FORMATS)}"})
    if args.what not in CONTENTS_BY_FORMAT[args.form]:
        raise ValueError(
            f"{args.form} {args.what} cannot be written; {args.form} has "
            f"{', '.join(CONTENTS_BY_FORMAT[args.form])}"
        )
    file = load_parameter_file(args.params) if args.params else load_default(args.joint)
    _check_options(args, file)
    written = _create_export(args, file)
    write_text(args.out, written.file_text)
    facts = {"written": str(args.out), "format": args.form, "what": args.what, "units": args.units}
    lines = [f"wrote {args.out}: {args.what} for {args.form}, {args.units}"]
    for name, value in written.printed_quantities.items():
        number = f"{value:.6g}" if isinstance(value, float) else value
        lines.append(f"  {name:<24}  {number} {_unit_of_printed_quantity(name)}".rstrip())
    is_complete = args.interface or _exports_complete_joint(args, file)
    missing = [] if is_complete else warn_missing_members(file)
    stiffness_judgement = _judge_export(args, file).prepend_warnings([*written.warnings, *missing])
    return CommandResult(
        json_document={**facts, **written.printed_quantities},
        output_lines=lines,
        stiffness_judgement=stiffness_judgement,
    )


def _unit_of_printed_quantity(quantity_name: str) -> str:
    """SI unit of a printed quantity; empty for a number without unit."""
    return next(
        (unit for start, unit in _PRINTED_QUANTITY_UNITS.items() if quantity_name.startswith(start)), ""
    )


def _exports_complete_joint(args: argparse.Namespace, parameter_file: ParameterFile) -> bool:
    """Whether to export the stiffness matrix of the complete joint, instead of springs of the interface."""
    has_members = getattr(parameter_file.values, "has_elastic_members", False)
    return (
        args.what == "springs"
        and args.form in STIFFNESS_FORMATS
        and not args.interface
        and (has_members or args.form not in INTERFACE_FORMATS)
    )


def _export_drive(args: argparse.Namespace) -> CommandResult:
    """Write a drive for a robot simulator; the output lists effects that the format cannot represent."""
    idle = (
        "params",
        "nodes",
        "first",
        "first_set",
        "normal",
        "error",
        "interface",
        "node_1",
        "node_2",
        *_working_point_meanings(),
    )
    _refuse_unused_options(args, dict.fromkeys(idle, args.form))
    if args.units != SI_UNIT_SET.unit_set_name:
        raise ValueError(
            f"--units = {args.units}: {args.form} is always in {SI_UNIT_SET.unit_set_name}; leave --units out"
        )
    from ...api import load
    from ...exchange.robots.writing import format_drive
    from ...joints.harmonic_drive.transmission import make_transmission

    with require_package("measure the file", "mujoco"):
        text, lines, facts = format_drive(args.form, make_transmission(load(args.what).file), args.torque)
    write_text(args.out, text)
    return CommandResult(
        json_document={"written": str(args.out), "format": args.form, **facts},
        output_lines=[
            f"wrote {args.out}: {facts['drive']} for {args.form}",
            *(f"  {line}" for line in lines),
        ],
    )


def _judge_export(args: argparse.Namespace, parameter_file: ParameterFile) -> Plausibility:
    """Assess whether the stiffness is plausible at the load or the pressures of the options, or a default."""
    nominal = find_nominal_pressure_model(KINDS[parameter_file.joint])
    load = getattr(args, nominal.load_variable, None) if nominal else None
    if load is None and args.nodes:
        from ...exchange.export.mesh import read_node_pairs

        mesh = read_node_pairs(args.nodes)
        if mesh.contact_pressure is not None:
            mean = float(mesh.contact_pressure @ mesh.contact_area / mesh.contact_area.sum())
            return assess_law_stiffness(
                KINDS[parameter_file.joint].extract_law(parameter_file.values),
                [mean],
                find_rms_height(parameter_file),
                float(mesh.contact_pressure.max()),
            )
    return judge_joint_stiffness(parameter_file, None if load is None else [load])


def _create_export(args: argparse.Namespace, parameter_file: ParameterFile) -> "ExportedFile":
    """Create the exported file (springs, stiffness, contact law or load curve) from the options."""
    import numpy as np

    from ...exchange.export import writing
    from ...exchange.export.mesh import read_node_pairs

    units = UNIT_SETS[args.units]
    error = DEFAULT_MAX_LOAD_ERROR if args.error is None else args.error
    if args.what == "contact":
        return writing.export_contact(args.form, parameter_file, units, args.error)
    state = _read_working_point(args, parameter_file.joint)
    if args.what == "curve":
        return writing.export_curve(args.form, parameter_file, state, units, error)
    if _exports_complete_joint(args, parameter_file):
        if state is None:
            available = exports.load_joint_exports(parameter_file.joint)
            assert available.working_point_class is not None
            values = {name: parameter_file.start_value(name) for name in available.working_point}
            state = available.working_point_class(**values)
        for name in ("node_1", "node_2"):
            if not np.all(np.isfinite(getattr(args, name) or _DEFAULT_NODE_POSITION)):
                raise ValueError(
                    f"{format_option_flag(name)} = {getattr(args, name)}: expected three finite numbers"
                )
        nodes = np.array([args.node_1 or _DEFAULT_NODE_POSITION, args.node_2 or _DEFAULT_NODE_POSITION])
        placing = TargetModel(units, args.normal or "z", args.first or 1, args.first_set or 1)
        return writing.export_stiffness(args.form, parameter_file, state, nodes, placing)
    mesh = read_node_pairs(args.nodes) if args.nodes else None
    first, text = next(iter(exports.load_joint_exports(parameter_file.joint).working_point.items()), ("", ""))
    if mesh is not None and mesh.contact_pressure is not None and state is not None:
        raise ValueError(
            f"{mesh.csv_path} states the pressures; leave out {format_option_flag(first)}, or its column "
            "'pressure'"
        )
    if (mesh is None or mesh.contact_pressure is None) and state is None and first:
        raise ValueError(
            f"springs need {format_option_flag(first)}, {text}, or --nodes with a column pressure"
        )
    placing = TargetModel(
        units, args.normal or "z", args.first or 1, args.first_set or 1, defines_nodes=mesh is None
    )
    return writing.export_springs(args.form, parameter_file, state, mesh, placing)


def _read_working_point(args: argparse.Namespace, joint_name: str) -> Any:
    """Read the working point of the joint from the options; None if no option states one."""
    available = exports.load_joint_exports(joint_name)
    values = {name: getattr(args, name) for name in available.working_point}
    if available.working_point_class is None or all(value is None for value in values.values()):
        return None
    return available.working_point_class(**{n: value for n, value in values.items() if value is not None})


def _refuse_unused_options(args: argparse.Namespace, unused_options: Mapping[str, str]) -> None:
    """Raise ValueError if the user sets an option that has no effect.

    unused_options : {option: format or content for which it has no meaning}
    """
    for name, what in unused_options.items():
        if getattr(args, name) is not None:
            raise ValueError(f"{format_option_flag(name)} has no effect for {what}")


def _check_working_point(args: argparse.Namespace, joint_name: str) -> None:
    """Raise ValueError if a working point is set but not used, or if a required one is missing."""
    used = {} if args.what == "contact" else exports.load_joint_exports(joint_name).working_point
    _refuse_unused_options(
        args,
        {
            name: f"the {args.what} of a {joint_name}"
            for name in _working_point_meanings()
            if name not in used
        },
    )
    stated = [name for name in used if getattr(args, name) is not None]
    first, text = next(iter(used.items()), ("", ""))
    if stated and first not in stated:
        raise ValueError(f"{format_option_flag(stated[0])} needs {format_option_flag(first)}, {text}")
    if args.what == "curve" and first and not stated:
        raise ValueError(f"the curve of a {joint_name} needs {format_option_flag(first)}, {text}")


def _check_options(args: argparse.Namespace, parameter_file: ParameterFile) -> None:
    """Check the options of `jointfmu export`.

    Raises ValueError if one has no effect, is missing or is out of range.
    """
    exports.require_export(parameter_file.joint, args.what)
    _check_working_point(args, parameter_file.joint)
    node_options = ("node_1", "node_2")
    if args.what != "springs":
        names = ("nodes", "first", "normal", "interface", *node_options)
        idle = dict.fromkeys(names, f"a {args.what}; it is for springs")
    elif _exports_complete_joint(args, parameter_file):
        idle = {"error": "springs; it is for contact and curve"}
        idle["nodes"] = "the stiffness matrix of a complete joint; --interface exports the interface alone"
        if args.form not in INTERFACE_FORMATS:
            idle["nodes"] = f"{args.form}; it is for {', '.join(INTERFACE_FORMATS)}"
    else:
        idle = {"error": "springs; it is for contact and curve"}
        idle |= dict.fromkeys(node_options, "springs of the interface; it is for a complete joint")
    if args.interface and args.form not in INTERFACE_FORMATS:
        idle["interface"] = f"{args.form}; it is for {', '.join(INTERFACE_FORMATS)}"
    if args.form != "ansys":
        idle["first_set"] = f"{args.form}; it is for ansys"
    _refuse_unused_options(args, idle)
    for name, highest in (("first", 10_000_000), ("first_set", 100_000)):
        value, option = getattr(args, name), format_option_flag(name)
        if value is not None and not 1 <= value <= highest:
            raise ValueError(f"{option} = {value} is outside [1, {highest}]")
        if value is None and args.nodes is not None and args.form in _FORMATS_WITH_ELEMENT_NUMBERS[name]:
            raise ValueError(f"--nodes needs {option}, {_FIRST_FREE_NUMBER_MEANINGS[name]}")
    if args.form == "modelica" and args.units != SI_UNIT_SET.unit_set_name:
        raise ValueError(
            f"--units = {args.units}: a Modelica table is always in {SI_UNIT_SET.unit_set_name}; leave "
            "--units out"
        )
