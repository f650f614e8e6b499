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
_SIGNIFICANT_DIGITS = 7
"""Significant digits of the numbers of a curve: more than a screen resolves."""


class Series(NamedTuple):
    """Line or marks of a chart.

    name   : name of the series in the legend
    x, y   : numbers of the points, in the units of the axes
    marks  : kind of mark; empty: a line
    dashed : whether the line is dashed
    titles : text of each mark, shown under the pointer
    """

    name: str
    x: NumberSequence
    y: NumberSequence
    marks: str = ""
    dashed: bool = False
    titles: Sequence[str] = ()


class Panel(NamedTuple):
    """One pair of axes: title, axis labels with units, series; `log`: logarithmic x axis."""

    title: str
    x: str
    y: str
    series: Sequence[Series]
    log: bool = False


def encode_panels(panels: Sequence[Panel]) -> str:
    """Encode panels of a chart, side by side, as JSON that is safe inside an HTML page."""

    def round_numbers(values: Any) -> list[float]:
        """Round the numbers of a curve to _SIGNIFICANT_DIGITS."""
        return [float(f"{x:.{_SIGNIFICANT_DIGITS}g}") for x in np.asarray(values, dtype=np.float64).tolist()]

    def encode_series(chart_series: Series) -> dict[str, Any]:
        """Encode one line or its marks as a JSON object."""
        return chart_series._asdict() | {
            "x": round_numbers(chart_series.x),
            "y": round_numbers(chart_series.y),
            "titles": list(chart_series.titles) or None,
        }

    rows = [panel._asdict() | {"series": [encode_series(s) for s in panel.series]} for panel in panels]
    return json.dumps(rows, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")


def make_figure(panels: Sequence[Panel]) -> str:
    """Make the HTML element of a chart with panels, for a page that contains `read_script("figures")`."""
    return f'<div class="figure"><script type="application/json">{encode_panels(panels)}</script></div>'


def read_script(*script_names: str) -> str:
    """JavaScript that draws charts; the name `figures` adds code for all page elements of class `figure`."""
    return '"use strict";\n' + "".join(_read_file(f"{name}.js") for name in ("text", "chart", *script_names))


def read_style() -> str:
    """Read the CSS of colours, charts and tables, the same on all pages."""
    return _read_file("chart.css")


def _read_file(file_name: str) -> str:
    """Read the text of a file in the folder of this module."""
    return Path(__file__).with_name(file_name).read_text(encoding="utf-8")
