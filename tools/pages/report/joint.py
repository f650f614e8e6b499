"""The report page of one joint: curves, loops, friction, sources of the numbers, validity."""

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from jointfmu_fmu_src.folders import find_page_or_icon
from jointfmu_fmu_src.joint_parts.chart import encode_panels
from jointfmu_fmu_src.native.page import draw_further_charts, find_load_ramp_panels
from jointfmu_fmu_src.templates import PAGE_TEMPLATE_FOLDER, load_jinja_template, make_law_template_variables

from jointfmu.files.writing import write_text
from jointfmu.joints import KINDS
from jointfmu.joints.model import Model, Variable
from jointfmu.parameters import VALUE_ORIGINS, ParameterFile
from jointfmu.progress import set_status_text
from jointfmu.quantity.units import conversion_factor
from jointfmu.version import __version__

from ...common.joint_parts import load_tool_module
from ...common.pressure import find_nominal_pressure_model, judge_joint_stiffness
from ...common.shown import (
    ParameterFileEntry,
    choose_display_unit,
    format_quantity,
    format_unit,
    list_parameter_file_entries,
)
from ...run.ramps.loops import HysteresisLoops
from .figure import ComparisonRow, Figure, Panel, Series, read_page_script, read_style_sheet
from .load_history import LoadHistory

_STIFFNESS_UNITS = ("N/m", "N.m/rad")
"""SI units of stiffnesses."""
_CONSTANT_STIFFNESS_RELATIVE_CHANGE = 0.02
"""Relative change of the stiffness over the load ramp [1], below which it is called constant."""


def summarise_joint(
    load_history: LoadHistory,
    hysteresis_loops: HysteresisLoops | None,
    parameter_entries: Sequence[ParameterFileEntry],
) -> str:
    """Summarise a joint in a few sentences: stiffness, hysteresis, estimated parameters.

    hysteresis_loops  : hysteresis loops; None for a joint without friction history
    parameter_entries : entries of the parameter file
    """
    lines = [f"A {KINDS[load_history.file.joint].title}.", _describe_stiffness(load_history)]
    if hysteresis_loops:
        lines.append(_describe_energy_loss(hysteresis_loops))
    count = Counter(entry.value_origin for entry in parameter_entries)
    uncertain = [f"{count[kind]} {text}" for kind, text in _ESTIMATED_ORIGINS.items() if count[kind]]
    if uncertain:
        total = sum(count.values())
        lines.append(
            f"Of its {total} parameters {' and '.join(uncertain)}; all are listed below with their sources."
        )
    return " ".join(line for line in lines if line)


_ESTIMATED_ORIGINS = {"estimate": "are estimates", "calibration": "were fitted"}
"""{origin of an uncertain parameter: end of the sentence that names such parameters}."""


def _format_value(si_value: float, si_unit: str) -> str:
    """Format a value with three digits in a display unit."""
    text, display_unit = format_quantity(si_value, si_unit, 3)
    return f"{float(text):.6g} {display_unit}"


_SETTLED_STIFFNESS_RELATIVE_CHANGE, _MAX_SETTLED_OVER_LARGEST_LOAD = 0.01, 0.8
"""Relative change [1] below which a stiffness counts as settled, and load from which it is settled over the
largest load [1], up to which the text states this load."""


def _describe_stiffness(load_history: LoadHistory) -> str:
    """Describe in a sentence how the stiffness changes along the load ramp; empty if no panel has one."""
    units = {v.name: v.unit for v in (*load_history.model.inputs, *load_history.model.outputs)}
    curves = [
        (over, name)
        for over, names in find_load_ramp_panels(load_history.model)
        for name in names
        if units[name] in _STIFFNESS_UNITS
    ]
    if not curves:
        return ""
    over, name = curves[0]
    columns = load_history.compute_ramp()
    first, last = (float(columns[name][i]) for i in (0, -1))
    end = f"{over} = {_format_value(float(columns[over][-1]), units[over])}"
    if abs(last - first) <= _CONSTANT_STIFFNESS_RELATIVE_CHANGE * abs(last):
        return f"The stiffness {name} is {_format_value(last, units[name])}, nearly constant up to {end}."
    start = _format_value(first, units[name]) if first > 0.0 else "zero"
    verb = "rises" if last > first else "falls"
    times = f", by a factor of {max(first, last) / min(first, last):.3g}" if min(first, last) > 0.0 else ""
    begin = f"{over} = {_format_value(float(columns[over][0]), units[over])}"
    loads, changing = columns[over], np.abs(columns[name] - last) > _SETTLED_STIFFNESS_RELATIVE_CHANGE * last
    settled = float(loads[np.flatnonzero(changing)[-1] + 1])
    if abs(settled) < _MAX_SETTLED_OVER_LARGEST_LOAD * abs(loads[-1]):
        start_of_plateau = f"{over} = {_format_value(settled, units[over])}{times}"
        end = f"{start_of_plateau}, and then changes by less than 1 % up to {end}"
        times = ""
    return (
        f"The stiffness {name} {verb} from {start} at {begin} to {_format_value(last, units[name])} "
        f"at {end}{times}. "
        "A constant spring would be right at one load only."
    )


