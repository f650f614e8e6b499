"""`jointfmu system`: build FMUs, SSP archives and a Modelica model of joints, bodies and loads."""

import argparse
from pathlib import Path

from jointfmu.files.outputs import (
    ARCHIVE_FILE,
    EXPORTED_TEXT_FILE,
    OUTPUT_FOLDER,
    PICTURE_FILE,
    check_output,
    check_outputs,
)
from jointfmu.files.writing import write_text

from ...common import columns
from ...common.options import require_package
from ...systems.arm import UNCOUPLED_AXES_NOTE
from ...systems.system import System, list_system_names, load_system
from ..command import CommandResult, SubParsers, declare_argument, declare_command
from ..outputs import declare_output
from . import save_panels


def add_command(command_parsers: SubParsers) -> None:
    """Declare the command `jointfmu system` with its options."""
    text = "build a system of joints and bodies: FMUs, SSP archives and a Modelica model"
    make = declare_command(command_parsers, "system", _run_system, text)
    declare_argument(
        make,
        "file",
        str,
        f"system file (TOML), or a shipped system ({', '.join(list_system_names())})",
        "FILE",
    )
    declare_output(make, "--out", OUTPUT_FOLDER, "folder to write", default=Path("dist"))
    text = "also build the whole system as one FMU, NAME.fmu, in FMI 2.0 and 3.0"
    make.add_argument("--fmu", action="store_true", help=text)
    declare_output(
        make,
        "--csv",
        columns.TABLE_FILE_KIND,
        "simulate the system and write its connected outputs over time (.csv)",
    )
    text = (
        "simulate the system and draw the loads of its joints; for an arm also wind-up and tip error (.png, "
        ".svg)"
    )
    declare_output(make, "--plot", PICTURE_FILE, text)


def _run_system(args: argparse.Namespace) -> CommandResult:
    """Run `jointfmu system`: write FMUs, archives and Modelica model of a system."""
    described = load_system(args.file)
    with require_package("build a system"):
        from ...exchange.modelica import library
        from ...exchange.modelica.systems import make_model_name
        from ...systems import ssp
        from ...systems.fmu.assembly import assemble_system
        from ...systems.steps import find_largest_stable_step

        whole = assemble_system(described) if args.fmu else None
        model = library.render_system(described)
        step = find_largest_stable_step(described)
        if (args.csv or args.plot) and (warning := _warn_long_step(described, *step)):
            raise ValueError(
                f"{args.file}: {warning}; state a shorter interval, or leave out --csv and --plot"
            )
        written = args.out / "modelica" / f"{make_model_name(described)}.mo"
        check_output(written, EXPORTED_TEXT_FILE, args.force)
        if whole:
            from ...systems.fmu.build import build_system_fmus, list_system_fmu_paths

            check_outputs(
                list_system_fmu_paths(whole.make_fmu_model().title, args.out), ARCHIVE_FILE, args.force
            )
        built = ssp.build_system_archives(args.out, [described], overwrite=args.force)
        if whole:
            built += build_system_fmus(whole, args.out, overwrite=args.force)
    write_text(written, model)
    paths = [*built, written]
    if args.csv or args.plot:
        from ...pages.report import systems
        from ...systems import cosimulation

        try:
            run = (
                cosimulation.simulate_arm(described)
                if described.arm
                else cosimulation.simulate_system(described, args.out / "fmi2")
            )
        except ValueError as error:
            text = f"experiment.interval = {described.output_interval:g} s may be too long"
            raise ValueError(f"{error}; {text}") from None
        step = min(step, find_largest_stable_step(described, run))
        if args.csv:
            units = systems.list_output_units(described)
            heads = [(name, units[name]) for name in run]
            write_text(args.csv, columns.format_table(heads, list(run.values()), significant_digits=12))
        if args.plot:
            save_panels(args.plot, systems.system_charts(described, run), systems.MOTION_FIGURE_SIZE)
        paths += [path for path in (args.csv, args.plot) if path]
    notes = [f"warning: {text}" for text in (_warn_long_step(described, *step),) if text]
    if described.arm:
        notes.append(
            f"archives and Modelica model: {UNCOUPLED_AXES_NOTE[0].lower()}{UNCOUPLED_AXES_NOTE[1:]}"
        )
    texts = [str(path) for path in paths]
    document = {"system": described.name, "built": texts, "longest_step": step[0], "notes": notes}
    return CommandResult(
        json_document=document, output_lines=[f"built {path}" for path in texts], stderr_lines=notes
    )


def _warn_long_step(system: System, largest_stable_step: float, joint_name: str) -> str:
    """Warning if the communication interval of a system is longer than the largest stable step; else empty.

    largest_stable_step : largest stable step [s] of a co-simulation
    joint_name          : joint that limits the step
    """
    if system.output_interval <= largest_stable_step:
        return ""
    stated = f"experiment.interval = {system.output_interval:g} s is longer than {largest_stable_step:.3g} s"
    return f"{stated}, the largest stable step of {joint_name} for a parallel (Jacobi) master"
