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
GAUSSIAN_DECAY_LENGTH_OVER_RMS_HEIGHT = 0.48
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
SCAN_PART_COUNT = 4
"""Number of parts of a scan [1] that must all have non-Gaussian heights: few hills differ by chance."""
MIN_NON_GAUSSIAN_SKEWNESS = 1e-3
"""Skewness [1] below which heights are Gaussian."""
SURFACE_OVER_LAW_STIFFNESS_RANGE = (1.0 / 1.5, 1.5)
"""Smallest and largest stiffness of single surfaces, over stiffness of the law [1]."""
RANDOM_POINT_PAIRS = 2**18
"""Number of random pairs of points from two surfaces, for the heights of their gap [1]."""


@dataclass(frozen=True, slots=True)
class HeightSample:
    """Heights and slopes at points of a surface, or of the gap of two surfaces.

    heights        : (n) [m], mean 0
    squared_slopes : (n) [1] squared gradient of the isotropic surface
    """

    heights: Array
    squared_slopes: Array

    def standardized_moment(self, moment_order: int) -> float:
        """Standardized moment [1]: order 3 is the skewness Ssk, order 4 the kurtosis Sku."""
        z = self.heights - self.heights.mean()
        return float(np.mean(z**moment_order) / np.mean(z**2) ** (0.5 * moment_order))

    def split_into_parts(self, sample_count: int) -> list["HeightSample"]:
        """Split the sample into samples of equal size, in the order of the points of the scan."""
        pairs = zip(
            np.array_split(self.heights, sample_count),
            np.array_split(self.squared_slopes, sample_count),
            strict=True,
        )
        return [HeightSample(heights, squared_slopes) for heights, squared_slopes in pairs]


def tail_over_rms_height(height_sample: HeightSample) -> float:
    """Rms height of Gaussian heights with the same upper tail, over the rms height of the sample [1]."""
    return BearingCurve.from_height_sample(height_sample).gaussian_tail_height / float(
        height_sample.heights.std()
    )


def add_independent_surfaces(first_sample: HeightSample, second_sample: HeightSample) -> HeightSample:
    """Add the heights of two statistically independent surfaces at random pairs of points."""
    rng = np.random.default_rng(0)
    i, j = (
        rng.integers(sample.heights.size, size=RANDOM_POINT_PAIRS) for sample in (first_sample, second_sample)
    )
    return HeightSample(
        first_sample.heights[i] + second_sample.heights[j],
        first_sample.squared_slopes[i] + second_sample.squared_slopes[j],
    )


def gaussian_mean_excess(section_area_share: Array) -> Array:
    """Mean excess of Gaussian heights above the plane that cuts a share a (n) [1], over their rms height."""
    from scipy.special import ndtri

    plane = -ndtri(section_area_share)
    return np.asarray(np.exp(-0.5 * plane**2) / (np.sqrt(2.0 * np.pi) * section_area_share) - plane)


def lognormal_tail_over_rms_height(skewness: float) -> float:
    """Tail height over rms height [1] of lognormal heights with a given skewness, see `tail_over_rms_height`.

    The result is 1 for a skewness of 0.

    For a negative skewness the lognormal heights are mirrored: pits below a flat top.
    """
    from scipy.optimize import brentq
    from scipy.special import ndtr, ndtri

    if abs(skewness) < MIN_NON_GAUSSIAN_SKEWNESS:
        return 1.0

    def skewness_difference(shape_parameter: float) -> float:
        """Skewness of lognormal heights with the shape parameter s, minus the magnitude of the given one."""
        return float(
            (np.exp(shape_parameter**2) + 2.0) * np.sqrt(np.expm1(shape_parameter**2)) - abs(skewness)
        )

    s = brentq(skewness_difference, 1e-6, 2.0) * np.sign(skewness)
    plane, share = -ndtri(TYPICAL_SECTION_AREA_SHARE), np.array(TYPICAL_SECTION_AREA_SHARE)
    excess = np.exp(0.5 * s**2) * ndtr(s - plane) / share - np.exp(s * plane)
    rms = np.exp(0.5 * s**2) * np.sqrt(np.expm1(s**2)) * np.sign(s)
    return float(excess / rms / gaussian_mean_excess(share))


