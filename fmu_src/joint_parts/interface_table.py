"""Points of the interface law `table` as data of an FMU, so that all tables share the compiled code."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, make_dataclass
from functools import cache
from typing import Any, ClassVar

import numpy as np

from jointfmu.contact.laws.table import MAX_TABLE_POINTS, LogSpline, StiffnessTable
from jointfmu.quantity import Number, flatten_parameters, group_field, quantity_field


@dataclass(frozen=True, kw_only=True)
class _SplineNumbers:
    """First point, last pressure and spline of a `StiffnessTable`, as single numbers.

    Subclasses add one field for each number of the spline.
    """

    columns: ClassVar[Mapping[str, tuple[str, ...]]] = {
        column: tuple(f"{column}_{i}" for i in range(MAX_TABLE_POINTS)) for column in LogSpline._fields
    }
    """{column of the spline: names of its numbers}."""

    first_pressure: float = quantity_field("Pa", "pressure of the first point", gt=0.0)
    first_stiffness: float = quantity_field("Pa/m", "stiffness of the first point", gt=0.0)
    last_pressure: float = quantity_field("Pa", "pressure of the last point", gt=0.0)

    @property
    def first_point(self) -> tuple[Number, Number]:
        """Pressure [Pa] and stiffness [Pa/m] of the first point."""
        return self.first_pressure, self.first_stiffness

    @property
    def spline(self) -> LogSpline:
        """Spline of the log-stiffness over the log-pressure, from its numbers."""
        return LogSpline(*([getattr(self, name) for name in names] for names in self.columns.values()))


_NUMBER_FIELDS = [
    (name, float, quantity_field("1", f"{column} of the spline at point {i}"))
    for column, names in _SplineNumbers.columns.items()
    for i, name in enumerate(names)
]
"""Dataclass fields for the numbers of the spline."""
_STATED_FIELDS = [
    (item.name, float, field(metadata=item.metadata, default=item.default))
    for item in fields(StiffnessTable)
    if "series" not in item.metadata
]
"""Dataclass fields of `StiffnessTable` that are single numbers: ratio and factor."""
_TableLawNumbers = make_dataclass(
    "_TableLawNumbers",
    [*_NUMBER_FIELDS, *_STATED_FIELDS],
    bases=(_SplineNumbers,),
    frozen=True,
    kw_only=True,
)
"""Section [table] of the parameter set with which the C code is generated."""


def _find_table(parameters: object) -> StiffnessTable | None:
    """Points of the stiffness in a parameter set with the law `table`; None for another law."""
    table = getattr(parameters, "table", None)
    return table if isinstance(table, StiffnessTable) else None


def find_code_class(parameters: object) -> type[object]:
    """Class of the parameter set for the C code: a spline replaces the points of a stiffness table."""
    cls = type(parameters)
    return cls if _find_table(parameters) is None else _class_with_numbers(cls)  # type: ignore[arg-type]


@cache
def _class_with_numbers(cls: Any) -> type[object]:
    """Class of a parameter set in which the spline's numbers replace the points of the table."""
    section = ("table", _TableLawNumbers, group_field("spline of the stiffness over the pressure"))
    return make_dataclass(cls.__name__, [section], bases=(cls,), frozen=True, kw_only=True)


def replace_points(parameters: object) -> Mapping[str, Any]:
    """Replace the points of the table in {structured name: value} by the numbers of their spline.

    Tables with fewer points repeat the first one, which adds segments without length.
    """
    values, table = flatten_parameters(parameters), _find_table(parameters)
    if table is None:
        return values
    missing = MAX_TABLE_POINTS - len(table.pressure)
    numbers = dict(zip(("first_pressure", "first_stiffness"), table.first_point, strict=True))
    numbers["last_pressure"] = table.last_pressure
    for names, column in zip(_SplineNumbers.columns.values(), table.spline, strict=True):
        numbers |= dict(zip(names, np.pad(column, (missing, 0), mode="edge").tolist(), strict=True))
    points = ("table.pressure", "table.stiffness")
    return {name: value for name, value in values.items() if name not in points} | {
        f"table.{name}": value for name, value in numbers.items()
    }
