"""Modelica component of a joint, its records in the package Data, interpolation tables; formatting."""

import re
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from jointfmu_fmu_src.naming import is_reserved_word
from numpy.typing import NDArray

from jointfmu.mechanics.curve import Curve
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array

from ..thinning import decimate_table

PARAMETER_DIGITS, COMPUTED_DIGITS = 15, 10
"""Digits of numbers from a parameter file, and of computed numbers. More digits of computed numbers would
depend on the processor; the error of the tables is 1e-7."""


def format_double_literal(value: float, significant_digits: int = PARAMETER_DIGITS) -> str:
    """Format a number or a Boolean as a Modelica expression."""
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value + 0.0:.{significant_digits}g}"


def format_matrix(matrix_rows: NDArray[np.float64]) -> str:
    """Format a matrix of computed numbers as a Modelica expression, one row per line."""
    lines = (", ".join(format_double_literal(x, COMPUTED_DIGITS) for x in row) for row in matrix_rows)
    return "[\n      " + ";\n      ".join(lines) + "]"


def escape_string(plain_text: str) -> str:
    """Escape a text for a Modelica string. A blank is added after a final backslash for simple parsers."""
    plain_text += " " * plain_text.endswith("\\")
    return plain_text.replace("\\", "\\\\").replace('"', '\\"')


def escape_html(plain_text: str) -> str:
    """Escape a plain text for the HTML of a documentation annotation, which is a Modelica string."""
    return escape_string(escape(plain_text, quote=False))


def make_identifier(record_title: str) -> str:
    """Make a Modelica identifier from the title of a record."""
    words = re.sub(r"[^A-Za-z0-9]+", "_", record_title).strip("_")
    plain = words[:1].isalpha() and not is_reserved_word(words) and words.lower() != "package"
    return words[0].upper() + words[1:] if plain else f"Joint_{words}"


def create_template_environment(*folders: Path) -> Environment:
    """Jinja environment with the templates of the folders, then of the library. Unknown names are errors."""
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


MAX_RELATIVE_TABLE_ERROR = 1e-7
"""Largest relative error [1] of load and stiffness of a table, against the original curve."""
_ERROR_SAMPLE_FRACTIONS = np.linspace(0.0, 1.0, 9)[1:-1]
"""Relative positions in a segment of a table [1] at which its error is measured."""


class InterpolationTable(NamedTuple):
    """Quintic spline of a load curve.

    table_rows         : (n, 5) displacement, load, stiffness, derivative of the stiffness before and after
                         the node
    max_relative_error : [1] largest relative error of load and stiffness against the original curve
    """

    table_rows: Array
    max_relative_error: float


def make_curve_of_table(interpolation_table: InterpolationTable) -> Curve:
    """Convert an interpolation table to a curve that can be evaluated."""
    x, y, k, before, after = interpolation_table.table_rows.T
    return Curve(x, y, k, after[:-1], before[1:])


def decimate_curve(
    load_curve: Curve,
    error_reference_node: int = -1,
    required_nodes: Collection[int] = (),
    is_segment_allowed: Callable[[int, int], bool] | None = None,
) -> InterpolationTable:
    """Select few nodes of a curve whose quintic spline reproduces it within MAX_RELATIVE_TABLE_ERROR.

    error_reference_node : errors are relative to the value at each point, or at this node if that is larger;
                           -1: always to the value at the point
    required_nodes       : nodes that are always selected
    is_segment_allowed   : (i, j) -> whether an additional condition allows a segment from node i to node j

    The nodes are selected one after the other.
    """
    kinks = np.flatnonzero(load_curve.stiffness_slope_end[:-1] != load_curve.stiffness_slope_start[1:]) + 1
    stops = {*kinks.tolist(), *required_nodes, load_curve.displacement.size - 1}
    floor = (
        (0.0, 0.0)
        if error_reference_node < 0
        else (load_curve.load[error_reference_node], load_curve.stiffness[error_reference_node])
    )

    def is_reproduced_by_quintic(segment_start_node: int, segment_end_node: int) -> bool:
        """Whether one quintic between two nodes reproduces the curve within MAX_RELATIVE_TABLE_ERROR."""
        accurate = (
            _segment_error(load_curve, segment_start_node, segment_end_node, floor)
            <= MAX_RELATIVE_TABLE_ERROR
        )
        return accurate and (
            is_segment_allowed is None or is_segment_allowed(segment_start_node, segment_end_node)
        )

    index = decimate_table(stops, is_reproduced_by_quintic)
    worst = max(_segment_error(load_curve, i, j, floor) for i, j in pairwise(index.tolist()))
    before = np.concatenate(
        [[load_curve.stiffness_slope_start[0]], load_curve.stiffness_slope_end[index[1:] - 1]]
    )
    after = np.concatenate(
        [load_curve.stiffness_slope_start[index[:-1]], [load_curve.stiffness_slope_end[-1]]]
    )
    columns = [
        load_curve.displacement[index],
        load_curve.load[index],
        load_curve.stiffness[index],
        before,
        after,
    ]
    return InterpolationTable(np.column_stack(columns), worst)


