"""Figures of reports, and rows that compare a published number with the computed one."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from jointfmu_fmu_src.joint_parts import chart
from jointfmu_fmu_src.joint_parts.chart import Panel, Series

from ...common.plots import BLUE, GREEN, GREY, RED
from ...studies.published.reference import ROLES, UNTESTED_ROLES, PublishedPoint
from ..laboratory.assemble import read_web_file

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas


def style_sheet() -> str:
    """Style sheet (CSS) of the reports."""
    return chart.read_style() + read_web_file("style.css") + _read_asset("report.css")


def page_script(*names: str) -> str:
    """JavaScript of the charts of a report, and of the named scripts of this folder."""
    return chart.read_script("figures") + "".join(map(_read_asset, names))


def _read_asset(file_name: str) -> str:
    """Read the text of a file in the folder of this module."""
    return Path(__file__).with_name(file_name).read_text(encoding="utf-8")


ROLE_PARAMETER_SOURCE, ROLE_INDEPENDENT, ROLE_PREDICTED = "set by it", "set independently", "predicted"
"""Roles of a published number: a parameter was set from it; a parameter has the same meaning, but another
source; no parameter was set from it, so the joint predicts it."""


class ComparisonRow(NamedTuple):
    """Comparison of a published number with the number that the joint has.

    unit                : SI unit of both numbers
    published, computed : the numbers
    is_upper_limit      : whether the published number is an upper limit
    role                : ROLE_PARAMETER_SOURCE, ROLE_INDEPENDENT or ROLE_PREDICTED
    """

    name: str
    unit: str
    published: float
    is_upper_limit: bool
    computed: float
    role: str
    source: str


__all__ = ["Figure", "Panel", "Series", "draw_panels", "published_series"]

_SERIES_COLOURS = (BLUE, RED, GREEN, GREY, "#8055a8", "#b8860b")
"""Colours of the curves of a chart, in their order."""


class Figure(NamedTuple):
    """Figure of a report: charts, table and text.

    title, text : heading, and description of what the figure shows
    panels      : charts
    pictures    : SVG elements
    data_file   : name of the CSV file next to the page
    table       : rows of a table; the first row has the headings
    """

    title: str
    text: str
    panels: Sequence[Panel] = ()
    pictures: Sequence[str] = ()
    data_file: str | None = None
    table: Sequence[Sequence[str]] = ()


def published_series(published_points: Sequence[PublishedPoint], argument: str) -> list[Series]:
    """Series of published numbers over an argument, one for each role.

    Marks are empty if numbers of this role are no independent check.
    """
    series = []
    for role in dict.fromkeys(point.role for point in published_points):
        chosen = [point for point in published_points if point.role == role]
        x, y = [p.where[argument] for p in chosen], [float(p.value) for p in chosen]
        marks = "empty" if role in UNTESTED_ROLES else "full"
        series.append(Series(f"published: {ROLES[role]}", x, y, marks, titles=[p.id for p in chosen]))
    return series


def draw_panels(matplotlib_figure: "Canvas", panels: Sequence[Panel]) -> None:
    """Draw panels side by side with matplotlib."""
    for axes, panel in zip(matplotlib_figure.subplots(1, len(panels), squeeze=False)[0], panels, strict=True):
        for series, color in zip(panel.series, _SERIES_COLOURS, strict=False):
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