def _describe_energy_loss(hysteresis_loops: HysteresisLoops) -> str:
    """Describe the energy loss of the largest loop in a sentence."""
    row = max(hysteresis_loops.compute_quantities_of_loops(), key=lambda row: row["motion"])
    if not row["loss"]:
        return "The joint has no hysteresis: loading and unloading follow the same curve."
    amplitude = (
        f"{hysteresis_loops.displacement_name} = "
        f"{_format_value(row['motion'], hysteresis_loops.displacement_and_force_units[0])}"
    )
    return (
        f"In a cycle between plus and minus {amplitude} the joint dissipates "
        f"{_format_value(row['loss'], 'J')}, "
        f"a loss factor of {row['loss_factor']:.2g}."
    )


ORIGIN_MEANINGS = {
    "paper": "printed in a paper or handbook",
    "standard": "a value of a standard",
    "catalogue": "a maker's catalogue",
    "measured": "measured",
    "derived": "computed from other values",
    "estimate": "an engineering estimate",
    "calibration": "fitted to published or measured points",
    "default": "not stated, the default of the package",
    "user": "stated by you",
}
"""{origin of a number: meaning}, for all parameters.VALUE_ORIGINS."""
VALIDITY_HEADINGS = {
    "docs/validity.md": ("In short", "What this does not show"),
    "docs/validity_stiffness.md": (
        "The laws on their own surfaces",
        "Measured joints",
        "Tangential stiffness",
    ),
    "docs/validity_friction.md": ("Damping",),
}
"""{page of the documentation: headings} that the report refers to."""


class _ReportRow(NamedTuple):
    """Row of the report's table of parameters: a number of the parameter file as text.

    display_value, unit : value in a display unit, the unit
    si_value            : value in SI units; empty if the display unit is the SI unit
    doc, origin, source : meaning, origin, source
    """

    name: str
    display_value: str
    unit: str
    si_value: str
    doc: str
    origin: str
    source: str


def write_joint_report(page_path: Path, parameter_file: ParameterFile, fmu_name: str | None = None) -> None:
    """Write the self-contained page of a parameter file for one of the joint's FMUs; default: the first.

    Raises ValueError if the joint has no such FMU, or the file cannot be written.
    """
    write_text(page_path, _render_page(KINDS[parameter_file.joint].find_model(fmu_name), parameter_file))


def _render_page(fmu_model: Model, parameter_file: ParameterFile) -> str:
    """Render the report page of one joint as HTML text."""
    set_status_text("curves over the load")
    course = LoadHistory(fmu_model, parameter_file)
    folder, rows = Path(__file__).parent, _make_parameter_table_rows(parameter_file)
    module = load_tool_module(KINDS[fmu_model.joint], "report")
    set_status_text("loops")
    loops = course.compute_loops() if fmu_model.load_cycle else None
    figures = [make_ramp_figure(course)]
    if loops and any(loop.energy_loss for loop in loops.loops):
        figures.append(make_loop_figure(course, loops))
    if module and fmu_model.name in module.REPORT_FIGURES:
        figures += module.REPORT_FIGURES[fmu_model.name](course)
    compared = (
        module.CATALOGUE_COMPARISONS[fmu_model.name](fmu_model, parameter_file)
        if module and fmu_model.name in module.CATALOGUE_COMPARISONS
        else []
    )
    return load_jinja_template(
        find_page_or_icon(fmu_model, "page.html"), folder, PAGE_TEMPLATE_FOLDER
    ).render(
        model=course.model,
        spring=course.tabulated_joint,
        fmu=True,
        **make_law_template_variables(parameter_file),
        file=parameter_file,
        version=__version__,
        figures=[(figure, encode_panels(figure.plot_panels)) for figure in figures],
        opening=summarise_joint(course, loops, list_parameter_file_entries(parameter_file)),
        beside=_make_comparison_table_rows(compared),
        drawings=draw_further_charts(course.model, course.tabulated_joint),
        rows=rows,
        origins=[
            (kind, ORIGIN_MEANINGS[kind], [r.name for r in rows if r.origin == kind])
            for kind in VALUE_ORIGINS
        ],
        judgement=judge_joint_stiffness(parameter_file),
        range=_describe_range(course),
        topics=VALIDITY_HEADINGS,
        style=read_style_sheet(),
        script=read_page_script() + "drawAll();",
    )


