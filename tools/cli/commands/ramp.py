"""`jointfmu ramp`: run an FMU along a load ramp or in load cycles."""

import argparse
import math
import sys
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from jointfmu.files.outputs import PICTURE_FILE
from jointfmu.files.writing import write_text
from jointfmu.joints.model import EXTRAPOLATION_WARNING

from ...common import columns, plots
from ...common.options import format_option_flag
from ...common.pressure import warn_overload_in_run
from ...common.shown import align_columns
from ...run.ramps import loops, ramp
from ..command import CommandResult, SubParsers, declare_argument, declare_command, declare_set_option
from ..outputs import declare_output

if TYPE_CHECKING:
    from matplotlib.figure import Figure

RAMP_OPTIONS, LOOP_OPTIONS = ("to", "step"), ("about", "shape", "points", "cycles", "output")
"""Options of a ramp, and options of load cycles in addition to --loop."""
MIN_RAMP_END_OVER_NOMINAL = 0.01
"""End of a ramp over the nominal value of its input [1] below which the command warns: kN in place of N."""
MAX_PRINTED_RAMP_POINTS = 24
"""Largest number of points of a ramp that are printed on a terminal [1]."""


def add_command(command_parsers: SubParsers) -> None:
    """Declare the command `jointfmu ramp` with its options."""
    text = "run an FMU along a load ramp and print its outputs, or in load cycles and print the energy loss"
    drive = declare_command(command_parsers, "ramp", _run_ramp_or_loops, text)
    declare_argument(drive, "fmu", Path, "path of the FMU (.fmu)", "FMU")
    declare_argument(
        drive, "--input", str, "input of the FMU to vary, as in preload or s_rel_x", required=True
    )
    text = "ramp: last value of the input (SI unit, as in 30e3 for 30 kN); the first is 0, or that of --set"
    declare_argument(drive, "--to", float, text)
    declare_argument(drive, "--step", float, "ramp: step of the input (SI unit)")
    declare_argument(
        drive,
        "--loop",
        float,
        "cycles: amplitudes of the input (SI unit), each in a new run of the FMU",
        nargs="+",
    )
    declare_argument(drive, "--about", float, "cycles: mean value of the input (SI unit; default: 0)")
    drive.add_argument(
        "--shape",
        choices=loops.WAVEFORMS,
        help=f"cycles: shape of the input over time (default: {loops.WAVEFORMS[0]})",
    )
    text = "cycles: points per cycle; the first loading adds a quarter of them (default: "
    declare_argument(drive, "--points", int, f"{text}{loops.DEFAULT_POINTS_PER_CYCLE})")
    declare_argument(
        drive,
        "--cycles",
        int,
        f"cycles: number of cycles per amplitude (default: {loops.DEFAULT_CYCLE_COUNT})",
    )
    declare_argument(
        drive,
        "--output",
        str,
        "cycles: output conjugate to the input, for the energy loss, as in f_x for s_rel_x (default: found "
        "by name)",
    )
    declare_argument(drive, "--columns", str, "ramp: outputs to print (default: all)", nargs="+")
    text = "set parameters and inputs (SI units), as in preload=9e3; for the input of a ramp: its first value"
    declare_set_option(drive, text)
    declare_output(drive, "--csv", columns.TABLE_FILE_KIND, "write every point to a table (.csv)")
    declare_output(
        drive,
        "--plot",
        PICTURE_FILE,
        "draw the outputs of a ramp, or the loops of cycles with energy loss and stiffness (.png, .svg)",
    )


def _run_ramp_or_loops(args: argparse.Namespace) -> CommandResult:
    """Run a ramp or load cycles. Raises ValueError if the options describe both or neither."""
    ramp_options, loop_options = (
        [name for name in names if getattr(args, name) is not None] for names in (RAMP_OPTIONS, LOOP_OPTIONS)
    )
    if args.loop and ramp_options:
        raise ValueError(
            f"--loop and {format_option_flag(ramp_options[0])} are both given; state either --loop, or --to "
            "with --step"
        )
    if not args.loop and loop_options:
        raise ValueError(
            f"{format_option_flag(loop_options[0])} is for load cycles; state --loop too, or leave it out"
        )
    if not args.loop and len(ramp_options) < len(RAMP_OPTIONS):
        raise ValueError("the load is missing; state --to with --step, or --loop")
    if args.loop and args.columns:
        raise ValueError("--columns is for a ramp; leave it out with --loop")
    return _run_loops(args) if args.loop else _run_ramp(args)


def _print_messages(fmu_messages: Iterable[str], driven_input: str, input_unit: str) -> None:
    """Print the messages of the FMU, except that the driven input starts at 0, the state without load.

    A temperature of 0 K is no state without load, so its message is printed.
    """
    for message in fmu_messages:
        starts_at_zero = (
            message.startswith(f"{driven_input} = 0") and "in place of its start value" in message
        )
        if not starts_at_zero or input_unit == "K":
            print(f"warning: {message}", file=sys.stderr)


