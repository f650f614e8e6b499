"""`jointfmu fit`: fit parameters to measured curves and catalogue values."""

import argparse
from collections.abc import Mapping
from functools import partial
from pathlib import Path

from jointfmu.files.outputs import PARAMETER_FILE, PICTURE_FILE
from jointfmu.joints import KINDS
from jointfmu.parameters import load_parameter_file
from jointfmu.progress import set_status_text

from ...api.make import Fit
from ...common import columns, plots
from ...common.options import Option, format_option_flag
from ...common.pressure import judge_joint_stiffness
from ...inputs.drawing.reading import parse_number
from ...inputs.fitting.outcome import format_relative_deviation
from ...inputs.fitting.procedure import FitProcedure, find_fit_procedures
from ..command import CommandResult, Parser, SubParsers, declare_argument, declare_command, format_sentence
from ..outputs import FORCE_OPTION_HELP, declare_output
from . import declare_option
from .fit_system import add_system_procedure


def add_command(command_parsers: SubParsers) -> None:
    """Declare `jointfmu fit` and its procedures."""
    text = "fit a joint's parameters to a measured curve or to catalogue values"
    top = command_parsers.add_parser("fit", help=text, description=format_sentence(text))
    ways = top.add_subparsers(dest="procedure", required=True, metavar="PROCEDURE", parser_class=Parser)
    for choices in find_fit_procedures().values():
        _declare_procedure_command(ways, choices)
    add_system_procedure(ways)


def _declare_procedure_command(
    procedure_parsers: SubParsers, procedure_by_joint: Mapping[str, FitProcedure]
) -> None:
    """Declare one fit procedure as a sub-command, with the options of all its joints.

    procedure_by_joint : {joint: its procedure of this name}
    """
    first = next(iter(procedure_by_joint.values()))
    text = "; ".join(procedure.procedure_description for procedure in procedure_by_joint.values())
    sub = declare_command(
        procedure_parsers, first.procedure_name, partial(_run_fit, procedure_by_joint), f"fit {text}"
    )
    if first.takes_file:
        many = "+" if first.takes_several_files else None
        declare_argument(
            sub,
            "file",
            Path,
            "measured data (CSV); the heading names columns and units, as in torque [N.m]",
            nargs=many,
        )
    starts = "; ".join(procedure.default_start_text for procedure in procedure_by_joint.values())
    declare_argument(sub, "--params", Path, f"parameter file to start from, TOML (default: {starts})")
    text = "names of the parameters to fit (default: selected by law and data, printed in the output)"
    declare_argument(sub, "--free", str, text, nargs="+")
    text = f"{FORCE_OPTION_HELP}; write the parameter file even if the fit does not determine the joint"
    sub.add_argument("--force", action="store_true", help=text)
    declare_output(
        sub, "--out", PARAMETER_FILE, "write a parameter file with the fitted values (TOML)", alias="--write"
    )
    declare_output(
        sub, "--plot", PICTURE_FILE, "draw measured data, fitted law and their differences (.png, .svg)"
    )
    for option in {
        option.name: option for p in procedure_by_joint.values() for option in p.procedure_options
    }.values():
        declare_option(sub, option)


def _run_fit(procedure_by_joint: Mapping[str, FitProcedure], args: argparse.Namespace) -> CommandResult:
    """Fit the parameters and write the requested files."""
    joint = _find_joint_of_file(procedure_by_joint, args)
    procedure = procedure_by_joint[joint]
    start = load_parameter_file(args.params, joint) if args.params else None
    data = (args.file,) if procedure.takes_file else ()
    set_status_text(f"fit of the {KINDS[joint].title}")
    return _write_fit_files(
        args, Fit(procedure.run_fit(*data, start, args.free, **_read_procedure_options(procedure, args)))
    )


def _read_procedure_options(fit_procedure: FitProcedure, args: argparse.Namespace) -> dict[str, object]:
    """Read the options of a fit procedure: {name: value}, numbers in SI units."""
    units = {option.unit_option for option in fit_procedure.procedure_options}
    return {
        option.name: _read_procedure_option(option, args)
        for option in fit_procedure.procedure_options
        if option.name not in units
    }


