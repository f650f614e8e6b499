"""Picture of an identification: data, law and range of both methods; filled points are in the range."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from jointfmu.contact.fractal import second_difference

from .. import plots
from .heights import Array
from .results import Identification, Result
from .structure import power_law

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLOURS = {"profile": plots.BLUE, "areal": plots.BLUE, "x": plots.RED, "y": plots.GREEN}


def draw(identified: Identification, path: str | Path) -> None:
    """Save the picture as .png or .svg."""
    with plots.drawing(path, (9.6, 5.0)) as figure:
        axes = dict(zip(("structure", "psd"), figure.subplots(1, 2), strict=True))
        for result in identified.results:
            _one(axes[result.method], result)
        axes["structure"].set_title("structure function", loc="left")
        axes["structure"].set_xlabel("lag τ [m]")
        axes["structure"].set_ylabel("S(τ) [m²]")
        axes["psd"].set_title("power spectral density, one-sided", loc="left")
        axes["psd"].set_xlabel("frequency ω [1/m]")
        axes["psd"].set_ylabel("P(ω) [m³]")
        label = f"h = {1e6 * identified.h:.3g} µm: all waves to the right"
        axes["psd"].axvline(1.0 / identified.longest_wave, color=plots.GREY, ls="--", lw=1.0, label=label)
        for panel in axes.values():
            panel.set_xscale("log")
            panel.set_yscale("log")
            _ticks(panel.xaxis)
            _ticks(panel.yaxis)
            panel.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.14))


def _one(axes: "Axes", result: Result) -> None:
    x, y, law = _shown(result)
    inside = (result.series.scale >= result.fit.low * 0.999) & (
        result.series.scale <= result.fit.high * 1.001
    )
    colour = COLOURS[result.direction]
    D, low, high = (
        (result.areal.D_s.value, result.areal.D_s.low, result.areal.D_s.high)
        if result.direction == "areal"
        else (result.profile.D.value, result.profile.D.low, result.profile.D.high)
    )
    name = "D_s" if result.direction == "areal" else "D"
    label = (
        f"{result.direction}: {name} = {D:.3f} ({low:.3f} to {high:.3f}), "
        f"{1e6 * result.fit.low:.3g} to {1e6 * result.fit.high:.3g} µm"
    )
    axes.plot(x, y, "o", ms=3.5, mfc="none", color=colour, alpha=0.5)
    axes.plot(x[inside], y[inside], "o", ms=3.5, color=colour)
    axes.plot(x[inside], law[inside], "-", lw=1.2, color=colour, label=label)


def _ticks(axis: Any) -> None:
    """Labels at 1, 2, 5 of a decade where there are few decades, else at the decades."""
    from matplotlib.ticker import LogFormatterSciNotation, LogLocator, NullFormatter

    low, high = axis.get_view_interval()
    if high < 100.0 * low:
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter(LogFormatterSciNotation(minor_thresholds=(10, 10)))
    axis.set_minor_formatter(NullFormatter())


def _shown(result: Result) -> tuple[Array, Array, Array]:
    """Abscissa, data and law, both freed of what the smoothing over scales does to a power law.

    The structure function is that without tilt, V/(4 - 4^H).
    """
    series, fit = result.series, result.fit
    expected = series.expected(fit.H)
    structure = series.method == "structure"
    pure = power_law(series.scale, fit.H) if structure else series.scale ** (2.0 * fit.H)
    first = expected[np.argmin(np.abs(series.scale - fit.low))]
    law = np.exp(fit.level) * fit.reference ** (-2.0 * fit.H) * (expected + fit.offset * first)
    data, law = series.value * pure / expected, law * pure / expected
    if structure:
        return series.scale, data / second_difference(fit.H), law / second_difference(fit.H)
    return 1.0 / series.scale, data * series.scale, law * series.scale
