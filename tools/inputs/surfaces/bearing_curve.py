"""Contact stiffness from the bearing curve: pressure over the decay length of the upper tail of the heights.

In elastic contact of many hills the pressure grows with the approach as exp(approach/l), so the stiffness
per area is k = p/l. For Gaussian heights l = gamma h (Persson 2007). For other heights l follows from the
part of the surface that carries the load: a plane cuts the heights in a section of the area share a, and l is
the mean excess of the heights above this plane. Two constants are fitted to boundary elements
(studies/validity_stiffness.py heights); docs/validity_stiffness.md has the range of validity.
"""

from dataclasses import dataclass

import numpy as np

from jointfmu.quantity import Array

SECTION_AREA_FACTOR = 4.0
"""Area share of the section over p/(E* h'_c) [1] at light load, with the rms slope h'_c of the section. The
real contact area is half of the section, as in Hertz contact."""
GAUSSIAN_DECAY_LIMIT = 0.48
"""Decay length over the rms height of Gaussian heights [1] at heavy load (Akarapu, Sharp, Robbins 2011)."""
MIN_SECTION_POINTS = 100
"""Smallest number of points of a section [1]: fewer belong to a few summits. A profile of few points has at
least an eighth of its points in a section."""
MIN_SECTION_AREA_SHARE, MAX_SECTION_AREA_SHARE = 1e-3, 0.38
"""Smallest and largest area share of the section [1] that was compared with boundary elements: pressures of
0.0003 to 0.1 E* h' on Gaussian heights."""
TYPICAL_SECTION_AREA_SHARE = 0.03
"""Area share of the section [1] at which the upper tail of the heights is compared with Gaussian heights."""
MAX_GAUSSIAN_TAIL_OVER_RMS_HEIGHT = 1.3
"""Largest ratio of the rms height and the height of the tail [1], either way, of Gaussian heights."""
SCAN_PARTS = 4
"""Number of parts of a scan [1] that must all have non-Gaussian heights: few hills differ by chance."""
MIN_SKEWNESS = 1e-3
"""Skewness [1] below which heights are Gaussian."""
TABLE_FACTOR_RANGE = (1.0 / 1.5, 1.5)
"""Smallest and largest stiffness of single surfaces, over stiffness of the law [1]."""
RANDOM_PAIRS = 2**18
"""Number of random pairs of points from two surfaces, for the heights of their gap [1]."""


@dataclass(frozen=True, slots=True)
class HeightSample:
    """Heights and slopes at points of a surface, or of the gap of two surfaces.

    heights        : (n) [m], mean 0
    squared_slopes : (n) [1] squared gradient of the isotropic surface
    """

    heights: Array
    squared_slopes: Array

    def moment(self, order: int) -> float:
        """Standardized moment [1]: order 3 is the skewness Ssk, order 4 the kurtosis Sku."""
        z = self.heights - self.heights.mean()
        return float(np.mean(z**order) / np.mean(z**2) ** (0.5 * order))

    def split(self, sample_count: int) -> list["HeightSample"]:
        """Split the sample into samples of equal size, in the order of the points of the scan."""
        pairs = zip(
            np.array_split(self.heights, sample_count),
            np.array_split(self.squared_slopes, sample_count),
            strict=True,
        )
        return [HeightSample(heights, squared_slopes) for heights, squared_slopes in pairs]


def tail_ratio(sample: HeightSample) -> float:
    """Rms height of Gaussian heights with the same upper tail, over the rms height of the sample [1]."""
    return BearingCurve.of_sample(sample).tail_height / float(sample.heights.std())


def add_surfaces(first: HeightSample, second: HeightSample) -> HeightSample:
    """Add the heights of two statistically independent surfaces at random pairs of points."""
    rng = np.random.default_rng(0)
    i, j = (rng.integers(sample.heights.size, size=RANDOM_PAIRS) for sample in (first, second))
    return HeightSample(
        first.heights[i] + second.heights[j], first.squared_slopes[i] + second.squared_slopes[j]
    )


def gaussian_mean_excess(share: Array) -> Array:
    """Mean excess of Gaussian heights above the plane that cuts a share a (n) [1], over their rms height."""
    from scipy.special import ndtri

    plane = -ndtri(share)
    return np.asarray(np.exp(-0.5 * plane**2) / (np.sqrt(2.0 * np.pi) * share) - plane)


