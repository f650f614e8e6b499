"""`jointfmu modes`: natural frequencies of a bolted assembly without supports."""

import argparse
from collections.abc import Iterator
from typing import TYPE_CHECKING

from jointfmu.files.outputs import MESH
from jointfmu.files.writing import write_bytes
from jointfmu.mechanics.curve import approach_curve

from ...command_line.common import Answer, Commands, argument, command
from ...command_line.outputs import output
from ...fem import installed
from ...fields.clamped import clamping
from . import assembly_arguments, joint_file, judge_assembly, with_assembly

if TYPE_CHECKING:
    from ...fem.modes import NaturalModes

MOST = 40
"""Largest number of modes."""


def add_modes(commands: Commands) -> None:
    """Declare the command `jointfmu modes` with its options."""
    text = "compute natural frequencies of a free bolted assembly with contact stiffness"
    sub = command(commands, "modes", run, text)
    assembly_arguments(sub)
    argument(sub, "--moment", float, "bending moment about x [N.m]", "M", default=0.0)
    argument(sub, "--count", int, f"number of modes, 1 to {MOST}", default=6)
    argument(sub, "--refinement", float, "factor that divides all element sizes", "R", default=1.0)
    output(sub, "--vtu", MESH, "write the mode shapes (.vtu)")


def run(args: argparse.Namespace) -> Answer:
    """Run the command `jointfmu modes`."""
    with installed("the finite-element analysis"):
        from ...fem import modes as assembly_modes
        from ...fem import results
        from ...fem.assembly import load
        from ...fem.bolted_contact import BoltedContact
    assembly = load(args.assembly)
    force = float(assembly.bolt_forces(args.preload, args.moment).sum())
    _check(args)
    file = with_assembly(joint_file(args.params), assembly, whole=False)
    law, shear = approach_curve(file.values), float(clamping(file.joint).shear_ratio(file.values))
    with installed("the finite-element analysis"):
        contact = BoltedContact.of(assembly, args.refinement)
        solution = contact.solve(law, args.preload, args.moment)
        modes = assembly_modes.computed(solution, shear, args.count)
        even = assembly_modes.uniform(contact, law, force, shear, args.count)
    if args.vtu:
        write_bytes(args.vtu, results.modes_vtu(contact.bodies, modes))
    judgement = judge_assembly(file, assembly, args.preload, force / assembly.contact_area, solution.peak)
    head = f"{assembly.name}: {args.preload:g} N per bolt, moment {args.moment:g} N.m, {modes.mass:.4g} kg"
    document = _document(args, assembly.name, modes, even)
    return Answer(document=document, lines=[head, *_table(modes, even)], judgement=judgement)


def _check(args: argparse.Namespace) -> None:
    if not 1 <= args.count <= MOST:
        raise ValueError(f"--count = {args.count} is outside [1, {MOST}]: number of modes")
    if not 0.1 <= args.refinement <= 4.0:
        raise ValueError(
            f"--refinement = {args.refinement:g} is outside [0.1, 4]: divides the sizes of elements"
        )
    if args.vtu and args.vtu.suffix.lower() not in MESH.endings:
        raise ValueError(f"{args.vtu}: suffix {args.vtu.suffix!r} is no mesh, allowed is .vtu")


def _document(
    args: argparse.Namespace, name: str, modes: "NaturalModes", even: "NaturalModes"
) -> dict[str, object]:
    rows = zip(modes.frequency.tolist(), even.frequency.tolist(), strict=True)
    return {
        "assembly": name,
        "preload": args.preload,
        "moment": args.moment,
        "mass": modes.mass,
        "modes": [{"f": f, "f_uniform_pressure": g} for f, g in rows],
        "written": [str(args.vtu)] if args.vtu else [],
    }


def _table(modes: "NaturalModes", even: "NaturalModes") -> Iterator[str]:
    yield "mode   f [Hz]   with uniform pressure [Hz]"
    for i, (f, g) in enumerate(zip(modes.frequency, even.frequency, strict=True), 1):
        yield f"{i:4d} {f:8.2f} {g:15.2f}  {100.0 * (g / f - 1.0):+.2f} %"
