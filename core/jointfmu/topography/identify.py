"""D and G of a surface, or of the equivalent surface of a pair, with confidence intervals and warnings."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from . import fractal
from .fit import Fit, fit
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
    kinds = {isinstance(one, Areal) for one in surfaces}
    if len(kinds) == 2:
        raise ValueError("a profile and an areal map given, a pair needs two of the same kind")
    prepared = [prepare(one, form) for one in surfaces]
    directions = ("areal", "x", "y") if kinds == {True} else ("profile",)
    low, high = span or (None, None)
    results = []
    for direction in directions:
        for method in (structure, psd):
            parts = [method(one.gappy if method is structure else one.whole, direction) for one in prepared]
            series = parts[0] if len(parts) == 1 else added(parts[0], parts[1])
            results.append(_result(series, fit(series, low, high)))
    repairs = [(one.whole.name, repair) for one in prepared for repair in one.repairs]
    repeats = [texture(one.whole) for one in prepared if isinstance(one.whole, Areal)]
    names = tuple(one.name for one in surfaces)
    textured = any(max(shares) > TEXTURE for shares in repeats)
    return Identification(names, tuple(results), tuple(repairs), tuple(warnings(results, textured)), textured)


def added(one: Series, other: Series) -> Series:
    """Series of the equivalent surface: values add at equal scale, over the range both have."""
    keep = (one.scale >= other.scale[0] * 0.999) & (one.scale <= other.scale[-1] * 1.001)
    if keep.sum() < 4:
        raise ValueError(
            f"the two surfaces share no scales: {one.scale[0]:.3g} to {one.scale[-1]:.3g} m and "
            f"{other.scale[0]:.3g} to {other.scale[-1]:.3g} m"
        )
    one = one.within(keep)
    at = _interpolation(np.log(one.scale), np.log(other.scale))
    value, raw = (np.exp(at @ np.log(a)) for a in (other.value, other.raw))
    share = one.value / (one.value + value)

    def covariance(H: float) -> Array:
        first, second = one.covariance(H), at @ other.covariance(H) @ at.T
        return np.asarray(np.outer(share, share) * first + np.outer(1 - share, 1 - share) * second)

    return replace(one, value=one.value + value, raw=one.raw + raw, covariance=covariance)


def _interpolation(at: Array, x: Array) -> Array:
    """Matrix of linear interpolation from x to `at`."""
    return np.stack([np.interp(at, x, unit) for unit in np.eye(x.size)], axis=1)


def _result(series: Series, found: Fit) -> Result:
    """Both kinds of parameters; the one that was not measured follows if the surface is isotropic."""
    rng = np.random.default_rng(0)
    root = np.linalg.cholesky(found.covariance)
    draws = np.array([found.H, found.level]) + rng.standard_normal((DRAWS, 2)) @ root.T
    H = np.clip(np.append(found.H, draws[:, 0]), 0.005, 0.995)
    level = np.append(found.level, draws[:, 1])
    log = (level + np.log(2.0) - 2.0 * H * np.log(found.reference)) / (2.0 * (1.0 - H))
    shift = np.log(fractal.profile_share(H)) / (2.0 * (1.0 - H))
    if series.method == "psd" and series.direction == "areal":
        profile, areal = log + shift, log
    else:
        profile, areal = log, log - shift
    return Result(
        method=series.method,
        direction=series.direction,
        series=series,
        fit=found,
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
