"""`jointfmu footprint`: pressure field of a bolted joint, imported from a file or computed."""

import argparse
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jointfmu.files.outputs import PARAMETERS, PICTURE, write_parameter_text
from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile, dump

from ...command_line.common import Answer, Commands, Parser, argument, command, sentence
from ...command_line.outputs import output
from ...fields.clamped import clamping
from ...judgement import judge, known_height
from ...pressure import without_members
from ...shown import fact_document, fact_lines
from . import bodies, compute, joint_file

if TYPE_CHECKING:
    from ...fields.nodal_result import ContactField
    from ...fields.reduction import Reduction


def add_footprint(commands: Commands) -> None:
    """Declare the command `jointfmu footprint` with its sub-commands."""
    text = "import or compute the contact pressure of a bolted joint"
    top = commands.add_parser("footprint", help=text, description=sentence(text))
    steps = top.add_subparsers(dest="step", required=True, metavar="STEP", parser_class=Parser)
    _import(steps)
    compute.add(steps)


OPTIONS = {"length": "length_unit", "pressure": "pressure_unit", "beside": "with"}
"""{name of an argument in the library: name of its option}, where the names differ."""


def _import(steps: Commands) -> None:
    text = "import a nodal contact result into the parameter file of a joint"
    step = command(steps, "import", _run_import, text)
    argument(step, "file", Path, "contact result: CSV, CalculiX .frd, ANSYS or Abaqus listing, or a mesh")
    argument(step, "--preload", float, "force of each bolt in the contact result [N]", "F", required=True)
    argument(step, "--params", Path, "parameter file of the joint (default: Zhao 2018)")
    output(step, "--out", PARAMETERS, "write the parameter file of the joint with the field (TOML)")
    output(step, "--plot", PICTURE, "draw the field (.png, .svg)")
    text = "format of the file: csv, mesh, ansys, abaqus or frd (default: by the file name)"
    argument(step, "--format", str, text, "FORMAT")
    text = "length unit of the file: m, mm, um; not needed for CSV, which states it"
    argument(step, "--length-unit", str, text, "UNIT")
    argument(step, "--pressure-unit", str, "pressure unit of the file: Pa, kPa, MPa, GPa", "UNIT")
    argument(step, "--data", str, "mesh: point data with the pressure, NAME or NAME:COMPONENT")
    argument(step, "--normal", str, "axis normal to the contact", "AXIS", default="z")
    argument(step, "--rows", str, "axis along the bolt rows (default: the next axis, x for z)", "AXIS")
    text = "side of the contact to read if both bodies have pressure: below or above"
    argument(step, "--side", str, text, "SIDE")
    argument(step, "--open", str, "nodes without pressure: keep, drop or refuse", "WHAT", default="refuse")
    text = "more listings, or the mesh of a listing: ANSYS archive .cdb, Abaqus deck .inp"
    step.add_argument("--with", dest="beside", nargs="+", type=Path, default=[], metavar="FILE", help=text)
    text = (
        "largest relative difference between contact force and bolt force; the pressures are scaled to the "
    )
    argument(step, "--force-tolerance", float, text + "bolt force (default: 0.01)", "P")
    argument(step, "--moment", float, "bending moment of --moment-file [N.m]", "M")
    argument(step, "--moment-file", Path, "contact result of the same nodes under an additional moment")
    bodies.arguments(step)
    step.set_defaults(options=OPTIONS)


def _run_import(args: argparse.Namespace) -> Answer:
    if (args.moment is None) != (args.moment_file is None):
        raise ValueError("--moment and --moment-file belong together: expected both or none")
    from ...fields import joint_parameters
    from ...fields.joint_parameters import FORCE_ERROR, with_field

    start = joint_file(args.params)
    bodies.check(args, start)
    field, tilted = _reading(args).field(args.file, args.moment_file)
    source = f"nodal contact result {args.file.name}"
    if args.moment_file:
        source += f" and {args.moment_file.name}"
    at = bodies.places(args, start, field)
    plates, notes = bodies.assembly(args, start, field, at) if args.thickness else (None, [])
    file, reduction = with_field(
        start,
        field,
        args.preload,
        source,
        tilted=tilted,
        moment=args.moment,
        bolts=at,
        tolerance=FORCE_ERROR if args.force_tolerance is None else args.force_tolerance,
    )
    file = replace(file, name=f"{start.name}, field of {args.file.name}")
    whole = {}
    if plates:
        preload, joint = compute.tightening(args, file), clamping(file.joint)
        file = joint.whole(file, plates, preload, args.attached or "faces", reduction.field)
        whole = joint.facts(file, preload)
    if args.plot:
        joint_parameters.draw(field, reduction, args.plot)
    if args.out:
        write_parameter_text(args.out, dump(file))
    facts = _findings(args, file, field, reduction)
    judgement = judge(
        KINDS[file.joint].law_of(file.values), [facts["p_mean"]], known_height(file), facts["p_max"]
    )
    facts |= {"outline": notes[0]} if notes else {}
    judgement = judgement.with_warnings([*notes[1:], *([] if plates else without_members(start))])
    scaling = facts["force_of_the_bolts"] / field.force - 1.0
    if abs(scaling) > FORCE_ERROR:
        text = f"the pressures are scaled by {100.0 * scaling:+.2g} % to the force of the bolts"
        judgement = judgement.with_warnings(
            [f"{text}: compare with the contact force of your finite-element run to see which is wrong"]
        )
    lines = [*_lines(facts, start.values.A_0), *fact_lines(whole)]
    lines += [f"wrote {path}" for path in facts["written"]]
    facts |= {"whole": fact_document(whole)} if whole else {}
    return Answer(document=facts, lines=lines, judgement=judgement)


