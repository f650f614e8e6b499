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

from ..folders import find_asset, find_fmu_parts
from ..joint_parts import RampPanel, chart
from ..joint_parts.terminals import Terminal
from ..licence import licence_files
from ..templates import law_variables, load_template
from ..xml_parts import list_variables
from .terminals import find_terminals

_RAMP_POINT_COUNT = 41
"""Number of points of the load ramp in the charts [1]."""


class _ParameterRow(NamedTuple):
    """Row of the table of parameters; all fields but the value are text."""

    name: str
    value: Any
    unit: str
    allowed_values: str
    doc: str
    origin: str
    source: str


_INERTIA_UNITS = {"N.m/rad": "kg.m2", "N/m": "kg"}
"""{unit of a stiffness: unit of the inertia of a body on it}."""
_EXAMPLE_INERTIAS = {"kg.m2": (0.01, 0.1, 1.0, 10.0), "kg": (1.0, 10.0, 100.0, 1000.0)}
"""{unit: inertias or masses} for which the page lists the largest stable steps."""


class _StableSteps(NamedTuple):
    """Largest stable steps of a body on the joint, with the stiffness at the end of the load ramp.

    inertia_unit : unit of the inertias
    rows         : (inertia, step with a sequential master [s], step with a parallel master [s])
    """

    name: str
    stiffness: float
    unit: str
    inertia_unit: str
    rows: Sequence[tuple[float, float, float]]


def make_documentation(model: Model, parameters: ParameterFile) -> dict[str, bytes]:
    """Make {path: content} of the folder documentation of an FMU: page, licences, images."""
    source = model, parameters, find_asset(model, "page.html")
    page = (
        render_variables_page(*source, find_terminals(model))
        if model.is_time_dependent
        else _render_joint_page(*source)
    )
    return {"index.html": page.encode(), **licence_files()}


def render_variables_page(
    model: Model, parameters: ParameterFile, template_path: Path, flanges: Sequence[Terminal] = ()
) -> str:
    """Render a page that lists the variables only, from the template at `template_path`."""
    return load_template(template_path, Path(__file__).parent).render(
        model=model,
        version=__version__,
        variables=list_variables(model, parameters),
        terminals=flanges,
    )


def _render_joint_page(model: Model, parameters: ParameterFile, template_path: Path) -> str:
    """Render the page of a joint from the template at `template_path`."""
    spring = model.tabulate(parameters.values)
    rest = {v.name: parameters.start_value(v.name) for v in model.inputs}
    model = model.with_load_range(spring, rest)
    variables = list_variables(model, parameters)
    exposed = model.parameter_fields()
    rows = _parameter_rows(parameters)
    return load_template(template_path, Path(__file__).parent).render(
        model=model,
        spring=spring,
        fmu=True,
        **law_variables(parameters),
        file=parameters,
        version=__version__,
        inputs=[v for v in variables if v.causality == "input"],
        outputs=[v for v in variables if v.causality == "output"],
        exposed=[row for row in rows if row.name in exposed],
        hidden=[row for row in rows if row.name not in exposed],
        terminals=find_terminals(model),
        messages=_list_log_messages(model, spring, rest),
        figure=_draw_ramp(model, spring, rest),
        drawings=draw_further_charts(model, spring),
        steps=_find_stable_steps(model, spring, rest, parameters),
        style=chart.read_style(),
        script=chart.read_script("figures") + "drawAll();",
        ramp_unit=next(v.unit for v in model.inputs if v.name == model.ramp.input_name),
    )


def _parameter_rows(parameters: ParameterFile) -> list[_ParameterRow]:
    """Rows of the table of all parameters."""
    fields, rows = dict(flatten_fields(type(parameters.values))), []
    for name, value in parameters.values_by_name.items():
        meta = fields[name].metadata
        if "allowed" in meta:
            allowed = ", ".join(str(a).lower() for a in meta["allowed"])
        else:
            allowed = "1, 2, 3, ..." if meta.get("whole") else str(meta["interval"])
        if isinstance(value, tuple):
            value = describe_range(value)
        kind, source = parameters.describe_source(name)
        rows.append(_ParameterRow(name, value, meta.get("unit", ""), allowed, meta["doc"], kind, source))
    return rows


