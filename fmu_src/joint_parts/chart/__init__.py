"""Charts of all pages, drawn by one script: of an FMU's documentation, the report and the laboratory.

A page holds curves as JSON beside the script; pictures in files are matplotlib's (`jointfmu_tools.plots`).
No plotting package is needed to build an FMU, and its bytes are the same everywhere.
"""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

Values: TypeAlias = Sequence[float] | NDArray[np.float64]
_DIGITS = 7
"""Of the numbers of a curve: more than a screen shows."""


class Series(NamedTuple):
    """A line, or marks, full or empty; `titles` names each mark."""

    name: str
    x: Values
    y: Values
    marks: str = ""
    dashed: bool = False
    titles: Sequence[str] = ()


class Panel(NamedTuple):
    """One pair of axes: title, their labels with units, what is drawn; `log`: over decades of x."""

    title: str
    x: str
    y: str
    series: Sequence[Series]
    log: bool = False


def as_json(panels: Sequence[Panel]) -> str:
    """Panels side by side as JSON, safe inside a page."""

    def numbers(values: Any) -> list[float]:
        return [float(f"{x:.{_DIGITS}g}") for x in np.asarray(values, dtype=np.float64).tolist()]

    def series(s: Series) -> dict[str, Any]:
        return s._asdict() | {"x": numbers(s.x), "y": numbers(s.y), "titles": list(s.titles) or None}

    rows = [panel._asdict() | {"series": [series(s) for s in panel.series]} for panel in panels]
    return json.dumps(rows, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")


def element(panels: Sequence[Panel]) -> str:
    """Panels as an element of a page with `script("figures")`."""
    return f'<div class="figure"><script type="application/json">{as_json(panels)}</script></div>'


def script(*names: str) -> str:
    """The charts, and with `figures` those of the page's elements of class `figure`."""
    return '"use strict";\n' + "".join(_own(f"{name}.js") for name in ("text", "chart", *names))


def style() -> str:
    """Colours, charts and tables, the same on all pages."""
    return _own("chart.css")


def _own(name: str) -> str:
    return Path(__file__).with_name(name).read_text(encoding="utf-8")
