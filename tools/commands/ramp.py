"""`jointfmu ramp`: an FMU along a load ramp, or to and fro."""

import argparse
import math
import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from jointfmu.files.outputs import PICTURE
from jointfmu.files.writing import write_text

from .. import columns, plots
from ..command_line.common import Answer, Commands, argument, command, flag, settings
from ..command_line.outputs import output
from ..ramps import loops, ramp
from ..shown import aligned

if TYPE_CHECKING:
    from matplotlib.figure import Figure

RAMP, LOOP = ("to", "step"), ("about", "shape", "points", "cycles", "output")
"""Options of a ramp, and of loops beside --loop."""
ROWS = 24
"""Points of a ramp that are printed on a terminal, the first and the last among them."""


def add(commands: Commands) -> None:
    """Declare the command."""
    text = "run an FMU along a load ramp from zero, or to and fro, and print every output or the loops' loss"
    drive = command(commands, "ramp", _run, text)
    argument(drive, "fmu", Path, "path of the FMU", "FMU")
    argument(drive, "--input", str, "input to drive", required=True)
    argument(drive, "--to", float, "end of the ramp (SI)")
    argument(drive, "--step", float, "step of the ramp (SI)")
    argument(drive, "--loop", float, "amplitudes of loops, each from rest (SI)", nargs="+")
    argument(drive, "--about", float, "middle of the loops (default: 0)")
    drive.add_argument(
        "--shape", choices=loops.SHAPES, help=f"of a loop over time (default: {loops.SHAPES[0]})"
    )
    argument(drive, "--points", int, f"of a cycle (default: {loops.POINTS})")
    argument(drive, "--cycles", int, f"of a loop (default: {loops.CYCLES})")
    argument(drive, "--output", str, "force or motion conjugate to the input of loops")
    argument(drive, "--columns", str, "outputs of a ramp (default: all)", nargs="+")
    settings(drive)
    output(drive, "--csv", columns.TABLE, "write every point to a file")
    output(drive, "--plot", PICTURE, "draw the outputs of a ramp, or loops, loss and stiffness (.png, .svg)")


def _run(args: argparse.Namespace) -> Answer:
    """A ramp or loops, as the options say; ValueError if they say both or neither."""
    ramped, looped = ([name for name in names if getattr(args, name) is not None] for names in (RAMP, LOOP))
    if args.loop and ramped:
        raise ValueError(
            f"--loop and {flag(ramped[0])} are both given; allowed is --loop, or --to with --step"
        )
    if not args.loop and looped:
        raise ValueError(f"{flag(looped[0])} is given without --loop; allowed is with --loop only")
    if not args.loop and len(ramped) < len(RAMP):
        raise ValueError("the drive is not stated; expected --to with --step, or --loop")
    if args.loop and args.columns:
        raise ValueError("--columns is given with --loop; allowed is with a ramp only")
    return _loops(args) if args.loop else _ramp(args)


def _ramp(args: argparse.Namespace) -> Answer:
    result = ramp.run(args.fmu, args.input, args.to, args.step, dict(args.settings))
    for message in result.messages:
        print(message, file=sys.stderr)
    result = _chosen(result, args.input, args.columns)
    if args.csv:
        write_text(args.csv, result.csv())
    if args.plot:
        count = len(result.columns) - 1
        with plots.drawing(args.plot, (4.0 * min(count, 3), 2.8 * math.ceil(count / 3))) as figure:
            _draw_ramp(figure, result)
    columns = {name: column.tolist() for name, column in result.columns.items()}
    lines = [f"wrote {path}: {len(columns[args.input])} points" for path in (args.csv, args.plot) if path]
    if not lines and not args.json:
        lines = _table(result) if sys.stdout.isatty() else [result.csv()[:-1]]
    return Answer(document={"fmu": str(args.fmu), "units": result.units, "columns": columns}, lines=lines)


def _chosen(result: ramp.RampResult, driven: str, names: list[str] | None) -> ramp.RampResult:
    """The driven input and the outputs asked for; ValueError for one that is not there."""
    if unknown := [name for name in names or () if name not in result.columns]:
        raise ValueError(f"--columns {unknown[0]}: unknown output, allowed are {', '.join(result.columns)}")
    kept = list(dict.fromkeys([driven, *(names or result.columns)]))
    return replace(
        result,
        columns={name: result.columns[name] for name in kept},
        units={name: result.units[name] for name in kept},
    )


