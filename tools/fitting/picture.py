"""The picture of a fit."""

from typing import TYPE_CHECKING

from .. import plots
from .outcome import FitResult

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def size(outcome: FitResult) -> tuple[float, float]:
    """Of the figure [inch]."""
    return 3.6 * (1 + len(outcome.pictures)), 5.6


def draw(figure: "Figure", outcome: FitResult) -> None:
    """Data and law above, residuals below; pictures side by side."""
    pictures = outcome.pictures
    every = figure.subplots(2, len(pictures), sharex="col", height_ratios=(2.4, 1.0), squeeze=False)
    for (above, below), picture in zip(every.T, pictures, strict=True):
        x, y = picture.x, picture.y
        above.plot(*picture.line, color=plots.BLUE, label="fitted law")
        for (name, line), color in zip(picture.also.items(), (plots.GREEN, plots.GREY), strict=False):
            above.plot(*line, "--", color=color, lw=1.0, label=name)
        above.plot(x, y, ".", color=plots.RED, ms=4, label="data")
        below.axhline(0.0, color=plots.BLUE, lw=1.0)
        below.plot(x, picture.misfit, ".", color=plots.RED, ms=4)
        if picture.marks is not None:
            for axes, values in ((above, y), (below, picture.misfit)):
                axes.plot(x[picture.marks], values[picture.marks], "o", color=plots.RED, ms=7)
        above.set_ylabel(picture.labels[1])
        below.set_xlabel(picture.labels[0])
        below.set_ylabel(picture.labels[2])
        above.legend()
