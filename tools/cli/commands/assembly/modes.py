"""`jointfmu modes`: natural frequencies of a bolted assembly without supports."""

import argparse
from collections.abc import Iterator
from typing import TYPE_CHECKING

from jointfmu.files.outputs import MESH_FILE
from jointfmu.files.writing import write_bytes
from jointfmu.mechanics.curve import tabulate_approach

from ....fem import require_fem_packages
from ...command import CommandResult, SubParsers, declare_argument, declare_command
from ...outputs import declare_output
from . import (
    declare_assembly_arguments,
    judge_stiffness_and_preload,
    load_joint_file,
    replace_assembly_parameters,
)

if TYPE_CHECKING:
    from ....fem.modes import NaturalModes

MAX_MODE_COUNT = 40
"""Largest number of natural frequencies that the command computes [1]."""


def add_modes_command(command_parsers: SubParsers) -> None:
    """Declare the command `jointfmu modes` with its options."""
    text = "compute natural frequencies of a free bolted assembly with contact stiffness"
    sub = declare_command(command_parsers, "modes", _run_modes, text)
    declare_assembly_arguments(sub)
    declare_argument(sub, "--moment", float, "bending moment on the joint about x [N.m]", "M", default=0.0)
    declare_argument(sub, "--count", int, f"number of elastic modes, 1 to {MAX_MODE_COUNT}", default=6)
    text = "factor that divides all element sizes, 0.1 to 4; below 1: coarser, faster"
    declare_argument(sub, "--refinement", float, text, "R", default=1.0)
    declare_output(sub, "--vtu", MESH_FILE, "write the mode shapes as a mesh for ParaView (.vtu)")


def _run_modes(args: argparse.Namespace) -> CommandResult:
    """Run the command `jointfmu modes`."""
    with require_fem_packages("the finite-element analysis"):
        from ....fem import modes as assembly_modes
        from ....fem import results
        from ....fem.assembly import read_assembly
        from ....fem.bolted_contact import BoltedContact
    assembly = read_assembly(args.assembly)
    force = float(assembly.bolt_forces(args.preload, args.moment).sum())
    _check_arguments(args)
    file = replace_assembly_parameters(load_joint_file(args.params), assembly, include_bolts=False)
    law = tabulate_approach(file.values)
    shear = float(file.values.shear_stiffness_ratio())
    with require_fem_packages("the finite-element analysis"):
        contact = BoltedContact.from_assembly(assembly, args.refinement)
        solution = contact.solve_equilibrium(law, args.preload, args.moment)
        modes = assembly_modes.compute_preloaded_modes(solution, shear, args.count)
        even = assembly_modes.compute_uniform_pressure_modes(contact, law, force, shear, args.count)
    if args.vtu:
        write_bytes(args.vtu, results.make_modes_vtu(contact.bodies, modes))
    judgement = judge_stiffness_and_preload(
        file, assembly, args.preload, force / assembly.contact_area, solution.peak_pressure
    )
    head = (
        f"{assembly.name}: {args.preload:g} N per bolt, moment {args.moment:g} N.m, "
        f"{modes.assembly_mass:.4g} kg"
    )
    document = _modes_to_json(args, assembly.name, modes, even)
    return CommandResult(
        json_document=document,
        output_lines=[head, *_format_modes(modes, even)],
        stiffness_judgement=judgement,
    )


def _check_arguments(args: argparse.Namespace) -> None:
    """Raise ValueError before the work starts if an option of the command is out of range."""
    if not 1 <= args.count <= MAX_MODE_COUNT:
        raise ValueError(f"--count = {args.count} is outside [1, {MAX_MODE_COUNT}]: number of modes")
    if not 0.1 <= args.refinement <= 4.0:
        raise ValueError(
            f"--refinement = {args.refinement:g} is outside [0.1, 4]: factor that divides the element sizes"
        )
    if args.vtu and args.vtu.suffix.lower() not in MESH_FILE.file_name_endings:
        raise ValueError(f"{args.vtu}: suffix {args.vtu.suffix!r} is not a mesh, allowed is .vtu")


def _modes_to_json(
    args: argparse.Namespace,
    assembly_name: str,
    natural_modes: "NaturalModes",
    compute_uniform_pressure_modes: "NaturalModes",
) -> dict[str, object]:
    """JSON object of the natural frequencies under the computed and under uniform pressure."""
    rows = zip(
        natural_modes.natural_frequencies.tolist(),
        compute_uniform_pressure_modes.natural_frequencies.tolist(),
        strict=True,
    )
    return {
        "assembly": assembly_name,
        "preload": args.preload,
        "moment": args.moment,
        "mass": natural_modes.assembly_mass,
        "modes": [{"f": f, "f_uniform_pressure": g} for f, g in rows],
        "written": [str(args.vtu)] if args.vtu else [],
    }


def _format_modes(
    natural_modes: "NaturalModes", compute_uniform_pressure_modes: "NaturalModes"
) -> Iterator[str]:
    """Format the natural frequencies as lines of text."""
    yield "mode   f [Hz]   with uniform pressure [Hz]"
    for i, (f, g) in enumerate(
        zip(
            natural_modes.natural_frequencies, compute_uniform_pressure_modes.natural_frequencies, strict=True
        ),
        1,
    ):
        yield f"{i:4d} {f:8.2f} {g:15.2f}  {100.0 * (g / f - 1.0):+.2f} %"