def _warn_small_ramp(fmu_path: Path, input_name: str, end_value: float) -> list[str]:
    """List a warning if a ramp ends far below the usual size of its input: the nominal value, if above 1."""
    from ...run.host import read_description

    (variable,) = (v for v in read_description(fmu_path).modelVariables if v.name == input_name)
    nominal, unit = float(variable.nominal or 1.0), variable.unit or "1"
    if nominal <= 1.0 or abs(end_value) >= MIN_RAMP_END_OVER_NOMINAL * nominal:
        return []
    return [
        f"to = {end_value:g} {unit} is below {100.0 * MIN_RAMP_END_OVER_NOMINAL:g} % of the usual size of "
        f"{input_name}, {nominal:g} {unit}; values are in {unit}: check the unit"
    ]


def _run_ramp(args: argparse.Namespace) -> CommandResult:
    """Run an FMU along a load ramp, and print or write its outputs."""
    result = ramp.run_ramp(args.fmu, args.input, args.to, args.step, dict(args.settings))
    _print_messages(result.log_messages, args.input, result.variable_units[args.input])
    notes = []
    if any(EXTRAPOLATION_WARNING in message for message in result.log_messages):
        unit = result.variable_units[args.input]
        notes.append(f"note: --to = {args.to:g} {unit} is beyond the range of the law; check its unit")
    warnings = [
        *_warn_small_ramp(args.fmu, args.input, args.to),
        *_find_overload(args.fmu, dict(args.settings) | result.variable_columns),
    ]
    result = _select_columns(result, args.input, args.columns)
    if args.csv:
        write_text(args.csv, result.format_time_series_csv())
    if args.plot:
        nonzero = [name for name, column in result.variable_columns.items() if np.any(column)]
        drawn = result if args.columns or len(nonzero) < 2 else _select_columns(result, args.input, nonzero)
        count = len(drawn.variable_columns) - 1
        with plots.open_figure(args.plot, (4.0 * min(count, 3), 2.8 * math.ceil(count / 3))) as figure:
            _draw_ramp(figure, drawn)
    columns = {name: column.tolist() for name, column in result.variable_columns.items()}
    lines = [f"wrote {path}: {len(columns[args.input])} points" for path in (args.csv, args.plot) if path]
    if not lines and not args.json:
        lines = _format_ramp_points(result) if sys.stdout.isatty() else [result.format_time_series_csv()[:-1]]
    return CommandResult(
        json_document={"fmu": str(args.fmu), "units": result.variable_units, "columns": columns},
        output_lines=lines,
        stderr_lines=[*notes, *(f"warning: {text}" for text in warnings)],
    )


def _find_overload(fmu: Path, variable_values: dict[str, Any]) -> list[str]:
    """List a warning if a bolt or another part is overloaded; empty if the FMU has no parameter file."""
    from ...studies.uncertainty.sweep import load_contained_parameter_file

    try:
        file = load_contained_parameter_file(fmu)
    except ValueError:
        return []
    return warn_overload_in_run(file, variable_values)


def _select_columns(
    ramp_result: ramp.RampResult, varied_input: str, output_names: list[str] | None
) -> ramp.RampResult:
    """Select the varied input and the requested outputs. Raises ValueError for an unknown output."""
    if unknown := [name for name in output_names or () if name not in ramp_result.variable_columns]:
        raise ValueError(
            f"--columns {unknown[0]}: unknown output, allowed are {', '.join(ramp_result.variable_columns)}"
        )
    selected = list(dict.fromkeys([varied_input, *(output_names or ramp_result.variable_columns)]))
    return replace(
        ramp_result,
        variable_columns={name: ramp_result.variable_columns[name] for name in selected},
        variable_units={name: ramp_result.variable_units[name] for name in selected},
    )


def _format_ramp_points(ramp_result: ramp.RampResult) -> list[str]:
    """Format up to MAX_PRINTED_RAMP_POINTS points of a ramp, first and last included, in display units."""
    count = next(iter(ramp_result.variable_columns.values())).size
    indices = np.unique(np.linspace(0, count - 1, min(count, MAX_PRINTED_RAMP_POINTS)).round().astype(int))
    columns = []
    for name, values in ramp_result.variable_columns.items():
        unit, size = plots.choose_plot_unit(ramp_result.variable_units[name], values)
        columns.append(
            [
                f"{name}{'' if unit == '1' else f' [{unit}]'}",
                *(f"{size * values[i] + 0.0:.5g}" for i in indices),
            ]
        )
    more = [f"{len(indices)} of {count} points; --csv writes all"] if len(indices) < count else []
    return [*align_columns([*zip(*columns, strict=True)], 0), *more]


def _draw_ramp(matplotlib_figure: "Figure", ramp_result: ramp.RampResult) -> None:
    """Draw every output against the varied input."""
    (driven, x), *outputs = ramp_result.variable_columns.items()
    x_unit, x_size = plots.choose_plot_unit(ramp_result.variable_units[driven], x)
    axes = matplotlib_figure.subplots(
        math.ceil(len(outputs) / 3), min(len(outputs), 3), squeeze=False
    ).ravel()
    for panel, (name, y) in zip(axes, outputs, strict=False):
        unit, size = plots.choose_plot_unit(ramp_result.variable_units[name], y)
        panel.plot(x_size * x, size * y, color=plots.BLUE)
        panel.set_ylabel(f"{name} [{unit}]")
        panel.set_xlabel(f"{driven} [{x_unit}]")
    for panel in axes[len(outputs) :]:
        panel.set_visible(False)