def _make_parameter_table_rows(parameter_file: ParameterFile) -> list[_ReportRow]:
    """Rows of the report's table for all entries of the parameter file."""
    return [
        _ReportRow(
            e.entry_name,
            *format_quantity(e.entry_value, e.si_unit),
            _format_si_value(e),
            e.entry_meaning,
            e.value_origin,
            e.value_source,
        )
        for e in list_parameter_file_entries(parameter_file)
    ]


def _format_si_value(parameter_entry: ParameterFileEntry) -> str:
    """Format the value of an entry in SI units.

    Empty if the display unit is the SI unit, or if there is no unit.
    """
    if parameter_entry.si_unit is None or isinstance(parameter_entry.entry_value, bool | str | tuple):
        return ""
    return (
        ""
        if choose_display_unit(parameter_entry.si_unit, parameter_entry.entry_value)
        == parameter_entry.si_unit
        else f"{parameter_entry.entry_value:.12g} {format_unit(parameter_entry.si_unit)}"
    )


def _to_display_unit(si_values: Any, si_unit: str) -> tuple[Any, str]:
    """Convert values to a display unit that suits the largest of them; returns the values and the unit."""
    largest = float(np.max(np.abs(si_values), initial=0.0))
    display_unit = choose_display_unit(si_unit, largest)
    return conversion_factor(si_unit, display_unit) * np.asarray(si_values), format_unit(display_unit)


def _format_panel_title(
    output_names: Sequence[str], abscissa_name: str, variable_by_name: Mapping[str, Variable]
) -> str:
    """Title of a panel by the meanings of its variables: "Normal stiffness over preload of each bolt"."""

    def find_short_meaning(variable_name: str) -> str:
        """First words of the description of a variable, up to a comma, bracket or symbol, for a title."""
        return re.split(r"[,;:(]| -?d\w+/d", variable_by_name[variable_name].doc)[0].strip()

    quantities = ", ".join(dict.fromkeys(map(find_short_meaning, output_names)))
    return f"{quantities[0].upper()}{quantities[1:]} over {find_short_meaning(abscissa_name)}"


def make_ramp_figure(load_history: LoadHistory) -> Figure:
    """Figure of the outputs along the load ramp, with the charts that the joint defines for its page."""
    columns = load_history.compute_ramp()
    variables = {v.name: v for v in (*load_history.model.inputs, *load_history.model.outputs)}
    charts, docs = [], dict[str, str]()
    unknown = getattr(load_history.file.values, "unknown_outputs", ())
    for over, output_names in find_load_ramp_panels(load_history.model):
        drawn = [name for name in output_names if name not in unknown]
        names = [name for name in drawn if np.any(columns[name])] or drawn  # not C_zz = 0
        x, x_unit = _to_display_unit(columns[over], variables[over].unit)
        unit = choose_display_unit(variables[names[0]].unit, float(np.max(np.abs(columns[names[0]]))))
        scale = conversion_factor(variables[names[0]].unit, unit)
        series = [Series(name, x, scale * columns[name]) for name in names]
        title = _format_panel_title(names, over, variables)
        charts.append(Panel(title, f"{over} [{x_unit}]", f"{', '.join(names)} [{unit}]", series))
        docs |= {name: variables[name].doc for name in (over, *names)}
    ramped = variables[load_history.model.ramp.input_name]
    end, unit = _to_display_unit(load_history.model.ramp.end_value, ramped.unit)
    meaning = "; ".join(f"{name}: {doc}" for name, doc in docs.items() if name != ramped.name)
    text = (
        f"{ramped.name} from 0 to {float(end):.4g} {unit}: {ramped.doc}. All other inputs have their start "
        f"values. Curves: {meaning}."
    )
    return Figure("Curves over the load", text, charts)


