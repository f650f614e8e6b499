"""Points of the interface law `table` from a file: normal stiffness per area over contact pressure."""

from pathlib import Path

import numpy as np

from jointfmu.contact.laws.table import MAX_TABLE_POINTS, StiffnessTable
from jointfmu.quantity.units import unit_sizes

from ...common import columns
from .part import ParameterSheet

INTERFACE_TABLE_COLUMN_UNITS = {
    "pressure": unit_sizes("Pa", "kPa", "MPa"),
    **dict.fromkeys(
        ("stiffness", "stiffness_low", "stiffness_high"), unit_sizes("Pa/m", "MPa/um", "N/m3", "N/mm3")
    ),
    "ratio": unit_sizes("1"),
}
"""{column: allowed units}. Only pressure and stiffness are required."""
PLAUSIBLE_PRESSURE_OVER_STIFFNESS = 1e-10, 1e-3
"""Pressure over stiffness [m] of interfaces: about half the rms height of the roughness, or less."""


def add_interface_table(
    parameter_sheet: ParameterSheet, table_path: Path, default_shear_stiffness_ratio: float
) -> None:
    """Add the points (pressure, stiffness) of an interface table in a file to the parameters of a new joint.

    default_shear_stiffness_ratio : tangential over normal stiffness K_T/K_N [1], used if the file has no
                                    column `ratio`

    Raises ValueError, one line: for a file that cannot be read, for points that the law `table` does not
    allow, for a ratio of pressure to stiffness that no interface has, and for a stiffness outside its limits
    stiffness_low and stiffness_high.
    """
    data = columns.read_columns(table_path, INTERFACE_TABLE_COLUMN_UNITS, 2)
    p, K = (data.require_column(name, INTERFACE_TABLE_COLUMN_UNITS) for name in ("pressure", "stiffness"))
    data.check_positive_columns(data.values_by_name, INTERFACE_TABLE_COLUMN_UNITS)
    if p.size > MAX_TABLE_POINTS:
        raise ValueError(
            f"{table_path}: has {p.size} points, allowed are 2 to {MAX_TABLE_POINTS}; leave out points that "
            "are near a power law through their neighbours"
        )
    low, high = PLAUSIBLE_PRESSURE_OVER_STIFFNESS
    if np.any(wrong := (p / K < low) | (p / K > high)):
        i = int(np.argmax(wrong))
        raise ValueError(
            f"{table_path}: line {data.line_numbers[i]}: pressure over stiffness = {p[i] / K[i]:.3g} m, "
            f"plausible for an interface is {low:g} to {high:g} m; check the units of both columns"
        )
    ratio = data.values_by_name.get("ratio", np.array([default_shear_stiffness_ratio]))
    try:
        StiffnessTable(pressure=tuple(p.tolist()), stiffness=tuple(K.tolist()), ratio=float(np.mean(ratio)))
    except ValueError as error:
        raise ValueError(f"{table_path}: {error}") from None
    source = f"points of {table_path.name}{_read_first_comment(table_path)}"
    parameter_sheet.add_parameter("table.pressure", tuple(p.tolist()), "user", source)
    parameter_sheet.add_parameter("table.stiffness", tuple(K.tolist()), "user", source)
    if "ratio" in data.values_by_name:
        is_constant = np.min(ratio) == np.max(ratio)
        text = source if is_constant else f"{source}: mean of the column ratio, whose ends are the range"
        parameter_sheet.add_parameter("table.ratio", float(np.mean(ratio)), "user", text)
        if not is_constant:
            parameter_sheet.set_parameter_range("table.ratio", float(np.min(ratio)), float(np.max(ratio)))
    else:
        text = (
            "not measured; 4 G'/E* of elastic contact spots (Mindlin 1949), measured joints have 0.2 to 0.5"
        )
        parameter_sheet.add_parameter("table.ratio", default_shear_stiffness_ratio, "estimate", text)
    parameter_sheet.add_parameter("table.factor", 1.0, "default", "default choice: the points as they are")
    _add_stiffness_factor_range(parameter_sheet, data, source)


def _add_stiffness_factor_range(
    parameter_sheet: ParameterSheet, table_columns: columns.TableColumns, points_source: str
) -> None:
    """Add the range of `table.factor`, a factor on all stiffnesses of an interface table, to a new joint.

    The range is that of the columns stiffness_low and stiffness_high over stiffness, if the file has them.
    """
    K = table_columns.values_by_name["stiffness"]
    low, high = (table_columns.values_by_name.get(f"stiffness_{end}", K) for end in ("low", "high"))
    if np.any(wrong := (low > K) | (high < K)):
        i = int(np.argmax(wrong))
        raise ValueError(
            f"{table_columns.table_path}: line {table_columns.line_numbers[i]}: stiffness = {K[i]:g} Pa/m "
            f"is outside [{low[i]:g}, {high[i]:g}], its stiffness_low and stiffness_high"
        )
    ends = float(np.min(low / K)), float(np.max(high / K))
    if ends[0] < ends[1]:
        text = (
            f"{points_source}: smallest stiffness_low and largest stiffness_high over stiffness are the range"
        )
        parameter_sheet.add_parameter("table.factor", 1.0, "user", text)
        parameter_sheet.set_parameter_range("table.factor", *ends)


def _read_first_comment(table_path: Path) -> str:
    """Text after ": " in the first comment line of a file of points; empty if the file has none."""
    lines = (line.strip() for line in columns.read_text_lines(table_path))
    text = next((line.lstrip("# ") for line in lines if line.startswith("#")), "")
    return f": {text}" if text else ""
