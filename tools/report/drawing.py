"""Pictures as SVG text: the style of all figures, and small files."""

import io
import re
from collections.abc import Callable
from typing import Any

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..plots import BLUE, GREEN, GREY, RED, STYLE

__all__ = ["BLUE", "GREEN", "GREY", "RED", "labels", "short", "svg"]


def svg(
    draw: Callable[[Figure], None], size: tuple[float, float] = (7.2, 4.2), style: Any = None, **options: Any
) -> str:
    """Draw a figure of a size [inch] and return its SVG element; `style` changes the style of all figures."""
    with rc_context(STYLE | (style or {})):
        figure = Figure(figsize=size, **{"layout": "constrained"} | options)
        draw(figure)
        text = io.StringIO()
        figure.savefig(text, format="svg", metadata={"Date": None})
    return text.getvalue()[text.getvalue().index("<svg") :]


def short(svg: str) -> str:
    """The same picture in fewer bytes: hundredths of a point, no description, no empty lines."""
    svg = re.sub(r"<metadata>.*?</metadata>", "", svg, flags=re.DOTALL)
    svg = re.sub(r' transform="rotate\(-0 [^"]*"', "", svg)
    svg = re.sub(r"-?\d+\.\d{3,}", lambda number: f"{float(number[0]):.2f}".rstrip("0").rstrip("."), svg)
    return re.sub(r"\s*\n\s*", "\n", svg)


def labels(axes: Axes, x: str, y: str) -> None:
    """Name the axes of a plot that starts at zero."""
    axes.set_xlabel(x)
    axes.set_ylabel(y)
    axes.set_xlim(left=0.0)
    axes.set_ylim(bottom=0.0)
