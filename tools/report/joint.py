"""The page of one joint: curves, loops, friction, where each number comes from, how far to trust it."""

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
"""Share [1] by which a stiffness may change and still be called constant."""


def opening(course: Course, loops: HysteresisLoops | None, numbers: Sequence[Stated]) -> str:
    """A few sentences; `loops` of a joint with memory, `numbers` of its file."""
    lines = [f"A {KINDS[course.file.joint].title}.", _stiff(course)]
    if loops:
        lines.append(_lost(loops))
    count = Counter(one.kind for one in numbers)
    weak = [f"{count[kind]} {told}" for kind, told in _WEAK.items() if count[kind]]
    if weak:
        total = sum(count.values())
        lines.append(
            f"Of the {total} numbers behind it {' and '.join(weak)}; each is listed below with its source."
        )
    return " ".join(line for line in lines if line)


_WEAK = {"estimate": "are estimates", "calibration": "were fitted"}


def _told(value: float, unit: str) -> str:
    text, shown = quantity(value, unit, 3)
    return f"{float(text):.6g} {shown}"


def _stiff(course: Course) -> str:
    """The stiffness over the load ramp; empty if no curve shows one."""
    units = {v.name: v.unit for v in (*course.model.inputs, *course.model.outputs)}
    shown = [
        (over, name) for over, names in panels(course.model) for name in names if units[name] in _STIFFNESS
    ]
    if not shown:
        return ""
    over, name = shown[0]
    columns = course.ramp()
    first, last = (float(columns[name][i]) for i in (0, -1))
    end = f"{over} = {_told(float(columns[over][-1]), units[over])}"
    if abs(last - first) <= _ALIKE * abs(last):
        return f"Its stiffness {name} is {_told(last, units[name])}, nearly constant up to {end}."
    start = _told(first, units[name]) if first > 0.0 else "nothing"
    word = "grows" if last > first else "falls"
    times = f", {max(first, last) / min(first, last):.2g} times" if min(first, last) > 0.0 else ""
    begin = f"{over} = {_told(float(columns[over][0]), units[over])}"
    return (
        f"Its stiffness {name} {word} from {start} at {begin} to "
        f"{_told(last, units[name])} at {end}{times}: a constant spring is right at one load only."
    )


def _lost(loops: HysteresisLoops) -> str:
    """What the largest loop loses."""
    row = max(loops.rows(), key=lambda row: row["motion"])
    if not row["loss"]:
        return "Moved to and fro it comes back on the same curve: it has no hysteresis."
    amplitude = f"{loops.motion} = {_told(row['motion'], loops.units[0])}"
    return (
        f"Moved to and fro between plus and minus {amplitude} it turns {_told(row['loss'], 'J')} into heat "
        f"in each cycle, a loss factor of {row['loss_factor']:.2g}."
    )


MEANT = {
    "published": "printed in the paper",
    "derived": "computed from printed values or from a drawing",
    "catalogue": "a maker's catalogue",
    "estimate": "an engineering estimate",
    "calibration": "fitted to published or measured points",
    "user": "set by you",
}
"""What each of ORIGINS means."""
TOPICS = (
    "In short",
    "The laws on their own surfaces",
    "Measured joints",
    "Tangential stiffness",
    "Damping",
    "What this does not show",
)
"""Headings of docs/validity.md for those who want to know more."""


class _ReportRow(NamedTuple):
    """A number of the file, as text: shown in a display unit, and in SI where that is another."""

    name: str
    shown: str
    unit: str
    stated: str
    doc: str
    kind: str
    source: str


def write_joint_report(path: Path, file: ParameterFile, fmu: str | None = None) -> None:
    """Write the self-contained page of a parameter file, for one of the joint's FMUs (default: the first).

    Raises ValueError if the joint has no such FMU, or the file cannot be written.
    """
    write_text(path, _page(KINDS[file.joint].model(fmu), file))


