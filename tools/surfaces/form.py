"""Form removal and repair of a scan, each repair named and counted; its rms height and slope.

h and slope are those of an isotropic surface, as the contact laws mean them. A line has the height of its
surface where the surface has no longer waves, and 1/sqrt(2) of its slope.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from jointfmu.quantity import Array

from .heights import FLAT, FORMS, Areal, Heights

Mask = NDArray[np.bool_]
SPIKE = 8.0
"""A spike deviates from the median of its neighbours by that many standard deviations."""
SWEEPS = 50
"""Sweeps of the harmonic filling: holes up to about ten points wide become smooth."""
MOST_MISSING = 0.2
"""Largest share of points that may be repaired."""


@dataclass(frozen=True, slots=True)
class Repair:
    """What was repaired, how often, of how many points."""

    name: str
    count: int
    points: int
    effect: str = ""

    def __str__(self) -> str:
        share = 100.0 * self.count / self.points
        return f"{self.name}: {self.count} of {self.points} points ({share:.3g} %){self.effect}"


def without_spikes(heights: Heights) -> tuple[Heights, list[Repair]]:
    """Spikes become missing points: |z - median of neighbours| > SPIKE standard deviations of that.

    The median is over 5 points along a profile and 5 x 5 on a map; the standard deviation is a robust one,
    the 0.9 quantile of the deviation over that of a normal distribution.
    """
    from scipy.ndimage import median_filter

    z = heights.z
    valid = np.isfinite(z)
    deviation = np.abs(z - median_filter(_nearest(z, valid), size=5, mode="nearest"))
    scale = float(np.quantile(deviation[valid], 0.9)) / 1.645
    if scale == 0.0:
        return heights, []
    spikes = valid & (deviation > SPIKE * scale)
    if not spikes.any():
        return heights, []
    clean = heights.with_heights(np.where(spikes, np.nan, z))
    before, after = (float(np.nanstd(without_form(scan).z)) for scan in (heights, clean))
    effect = f"; with them Sq is {before / after:.3g} times as large" if after > 0.0 else ""
    return clean, [Repair("spikes taken as missing", int(spikes.sum()), z.size, effect)]


def without_form(heights: Heights, form: str = "tilt") -> Heights:
    """Subtract the least-squares polynomial of the valid points: order 0, 1 or 2 in x (and y)."""
    if form not in FORMS:
        raise ValueError(f"form = {form!r} is not one of {', '.join(FORMS)}")
    order = {"mean": 0, "tilt": 1, "curvature": 2}[form]
    axes = [np.linspace(-1.0, 1.0, n) for n in heights.z.shape]
    grids = np.meshgrid(*axes, indexing="ij", sparse=True)
    valid = np.isfinite(heights.z)
    terms = _polynomial([np.broadcast_to(g, heights.z.shape) for g in grids], order)
    weights = [np.where(valid, t, 0.0).ravel() for t in terms]
    normal, left = np.array([[a @ b for b in weights] for a in weights]), heights.z
    for _ in range(2):  # what rounding leaves of a large form goes the second time
        known = np.where(valid, left, 0.0).ravel()
        coefficients = np.linalg.solve(normal, np.array([w @ known for w in weights]))
        left = left - sum(c * t for c, t in zip(coefficients, terms, strict=True))
    return heights.with_heights(left)


def _polynomial(axes: list[Array], order: int) -> list[Array]:
    terms = [np.ones_like(axes[0])]
    if order >= 1:
        terms += axes
    if order >= 2:
        terms += [a * b for i, a in enumerate(axes) for b in axes[i:]]
    return terms


def filled(heights: Heights) -> tuple[Heights, list[Repair]]:
    """Missing points filled, for the spectrum: linearly along a profile, on a map harmonically.

    Raises ValueError if more than MOST_MISSING of the points are missing.
    """
    z = heights.z
    valid = np.isfinite(z)
    count = int(z.size - valid.sum())
    if count == 0:
        return heights, []
    if count > MOST_MISSING * z.size:
        raise ValueError(
            f"{heights.name}: {count} of {z.size} points are missing or spikes, "
            f"at most {100.0 * MOST_MISSING:g} % can be filled"
        )
    if z.ndim == 1:
        at = np.arange(z.size)
        whole = np.interp(at, at[valid], z[valid])
    else:
        whole = _harmonic(_nearest(z, valid), ~valid)
    how = "linearly" if z.ndim == 1 else "harmonically"
    return heights.with_heights(whole), [Repair(f"missing points filled {how}", count, z.size)]


def _harmonic(z: Array, missing: Mask) -> Array:
    """Every missing point nears the mean of its four neighbours, from a first guess."""
    row, column = np.nonzero(missing)
    low, high = np.maximum(row - 1, 0), np.minimum(row + 1, z.shape[0] - 1)
    left, right = np.maximum(column - 1, 0), np.minimum(column + 1, z.shape[1] - 1)
    whole = z.copy()
    for _ in range(SWEEPS):
        around = whole[low, column] + whole[high, column] + whole[row, left] + whole[row, right]
        whole[row, column] = 0.25 * around
    return whole


def _nearest(z: Array, valid: Mask) -> Array:
    if valid.all():
        return z
    from scipy.ndimage import distance_transform_edt

    index = distance_transform_edt(~valid, return_distances=False, return_indices=True)
    return np.asarray(z[tuple(index)])


@dataclass(frozen=True, slots=True)
class Prepared:
    """A surface without form: with gaps for the structure function, filled for the spectrum."""

    gappy: Heights
    whole: Heights
    repairs: tuple[Repair, ...]


def prepare(heights: Heights, form: str = FORMS[0], keep_spikes: bool = False) -> Prepared:
    """Take spikes as missing, unless they are kept; remove the form, fill.

    Raises ValueError if the form leaves round-off alone, and as `filled`.
    """
    clean, spikes = (heights, []) if keep_spikes else without_spikes(heights)
    gappy = without_form(clean, form)
    if np.nanmax(np.abs(gappy.z)) <= FLAT * np.nanmax(np.abs(clean.z)):
        raise ValueError(f"{heights.name}: without its {form} the surface is smooth, it has no D and no G")
    whole, gaps = filled(gappy)
    return Prepared(gappy, whole, (*spikes, *gaps))


FEWEST = 5.0
"""Shortest wave of the slope [spacings]: shorter waves are noise (docs/surfaces_reference.md)."""
WAVES = 4.0
"""Least longest wave over that shortest one."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ScanRoughness:
    """Roughness of one scan without form and spikes.

    areal         : whether of a map
    rms, mean     : [m] root mean square and mean absolute height of the scan (Sq, Sa; of a profile Rq, Ra)
    h             : [m] rms height of its waves up to longest_wave [m]
    slope         : [1] rms slope of the isotropic surface, of waves from longest_wave to shortest_wave [m]
    """

    areal: bool
    rms: float
    mean: float
    h: float
    slope: float
    longest_wave: float
    shortest_wave: float