def make_loop_figure(load_history: LoadHistory, hysteresis_loops: HysteresisLoops) -> Figure:
    """Figure of the hysteresis loops, with a table of their losses."""
    units = hysteresis_loops.displacement_and_force_units
    x_unit, y_unit = (
        choose_display_unit(unit, max(float(np.max(np.abs(values))) for values in series))
        for unit, series in zip(
            units,
            ([p.displacements for p in hysteresis_loops.loops], [p.forces for p in hysteresis_loops.loops]),
            strict=True,
        )
    )
    x, y = conversion_factor(units[0], x_unit), conversion_factor(units[1], y_unit)
    series = [
        Series(
            f"amplitude {x * loop.displacement_and_force_amplitude[0]:.4g} {format_unit(x_unit)}",
            x * loop.displacements,
            y * loop.forces,
        )
        for loop in reversed(hysteresis_loops.loops)
    ]
    inputs = {v.name: v.unit for v in load_history.model.inputs}
    settings = [
        f"{name} = {' '.join(format_quantity(value, inputs[name], 5))}"
        for name, value in load_history.loop_inputs.items()
        if value
    ]
    text = "Quasi-static load cycles, each amplitude from rest with two cycles" + (
        f", at {', '.join(settings)}. " if settings else ". "
    )
    force = f"{'-' if hysteresis_loops.force_sign < 0.0 else ''}{hysteresis_loops.force_name}"
    variables = {v.name: v for v in (*load_history.model.inputs, *load_history.model.outputs)}
    panel = Panel(
        _format_panel_title([hysteresis_loops.force_name], hysteresis_loops.displacement_name, variables),
        f"{hysteresis_loops.displacement_name} [{x_unit}]",
        f"{force} [{y_unit}]",
        series,
    )
    return Figure("Loops", text, [panel], table_rows=_make_loop_table_rows(hysteresis_loops))


def _make_loop_table_rows(hysteresis_loops: HysteresisLoops) -> list[tuple[str, ...]]:
    """Rows of the table of hysteresis loops: amplitude, force, stiffness, energy loss, loss factor."""
    units = hysteresis_loops.loop_quantity_units

    def format_cell(loop_result: dict[str, float], quantity_name: str) -> str:
        """Format one number of a loop in its display unit."""
        value, unit = _to_display_unit(loop_result[quantity_name], units[quantity_name])
        return f"{float(value):.4g} {unit}"

    rows: list[tuple[str, ...]] = [
        ("amplitude", "force or torque", "secant stiffness", "energy loss per cycle", "loss factor")
    ]
    for row in hysteresis_loops.compute_quantities_of_loops():
        rows.append((*(format_cell(row, name) for name in units), f"{row['loss_factor']:.3g}"))
    return rows


def _make_comparison_table_rows(comparison_rows: list[ComparisonRow]) -> list[dict[str, str]]:
    """Template rows that compare published with computed numbers of a joint, in display units."""
    cells: list[dict[str, str]] = []
    previous_source = ""
    for row in comparison_rows:
        unit = choose_display_unit(row.si_unit, row.published_value)
        scale, ending = conversion_factor(row.si_unit, unit), f" {format_unit(unit)}".rstrip()
        numbers = (f"{scale * value:.4g}{ending}" for value in (row.published_value, row.computed_value))
        names = ("name", "published", "computed", "role", "source")
        source = "as above" if row.source == previous_source else row.source
        previous_source = row.source
        texts = (row.quantity_name.replace("_", " "), *numbers, row.role, source)
        cells.append(dict(zip(names, texts, strict=True)) | {"limit": "< " if row.is_upper_limit else ""})
    return cells


def _describe_range(load_history: LoadHistory) -> str:
    """Describe the range of loads of a joint in a sentence.

    The range ends at the end of the law, or at the load capacity of the parts if that is less.
    """
    ramped = next(v for v in load_history.model.inputs if v.name == load_history.model.ramp.input_name)
    nominal = find_nominal_pressure_model(KINDS[load_history.file.joint])
    capacity = nominal.load_capacity(load_history.file) if nominal else None
    if nominal and capacity and nominal.load_variable == ramped.name:
        largest, name = capacity
        if load_history.law_limit is None or largest < load_history.law_limit[0]:
            value, unit = _to_display_unit(largest, ramped.unit)
            return (
                f"Use it up to {ramped.name} = {float(value):.3g} {unit}, {name}. The law of the interface "
                "ends at a larger load only."
            )
    if load_history.law_limit is None:
        return f"The law is valid for {ramped.name} far beyond the load ramp."
    value, unit = _to_display_unit(load_history.law_limit[0], ramped.unit)
    reason = load_history.law_limit[1].rpartition(": ")[2]
    return (
        f"The law is valid up to {ramped.name} = {float(value):.3g} {unit}. Above, the FMU warns: {reason}."
    )
