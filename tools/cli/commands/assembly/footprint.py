"""`jointfmu footprint`: pressure field of a bolted joint, imported from a file or computed."""

import argparse
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jointfmu.files.outputs import PARAMETER_FILE, PICTURE_FILE, write_parameter_text
from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile, format_parameter_file

from ....common.judgement import assess_law_stiffness, find_rms_height
from ....common.pressure import warn_missing_members
from ....common.shown import facts_to_json, format_facts
from ....joints.bolted_joint.field import insert_elastic_bodies, joint_facts
from ...command import CommandResult, Parser, SubParsers, declare_argument, declare_command, format_sentence
from ...outputs import declare_output
from . import bodies, compute, load_joint_file

if TYPE_CHECKING:
    from ....inputs.fields.nodal_result import ContactField
    from ....inputs.fields.reduction import Reduction


def add_footprint_command(command_parsers: SubParsers) -> None:
    """Declare the command `jointfmu footprint` with its sub-commands."""
    text = "import or compute the contact pressure of a bolted joint"
    top = command_parsers.add_parser("footprint", help=text, description=format_sentence(text))
    steps = top.add_subparsers(dest="step", required=True, metavar="STEP", parser_class=Parser)
    _declare_import(steps)
    compute.add_command(steps)


OPTION_NAME_BY_ARGUMENT = {"length": "length_unit", "pressure": "pressure_unit", "beside": "with"}
"""{name of an argument in the library: name of its option}, where the names differ."""


def _declare_import(subcommands: SubParsers) -> None:
    """Declare the sub-command `import` with its options."""
    text = "import a nodal contact result into the parameter file of a joint"
    step = declare_command(subcommands, "import", _run_import, text)
    declare_argument(
        step, "file", Path, "contact result: CSV, CalculiX .frd, ANSYS or Abaqus listing, or a mesh"
    )
    declare_argument(
        step, "--preload", float, "preload of each bolt in the contact result [N]", "F", required=True
    )
    declare_argument(step, "--params", Path, "parameter file of the joint (default: Zhao 2018)")
    declare_output(
        step, "--out", PARAMETER_FILE, "write the parameter file of the joint with the field (TOML)"
    )
    declare_output(step, "--plot", PICTURE_FILE, "draw the field (.png, .svg)")
    text = "format of the file: csv, mesh, ansys, abaqus or frd (default: by the file name)"
    declare_argument(step, "--format", str, text, "FORMAT")
    text = "length unit of the file: m, mm, um; not needed for CSV, which states it"
    declare_argument(step, "--length-unit", str, text, "UNIT")
    declare_argument(step, "--pressure-unit", str, "pressure unit of the file: Pa, kPa, MPa, GPa", "UNIT")
    declare_argument(step, "--data", str, "mesh: point data with the pressure, NAME or NAME:COMPONENT")
    declare_argument(step, "--normal", str, "axis normal to the contact", "AXIS", default="z")
    declare_argument(
        step, "--rows", str, "axis along the bolt rows (default: the next axis, x for z)", "AXIS"
    )
    text = "side of the contact to read if both bodies have pressure: below or above"
    declare_argument(step, "--side", str, text, "SIDE")
    declare_argument(
        step,
        "--open",
        str,
        "nodes without pressure: keep (they just touch), drop (they never touch) or refuse",
        "WHAT",
        default="refuse",
    )
    text = "more listings, or the mesh of a listing: ANSYS archive .cdb, Abaqus deck .inp"
    step.add_argument("--with", dest="beside", nargs="+", type=Path, default=[], metavar="FILE", help=text)
    text = (
        "largest relative difference between contact force and bolt force; the pressures are scaled to the "
    )
    declare_argument(step, "--force-tolerance", float, text + "bolt force (default: 0.01)", "P")
    declare_argument(step, "--moment", float, "bending moment of --moment-file [N.m]", "M")
    declare_argument(
        step, "--moment-file", Path, "contact result of the same nodes under an additional moment"
    )
    bodies.declare_body_arguments(step)
    step.set_defaults(options=OPTION_NAME_BY_ARGUMENT)


def _run_import(args: argparse.Namespace) -> CommandResult:
    """Run `jointfmu footprint import`: read a contact result, reduce it, write the parameter file."""
    if (args.moment is None) != (args.moment_file is None):
        raise ValueError("--moment and --moment-file belong together; state both or neither")
    from ....inputs.fields import joint_parameters
    from ....inputs.fields.joint_parameters import FORCE_TOLERANCE, insert_field

    start = load_joint_file(args.params)
    bodies.check_body_arguments(args, start)
    field, tilted = _create_reader(args).read_field(args.file, args.moment_file)
    source = f"nodal contact result {args.file.name}"
    if args.moment_file:
        source += f" and {args.moment_file.name}"
    at = bodies.find_bolt_positions(args, start, field)
    plates, notes = bodies.build_assembly(args, start, field, at) if args.thickness else (None, [])
    file, reduction = insert_field(
        start,
        field,
        args.preload,
        source,
        moment_field=tilted,
        moment=args.moment,
        bolt_positions=at,
        force_tolerance=FORCE_TOLERANCE if args.force_tolerance is None else args.force_tolerance,
    )
    file = replace(file, name=f"{start.name}, field of {args.file.name}")
    whole = {}
    if plates:
        preload = compute.tightening_force(args, file)
        file = insert_elastic_bodies(
            file, plates, preload, args.attached or "faces", reduction.full_distribution
        )
        whole = joint_facts(file, preload)
    if args.plot:
        joint_parameters.draw_field(field, reduction, args.plot)
    if args.out:
        write_parameter_text(args.out, format_parameter_file(file))
    facts = _collect_results(args, file, field, reduction)
    judgement = assess_law_stiffness(
        KINDS[file.joint].extract_law(file.values), [facts["p_mean"]], find_rms_height(file), facts["p_max"]
    )
    facts |= {"outline": notes[0]} if notes else {}
    judgement = judgement.with_warnings([*notes[1:], *([] if plates else warn_missing_members(start))])
    scaling = facts["force_of_the_bolts"] / field.force - 1.0
    if abs(scaling) > FORCE_TOLERANCE:
        text = f"the pressures are scaled by {100.0 * scaling:+.2g} % to the force of the bolts"
        judgement = judgement.with_warnings(
            [f"{text}: compare with the contact force of your finite-element run to see which is wrong"]
        )
    lines = [*_format_results(facts, start.values.A_0), *format_facts(whole)]
    lines += [f"wrote {path}" for path in facts["written"]]
    facts |= {"whole": facts_to_json(whole)} if whole else {}
    return CommandResult(json_document=facts, lines=lines, stiffness_judgement=judgement)


