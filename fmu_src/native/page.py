"""Documentation page of an FMU: connection, law, limits, warnings and parameters of its joint."""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from jointfmu import __version__
from jointfmu.joints.model import Model, TabulatedJoint
from jointfmu.mechanics.steps import largest_stable_steps
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import describe_range, find_problem, flat_fields
from jointfmu.quantity.units import UNITS, display_unit

from ..folders import asset, parts_of
from ..joint_parts import RampPanel, chart
from ..joint_parts.terminals import Terminal
from ..licence import licences
from ..templates import law_terms, template
from ..xml_parts import list_variables
from .terminals import terminals

_POINTS = 41


class _ParameterRow(NamedTuple):
    """Row of the table of parameters; all fields but the value are text."""

    name: str
    value: Any
    unit: str
    allowed: str
    doc: str
    kind: str
    source: str


_STIFFNESS = {"N.m/rad": "kg.m2", "N/m": "kg"}
_BODIES = {"kg.m2": (0.01, 0.1, 1.0, 10.0), "kg": (1.0, 10.0, 100.0, 1000.0)}
"""{unit: inertias or masses} for which the page lists the largest stable steps."""


class _StableSteps(NamedTuple):
    """Largest stable steps of a body on the joint, with the stiffness at the end of the load ramp.

    inertia_unit : unit of the inertias
    rows         : (inertia, step with a sequential master [s], step with a parallel master [s])
    """

    name: str
    stiffness: float
    unit: str
    inertia: str
    rows: Sequence[tuple[float, float, float]]


def documentation(model: Model, parameters: ParameterFile) -> dict[str, bytes]:
    """{path: content} of the folder documentation, the same for FMI 2.0 and 3.0."""
    source = model, parameters, asset(model, "page.html")
    page = plain_page(*source, terminals(model)) if model.is_time_dependent else _page(*source)
    return {"index.html": page.encode(), **licences()}


def plain_page(model: Model, parameters: ParameterFile, page: Path, flanges: Sequence[Terminal] = ()) -> str:
    """Render a page that lists the variables only, from the template at `template_path`."""
    return template(page, Path(__file__).parent).render(
        model=model,
        version=__version__,
        variables=list_variables(model, parameters),
        terminals=flanges,
    )


def _page(model: Model, parameters: ParameterFile, page: Path) -> str:
    """Render the page of a joint from the template at `template_path`."""
    spring = model.tabulate(parameters.values)
    rest = {v.name: parameters.start_value(v.name) for v in model.inputs}
    model = model.with_load_range(spring, rest)
    variables = list_variables(model, parameters)
    exposed = model.parameter_fields()
    rows = _rows(parameters)
    return template(page, Path(__file__).parent).render(
        model=model,
        spring=spring,
        fmu=True,
        **law_terms(parameters),
        file=parameters,
        version=__version__,
        inputs=[v for v in variables if v.causality == "input"],
        outputs=[v for v in variables if v.causality == "output"],
        exposed=[row for row in rows if row.name in exposed],
        hidden=[row for row in rows if row.name not in exposed],
        terminals=terminals(model),
        messages=_messages(model, spring, rest),
        figure=_figure(model, spring, rest),
        drawings=drawings(model, spring),
        steps=_steps(model, spring, rest, parameters),
        style=chart.style(),
        script=chart.script("figures") + "drawAll();",
        ramp_unit=next(v.unit for v in model.inputs if v.name == model.ramp.input),
    )


def _rows(parameters: ParameterFile) -> list[_ParameterRow]:
    """Rows of the table of all parameters."""
    fields, rows = dict(flat_fields(type(parameters.values))), []
    for name, value in parameters.values_by_name.items():
        meta = fields[name].metadata
        if "allowed" in meta:
            allowed = ", ".join(str(a).lower() for a in meta["allowed"])
        else:
            allowed = "1, 2, 3, ..." if meta.get("whole") else str(meta["interval"])
        if isinstance(value, tuple):
            value = describe_range(value)
        kind, source = parameters.origins.get(name, "user"), parameters.sources.get(name, "default choice")
        rows.append(_ParameterRow(name, value, meta.get("unit", ""), allowed, meta["doc"], kind, source))
    return rows


