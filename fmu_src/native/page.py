"""Documentation page of an FMU: connection, law, limits, warnings and parameters of its joint."""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from jointfmu.joints.model import Model, TabulatedJoint
from jointfmu.mechanics.stable_steps import largest_stable_steps
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import describe_range, find_problem, flatten_fields
from jointfmu.quantity.units import UNITS, display_unit
from jointfmu.version import __version__

from ..folders import find_fmu_build_data, find_page_or_icon
from ..joint_parts import RampPanel, chart
from ..joint_parts.terminals import Terminal
from ..licence import read_licence_files
from ..templates import load_jinja_template, make_law_template_variables
from ..xml_parts import list_variables
from .terminals import find_terminals

_RAMP_CHART_POINT_COUNT = 41
"""Number of points of the load ramp in the charts [1]."""


class _ParameterRow(NamedTuple):
    """Row of the parameter table on the documentation page; all fields but the value are text."""

    parameter_name: str
    parameter_value: Any
    parameter_unit: str
    allowed_values: str
    parameter_description: str
    origin_kind: str
    source_text: str


_INERTIA_UNIT_BY_STIFFNESS_UNIT = {"N.m/rad": "kg.m2", "N/m": "kg"}
"""{unit of a stiffness: unit of the inertia of a body on it}."""
_EXAMPLE_INERTIAS = {"kg.m2": (0.01, 0.1, 1.0, 10.0), "kg": (1.0, 10.0, 100.0, 1000.0)}
"""{unit: inertias or masses} for which the page lists the largest stable steps."""


class _StableSteps(NamedTuple):
    """Table of the largest stable communication steps for bodies on a joint, on the documentation page.

    stiffness_name             : output with the largest stiffness
    largest_stiffness          : value of this output at the end of the load ramp
    inertia_unit               : unit of the inertias
    inertias_with_stable_steps : (inertia, step with a sequential co-simulation master [s], with a parallel
        master [s])
    """

    stiffness_name: str
    largest_stiffness: float
    stiffness_unit: str
    inertia_unit: str
    inertias_with_stable_steps: Sequence[tuple[float, float, float]]


def make_documentation(fmu_model: Model, parameter_file: ParameterFile) -> dict[str, bytes]:
    """Make the folder documentation of an FMU, {path: content}: page and licence texts."""
    source = fmu_model, parameter_file, find_page_or_icon(fmu_model, "page.html")
    page = (
        render_variables_page(*source, find_terminals(fmu_model))
        if fmu_model.is_time_dependent
        else _render_joint_page(*source)
    )
    return {"index.html": page.encode(), **read_licence_files()}


def render_variables_page(
    fmu_model: Model,
    parameter_file: ParameterFile,
    page_template_path: Path,
    flanges: Sequence[Terminal] = (),
) -> str:
    """Render a documentation page that only lists the variables of an FMU."""
    return load_jinja_template(page_template_path, Path(__file__).parent).render(
        model=fmu_model,
        version=__version__,
        variables=list_variables(fmu_model, parameter_file),
        terminals=flanges,
    )


def _render_joint_page(fmu_model: Model, parameter_file: ParameterFile, page_template_path: Path) -> str:
    """Render the documentation page of a joint's FMU from the template of the joint."""
    spring = fmu_model.tabulate(parameter_file.values)
    rest = {v.name: parameter_file.start_value(v.name) for v in fmu_model.inputs}
    fmu_model = fmu_model.with_load_range(spring, rest)
    variables = list_variables(fmu_model, parameter_file)
    exposed = fmu_model.parameter_fields()
    rows = _make_parameter_rows(parameter_file)
    return load_jinja_template(page_template_path, Path(__file__).parent).render(
        model=fmu_model,
        spring=spring,
        fmu=True,
        **make_law_template_variables(parameter_file),
        file=parameter_file,
        version=__version__,
        inputs=[v for v in variables if v.causality == "input"],
        outputs=[v for v in variables if v.causality == "output"],
        exposed=[row for row in rows if row.parameter_name in exposed],
        hidden=[row for row in rows if row.parameter_name not in exposed],
        terminals=find_terminals(fmu_model),
        messages=_list_log_messages(fmu_model, spring, rest),
        figure=_draw_load_ramp(fmu_model, spring, rest),
        drawings=draw_further_charts(fmu_model, spring),
        steps=_find_stable_steps(fmu_model, spring, rest, parameter_file),
        style=chart.read_chart_style(),
        script=chart.read_chart_script("figures") + "drawAll();",
        ramp_unit=next(v.unit for v in fmu_model.inputs if v.name == fmu_model.ramp.input_name),
    )


