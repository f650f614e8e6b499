"""`jointfmu system`: build FMUs, SSP archives and a Modelica model of joints, bodies and loads."""

import argparse
from pathlib import Path

from jointfmu.files.outputs import ARCHIVE, FOLDER, PICTURE, TEXT, check_output, check_outputs
from jointfmu.files.writing import write_text

from .. import columns
from ..command_line.common import Answer, Commands, argument, command, needing
from ..command_line.outputs import output
from ..systems.system import System, names, system
from . import draw


def add(commands: Commands) -> None:
    """Declare the command `jointfmu system` with its options."""
    text = "build a system of joints and bodies: FMUs, SSP archives and a Modelica model"
    make = command(commands, "system", _system, text)
    argument(make, "file", str, f"system file (TOML), or {', '.join(names())}", "FILE")
    output(make, "--out", FOLDER, "folder to write", default=Path("dist"))
    text = "also build one FMU of the whole system: NAME.fmu, FMI 2.0 and 3.0"
    make.add_argument("--fmu", action="store_true", help=text)
    output(make, "--csv", columns.TABLE, "simulate the system and write all connected outputs")
    text = "simulate the system and draw the joint loads; for an arm also wind-up and tip error (.png, .svg)"
    output(make, "--plot", PICTURE, text)


def _system(args: argparse.Namespace) -> Answer:
    described = system(args.file)
    with needing("build a system"):
        from ..modelica import library
        from ..modelica.systems import model_name
        from ..systems import ssp
        from ..systems.fmu.assembly import assembly
        from ..systems.steps import longest_step

        whole = assembly(described) if args.fmu else None
        model = library.system_text(described)
        step = longest_step(described)
        if (args.csv or args.plot) and (warning := _beyond(described, *step)):
            raise ValueError(f"{args.file}: {warning}; allowed is a shorter one, or neither --csv nor --plot")
        written = args.out / "modelica" / f"{model_name(described)}.mo"
        check_output(written, TEXT, args.force)
        if whole:
            from ..systems.fmu.build import build_system, fmu_paths

            check_outputs(fmu_paths(whole.model().title, args.out), ARCHIVE, args.force)
        built = ssp.build_systems(args.out, [described], force=args.force)
        if whole:
            built += build_system(whole, args.out, force=args.force)
    write_text(written, model)
    paths = [*built, written]
    if args.csv or args.plot:
        from ..report import systems
        from ..systems import cosimulation

        try:
            run = cosimulation.simulate(described, args.out / "fmi2")
        except ValueError as error:
            text = f"experiment.interval = {described.interval:g} s may be too long"
            raise ValueError(f"{error}; {text}") from None
        step = min(step, longest_step(described, run))
        if args.csv:
            units = systems.units(described)
            heads = [(name, units[name]) for name in run]
            write_text(args.csv, columns.text(heads, list(run.values()), digits=12))
        if args.plot:
            draw(args.plot, systems.panels(described, run), systems.MOTION_SIZE)
        paths += [path for path in (args.csv, args.plot) if path]
    notes = [f"warning: {text}" for text in (_beyond(described, *step),) if text]
    texts = [str(path) for path in paths]
    document = {"system": described.name, "built": texts, "longest_step": step[0], "notes": notes}
    return Answer(document=document, lines=[f"built {path}" for path in texts], notes=notes)


def _beyond(system: System, longest: float, joint: str) -> str:
    """Format a warning if the system's interval is longer than the largest stable step; else empty.

    largest_step : largest stable step [s] of a co-simulation
    joint        : joint that limits the step
    """
    if system.interval <= longest:
        return ""
    stated = f"experiment.interval = {system.interval:g} s is longer than {longest:.3g} s"
    return f"{stated}, the largest stable step of {joint} for a parallel (Jacobi) master"
