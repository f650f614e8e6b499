"""The report page of one joint: curves, loops, friction, sources of the numbers, validity."""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from jointfmu_fmu_src.folders import asset
from jointfmu_fmu_src.joint_parts.chart import as_json
from jointfmu_fmu_src.native.page import drawings, panels
from jointfmu_fmu_src.templates import FRAME, law_terms, template

from jointfmu import __version__
from jointfmu.files.writing import write_text
from jointfmu.joints import KINDS
from jointfmu.joints.model import Model
from jointfmu.parameters import ORIGINS, ParameterFile
from jointfmu.progress import step
from jointfmu.quantity.units import factor

from ..joint_parts import part
from ..pressure import judge_file
from ..ramps.loops import HysteresisLoops
from ..shown import Stated, quantity, shown_unit, spelled, stated
from .course import Course
from .figure import Beside, Figure, Panel, Series, script, style

_STIFFNESS = ("N/m", "N.m/rad")
_ALIKE = 0.02
"""Relative change [1] below which a stiffness is called constant."""


def opening(course: Course, loops: HysteresisLoops | None, numbers: Sequence[Stated]) -> str:
    """Summarise a joint in a few sentences: stiffness, hysteresis, estimated parameters.

    loops   : hysteresis loops; None for a joint without friction history
    numbers : entries of the parameter file
    """
    lines = [f"A {KINDS[course.file.joint].title}.", _stiff(course)]
    if loops:
        lines.append(_lost(loops))
    count = Counter(entry.kind for entry in numbers)
    uncertain = [f"{count[kind]} {text}" for kind, text in _WEAK.items() if count[kind]]
    if uncertain:
        total = sum(count.values())
        lines.append(
            f"Of its {total} parameters {' and '.join(uncertain)}; all are listed below with their sources."
        )
    return " ".join(line for line in lines if line)


_WEAK = {"estimate": "are estimates", "calibration": "were fitted"}
"""{origin of an uncertain parameter: text}."""


def _told(value: float, unit: str) -> str:
    """Format a value with three digits in a display unit."""
    text, display_unit = quantity(value, unit, 3)
    return f"{float(text):.6g} {display_unit}"


def _stiff(course: Course) -> str:
    """Describe the stiffness over the load ramp in a sentence; empty if no panel has a stiffness."""
    units = {v.name: v.unit for v in (*course.model.inputs, *course.model.outputs)}
    curves = [
        (over, name) for over, names in panels(course.model) for name in names if units[name] in _STIFFNESS
    ]
    if not curves:
        return ""
    over, name = curves[0]
    columns = course.ramp()
    first, last = (float(columns[name][i]) for i in (0, -1))
    end = f"{over} = {_told(float(columns[over][-1]), units[over])}"
    if abs(last - first) <= _ALIKE * abs(last):
        return f"The stiffness {name} is {_told(last, units[name])}, nearly constant up to {end}."
    start = _told(first, units[name]) if first > 0.0 else "zero"
    verb = "rises" if last > first else "falls"
    times = f", by a factor of {max(first, last) / min(first, last):.3g}" if min(first, last) > 0.0 else ""
    begin = f"{over} = {_told(float(columns[over][0]), units[over])}"
    return (
        f"The stiffness {name} {verb} from {start} at {begin} to {_told(last, units[name])} at {end}{times}. "
        "A constant spring would be right at one load only."
    )


def _lost(loops: HysteresisLoops) -> str:
    """Describe the energy loss of the largest loop in a sentence."""
    row = max(loops.rows(), key=lambda row: row["motion"])
    if not row["loss"]:
        return "The joint has no hysteresis: loading and unloading follow the same curve."
    amplitude = f"{loops.motion} = {_told(row['motion'], loops.units[0])}"
    return (
        f"In a cycle between plus and minus {amplitude} the joint dissipates {_told(row['loss'], 'J')}, "
        f"a loss factor of {row['loss_factor']:.2g}."
    )


