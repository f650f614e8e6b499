"""`jointfmu footprint compute`: contact pressure of a bolted joint by finite elements."""

import argparse
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from jointfmu.files.outputs import PARAMETERS, PICTURE, write_parameter_text
from jointfmu.mechanics.curve import approach_curve
from jointfmu.parameters import ParameterFile, dump

from ...columns import FIELD
from ...command_line.common import Answer, Commands, argument, command
from ...command_line.outputs import output
from ...fem import installed
from ...fields.clamped import clamping
from ...shown import fact_document, fact_lines
from . import assembly_arguments, check_bolts, joint_file, judge_assembly, with_assembly

if TYPE_CHECKING:
    from ...fem.bolted_contact import JointSolution
    from ...fem.convergence import MeshResult


FINEST = 5
"""Largest number of meshes for `--refine`."""
COARSEST = 0.3
"""Smallest refinement [1] at which the mesh still resolves a hole."""


def add(commands: Commands) -> None:
    """Declare the command `jointfmu footprint compute` with its options."""
    text = "compute the contact pressure of a bolted joint by finite elements"
    sub = command(commands, "compute", run, text)
    assembly_arguments(sub)
    argument(sub, "--moment", float, "bending moment about x [N.m] (default: 0)", "M")
    output(sub, "--out", PARAMETERS, "write the parameter file of the joint with this field (TOML)")
    sub.add_argument(
        "--attached",
        choices=("faces", "edge", "heads"),
        help="write the whole joint (sides = elastic) between these surfaces of the bodies: outer faces, "
        "edges (side 1 at -x, side 2 at +x), or seats of the heads (default: write the interface only)",
    )
    output(sub, "--field", FIELD, "write the pressure field (.csv, .vtu)")
    output(sub, "--plot", PICTURE, "draw the pressure (.png, .svg)")
    argument(sub, "--refine", int, f"number of meshes of a convergence study, 1 to {FINEST}", default=1)
    argument(sub, "--refinement", float, "factor that divides the element sizes", "R", default=1.0)


def run(args: argparse.Namespace) -> Answer:
    """Run the command `jointfmu footprint compute`."""
    with installed("the finite-element analysis"):
        from ...fem import convergence, results
        from ...fem.assembly import load as read
        from ...fem.convergence import unlike_holes
        from ...fem.geometry import check_thickness
    assembly, file = read(args.assembly), joint_file(args.params)
    moment = 0.0 if args.moment is None else args.moment
    assembly.bolt_forces(args.preload, moment)
    _check(args)
    if args.attached:
        check_bolts(f"--attached {args.attached}", file)
        check_thickness(assembly)
    if args.field:
        results.check(args.field)
    file = with_assembly(file, assembly, whole=args.out is not None)
    levels = convergence.refinements(args.refine, args.refinement)
    with installed("the finite-element analysis"):
        curve = approach_curve(file.values)
        rows, solution = convergence.study(assembly, curve, args.preload, moment, levels)
    result = _with_field(args, file, solution) if args.out else file
    whole = clamping(file.joint).facts(result, tightening(args, result)) if args.attached else {}
    written = _write(args, result, solution)
    facts = _findings(solution, moment, args.preload)
    judgement = judge_assembly(file, assembly, args.preload, facts["p_mean"], solution.peak)
    judgement = judgement.with_warnings(unlike_holes(solution.field, assembly.bolts.positions, moment != 0.0))
    document = facts | {"meshes": [_mesh(row) for row in rows], "written": written}
    document |= {"whole": fact_document(whole)} if whole else {}
    lines = [*_lines(facts), *_table(rows), *fact_lines(whole)]
    return Answer(document=document, lines=lines, judgement=judgement, written=written)


def _check(args: argparse.Namespace) -> None:
    """Raise ValueError before the work starts if an option is out of range or `--out` is missing."""
    if not 1 <= args.refine <= FINEST:
        raise ValueError(f"--refine = {args.refine} is outside [1, {FINEST}]: number of meshes")
    if not COARSEST <= args.refinement <= 4.0:
        raise ValueError(f"--refinement = {args.refinement:g} is outside [{COARSEST:g}, 4]")
    if args.attached and not args.out:
        raise ValueError(f"--attached {args.attached} without --out: expected the file for the whole joint")