def _steps(
    model: Model, spring: TabulatedJoint, rest: Mapping[str, float], parameters: ParameterFile
) -> _StableSteps | None:
    """Largest stable communication steps of a joint with a body, at the end of the load ramp.

    They follow from the largest stiffness and its damping by `stable_steps`: for a sequential master, which
    passes on the force before the body steps, and for a parallel master with `lag_b` = 1. None: no input is a
    speed, so the joint has no such limit.
    """
    stiffnesses = [v for v in model.outputs if v.unit in _STIFFNESS]
    if not stiffnesses or not any(v.unit in ("rad/s", "m/s") for v in model.inputs):
        return None
    unit = stiffnesses[0].unit
    first, *others = (v.name for v in stiffnesses if v.unit == unit)
    axes = [name for name in others if re.fullmatch(r"K_(.)\1", first) and re.fullmatch(r"K_(.)\1", name)]
    outputs = evaluated(model, spring, {**rest, model.ramp.input: model.ramp.end})
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
    for J in _BODIES[_STIFFNESS[unit]]:
        at_once, side_by_side = largest_stable_steps(K, d, 1.0 / J)
        rows.append((J, _short(float(at_once)), _short(float(side_by_side))))
    return _StableSteps(name, _short(K), unit, _STIFFNESS[unit], rows)


def _short(number: float) -> float:
    """Round a number to three significant digits."""
    return float(f"{number:.3g}")


def _messages(model: Model, spring: TabulatedJoint, rest: Mapping[str, float]) -> list[tuple[str, str, str]]:
    """(level, example, meaning) of the messages that an instance may log."""
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
        for text in _warnings(model, spring, rest)
    ]


def _warnings(model: Model, spring: TabulatedJoint, rest: Mapping[str, float]) -> list[str]:
    """Example of each warning: end of the load ramp, one variable 10 % beyond its validity limit."""
    inputs = {**rest, model.ramp.input: model.ramp.end}
    values = inputs | evaluated(model, spring, inputs)
    warnings = []
    for i, outside in enumerate(model.validity_limits):
        low, high = outside.interval(spring.joint, spring.curve.end, values)
        value = 1.1 * high if np.isfinite(high) else low - 0.1 * model.ramp.end
        warnings.append(model.find_warnings(spring, values | {outside.variable: float(value)})[i])
    return warnings


def evaluated(model: Model, spring: TabulatedJoint, inputs: Mapping[str, float]) -> dict[str, float]:
    """{output: value} of a tabulated joint at given inputs."""
    return {name: float(value) for name, value in model.evaluate(spring, inputs).items()}


def panels(model: Model) -> tuple[RampPanel, ...]:
    """Charts of the load ramp; default: the first output against the ramped input."""
    charts = parts_of(model).panels.get(model.name)
    return charts or (RampPanel(model.ramp.input, (model.outputs[0].name,)),)


def _figure(model: Model, spring: TabulatedJoint, rest: Mapping[str, float]) -> str:
    """HTML element with the charts of the load ramp; the other inputs keep their start values."""
    points = [{**rest, model.ramp.input: float(x)} for x in model.ramp.sample_inputs(_POINTS)]
    rows = [point | evaluated(model, spring, point) for point in points]
    variables = {v.name: v for v in (*model.inputs, *model.outputs)}

    def column(name: str, shown: str) -> list[float]:
        factor = UNITS[variables[name].unit].display[shown]
        return [factor * row[name] for row in rows]

    charts = []
    for over, names in panels(model):
        x, y = (display_unit(variables[n].unit, variables[n].nominal) for n in (over, names[0]))
        lines = [chart.Series(name, column(over, x), column(name, y)) for name in names]
        title = ", ".join(names)
        charts.append(chart.Panel(f"{title} over {over}", f"{over} [{x}]", f"{title} [{y}]", lines))
    return chart.element(charts)


def drawings(model: Model, spring: TabulatedJoint) -> dict[str, str]:
    """{name: HTML element} of the further charts of a page."""
    drawings = parts_of(model).drawings.get(model.name, {})
    return {name: chart.element(panels(spring, model.ramp.end)) for name, panels in drawings.items()}
