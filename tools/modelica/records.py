"""What the library holds of one joint: its component, the records of the package Data that fill it in,
tables; how Modelica writes numbers and texts.
"""

import re
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from jointfmu_fmu_src.naming import reserved
from numpy.typing import NDArray

from jointfmu.mechanics.curve import Curve
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array

from ..thinning import kept

GIVEN, COMPUTED = 15, 10
"""Digits of numbers that a file gives, and of those computed from them: later digits depend on the
processor, and the tables err by 1e-7."""


def number(value: float, digits: int = GIVEN) -> str:
    """A number, or a Boolean."""
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value + 0.0:.{digits}g}"


def matrix(rows: NDArray[np.float64]) -> str:
    """A matrix of computed numbers, one row per line."""
    lines = (", ".join(number(x, COMPUTED) for x in row) for row in rows)
    return "[\n      " + ";\n      ".join(lines) + "]"


def text(content: str) -> str:
    """The inside of a Modelica string; it ends with no backslash, which simple readers misread."""
    content += " " * content.endswith("\\")
    return content.replace("\\", "\\\\").replace('"', '\\"')


def html(content: str) -> str:
    """A plain text in the HTML of a documentation annotation, which is a Modelica string."""
    return text(escape(content, quote=False))


def identifier(name: str) -> str:
    """A Modelica identifier of a title."""
    words = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_")
    plain = words[:1].isalpha() and not reserved(words) and words.lower() != "package"
    return words[0].upper() + words[1:] if plain else f"Joint_{words}"


def environment(*folders: Path) -> Environment:
    """Templates of the folders, then those of the library; an unknown name is an error."""
    return Environment(
        loader=FileSystemLoader([*folders, Path(__file__).parent / "templates"]),
        undefined=StrictUndefined,
        variable_start_string="<<",
        variable_end_string=">>",
        block_start_string="<%",
        block_end_string="%>",
        comment_start_string="<#",
        comment_end_string="#>",
        keep_trailing_newline=True,
        autoescape=False,
    )


TOLERANCE = 1e-7
"""Largest relative error of load and stiffness [1] against the package's curve."""
_INNER = np.linspace(0.0, 1.0, 9)[1:-1]


class InterpolationTable(NamedTuple):
    """A quintic spline: rows (n, 5) of displacement, load, stiffness, and its derivative before and after.

    error : [1] largest relative error of load and stiffness against what it was made of
    """

    rows: Array
    error: float


def curve_of(table: InterpolationTable) -> Curve:
    """The table as a curve of the package."""
    x, y, k, before, after = table.rows.T
    return Curve(x, y, k, after[:-1], before[1:])


def thinned(
    curve: Curve,
    reference: int = -1,
    keep: Collection[int] = (),
    fits: Callable[[int, int], bool] | None = None,
) -> InterpolationTable:
    """The fewest nodes of a curve, taken one after the other, that reproduce it within TOLERANCE.

    reference : node whose load and stiffness the errors refer to where the curve's own are smaller;
                -1: each value's own
    keep      : nodes that stay
    fits      : a further demand on the segment from one node to another
    """
    kinks = np.flatnonzero(curve.bend_end[:-1] != curve.bend_start[1:]) + 1
    stops = {*kinks.tolist(), *keep, curve.displacement.size - 1}
    floor = (0.0, 0.0) if reference < 0 else (curve.load[reference], curve.stiffness[reference])

    def reproduces(i: int, j: int) -> bool:
        close = _segment_error(curve, i, j, floor) <= TOLERANCE
        return close and (fits is None or fits(i, j))

    index = kept(stops, reproduces)
    worst = max(_segment_error(curve, i, j, floor) for i, j in pairwise(index.tolist()))
    before = np.concatenate([[curve.bend_start[0]], curve.bend_end[index[1:] - 1]])
    after = np.concatenate([curve.bend_start[index[:-1]], [curve.bend_end[-1]]])
    columns = [curve.displacement[index], curve.load[index], curve.stiffness[index], before, after]
    return InterpolationTable(np.column_stack(columns), worst)


def _segment_error(curve: Curve, i: int, j: int, floor: tuple[float, float]) -> float:
    """Largest relative error of one quintic from node i to node j."""
    ends = [i, j]
    quintic = Curve(
        curve.displacement[ends],
        curve.load[ends],
        curve.stiffness[ends],
        curve.bend_start[i : i + 1],
        curve.bend_end[j - 1 : j],
    )
    x = curve.displacement[i : j + 1]
    points = np.concatenate([x[1:-1], (x[:-1, None] + np.diff(x)[:, None] * _INNER).ravel()])
    worst = 0.0
    for exact, rough, least in zip(
        curve.derivatives(points), quintic.derivatives(points), floor, strict=True
    ):
        size = np.maximum(np.abs(exact), least)
        some = size > 0.0
        worst = max(worst, float(np.max(np.abs(rough - exact)[some] / size[some], initial=0.0)))
    return worst


WorkingPoint = tuple[float, ...]
"""Values of the inputs Kind.working_point of a joint, SI; empty for a joint that has none."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelicaRecord:
    """A joint as a table.

    name   : of the record, an identifier
    title  : the same as words
    table  : load over displacement
    values : {name in the base record: expression} besides the table
    more   : what the table's error refers to, where not to each value
    """

    name: str
    title: str
    table: InterpolationTable
    values: Mapping[str, str] = field(default_factory=dict)
    more: str = ""

    @property
    def end(self) -> float:
        """Largest load of the table."""
        return float(self.table.rows[-1, 1])

    def content(self, base: str) -> dict[str, object]:
        """What the template of records needs; `base` is the record that it extends."""
        return {
            "name": self.name,
            "title": text(self.title),
            "base": base,
            "values": {**self.values, "table": matrix(self.table.rows)},
            "about": html(f"From the parameters {self.title}."),
            "error": f"{max(self.table.error, TOLERANCE):.0e}",
            "more": self.more,
        }


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelicaComponent:
    """COMPONENT in the folder `modelica` of a joint.

    The templates lie beside it as in the library: Components/NAME.mo and Data/BASE.mo. The component's gets
    the meanings of parameters `meta` and of outputs `docs`, the FMU's page `html`, the name of its first
    record `record`, and `texts`.

    name    : of the component, and of the FMU that it stands for
    base    : of its records
    points  : working points of the records unless others are asked for
    records : (parameters, working points) -> a record for each, the first the component's own
    texts   : first record -> {name: text}
    flanges : names of its flanges
    of_system : parameters -> {parameter of the component: text} that a system sets beside the record
    held    : {input of the joint: parameter of the component} at which a system may hold it
    special : parameters of the joint that only these decide, not the record's table
    note    : HTML for the description of all components
    """

    name: str
    base: str
    points: Sequence[WorkingPoint] = ((),)
    records: Callable[[ParameterFile, Sequence[WorkingPoint]], list[ModelicaRecord]]
    texts: Callable[[ModelicaRecord], Mapping[str, str]]
    note: str = ""
    flanges: Sequence[str] = ("flange_a", "flange_b")
    of_system: Callable[[ParameterFile], Mapping[str, str]] = lambda file: {}
    held: Mapping[str, str] = field(default_factory=dict)
    special: Sequence[str] = ()


def given(values: Mapping[str, float]) -> dict[str, str]:
    """Values of a file as expressions."""
    return {name: number(value, GIVEN) for name, value in values.items()}


def computed(values: Mapping[str, float]) -> dict[str, str]:
    """Values computed from those of a file as expressions."""
    return {name: number(value, COMPUTED) for name, value in values.items()}