MEANT = {
    "published": "printed in the paper",
    "derived": "computed from printed values or from a drawing",
    "catalogue": "a maker's catalogue",
    "estimate": "an engineering estimate",
    "calibration": "fitted to published or measured points",
    "user": "set by you",
}
"""{origin of a number: meaning}, for all parameters.ORIGINS."""
TOPICS = (
    "In short",
    "The laws on their own surfaces",
    "Measured joints",
    "Tangential stiffness",
    "Damping",
    "What this does not show",
)
"""Headings of docs/validity.md that the page refers to."""


class _ReportRow(NamedTuple):
    """A number of the parameter file as text.

    display_value, unit : value in a display unit, the unit
    si_value            : value in SI units; empty if the display unit is the SI unit
    doc, kind, source   : meaning, origin, source
    """

    name: str
    shown: str
    unit: str
    stated: str
    doc: str
    kind: str
    source: str


def write_joint_report(path: Path, file: ParameterFile, fmu: str | None = None) -> None:
    """Write the self-contained page of a parameter file for one of the joint's FMUs; default: the first.

    Raises ValueError if the joint has no such FMU, or the file cannot be written.
    """
    write_text(path, _page(KINDS[file.joint].model(fmu), file))


def _page(model: Model, file: ParameterFile) -> str:
    step("curves over the load")
    course = Course(model, file)
    folder, rows = Path(__file__).parent, _rows(file)
    module = part(KINDS[model.joint], "report")
    step("loops")
    loops = course.loops() if model.loop else None
    figures = [curves(course), *([looped(course, loops)] if loops else [])]
    if module and model.name in module.FIGURES:
        figures += module.FIGURES[model.name](course)
    compared = module.BESIDE[model.name](model, file) if module and model.name in module.BESIDE else []
    return template(asset(model, "page.html"), folder, FRAME).render(
        model=course.model,
        spring=course.spring,
        fmu=True,
        **law_terms(file),
        file=file,
        version=__version__,
        figures=[(figure, as_json(figure.panels)) for figure in figures],
        opening=opening(course, loops, stated(file)),
        beside=_beside_rows(compared),
        drawings=drawings(course.model, course.spring),
        rows=rows,
        origins=[(kind, MEANT[kind], [r.name for r in rows if r.kind == kind]) for kind in ORIGINS],
        judgement=judge_file(file),
        range=_range(course),
        topics=TOPICS,
        style=style(),
        script=script() + "drawAll();",
    )


def _rows(file: ParameterFile) -> list[_ReportRow]:
    """Rows of all entries of the parameter file."""
    return [
        _ReportRow(e.name, *quantity(e.value, e.unit), _exact(e), e.doc, e.kind, e.source)
        for e in stated(file)
    ]


def _exact(one: Stated) -> str:
    """Format the value in SI units; empty if the display unit is the SI unit, or if there is no unit."""
    if one.unit is None or isinstance(one.value, bool | str | tuple):
        return ""
    return "" if shown_unit(one.unit, one.value) == one.unit else f"{one.value:.12g} {spelled(one.unit)}"


def _scale(values: Any, unit: str) -> tuple[Any, str]:
    """Convert values to a display unit that suits the largest of them; returns the values and the unit."""
    largest = float(np.max(np.abs(values), initial=0.0))
    display_unit = shown_unit(unit, largest)
    return factor(unit, display_unit) * np.asarray(values), spelled(display_unit)