def _make_parameter_rows(parameter_file: ParameterFile) -> list[_ParameterRow]:
    """Make the rows of the parameter table on the documentation page."""
    fields, rows = dict(flatten_fields(type(parameter_file.values))), []
    for name, value in parameter_file.values_by_name.items():
        meta = fields[name].metadata
        if "allowed" in meta:
            allowed = ", ".join(str(a).lower() for a in meta["allowed"])
        else:
            allowed = "1, 2, 3, ..." if meta.get("whole") else str(meta["interval"])
        if isinstance(value, tuple):
            value = describe_range(value)
        kind, source = parameter_file.describe_source(name)
        rows.append(_ParameterRow(name, value, meta.get("unit", ""), allowed, meta["doc"], kind, source))
    return rows


def _find_stable_steps(
    fmu_model: Model,
    tabulated_joint: TabulatedJoint,
    start_values: Mapping[str, float],
    parameter_file: ParameterFile,
) -> _StableSteps | None:
    """Find the largest stable communication steps of a joint with a body, at the end of the load ramp.

    The steps follow from the largest stiffness and its damping: for a sequential co-simulation master, which
    passes on the force before the body steps, and for a parallel master, where the force is one step late
    (the body has `lag_b` = 1). Returns None if no input is a speed: the joint then has no such limit.
    """
    stiffnesses = [v for v in fmu_model.outputs if v.unit in _INERTIA_UNIT_BY_STIFFNESS_UNIT]
    if not stiffnesses or not any(v.unit in ("rad/s", "m/s") for v in fmu_model.inputs):
        return None
    unit = stiffnesses[0].unit
    first, *others = (v.name for v in stiffnesses if v.unit == unit)
    axes = [name for name in others if re.fullmatch(r"K_(.)\1", first) and re.fullmatch(r"K_(.)\1", name)]
    outputs = evaluate_outputs(
        fmu_model, tabulated_joint, {**start_values, fmu_model.ramp.input_name: fmu_model.ramp.end_value}
    )
    K, name = max((outputs[name], name) for name in (first, *axes))
    if not K > 0.0:
        return None
    is_damped = parameter_file.values_by_name.get("damping", True)
    d = (
        float(parameter_file.values_by_name.get("d", outputs.get(name.replace("K", "C", 1), 0.0)))
        if is_damped
        else 0.0
    )
    rows = []
    for J in _EXAMPLE_INERTIAS[_INERTIA_UNIT_BY_STIFFNESS_UNIT[unit]]:
        at_once, side_by_side = largest_stable_steps(K, d, 1.0 / J)
        rows.append((J, _round_to_three_digits(float(at_once)), _round_to_three_digits(float(side_by_side))))
    return _StableSteps(name, _round_to_three_digits(K), unit, _INERTIA_UNIT_BY_STIFFNESS_UNIT[unit], rows)


def _round_to_three_digits(real_number: float) -> float:
    """Round a number to three significant digits."""
    return float(f"{real_number:.3g}")


def _list_log_messages(
    fmu_model: Model, tabulated_joint: TabulatedJoint, start_values: Mapping[str, float]
) -> list[tuple[str, str, str]]:
    """List the messages that an instance of an FMU may log: (log level, example text, meaning)."""
    name, item = next(iter(fmu_model.parameter_fields().items()))
    v = fmu_model.inputs[0]
    parameter_error = find_problem(name, np.nan, item) or ""
    messages = [
        ("error", parameter_error, "A parameter is outside its interval, not a number or infinite."),
        (
            "error",
            f"{v.name} = nan {v.unit} is outside {v.interval}: {v.doc}",
            "An input is not a number, infinite or outside its interval.",
        ),
        (
            "error",
            f"{v.name} = 1e+308: the inputs are too large, the output {fmu_model.outputs[0].name} is not "
            "finite",
            "The inputs are finite, but the result is not.",
        ),
        (
            "error",
            "FUNCTION: what happened; what was expected",
            "A call of an FMI function in the wrong state or with wrong arguments.",
        ),
    ]
    return messages + [
        ("warning", text, "Logged once until reset; the call succeeds.")
        for text in _make_example_warnings(fmu_model, tabulated_joint, start_values)
    ]