def _run_loops(args: argparse.Namespace) -> CommandResult:
    """Run an FMU in load cycles, and print or write loss and stiffness."""
    fields = {
        "about": "centre_value",
        "shape": "waveform",
        "points": "points_per_cycle",
        "cycles": "cycle_count",
    }
    stated = {name: value for option, name in fields.items() if (value := getattr(args, option)) is not None}
    swing = loops.CyclicInputPath(**stated)
    found = loops.run_loops(args.fmu, args.input, args.loop, swing, args.output, dict(args.settings))
    _print_messages(found.log_messages, args.input, found.loops[0].path_result.variable_units[args.input])
    if args.csv:
        write_text(args.csv, found.format_point_table())
    if args.plot:
        with plots.open_figure(args.plot, (11.4, 3.8)) as figure:
            _draw_loops(figure, found, swing)
    lines, written = found.format_quantity_table().splitlines(), (args.csv, args.plot)
    return CommandResult(
        json_document=_loops_to_json(args.fmu, found),
        output_lines=lines,
        stderr_lines=[found.describe_loop_columns()],
        written_files=written,
    )


def _loops_to_json(fmu: Path, hysteresis_loops: loops.HysteresisLoops) -> dict[str, object]:
    """JSON object of load cycles. Forces act on the joint and are positive in the direction of motion."""
    rows = hysteresis_loops.compute_quantities_of_loops()
    for row, loop in zip(rows, hysteresis_loops.loops, strict=True):
        row |= {
            "motions": loop.displacements.tolist(),
            "forces": loop.forces.tolist(),
            "closed": loop.last_cycle_start_index,
        }
    names = {
        "motion": hysteresis_loops.displacement_name,
        "force": hysteresis_loops.force_name,
        "sign": hysteresis_loops.force_sign,
    }
    return {
        "fmu": str(fmu),
        **names,
        "units": dict(zip(("motion", "force"), hysteresis_loops.displacement_and_force_units, strict=True)),
        "rows": rows,
    }


def _draw_loops(
    matplotlib_figure: "Figure", hysteresis_loops: loops.HysteresisLoops, cyclic_path: loops.CyclicInputPath
) -> None:
    """Draw hysteresis loops with first loading and end points; energy loss and stiffness versus amplitude."""
    left, middle, right = matplotlib_figure.subplots(1, 3, width_ratios=(1.3, 1.0, 1.0))
    cycles = sorted(hysteresis_loops.loops, key=lambda loop: loop.displacement_and_force_amplitude[0])
    (motion, x_size), (force, y_size) = (
        plots.choose_plot_unit(unit, np.concatenate([getattr(loop, name) for loop in cycles]))
        for unit, name in zip(
            hysteresis_loops.displacement_and_force_units, ("displacements", "forces"), strict=True
        )
    )
    for loop in cycles:
        x, y = (
            x_size * loop.displacements[loop.last_cycle_start_index :],
            y_size * loop.forces[loop.last_cycle_start_index :],
        )
        left.plot(x, y, color=plots.BLUE, lw=1.2)
    first = slice(None, cyclic_path.points_per_cycle // 4 + 1)
    left.plot(
        x_size * cycles[-1].displacements[first],
        y_size * cycles[-1].forces[first],
        "--",
        color=plots.RED,
        label="first loading",
    )
    ends = np.array([(x_size * loop.displacements[-1], y_size * loop.forces[-1]) for loop in cycles])
    left.plot(*ends.T, "o", color=plots.RED, ms=4, label="ends of the loops")
    left.set_xlabel(f"{hysteresis_loops.displacement_name} [{motion}]")
    left.set_ylabel(
        f"{'-' if hysteresis_loops.force_sign < 0.0 else ''}{hysteresis_loops.force_name} [{force}]"
    )
    left.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2)
    rows = [loop.compute_loop_quantities() for loop in cycles]
    amplitude, stiffness, loss = (
        np.array([row[name] for row in rows]) for name in ("motion", "secant_stiffness", "loss")
    )
    unit, size = plots.choose_plot_unit(hysteresis_loops.loop_quantity_units["secant_stiffness"], stiffness)
    for axes, y, label in (
        (middle, loss, "energy loss per cycle [J]"),
        (right, size * stiffness, f"secant stiffness [{unit}]"),
    ):
        axes.plot(x_size * amplitude, y, "o-", color=plots.BLUE, ms=4)
        axes.set_xlabel(f"amplitude [{motion}]")
        axes.set_ylabel(label)
    right.set_xlim(left=0.0)
    right.set_ylim(0.0, 1.1 * size * float(np.max(stiffness)))
    if np.all(loss > 0.0):
        middle.set(xscale="log", yscale="log")
        plots.set_log_axis_ticks(middle.xaxis)
        plots.set_log_axis_ticks(middle.yaxis)