def curves(course: Course) -> Figure:
    """Figure of the curves over the load ramp, with the panels that the joint defines for its page."""
    columns = course.ramp()
    variables = {v.name: v for v in (*course.model.inputs, *course.model.outputs)}
    charts, docs = [], dict[str, str]()
    for over, names in panels(course.model):
        x, x_unit = _scale(columns[over], variables[over].unit)
        unit = shown_unit(variables[names[0]].unit, float(np.max(np.abs(columns[names[0]]))))
        scale = factor(variables[names[0]].unit, unit)
        series = [Series(name, x, scale * columns[name]) for name in names]
        title = f"{', '.join(names)} over {over}"
        charts.append(Panel(title, f"{over} [{x_unit}]", f"{', '.join(names)} [{unit}]", series))
        docs |= {name: variables[name].doc for name in (over, *names)}
    ramped = variables[course.model.ramp.input]
    end, unit = _scale(course.model.ramp.end, ramped.unit)
    meaning = "; ".join(f"{name}: {doc}" for name, doc in docs.items() if name != ramped.name)
    text = (
        f"{ramped.name} ({ramped.doc}) from 0 to {float(end):.4g} {unit}; all other inputs have their start "
        f"values. Curves: {meaning}."
    )
    return Figure("Curves over the load", text, charts)


def looped(course: Course, loops: HysteresisLoops) -> Figure:
    """Figure of the hysteresis loops, with a table of their losses."""
    units = loops.units
    x_unit, y_unit = (
        shown_unit(unit, max(float(np.max(np.abs(values))) for values in series))
        for unit, series in zip(
            units, ([p.motion for p in loops.loops], [p.force for p in loops.loops]), strict=True
        )
    )
    x, y = factor(units[0], x_unit), factor(units[1], y_unit)
    series = [
        Series(f"amplitude {x * loop.amplitudes[0]:.4g} {spelled(x_unit)}", x * loop.motion, y * loop.force)
        for loop in reversed(loops.loops)
    ]
    inputs = {v.name: v.unit for v in course.model.inputs}
    settings = [
        f"{name} = {value:g} {spelled(inputs[name])}" for name, value in course.about.items() if value
    ]
    text = "Quasi-static load cycles, each amplitude from rest with two cycles" + (
        f", at {', '.join(settings)}. " if settings else ". "
    )
    if not any(loop.loss for loop in loops.loops):
        text += "With these parameters there is no hysteresis: loading and unloading follow one curve."
    force = f"{'-' if loops.sign < 0.0 else ''}{loops.force}"
    panel = Panel(f"{force} over {loops.motion}", f"{loops.motion} [{x_unit}]", f"{force} [{y_unit}]", series)
    return Figure("Loops", text, [panel], table=_loop_rows(loops))


def _loop_rows(loops: HysteresisLoops) -> list[tuple[str, ...]]:
    """Table of the loops in display units: amplitude, force, stiffness, energy loss, loss factor."""
    units = loops.row_units

    def shown(row: dict[str, float], name: str) -> str:
        value, unit = _scale(row[name], units[name])
        return f"{float(value):.4g} {unit}"

    rows: list[tuple[str, ...]] = [
        ("amplitude", "force or torque", "secant stiffness", "energy loss per cycle", "loss factor")
    ]
    for row in loops.rows():
        rows.append((*(shown(row, name) for name in units), f"{row['loss_factor']:.3g}"))
    return rows


def _beside_rows(rows: list[Beside]) -> list[dict[str, str]]:
    """Template rows that compare published with computed numbers, in display units."""
    cells = []
    for row in rows:
        unit = shown_unit(row.unit, row.published)
        scale, ending = factor(row.unit, unit), f" {spelled(unit)}".rstrip()
        numbers = (f"{scale * value:.4g}{ending}" for value in (row.published, row.computed))
        names = ("name", "published", "computed", "role", "source")
        texts = (row.name.replace("_", " "), *numbers, row.role, row.source)
        cells.append(dict(zip(names, texts, strict=True)) | {"limit": "< " if row.bound else ""})
    return cells


def _range(course: Course) -> str:
    """Describe the load range in which the law is valid."""
    ramped = next(v for v in course.model.inputs if v.name == course.model.ramp.input)
    if course.limit is None:
        return f"The law is valid for {ramped.name} far beyond the load ramp."
    value, unit = _scale(course.limit[0], ramped.unit)
    return (
        f"The law is valid up to {ramped.name} = {float(value):.3g} {unit}. Above, the FMU warns: "
        f"{course.limit[1]}."
    )
