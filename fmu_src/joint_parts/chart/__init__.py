"""Charts of HTML pages: FMU documentation, report and laboratory share one script that draws them.

A page contains the curves as JSON and the script. So building an FMU needs no plotting package, and its bytes
are the same on every platform. Image files are drawn by matplotlib instead (`jointfmu_tools.common.plots`).
"""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

NumberSequence: TypeAlias = Sequence[float] | NDArray[np.float64]
_CURVE_SIGNIFICANT_DIGITS = 7
"""Significant digits of the numbers of a curve: more than a screen resolves."""


class Series(NamedTuple):
    """Data series of a chart: a line or single markers.

    series_name        : name of the series in the legend
    x_values, y_values : coordinates of the points, in the units of the axes
    marker_style       : "full" or "empty" markers; empty text: a line
    is_dashed          : whether the line is dashed
    marker_tooltips    : text of each marker, shown under the pointer
    """

    series_name: str
    x_values: NumberSequence
    y_values: NumberSequence
    marker_style: str = ""
    is_dashed: bool = False
    marker_tooltips: Sequence[str] = ()


class Panel(NamedTuple):
    """One pair of axes of a chart: title, axis labels with units, data series."""

    panel_title: str
    x_axis_label: str
    y_axis_label: str
    chart_series: Sequence[Series]
    has_log_x_axis: bool = False


def encode_panels(chart_panels: Sequence[Panel]) -> str:
    """Encode the panels of a chart, drawn side by side, as JSON that is safe inside an HTML page."""

    def round_numbers(curve_values: Any) -> list[float]:
        """Round the coordinates of a curve to _CURVE_SIGNIFICANT_DIGITS significant digits."""
        return [
            float(f"{x:.{_CURVE_SIGNIFICANT_DIGITS}g}")
            for x in np.asarray(curve_values, dtype=np.float64).tolist()
        ]

    def encode_series(chart_series: Series) -> dict[str, Any]:
        """Encode one data series as a JSON object with the keys that the script of the chart reads."""
        return {
            "name": chart_series.series_name,
            "x": round_numbers(chart_series.x_values),
            "y": round_numbers(chart_series.y_values),
            "marks": chart_series.marker_style,
            "dashed": chart_series.is_dashed,
            "titles": list(chart_series.marker_tooltips) or None,
        }

    rows = [
        {
            "title": panel.panel_title,
            "x": panel.x_axis_label,
            "y": panel.y_axis_label,
            "series": [encode_series(s) for s in panel.chart_series],
            "log": panel.has_log_x_axis,
        }
        for panel in chart_panels
    ]
    return json.dumps(rows, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")


def make_chart_element(chart_panels: Sequence[Panel]) -> str:
    """HTML element of a chart with panels, for a page that contains `read_chart_script("figures")`."""
    chart_json = encode_panels(chart_panels)
    return f'<div class="figure"><script type="application/json">{chart_json}</script></div>'


def read_chart_script(*script_names: str) -> str:
    """Read the JavaScript that draws charts, and further scripts of this folder by name.

    The script `figures` draws a chart in each page element of class `figure`.
    """
    return '"use strict";\n' + "".join(
        _read_chart_file(f"{name}.js") for name in ("text", "chart", *script_names)
    )


def read_chart_style() -> str:
    """Read the CSS for colours, charts and tables, which all HTML pages share."""
    return _read_chart_file("chart.css")


def _read_chart_file(file_name: str) -> str:
    """Read a script or style sheet in the folder of this module."""
    return Path(__file__).with_name(file_name).read_text(encoding="utf-8")