def skewed_tail_ratio(skewness: float) -> float:
    """Tail height over rms height [1] of lognormal heights with a given skewness, see `tail_ratio`.

    The result is 1 for a skewness of 0.

    For a negative skewness the lognormal heights are mirrored: pits below a flat top.
    """
    from scipy.optimize import brentq
    from scipy.special import ndtr, ndtri

    if abs(skewness) < MIN_SKEWNESS:
        return 1.0

    def excess_skewness(s: float) -> float:
        """Skewness of lognormal heights with the shape parameter s, minus the magnitude of the given one."""
        return float((np.exp(s**2) + 2.0) * np.sqrt(np.expm1(s**2)) - abs(skewness))

    s = brentq(excess_skewness, 1e-6, 2.0) * np.sign(skewness)
    plane, share = -ndtri(TYPICAL_SECTION_AREA_SHARE), np.array(TYPICAL_SECTION_AREA_SHARE)
    excess = np.exp(0.5 * s**2) * ndtr(s - plane) / share - np.exp(s * plane)
    rms = np.exp(0.5 * s**2) * np.sqrt(np.expm1(s**2)) * np.sign(s)
    return float(excess / rms / gaussian_mean_excess(share))


@dataclass(frozen=True, slots=True)
class BearingCurve:
    """Sections of a surface by planes, from high planes down.

    share       : (n) area share a of the section [1], increasing
    mean_excess : (n) mean height, above the plane, of all points above the plane [m]
    slope       : (n) rms slope h'_c of the part above the plane [1]
    """

    share: Array
    mean_excess: Array
    slope: Array

    @classmethod
    def of_sample(cls, sample: HeightSample, section_count: int = 200) -> "BearingCurve":
        """Bearing curve from the MIN_SECTION_POINTS highest points to three quarters of the surface."""
        order = np.argsort(sample.heights)[::-1]
        z = sample.heights[order]
        first = min(MIN_SECTION_POINTS, z.size // 8)
        count = np.unique(np.geomspace(first, 0.75 * z.size, section_count).astype(int))
        mean, slope = (np.cumsum(v)[count - 1] / count for v in (z, sample.squared_slopes[order]))
        return cls(count / z.size, mean - z[count - 1], np.sqrt(slope))

    @property
    def decay_length(self) -> Array:
        """Decay length l [m] at each section: p ~ exp(approach/l).

        The decay length is `mean_excess`, the mean height of all points above the section. At heavy load the
        hills interact: if Gaussian heights of rms h had a mean excess above GAUSSIAN_DECAY_LIMIT h at this
        section, the mean excess is multiplied by the ratio of this limit to the Gaussian mean excess.
        """
        limit = GAUSSIAN_DECAY_LIMIT / gaussian_mean_excess(self.share)
        return np.asarray(self.mean_excess * np.minimum(limit, 1.0))

    @property
    def tail_height(self) -> float:
        """Rms height [m] of Gaussian heights with the same mean excess as the surface.

        The excess is compared at the section of TYPICAL_SECTION_AREA_SHARE.
        """
        excess = np.interp(TYPICAL_SECTION_AREA_SHARE, self.share, self.mean_excess)
        return float(excess / gaussian_mean_excess(np.array(TYPICAL_SECTION_AREA_SHARE)))

    def pressure(self, modulus: float) -> Array:
        """Nominal contact pressure p (n) [Pa] at which the contact reaches each section of the heights.

        modulus : contact modulus E* [Pa]
        """
        from scipy.special import erfinv

        p = 2.0 / np.sqrt(np.pi) * erfinv(self.share) * modulus * self.slope / SECTION_AREA_FACTOR
        return np.asarray(np.maximum.accumulate(p))

    def stiffness(self, pressure: Array, modulus: float) -> Array:
        """Stiffness per area k = p/l [Pa/m] at pressures p (m) [Pa]; constant l outside the sections."""
        return np.asarray(pressure / np.interp(pressure, self.pressure(modulus), self.decay_length))

    def checked_pressures(self, modulus: float) -> tuple[float, float]:
        """Smallest and largest pressure [Pa] that were compared with boundary elements."""
        low, high = np.interp(
            [MIN_SECTION_AREA_SHARE, MAX_SECTION_AREA_SHARE], self.share, self.pressure(modulus)
        )
        return float(low), float(high)

    def stiffness_table(self, modulus: float, pressure_count: int = 16) -> tuple[Array, Array]:
        """Pressures [Pa] and stiffness [Pa/m] of the law `table`, whose stiffness is not allowed to decrease.

        The pressures go up to MAX_SECTION_AREA_SHARE.
        """
        p = np.geomspace(self.pressure(modulus)[0], self.checked_pressures(modulus)[1], pressure_count)
        return p, np.maximum.accumulate(self.stiffness(p, modulus))
