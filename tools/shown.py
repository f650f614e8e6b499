"""Numbers as people read them: one unit for all stiffnesses, units spelled out, a file's with sources."""

import re
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from jointfmu.contact.roughness import DECLARED
from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import flat_fields, span
from jointfmu.quantity.units import display_unit, factor

STIFFNESSES = {"N.m/rad": "N.m/rad", "N/m": "N/um"}
"""{SI unit: the one in which every page shows it}; others have that in which they read best."""


def shown_unit(unit: str, typical: float) -> str:
    """The display unit of a variable of a typical size."""
    return STIFFNESSES.get(unit) or display_unit(unit, typical)


def spelled(unit: str) -> str:
    """A unit as it is read: N m, µm; nothing for 1."""
    return "" if unit == "1" else re.sub(r"\bu(?=[mNsJr])", "µ", unit.replace(".", " "))


def quantity(value: Any, unit: str | None, digits: int = 6) -> tuple[str, str]:
    """A value as text in the unit in which it reads best, and that unit."""
    if isinstance(value, bool | str):
        return str(value).lower(), ""
    if np.ndim(value):
        return span(value), spelled(unit or "1") if len(value) else ""
    if unit is None:
        return f"{value:g}", ""
    shown = shown_unit(unit, value)
    return f"{factor(unit, shown) * value:.{digits}g}", spelled(shown)


def aligned(rows: Sequence[Sequence[str]], words: int | None = None) -> list[str]:
    """Rows of cells as lines, columns as wide as their widest cell.

    words : so many columns are words, to the left, the others numbers, to the right; None: all are words
    """
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    signs = ["<" if words is None or i < words else ">" for i in range(len(widths))]
    pattern = "  ".join(f"{{:{sign}{width}}}" for sign, width in zip(signs, widths, strict=True))
    return [pattern.format(*row).rstrip() for row in rows]


def fact_lines(facts: Mapping[str, tuple[float, str, str]]) -> list[str]:
    """{name: (value, unit, meaning)} as lines."""
    return [
        f"{name:18} {value:.4g}{'' if unit == '1' else f' {unit}'}  {text}"
        for name, (value, unit, text) in facts.items()
    ]


def fact_document(facts: Mapping[str, tuple[float, str, str]]) -> dict[str, object]:
    """The same for --json."""
    return {name: {"value": v, "unit": u, "text": t} for name, (v, u, t) in facts.items()}


class Stated(NamedTuple):
    """A number or choice of a parameter file, in SI; `unit` is None of what has none."""

    name: str
    value: Any
    unit: str | None
    doc: str
    kind: str
    source: str


def _source(file: ParameterFile, name: str) -> str:
    """Where a number comes from, with the range that the file states for it."""
    text = file.sources.get(name, "default choice")
    low, high = file.ranges.get(name, (0.0, 0.0))
    return f"{low:g} to {high:g}; {text}" if high > low else text


def stated(file: ParameterFile) -> list[Stated]:
    """Every number of a file: parameters, start values of inputs, roughnesses."""
    fields: dict[str, Mapping[str, Any]] = {
        name: item.metadata for name, item in flat_fields(type(file.values))
    }
    fields |= {file.surfaces + name: item.metadata for name, item in DECLARED.items()}
    inputs = (v for model in KINDS[file.joint].models for v in model.inputs)
    fields |= {f"inputs.{v.name}": {"unit": v.unit, "doc": v.doc} for v in inputs}
    values = dict(file.flat)
    values |= {f"inputs.{name}": value for name, value in file.inputs.items()}
    values |= {file.surfaces + name: value for name, value in file.roughness.items()}
    return [
        Stated(
            name,
            value,
            fields[name].get("unit"),
            fields[name]["doc"],
            file.origins.get(name, "user"),
            _source(file, name),
        )
        for name, value in values.items()
    ]
