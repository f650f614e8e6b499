"""Text display of numbers: display units, aligned tables, entries of a parameter file with their sources."""

import re
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from jointfmu.contact.roughness import HEIGHT_FIELDS
from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import describe_range, flatten_fields
from jointfmu.quantity.units import conversion_factor, display_unit

STIFFNESS_DISPLAY_UNITS = {"N.m/rad": "N.m/rad", "N/m": "N/um"}
"""Display units of stiffnesses on all pages: {SI unit: display unit}. Large stiffnesses have a prefix.

Other display units depend on the value."""
_MIN_PREFIX_VALUES = {"M": 1e7, "k": 1e4}
"""{prefix of a display unit of stiffness: value from which it is used}: 13.3 kN/um, not 1.33e+04 N/um."""


def choose_display_unit(si_unit: str, typical_value: float) -> str:
    """Choose the display unit of a variable by a typical value in SI units."""
    if si_unit not in STIFFNESS_DISPLAY_UNITS:
        return display_unit(si_unit, typical_value)
    shown = STIFFNESS_DISPLAY_UNITS[si_unit]
    value = abs(typical_value) * conversion_factor(si_unit, shown)
    prefix = next((prefix for prefix, least in _MIN_PREFIX_VALUES.items() if value >= least), "")
    return f"{prefix}{shown}"


def format_unit(si_unit: str) -> str:
    """Format a unit for display: N m, µm; empty for 1."""
    return "" if si_unit == "1" else re.sub(r"\bu(?=[mNsJr])", "µ", si_unit.replace(".", " "))


def format_quantity(si_value: Any, si_unit: str | None, significant_digits: int = 6) -> tuple[str, str]:
    """Format a value with its display unit; returns the text of the number and the unit."""
    if isinstance(si_value, bool | str):
        return str(si_value).lower(), ""
    if np.ndim(si_value):
        return describe_range(si_value), format_unit(si_unit or "1") if len(si_value) else ""
    if si_unit is None:
        return f"{si_value:g}", ""
    shown = choose_display_unit(si_unit, si_value)
    return f"{conversion_factor(si_unit, shown) * si_value:.{significant_digits}g}", format_unit(shown)


def align_columns(text_rows: Sequence[Sequence[str]], text_column_count: int | None = None) -> list[str]:
    """Format rows of text cells as lines, columns as wide as their widest cell.

    text_column_count : number of columns of words at the left, aligned left; the others are aligned right;
                        None: all columns are words
    """
    widths = [max(map(len, column)) for column in zip(*text_rows, strict=True)]
    signs = ["<" if text_column_count is None or i < text_column_count else ">" for i in range(len(widths))]
    pattern = "  ".join(f"{{:{sign}{width}}}" for sign, width in zip(signs, widths, strict=True))
    return [pattern.format(*row).rstrip() for row in text_rows]


def format_derived_values(derived_values: Mapping[str, tuple[float, str, str]]) -> list[str]:
    """Format derived values of a joint, {name: (value, unit, meaning)}, as lines of text.

    If a meaning begins, up to its colon, as that of the line before, this part is replaced by dots.
    """
    lines, last_head = [], ""
    for name, (value, unit, text) in derived_values.items():
        head, colon, rest = text.partition(": ")
        shown = f"... {rest}" if colon and head == last_head else text
        last_head = head
        lines.append(f"{name:18} {value:.4g}{'' if unit == '1' else f' {unit}'}  {shown}")
    return lines


def derived_values_to_json(derived_values: Mapping[str, tuple[float, str, str]]) -> dict[str, object]:
    """Convert derived values of a joint, {name: (value, unit, meaning)}, to a JSON object."""
    return {name: {"value": v, "unit": u, "text": t} for name, (v, u, t) in derived_values.items()}


class ParameterFileEntry(NamedTuple):
    """Entry of a parameter file: a number in SI units or a choice, with meaning, origin and source.

    si_unit      : SI unit; None for a choice
    value_origin : kind of source, one of parameters.VALUE_ORIGINS
    """

    entry_name: str
    entry_value: Any
    si_unit: str | None
    entry_meaning: str
    value_origin: str
    value_source: str


def _format_source(parameter_file: ParameterFile, parameter_name: str) -> str:
    """Format the source of a number, with the range that the file states for it."""
    text = parameter_file.describe_source(parameter_name)[1]
    low, high = parameter_file.ranges.get(parameter_name, (0.0, 0.0))
    return f"{low:g} to {high:g}; {text}" if high > low else text


def list_parameter_file_entries(parameter_file: ParameterFile) -> list[ParameterFileEntry]:
    """List all entries of a parameter file: parameters, start values of inputs, roughnesses."""
    fields: dict[str, Mapping[str, Any]] = {
        name: item.metadata for name, item in flatten_fields(type(parameter_file.values))
    }
    fields |= {parameter_file.heights_prefix + name: item.metadata for name, item in HEIGHT_FIELDS.items()}
    inputs = (v for model in KINDS[parameter_file.joint].models for v in model.inputs)
    fields |= {f"inputs.{v.name}": {"unit": v.unit, "doc": v.doc} for v in inputs}
    values = dict(parameter_file.values_by_name)
    values |= {f"inputs.{name}": value for name, value in parameter_file.inputs.items()}
    values |= {
        parameter_file.heights_prefix + name: value for name, value in parameter_file.roughness.items()
    }
    return [
        ParameterFileEntry(
            name,
            value,
            fields[name].get("unit"),
            fields[name]["doc"],
            parameter_file.describe_source(name)[0],
            _format_source(parameter_file, name),
        )
        for name, value in values.items()
    ]
