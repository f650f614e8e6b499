"""`jointfmu system`: a file of joints, bodies and loads as FMUs, SSP archives, a Modelica model, one FMU."""

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
    """Declare the command."""
    text = "build a system of named joints: its FMUs, SSP archives and a Modelica model"
    make = command(commands, "system", _system, text)
    argument(make, "file", str, f"a system's file (TOML), or {', '.join(names())}", "FILE")
    output(make, "--out", FOLDER, "folder", default=Path("dist"))
    text = "one FMU of the whole system too: NAME.fmu, FMI 2.0 and 3.0"
    make.add_argument("--fmu", action="store_true", help=text)
    output(make, "--csv", columns.TABLE, "run it and write all connected outputs")
    text = "run it and draw the joints' loads; of an arm wind-up and the tip's error (.png, .svg)"
    output(make, "--plot", PICTURE, text)


def _system(args: argparse.Namespace) -> Answer:
    found = system(args.file)
    with needing("build a system"):
        from ..modelica import library
        from ..modelica.systems import model_name
        from ..systems import ssp
        from ..systems.fmu.assembly import assembly
        from ..systems.steps import longest_step

        whole = assembly(found) if args.fmu else None
        model = library.system_text(found)
        step = longest_step(found)
        if (args.csv or args.plot) and (beyond := _beyond(found, *step)):
            raise ValueError(f"{args.file}: {beyond}; allowed is a shorter one, or neither --csv nor --plot")
        written = args.out / "modelica" / f"{model_name(found)}.mo"
        check_output(written, TEXT, args.force)
        if whole:
            from ..systems.fmu.build import build_system, fmu_paths

            check_outputs(fmu_paths(whole.model().title, args.out), ARCHIVE, args.force)
        made = ssp.build_systems(args.out, [found], force=args.force)
        if whole:
            made += build_system(whole, args.out, force=args.force)
    write_text(written, model)
    paths = [*made, written]
    if args.csv or args.plot:
        from ..report import systems
        from ..systems import cosimulation

        try:
            run = cosimulation.simulate(found, args.out / "fmi2")
        except ValueError as error:
            raise ValueError(f"{error}; experiment.interval = {found.interval:g} s may be too long") from None
        step = min(step, longest_step(found, run))
        if args.csv:
            units = systems.units(found)
            heads = [(name, units[name]) for name in run]
            write_text(args.csv, columns.text(heads, list(run.values()), digits=12))
        if args.plot:
            draw(args.plot, systems.panels(found, run), systems.MOTION_SIZE)
        paths += [path for path in (args.csv, args.plot) if path]
    notes = [f"warning: {text}" for text in (_beyond(found, *step),) if text]
    built = [str(path) for path in paths]
    document = {"system": found.name, "built": built, "longest_step": step[0], "notes": notes}
    return Answer(document=document, lines=[f"built {path}" for path in built], notes=notes)


def _beyond(system: System, longest: float, joint: str) -> str:
    """What is said of an interval [s] that is longer than the largest stable step of a joint."""
    if system.interval <= longest:
        return ""
    stated = f"experiment.interval = {system.interval:g} s is longer than {longest:.3g} s"
    return f"{stated}, the largest stable step of {joint} where all step side by side"