def _write(args: argparse.Namespace, file: ParameterFile, solution: "JointSolution") -> list[str]:
    """Write the files of `--out`, `--field` and `--plot`; returns their paths."""
    from ...fem import results

    if args.out:
        write_parameter_text(args.out, dump(file))
    if args.field:
        results.write(solution, args.field)
    if args.plot:
        results.draw(solution, args.plot)
    return [str(path) for path in (args.out, args.field, args.plot) if path]


def _with_field(args: argparse.Namespace, file: ParameterFile, solution: "JointSolution") -> ParameterFile:
    """Return the joint with the computed pressure field, and with elastic bodies if `--attached` is set.

    The field is of the preload after embedding; it contains the change of pressure under a moment.
    """
    from ...fem.bolted_contact import with_solution

    interface, shape = with_solution(file, solution, args.preload, args.moment or 0.0)
    if not args.attached:
        return interface
    preload = tightening(args, interface)
    return clamping(interface.joint).whole(interface, solution.joint.assembly, preload, args.attached, shape)


def tightening(args: argparse.Namespace, file: ParameterFile) -> float:
    """Tightening force [N] of each bolt: the preload before embedding."""
    return float(args.preload + file.values.embedding)


def _findings(solution: "JointSolution", moment: float, preload: float) -> dict[str, Any]:
    field = solution.field
    places, between = solution.between
    return {
        "assembly": solution.joint.assembly.name,
        "preload": preload,
        "moment": moment,
        "area": float(field.area.sum()),
        "force": field.force,
        "p_mean": field.force / float(field.area.sum()),
        "p_max": solution.peak,
        "between": [
            {"x": x, "y": y, "p": p} for (x, y), p in zip(places.tolist(), between.tolist(), strict=True)
        ],
        "open_share": float(field.area[field.pressure <= 0.0].sum() / field.area.sum()),
        **solution.stiffness,
    }


def _lines(facts: dict[str, Any]) -> Iterator[str]:
    """Format the results as lines of text."""
    yield f"{facts['assembly']}: {facts['preload']:g} N per bolt, moment {facts['moment']:g} N.m"
    yield f"contact   {facts['area'] * 1e4:.2f} cm2, {100 * facts['open_share']:.3g} % open"
    yield f"force     {facts['force']:.6g} N"
    yield f"pressure  mean {facts['p_mean'] / 1e6:.3g} MPa, peak {facts['p_max'] / 1e6:.4g} MPa"
    for middle in facts["between"]:
        yield f"          between bolts at ({middle['x']:g}, {middle['y']:g}) m: {middle['p'] / 1e6:.3g} MPa"
    yield f"interface K_N {facts['K_N']:.5g} N/m, K_rx {facts['K_rx']:.5g}, K_ry {facts['K_ry']:.5g} N.m/rad"


def _mesh(row: "MeshResult") -> dict[str, object]:
    return {"refinement": row.refinement, "elements": row.elements, "unknowns": row.unknowns, **row.values}


def _table(rows: list["MeshResult"]) -> Iterator[str]:
    """Format the convergence study: results of each mesh, relative changes, observed order."""
    if len(rows) < 2:
        return
    from ...fem.convergence import COLUMNS, changes, orders

    heads = [f"{name} [{unit}]" for name, unit in COLUMNS.items()]
    yield f"{'mesh':>6} {'unknowns':>9} " + " ".join(f"{head:>16}" for head in heads)
    for row in rows:
        values = " ".join(f"{row.values[name]:16.6g}" for name in COLUMNS)
        yield f"{row.refinement:6.2f} {row.unknowns:9d} {values}"
    for change, row in zip(changes(rows), rows[1:], strict=True):
        percent = " ".join(f"{100.0 * change[name]:14.3f} %" for name in COLUMNS)
        yield f"change to {row.refinement:6.2f} {percent}"
    if observed := orders(rows):
        yield "observed order   " + " ".join(f"{observed[name]:16.1f}" for name in COLUMNS)
