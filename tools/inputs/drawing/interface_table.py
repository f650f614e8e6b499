"""Points of the interface law `table` from a file: normal stiffness per area over contact pressure."""

from pathlib import Path

import numpy as np

from jointfmu.contact.laws.table import MAX_TABLE_POINTS, StiffnessTable
from jointfmu.quantity.units import unit_sizes

from ...common import columns
from .part import ParameterSheet

COLUMN_UNITS = {
    "pressure": unit_sizes("Pa", "kPa", "MPa"),
    **dict.fromkeys(
        ("stiffness", "stiffness_low", "stiffness_high"), unit_sizes("Pa/m", "MPa/um", "N/m3", "N/mm3")
    ),
    "ratio": unit_sizes("1"),
}
"""{column: allowed units}. Only pressure and stiffness are required."""
PLAUSIBLE_LENGTHS = 1e-10, 1e-3
"""Pressure over stiffness [m] of interfaces: about half the rms height of the roughness, or less."""


def add_interface_table(parameter_sheet: ParameterSheet, path: Path, default_ratio: float) -> None:
    """Add the points of a file to the parameters of a new joint.

    default_ratio : K_T/K_N [1] if the file has no column `ratio`

    Raises ValueError, one line: as `columns.read_columns` and `StiffnessTable` do; for a pressure over
    stiffness that no interface has; for a stiffness outside its column of limits.
    """
    data = columns.read_columns(path, COLUMN_UNITS, 2)
    p, K = (data.require_column(name, COLUMN_UNITS) for name in ("pressure", "stiffness"))
    data.check_positive(data.columns, COLUMN_UNITS)
    if p.size > MAX_TABLE_POINTS:
        raise ValueError(
            f"{path}: has {p.size} points, allowed are 2 to {MAX_TABLE_POINTS}; keep those between which the "
            "stiffness is about a power of the pressure"
        )
    low, high = PLAUSIBLE_LENGTHS
    if np.any(wrong := (p / K < low) | (p / K > high)):
        i = int(np.argmax(wrong))
        raise ValueError(
            f"{path}: line {data.line_numbers[i]}: pressure over stiffness = {p[i] / K[i]:.3g} m, plausible "
            f"for an interface is {low:g} to {high:g} m; check the units of both columns"
        )
    ratio = data.columns.get("ratio", np.array([default_ratio]))
    try:
        StiffnessTable(pressure=tuple(p.tolist()), stiffness=tuple(K.tolist()), ratio=float(np.mean(ratio)))
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
    source = f"points of {path.name}{_first_comment(path)}"
    parameter_sheet.add_parameter("table.pressure", tuple(p.tolist()), "user", source)
    parameter_sheet.add_parameter("table.stiffness", tuple(K.tolist()), "user", source)
    if "ratio" in data.columns:
        is_constant = np.min(ratio) == np.max(ratio)
        text = source if is_constant else f"{source}: mean of the column ratio, whose ends are the range"
        parameter_sheet.add_parameter("table.ratio", float(np.mean(ratio)), "user", text)
        if not is_constant:
            parameter_sheet.set_parameter_range("table.ratio", float(np.min(ratio)), float(np.max(ratio)))
    else:
        text = (
            "not measured; 4 G'/E* of elastic contact spots (Mindlin 1949), measured joints have 0.3 to 0.9"
        )
        parameter_sheet.add_parameter("table.ratio", default_ratio, "estimate", text)
    parameter_sheet.add_parameter("table.factor", 1.0, "default", "default choice: the points as they are")
    _add_level_range(parameter_sheet, data, source)


def _add_level_range(parameter_sheet: ParameterSheet, table_columns: columns.Columns, source: str) -> None:
    """Add the range of `table.factor` that the columns stiffness_low and stiffness_high state, if any."""
    K = table_columns.columns["stiffness"]
    low, high = (table_columns.columns.get(f"stiffness_{end}", K) for end in ("low", "high"))
    if np.any(wrong := (low > K) | (high < K)):
        i = int(np.argmax(wrong))
        raise ValueError(
            f"{table_columns.path}: line {table_columns.line_numbers[i]}: stiffness = {K[i]:g} Pa/m is "
            f"outside [{low[i]:g}, {high[i]:g}], its stiffness_low and stiffness_high"
        )
    ends = float(np.min(low / K)), float(np.max(high / K))
    if ends[0] < ends[1]:
        text = f"{source}: smallest stiffness_low and largest stiffness_high over stiffness are the range"
        parameter_sheet.add_parameter("table.factor", 1.0, "user", text)
        parameter_sheet.set_parameter_range("table.factor", *ends)


def _first_comment(path: Path) -> str:
    """Text after ": " in the first comment line of a file of points; empty if the file has none."""
    lines = (line.strip() for line in columns.read_text_lines(path))
    text = next((line.lstrip("# ") for line in lines if line.startswith("#")), "")
    return f": {text}" if text else ""
