"""`jointfmu footprint`: pressure field of a bolted joint, imported from a file or computed."""

import argparse
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jointfmu.files.outputs import PARAMETER_FILE, PICTURE_FILE, write_parameter_text
from jointfmu.joints import KINDS
from jointfmu.joints.bolted_joint.joint import BoltedJointSpring
from jointfmu.parameters import ParameterFile, format_parameter_file

from ....common.judgement import assess_law_stiffness, find_rms_height
from ....common.pressure import warn_missing_members
from ....common.shown import derived_values_to_json, format_derived_values
from ....joints.bolted_joint.field import compute_complete_joint_results, insert_elastic_bodies
from ...command import CommandResult, Parser, SubParsers, declare_argument, declare_command, format_sentence
from ...outputs import declare_output
from . import bodies, compute, load_joint_file

if TYPE_CHECKING:
    from ....inputs.fields.nodal_result import ContactPressureField
    from ....inputs.fields.reduction import FieldReduction


def add_footprint_command(command_parsers: SubParsers) -> None:
    """Declare the command `jointfmu footprint` with its sub-commands."""
    text = "import or compute the contact pressure of a bolted joint"
    top = command_parsers.add_parser("footprint", help=text, description=format_sentence(text))
    steps = top.add_subparsers(dest="step", required=True, metavar="STEP", parser_class=Parser)
    _declare_import(steps)
    compute.add_command(steps)


OPTION_NAME_BY_ARGUMENT = {"length": "length_unit", "pressure": "pressure_unit", "beside": "with"}
"""{name of an argument in the library: name of its option}, where the names differ."""


def _declare_import(subcommand_parsers: SubParsers) -> None:
    """Declare the sub-command `import` with its options."""
    text = "import a nodal contact result into the parameter file of a joint"
    step = declare_command(subcommand_parsers, "import", _run_import, text)
    declare_argument(
        step,
        "file",
        Path,
        "contact pressure at nodes: CSV, CalculiX .frd, ANSYS or Abaqus listing, or a mesh such as .vtu",
    )
    declare_argument(
        step,
        "--preload",
        float,
        "force of each bolt in the contact result [N]: the preload that remains after embedding",
        "F",
        required=True,
    )
    declare_argument(
        step,
        "--params",
        Path,
        "parameter file of a bolted joint to start from (default: box specimen of Zhao 2018)",
    )
    declare_output(
        step, "--out", PARAMETER_FILE, "write a parameter file of the joint with the imported pressure (TOML)"
    )
    declare_output(step, "--plot", PICTURE_FILE, "draw the contact pressure (.png, .svg)")
    text = "format of the file: csv, mesh, ansys, abaqus or frd (default: by the file name)"
    declare_argument(step, "--format", str, text, "FORMAT")
    text = "length unit of the file: m, mm, um; CSV files state it in the heading"
    declare_argument(step, "--length-unit", str, text, "UNIT")
    declare_argument(
        step,
        "--pressure-unit",
        str,
        "pressure unit of the file: Pa, kPa, MPa, GPa; CSV files state it in the heading",
        "UNIT",
    )
    declare_argument(
        step, "--data", str, "mesh: name of the point data with the pressure, NAME or NAME:COMPONENT"
    )
    declare_argument(
        step, "--normal", str, "axis of the file normal to the contact: x, y or z", "AXIS", default="z"
    )
    declare_argument(
        step,
        "--rows",
        str,
        "axis of the file along the bolt rows (default: x for normal z, y for x, z for y)",
        "AXIS",
    )
    text = "body to read if both have contact pressure: below or above the contact, along the normal"
    declare_argument(step, "--side", str, text, "SIDE")
    declare_argument(
        step,
        "--open",
        str,
        "what to do with nodes without pressure: keep (gap of zero), drop (never in contact) or refuse",
        "WHAT",
        default="refuse",
    )
    text = "files that belong to a listing: more listings, or its mesh (ANSYS archive .cdb, Abaqus deck .inp)"
    step.add_argument("--with", dest="beside", nargs="+", type=Path, default=[], metavar="FILE", help=text)
    text = (
        "largest allowed difference of contact force and bolt force, divided by the bolt force [1]; the "
        "pressures are scaled to the bolt force (default: 0.01)"
    )
    declare_argument(step, "--force-tolerance", float, text, "P")
    declare_argument(
        step, "--moment", float, "bending moment about x in the result of --moment-file [N.m]", "M"
    )
    declare_argument(
        step,
        "--moment-file",
        Path,
        "contact result at the same nodes, under the preload and the moment of --moment",
    )
    bodies.declare_body_arguments(step)
    step.set_defaults(options=OPTION_NAME_BY_ARGUMENT)