def _find_stable_steps(
    model: Model,
    tabulated_joint: TabulatedJoint,
    start_values: Mapping[str, float],
    parameters: ParameterFile,
) -> _StableSteps | None:
    """Largest stable communication steps of a joint with a body, at the end of the load ramp.

    The steps follow from the largest stiffness and its damping by `stable_steps`: for a sequential master,
    which passes on the force before the body steps, and for a parallel master with `lag_b` = 1. None: no
    input is a speed, so the joint has no such limit.
    """
    stiffnesses = [v for v in model.outputs if v.unit in _INERTIA_UNITS]
    if not stiffnesses or not any(v.unit in ("rad/s", "m/s") for v in model.inputs):
        return None
    unit = stiffnesses[0].unit
    first, *others = (v.name for v in stiffnesses if v.unit == unit)
    axes = [name for name in others if re.fullmatch(r"K_(.)\1", first) and re.fullmatch(r"K_(.)\1", name)]
    outputs = evaluate_outputs(
        model, tabulated_joint, {**start_values, model.ramp.input_name: model.ramp.end_value}
    )
    K, name = max((outputs[name], name) for name in (first, *axes))
    if not K > 0.0:
        return None
    is_damped = parameters.values_by_name.get("damping", True)
    d = (
        float(parameters.values_by_name.get("d", outputs.get(name.replace("K", "C", 1), 0.0)))
        if is_damped
        else 0.0
    )
    rows = []
    for J in _EXAMPLE_INERTIAS[_INERTIA_UNITS[unit]]:
        at_once, side_by_side = largest_stable_steps(K, d, 1.0 / J)
        rows.append((J, _round_to_three_digits(float(at_once)), _round_to_three_digits(float(side_by_side))))
    return _StableSteps(name, _round_to_three_digits(K), unit, _INERTIA_UNITS[unit], rows)


def _round_to_three_digits(number: float) -> float:
    """Round a number to three significant digits."""
    return float(f"{number:.3g}")


def _list_log_messages(
    model: Model, tabulated_joint: TabulatedJoint, start_values: Mapping[str, float]
) -> list[tuple[str, str, str]]:
    """List (level, example, meaning) of the messages that an instance of an FMU may log."""
    name, item = next(iter(model.parameter_fields().items()))
    v = model.inputs[0]
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
            f"{v.name} = 1e+308: too large, {model.outputs[0].name} is not finite",
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
        for text in _example_warnings(model, tabulated_joint, start_values)
    ]


def _example_warnings(
    model: Model, tabulated_joint: TabulatedJoint, start_values: Mapping[str, float]
) -> list[str]:
    """Example of each warning of a joint: at the end of the load ramp, one variable 10 % beyond its limit."""
    inputs = {**start_values, model.ramp.input_name: model.ramp.end_value}
    values = inputs | evaluate_outputs(model, tabulated_joint, inputs)
    warnings = []
    for i, outside in enumerate(model.validity_limits):
        low, high = outside.find_interval(tabulated_joint.joint, tabulated_joint.curve.end_point, values)
        value = 1.1 * high if np.isfinite(high) else low - 0.1 * model.ramp.end_value
        warnings.append(
            model.find_warnings(tabulated_joint, values | {outside.variable_name: float(value)})[i]
        )
    return warnings


def evaluate_outputs(
    model: Model, tabulated_joint: TabulatedJoint, inputs: Mapping[str, float]
) -> dict[str, float]:
    """{output: value} of a tabulated joint at given inputs."""
    return {name: float(value) for name, value in model.evaluate(tabulated_joint, inputs).items()}


def find_ramp_panels(model: Model) -> tuple[RampPanel, ...]:
    """Charts of the load ramp of a model. Default: the first output over the ramped input."""
    charts = find_fmu_parts(model).ramp_panels.get(model.name)
    return charts or (RampPanel(model.ramp.input_name, (model.outputs[0].name,)),)


def _draw_ramp(model: Model, tabulated_joint: TabulatedJoint, start_values: Mapping[str, float]) -> str:
    """Draw the load ramp as an HTML element; the other inputs keep their start values."""
    points = [
        {**start_values, model.ramp.input_name: float(x)} for x in model.ramp.sample_inputs(_RAMP_POINT_COUNT)
    ]
    rows = [point | evaluate_outputs(model, tabulated_joint, point) for point in points]
    variables = {v.name: v for v in (*model.inputs, *model.outputs)}

    def convert_column(variable_name: str, unit: str) -> list[float]:
        """Convert the values of a variable along the ramp to a unit of the chart."""
        factor = UNITS[variables[variable_name].unit].display_factors[unit]
        return [factor * row[variable_name] for row in rows]

    charts = []
    for over, names in find_ramp_panels(model):
        x, y = (display_unit(variables[n].unit, variables[n].nominal) for n in (over, names[0]))
        lines = [chart.Series(name, convert_column(over, x), convert_column(name, y)) for name in names]
        title = ", ".join(names)
        charts.append(chart.Panel(f"{title} over {over}", f"{over} [{x}]", f"{title} [{y}]", lines))
    return chart.make_figure(charts)


def draw_further_charts(model: Model, tabulated_joint: TabulatedJoint) -> dict[str, str]:
    """Draw the charts of an FMU's page except the load ramp: {name: HTML element}."""
    drawings = find_fmu_parts(model).chart_drawings.get(model.name, {})
    return {
        name: chart.make_figure(panels(tabulated_joint, model.ramp.end_value))
        for name, panels in drawings.items()
    }
