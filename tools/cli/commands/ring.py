"""`jointfmu ring`: resonance frequency and damping of a joint in its system, by simulation with FMUs."""

import argparse
import math
import sys
from pathlib import Path
from typing import Any

import numpy as np

from jointfmu.files.outputs import PICTURE_FILE
from jointfmu.files.writing import write_text
from jointfmu.mechanics.stable_steps import largest_stable_steps

from ...common import columns
from ...common.options import require_package
from ...systems.system import list_system_names, load_system
from ..command import CommandResult, SubParsers, declare_argument, declare_command, declare_set_option
from ..outputs import declare_output
from . import save_panels


def add_command(command_parsers: SubParsers) -> None:
    """Declare the command `jointfmu ring` with its options."""
    text = "simulate a joint with a body on it; find resonance and damping over load or amplitude"
    ring = declare_command(command_parsers, "ring", _run_resonance_simulation, text)
    declare_argument(
        ring,
        "system",
        str,
        f"shipped system ({', '.join(list_system_names())}), or a system file (TOML)",
        "SYSTEM",
    )
    declare_argument(ring, "--joint", str, "name of the joint to examine, needed if the system has several")
    text = "folder with the FMUs, written by `jointfmu system` or `jointfmu build --systems`"
    declare_argument(ring, "--fmus", Path, text, "DIR", default=Path("dist/fmi2"))
    text = (
        "loads of the joint, each simulated separately: preload (the same in each bolt) [N], or torque at "
        "the output [N.m] (default: four preloads from 3 to 30 kN, or torques from zero to rated torque)"
    )
    declare_argument(ring, "--load", float, text, nargs="+")
    text = "mass [kg], or for a rotating body moment of inertia [kg.m2] (default: the value in SYSTEM)"
    declare_argument(ring, "--inertia", float, text)
    text = (
        "simulate a free decay from this deflection [m or rad], in the direction in which the joint slips, "
    )
    text += "and print frequency and damping over the amplitude (default load: the largest of the series)"
    declare_argument(ring, "--amplitude", float, text)
    declare_set_option(ring, "with --amplitude: set parameters of the joint (SI units), as in mu=0.2")
    declare_output(ring, "--csv", columns.TABLE_FILE_KIND, "write the printed table (.csv)")
    declare_output(ring, "--plot", PICTURE_FILE, "draw resonance and decay (.png, .svg)")


def _run_resonance_simulation(args: argparse.Namespace) -> CommandResult:
    """Run `jointfmu ring`: resonance or free decay of a joint with a body, by simulation with FMUs."""
    with require_package("run a system"):
        from ...systems import ringing
    example = ringing.find_vibrating_joint(load_system(args.system), args.joint)
    _check_arguments(args, example.inertia_unit)
    for name in (example.fmu_name, example.vibration_test.body_model):
        if not (args.fmus / f"{name}.fmu").is_file():
            raise ValueError(
                f"--fmus {args.fmus}: has no {name}.fmu; `jointfmu system {args.system}` writes it"
            )
    if args.amplitude is not None:
        return _run_free_decays(args, example)
    if args.settings:
        raise ValueError("--set works with --amplitude only; state --amplitude too")
    points = ringing.simulate_vibrations(example, args.fmus, args.load, args.inertia)
    rows = [_resonance_row(point) for point in points]
    for message in dict.fromkeys(text for point in points for text in point.log_messages):
        print(message, file=sys.stderr)
    for note in example.simplification_notes:
        print(f"note: {note}", file=sys.stderr)
    table = _format_resonance_table(rows, example.load_unit)
    if args.csv:
        write_text(args.csv, table)
    if args.plot:
        from ...pages.report.systems import RESONANCE_FIGURE_SIZE, resonance_charts

        save_panels(args.plot, resonance_charts(points, example, args.fmus), RESONANCE_FIGURE_SIZE)
    misses = [line for point in points for line in point.deviation_texts]
    for line in misses:
        print(f"missed: {line}", file=sys.stderr)
    return CommandResult(
        json_document={"system": args.system, "rows": rows, "missed": len(misses)},
        output_lines=table.splitlines(),
        written_files=(args.csv, args.plot),
        exit_status=int(bool(misses)),
    )