def _table(result: ramp.RampResult) -> list[str]:
    """Some of the points for people, in the units in which they read best."""
    every = next(iter(result.columns.values())).size
    shown = np.unique(np.linspace(0, every - 1, min(every, ROWS)).round().astype(int))
    columns = []
    for name, values in result.columns.items():
        unit, size = plots.shown(result.units[name], values)
        columns.append(
            [
                f"{name}{'' if unit == '1' else f' [{unit}]'}",
                *(f"{size * values[i] + 0.0:.5g}" for i in shown),
            ]
        )
    more = [f"{len(shown)} of {every} points; --csv writes all"] if len(shown) < every else []
    return [*aligned([*zip(*columns, strict=True)], 0), *more]


def _draw_ramp(figure: "Figure", result: ramp.RampResult) -> None:
    """Every output over the driven input."""
    (driven, x), *outputs = result.columns.items()
    x_unit, by = plots.shown(result.units[driven], x)
    axes = figure.subplots(math.ceil(len(outputs) / 3), min(len(outputs), 3), squeeze=False).ravel()
    for one, (name, y) in zip(axes, outputs, strict=False):
        unit, size = plots.shown(result.units[name], y)
        one.plot(by * x, size * y, color=plots.BLUE)
        one.set_ylabel(f"{name} [{unit}]")
        one.set_xlabel(f"{driven} [{x_unit}]")
    for one in axes[len(outputs) :]:
        one.set_visible(False)


def _loops(args: argparse.Namespace) -> Answer:
    given = {name: getattr(args, name) for name in LOOP[:4] if getattr(args, name) is not None}
    swing = loops.Swing(**given)
    found = loops.run(args.fmu, args.input, args.loop, swing, args.output, dict(args.settings))
    for message in found.messages:
        print(message, file=sys.stderr)
    if args.csv:
        write_text(args.csv, found.csv())
    if args.plot:
        with plots.drawing(args.plot, (11.4, 3.8)) as figure:
            _draw(figure, found, swing)
    lines, written = found.table().splitlines(), (args.csv, args.plot)
    return Answer(document=_document(args.fmu, found), lines=lines, written=written)


def _document(fmu: Path, found: loops.HysteresisLoops) -> dict[str, object]:
    """What was found as one JSON object; forces act on the joint, positive with the motion."""
    rows = found.rows()
    for row, loop in zip(rows, found.loops, strict=True):
        row |= {"motions": loop.motion.tolist(), "forces": loop.force.tolist(), "closed": loop.closed}
    names = {"motion": found.motion, "force": found.force, "sign": found.sign}
    return {
        "fmu": str(fmu),
        **names,
        "units": dict(zip(("motion", "force"), found.units, strict=True)),
        "rows": rows,
    }


def _draw(figure: "Figure", found: loops.HysteresisLoops, swing: loops.Swing) -> None:
    """Loops with first loading and ends; loss, and stiffness, over the amplitude."""
    left, middle, right = figure.subplots(1, 3, width_ratios=(1.3, 1.0, 1.0))
    every = sorted(found.loops, key=lambda loop: loop.amplitudes[0])
    (motion, by), (force, times) = (
        plots.shown(unit, np.concatenate([getattr(loop, name) for loop in every]))
        for unit, name in zip(found.units, ("motion", "force"), strict=True)
    )
    for loop in every:
        left.plot(
            by * loop.motion[loop.closed :], times * loop.force[loop.closed :], color=plots.BLUE, lw=1.2
        )
    first = slice(None, swing.points // 4 + 1)
    left.plot(by * every[-1].motion[first], times * every[-1].force[first], "--", color=plots.RED)
    ends = np.array([(by * loop.motion[-1], times * loop.force[-1]) for loop in every])
    left.plot(*ends.T, "o", color=plots.RED, ms=4, label="first loading, ends of the loops")
    left.set_xlabel(f"{found.motion} [{motion}]")
    left.set_ylabel(f"{'-' if found.sign < 0.0 else ''}{found.force} [{force}]")
    left.legend(loc="lower right")
    rows = [loop.row() for loop in every]
    amplitude, stiffness, loss = (
        np.array([row[name] for row in rows]) for name in ("motion", "secant_stiffness", "loss")
    )
    unit, size = plots.shown(found.row_units["secant_stiffness"], stiffness)
    for axes, y, label in (
        (middle, loss, "loss of a cycle [J]"),
        (right, size * stiffness, f"secant stiffness [{unit}]"),
    ):
        axes.plot(by * amplitude, y, "o-", color=plots.BLUE, ms=4)
        axes.set_xlabel(f"amplitude [{motion}]")
        axes.set_ylabel(label)
    right.set_xlim(left=0.0)
    right.set_ylim(0.0, 1.1 * size * float(np.max(stiffness)))
    if np.all(loss > 0.0):
        middle.set(xscale="log", yscale="log")
