"""Identify D and G of a surface, or of the equivalent surface of two, with confidence intervals."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jointfmu.quantity import Array
from jointfmu.quantity.refusal import InputRefusal

from .. import fractal
from .bearing_curve import SCAN_PARTS, add_surfaces
from .fit import SelfAffineLaw, fit_law
from .form import check_longest_wave, default_longest_wave, prepare_scan, scan_roughness
from .heights import ArealMap, Heights
from .results import (
    TEXTURE_THRESHOLD,
    ArealFractal,
    Estimate,
    FractalResult,
    Identification,
    ProfileFractal,
    RoughnessEstimate,
    list_warnings,
    mean_line_shares,
)
from .spectrum import ScaleSeries, power_spectrum, structure_function

CONFIDENCE_LEVEL = 0.95
"""Level of the confidence intervals [1]."""
MONTE_CARLO_SAMPLES = 4000
"""Number of random samples of the fitted law for confidence intervals [1]."""


def identify(
    surfaces: Sequence[Heights],
    form: str = "tilt",
    scale_range: tuple[float, float] | None = None,
    longest_wave: float | None = None,
    side: str | None = None,
    keep_spikes: bool = False,
) -> Identification:
    """Identify D, G and roughness of one surface, or of the equivalent surface of two.

    The equivalent surface of two independent surfaces has the difference of their heights. Its structure
    function is the sum of their structure functions, and its spectrum the sum of their spectra.

    surfaces : one surface, or two of the same kind (profile or areal map)
    form     : form that is removed, one of FORM_NAMES
    scale_range : range [m] of lags and wavelengths; None: the longest self-affine range
    longest_wave : longest wavelength [m] of the roughness; None: the smallest default of the surfaces
    side : for one surface, its side of the contact, one of SCAN_SIDES. "1" or "2": the other side is smooth;
               "both": the other side has the same finish. Of two surfaces, the first is side 1
    keep_spikes : do not remove spikes
    """
    if len(surfaces) not in (1, 2):
        raise ValueError(f"{len(surfaces)} files given, allowed are one surface or the two of a pair")
    if side is not None and len(surfaces) == 2:
        raise InputRefusal(
            f"side = {side} is given with two files; leave it out: the first file is side 1", "side"
        )
    areal = {isinstance(surface, ArealMap) for surface in surfaces}
    if len(areal) == 2:
        raise ValueError("one file is a profile, the other an areal map; a pair needs two of the same kind")
    if longest_wave is not None:
        for surface in surfaces:
            check_longest_wave(surface, longest_wave)
    prepared = [prepare_scan(surface, form, keep_spikes) for surface in surfaces]
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
            series = make_two_sided_series(all_series[0]) if side == "both" else all_series[0]
            if len(all_series) == 2:
                series = add_series(all_series[0], all_series[1])
            results.append(_fractal_result(series, fit_law(series, low, high)))
    repairs = [(surface.filled_heights.name, repair) for surface in prepared for repair in surface.repairs]
    line_shares = [
        mean_line_shares(surface.filled_heights)
        for surface in prepared
        if isinstance(surface.filled_heights, ArealMap)
    ]
    names = tuple(surface.name for surface in surfaces)
    textured = any(max(shares) > TEXTURE_THRESHOLD for shares in line_shares)
    wave = longest_wave or min(default_longest_wave(surface) for surface in surfaces)
    scans = tuple(
        scan_roughness(surface.heights_with_gaps, surface.filled_heights, wave) for surface in prepared
    )
    notes = tuple(list_warnings(results, textured))
    samples = [scan.sample for scan in scans]
    pairs = [samples, *zip(*(sample.split(SCAN_PARTS) for sample in samples), strict=True)]
    is_pair = len(samples) == 2 or side == "both"
    gap, *parts = (add_surfaces(one[0], one[-1]) if is_pair else one[0] for one in pairs)
    return Identification(
        names, tuple(results), tuple(repairs), notes, textured, scans, gap, tuple(parts), side
    )


def make_two_sided_series(one_sided_series: ScaleSeries) -> ScaleSeries:
    """Structure function or spectrum of the gap between two sides with the same finish.

    one_sided_series : structure function or spectrum of one side; both sides add
    """
    return replace(
        one_sided_series,
        value=2.0 * one_sided_series.value,
        structure_or_psd=2.0 * one_sided_series.structure_or_psd,
    )


def add_series(first_series: ScaleSeries, second_series: ScaleSeries) -> ScaleSeries:
    """Add the series of two surfaces over their common range of scales, for the equivalent surface.

    Raises ValueError if fewer than four scales are common.
    """
    common = (first_series.scale >= second_series.scale[0] * 0.999) & (
        first_series.scale <= second_series.scale[-1] * 1.001
    )
    if common.sum() < 4:
        raise ValueError(
            f"the two surfaces share no scales: {first_series.scale[0]:.3g} to "
            f"{first_series.scale[-1]:.3g} m and "
            f"{second_series.scale[0]:.3g} to {second_series.scale[-1]:.3g} m"
        )
    first_series = first_series.select_scales(common)
    x1, x2 = np.log(first_series.scale), np.log(second_series.scale)
    interpolation = np.stack([np.interp(x1, x2, unit) for unit in np.eye(x2.size)], axis=1)
    value, raw = (
        np.exp(interpolation @ np.log(a)) for a in (second_series.value, second_series.structure_or_psd)
    )
    share = first_series.value / (first_series.value + value)

    def covariance(H: float) -> Array:
        """Covariance of ln(value) of the sum."""
        covariance1 = first_series.covariance(H)
        covariance2 = interpolation @ second_series.covariance(H) @ interpolation.T
        return np.asarray(np.outer(share, share) * covariance1 + np.outer(1 - share, 1 - share) * covariance2)

    return replace(
        first_series,
        value=first_series.value + value,
        structure_or_psd=first_series.structure_or_psd + raw,
        covariance=covariance,
    )


def _fractal_result(series: ScaleSeries, law: SelfAffineLaw) -> FractalResult:
    """Fractal parameters of the profile and of the surface, with intervals by Monte Carlo sampling.

    Only one of the two is measured; the other follows for an isotropic surface.
    """
    rng = np.random.default_rng(0)
    root = np.linalg.cholesky(law.covariance)
    draws = np.array([law.H, law.log_power]) + rng.standard_normal((MONTE_CARLO_SAMPLES, 2)) @ root.T
    H = np.clip(np.append(law.H, draws[:, 0]), 0.005, 0.995)
    level = np.append(law.log_power, draws[:, 1])
    log = (level + np.log(2.0) - 2.0 * H * np.log(law.reference_wavelength)) / (2.0 * (1.0 - H))
    shift = np.log(fractal.profile_power_ratio(H)) / (2.0 * (1.0 - H))
    if series.method == "psd" and series.direction == "areal":
        profile, areal = log + shift, log
    else:
        profile, areal = log, log - shift
    return FractalResult(
        method=series.method,
        direction=series.direction,
        series=series,
        fit=law,
        profile=ProfileFractal(
            D=Estimate(*_confidence_interval(2.0 - H)),
            G=RoughnessEstimate.from_logarithms(*_confidence_interval(profile)),
        ),
        areal=ArealFractal(
            D_s=Estimate(*_confidence_interval(3.0 - H)),
            G_s=RoughnessEstimate.from_logarithms(*_confidence_interval(areal)),
        ),
    )


def _confidence_interval(estimates: Array) -> tuple[float, float, float]:
    """Estimate of a quantity with its confidence interval.

    estimates : the first is the estimate, the others are random samples of it
    """
    low, high = np.quantile(estimates[1:], [0.5 - 0.5 * CONFIDENCE_LEVEL, 0.5 + 0.5 * CONFIDENCE_LEVEL])
    return float(estimates[0]), float(low), float(high)
