"""`jointfmu footprint compute`: contact pressure of a bolted joint by finite elements."""

import argparse
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from jointfmu.files.outputs import PARAMETER_FILE, PICTURE_FILE, write_parameter_text
from jointfmu.mechanics.curve import tabulate_approach
from jointfmu.parameters import ParameterFile, format_parameter_file

from ....common.columns import PRESSURE_FIELD_FILE_KIND
from ....common.shown import derived_values_to_json, format_derived_values
from ....fem import require_fem_packages
from ....joints.bolted_joint.field import compute_complete_joint_results, insert_elastic_bodies
from ...command import CommandResult, SubParsers, declare_argument, declare_command
from ...outputs import declare_output
from . import (
    check_bolt_stiffness,
    declare_assembly_arguments,
    judge_stiffness_and_preload,
    load_joint_file,
    replace_assembly_parameters,
)

if TYPE_CHECKING:
    from ....fem.bolted_contact import JointSolution
    from ....fem.convergence import MeshResult


MAX_CONVERGENCE_STUDY_MESHES = 5
"""Largest number of meshes for `--refine` [1]."""
MIN_MESH_REFINEMENT = 0.3
"""Smallest refinement factor of the mesh [1], as in `--refine`, at which it still resolves a hole."""


def add_command(command_parsers: SubParsers) -> None:
    """Declare the command `jointfmu footprint compute` with its options."""
    text = "compute the contact pressure of a bolted joint by finite elements"
    sub = declare_command(command_parsers, "compute", _run_compute, text)
    declare_assembly_arguments(sub)
    declare_argument(sub, "--moment", float, "bending moment on the joint about x [N.m] (default: 0)", "M")
    declare_output(
        sub, "--out", PARAMETER_FILE, "write a parameter file of the joint with the computed pressure (TOML)"
    )
    sub.add_argument(
        "--attached",
        choices=("faces", "edge", "heads"),
        help="write the complete joint (sides = elastic) between these surfaces of the bodies: outer faces, "
        "edges (side 1 at -x, side 2 at +x), or faces under heads and nuts (default: write the interface "
        "only)",
    )
    declare_output(
        sub, "--field", PRESSURE_FIELD_FILE_KIND, "write the contact pressure at the nodes (.csv, .vtu)"
    )
    declare_output(sub, "--plot", PICTURE_FILE, "draw the contact pressure (.png, .svg)")
    declare_argument(
        sub,
        "--refine",
        int,
        f"convergence study: number of meshes, 1 to {MAX_CONVERGENCE_STUDY_MESHES}, each finer than the one "
        "before, the second with --refinement",
        default=1,
    )
    text = f"factor that divides all element sizes, {MIN_MESH_REFINEMENT:g} to 4; below 1: coarser, faster"
    declare_argument(sub, "--refinement", float, text, "R", default=1.0)


def _run_compute(args: argparse.Namespace) -> CommandResult:
    """Compute the contact pressure of an assembly by finite elements, print it and write the files."""
    with require_fem_packages("the finite-element analysis"):
        from ....fem import convergence, results
        from ....fem.assembly import read_assembly as read
        from ....fem.convergence import check_bolt_symmetry
        from ....fem.geometry import check_thickness
    assembly, file = read(args.assembly), load_joint_file(args.params)
    moment = 0.0 if args.moment is None else args.moment
    assembly.bolt_forces(args.preload, moment)
    _check_arguments(args)
    if args.attached:
        check_bolt_stiffness(f"--attached {args.attached}", file)
        check_thickness(assembly)
    if args.field:
        results.check_pressure_field_path(args.field)
    file = replace_assembly_parameters(file, assembly, include_bolts=args.out is not None)
    levels = convergence.refinement_series(args.refine, args.refinement)
    with require_fem_packages("the finite-element analysis"):
        curve = tabulate_approach(file.values)
        rows, solution = convergence.run_mesh_study(assembly, curve, args.preload, moment, levels)
    result = _insert_pressure_field(args, file, solution) if args.out else file
    whole = compute_complete_joint_results(result, tightening_force(args, result)) if args.attached else {}
    written = _write_outputs(args, result, solution)
    facts = _results_to_json(solution, moment, args.preload)
    judgement = judge_stiffness_and_preload(
        file, assembly, args.preload, facts["p_mean"], solution.peak_pressure
    )
    judgement = judgement.prepend_warnings(
        check_bolt_symmetry(solution.contact_field, assembly.bolts.bolt_positions, moment != 0.0)
    )
    document = facts | {"meshes": [_mesh_result_to_json(row) for row in rows], "written": written}
    document |= {"whole": derived_values_to_json(whole)} if whole else {}
    lines = [
        *_format_results(facts),
        *_format_convergence(rows),
        *(describe_fmu_preload(args, result) if args.out else ()),
        *format_derived_values(whole),
    ]
    return CommandResult(
        json_document=document, output_lines=lines, stiffness_judgement=judgement, written_files=written
    )


def _check_arguments(args: argparse.Namespace) -> None:
    """Raise ValueError before the work starts if an option is out of range or `--out` is missing."""
    if not 1 <= args.refine <= MAX_CONVERGENCE_STUDY_MESHES:
        raise ValueError(
            f"--refine = {args.refine} is outside [1, {MAX_CONVERGENCE_STUDY_MESHES}]: number of meshes"
        )
    if not MIN_MESH_REFINEMENT <= args.refinement <= 4.0:
        raise ValueError(
            f"--refinement = {args.refinement:g} is outside [{MIN_MESH_REFINEMENT:g}, 4]: factor that "
            "divides the element sizes"
        )
    if args.attached and not args.out:
        raise ValueError(f"--attached {args.attached} needs --out, the file for the complete joint")