def _read_procedure_option(procedure_option: Option, args: argparse.Namespace) -> object:
    """Read the value of one option of a procedure, a number in SI units."""
    value = getattr(args, procedure_option.name)
    if not procedure_option.default_unit or value is None:
        return value
    unit = (
        procedure_option.unit_option and getattr(args, procedure_option.unit_option)
    ) or procedure_option.default_unit
    if value.strip().lower() in ("nan", "inf", "-inf"):
        return float(value)  # the procedure refuses the value with its own message
    return parse_number(procedure_option.name, value, unit, procedure_option.default_unit, None)


def _find_joint_of_file(procedure_by_joint: Mapping[str, FitProcedure], args: argparse.Namespace) -> str:
    """Find the joint to which the columns of the file belong.

    procedure_by_joint : {joint: its procedure}, the procedures of one name
    Raises ValueError if the file has the columns of no joint or of several, or if an option belongs to
    another joint.
    """
    if len(procedure_by_joint) == 1:
        return next(iter(procedure_by_joint))
    from ...inputs.fitting.measurement import COLUMN_SYNONYMS

    names = {*columns.read_column_names(args.file)}
    joints = [
        j
        for j, procedure in procedure_by_joint.items()
        if names & {procedure.identifying_column, *COLUMN_SYNONYMS[procedure.identifying_column]}
    ]
    if len(joints) != 1:
        expected = " or ".join(
            f"{procedure.identifying_column} ({joint})" for joint, procedure in procedure_by_joint.items()
        )
        raise ValueError(
            f"{args.file}: has {'more than one column' if joints else 'no column'} of {expected}; expected "
            "one"
        )
    options = {option.name for option in procedure_by_joint[joints[0]].procedure_options}
    for other, procedure in procedure_by_joint.items():
        for option in procedure.procedure_options:
            if option.name not in options and getattr(args, option.name) != option.default:
                raise ValueError(
                    f"{args.file}: has the columns of a {joints[0]}; {format_option_flag(option.name)} is "
                    f"for a {other} only: leave it out"
                )
    return joints[0]


def _write_fit_files(args: argparse.Namespace, joint_fit: Fit) -> CommandResult:
    """Write the files of a fit and format its result. A doubtful fit is written with `--force` only."""
    outcome = joint_fit.outcome
    if args.plot:
        plots.save_figure(joint_fit.plot(), args.plot)
    doubt = None if args.force else outcome.rejection_reason()
    if args.out and not doubt:
        joint_fit.joint.save(args.out, force=args.force)
    lines = []
    for row in outcome.list_fitted_parameters():
        spread = row["relative_deviation"]
        shown = "spread unknown" if spread is None else format_relative_deviation(spread)
        shown = f"+- {shown}" if shown.endswith("%") else shown
        mark = "" if row["determined"] else "   not determined"
        ends = "  (95 %: {:.4g} to {:.4g})".format(*row["interval"]) if "interval" in row else ""
        lines.append(f"{row['name']:24} {row['value']:.6g} {row['unit']}  {shown}{ends}{mark}")
    for name, (value, unit, text) in outcome.facts.items():
        lines.append(f"{name:24} {value:.4g} {unit}  {text}")
    judgement, document = judge_joint_stiffness(outcome.parameters), outcome.to_json()
    notes = [f"note: {line}" for line in document["warnings"]]
    notes += [f"warning: {line}" for line in judgement.warnings]
    if doubt:
        unwritten = f"; {args.out} is not written, --force writes it" if args.out else ""
        notes.append(f"the fit does not determine the joint: {doubt}{unwritten}")
    document["warnings"] += judgement.warnings
    return CommandResult(
        json_document=judgement.to_json() | document | {"doubt": doubt},
        output_lines=[*lines, *judgement.format_lines()],
        stderr_lines=notes,
        written_files=(None if doubt else args.out, args.plot),
        exit_status=int(doubt is not None),
    )
