"""Points of the interface law `table` as data of an FMU, so that all tables share the compiled code."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, make_dataclass
from functools import cache
from typing import Any, ClassVar

import numpy as np

from jointfmu.contact.laws.table import MAX_TABLE_POINTS, LogSpline, StiffnessTable
from jointfmu.quantity import Number, flatten_parameters, group_field, quantity_field


@dataclass(frozen=True, kw_only=True)
class _SplineTableParameters:
    """Parameters of the law `table` as single numbers, from which the spline of the stiffness is assembled.

    Subclasses add one field for each number of the spline.
    """

    number_names_by_spline_column: ClassVar[Mapping[str, tuple[str, ...]]] = {
        column: tuple(f"{column}_{i}" for i in range(MAX_TABLE_POINTS)) for column in LogSpline._fields
    }
    """{column of the spline: names of its numbers}."""

    first_pressure: float = quantity_field("Pa", "pressure of the first point", gt=0.0)
    first_stiffness: float = quantity_field("Pa/m", "stiffness of the first point", gt=0.0)
    last_pressure: float = quantity_field("Pa", "pressure of the last point", gt=0.0)

    @property
    def first_point(self) -> tuple[Number, Number]:
        """Pressure [Pa] and interface stiffness [Pa/m] of the first point of the table."""
        return self.first_pressure, self.first_stiffness

    @property
    def spline(self) -> LogSpline:
        """Spline of ln(stiffness) as a function of ln(pressure), assembled from the single numbers."""
        return LogSpline(
            *(
                [getattr(self, name) for name in names]
                for names in self.number_names_by_spline_column.values()
            )
        )


_SPLINE_NUMBER_FIELDS = [
    (name, float, quantity_field("1", f"{column} of the spline at point {i}"))
    for column, names in _SplineTableParameters.number_names_by_spline_column.items()
    for i, name in enumerate(names)
]
"""Dataclass fields for the numbers of the spline."""
_SINGLE_NUMBER_TABLE_FIELDS = [
    (item.name, float, field(metadata=item.metadata, default=item.default))
    for item in fields(StiffnessTable)
    if "series" not in item.metadata
]
"""Dataclass fields of `StiffnessTable` that are single numbers: ratio and factor."""
_TableLawSplineParameters = make_dataclass(
    "_TableLawSplineParameters",
    [*_SPLINE_NUMBER_FIELDS, *_SINGLE_NUMBER_TABLE_FIELDS],
    bases=(_SplineTableParameters,),
    frozen=True,
    kw_only=True,
)
"""Section [table] of the parameter set with which the C code is generated."""


def _find_stiffness_table(parameter_set: object) -> StiffnessTable | None:
    """Stiffness table of a parameter set with the law `table`; None for another law."""
    table = getattr(parameter_set, "table", None)
    return table if isinstance(table, StiffnessTable) else None


def find_code_parameter_class(parameter_set: object) -> type[object]:
    """Class of the parameter set with which C code is generated: splines replace stiffness tables."""
    cls = type(parameter_set)
    return cls if _find_stiffness_table(parameter_set) is None else _make_spline_table_parameter_class(cls)  # type: ignore[arg-type]


@cache
def _make_spline_table_parameter_class(cls: Any) -> type[object]:
    """Make a subclass of a parameter set in which numbers of the spline replace the points of the table."""
    section = ("table", _TableLawSplineParameters, group_field("spline of the stiffness over the pressure"))
    return make_dataclass(cls.__name__, [section], bases=(cls,), frozen=True, kw_only=True)


def replace_table_points(parameter_set: object) -> Mapping[str, Any]:
    """Parameters {structured name: value} with the points of a stiffness table replaced by spline numbers.

    The spline always has MAX_TABLE_POINTS points: a shorter table repeats its first point, which adds
    segments without length.
    """
    values, table = flatten_parameters(parameter_set), _find_stiffness_table(parameter_set)
    if table is None:
        return values
    missing = MAX_TABLE_POINTS - len(table.pressure)
    numbers = dict(zip(("first_pressure", "first_stiffness"), table.first_point, strict=True))
    numbers["last_pressure"] = table.last_pressure
    for names, column in zip(
        _SplineTableParameters.number_names_by_spline_column.values(), table.spline, strict=True
    ):
        numbers |= dict(zip(names, np.pad(column, (missing, 0), mode="edge").tolist(), strict=True))
    points = ("table.pressure", "table.stiffness")
    return {name: value for name, value in values.items() if name not in points} | {
        f"table.{name}": value for name, value in numbers.items()
    }