def _write_outputs(
    args: argparse.Namespace, parameter_file: ParameterFile, joint_solution: "JointSolution"
) -> list[str]:
    """Write the joint (`--out`), pressure field (`--field`) and picture (`--plot`); returns their paths."""
    from ....fem import results

    if args.out:
        write_parameter_text(args.out, format_parameter_file(parameter_file))
    if args.field:
        results.write_pressure_field(joint_solution, args.field)
    if args.plot:
        results.draw_contact_pressure(joint_solution, args.plot)
    return [str(path) for path in (args.out, args.field, args.plot) if path]


def _insert_pressure_field(
    args: argparse.Namespace, parameter_file: ParameterFile, joint_solution: "JointSolution"
) -> ParameterFile:
    """Return the joint with the computed pressure field, and with elastic bodies if `--attached` is set.

    The pressures are those at the preload that remains after embedding, and those that a moment adds.
    """
    from ....fem.bolted_contact import insert_contact_pressure

    interface, shape = insert_contact_pressure(
        parameter_file, joint_solution, args.preload, args.moment or 0.0
    )
    if not args.attached:
        return interface
    preload = tightening_force(args, interface)
    return insert_elastic_bodies(
        interface, joint_solution.bolted_contact.assembly, preload, args.attached, shape
    )


def tightening_force(args: argparse.Namespace, parameter_file: ParameterFile) -> float:
    """Tightening force [N] of each bolt: the preload before embedding."""
    return float(args.preload + parameter_file.values.embedding)


def describe_fmu_preload(args: argparse.Namespace, parameter_file: ParameterFile) -> list[str]:
    """List a line that states the input `preload` with which the FMU has the pressure field.

    The list is empty if the joint has no embedding: then the input is `--preload`.
    """
    embedding = parameter_file.values.embedding
    if not embedding:
        return []
    preload = tightening_force(args, parameter_file)
    start = parameter_file.inputs.get("preload")
    return [
        f"set preload = {preload:.5g} N in the FMU to get this field: embedding takes {embedding:.5g} N, "
        f"{args.preload:.5g} N remain"
        + (f"; the start value in the file is {start:.5g} N" if start not in (None, preload) else "")
    ]


def _results_to_json(
    joint_solution: "JointSolution", bending_moment: float, preload: float
) -> dict[str, Any]:
    """Collect the results of the computed contact pressure in a JSON object."""
    field = joint_solution.contact_field
    places, between = joint_solution.pressure_between_bolts
    return {
        "assembly": joint_solution.bolted_contact.assembly.name,
        "preload": preload,
        "moment": bending_moment,
        "area": float(field.nodal_area.sum()),
        "force": field.normal_force,
        "p_mean": field.normal_force / float(field.nodal_area.sum()),
        "p_max": joint_solution.peak_pressure,
        "between": [
            {"x": x, "y": y, "p": p} for (x, y), p in zip(places.tolist(), between.tolist(), strict=True)
        ],
        "open_share": float(field.nodal_area[field.nodal_pressure <= 0.0].sum() / field.nodal_area.sum()),
        **joint_solution.interface_stiffness,
    }


def _format_results(json_document: dict[str, Any]) -> Iterator[str]:
    """Format the results of the computed contact pressure as lines of text."""
    yield (
        f"{json_document['assembly']}: {json_document['preload']:g} N per bolt, moment "
        f"{json_document['moment']:g} N.m"
    )
    yield f"contact   {json_document['area'] * 1e4:.2f} cm2, {100 * json_document['open_share']:.3g} % open"
    yield f"force     {json_document['force']:.6g} N"
    yield (
        f"pressure  mean {json_document['p_mean'] / 1e6:.3g} MPa, peak {json_document['p_max'] / 1e6:.4g} MPa"
    )
    for middle in json_document["between"]:
        yield f"          between bolts at ({middle['x']:g}, {middle['y']:g}) m: {middle['p'] / 1e6:.3g} MPa"
    yield (
        f"interface K_N {json_document['K_N']:.5g} N/m, K_rx {json_document['K_rx']:.5g}, K_ry "
        f"{json_document['K_ry']:.5g} N.m/rad"
    )


def _mesh_result_to_json(mesh_result: "MeshResult") -> dict[str, object]:
    """JSON object of the results on one mesh of the convergence study."""
    return {
        "refinement": mesh_result.refinement,
        "elements": mesh_result.element_count,
        "unknowns": mesh_result.unknown_count,
        **mesh_result.result_values,
    }


def _format_convergence(mesh_results: list["MeshResult"]) -> Iterator[str]:
    """Format the mesh convergence study: results of each mesh, relative changes, observed order."""
    if len(mesh_results) < 2:
        return
    from ....fem.convergence import RESULT_UNITS, observed_orders, relative_changes

    heads = [f"{name} [{unit}]" for name, unit in RESULT_UNITS.items()]
    yield f"{'mesh':>6} {'unknowns':>9} " + " ".join(f"{head:>16}" for head in heads)
    for row in mesh_results:
        values = " ".join(f"{row.result_values[name]:16.6g}" for name in RESULT_UNITS)
        yield f"{row.refinement:6.2f} {row.unknown_count:9d} {values}"
    for change, row in zip(relative_changes(mesh_results), mesh_results[1:], strict=True):
        percent = " ".join(f"{100.0 * change[name]:14.3f} %" for name in RESULT_UNITS)
        yield f"change to {row.refinement:6.2f} {percent}"
    if observed := observed_orders(mesh_results):
        yield "observed order   " + " ".join(f"{observed[name]:16.1f}" for name in RESULT_UNITS)
