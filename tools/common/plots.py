"""Figures for the command line: common style and saving (matplotlib, loaded only when drawing)."""

import io
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from jointfmu.files.outputs import PROGRAM_MARK
from jointfmu.files.writing import write_bytes
from jointfmu.quantity.units import UNITS, display_unit

if TYPE_CHECKING:
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure

BLUE, RED, GREEN, GREY = "#1f5fa8", "#c1442e", "#2f7d4f", "#777777"
PICTURE_FORMATS = (".png", ".svg")
"""File name endings of pictures that can be written."""
STYLE_SETTINGS: Any = {
    "svg.hashsalt": "jointfmu",
    "svg.fonttype": "path",
    "font.family": "DejaVu Sans",
    "font.size": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#e4e4e4",
    "axes.axisbelow": True,
    "legend.frameon": False,
}
"""Settings of matplotlib for all figures."""
PNG_RESOLUTION = 150
"""Resolution of a PNG [dots per inch]."""


def check_picture_path(picture_path: str | Path) -> None:
    """Raise ValueError if the file name has no picture format, or if matplotlib is missing.

    Call it before long work.
    """
    if Path(picture_path).suffix.lower() not in PICTURE_FORMATS:
        raise ValueError(
            f"{picture_path}: suffix {Path(picture_path).suffix!r} is not that of a picture, allowed are "
            ".png, .svg"
        )
    _load_matplotlib_settings()


def choose_plot_unit(si_unit: str, si_values: NDArray[np.float64]) -> tuple[str, float]:
    """Choose a display unit by the largest of some values. Returns the unit and the factor to it."""
    name = display_unit(si_unit, float(np.max(np.abs(si_values), initial=0.0)))
    return name, UNITS[si_unit].display_factors[name]


@contextmanager
def open_figure(
    picture_path: str | Path, figure_size: tuple[float, float] = (7.2, 4.2)
) -> Iterator["Figure"]:
    """Create a figure of a size [inch] in the common style; it is saved at the end of the `with` block.

    with plots.open_figure("ramp.png") as figure:
        axes = figure.subplots()
    """
    check_picture_path(picture_path)
    from matplotlib.figure import Figure

    with apply_plot_style():
        figure = Figure(figsize=figure_size, layout="constrained")
        yield figure
        save_figure(figure, picture_path)


@contextmanager
def apply_plot_style() -> Iterator[None]:
    """Apply the common style in a `with` block, or as a decorator of a function that draws.

    At the end, only the settings of the style are restored. Other settings that change inside the block keep
    their new value: the first figure of a notebook switches pyplot to interactive mode.
    Raises ValueError if matplotlib is missing.
    """
    settings = _load_matplotlib_settings()
    former = {name: settings[name] for name in STYLE_SETTINGS}
    settings.update(STYLE_SETTINGS)
    try:
        yield
    finally:
        settings.update(former)


def _load_matplotlib_settings() -> Any:
    try:
        from matplotlib import rcParams
    except ImportError:
        raise ValueError(
            "the package matplotlib is missing, needed for plots; install it with: pip install matplotlib"
        ) from None
    return rcParams


def create_figure(figure_size: tuple[float, float]) -> "Figure":
    """Create an empty figure of a size [inch]. `pyplot.show` and notebooks display it once."""
    from matplotlib import pyplot

    figure = pyplot.figure(figsize=figure_size, layout="constrained")
    setattr(figure, "_repr_mimebundle_", partial(_close_in_notebook, figure))  # noqa: B010 (unknown to mypy)
    return figure


def _close_in_notebook(figure: "Figure", **_: object) -> dict[str, str]:
    """Close a figure that IPython displays as the result of a cell.

    A notebook displays the open figures at the end of a cell, and would display this one twice. Returns {}:
    IPython makes the picture as for other figures.
    """
    from matplotlib import get_backend, pyplot

    if "inline" in get_backend():
        pyplot.close(figure)
    return {}


def set_log_axis_ticks(axis: "Axis") -> None:
    """Set tick labels of a logarithmic axis: at 1, 2, 5 in each decade below two decades, else at decades.

    Below a factor of 3 between the ends of the axis, the labels are those of a linear axis.
    """
    from matplotlib.ticker import (
        LogFormatterSciNotation,
        LogLocator,
        MaxNLocator,
        NullFormatter,
        ScalarFormatter,
    )

    low, high = axis.get_view_interval()
    if high < 3.0 * low:
        axis.set_major_locator(MaxNLocator(4))
        axis.set_major_formatter(ScalarFormatter())
    elif high < 100.0 * low:
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter(LogFormatterSciNotation(minor_thresholds=(10, 10)))
    axis.set_minor_formatter(NullFormatter())


def save_figure(figure: "Figure", picture_path: str | Path) -> None:
    """Save a figure as .png or .svg. A failure leaves no file."""
    check_picture_path(picture_path)
    suffix = Path(picture_path).suffix.lower()
    data = io.BytesIO()
    metadata = (
        {"Date": None, "Description": PROGRAM_MARK} if suffix == ".svg" else {"Description": PROGRAM_MARK}
    )
    figure.savefig(data, format=suffix[1:], dpi=PNG_RESOLUTION, metadata=metadata)
    write_bytes(picture_path, data.getvalue())
