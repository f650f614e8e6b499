"""D and G of a surface, or of the equivalent surface of a pair, with confidence intervals and warnings."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jointfmu.quantity import Array
from jointfmu.quantity.refusal import Refusal

from .. import fractal
from .fit import SelfAffineLaw, fit
from .form import check_wave, default_wave, of_scan, prepare
from .heights import Areal, Heights
from .results import (
    TEXTURE,
    ArealFractal,
    Estimate,
    Identification,
    ProfileFractal,
    Result,
    RoughnessEstimate,
    texture,
    warnings,
)
from .spectrum import ScaleSeries, psd, structure

LEVEL = 0.95
"""Level of the confidence intervals."""
DRAWS = 4000


def identify(
    surfaces: Sequence[Heights],
    form: str = "tilt",
    span: tuple[float, float] | None = None,
    longest: float | None = None,
    side: str | None = None,
    keep_spikes: bool = False,
) -> Identification:
    """Identify one surface, or the equivalent surface of two.

    surfaces : one, or two of the same kind; of two independent surfaces the difference of heights counts,
        whose structure function and spectrum are the sums of theirs
    form     : what is removed, see `form.FORMS`
    span     : scaling range [m] of lags and wavelengths; by default the longest straight one is searched
    longest  : longest wave [m] of the roughness; by default the shortest `default_wave` of the surfaces
    side     : of one surface, the side of the contact that it is, one of SIDES: on a smooth other side, or
               on another one like it; of two surfaces the first is side 1
    keep_spikes : whether spikes are heights like all others
    """
    if len(surfaces) not in (1, 2):
        raise ValueError(f"{len(surfaces)} files given, allowed are one surface or the two of a pair")
    if side is not None and len(surfaces) == 2:
        raise Refusal(f"side = {side} beside two files, of which the first is side 1; leave it out", "side")
    areal = {isinstance(surface, Areal) for surface in surfaces}
    if len(areal) == 2:
        raise ValueError("a profile and an areal map given, a pair needs two of the same kind")
    if longest is not None:
        for surface in surfaces:
            check_wave(surface, longest)
    prepared = [prepare(surface, form, keep_spikes) for surface in surfaces]
    directions = ("areal", "x", "y") if areal == {True} else ("profile",)
    low, high = span or (None, None)
    results = []
    for direction in directions:
        for method in (structure, psd):
            parts = [
                method(surface.gappy if method is structure else surface.whole, direction)
                for surface in prepared
            ]
            series = doubled(parts[0]) if side == "both" else parts[0]
            if len(parts) == 2:
                series = added(parts[0], parts[1])
            results.append(_result(series, fit(series, low, high)))
    repairs = [(surface.whole.name, repair) for surface in prepared for repair in surface.repairs]
    repeats = [texture(surface.whole) for surface in prepared if isinstance(surface.whole, Areal)]
    names = tuple(surface.name for surface in surfaces)
    textured = any(max(shares) > TEXTURE for shares in repeats)
    wave = longest or min(default_wave(surface) for surface in surfaces)
    scans = tuple(of_scan(surface.gappy, surface.whole, wave) for surface in prepared)
    notes = tuple(warnings(results, textured))
    return Identification(names, tuple(results), tuple(repairs), notes, textured, scans, side)


def doubled(series: ScaleSeries) -> ScaleSeries:
    """Series of the equivalent surface of two sides of one finish, of which one is known."""
    return replace(series, value=2.0 * series.value, raw=2.0 * series.raw)


def added(first: ScaleSeries, second: ScaleSeries) -> ScaleSeries:
    """Series of the equivalent surface: values add at equal scale, over the range both have."""
    keep = (first.scale >= second.scale[0] * 0.999) & (first.scale <= second.scale[-1] * 1.001)
    if keep.sum() < 4:
        raise ValueError(
            f"the two surfaces share no scales: {first.scale[0]:.3g} to {first.scale[-1]:.3g} m and "
            f"{second.scale[0]:.3g} to {second.scale[-1]:.3g} m"
        )
    first = first.within(keep)
    x, known = np.log(first.scale), np.log(second.scale)
    at = np.stack([np.interp(x, known, unit) for unit in np.eye(known.size)], axis=1)
    value, raw = (np.exp(at @ np.log(a)) for a in (second.value, second.raw))
    share = first.value / (first.value + value)

    def covariance(H: float) -> Array:
        covariance1, covariance2 = first.covariance(H), at @ second.covariance(H) @ at.T
        return np.asarray(np.outer(share, share) * covariance1 + np.outer(1 - share, 1 - share) * covariance2)

    return replace(first, value=first.value + value, raw=first.raw + raw, covariance=covariance)


def _result(series: ScaleSeries, fitted: SelfAffineLaw) -> Result:
    """Both kinds of parameters; the one that was not measured follows if the surface is isotropic."""
    rng = np.random.default_rng(0)
    root = np.linalg.cholesky(fitted.covariance)
    draws = np.array([fitted.H, fitted.level]) + rng.standard_normal((DRAWS, 2)) @ root.T
    H = np.clip(np.append(fitted.H, draws[:, 0]), 0.005, 0.995)
    level = np.append(fitted.level, draws[:, 1])
    log = (level + np.log(2.0) - 2.0 * H * np.log(fitted.reference)) / (2.0 * (1.0 - H))
    shift = np.log(fractal.profile_share(H)) / (2.0 * (1.0 - H))
    if series.method == "psd" and series.direction == "areal":
        profile, areal = log + shift, log
    else:
        profile, areal = log, log - shift
    return Result(
        method=series.method,
        direction=series.direction,
        series=series,
        fit=fitted,
        profile=ProfileFractal(
            D=Estimate(*_interval(2.0 - H)), G=RoughnessEstimate.of_logarithms(*_interval(profile))
        ),
        areal=ArealFractal(
            D_s=Estimate(*_interval(3.0 - H)), G_s=RoughnessEstimate.of_logarithms(*_interval(areal))
        ),
    )


def _interval(values: Array) -> tuple[float, float, float]:
    """The first value, and the interval of the others, the draws."""
    low, high = np.quantile(values[1:], [0.5 - 0.5 * LEVEL, 0.5 + 0.5 * LEVEL])
    return float(values[0]), float(low), float(high)