@dataclass(frozen=True, slots=True)
class BearingCurve:
    """Sections of a surface by planes, from high planes down.

    section_area_share : (n) area share a of the section [1], increasing
    mean_excess        : (n) mean height, above the plane, of all points above the plane [m]
    section_rms_slope  : (n) rms slope h'_c of the part above the plane [1]
    """

    section_area_share: Array
    mean_excess: Array
    section_rms_slope: Array

    @classmethod
    def from_height_sample(cls, height_sample: HeightSample, section_count: int = 200) -> "BearingCurve":
        """Bearing curve from the MIN_SECTION_POINTS highest points to three quarters of the surface."""
        order = np.argsort(height_sample.heights)[::-1]
        z = height_sample.heights[order]
        first = min(MIN_SECTION_POINTS, z.size // 8)
        count = np.unique(np.geomspace(first, 0.75 * z.size, section_count).astype(int))
        mean, slope = (np.cumsum(v)[count - 1] / count for v in (z, height_sample.squared_slopes[order]))
        return cls(count / z.size, mean - z[count - 1], np.sqrt(slope))

    @property
    def decay_length(self) -> Array:
        """Decay length l [m] of the nominal pressure p at each section: p ~ exp(approach/l).

        The decay length is `mean_excess`, the mean height of all points above the section. At heavy load the
        hills interact. The mean excess is then reduced by the factor that reduces the mean excess of Gaussian
        heights, at the same section, to GAUSSIAN_DECAY_LENGTH_OVER_RMS_HEIGHT times their rms height.
        """
        limit = GAUSSIAN_DECAY_LENGTH_OVER_RMS_HEIGHT / gaussian_mean_excess(self.section_area_share)
        return np.asarray(self.mean_excess * np.minimum(limit, 1.0))

    @property
    def gaussian_tail_height(self) -> float:
        """Rms height [m] of Gaussian heights with the same mean excess as the surface.

        The excess is compared at the section of TYPICAL_SECTION_AREA_SHARE.
        """
        excess = np.interp(TYPICAL_SECTION_AREA_SHARE, self.section_area_share, self.mean_excess)
        return float(excess / gaussian_mean_excess(np.array(TYPICAL_SECTION_AREA_SHARE)))

    def nominal_pressure(self, contact_modulus: float) -> Array:
        """Nominal contact pressure p (n) [Pa] at which the contact reaches each section of the heights.

        contact_modulus : contact modulus E* [Pa]
        """
        from scipy.special import erfinv

        p = (
            2.0
            / np.sqrt(np.pi)
            * erfinv(self.section_area_share)
            * contact_modulus
            * self.section_rms_slope
            / SECTION_AREA_FACTOR
        )
        return np.asarray(np.maximum.accumulate(p))

    def normal_stiffness(self, nominal_pressure: Array, contact_modulus: float) -> Array:
        """Normal stiffness per area p/l [Pa/m] at m nominal pressures p [Pa], with the decay length l.

        Outside the sections of the bearing curve, l is constant.
        """
        return np.asarray(
            nominal_pressure
            / np.interp(nominal_pressure, self.nominal_pressure(contact_modulus), self.decay_length)
        )

    def validated_pressure_range(self, contact_modulus: float) -> tuple[float, float]:
        """Smallest and largest pressure [Pa] at which bearing curves were compared with boundary elements."""
        low, high = np.interp(
            [MIN_SECTION_AREA_SHARE, MAX_SECTION_AREA_SHARE],
            self.section_area_share,
            self.nominal_pressure(contact_modulus),
        )
        return float(low), float(high)

    def stiffness_table(self, contact_modulus: float, pressure_count: int = 16) -> tuple[Array, Array]:
        """Pressures [Pa] and stiffness [Pa/m] of the law `table`, whose stiffness is not allowed to decrease.

        The pressures go up to MAX_SECTION_AREA_SHARE.
        """
        p = np.geomspace(
            self.nominal_pressure(contact_modulus)[0],
            self.validated_pressure_range(contact_modulus)[1],
            pressure_count,
        )
        return p, np.maximum.accumulate(self.normal_stiffness(p, contact_modulus))