def _reading(args: argparse.Namespace) -> Any:
    """Build the reader of the contact result. Raises ValueError for a choice that does not exist."""
    from ...fields.contact_surface import AXES, OPEN, SIDES, Plane
    from ...fields.nodal_result import LENGTHS, PRESSURES
    from ...fields.reading import FORMATS, Reading

    for name, value, allowed in (
        ("--format", args.format, FORMATS),
        ("--length-unit", args.length_unit, tuple(LENGTHS)),
        ("--pressure-unit", args.pressure_unit, tuple(PRESSURES)),
        ("--normal", args.normal, tuple(AXES)),
        ("--rows", args.rows, tuple(AXES)),
        ("--side", args.side, SIDES),
        ("--open", args.open, OPEN),
    ):
        if value is not None and value not in allowed:
            raise ValueError(f"{name} = {value!r} is not one of {', '.join(allowed)}")
    return Reading(
        format=args.format,
        length=args.length_unit,
        pressure=args.pressure_unit,
        data=args.data,
        beside=args.beside,
        plane=Plane(args.normal, args.rows, args.side),
        open=args.open,
    )


def _findings(
    args: argparse.Namespace, file: ParameterFile, field: "ContactField", reduction: "Reduction"
) -> dict[str, Any]:
    joint = file.values
    return {
        "file": str(args.file),
        "nodes": reduction.nodes,
        "A_0": joint.A_0,
        "force": field.force,
        "force_of_the_bolts": args.preload * joint.n_bolts,
        "p_max": float(field.pressure.max()),
        "p_mean": field.force / joint.A_0,
        "open_nodes": int((field.pressure == 0.0).sum()),
        "points": reduction.points,
        "deviation": reduction.deviation,
        "loads": reduction.loads,
        "largest_moment": reduction.moment * args.preload * joint.row_distance * joint.row_bolts,
        "deviation_beyond": reduction.beyond,
        "written": [str(path) for path in (args.out, args.plot) if path],
    }


def _lines(facts: dict[str, Any], before: float) -> list[str]:
    from ...fields.sums import PRELOADS

    low, high = PRELOADS
    difference = 100.0 * (facts["force"] / facts["force_of_the_bolts"] - 1.0)
    lines = [
        f"{facts['nodes']} nodes ({facts['open_nodes']} open), pressure up to "
        f"{facts['p_max'] / 1e6:.4g} MPa, mean {facts['p_mean'] / 1e6:.4g} MPa",
        f"force {facts['force']:.6g} N, {difference:+.2g} % from the bolt force, "
        f"{facts['force_of_the_bolts']:.6g} N; the field is scaled to the bolt force",
        f"A_0 is the nodes' area, {facts['A_0']:.6g} m2 (it was {before:.6g} m2)",
    ]
    if facts["loads"]:
        lines.append(
            f"{facts['points']} points stand for them: force, K_zz, K_xx, K_rx, K_ry within "
            f"{facts['deviation']:.1e} at {facts['loads']} other loads (preload {low:g} to {high:g} times "
            f"this one, pressed to fully open, moment up to {facts['largest_moment']:.4g} N.m at this one)"
        )
    else:
        lines.append("all nodes are kept")
    if facts["deviation_beyond"]:
        lines.append(
            f"larger moments open nodes: within {facts['deviation_beyond']:.1e} until a row is unloaded"
        )
    if "outline" in facts:
        lines.append(facts["outline"])
    return lines
