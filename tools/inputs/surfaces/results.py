"""Results of the identification of a surface: fractal parameters, roughness, warnings, plot."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from jointfmu.quantity import Array

from ...common import plots
from ..fractal import second_difference_ratio
from .bearing_curve import MAX_GAUSSIAN_TAIL_OVER_RMS_HEIGHT, BearingCurve, HeightSample, tail_over_rms_height
from .fit import SelfAffineLaw
from .form import ScanRepair, ScanRoughness
from .heights import ArealMap
from .spectrum import ScaleSeries, second_difference_power_law

if TYPE_CHECKING:
    from matplotlib.axes import Axes


MIN_LINE_SIMILARITY_OF_TEXTURE = 0.3
"""Mean square of the average line of a map over that of single lines [1], above which it is textured."""


@dataclass(frozen=True, slots=True)
class Estimate:
    """Estimated value of a surface parameter, with the limits of its confidence interval."""

    estimated_value: float
    confidence_interval_low: float
    confidence_interval_high: float


@dataclass(frozen=True, slots=True)
class FractalRoughnessEstimate(Estimate):
    """Estimated fractal roughness G [m] with its confidence interval, from logarithms.

    As the fractal dimension D approaches 1, the interval spans hundreds of decades. If it exceeds the range
    of positive floating-point numbers, G is not determined: value and limits are nan.

    interval_decades : length of the interval [decades], whether or not G is determined
    """

    interval_decades: float

    @property
    def is_determined(self) -> bool:
        """Whether the confidence interval of G is within the range of positive floating-point numbers."""
        return bool(np.isfinite(self.estimated_value))

    @classmethod
    def from_logarithms(
        cls, log_value: float, log_interval_low: float, log_interval_high: float
    ) -> "FractalRoughnessEstimate":
        """Estimate from the natural logarithms of the value and of the limits of its interval."""
        decades = (log_interval_high - log_interval_low) / np.log(10.0)
        smallest, largest = np.log([np.finfo(float).tiny, np.finfo(float).max])
        if not smallest <= min(log_value, log_interval_low) <= max(log_value, log_interval_high) <= largest:
            return cls(np.nan, np.nan, np.nan, float(decades))
        return cls(
            float(np.exp(log_value)),
            float(np.exp(log_interval_low)),
            float(np.exp(log_interval_high)),
            float(decades),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class ProfileFractal:
    """Fractal dimension D and roughness G of a profile, 1 < D < 2 (Zhao 2018, Yu 2022)."""

    D: Estimate
    G: FractalRoughnessEstimate


@dataclass(frozen=True, slots=True, kw_only=True)
class ArealFractal:
    """Fractal dimension D_s and roughness G_s of an isotropic surface, 2 < D_s < 3 (Hu 2023, Eq. 1)."""

    D_s: Estimate
    G_s: FractalRoughnessEstimate


@dataclass(frozen=True, slots=True, kw_only=True)
class FractalResult:
    """Fractal parameters by one method (structure function or spectrum) in one direction.

    The direction is "profile", "x", "y" or "areal".

    scale_series    : structure function or spectrum over lag or wavelength
    fitted_law      : self-affine law fitted to the series
    profile_fractal : fractal parameters of the profile
    areal_fractal   : fractal parameters of the surface
    """

    series_method: str
    scan_direction: str
    scale_series: ScaleSeries
    fitted_law: SelfAffineLaw
    profile_fractal: ProfileFractal
    areal_fractal: ArealFractal


@dataclass(frozen=True, slots=True)
class SurfaceIdentification:
    """Identified fractal parameters and roughness of one surface, or of the equivalent surface of two.

    file_names       : names of the files
    fractal_results  : results of all methods and directions
    scan_repairs     : (file, repair) of all repairs
    warnings         : messages for the user
    is_textured      : whether a surface is textured (not isotropic)
    scan_roughnesses : roughness of each file
    gap_sample       : heights and slopes of the gap between the measured sides
    gap_part_samples : heights and slopes of the gap, one sample for each part of the scans
    contact_side     : for a single surface, its side of the contact, one of CONTACT_SIDES; None: not given
    """

    file_names: tuple[str, ...]
    fractal_results: tuple[FractalResult, ...]
    scan_repairs: tuple[tuple[str, ScanRepair], ...]
    warnings: tuple[str, ...]
    is_textured: bool
    scan_roughnesses: tuple[ScanRoughness, ...]
    gap_sample: HeightSample
    gap_part_samples: tuple[HeightSample, ...]
    contact_side: str | None = None

    @property
    def roughness_by_side(self) -> dict[int, ScanRoughness]:
        """{side 1 or 2: roughness} of the measured sides; a single scan without a given side is side 1."""
        if len(self.scan_roughnesses) == 2 or self.contact_side == "both":
            return {1: self.scan_roughnesses[0], 2: self.scan_roughnesses[-1]}
        return {int(self.contact_side or 1): self.scan_roughnesses[0]}

    @property
    def combined_rms_height(self) -> float:
        """Combined rms height [m] of both sides for waves up to longest_wave; unmeasured sides are smooth."""
        return float(np.sqrt(sum(scan.long_wave_rms_height**2 for scan in self.roughness_by_side.values())))

    @property
    def bearing_curve(self) -> BearingCurve:
        """Bearing curve of the gap of the measured sides."""
        return BearingCurve.from_height_sample(self.gap_sample)

    @property
    def tail_over_rms_height(self) -> float:
        """Ratio [1] of two rms heights: Gaussian heights with the same upper tail as the gap, and the gap."""
        return tail_over_rms_height(self.gap_sample)

    @property
    def is_gaussian(self) -> bool:
        """Whether the upper tail of the heights can be that of a Gaussian surface.

        False only if the tails of the whole scan and of all its parts deviate in the same direction.
        """
        ratios = [self.tail_over_rms_height, *map(tail_over_rms_height, self.gap_part_samples)]
        return not (
            max(ratios) < 1.0 / MAX_GAUSSIAN_TAIL_OVER_RMS_HEIGHT
            or min(ratios) > MAX_GAUSSIAN_TAIL_OVER_RMS_HEIGHT
        )

    @property
    def combined_rms_slope(self) -> float:
        """Combined rms slope [1] of both sides; an unmeasured side is smooth."""
        return float(np.sqrt(sum(scan.rms_slope**2 for scan in self.roughness_by_side.values())))

    @property
    def longest_wave(self) -> float:
        """Longest wavelength [m] that contributes to the combined rms height h and slope."""
        return self.scan_roughnesses[0].longest_wave

    def select_best_result(
        self, scan_direction: str | None = None, series_method: str | None = None
    ) -> FractalResult:
        """Select the best result in a direction (None: any): self-affine, smallest standard error of D.

        A result with D at an end of its interval comes last, because its standard error is not valid.
        """
        candidates = [
            r
            for r in self.select_results_in_direction(scan_direction)
            if series_method in (None, r.series_method)
        ]
        return min(
            candidates,
            key=lambda r: (
                r.fitted_law.is_at_bound,
                not r.fitted_law.is_self_affine,
                r.fitted_law.parameter_covariance[0, 0],
            ),
        )

    def select_results_in_direction(self, scan_direction: str | None = None) -> list[FractalResult]:
        """Select the results of all methods in a direction (None: the whole surface)."""
        scan_direction = scan_direction or self.fractal_results[0].scan_direction
        return [r for r in self.fractal_results if r.scan_direction == scan_direction]

    def undetermined_reason(self, scan_direction: str | None = None) -> str | None:
        """Reason why fractal dimension D and roughness G in a direction are not determined; None if they are.

        D and G are determined if the surface is self-affine by all methods with D inside of its interval, if
        the confidence intervals of D overlap, and if G is determined.
        """
        results = self.select_results_in_direction(scan_direction)
        for result in results:
            D = result.profile_fractal.D.estimated_value
            if result.fitted_law.is_at_bound:
                return f"D = {D:.2f} ({result.series_method}) lies at the end of 1 to 2"
            if not result.fitted_law.is_self_affine:
                return f"not self-affine ({result.series_method})"
        if max(r.profile_fractal.D.confidence_interval_low for r in results) > min(
            r.profile_fractal.D.confidence_interval_high for r in results
        ):
            values = ", ".join(
                f"{r.profile_fractal.D.estimated_value:.2f} "
                f"[{r.profile_fractal.D.confidence_interval_low:.2f}, "
                f"{r.profile_fractal.D.confidence_interval_high:.2f}] ({r.series_method})"
                for r in results
            )
            return f"the methods disagree, D = {values}"
        G = self.select_best_result(scan_direction).profile_fractal.G
        return None if G.is_determined else f"the interval of G spans {G.interval_decades:.0f} decades"


def compute_line_similarity(heights: ArealMap) -> tuple[float, float]:
    """Similarity [1] of the lines of a map, along x and along y: near 0 if isotropic, 1 if all are equal.

    Each value is the mean square of the second differences of the average line, divided by that of the single
    lines [1].
    """
    shares = []
    for z in (heights.z, heights.z.T):
        lag = max(2, z.shape[1] // 32)
        second = z[:, 2 * lag :] - 2.0 * z[:, lag:-lag] + z[:, : -2 * lag]
        total = float(np.mean(second**2))
        shares.append(float(np.mean(second.mean(axis=0) ** 2)) / total if total > 0.0 else 1.0)
    return shares[0], shares[1]


def list_identification_warnings(fractal_results: Sequence[FractalResult], is_textured: bool) -> list[str]:
    """Warnings for the user about the fractal parameters of one surface.

    fractal_results : results of all directions and methods; the first two are of the whole surface
    """
    lines = []
    if is_textured:
        lines.append(
            "the surface is textured (its lines repeat): D_s and G_s of an isotropic surface do not describe "
            "it, use D and G along x and y"
        )
    for result in fractal_results:
        label = f"{result.series_method}, {result.scan_direction}"
        if not (result.fitted_law.is_self_affine or result.fitted_law.is_range_too_short_for_drift):
            lines.append(
                f"{label}: not self-affine over {result.fitted_law.min_scale:.3g} to "
                f"{result.fitted_law.max_scale:.3g} m: D drifts by "
                f"{result.fitted_law.dimension_drift:+.2f}, deviation from the power law "
                f"{100.0 * result.fitted_law.excess_deviation:.0f} %"
            )
        if result.fitted_law.range_decades < 1.0:
            lines.append(
                f"{label}: the range spans {result.fitted_law.range_decades:.2f} decades, expected at least "
                "one"
            )
        if result.fitted_law.is_range_too_short_for_drift:
            lines.append(
                f"{label}: D changes from 1 to 2 over all scales, and only "
                f"{result.fitted_law.range_decades:.2f} decades follow a power law; state a range to use "
                "them"
            )
        if result.fitted_law.is_at_bound:
            lines.append(
                f"{label}: D = {result.profile_fractal.D.estimated_value:.2f} is at the end of 1 to 2: no "
                "fractal surface"
            )
    G = min(
        fractal_results[:2], key=lambda result: result.fitted_law.parameter_covariance[0, 0]
    ).profile_fractal.G
    if G.interval_decades > 4.0:
        lines.append(
            f"G is {'hardly' if G.is_determined else 'not'} determined: its interval spans "
            f"{G.interval_decades:.1f} decades; measure a larger patch, or more decades"
        )
    structures, spectra = fractal_results[0].profile_fractal.D, fractal_results[1].profile_fractal.D
    if (
        structures.confidence_interval_low > spectra.confidence_interval_high
        or spectra.confidence_interval_low > structures.confidence_interval_high
    ):
        lines.append(
            f"the methods disagree: D = {structures.estimated_value:.3f} "
            f"({fractal_results[0].series_method}) and {spectra.estimated_value:.3f} "
            f"({fractal_results[1].series_method}); state a range where both follow a power law"
        )
    return lines


DIRECTION_COLOURS = {"profile": plots.BLUE, "areal": plots.BLUE, "x": plots.RED, "y": plots.GREEN}
"""{direction of a result: colour in the plot}."""


def draw_identification(identified_surface: SurfaceIdentification, picture_path: str | Path) -> None:
    """Plot structure functions and spectra with the fitted laws, as .png or .svg."""
    with plots.open_figure(picture_path, (9.6, 5.0)) as figure:
        axes = dict(zip(("structure", "psd"), figure.subplots(1, 2), strict=True))
        for result in identified_surface.fractal_results:
            _draw_fractal_result(axes[result.series_method], result)
        axes["structure"].set_title("structure function", loc="left")
        axes["structure"].set_xlabel("lag τ [m]")
        axes["structure"].set_ylabel("S(τ) [m²]")
        axes["psd"].set_title("power spectral density, one-sided", loc="left")
        axes["psd"].set_xlabel("frequency ω [1/m]")
        axes["psd"].set_ylabel("P(ω) [m³]")
        label = f"h = {1e6 * identified_surface.combined_rms_height:.3g} µm: all waves to the right"
        axes["psd"].axvline(
            1.0 / identified_surface.longest_wave, color=plots.GREY, ls="--", lw=1.0, label=label
        )
        for panel in axes.values():
            panel.set_xscale("log")
            panel.set_yscale("log")
            plots.set_log_axis_ticks(panel.xaxis)
            plots.set_log_axis_ticks(panel.yaxis)
            panel.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.14))


def _draw_fractal_result(axes: "Axes", fractal_result: FractalResult) -> None:
    """Plot one result: all data, data in the range of the fit, and the fitted law."""
    x, y, law = _plot_data(fractal_result)
    inside = (
        fractal_result.scale_series.lag_or_wavelength >= fractal_result.fitted_law.min_scale * 0.999
    ) & (fractal_result.scale_series.lag_or_wavelength <= fractal_result.fitted_law.max_scale * 1.001)
    colour = DIRECTION_COLOURS[fractal_result.scan_direction]
    D, low, high = (
        (
            fractal_result.areal_fractal.D_s.estimated_value,
            fractal_result.areal_fractal.D_s.confidence_interval_low,
            fractal_result.areal_fractal.D_s.confidence_interval_high,
        )
        if fractal_result.scan_direction == "areal"
        else (
            fractal_result.profile_fractal.D.estimated_value,
            fractal_result.profile_fractal.D.confidence_interval_low,
            fractal_result.profile_fractal.D.confidence_interval_high,
        )
    )
    name = "D_s" if fractal_result.scan_direction == "areal" else "D"
    label = (
        f"{fractal_result.scan_direction}: {name} = {D:.3f} ({low:.3f} to {high:.3f}), "
        f"{1e6 * fractal_result.fitted_law.min_scale:.3g} to "
        f"{1e6 * fractal_result.fitted_law.max_scale:.3g} µm"
    )
    axes.plot(x, y, "o", ms=3.5, mfc="none", color=colour, alpha=0.5)
    axes.plot(x[inside], y[inside], "o", ms=3.5, color=colour)
    axes.plot(x[inside], law[inside], "-", lw=1.2, color=colour, label=label)


def _plot_data(fractal_result: FractalResult) -> tuple[Array, Array, Array]:
    """Abscissa, measured values and fitted law of the plot: structure function, or power spectral density.

    Both are plotted as they are before the smoothing over neighbouring lags or wavelengths. The structure
    function is V/(4 - 4^H), with the second difference V of the heights, from which a tilt of the surface
    cancels.
    """
    series, fit = fractal_result.scale_series, fractal_result.fitted_law
    expected = series.expected_value(fit.H)
    is_structure = series.series_method == "structure"
    unsmoothed = (
        second_difference_power_law(series.lag_or_wavelength, fit.H)
        if is_structure
        else series.lag_or_wavelength ** (2.0 * fit.H)
    )
    first = expected[np.argmin(np.abs(series.lag_or_wavelength - fit.min_scale))]
    law = (
        np.exp(fit.log_height_variance)
        * fit.reference_wavelength ** (-2.0 * fit.H)
        * (expected + fit.relative_offset * first)
    )
    data, law = series.smoothed_value * unsmoothed / expected, law * unsmoothed / expected
    if is_structure:
        return (
            series.lag_or_wavelength,
            data / second_difference_ratio(fit.H),
            law / second_difference_ratio(fit.H),
        )
    return 1.0 / series.lag_or_wavelength, data * series.lag_or_wavelength, law * series.lag_or_wavelength
