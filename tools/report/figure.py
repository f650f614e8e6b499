"""A figure of the report, and a row of a joint's page: a published number beside what the joint does."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from jointfmu_fmu_src.joint_parts import chart
from jointfmu_fmu_src.joint_parts.chart import Panel, Series

from ..laboratory.assemble import web_file
from ..plots import BLUE, GREEN, GREY, RED
from ..published.reference import PROVES_NOTHING, ROLES, Point

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas


def style() -> str:
    """The style sheet."""
    return chart.style() + web_file("style.css") + _own("report.css")


def script(*names: str) -> str:
    """The charts of the figures, and scripts of this folder that use them."""
    return chart.script("figures") + "".join(map(_own, names))


def _own(name: str) -> str:
    return Path(__file__).with_name(name).read_text(encoding="utf-8")


SET, OWN, PREDICTED = "set by it", "a parameter of its own", "predicted"
"""What the published number is for the file: a parameter comes from it; one is of the same meaning, but does
not come from it; none of the two."""


class Beside(NamedTuple):
    """Numbers in the SI unit `unit`.

    bound : the published number is an upper limit
    role  : SET, OWN or PREDICTED
    """

    name: str
    unit: str
    published: float
    bound: bool
    computed: float
    role: str
    source: str


__all__ = ["Figure", "Panel", "Series", "drawn", "published"]

_COLOURS = (BLUE, RED, GREEN, GREY, "#8055a8", "#b8860b")


class Figure(NamedTuple):
    """Title, what is to be seen, panels or pictures as SVG elements, the CSV file beside the page, and rows
    of a table, its head first."""

    title: str
    text: str
    panels: Sequence[Panel] = ()
    pictures: Sequence[str] = ()
    data: str | None = None
    table: Sequence[Sequence[str]] = ()


def published(points: Sequence[Point], over: str) -> list[Series]:
    """Published numbers over an argument, by role; what proves nothing is empty."""
    found = []
    for role in dict.fromkeys(point.role for point in points):
        some = [point for point in points if point.role == role]
        x, y = [p.where[over] for p in some], [float(p.value) for p in some]
        marks = "empty" if role in PROVES_NOTHING else "full"
        found.append(Series(f"published: {ROLES[role]}", x, y, marks, titles=[p.id for p in some]))
    return found


def drawn(canvas: "Canvas", panels: Sequence[Panel]) -> None:
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
