"""`jointfmu fit`: parameters from measured curves and catalogue rows."""

import argparse
from collections.abc import Mapping
from functools import partial
from pathlib import Path

from jointfmu.files.outputs import PARAMETERS, PICTURE
from jointfmu.joints import KINDS
from jointfmu.parameters import load
from jointfmu.progress import step

from .. import columns, plots
from ..command_line.common import Answer, Commands, Parser, argument, command, flag
from ..command_line.outputs import FORCE, output
from ..drawing.reading import number
from ..fitting.outcome import percent
from ..fitting.procedure import Procedure, procedures
from ..interface.make import Fit
from ..joint_parts import Option
from ..pressure import judge_file
from . import declare


def add(commands: Commands) -> None:
    """Declare the command and what the joints are fitted to."""
    text = "fit a joint's parameters to a measured curve or a catalogue row"
    top = commands.add_parser("fit", help=text, description=text)
    ways = top.add_subparsers(dest="procedure", required=True, metavar="PROCEDURE", parser_class=Parser)
    for choices in procedures().values():
        _declare(ways, choices)


def _declare(ways: Commands, choices: Mapping[str, Procedure]) -> None:
    """Declare the procedures of one name: what all share, and their own options."""
    first = next(iter(choices.values()))
    text = "; ".join(procedure.text for procedure in choices.values())
    sub = command(ways, first.name, partial(_fit, choices), f"fit {text}")
    if first.file:
        many = "+" if first.many else None
        argument(sub, "file", Path, "CSV; the heading names columns and units", nargs=many)
    argument(sub, "--params", Path, "parameter file to start from (TOML)")
    argument(sub, "--free", str, "parameters to fit", nargs="+")
    text = f"{FORCE}; write a fit that says nothing of the joint too"
    sub.add_argument("--force", action="store_true", help=text)
    output(sub, "--out", PARAMETERS, "write the parameter file (TOML)", second="--write")
    output(sub, "--plot", PICTURE, "draw data, law and residuals (.png, .svg)")
    for option in {option.name: option for p in choices.values() for option in p.options}.values():
        declare(sub, option)


def _fit(choices: Mapping[str, Procedure], args: argparse.Namespace) -> Answer:
    """Fit, and write what was found."""
    joint = _joint(choices, args)
    procedure = choices[joint]
    start = load(args.params, joint) if args.params else None
    data = (args.file,) if procedure.file else ()
    step(f"fit of the {KINDS[joint].title}")
    return _finish(args, Fit(procedure.run(*data, start, args.free, **_options(procedure, args))))


def _options(procedure: Procedure, args: argparse.Namespace) -> dict[str, object]:
    """Its options as its function takes them, numbers in SI units."""
    units = {option.unit_by for option in procedure.options}
    return {option.name: _value(option, args) for option in procedure.options if option.name not in units}


def _value(option: Option, args: argparse.Namespace) -> object:
    value = getattr(args, option.name)
    if not option.unit or value is None:
        return value
    unit = (option.unit_by and getattr(args, option.unit_by)) or option.unit
    if value.strip().lower() in ("nan", "inf", "-inf"):
        return float(value)  # the procedure's to refuse
    return number(option.name, value, unit, option.unit, None)


def _joint(choices: Mapping[str, Procedure], args: argparse.Namespace) -> str:
    """The joint whose procedure reads the file; ValueError if none does or an option is another joint's."""
    if len(choices) == 1:
        return next(iter(choices))
    from ..fitting.measurement import OTHERS

    have = {*columns.names(args.file)}
    found = [j for j, procedure in choices.items() if have & {procedure.column, *OTHERS[procedure.column]}]
    if len(found) != 1:
        wanted = " or ".join(f"{procedure.column} ({joint})" for joint, procedure in choices.items())
        raise ValueError(
            f"{args.file}: has {'more than one column' if found else 'no column'} of {wanted}; expected one"
        )
    own = {option.name for option in choices[found[0]].options}
    for other, procedure in choices.items():
        for option in procedure.options:
            if option.name not in own and getattr(args, option.name) != option.default:
                raise ValueError(
                    f"{args.file}: is of a {found[0]}; {flag(option.name)} is allowed with a {other} only"
                )
    return found[0]


def _finish(args: argparse.Namespace, fit: Fit) -> Answer:
    """Write what was found."""
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
    found, document = judge_file(outcome.parameters), outcome.document()
    notes = [f"note: {line}" for line in document["warnings"]]
    notes += [f"warning: {line}" for line in found.warnings]
    if doubt:
        unwritten = f"; {args.out} is not written, --force does it" if args.out else ""
        notes.append(f"the fit says nothing of the joint: {doubt}{unwritten}")
    document["warnings"] += found.warnings
    return Answer(
        document=found.document() | document | {"doubt": doubt},
        lines=[*lines, *found.lines()],
        notes=notes,
        written=(None if doubt else args.out, args.plot),
        status=int(doubt is not None),
    )