def _run_free_decays(args: argparse.Namespace, vibrating_joint: Any) -> CommandResult:
    """Simulate free decays: frequency and damping as functions of the amplitude."""
    from ...systems import decays

    points = decays.simulate_decays(
        vibrating_joint, args.fmus, args.amplitude, args.load, args.inertia, dict(args.settings)
    )
    body = vibrating_joint.vibration_test
    for message in dict.fromkeys(text for point in points for text in point.log_messages):
        print(message, file=sys.stderr)
    heads = {
        "load": vibrating_joint.load_unit,
        "amplitude": vibrating_joint.motion_unit,
        "frequency": "Hz",
        "loop_frequency": "Hz",
        "damping_ratio": "1",
        "loop_damping_ratio": "1",
    }
    values = [np.concatenate(column) for column in zip(*map(_collect_decay_columns, points), strict=True)]
    table = columns.format_table(list(heads.items()), values, significant_digits=6)
    if args.csv:
        write_text(args.csv, table)
    if args.plot:
        from ...pages.report.systems import DECAY_FIGURE_SIZE, decay_charts

        save_panels(args.plot, decay_charts(points, body), DECAY_FIGURE_SIZE)
    rows = [dict(zip(heads, row, strict=True)) for row in np.stack(values, axis=1).tolist()]
    document, written = {"system": args.system, "rows": rows}, (args.csv, args.plot)
    return CommandResult(json_document=document, output_lines=table.splitlines(), written_files=written)


def _collect_decay_columns(free_decay: Any) -> tuple[np.ndarray[Any, Any], ...]:
    """Collect the columns of a free decay: load, amplitude, frequencies [Hz], damping ratios [1].

    Frequency and damping ratio are stated twice: measured in the simulated decay, and computed from the
    joint's hysteresis loop of the same amplitude.
    """
    hertz = 1.0 / math.tau
    return (
        np.full(free_decay.amplitude.size, free_decay.joint_load),
        free_decay.amplitude,
        hertz * free_decay.frequency,
        hertz * free_decay.expected_frequency,
        free_decay.damping,
        free_decay.expected_damping,
    )


def _check_arguments(args: argparse.Namespace, inertia_unit: str) -> None:
    """Raise ValueError before the work starts if load, inertia or amplitude of the vibration is out of range.

    inertia_unit : unit of the inertia in the message
    """
    for value in args.load or ():
        if not math.isfinite(value):
            raise ValueError(f"load = {value:g}: expected a finite number")
    if args.inertia is not None and not 0.0 < args.inertia < math.inf:
        raise ValueError(f"inertia = {args.inertia:g} {inertia_unit} is outside (0, inf)")
    if args.amplitude is not None and not 0.0 < args.amplitude < math.inf:
        raise ValueError(f"amplitude = {args.amplitude:g} m or rad is outside (0, inf)")


def _resonance_row(free_vibration: Any) -> dict[str, float]:
    """Row of results at one load: frequencies [Hz], damping ratios [1], and largest stable time steps [s].

    `largest_step` holds if the co-simulation master passes the force on at once, `largest_step_late` if it
    passes the force on one step late.
    """
    at_once, late = largest_stable_steps(
        free_vibration.expected_frequency**2,
        2.0 * free_vibration.expected_damping * free_vibration.expected_frequency,
        1.0,
    )
    return {
        "load": free_vibration.joint_load,
        "frequency": free_vibration.frequency / math.tau,
        "expected_frequency": free_vibration.expected_frequency / math.tau,
        "damping_ratio": free_vibration.damping,
        "stated_damping_ratio": free_vibration.expected_damping,
        "largest_step": float(at_once),
        "largest_step_late": float(late),
    }


def _format_resonance_table(result_rows: list[dict[str, float]], load_unit: str) -> str:
    """Format rows of results as CSV text with six digits; headings with units."""
    units = (load_unit, "Hz", "Hz", "1", "1", "s", "s")
    values = [np.array([row[name] for row in result_rows]) for name in result_rows[0]]
    return columns.format_table(list(zip(result_rows[0], units, strict=True)), values, significant_digits=6)
