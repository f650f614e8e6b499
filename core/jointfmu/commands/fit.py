"""`jointfmu fit`: parameters from measured curves and catalogue rows."""

import argparse
import json
import sys
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .. import plots
from ..fitting.procedure import Option, Procedure
from ..joints import KINDS
from ..parameters import check_writable, dump, load, write_text
from .common import Parser, command, flag, written

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..fitting.outcome import Outcome


def add(commands: Any) -> None:
    """Declare the command and what the joints are fitted to."""
    text = "fit a joint's parameters to a measured curve or a catalogue row"
    top = commands.add_parser("fit", help=text, description=text)
    procedures = top.add_subparsers(dest="procedure", required=True, metavar="PROCEDURE", parser_class=Parser)
    for kind in KINDS.values():
        part = kind.part("fit")
        for procedure in part.FITS if part else ():
            _declare(procedures, kind.name, procedure)


def _declare(procedures: Any, joint: str, procedure: Procedure) -> None:
    """Declare one procedure: what all share, and its own options."""
    sub = command(procedures, procedure.name, partial(_fit, joint, procedure), f"fit {procedure.text}")
    if procedure.file:
        sub.add_argument("file", type=Path, metavar="FILE", help="CSV; the heading names columns and units")
    sub.add_argument("--params", type=Path, metavar="FILE", help="parameter file to start from (TOML)")
    sub.add_argument("--free", nargs="+", metavar="NAME", help="parameters to fit")
    written(sub)
    sub.add_argument("--plot", type=Path, metavar="FILE", help="draw data, law and residuals (.png, .svg)")
    for option in procedure.options:
        _option(sub, option)


def _option(sub: argparse.ArgumentParser, option: Option) -> None:
    metavar = "TEXT" if option.word else "VALUE"
    sub.add_argument(
        flag(option.name),
        type=str if option.word else float,
        default=option.default,
        choices=option.choices or None,
        required=option.required,
        metavar=None if option.choices else metavar,
        help=option.text,
    )


def _fit(joint: str, procedure: Procedure, args: argparse.Namespace) -> int:
    """Check what is to be written before the work, and fit."""
    if args.out:
        check_writable(args.out)
    if args.plot:
        plots.check(args.plot)
    start = load(args.params, joint) if args.params else None
    data = (args.file,) if procedure.file else ()
    options = {option.name: getattr(args, option.name) for option in procedure.options}
    return _finish(args, procedure.run(*data, start, args.free, **options))


def _finish(args: argparse.Namespace, outcome: "Outcome") -> int:
    """Write and print what was found."""
    from ..fitting.outcome import percent

    if args.plot:
        with plots.drawing(args.plot, (7.2, 5.6)) as figure:
            _draw(figure, outcome)
    if args.out:
        write_text(args.out, dump(outcome.parameters))
    if args.json:
        print(json.dumps(outcome.document()))
        return 0
    for row in outcome.rows():
        spread = row["relative_deviation"]
        shown = "unknown" if spread is None else percent(spread)
        mark = "" if row["determined"] else "   not determined"
        print(f"{row['name']:24} {row['value']:.6g} {row['unit']}  +- {shown}{mark}")
    for name, (value, unit, text) in outcome.facts.items():
        print(f"{name:24} {value:.4g} {unit}  {text}")
    for line in outcome.warnings():
        print(f"note: {line}", file=sys.stderr)
    for path in filter(None, (args.out, args.plot)):
        print(f"wrote {path}")
    return 0


def _draw(figure: "Figure", outcome: "Outcome") -> None:
    """Data and law above, residuals below."""
    picture = outcome.picture
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(2.4, 1.0))
    x, y = picture.x, picture.y
    above.plot(*picture.line, color=plots.BLUE, label="fitted law")
    above.plot(x, y, ".", color=plots.RED, ms=4, label="data")
    below.axhline(0.0, color=plots.BLUE, lw=1.0)
    below.plot(x, picture.misfit, ".", color=plots.RED, ms=4)
    if picture.marks is not None:
        for axes, values in ((above, y), (below, picture.misfit)):
            axes.plot(x[picture.marks], values[picture.marks], "o", color=plots.RED, ms=7)
    above.set_ylabel(picture.labels[1])
    below.set_xlabel(picture.labels[0])
    below.set_ylabel(picture.labels[2])
    above.legend()
