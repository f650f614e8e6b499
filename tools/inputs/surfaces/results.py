"""Results of the identification of a surface: fractal parameters, roughness, warnings, plot."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from jointfmu.quantity import Array

from ...common import plots
from ..fractal import second_difference_ratio
from .bearing_curve import MAX_GAUSSIAN_TAIL_OVER_RMS_HEIGHT, BearingCurve, HeightSample, tail_ratio
from .fit import SelfAffineLaw
from .form import Repair, ScanRoughness
from .heights import ArealMap
from .spectrum import ScaleSeries, structure_power_law

if TYPE_CHECKING:
    from matplotlib.axes import Axes


TEXTURE_THRESHOLD = 0.3
"""Mean square of the average line of a map over that of single lines [1], above which it is textured."""


@dataclass(frozen=True, slots=True)
class Estimate:
    """Estimated value of a surface parameter, with the limits of its confidence interval."""

    value: float
    low: float
    high: float


@dataclass(frozen=True, slots=True)
class RoughnessEstimate(Estimate):
    """Estimated roughness G [m] with its confidence interval, from logarithms.

    As D approaches 1, the interval spans hundreds of decades. If it exceeds the range of positive
    floating-point numbers, G is not determined: value, low and high are nan.

    interval_decades : length of the interval [decades], whether or not G is determined
    """

    interval_decades: float

    @property
    def is_determined(self) -> bool:
        """Whether the whole interval is in the range of positive floating-point numbers."""
        return bool(np.isfinite(self.value))

    @classmethod
    def from_logarithms(cls, value: float, low: float, high: float) -> "RoughnessEstimate":
        """Estimate from the natural logarithms of the value and of the limits of its interval."""
        decades = (high - low) / np.log(10.0)
        smallest, largest = np.log([np.finfo(float).tiny, np.finfo(float).max])
        if not smallest <= min(value, low) <= max(value, high) <= largest:
            return cls(np.nan, np.nan, np.nan, float(decades))
        return cls(float(np.exp(value)), float(np.exp(low)), float(np.exp(high)), float(decades))


@dataclass(frozen=True, slots=True, kw_only=True)
class ProfileFractal:
    """Fractal parameters of a profile, 1 < D < 2 (Zhao 2018, Yu 2022)."""

    D: Estimate
    G: RoughnessEstimate


@dataclass(frozen=True, slots=True, kw_only=True)
class ArealFractal:
    """Fractal parameters of an isotropic surface, 2 < D_s < 3 (Hu 2023, Eq. 1)."""

    D_s: Estimate
    G_s: RoughnessEstimate


@dataclass(frozen=True, slots=True, kw_only=True)
class FractalResult:
    """Fractal parameters by one method (structure function or spectrum) in one direction.

    The direction is "profile", "x", "y" or "areal".

    series  : structure function or spectrum over scale
    fit     : self-affine law fitted to the series
    profile : fractal parameters of the profile
    areal   : fractal parameters of the surface
    """

    method: str
    direction: str
    series: ScaleSeries
    fit: SelfAffineLaw
    profile: ProfileFractal
    areal: ArealFractal


@dataclass(frozen=True, slots=True)
class Identification:
    """Identified parameters of one surface, or of the equivalent surface of two.

    file_names  : names of the files
    results     : results of all methods and directions
    repairs     : (file, repair) of all repairs
    warnings    : messages for the user
    is_textured : whether a surface is textured (not isotropic)
    scans       : roughness of each file
    gap         : sample of the gap heights of the measured sides
    gap_parts   : samples of the gap heights, one for each part of the scans
    side        : for a single surface, its side of the contact, one of SCAN_SIDES; None: not given
    """

    file_names: tuple[str, ...]
    results: tuple[FractalResult, ...]
    repairs: tuple[tuple[str, Repair], ...]
    warnings: tuple[str, ...]
    is_textured: bool
    scans: tuple[ScanRoughness, ...]
    gap: HeightSample
    gap_parts: tuple[HeightSample, ...]
    side: str | None = None

    @property
    def roughness_by_side(self) -> dict[int, ScanRoughness]:
        """{side 1 or 2: roughness} of the measured sides; a single scan without a given side is side 1."""
        if len(self.scans) == 2 or self.side == "both":
            return {1: self.scans[0], 2: self.scans[-1]}
        return {int(self.side or 1): self.scans[0]}

    @property
    def h(self) -> float:
        """Combined rms height [m] of both sides for waves up to longest_wave; unmeasured sides are smooth."""
        return float(np.sqrt(sum(scan.h**2 for scan in self.roughness_by_side.values())))

    @property
    def bearing_curve(self) -> BearingCurve:
        """Bearing curve of the gap of the measured sides."""
        return BearingCurve.of_sample(self.gap)

    @property
    def tail_ratio(self) -> float:
        """Rms height of Gaussian heights with the same upper tail as the gap, over the rms gap height [1]."""
        return tail_ratio(self.gap)

    @property
    def is_gaussian(self) -> bool:
        """Whether the upper tail agrees with Gaussian heights; also true if parts of the scan disagree."""
        ratios = [self.tail_ratio, *map(tail_ratio, self.gap_parts)]
        return not (
            max(ratios) < 1.0 / MAX_GAUSSIAN_TAIL_OVER_RMS_HEIGHT
            or min(ratios) > MAX_GAUSSIAN_TAIL_OVER_RMS_HEIGHT
        )

    @property
    def slope(self) -> float:
        """Combined rms slope [1] of both sides; an unmeasured side is smooth."""
        return float(np.sqrt(sum(scan.slope**2 for scan in self.roughness_by_side.values())))

    @property
    def longest_wave(self) -> float:
        """Longest wavelength [m] that contributes to the combined rms height h and slope."""
        return self.scans[0].longest_wave

    def select_best_result(self, direction: str | None = None, method: str | None = None) -> FractalResult:
        """Select the best result in a direction (None: any): self-affine, smallest standard error of D.

        A result with D at an end of its interval comes last, because its standard error is not valid.
        """
        candidates = [r for r in self.select_results_in_direction(direction) if method in (None, r.method)]
        return min(
            candidates, key=lambda r: (r.fit.is_at_bound, not r.fit.is_self_affine, r.fit.covariance[0, 0])
        )

    def select_results_in_direction(self, direction: str | None = None) -> list[FractalResult]:
        """Select the results of all methods in a direction (None: the whole surface)."""
        direction = direction or self.results[0].direction
        return [r for r in self.results if r.direction == direction]

    def undetermined_reason(self, direction: str | None = None) -> str | None:
        """Reason why D and G in a direction are not determined; None if they are.

        D and G are determined if the surface is self-affine by all methods with D inside of its interval, if
        the confidence intervals of D overlap, and if G is determined.
        """
        results = self.select_results_in_direction(direction)
        for result in results:
            D = result.profile.D.value
            if result.fit.is_at_bound:
                return f"D = {D:.2f} ({result.method}) lies at the end of 1 to 2"
            if not result.fit.is_self_affine:
                return f"not self-affine ({result.method})"
        if max(r.profile.D.low for r in results) > min(r.profile.D.high for r in results):
            values = ", ".join(
                f"{r.profile.D.value:.2f} [{r.profile.D.low:.2f}, {r.profile.D.high:.2f}] ({r.method})"
                for r in results
            )
            return f"the methods disagree, D = {values}"
        G = self.select_best_result(direction).profile.G
        return None if G.is_determined else f"the interval of G spans {G.interval_decades:.0f} decades"


def mean_line_shares(heights: ArealMap) -> tuple[float, float]:
    """Mean square of a map's average line over the mean square of its single lines [1], along x and along y.

    The squares are taken of second differences. The result is near 0 for an isotropic surface, and 1 if all
    lines are equal.
    """
    shares = []
    for z in (heights.z, heights.z.T):
        lag = max(2, z.shape[1] // 32)
        second = z[:, 2 * lag :] - 2.0 * z[:, lag:-lag] + z[:, : -2 * lag]
        total = float(np.mean(second**2))
        shares.append(float(np.mean(second.mean(axis=0) ** 2)) / total if total > 0.0 else 1.0)
    return shares[0], shares[1]


def list_warnings(fractal_results: Sequence[FractalResult], is_textured: bool) -> list[str]:
    """Warnings for the user about the results of one surface.

    fractal_results : results of all directions and methods; the first two are of the whole surface
    """
    lines = []
    if is_textured:
        lines.append(
            "the surface is textured (its lines repeat): D_s and G_s of an isotropic surface do not describe "
            "it, use D and G along x and y"
        )
    for result in fractal_results:
        label = f"{result.method}, {result.direction}"
        if not (result.fit.is_self_affine or result.fit.drift_covers_dimensions):
            lines.append(
                f"{label}: not self-affine over {result.fit.min_scale:.3g} to "
                f"{result.fit.max_scale:.3g} m: D drifts by "
                f"{result.fit.dimension_drift:+.2f}, deviation from the law "
                f"{100.0 * result.fit.excess_deviation:.0f} %"
            )
        if result.fit.range_decades < 1.0:
            lines.append(f"{label}: the range spans {result.fit.range_decades:.2f} decades, less than one")
        if result.fit.drift_covers_dimensions:
            lines.append(
                f"{label}: over all scales D runs through its interval from 1 to 2, and only a piece of "
                f"{result.fit.range_decades:.2f} decades is straight; state a range to take it"
            )
        if result.fit.is_at_bound:
            lines.append(f"{label}: D = {result.profile.D.value:.2f} lies at the end of 1 to 2; no fractal")
    G = min(fractal_results[:2], key=lambda result: result.fit.covariance[0, 0]).profile.G
    if G.interval_decades > 4.0:
        lines.append(
            f"G is {'hardly' if G.is_determined else 'not'} determined: its interval spans "
            f"{G.interval_decades:.1f} "
            "decades; a larger patch or more decades are needed"
        )
    structures, spectra = fractal_results[0].profile.D, fractal_results[1].profile.D
    if structures.low > spectra.high or spectra.low > structures.high:
        lines.append(f"the methods disagree: D = {structures.value:.3f} and {spectra.value:.3f}")
    return lines


DIRECTION_COLOURS = {"profile": plots.BLUE, "areal": plots.BLUE, "x": plots.RED, "y": plots.GREEN}
"""{direction of a result: colour in the plot}."""


def draw_identification(identified_surface: Identification, path: str | Path) -> None:
    """Plot structure functions and spectra with the fitted laws, as .png or .svg."""
    with plots.open_figure(path, (9.6, 5.0)) as figure:
        axes = dict(zip(("structure", "psd"), figure.subplots(1, 2), strict=True))
        for result in identified_surface.results:
            _draw_result(axes[result.method], result)
        axes["structure"].set_title("structure function", loc="left")
        axes["structure"].set_xlabel("lag τ [m]")
        axes["structure"].set_ylabel("S(τ) [m²]")
        axes["psd"].set_title("power spectral density, one-sided", loc="left")
        axes["psd"].set_xlabel("frequency ω [1/m]")
        axes["psd"].set_ylabel("P(ω) [m³]")
        label = f"h = {1e6 * identified_surface.h:.3g} µm: all waves to the right"
        axes["psd"].axvline(
            1.0 / identified_surface.longest_wave, color=plots.GREY, ls="--", lw=1.0, label=label
        )
        for panel in axes.values():
            panel.set_xscale("log")
            panel.set_yscale("log")
            _set_ticks(panel.xaxis)
            _set_ticks(panel.yaxis)
            panel.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.14))


def _draw_result(axes: "Axes", fractal_result: FractalResult) -> None:
    """Plot one result: all data, data in the range of the fit, and the fitted law."""
    x, y, law = _plot_data(fractal_result)
    inside = (fractal_result.series.scale >= fractal_result.fit.min_scale * 0.999) & (
        fractal_result.series.scale <= fractal_result.fit.max_scale * 1.001
    )
    colour = DIRECTION_COLOURS[fractal_result.direction]
    D, low, high = (
        (fractal_result.areal.D_s.value, fractal_result.areal.D_s.low, fractal_result.areal.D_s.high)
        if fractal_result.direction == "areal"
        else (fractal_result.profile.D.value, fractal_result.profile.D.low, fractal_result.profile.D.high)
    )
    name = "D_s" if fractal_result.direction == "areal" else "D"
    label = (
        f"{fractal_result.direction}: {name} = {D:.3f} ({low:.3f} to {high:.3f}), "
        f"{1e6 * fractal_result.fit.min_scale:.3g} to {1e6 * fractal_result.fit.max_scale:.3g} µm"
    )
    axes.plot(x, y, "o", ms=3.5, mfc="none", color=colour, alpha=0.5)
    axes.plot(x[inside], y[inside], "o", ms=3.5, color=colour)
    axes.plot(x[inside], law[inside], "-", lw=1.2, color=colour, label=label)


def _set_ticks(axis: Any) -> None:
    """Set tick labels of a logarithmic axis: at 1, 2, 5 in each decade below two decades, else at decades."""
    from matplotlib.ticker import LogFormatterSciNotation, LogLocator, NullFormatter

    low, high = axis.get_view_interval()
    if high < 100.0 * low:
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter(LogFormatterSciNotation(minor_thresholds=(10, 10)))
    axis.set_minor_formatter(NullFormatter())


def _plot_data(fractal_result: FractalResult) -> tuple[Array, Array, Array]:
    """Abscissa, measured values and fitted law of the plot: structure function, or power spectral density.

    Both are plotted as they are before the smoothing over neighbouring lags or wavelengths. The structure
    function is V/(4 - 4^H), with the second difference V of the heights, from which a tilt of the surface
    cancels.
    """
    series, fit = fractal_result.series, fractal_result.fit
    expected = series.expected_value(fit.H)
    is_structure = series.method == "structure"
    unsmoothed = structure_power_law(series.scale, fit.H) if is_structure else series.scale ** (2.0 * fit.H)
    first = expected[np.argmin(np.abs(series.scale - fit.min_scale))]
    law = (
        np.exp(fit.log_power)
        * fit.reference_wavelength ** (-2.0 * fit.H)
        * (expected + fit.relative_offset * first)
    )
    data, law = series.value * unsmoothed / expected, law * unsmoothed / expected
    if is_structure:
        return series.scale, data / second_difference_ratio(fit.H), law / second_difference_ratio(fit.H)
    return 1.0 / series.scale, data * series.scale, law * series.scale
