"""Pictures of a study: bands over the load with the indices below, or distributions at one load."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from .. import plots
from .propagate import QUANTILES, Bands
from .sensitivity import Sensitivity

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_COLOURS = (plots.BLUE, plots.RED, plots.GREEN, "#b8860b", "#7b4fa3", "#3a9ca6", plots.GREY, "#a65628")


def draw(path: Path, bands: Bands, sensitivity: Sensitivity | None, load: str) -> None:
    """One column per output: bands, and total (line) and first-order (dashed) indices over the load."""
    names = list(bands.quantiles)
    rows = 1 if sensitivity is None or bands.loads.size == 1 else 2
    with plots.drawing(path, (4.2 * len(names), 3.6 * rows)) as figure:
        grid = figure.subplots(rows, len(names), squeeze=False)
        for column, name in enumerate(names):
            label = f"{name} [{bands.units[name]}]"
            if bands.loads.size == 1:
                _spread(grid[0, column], bands, name, label)
                continue
            _bands(grid[0, column], bands, name, label, load)
            if sensitivity is not None:
                _indices(grid[1, column], sensitivity, name, load, legend=column == 0)


def _bands(axes: "Axes", bands: Bands, name: str, label: str, load: str) -> None:
    q = dict(zip(QUANTILES, bands.quantiles[name], strict=True))
    for low, high, shade in ((0.01, 0.99, 0.12), (0.05, 0.95, 0.2), (0.25, 0.75, 0.3)):
        text = f"{100 * low:g} to {100 * high:g} %"
        axes.fill_between(
            bands.loads, q[low], q[high], color=plots.BLUE, alpha=shade, linewidth=0, label=text
        )
    axes.plot(bands.loads, q[0.5], color=plots.BLUE, label="median")
    axes.plot(bands.loads, bands.nominal[name], color=plots.RED, linestyle="--", label="parameter file")
    axes.set(xlabel=load, ylabel=label, xlim=(0.0, bands.loads[-1]), ylim=(0.0, None))
    axes.legend(fontsize=8)


def _spread(axes: "Axes", bands: Bands, name: str, label: str) -> None:
    axes.plot(bands.quantiles[name][:, 0], 100.0 * np.array(QUANTILES), "o-", color=plots.BLUE)
    axes.axvline(bands.nominal[name][0], color=plots.RED, linestyle="--", label="parameter file")
    axes.set(xlabel=label, ylabel="samples below [%]", ylim=(0.0, 100.0))
    axes.legend(fontsize=8)


def _indices(axes: "Axes", sensitivity: Sensitivity, name: str, load: str, legend: bool) -> None:
    indices = sensitivity.outputs[name]
    for i, parameter in enumerate(sensitivity.names):
        colour = _COLOURS[i % len(_COLOURS)]
        low, high = (
            indices.total[:, i] - indices.total_half[:, i],
            indices.total[:, i] + indices.total_half[:, i],
        )
        axes.fill_between(sensitivity.loads, low, high, color=colour, alpha=0.2, linewidth=0)
        axes.plot(sensitivity.loads, indices.total[:, i], color=colour, label=parameter)
        axes.plot(sensitivity.loads, indices.first[:, i], color=colour, linestyle="--")
    axes.set(xlabel=load, ylabel=f"Sobol' indices of {name}", xlim=(0.0, None), ylim=(0.0, 1.05))
    if legend:
        axes.plot([], [], color=plots.GREY, label="total")
        axes.plot([], [], color=plots.GREY, linestyle="--", label="first order")
        axes.legend(fontsize=8)
