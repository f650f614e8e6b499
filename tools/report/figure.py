"""A figure of the report; `figures(outcome)` in the file of a joint returns a list of them."""

import json
from collections.abc import Sequence
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from matplotlib.figure import Figure as Canvas
from numpy.typing import NDArray

from jointfmu.plots import BLUE, GREEN, GREY, RED
from jointfmu.published.reference import PROVES_NOTHING, ROLES, Point

from ..shown import spelled_label

Values: TypeAlias = Sequence[float] | NDArray[np.float64]
_DIGITS = 7
"""Of the numbers of a curve: more than a screen shows."""
_COLOURS = (BLUE, RED, GREEN, GREY, "#8055a8", "#b8860b")


class Series(NamedTuple):
    """A line, or marks, full or empty; `titles` names each mark."""

    name: str
    x: Values
    y: Values
    marks: str = ""
    dashed: bool = False
    titles: Sequence[str] = ()


class Panel(NamedTuple):
    """One pair of axes: title, their labels, what is drawn."""

    title: str
    x: str
    y: str
    series: Sequence[Series]


class Figure(NamedTuple):
    """Title, what is to be seen, panels or pictures as SVG elements, and the CSV file beside the page."""

    title: str
    text: str
    panels: Sequence[Panel] = ()
    pictures: Sequence[str] = ()
    data: str | None = None


def published(points: Sequence[Point], over: str, factor: float = 1.0) -> list[Series]:
    """Published numbers over an argument, by role; what proves nothing is empty."""
    found = []
    for role in dict.fromkeys(point.role for point in points):
        some = [point for point in points if point.role == role]
        x, y = [p.where[over] for p in some], [factor * float(p.value) for p in some]
        marks = "empty" if role in PROVES_NOTHING else "full"
        found.append(Series(f"published: {ROLES[role]}", x, y, marks, titles=[p.id for p in some]))
    return found


def drawn(canvas: Canvas, panels: Sequence[Panel]) -> None:
    """The panels side by side, as a picture for the command line."""
    for axes, panel in zip(canvas.subplots(1, len(panels), squeeze=False)[0], panels, strict=True):
        for series, color in zip(panel.series, _COLOURS, strict=False):
            style = {"ls": "", "marker": "o", "mfc": "white" if series.marks == "empty" else color}
            axes.plot(
                series.x,
                series.y,
                color=color,
                label=series.name,
                **style if series.marks else {"ls": "--" if series.dashed else "-"},
            )
        axes.set_title(panel.title, fontsize=10)
        axes.set_xlabel(panel.x)
        axes.set_ylabel(panel.y)
        if len(panel.series) > 1:
            axes.legend(fontsize=8)


def as_json(figure: Figure) -> str:
    """The panels as JSON, for the page's charts."""

    def numbers(values: Any) -> list[float]:
        return [float(f"{x:.{_DIGITS}g}") for x in np.asarray(values, dtype=np.float64).tolist()]

    panels = [
        {
            "title": panel.title,
            "x": spelled_label(panel.x),
            "y": spelled_label(panel.y),
            "series": [
                s._asdict() | {"x": numbers(s.x), "y": numbers(s.y), "titles": list(s.titles) or None}
                for s in panel.series
            ],
        }
        for panel in figure.panels
    ]
    return json.dumps(panels, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")
