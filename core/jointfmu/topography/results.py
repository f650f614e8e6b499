"""What is identified: parameters of profiles and of surfaces, never one for the other, and its warnings."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .fit import SelfAffineLaw
from .form import Repair
from .heights import Areal
from .series import Series

TEXTURE = 0.3
"""Share of the mean line in the lines of a map above which the map is textured."""


@dataclass(frozen=True, slots=True)
class Estimate:
    """A value with the ends of its confidence interval."""

    value: float
    low: float
    high: float


@dataclass(frozen=True, slots=True)
class Roughness(Estimate):
    """A roughness G [m] with its interval, worked out in logarithms.

    As D goes to 1 the interval spans hundreds of decades. Where it leaves the positive floating-point numbers
    G is not determined: value, low and high are nan.

    decades : [1] length of the interval, whether or not G is determined
    """

    decades: float

    @property
    def determined(self) -> bool:
        """Whether the whole interval consists of positive floating-point numbers."""
        return bool(np.isfinite(self.value))

    @classmethod
    def of_logarithms(cls, value: float, low: float, high: float) -> "Roughness":
        """From the natural logarithms of the value and of the ends of its interval."""
        decades = (high - low) / np.log(10.0)
        least, most = np.log([np.finfo(float).tiny, np.finfo(float).max])
        if not least <= min(value, low) <= max(value, high) <= most:
            return cls(np.nan, np.nan, np.nan, float(decades))
        return cls(float(np.exp(value)), float(np.exp(low)), float(np.exp(high)), float(decades))


@dataclass(frozen=True, slots=True, kw_only=True)
class ProfileFractal:
    """Fractal parameters of a profile, 1 < D < 2 (Zhao 2018, Yu 2022)."""

    D: Estimate
    G: Roughness


@dataclass(frozen=True, slots=True, kw_only=True)
class ArealFractal:
    """Fractal parameters of an isotropic surface, 2 < D_s < 3 (Hu 2023, Eq. 1)."""

    D_s: Estimate
    G_s: Roughness


@dataclass(frozen=True, slots=True, kw_only=True)
class Result:
    """What one method finds along one direction ("profile", "x", "y" or "areal")."""

    method: str
    direction: str
    series: Series
    fit: SelfAffineLaw
    profile: ProfileFractal
    areal: ArealFractal


@dataclass(frozen=True, slots=True)
class Identification:
    """All results, the repairs per file and the warnings."""

    names: tuple[str, ...]
    results: tuple[Result, ...]
    repairs: tuple[tuple[str, Repair], ...]
    warnings: tuple[str, ...]
    textured: bool

    def best(self, direction: str | None = None, method: str | None = None) -> Result:
        """The result with the smaller standard error of D; of a direction, by default the whole surface."""
        direction = direction or self.results[0].direction
        fitting = [r for r in self.results if r.direction == direction and method in (None, r.method)]
        return min(fitting, key=lambda r: (not r.fit.straight, r.fit.covariance[0, 0]))


def texture(heights: Areal) -> tuple[float, float]:
    """Share of the mean line in the lines along x and along y: near 0 isotropic, 1 all lines alike."""
    shares = []
    for z in (heights.z, heights.z.T):
        lag = max(2, z.shape[1] // 32)
        second = z[:, 2 * lag :] - 2.0 * z[:, lag:-lag] + z[:, : -2 * lag]
        shares.append(float(np.mean(second.mean(axis=0) ** 2) / np.mean(second**2)))
    return shares[0], shares[1]


def warnings(results: Sequence[Result], textured: bool) -> list[str]:
    """What a user must know about results of one surface, whole surface first."""
    lines = []
    if textured:
        lines.append(
            "the surface is textured (its lines repeat): D_s and G_s of an isotropic surface do not describe "
            "it, use D and G along x and y"
        )
    for result in results:
        where = f"{result.method}, {result.direction}"
        if not result.fit.straight:
            lines.append(
                f"{where}: not self-affine over {result.fit.low:.3g} to {result.fit.high:.3g} m: D drifts by "
                f"{result.fit.drift:+.2f}, deviation from the law {100.0 * result.fit.deviation:.0f} %"
            )
        if result.fit.decades < 1.0:
            lines.append(f"{where}: the range spans {result.fit.decades:.2f} decades, less than one")
        if not 0.03 < result.fit.H < 0.97:
            lines.append(f"{where}: D = {result.profile.D.value:.2f} lies at the end of 1 to 2; no fractal")
    G = min(results[:2], key=lambda result: result.fit.covariance[0, 0]).profile.G
    if G.decades > 4.0:
        lines.append(
            f"G is {'hardly' if G.determined else 'not'} determined: its interval spans {G.decades:.1f} "
            "decades; a larger patch or more decades are needed"
        )
    structures, spectra = results[0].profile.D, results[1].profile.D
    if structures.low > spectra.high or spectra.low > structures.high:
        lines.append(f"the methods disagree: D = {structures.value:.3f} and {spectra.value:.3f}")
    return lines