def default_wave(heights: Heights) -> float:
    """Longest wave [m] where none is stated: the length of a profile, the shorter side of a map."""
    return min(heights.lengths)


def check_wave(heights: Heights, longest: float) -> None:
    """Raise ValueError if a scan says nothing of waves that long [m]."""
    low, high = WAVES * _shortest(heights), max(heights.lengths)
    if not low <= longest <= high * (1.0 + 1e-9):
        raise ValueError(
            f"{heights.name}: longest wave = {longest:g} m is outside [{low:.3g}, {high:.3g}], from "
            f"{WAVES * FEWEST:g} points to the length of the scan"
        )


def of_scan(gappy: Heights, whole: Heights, longest: float) -> ScanRoughness:
    """Roughness of a scan over a longest wave [m].

    gappy, whole : without form; missing points as NaN, and filled

    The heights are a sum of cosines with 0, 1, 2, ... half waves along every side (type-II cosine transform:
    no window, no jump at the ends, and the squares add up to the mean square of the heights). Those with
    a wavelength up to the longest count.
    """
    from scipy.fft import dctn

    check_wave(whole, longest)
    valid = gappy.z[np.isfinite(gappy.z)] - float(np.nanmean(gappy.z))
    spacings = (whole.dy, whole.dx) if isinstance(whole, Areal) else (whole.dx,)
    axes = [np.arange(n) / (2.0 * n * d) for n, d in zip(whole.z.shape, spacings, strict=True)]
    squared = sum(f**2 for f in np.meshgrid(*axes, indexing="ij", sparse=True))
    power = dctn(whole.z, norm="ortho") ** 2 / whole.z.size
    shortest = _shortest(whole)
    inside = squared >= (1.0 - 1e-9) / longest**2
    resolved = inside & (squared <= (1.0 + 1e-9) / shortest**2)
    directions = 1.0 if isinstance(whole, Areal) else 2.0
    slope = 2.0 * np.pi * np.sqrt(directions * np.sum(power[resolved] * squared[resolved]))
    return ScanRoughness(
        areal=isinstance(whole, Areal),
        rms=float(np.sqrt(np.mean(valid**2))),
        mean=float(np.mean(np.abs(valid))),
        h=float(np.sqrt(np.sum(power[inside]))),
        slope=float(slope),
        longest_wave=longest,
        shortest_wave=shortest,
    )


def _shortest(heights: Heights) -> float:
    return FEWEST * max((heights.dx, heights.dy) if isinstance(heights, Areal) else (heights.dx,))
