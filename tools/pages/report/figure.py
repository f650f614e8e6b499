"""Figures of reports, and rows that compare a published number with the computed one."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from jointfmu_fmu_src.joint_parts import chart
from jointfmu_fmu_src.joint_parts.chart import Panel, Series

from ...common.plots import BLUE, GREEN, GREY, RED
from ...studies.published.reference import POINT_ROLES, UNTESTED_ROLES, PublishedPoint
from ..laboratory.assemble import read_web_file

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas


def read_style_sheet() -> str:
    """Style sheet (CSS) of the reports."""
    return chart.read_chart_style() + read_web_file("style.css") + _read_asset("report.css")


def read_page_script(*names: str) -> str:
    """JavaScript of the charts of a report, and of the named scripts of this folder."""
    return chart.read_chart_script("figures") + "".join(map(_read_asset, names))


def _read_asset(file_name: str) -> str:
    """Read the text of a file in the folder of this module."""
    return Path(__file__).with_name(file_name).read_text(encoding="utf-8")


ROLE_PARAMETER_SOURCE, ROLE_INDEPENDENT, ROLE_PREDICTED = "set by it", "set independently", "predicted"
"""Roles of a published number: a parameter was set from it; a parameter has the same meaning, but another
source; no parameter was set from it, so the joint predicts it."""


class ComparisonRow(NamedTuple):
    """Comparison of a published number with the number that the joint computes or has as parameter.

    si_unit                         : SI unit of both numbers
    published_value, computed_value : the numbers
    is_upper_limit                  : whether the published number is an upper limit
    role                            : use of the published number: source of a parameter
        (ROLE_PARAMETER_SOURCE), other source of the parameter (ROLE_INDEPENDENT), test of a prediction
        (ROLE_PREDICTED)
    """

    quantity_name: str
    si_unit: str
    published_value: float
    is_upper_limit: bool
    computed_value: float
    role: str
    source: str


__all__ = ["Figure", "Panel", "Series", "draw_panels", "published_series"]

_SERIES_COLOURS = (BLUE, RED, GREEN, GREY, "#8055a8", "#b8860b")
"""Colours of the curves of a chart, in their order."""


class Figure(NamedTuple):
    """Figure of a report: charts, table and text.

    title, description : heading, and description of what the figure shows; a blank line begins a paragraph
    plot_panels        : charts
    svg_pictures       : SVG elements
    data_file          : name of the CSV file next to the page
    table_rows         : rows of a table; the first row has the headings
    """

    title: str
    description: str
    plot_panels: Sequence[Panel] = ()
    svg_pictures: Sequence[str] = ()
    data_file: str | None = None
    table_rows: Sequence[Sequence[str]] = ()


def published_series(published_points: Sequence[PublishedPoint], abscissa_name: str) -> list[Series]:
    """Chart series of published numbers against an argument, one for each use (role) of the numbers.

    Marks are empty if the numbers are no independent check, for example if parameters are fitted to them.
    """
    series = []
    for role in dict.fromkeys(point.role for point in published_points):
        chosen = [point for point in published_points if point.role == role]
        x, y = [p.where[abscissa_name] for p in chosen], [float(p.value) for p in chosen]
        marks = "empty" if role in UNTESTED_ROLES else "full"
        series.append(
            Series(f"published: {POINT_ROLES[role]}", x, y, marks, marker_tooltips=[p.id for p in chosen])
        )
    return series


def draw_panels(matplotlib_figure: "Canvas", plot_panels: Sequence[Panel]) -> None:
    """Draw panels side by side with matplotlib."""
    for axes, panel in zip(
        matplotlib_figure.subplots(1, len(plot_panels), squeeze=False)[0], plot_panels, strict=True
    ):
        for series, color in zip(panel.chart_series, _SERIES_COLOURS, strict=False):
            style = {"ls": "", "marker": "o", "mfc": "white" if series.marker_style == "empty" else color}
            axes.plot(
                series.x_values,
                series.y_values,
                color=color,
                label=series.series_name,
                **style if series.marker_style else {"ls": "--" if series.is_dashed else "-"},
            )
        axes.set_title(panel.panel_title, fontsize=10)
        axes.set_xlabel(panel.x_axis_label)
        axes.set_ylabel(panel.y_axis_label)
        if len(panel.chart_series) > 1:
            axes.legend(fontsize=8)
