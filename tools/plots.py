"""Pictures for the command line: one style, one way to save (matplotlib, loaded only when drawing)."""

import io
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from jointfmu.files.outputs import MARK
from jointfmu.files.writing import write_bytes
from jointfmu.quantity.units import UNITS, display_unit

if TYPE_CHECKING:
    from matplotlib.figure import Figure

BLUE, RED, GREEN, GREY = "#1f5fa8", "#c1442e", "#2f7d4f", "#777777"
FORMATS = (".png", ".svg")
STYLE: Any = {
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
RESOLUTION = 150
"""Dots per inch of a PNG."""


def check(path: str | Path) -> None:
    """Raise ValueError if a picture could not be saved under this name, or matplotlib is missing.

    To be called before long work.
    """
    if Path(path).suffix.lower() not in FORMATS:
        raise ValueError(f"{path}: suffix {Path(path).suffix!r} is no picture, allowed are .png, .svg")
    _rc_context()


def shown(unit: str, values: NDArray[np.float64]) -> tuple[str, float]:
    """The display unit in which values read best, and the factor to it."""
    name = display_unit(unit, float(np.max(np.abs(values))))
    return name, UNITS[unit].display[name]


@contextmanager
def drawing(path: str | Path, size: tuple[float, float] = (7.2, 4.2)) -> Iterator["Figure"]:
    """A figure of a size [inch] in the common style, saved at the end of the `with` block.

    with plots.drawing("ramp.png") as figure:
        axes = figure.subplots()
    """
    check(path)
    from matplotlib.figure import Figure

    with style():
        figure = Figure(figsize=size, layout="constrained")
        yield figure
        save(figure, path)


@contextmanager
def style() -> Iterator[None]:
    """The common style, also as a decorator of what draws: `@plots.style()`.

    Raises ValueError if matplotlib is missing.
    """
    with _rc_context()(STYLE):
        yield


def _rc_context() -> Callable[..., AbstractContextManager[None, bool | None]]:
    try:
        from matplotlib import rc_context
    except ImportError:
        raise ValueError(
            "the package matplotlib is missing, needed for plots; install it with: pip install matplotlib"
        ) from None
    return rc_context


def figure(size: tuple[float, float]) -> "Figure":
    """An empty figure of a size [inch] for a user: matplotlib's own `show` and a notebook know it."""
    from matplotlib import get_backend, pyplot

    made = pyplot.figure(figsize=size, layout="constrained")
    if "inline" in get_backend():
        pyplot.close(made)  # a notebook shows what a cell returns, and once more what is open
    return made


def save(figure: "Figure", path: str | Path) -> None:
    """Save a figure as .png or .svg; a failure leaves nothing behind."""
    check(path)
    suffix = Path(path).suffix.lower()
    data = io.BytesIO()
    metadata = {"Date": None, "Description": MARK} if suffix == ".svg" else {"Description": MARK}
    figure.savefig(data, format=suffix[1:], dpi=RESOLUTION, metadata=metadata)
    write_bytes(path, data.getvalue())