def _segment_error(
    load_curve: Curve,
    segment_start_node: int,
    segment_end_node: int,
    min_error_reference: tuple[float, float],
) -> float:
    """Largest relative error of load and stiffness if one quintic replaces a curve between two nodes.

    min_error_reference : smallest load and stiffness to which the errors are relative
    """
    ends = [segment_start_node, segment_end_node]
    quintic = Curve(
        load_curve.displacement[ends],
        load_curve.load[ends],
        load_curve.stiffness[ends],
        load_curve.stiffness_slope_start[segment_start_node : segment_start_node + 1],
        load_curve.stiffness_slope_end[segment_end_node - 1 : segment_end_node],
    )
    x = load_curve.displacement[segment_start_node : segment_end_node + 1]
    points = np.concatenate([x[1:-1], (x[:-1, None] + np.diff(x)[:, None] * _ERROR_SAMPLE_FRACTIONS).ravel()])
    worst = 0.0
    for exact, approximate, reference in zip(
        load_curve.derivatives(points), quintic.derivatives(points), min_error_reference, strict=True
    ):
        size = np.maximum(np.abs(exact), reference)
        positive = size > 0.0
        errors = np.abs(approximate - exact)[positive] / size[positive]
        worst = max(worst, float(np.max(errors, initial=0.0)))
    return worst


WorkingPoint = tuple[float, ...]
"""Values [SI] of the inputs `JointKind.working_point` of a joint; empty if the joint has no such inputs."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelicaRecord:
    """Modelica record of the library with the load table and the parameters of a joint.

    record_name         : identifier of the record
    record_title        : title in words
    interpolation_table : load over displacement
    value_expressions   : {name in the base record: Modelica expression} in addition to the table
    error_note          : text on the values to which the error of the table is relative; empty: to each value
                          itself
    """

    record_name: str
    record_title: str
    interpolation_table: InterpolationTable
    value_expressions: Mapping[str, str] = field(default_factory=dict)
    error_note: str = ""

    @property
    def max_load(self) -> float:
        """Largest load of the table [N or N.m]."""
        return float(self.interpolation_table.table_rows[-1, 1])

    def template_variables(self, base_record: str) -> dict[str, object]:
        """Variables of the template that renders a record of the library.

        base_record : name of the record that it extends
        """
        return {
            "name": self.record_name,
            "title": escape_string(self.record_title),
            "base": base_record,
            "values": {**self.value_expressions, "table": format_matrix(self.interpolation_table.table_rows)},
            "about": escape_html(f"From the parameters {self.record_title}."),
            "error": f"{max(self.interpolation_table.max_relative_error, MAX_RELATIVE_TABLE_ERROR):.0e}",
            "more": self.error_note,
        }


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelicaComponent:
    """Modelica component of a joint: MODELICA_COMPONENT in the folder `modelica` of the joint.

    This folder has the templates Components/NAME.mo and Data/BASE.mo. The template of the component gets the
    variables `meta` (meanings of the parameters), `docs` (meanings of inputs and outputs), `html` (sections
    of the FMU's page), `record` (name of the default record), and the result of `make_template_texts`.

    component_name : name of the component, and of the FMU that it replaces
    base_record    : name of the base record of its records
    default_working_points : default working points of the records
    make_records   : (parameter file, working points) -> one record for each; the first is the default record
    make_template_texts : default record -> {template variable: text}
    flange_names   : names of its flanges
    system_parameters         : parameter file -> {parameter of the component: text} that a system sets in
                                addition to the record
    system_parameter_units    : {parameter of `system_parameters`: unit}
    fixed_input_parameters    : {input of the joint: parameter of the component}, for inputs that a system may
                                hold constant
    component_only_parameters : parameters of the joint that do not change the table of the record
    package_note   : HTML for the description of the package of components
    """

    component_name: str
    base_record: str
    default_working_points: Sequence[WorkingPoint] = ((),)
    make_records: Callable[[ParameterFile, Sequence[WorkingPoint]], list[ModelicaRecord]]
    make_template_texts: Callable[[ModelicaRecord], Mapping[str, str]]
    package_note: str = ""
    flange_names: Sequence[str] = ("flange_a", "flange_b")
    system_parameters: Callable[[ParameterFile], Mapping[str, str]] = lambda file: {}
    system_parameter_units: Mapping[str, str] = field(default_factory=dict)
    fixed_input_parameters: Mapping[str, str] = field(default_factory=dict)
    component_only_parameters: Sequence[str] = ()


def format_parameter_values(parameter_values: Mapping[str, float]) -> dict[str, str]:
    """Format values of a parameter file as Modelica expressions: {name: expression}."""
    return {name: format_double_literal(value, PARAMETER_DIGITS) for name, value in parameter_values.items()}


def format_computed_values(computed_values: Mapping[str, float]) -> dict[str, str]:
    """Format computed values as Modelica expressions with rounded numbers: {name: expression}."""
    return {name: format_double_literal(value, COMPUTED_DIGITS) for name, value in computed_values.items()}