def _make_example_warnings(
    fmu_model: Model, tabulated_joint: TabulatedJoint, start_values: Mapping[str, float]
) -> list[str]:
    """Make an example of each warning of a joint: one variable is 10 % beyond its validity limit.

    The other variables are those at the end of the load ramp.
    """
    inputs = {**start_values, fmu_model.ramp.input_name: fmu_model.ramp.end_value}
    values = inputs | evaluate_outputs(fmu_model, tabulated_joint, inputs)
    warnings = []
    for i, outside in enumerate(fmu_model.validity_limits):
        low, high = outside.find_interval(tabulated_joint.joint, tabulated_joint.curve.end_point, values)
        value = 1.1 * high if np.isfinite(high) else low - 0.1 * fmu_model.ramp.end_value
        warnings.append(
            fmu_model.find_warnings(tabulated_joint, values | {outside.variable_name: float(value)})[i]
        )
    return warnings


def evaluate_outputs(
    fmu_model: Model, tabulated_joint: TabulatedJoint, input_values: Mapping[str, float]
) -> dict[str, float]:
    """Evaluate the outputs {name: value} of a tabulated joint at given inputs."""
    return {name: float(value) for name, value in fmu_model.evaluate(tabulated_joint, input_values).items()}


def find_load_ramp_panels(fmu_model: Model) -> tuple[RampPanel, ...]:
    """Find the charts of the load ramp of an FMU. Default: the first output against the ramped input."""
    charts = find_fmu_build_data(fmu_model).load_ramp_panels.get(fmu_model.name)
    return charts or (RampPanel(fmu_model.ramp.input_name, (fmu_model.outputs[0].name,)),)


def _draw_load_ramp(
    fmu_model: Model, tabulated_joint: TabulatedJoint, start_values: Mapping[str, float]
) -> str:
    """Draw charts of the load ramp as an HTML element; the inputs without ramp keep their start values."""
    points = [
        {**start_values, fmu_model.ramp.input_name: float(x)}
        for x in fmu_model.ramp.sample_inputs(_RAMP_CHART_POINT_COUNT)
    ]
    rows = [point | evaluate_outputs(fmu_model, tabulated_joint, point) for point in points]
    variables = {v.name: v for v in (*fmu_model.inputs, *fmu_model.outputs)}

    def convert_ramp_column(variable_name: str, chart_unit: str) -> list[float]:
        """Convert the values of a variable along the ramp to a unit of the chart."""
        factor = UNITS[variables[variable_name].unit].display_factors[chart_unit]
        return [factor * row[variable_name] for row in rows]

    charts = []
    for over, names in find_load_ramp_panels(fmu_model):
        x, y = (display_unit(variables[n].unit, variables[n].nominal) for n in (over, names[0]))
        lines = [
            chart.Series(name, convert_ramp_column(over, x), convert_ramp_column(name, y)) for name in names
        ]
        title = ", ".join(names)
        charts.append(chart.Panel(f"{title} over {over}", f"{over} [{x}]", f"{title} [{y}]", lines))
    return chart.make_chart_element(charts)


def draw_further_charts(fmu_model: Model, tabulated_joint: TabulatedJoint) -> dict[str, str]:
    """Draw the charts of an FMU's documentation page except the load ramp: {chart name: HTML element}."""
    drawings = find_fmu_build_data(fmu_model).chart_drawings.get(fmu_model.name, {})
    return {
        name: chart.make_chart_element(panels(tabulated_joint, fmu_model.ramp.end_value))
        for name, panels in drawings.items()
    }
