"""`jointfmu fit system`: fit parameters of a system to measured time series."""

import argparse
from pathlib import Path

from jointfmu_fmu_src.naming import check_fmu_name

from jointfmu.files.outputs import PARAMETER_FILE, PICTURE_FILE

from ...api.system_fit import fit_system
from ...common import plots
from ...systems.fit.system_text import read_document_with_sections
from ...systems.system import find_system_file, list_system_names
from ..command import CommandResult, SubParsers, declare_argument, declare_command
from ..outputs import FORCE_OPTION_HELP, declare_output


def add_system_procedure(procedure_parsers: SubParsers) -> None:
    """Declare `jointfmu fit system` with its options."""
    text = "fit parameters of a system to measured time series"
    sub = declare_command(procedure_parsers, "system", _run_system_fit, text)
    text = f"system file with the start values (TOML), or a shipped system ({', '.join(list_system_names())})"
    declare_argument(sub, "file", str, text, "FILE")
    text = "measured time series (CSV): time, and columns named as variables of the system, with units"
    declare_argument(sub, "data", Path, text, "DATA")
    text = (
        "parameters to fit, COMPONENT.PARAMETER, as in drive.K1; for angle and speed of a body, the start "
        "value is fitted"
    )
    declare_argument(sub, "--free", str, text, nargs="+", required=True)
    text = "share of the record, at its end, that is predicted and not fitted, as in 0.2 [1]"
    declare_argument(sub, "--hold-out", float, text, "SHARE", default=0.0)
    text = "headings of DATA that differ from the variables' names: NAME=HEADING or 'NAME=HEADING [UNIT]'"
    declare_argument(sub, "--columns", str, text, "TEXT", nargs="+", default=[])
    text = f"{FORCE_OPTION_HELP}; write the system file even if the fit does not determine the system"
    sub.add_argument("--force", action="store_true", help=text)
    declare_output(sub, "--out", PARAMETER_FILE, "write the system file with the fitted values (TOML)")
    text = "draw measured and simulated columns and their differences over time (.png, .svg)"
    declare_output(sub, "--plot", PICTURE_FILE, text)


def _run_system_fit(args: argparse.Namespace) -> CommandResult:
    """Fit the parameters and write the requested files. A doubtful fit is written with `--force` only."""
    if args.out:
        check_fmu_name(args.out.stem)
        read_document_with_sections(find_system_file(args.file), args.free)
    fit = fit_system(args.file, args.data, args.free, hold_out=args.hold_out, columns=args.columns)
    outcome = fit.outcome
    if args.plot:
        plots.save_figure(fit.plot(), args.plot)
    doubt = None if args.force else outcome.rejection_reason()
    if args.out and not doubt:
        fit.save(args.out, force=args.force)
    lines = []
    for row in outcome.list_fitted_parameters():
        low, high = ("unknown" if end is None else f"{end:.6g}" for end in row["interval"])
        mark = "" if row["determined"] else "   not determined"
        ends = f"95 %: {low} to {high}"
        lines.append(
            f"{row['name']:24} {row['value']:.6g} {row['unit']}  {ends}  start {row['start']:.4g}{mark}"
        )
    lines += [f"{name:24} {value:.4g} {unit}  {text}" for name, (value, unit, text) in outcome.facts.items()]
    document = outcome.to_json()
    notes = [f"note: {line}" for line in document["warnings"]]
    if doubt:
        unwritten = f"; {args.out} is not written, --force writes it" if args.out else ""
        notes.append(f"the fit does not determine the system: {doubt}{unwritten}")
    return CommandResult(
        json_document=document | {"doubt": doubt},
        output_lines=lines,
        stderr_lines=notes,
        written_files=(None if doubt else args.out, args.plot),
        exit_status=int(doubt is not None),
    )
