"""Identify D and G of a surface, or of the equivalent surface of two, with confidence intervals."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jointfmu.quantity import Array
from jointfmu.quantity.refusal import InputRefusal

from .. import fractal
from .bearing_curve import SCAN_PART_COUNT, add_independent_surfaces
from .fit import SelfAffineLaw, fit_self_affine_law
from .form import check_longest_wave, compute_scan_roughness, default_longest_wave, prepare_scan
from .heights import ArealMap, ScanHeights
from .results import (
    MIN_LINE_SIMILARITY_OF_TEXTURE,
    ArealFractal,
    Estimate,
    FractalResult,
    FractalRoughnessEstimate,
    ProfileFractal,
    SurfaceIdentification,
    compute_line_similarity,
    list_identification_warnings,
)
from .spectrum import ScaleSeries, power_spectrum, structure_function

CONFIDENCE_LEVEL = 0.95
"""Level of the confidence intervals [1]."""
MONTE_CARLO_SAMPLES = 4000
"""Number of random samples of the fitted law for confidence intervals [1]."""


def identify_surface(
    surfaces: Sequence[ScanHeights],
    form_name: str = "tilt",
    scale_range: tuple[float, float] | None = None,
    longest_wave: float | None = None,
    contact_side: str | None = None,
    keep_spikes: bool = False,
) -> SurfaceIdentification:
    """Identify fractal dimension D, fractal roughness G and roughness of one surface, or of two together.

    Two independent surfaces have an equivalent surface: its structure function is the sum of their structure
    functions, and its spectrum the sum of their spectra.

    surfaces     : one surface, or two of the same kind (profile or areal map)
    form_name    : form that is removed, one of FORM_NAMES
    scale_range  : range [m] of lags and wavelengths; None: the longest self-affine range
    longest_wave : longest wavelength [m] of the roughness; None: the smallest default of the surfaces
    contact_side : for one surface, its side of the contact, one of CONTACT_SIDES. "1" or "2": the other side
                   is
                   smooth; "both": the other side has the same finish. Of two surfaces, the first is side 1
    keep_spikes  : do not remove spikes
    """
    if len(surfaces) not in (1, 2):
        raise ValueError(f"{len(surfaces)} files given, allowed are one surface or the two of a pair")
    if contact_side is not None and len(surfaces) == 2:
        raise InputRefusal(
            f"side = {contact_side} is given with two files; leave it out: the first file is side 1", "side"
        )
    areal = {isinstance(surface, ArealMap) for surface in surfaces}
    if len(areal) == 2:
        raise ValueError("one file is a profile, the other an areal map; a pair needs two of the same kind")
    if longest_wave is not None:
        for surface in surfaces:
            check_longest_wave(surface, longest_wave)
    prepared = [prepare_scan(surface, form_name, keep_spikes) for surface in surfaces]
    directions = ("areal", "x", "y") if areal == {True} else ("profile",)
    low, high = scale_range or (None, None)
    results = []
    for direction in directions:
        for method in (structure_function, power_spectrum):
            all_series = [
                method(
                    surface.heights_with_gaps if method is structure_function else surface.filled_heights,
                    direction,
                )
                for surface in prepared
            ]
            series = make_two_sided_series(all_series[0]) if contact_side == "both" else all_series[0]
            if len(all_series) == 2:
                series = add_scale_series(all_series[0], all_series[1])
            results.append(_estimate_fractal_parameters(series, fit_self_affine_law(series, low, high)))
    repairs = [
        (surface.filled_heights.scan_name, repair) for surface in prepared for repair in surface.repairs
    ]
    line_shares = [
        compute_line_similarity(surface.filled_heights)
        for surface in prepared
        if isinstance(surface.filled_heights, ArealMap)
    ]
    names = tuple(surface.scan_name for surface in surfaces)
    textured = any(max(shares) > MIN_LINE_SIMILARITY_OF_TEXTURE for shares in line_shares)
    wave = longest_wave or min(default_longest_wave(surface) for surface in surfaces)
    scans = tuple(
        compute_scan_roughness(surface.heights_with_gaps, surface.filled_heights, wave)
        for surface in prepared
    )
    notes = tuple(list_identification_warnings(results, textured))
    samples = [scan.height_sample for scan in scans]
    pairs = [samples, *zip(*(sample.split_into_parts(SCAN_PART_COUNT) for sample in samples), strict=True)]
    is_pair = len(samples) == 2 or contact_side == "both"
    gap, *parts = (add_independent_surfaces(one[0], one[-1]) if is_pair else one[0] for one in pairs)
    return SurfaceIdentification(
        names, tuple(results), tuple(repairs), notes, textured, scans, gap, tuple(parts), contact_side
    )


def make_two_sided_series(one_sided_series: ScaleSeries) -> ScaleSeries:
    """Structure function or spectrum of the gap between two sides with the same finish.

    one_sided_series : structure function or spectrum of one side; both sides add
    """
    return replace(
        one_sided_series,
        smoothed_value=2.0 * one_sided_series.smoothed_value,
        structure_or_psd=2.0 * one_sided_series.structure_or_psd,
    )


def add_scale_series(first_series: ScaleSeries, second_series: ScaleSeries) -> ScaleSeries:
    """Add the structure functions, or the spectra, of two surfaces over their common range of scales.

    The sum is that of the equivalent surface (the gap).

    Raises ValueError if fewer than four scales are common.
    """
    common = (first_series.lag_or_wavelength >= second_series.lag_or_wavelength[0] * 0.999) & (
        first_series.lag_or_wavelength <= second_series.lag_or_wavelength[-1] * 1.001
    )
    if common.sum() < 4:
        raise ValueError(
            f"the scales of the two surfaces do not overlap: {first_series.lag_or_wavelength[0]:.3g} to "
            f"{first_series.lag_or_wavelength[-1]:.3g} m and {second_series.lag_or_wavelength[0]:.3g} to "
            f"{second_series.lag_or_wavelength[-1]:.3g} m"
        )
    first_series = first_series.select_scales(common)
    x1, x2 = np.log(first_series.lag_or_wavelength), np.log(second_series.lag_or_wavelength)
    interpolation = np.stack([np.interp(x1, x2, unit) for unit in np.eye(x2.size)], axis=1)
    value, raw = (
        np.exp(interpolation @ np.log(a))
        for a in (second_series.smoothed_value, second_series.structure_or_psd)
    )
    share = first_series.smoothed_value / (first_series.smoothed_value + value)

    def covariance(H: float) -> Array:
        """Covariance of ln(value) of the summed series, for the Hurst exponent H."""
        covariance1 = first_series.log_value_covariance(H)
        covariance2 = interpolation @ second_series.log_value_covariance(H) @ interpolation.T
        return np.asarray(np.outer(share, share) * covariance1 + np.outer(1 - share, 1 - share) * covariance2)

    return replace(
        first_series,
        smoothed_value=first_series.smoothed_value + value,
        structure_or_psd=first_series.structure_or_psd + raw,
        log_value_covariance=covariance,
    )


def _estimate_fractal_parameters(scale_series: ScaleSeries, fitted_law: SelfAffineLaw) -> FractalResult:
    """Fractal parameters of the profile and of the surface, with intervals by Monte Carlo sampling.

    Only one of the two is measured; the other follows for an isotropic surface.
    """
    rng = np.random.default_rng(0)
    root = np.linalg.cholesky(fitted_law.parameter_covariance)
    draws = (
        np.array([fitted_law.H, fitted_law.log_height_variance])
        + rng.standard_normal((MONTE_CARLO_SAMPLES, 2)) @ root.T
    )
    H = np.clip(np.append(fitted_law.H, draws[:, 0]), 0.005, 0.995)
    level = np.append(fitted_law.log_height_variance, draws[:, 1])
    log = (level + np.log(2.0) - 2.0 * H * np.log(fitted_law.reference_wavelength)) / (2.0 * (1.0 - H))
    shift = np.log(fractal.profile_variance_ratio(H)) / (2.0 * (1.0 - H))
    if scale_series.series_method == "psd" and scale_series.scan_direction == "areal":
        profile, areal = log + shift, log
    else:
        profile, areal = log, log - shift
    return FractalResult(
        series_method=scale_series.series_method,
        scan_direction=scale_series.scan_direction,
        scale_series=scale_series,
        fitted_law=fitted_law,
        profile_fractal=ProfileFractal(
            D=Estimate(*_confidence_interval(2.0 - H)),
            G=FractalRoughnessEstimate.from_logarithms(*_confidence_interval(profile)),
        ),
        areal_fractal=ArealFractal(
            D_s=Estimate(*_confidence_interval(3.0 - H)),
            G_s=FractalRoughnessEstimate.from_logarithms(*_confidence_interval(areal)),
        ),
    )


def _confidence_interval(estimates: Array) -> tuple[float, float, float]:
    """Estimate of a quantity with its confidence interval.

    estimates : the first is the estimate, the others are random samples of it
    """
    low, high = np.quantile(estimates[1:], [0.5 - 0.5 * CONFIDENCE_LEVEL, 0.5 + 0.5 * CONFIDENCE_LEVEL])
    return float(estimates[0]), float(low), float(high)
