"""D and G of a surface, or of the equivalent surface of a pair, with confidence intervals and warnings."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from . import fractal
from .fit import SelfAffineLaw, fit
from .form import Repair, filled, without_form, without_spikes
from .heights import Areal, Array, Heights
from .results import (
    TEXTURE,
    ArealFractal,
    Estimate,
    Identification,
    ProfileFractal,
    Result,
    Roughness,
    texture,
    warnings,
)
from .series import Series
from .spectrum import psd
from .structure import structure

LEVEL = 0.95
"""Level of the confidence intervals."""
DRAWS = 4000
METHODS = ("structure", "psd")


@dataclass(frozen=True, slots=True)
class Prepared:
    """A surface without form: with gaps for the structure function, filled for the spectrum."""

    gappy: Heights
    whole: Heights
    repairs: tuple[Repair, ...]


def prepare(heights: Heights, form: str) -> Prepared:
    """Take spikes as missing, remove the form, fill."""
    clean, spikes = without_spikes(heights)
    gappy = without_form(clean, form)
    whole, gaps = filled(gappy)
    return Prepared(gappy, whole, (*spikes, *gaps))


def identify(
    surfaces: Sequence[Heights], form: str = "tilt", span: tuple[float, float] | None = None
) -> Identification:
    """Identify one surface, or the equivalent surface of two.

    surfaces : one, or two of the same kind; of two independent surfaces the difference of heights counts,
        whose structure function and spectrum are the sums of theirs
    form     : what is removed, see `form.FORMS`
    span     : scaling range [m] of lags and wavelengths; by default the longest straight one is searched
    """
    if len(surfaces) not in (1, 2):
        raise ValueError(f"{len(surfaces)} files given, allowed are one surface or the two of a pair")
    areal = {isinstance(surface, Areal) for surface in surfaces}
    if len(areal) == 2:
        raise ValueError("a profile and an areal map given, a pair needs two of the same kind")
    prepared = [prepare(surface, form) for surface in surfaces]
    directions = ("areal", "x", "y") if areal == {True} else ("profile",)
    low, high = span or (None, None)
    results = []
    for direction in directions:
        for method in (structure, psd):
            parts = [
                method(surface.gappy if method is structure else surface.whole, direction)
                for surface in prepared
            ]
            series = parts[0] if len(parts) == 1 else added(parts[0], parts[1])
            results.append(_result(series, fit(series, low, high)))
    repairs = [(surface.whole.name, repair) for surface in prepared for repair in surface.repairs]
    repeats = [texture(surface.whole) for surface in prepared if isinstance(surface.whole, Areal)]
    names = tuple(surface.name for surface in surfaces)
    textured = any(max(shares) > TEXTURE for shares in repeats)
    return Identification(names, tuple(results), tuple(repairs), tuple(warnings(results, textured)), textured)


def added(first: Series, second: Series) -> Series:
    """Series of the equivalent surface: values add at equal scale, over the range both have."""
    keep = (first.scale >= second.scale[0] * 0.999) & (first.scale <= second.scale[-1] * 1.001)
    if keep.sum() < 4:
        raise ValueError(
            f"the two surfaces share no scales: {first.scale[0]:.3g} to {first.scale[-1]:.3g} m and "
            f"{second.scale[0]:.3g} to {second.scale[-1]:.3g} m"
        )
    first = first.within(keep)
    at = _interpolation(np.log(first.scale), np.log(second.scale))
    value, raw = (np.exp(at @ np.log(a)) for a in (second.value, second.raw))
    share = first.value / (first.value + value)

    def covariance(H: float) -> Array:
        covariance1, covariance2 = first.covariance(H), at @ second.covariance(H) @ at.T
        return np.asarray(np.outer(share, share) * covariance1 + np.outer(1 - share, 1 - share) * covariance2)

    return replace(first, value=first.value + value, raw=first.raw + raw, covariance=covariance)


def _interpolation(at: Array, x: Array) -> Array:
    """Matrix of linear interpolation from x to `at`."""
    return np.stack([np.interp(at, x, unit) for unit in np.eye(x.size)], axis=1)


def _result(series: Series, fitted: SelfAffineLaw) -> Result:
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
        profile=ProfileFractal(D=_estimate(2.0 - H), G=_roughness(profile)),
        areal=ArealFractal(D_s=_estimate(3.0 - H), G_s=_roughness(areal)),
    )


def _estimate(values: Array) -> Estimate:
    return Estimate(*_interval(values))


def _roughness(logarithms: Array) -> Roughness:
    return Roughness.of_logarithms(*_interval(logarithms))


def _interval(values: Array) -> tuple[float, float, float]:
    """The first value, and the interval of the others, the draws."""
    low, high = np.quantile(values[1:], [0.5 - 0.5 * LEVEL, 0.5 + 0.5 * LEVEL])
    return float(values[0]), float(low), float(high)
