"""`jointfmu fit`: fit parameters to measured curves and catalogue values."""

import argparse
from collections.abc import Mapping
from functools import partial
from pathlib import Path

from jointfmu.files.outputs import PARAMETERS, PICTURE
from jointfmu.joints import KINDS
from jointfmu.parameters import load
from jointfmu.progress import step

from .. import columns, plots
from ..command_line.common import Answer, Commands, Parser, argument, command, flag, sentence
from ..command_line.outputs import FORCE, output
from ..drawing.reading import number
from ..fitting.outcome import percent
from ..fitting.procedure import Procedure, procedures
from ..interface.make import Fit
from ..joint_parts import Option
from ..pressure import judge_file
from . import declare


def add(commands: Commands) -> None:
    """Declare `jointfmu fit` and its procedures."""
    text = "fit a joint's parameters to a measured curve or to catalogue values"
    top = commands.add_parser("fit", help=text, description=sentence(text))
    ways = top.add_subparsers(dest="procedure", required=True, metavar="PROCEDURE", parser_class=Parser)
    for choices in procedures().values():
        _declare(ways, choices)


def _declare(ways: Commands, choices: Mapping[str, Procedure]) -> None:
    """Declare one procedure with the options of all its joints.

    choices : {joint: its procedure of this name}
    """
    first = next(iter(choices.values()))
    text = "; ".join(procedure.text for procedure in choices.values())
    sub = command(ways, first.name, partial(_fit, choices), f"fit {text}")
    if first.file:
        many = "+" if first.many else None
        argument(sub, "file", Path, "measured data (CSV); the heading names columns and units", nargs=many)
    argument(sub, "--params", Path, "parameter file to start from (TOML)")
    argument(sub, "--free", str, "parameters to fit", nargs="+")
    text = f"{FORCE}; write the parameter file even if the fit does not determine the joint"
    sub.add_argument("--force", action="store_true", help=text)
    output(sub, "--out", PARAMETERS, "write the parameter file (TOML)", second="--write")
    output(sub, "--plot", PICTURE, "draw data, law and residuals (.png, .svg)")
    for option in {option.name: option for p in choices.values() for option in p.options}.values():
        declare(sub, option)


def _fit(choices: Mapping[str, Procedure], args: argparse.Namespace) -> Answer:
    """Fit the parameters and write the requested files."""
    joint = _joint(choices, args)
    procedure = choices[joint]
    start = load(args.params, joint) if args.params else None
    data = (args.file,) if procedure.file else ()
    step(f"fit of the {KINDS[joint].title}")
    return _finish(args, Fit(procedure.run(*data, start, args.free, **_options(procedure, args))))


def _options(procedure: Procedure, args: argparse.Namespace) -> dict[str, object]:
    """Read the options of a procedure: {name: value}, numbers in SI units."""
    units = {option.unit_by for option in procedure.options}
    return {option.name: _value(option, args) for option in procedure.options if option.name not in units}


def _value(option: Option, args: argparse.Namespace) -> object:
    value = getattr(args, option.name)
    if not option.unit or value is None:
        return value
    unit = (option.unit_by and getattr(args, option.unit_by)) or option.unit
    if value.strip().lower() in ("nan", "inf", "-inf"):
        return float(value)  # the procedure refuses the value with its own message
    return number(option.name, value, unit, option.unit, None)


def _joint(choices: Mapping[str, Procedure], args: argparse.Namespace) -> str:
    """Find the joint to which the columns of the file belong.

    Raises ValueError if the file has the columns of no joint or of several, or if an option belongs to
    another joint.
    """
    if len(choices) == 1:
        return next(iter(choices))
    from ..fitting.measurement import OTHERS

    names = {*columns.names(args.file)}
    joints = [j for j, procedure in choices.items() if names & {procedure.column, *OTHERS[procedure.column]}]
    if len(joints) != 1:
        expected = " or ".join(f"{procedure.column} ({joint})" for joint, procedure in choices.items())
        raise ValueError(
            f"{args.file}: has {'more than one column' if joints else 'no column'} of {expected}; "
            "expected one"
        )
    options = {option.name for option in choices[joints[0]].options}
    for other, procedure in choices.items():
        for option in procedure.options:
            if option.name not in options and getattr(args, option.name) != option.default:
                raise ValueError(
                    f"{args.file}: is of a {joints[0]}; {flag(option.name)} is allowed with a {other} only"
                )
    return joints[0]


def _finish(args: argparse.Namespace, fit: Fit) -> Answer:
    """Write the files of a fit and format its result. A doubtful fit is written with `--force` only."""
    outcome = fit.outcome
    if args.plot:
        plots.save(fit.plot(), args.plot)
    doubt = None if args.force else outcome.doubt()
    if args.out and not doubt:
        fit.joint.save(args.out, force=args.force)
    lines = []
    for row in outcome.rows():
        spread = row["relative_deviation"]
        shown = "spread unknown" if spread is None else percent(spread)
        shown = f"+- {shown}" if shown.endswith("%") else shown
        mark = "" if row["determined"] else "   not determined"
        ends = "  (95 %: {:.4g} to {:.4g})".format(*row["interval"]) if "interval" in row else ""
        lines.append(f"{row['name']:24} {row['value']:.6g} {row['unit']}  {shown}{ends}{mark}")
    for name, (value, unit, text) in outcome.facts.items():
        lines.append(f"{name:24} {value:.4g} {unit}  {text}")
    judgement, document = judge_file(outcome.parameters), outcome.document()
    notes = [f"note: {line}" for line in document["warnings"]]
    notes += [f"warning: {line}" for line in judgement.warnings]
    if doubt:
        unwritten = f"; {args.out} is not written, --force writes it" if args.out else ""
        notes.append(f"the fit does not determine the joint: {doubt}{unwritten}")
    document["warnings"] += judgement.warnings
    return Answer(
        document=judgement.document() | document | {"doubt": doubt},
        lines=[*lines, *judgement.lines()],
        notes=notes,
        written=(None if doubt else args.out, args.plot),
        status=int(doubt is not None),
    )