def _page(model: Model, file: ParameterFile) -> str:
    step("curves over the load")
    course = Course(model, file)
    here, rows = Path(__file__).parent, _rows(file)
    own = part(KINDS[model.joint], "report")
    step("loops")
    loops = course.loops() if model.loop else None
    figures = [curves(course), *([looped(course, loops)] if loops else [])]
    if own and model.name in own.FIGURES:
        figures += own.FIGURES[model.name](course)
    return template(asset(model, "page.html"), here, FRAME).render(
        model=course.model,
        spring=course.spring,
        fmu=True,
        **law_terms(file),
        file=file,
        version=__version__,
        figures=[(figure, as_json(figure.panels)) for figure in figures],
        opening=opening(course, loops, stated(file)),
        beside=_beside_rows(own.BESIDE[model.name](model, file)) if own and model.name in own.BESIDE else [],
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
    """Every number of the file."""
    return [
        _ReportRow(one.name, *quantity(one.value, one.unit), _exact(one), one.doc, one.kind, one.source)
        for one in stated(file)
    ]


def _exact(one: Stated) -> str:
    """The value in SI, where it is shown in another unit."""
    if one.unit is None or isinstance(one.value, bool | str | tuple):
        return ""
    return "" if shown_unit(one.unit, one.value) == one.unit else f"{one.value:.12g} {spelled(one.unit)}"


def _scale(values: Any, unit: str) -> tuple[Any, str]:
    """Values in the display unit in which the largest of them reads best, and that unit."""
    largest = float(np.max(np.abs(values), initial=0.0))
    shown = shown_unit(unit, largest)
    return factor(unit, shown) * np.asarray(values), spelled(shown)


def curves(course: Course) -> Figure:
    """The load ramp: what the joint's folder says of its page."""
    columns = course.ramp()
    variables = {v.name: v for v in (*course.model.inputs, *course.model.outputs)}
    drawn, named = [], dict[str, str]()
    for over, names in panels(course.model):
        x, x_unit = _scale(columns[over], variables[over].unit)
        unit = shown_unit(variables[names[0]].unit, float(np.max(np.abs(columns[names[0]]))))
        times = factor(variables[names[0]].unit, unit)
        series = [Series(name, x, times * columns[name]) for name in names]
        title = f"{', '.join(names)} over {over}"
        drawn.append(Panel(title, f"{over} [{x_unit}]", f"{', '.join(names)} [{unit}]", series))
        named |= {name: variables[name].doc for name in (over, *names)}
    ramped = variables[course.model.ramp.input]
    end, unit = _scale(course.model.ramp.end, ramped.unit)
    meaning = "; ".join(f"{name}: {doc}" for name, doc in named.items() if name != ramped.name)
    text = (
        f"{ramped.name} ({ramped.doc}) from 0 to {float(end):.4g} {unit}, all else at its start value. "
        f"Drawn are {meaning}."
    )
    return Figure("Curves over the load", text, drawn)


def looped(course: Course, loops: HysteresisLoops) -> Figure:
    """The loops of a joint with memory."""
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
    set_ = [f"{name} = {value:g} {spelled(inputs[name])}" for name, value in course.about.items() if value]
    text = "To and fro from rest at no speed, two cycles each" + (
        f", at {', '.join(set_)}. " if set_ else ". "
    )
    if not any(loop.loss for loop in loops.loops):
        text += "With these parameters the joint remembers nothing: way there and way back are one curve."
    force = f"{'-' if loops.sign < 0.0 else ''}{loops.force}"
    panel = Panel(f"{force} over {loops.motion}", f"{loops.motion} [{x_unit}]", f"{force} [{y_unit}]", series)
    return Figure("Loops", text, [panel], table=_loop_rows(loops))


def _loop_rows(loops: HysteresisLoops) -> list[tuple[str, ...]]:
    """What the loops lose, in display units."""
    units = loops.row_units

    def shown(row: dict[str, float], name: str) -> str:
        value, unit = _scale(row[name], units[name])
        return f"{float(value):.4g} {unit}"

    rows: list[tuple[str, ...]] = [
        ("amplitude", "force or torque", "secant stiffness", "loss of a cycle", "loss factor")
    ]
    for row in loops.rows():
        rows.append((*(shown(row, name) for name in units), f"{row['loss_factor']:.3g}"))
    return rows


def _beside_rows(rows: list[Beside]) -> list[dict[str, str]]:
    """The table of what is published of this joint, in the display units of the published numbers."""
    shown = []
    for row in rows:
        unit = shown_unit(row.unit, row.published)
        times, ending = factor(row.unit, unit), f" {spelled(unit)}".rstrip()
        numbers = (f"{times * value:.4g}{ending}" for value in (row.published, row.computed))
        names = ("name", "published", "computed", "role", "source")
        texts = (row.name.replace("_", " "), *numbers, row.role, row.source)
        shown.append(dict(zip(names, texts, strict=True)) | {"limit": "< " if row.bound else ""})
    return shown


def _range(course: Course) -> str:
    """Where the law ends."""
    ramped = next(v for v in course.model.inputs if v.name == course.model.ramp.input)
    if course.limit is None:
        return f"No end of the law is met by {ramped.name}, far beyond the load ramp."
    value, unit = _scale(course.limit[0], ramped.unit)
    return (
        f"The law ends at {ramped.name} = {float(value):.3g} {unit}; beyond, an FMU warns: {course.limit[1]}."
    )
