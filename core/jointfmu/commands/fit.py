"""`jointfmu fit`: parameters from measured curves and catalogue rows."""

import argparse
import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .. import plots
from ..parameters import ParameterFile, check_writable, dump, load, write_text
from .common import Parser, Run, command

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..fitting.outcome import Outcome


def add(commands: Any) -> None:
    """Declare the command and its three kinds."""
    text = "fit a joint's parameters to a measured curve or a catalogue row"
    top = commands.add_parser("fit", help=text, description=text)
    kinds = top.add_subparsers(dest="kind", required=True, metavar="KIND", parser_class=Parser)
    _torque_angle(kinds)
    _catalogue(kinds)
    _preload(kinds)


def _torque_angle(kinds: Any) -> None:
    one = _kind(kinds, "torque-angle", _fit_torque_angle, "a torque-angle curve to the harmonic drive", True)
    one.add_argument(
        "--rated-torque", type=float, metavar="VALUE", help="of the drive [N.m]; scales max_torque with it"
    )


def _catalogue(kinds: Any) -> None:
    one = _kind(kinds, "catalogue", _fit_catalogue, "a catalogue row to the harmonic drive", False)
    for name, text in (
        ("K1", "stiffness below T1 [N.m/rad]"),
        ("K2", "stiffness between T1 and T2 [N.m/rad]"),
        ("K3", "stiffness above T2 [N.m/rad]"),
        ("T1", "torque at the first corner [N.m]"),
        ("T2", "torque at the second corner [N.m]"),
    ):
        one.add_argument(f"--{name}", type=float, required=True, metavar="VALUE", help=text)
    one.add_argument("--rated-torque", type=float, metavar="VALUE", help="rated torque [N.m] (default: T2)")
    one.add_argument("--source", default="catalogue", metavar="TEXT", help="where the row is printed")
    one.add_argument("--ratio", type=float, metavar="VALUE", help="speed ratio (default: that of the start)")


def _preload(kinds: Any) -> None:
    text = "stiffness or frequency over preload to the bolted joint"
    one = _kind(kinds, "preload", _fit_preload, text, True)
    one.add_argument("--direction", choices=("normal", "tangential"), default="normal", help="of the motion")
    one.add_argument("--modal-mass", type=float, metavar="VALUE", help="what vibrates on the joint [kg]")
    one.add_argument(
        "--series-stiffness",
        type=float,
        metavar="VALUE",
        help="of the structure, in series with the joint [N/m]; to fit it: --free ... series_stiffness",
    )


def _kind(kinds: Any, name: str, run: Run, text: str, file: bool) -> argparse.ArgumentParser:
    """What the three share."""
    one = command(kinds, name, run, f"fit {text}")
    if file:
        one.add_argument("file", type=Path, metavar="FILE", help="CSV; the heading names columns and units")
    one.add_argument("--params", type=Path, metavar="FILE", help="parameter file to start from (TOML)")
    one.add_argument("--free", nargs="+", metavar="NAME", help="parameters to fit")
    one.add_argument("--write", type=Path, metavar="FILE", help="write the parameter file (TOML)")
    one.add_argument("--plot", type=Path, metavar="FILE", help="draw data, law and residuals (.png, .svg)")
    return one


def _start(args: argparse.Namespace, joint: str) -> ParameterFile | None:
    """Check what is to be written before the work; the file to start from."""
    if args.write:
        check_writable(args.write)
    if args.plot:
        plots.check(args.plot)
    return load(args.params, joint) if args.params else None


def _fit_torque_angle(args: argparse.Namespace) -> int:
    from ..fitting import torque_angle

    start = _start(args, "harmonic_drive")
    return _finish(args, torque_angle.fit(args.file, start, args.free, args.rated_torque))


def _fit_catalogue(args: argparse.Namespace) -> int:
    from ..fitting import catalogue

    start = _start(args, "harmonic_drive")
    rated, kind = (args.T2, "estimate") if args.rated_torque is None else (args.rated_torque, "catalogue")
    row = catalogue.Row(K1=args.K1, K2=args.K2, K3=args.K3, T1=args.T1, T2=args.T2, rated=rated)
    return _finish(args, catalogue.fit(row, start, args.free, kind, args.ratio, args.source))


def _fit_preload(args: argparse.Namespace) -> int:
    from ..fitting import preload

    start = _start(args, "bolted_joint")
    options = {"modal_mass": args.modal_mass, "series": args.series_stiffness}
    return _finish(args, preload.fit(args.file, start, args.free, direction=args.direction, **options))


def _finish(args: argparse.Namespace, outcome: "Outcome") -> int:
    """Write and print what was found."""
    from ..fitting.outcome import percent

    if args.plot:
        with plots.drawing(args.plot, (7.2, 5.6)) as figure:
            _draw(figure, outcome)
    if args.write:
        write_text(args.write, dump(outcome.parameters))
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
    for path in filter(None, (args.write, args.plot)):
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