def _create_reader(args: argparse.Namespace) -> Any:
    """Build the reader of the contact result. Raises ValueError for a choice that does not exist."""
    from ....inputs.fields.contact_surface import AXIS_NAMES, BODY_SIDES, OPEN_NODE_OPTIONS, ContactPlane
    from ....inputs.fields.nodal_result import LENGTH_UNITS, PRESSURE_UNITS
    from ....inputs.fields.reading import FIELD_FORMATS, FieldReader

    for name, value, allowed in (
        ("--format", args.format, FIELD_FORMATS),
        ("--length-unit", args.length_unit, tuple(LENGTH_UNITS)),
        ("--pressure-unit", args.pressure_unit, tuple(PRESSURE_UNITS)),
        ("--normal", args.normal, tuple(AXIS_NAMES)),
        ("--rows", args.rows, tuple(AXIS_NAMES)),
        ("--side", args.side, BODY_SIDES),
        ("--open", args.open, OPEN_NODE_OPTIONS),
    ):
        if value is not None and value not in allowed:
            raise ValueError(f"{name} = {value!r} is not one of {', '.join(allowed)}")
    return FieldReader(
        file_format=args.format,
        length_unit=args.length_unit,
        pressure_unit=args.pressure_unit,
        point_data_name=args.data,
        companion_files=args.beside,
        contact_plane=ContactPlane(args.normal, args.rows, args.side),
        open_nodes=args.open,
    )


def _collect_results(
    args: argparse.Namespace, parameter_file: ParameterFile, field: "ContactField", reduction: "Reduction"
) -> dict[str, Any]:
    """Collect the results of the imported pressure field in a JSON object."""
    joint = parameter_file.values
    return {
        "file": str(args.file),
        "nodes": reduction.node_count,
        "A_0": joint.A_0,
        "force": field.force,
        "force_of_the_bolts": args.preload * joint.n_bolts,
        "p_max": float(field.pressure.max()),
        "p_mean": field.force / joint.A_0,
        "open_nodes": int((field.pressure == 0.0).sum()),
        "points": reduction.point_count,
        "deviation": reduction.largest_deviation,
        "loads": reduction.test_case_count,
        "largest_moment": reduction.max_tested_moment_ratio
        * args.preload
        * joint.row_distance
        * joint.row_bolts,
        "deviation_beyond": reduction.deviation_above_tested_moments,
        "written": [str(path) for path in (args.out, args.plot) if path],
    }


def _format_results(result_values: dict[str, Any], old_contact_area: float) -> list[str]:
    """Format the results of the imported pressure field as lines of text."""
    from ....inputs.fields.sums import CASE_OVER_FIELD_PRELOAD_RANGE

    low, high = CASE_OVER_FIELD_PRELOAD_RANGE
    difference = 100.0 * (result_values["force"] / result_values["force_of_the_bolts"] - 1.0)
    lines = [
        f"{result_values['nodes']} nodes ({result_values['open_nodes']} open), pressure up to "
        f"{result_values['p_max'] / 1e6:.4g} MPa, mean {result_values['p_mean'] / 1e6:.4g} MPa",
        f"force {result_values['force']:.6g} N, {difference:+.2g} % from the bolt force, "
        f"{result_values['force_of_the_bolts']:.6g} N; the field is scaled to the bolt force",
        f"A_0 is the nodes' area, {result_values['A_0']:.6g} m2 (it was {old_contact_area:.6g} m2)",
    ]
    if result_values["loads"]:
        lines.append(
            f"{result_values['points']} points represent them: force, K_zz, K_xx, K_rx, K_ry within "
            f"{result_values['deviation']:.1e} at {result_values['loads']} other loads (preload {low:g} to "
            f"{high:g} times this one, pressed to fully open, moment up to "
            f"{result_values['largest_moment']:.4g} N.m at this one)"
        )
    else:
        lines.append("all nodes are kept")
    if result_values["deviation_beyond"]:
        lines.append(
            f"larger moments open nodes: within {result_values['deviation_beyond']:.1e} until a row is "
            "unloaded"
        )
    if "outline" in result_values:
        lines.append(result_values["outline"])
    return lines