def _run_import(args: argparse.Namespace) -> CommandResult:
    """Run `jointfmu footprint import`: read a contact result, reduce it, write the parameter file."""
    if (args.moment is None) != (args.moment_file is None):
        raise ValueError("--moment and --moment-file belong together; state both or neither")
    from ....inputs.fields import joint_parameters
    from ....inputs.fields.joint_parameters import FIELD_FORCE_TOLERANCE, insert_pressure_field

    start = load_joint_file(args.params)
    bodies.check_body_arguments(args, start)
    field, tilted = _create_field_reader(args).read_field(args.file, args.moment_file)
    source = f"nodal contact result {args.file.name}"
    if args.moment_file:
        source += f" and {args.moment_file.name}"
    at = bodies.find_bolt_positions(args, start, field)
    plates, notes = bodies.build_assembly(args, start, field, at) if args.thickness else (None, [])
    file, reduction = insert_pressure_field(
        start,
        field,
        args.preload,
        source,
        moment_field=tilted,
        bending_moment=args.moment,
        bolt_positions=at,
        force_tolerance=FIELD_FORCE_TOLERANCE if args.force_tolerance is None else args.force_tolerance,
    )
    file = replace(file, name=f"{start.name}, field of {args.file.name}")
    whole, preload = {}, compute.tightening_force(args, file)
    if plates:
        file = insert_elastic_bodies(
            file, plates, preload, args.attached or "faces", reduction.full_distribution
        )
        whole = compute_complete_joint_results(file, preload)
    if args.plot:
        joint_parameters.draw_pressure_field(field, reduction, args.plot)
    if args.out:
        write_parameter_text(args.out, format_parameter_file(file))
    facts = _results_to_json(args, file, field, reduction)
    judgement = assess_law_stiffness(
        KINDS[file.joint].extract_law(file.values), [facts["p_mean"]], find_rms_height(file), facts["p_max"]
    )
    facts |= {"outline": notes[0]} if notes else {}
    missing = [] if plates else warn_missing_members(start, "add them with --thickness T1 T2")
    judgement = judgement.prepend_warnings([*notes[1:], *missing])
    scaling = facts["force_of_the_bolts"] / field.normal_force - 1.0
    if abs(scaling) > FIELD_FORCE_TOLERANCE:
        text = f"the pressures are scaled by {100.0 * scaling:+.2g} % to the force of the bolts"
        judgement = judgement.prepend_warnings(
            [f"{text}: compare with the contact force of your finite-element run to see which is wrong"]
        )
    lines = [
        *_format_results(facts, start.values.A_0),
        *compute.describe_fmu_preload(args, file),
        *(format_derived_values(whole) if whole else [_format_rigid_stiffness(file, preload)]),
    ]
    lines += [f"wrote {path}" for path in facts["written"]]
    facts |= {"whole": derived_values_to_json(whole)} if whole else {}
    return CommandResult(json_document=facts, output_lines=lines, stiffness_judgement=judgement)


def _create_field_reader(args: argparse.Namespace) -> Any:
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
        open_node_treatment=args.open,
    )


def _results_to_json(
    args: argparse.Namespace,
    parameter_file: ParameterFile,
    contact_field: "ContactPressureField",
    field_reduction: "FieldReduction",
) -> dict[str, Any]:
    """Collect the results of the imported pressure field in a JSON object."""
    joint = parameter_file.values
    return {
        "file": str(args.file),
        "nodes": field_reduction.node_count,
        "A_0": joint.A_0,
        "force": contact_field.normal_force,
        "force_of_the_bolts": args.preload * joint.n_bolts,
        "p_max": float(contact_field.nodal_pressure.max()),
        "p_mean": contact_field.normal_force / joint.A_0,
        "open_nodes": int((contact_field.nodal_pressure == 0.0).sum()),
        "points": field_reduction.point_count,
        "deviation": field_reduction.largest_deviation,
        "loads": field_reduction.test_case_count,
        "largest_moment": field_reduction.max_tested_over_unloading_moment
        * args.preload
        * joint.row_distance
        * joint.row_bolts,
        "deviation_beyond": field_reduction.deviation_above_tested_moments,
        "written": [str(path) for path in (args.out, args.plot) if path],
    }


def _format_rigid_stiffness(parameter_file: ParameterFile, preload: float) -> str:
    """Format the stiffness of interface and bolts between rigid plates, at a preload [N] at tightening."""
    still = (0.0, 0.0, 0.0)
    outputs = BoltedJointSpring.from_joint(parameter_file.values).evaluate(preload, 0.0, still, still)
    numbers = ", ".join(f"{name} = {outputs[name]:.4g} N/m" for name in ("K_xx", "K_yy", "K_zz"))
    return f"interface and bolts between rigid plates: {numbers}; --thickness T1 T2 adds the plates"


def _format_results(json_document: dict[str, Any], old_contact_area: float) -> list[str]:
    """Format the results of the imported pressure field as lines of text."""
    from ....inputs.fields.sums import PRELOAD_OVER_FIELD_PRELOAD_RANGE

    low, high = PRELOAD_OVER_FIELD_PRELOAD_RANGE
    difference = 100.0 * (json_document["force"] / json_document["force_of_the_bolts"] - 1.0)
    lines = [
        f"{json_document['nodes']} nodes ({json_document['open_nodes']} open), pressure up to "
        f"{json_document['p_max'] / 1e6:.4g} MPa, mean {json_document['p_mean'] / 1e6:.4g} MPa",
        f"force {json_document['force']:.6g} N, {difference:+.2g} % from the bolt force, "
        f"{json_document['force_of_the_bolts']:.6g} N; the field is scaled to the bolt force",
        f"A_0 is the nodes' area, {json_document['A_0']:.6g} m2 (it was {old_contact_area:.6g} m2)",
    ]
    if json_document["loads"]:
        lines.append(
            f"{json_document['points']} points represent the nodes: force, K_zz, K_xx, K_rx, K_ry within "
            f"{json_document['deviation']:.1e} at {json_document['loads']} other loads (preload {low:g} to "
            f"{high:g} times this one, in compression to fully open, moment up to "
            f"{json_document['largest_moment']:.4g} N.m at this preload)"
        )
    else:
        lines.append("all nodes are kept")
    if json_document["deviation_beyond"]:
        lines.append(
            f"larger moments open nodes: within {json_document['deviation_beyond']:.1e}, up to the moment "
            "that unloads a row of bolts"
        )
    if "outline" in json_document:
        lines.append(json_document["outline"])
    return lines
