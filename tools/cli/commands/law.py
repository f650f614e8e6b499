"""`jointfmu law`: evaluate one interface law at pressures or at areas of the largest contact spot."""

import argparse
import math
from pathlib import Path
from typing import Any

import numpy as np

from jointfmu.contact.interface import evaluate_at_largest_spot, evaluate_at_pressure
from jointfmu.contact.laws import LAWS
from jointfmu.quantity import flatten_parameters

from ...common.judgement import assess_law_stiffness
from ...common.shown import align_columns
from ...inputs.laws import (
    LAW_OUTPUT_COLUMNS,
    LAW_OUTPUT_UNITS,
    build_law_parameters,
    explain_law_outputs,
    find_joints_with_law,
    find_surface_rms_height,
    load_law_file,
)
from ..command import CommandResult, SubParsers, declare_argument, declare_command, declare_set_option


def add_command(command_parsers: SubParsers) -> None:
    """Declare the command `jointfmu law` with its options."""
    text = "evaluate one interface law at pressures or at areas of the largest contact spot"
    law = declare_command(command_parsers, "law", _run_law, text)
    laws = [name for name in LAWS if find_joints_with_law(name)]
    law.add_argument("law", choices=laws, metavar="LAW", help=f"interface law, one of {', '.join(laws)}")
    at = law.add_mutually_exclusive_group(required=True)
    declare_argument(
        at, "--pressure", float, "mean pressure on the nominal contact area [Pa]", "P", nargs="+"
    )
    declare_argument(at, "--largest-spot", float, "area of the largest contact spot [m2]", "A", nargs="+")
    declare_argument(
        law,
        "--params",
        Path,
        "parameter file of a joint with this law (TOML; default: that of a shipped joint with this law)",
    )
    declare_set_option(
        law, "set parameters of the law (SI units), as in surface.D=2.45; see jointfmu parameters LAW"
    )


def _run_law(args: argparse.Namespace) -> CommandResult:
    """Run `jointfmu law`: evaluate one interface law at pressures or spot areas."""
    file = load_law_file(args.params, args.law) if args.params else None
    law = build_law_parameters(args.law, file, dict(args.settings))
    with np.errstate(over="ignore"):
        if args.pressure is not None:
            state = evaluate_at_pressure(law, np.array(args.pressure))
        else:
            state = evaluate_at_largest_spot(law, np.array(args.largest_spot))
    names = [*LAW_OUTPUT_COLUMNS, *(name for name in state if name not in LAW_OUTPUT_COLUMNS)]
    count = len(args.pressure or args.largest_spot)
    rows = [{n: _read_finite_entry(state[n], i) if n in state else None for n in names} for i in range(count)]
    h = find_surface_rms_height(args.law, law, file, dict(args.settings))
    judgement = assess_law_stiffness(law, np.ravel(state["pressure"]).tolist(), h)
    heads = [f"{name} [{LAW_OUTPUT_UNITS[name]}]" for name in names]
    cells = [heads, *(["-" if row[n] is None else f"{row[n]:.6g}" for n in names] for row in rows)]
    notes, warnings = explain_law_outputs(law)
    return CommandResult(
        json_document={"law": args.law, "parameters": flatten_parameters(law), "rows": rows},
        output_lines=[*align_columns(cells, 0), *notes],
        stiffness_judgement=judgement.prepend_warnings(warnings),
    )


def _read_finite_entry(result_column: Any, row_index: int) -> float | None:
    """Value of a result column in one row (a single value holds for all rows); None if it is not finite."""
    value = float(
        np.broadcast_to(
            result_column, (row_index + 1,) if np.ndim(result_column) == 0 else np.shape(result_column)
        )[row_index]
    )
    return value if math.isfinite(value) else None
