"""Form removal and repair of a scan, and its rms height h and rms slope.

h and slope are those of an isotropic surface, as the contact laws need them. A profile has the same height as
its surface if the surface has no longer waves, and its slope over sqrt(2).
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from jointfmu.quantity import Array

from .bearing_curve import HeightSample
from .heights import FORM_NAMES, RELATIVE_ROUND_OFF, ArealMap, ScanHeights

PointMask = NDArray[np.bool_]
"""Boolean array: which points are selected."""
SPIKE_OVER_STANDARD_DEVIATION = 8.0
"""Deviation of a spike from the median of its neighbours, over the standard deviation of all points [1]."""
GAP_FILLING_ITERATIONS = 50
"""Number of iterations of the harmonic filling: enough for gaps up to about ten points wide."""
MAX_MISSING_SHARE = 0.2
"""Largest share of missing points [1] that can be filled."""


@dataclass(frozen=True, slots=True)
class ScanRepair:
    """Repair of a scan (spikes or gaps), for messages.

    repair_name     : kind of repair
    repaired_point_count : number of repaired points
    total_point_count    : number of all points
    effect_note     : text on its effect
    """

    repair_name: str
    repaired_point_count: int
    total_point_count: int
    effect_note: str = ""

    def __str__(self) -> str:
        share = 100.0 * self.repaired_point_count / self.total_point_count
        points = f"{self.repaired_point_count} of {self.total_point_count} points ({share:.3g} %)"
        return f"{self.repair_name}: {points}{self.effect_note}"


def remove_spikes(heights: ScanHeights) -> tuple[ScanHeights, list[ScanRepair]]:
    """Replace spikes by missing points; return the heights and the repairs.

    A spike deviates from the median of its neighbours by more than SPIKE_OVER_STANDARD_DEVIATION standard
    deviations. The median is taken over 5 points of a profile, or 5 x 5 points of a map. The standard
    deviation is robust: the 0.9 quantile of the deviation over the same quantile of a normal distribution.
    """
    from scipy.ndimage import median_filter

    z = heights.z
    valid = np.isfinite(z)
    deviation = np.abs(z - median_filter(_fill_nearest(z, valid), size=5, mode="nearest"))
    scale = float(np.quantile(deviation[valid], 0.9)) / 1.645
    if scale == 0.0:
        return heights, []
    spikes = valid & (deviation > SPIKE_OVER_STANDARD_DEVIATION * scale)
    if not spikes.any():
        return heights, []
    clean = heights.replace_heights(np.where(spikes, np.nan, z))
    rms_before, rms_after = (float(np.nanstd(remove_form(scan).z)) for scan in (heights, clean))
    effect = f"; with them Sq is {rms_before / rms_after:.3g} times as large" if rms_after > 0.0 else ""
    return clean, [ScanRepair("spikes taken as missing", int(spikes.sum()), z.size, effect)]


def remove_form(heights: ScanHeights, form_name: str = "tilt") -> ScanHeights:
    """Subtract the least-squares polynomial in x (and y) of the valid points.

    form_name : "mean", "tilt" or "curvature": order 0, 1 or 2
    """
    if form_name not in FORM_NAMES:
        raise ValueError(f"form = {form_name!r} is not one of {', '.join(FORM_NAMES)}")
    order = {"mean": 0, "tilt": 1, "curvature": 2}[form_name]
    axes = [np.linspace(-1.0, 1.0, n) for n in heights.z.shape]
    grids = np.meshgrid(*axes, indexing="ij", sparse=True)
    valid = np.isfinite(heights.z)
    terms = _form_monomials([np.broadcast_to(g, heights.z.shape) for g in grids], order)
    weights = [np.where(valid, t, 0.0).ravel() for t in terms]
    normal_matrix, residual = np.array([[a @ b for b in weights] for a in weights]), heights.z
    for _ in range(2):  # the second pass removes the round-off of a large form
        values = np.where(valid, residual, 0.0).ravel()
        coefficients = np.linalg.solve(normal_matrix, np.array([w @ values for w in weights]))
        residual = residual - sum(c * t for c, t in zip(coefficients, terms, strict=True))
    return heights.replace_heights(residual)


def _form_monomials(coordinates: list[Array], polynomial_order: int) -> list[Array]:
    """Monomials in one or two coordinates, up to an order, for the polynomial that describes the form."""
    terms = [np.ones_like(coordinates[0])]
    if polynomial_order >= 1:
        terms += coordinates
    if polynomial_order >= 2:
        terms += [a * b for i, a in enumerate(coordinates) for b in coordinates[i:]]
    return terms


def fill_gaps(heights: ScanHeights) -> tuple[ScanHeights, list[ScanRepair]]:
    """Fill missing points, for the spectrum: by linear interpolation in a profile, harmonically in a map.

    Returns the heights and the repairs. Raises ValueError if more than MAX_MISSING_SHARE of the points are
    missing.
    """
    z = heights.z
    valid = np.isfinite(z)
    count = int(z.size - valid.sum())
    if count == 0:
        return heights, []
    if count > MAX_MISSING_SHARE * z.size:
        raise ValueError(
            f"{heights.scan_name}: {count} of {z.size} points are missing or spikes, at most "
            f"{100.0 * MAX_MISSING_SHARE:g} % may be missing"
        )
    if z.ndim == 1:
        index = np.arange(z.size)
        complete = np.interp(index, index[valid], z[valid])
    else:
        complete = _fill_harmonically(_fill_nearest(z, valid), ~valid)
    method = "linearly" if z.ndim == 1 else "harmonically"
    return heights.replace_heights(complete), [ScanRepair(f"missing points filled {method}", count, z.size)]


def _fill_harmonically(z: Array, missing_mask: PointMask) -> Array:
    """Solve Laplace's equation at the missing points by Jacobi iterations, from the initial heights z."""
    row, column = np.nonzero(missing_mask)
    low, high = np.maximum(row - 1, 0), np.minimum(row + 1, z.shape[0] - 1)
    left, right = np.maximum(column - 1, 0), np.minimum(column + 1, z.shape[1] - 1)
    heights = z.copy()
    for _ in range(GAP_FILLING_ITERATIONS):
        neighbours = heights[low, column] + heights[high, column] + heights[row, left] + heights[row, right]
        heights[row, column] = 0.25 * neighbours
    return heights


def _fill_nearest(z: Array, valid_mask: PointMask) -> Array:
    """Fill missing points of a scan with the height of the nearest valid point."""
    if valid_mask.all():
        return z
    from scipy.ndimage import distance_transform_edt

    index = distance_transform_edt(~valid_mask, return_distances=False, return_indices=True)
    return np.asarray(z[tuple(index)])


@dataclass(frozen=True, slots=True)
class PreparedScan:
    """Scan without spikes and form: once with missing points, once with filled gaps.

    heights_with_gaps : heights with missing points as NaN, for the structure function
    filled_heights    : heights with missing points filled, for the spectrum
    repairs           : repairs of spikes and gaps
    """

    heights_with_gaps: ScanHeights
    filled_heights: ScanHeights
    repairs: tuple[ScanRepair, ...]


def prepare_scan(
    heights: ScanHeights, form_name: str = FORM_NAMES[0], keep_spikes: bool = False
) -> PreparedScan:
    """Prepare a scan: remove spikes (unless `keep_spikes`), remove the form, fill missing points.

    Raises ValueError if only round-off remains without the form, or if too many points are missing.
    """
    clean, spikes = (heights, []) if keep_spikes else remove_spikes(heights)
    gappy = remove_form(clean, form_name)
    if np.nanmax(np.abs(gappy.z)) <= RELATIVE_ROUND_OFF * np.nanmax(np.abs(clean.z)):
        raise ValueError(
            f"{heights.scan_name}: without its {form_name} the surface is smooth, it has no D and no G"
        )
    complete, gaps = fill_gaps(gappy)
    return PreparedScan(gappy, complete, (*spikes, *gaps))


SHORTEST_WAVE_OVER_SPACING = 5.0
"""Shortest wavelength of the slope over the point spacing [1]. Shorter waves are noise or effects of the
instrument (docs/surfaces_reference.md)."""
MIN_LONGEST_OVER_SHORTEST_WAVE = 4.0
"""Smallest allowed ratio of the longest to the shortest wavelength of a scan [1]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ScanRoughness:
    """Roughness of one scan without form and spikes.

    is_areal                    : whether the scan is an areal map
    rms_height                  : [m] root mean square height (Sq; Rq of a profile)
    mean_absolute_height        : [m] mean absolute height (Sa; Ra of a profile)
    long_wave_rms_height        : [m] rms height of waves up to longest_wave
    rms_slope                   : [1] of the isotropic surface, of waves from longest_wave down to
                                  shortest_wave
    longest_wave, shortest_wave : wavelengths [m]
    height_sample               : heights of waves from longest_wave down to shortest_wave, with their slopes
    """

    is_areal: bool
    rms_height: float
    mean_absolute_height: float
    long_wave_rms_height: float
    rms_slope: float
    longest_wave: float
    shortest_wave: float
    height_sample: HeightSample = field(repr=False, compare=False)


def default_longest_wave(heights: ScanHeights) -> float:
    """Default of the longest wavelength [m] of a scan: length of a profile, or shorter side of a map."""
    return min(heights.side_lengths)


def check_longest_wave(heights: ScanHeights, longest_wave: float) -> None:
    """Raise ValueError if a scan cannot resolve waves up to this longest wavelength [m]."""
    low, high = MIN_LONGEST_OVER_SHORTEST_WAVE * _shortest_resolved_wave(heights), max(heights.side_lengths)
    if not low <= longest_wave <= high * (1.0 + 1e-9):
        raise ValueError(
            f"{heights.scan_name}: longest wave = {longest_wave:g} m is outside [{low:.3g}, {high:.3g}], "
            f"from {MIN_LONGEST_OVER_SHORTEST_WAVE * SHORTEST_WAVE_OVER_SPACING:g} points to the length of "
            "the scan"
        )


def compute_scan_roughness(
    heights_with_gaps: ScanHeights, filled_heights: ScanHeights, longest_wave: float
) -> ScanRoughness:
    """Roughness of a scan from waves up to a longest wavelength [m].

    heights_with_gaps : heights without form, missing points as NaN
    filled_heights    : heights without form, missing points filled

    The heights are decomposed into cosines with 0, 1, 2, ... half waves along each side (type-II cosine
    transform). This needs no window and has no jump at the ends; the squared amplitudes add up to the mean
    square height. Only waves up to the longest wavelength count.
    """
    from scipy.fft import dctn, idctn

    check_longest_wave(filled_heights, longest_wave)
    valid = heights_with_gaps.z[np.isfinite(heights_with_gaps.z)] - float(np.nanmean(heights_with_gaps.z))
    spacings = (
        (filled_heights.dy, filled_heights.dx)
        if isinstance(filled_heights, ArealMap)
        else (filled_heights.dx,)
    )
    axes = [np.arange(n) / (2.0 * n * d) for n, d in zip(filled_heights.z.shape, spacings, strict=True)]
    squared = sum(f**2 for f in np.meshgrid(*axes, indexing="ij", sparse=True))
    waves = dctn(filled_heights.z, norm="ortho")
    power = waves**2 / filled_heights.z.size
    shortest = _shortest_resolved_wave(filled_heights)
    inside = squared >= (1.0 - 1e-9) / longest_wave**2
    resolved = inside & (squared <= (1.0 + 1e-9) / shortest**2)
    directions = 1.0 if isinstance(filled_heights, ArealMap) else 2.0
    slope = 2.0 * np.pi * np.sqrt(directions * np.sum(power[resolved] * squared[resolved]))
    return ScanRoughness(
        is_areal=isinstance(filled_heights, ArealMap),
        rms_height=float(np.sqrt(np.mean(valid**2))),
        mean_absolute_height=float(np.mean(np.abs(valid))),
        long_wave_rms_height=float(np.sqrt(np.sum(power[inside]))),
        rms_slope=float(slope),
        longest_wave=longest_wave,
        shortest_wave=shortest,
        height_sample=_build_height_sample(
            idctn(np.where(resolved, waves, 0.0), norm="ortho"), spacings, float(slope)
        ),
    )


def _build_height_sample(z: Array, spacings: tuple[float, ...], rms_slope: float) -> HeightSample:
    """Heights z [m] on a grid, and squared slopes [1] from the differences of neighbouring heights.

    The squared slopes are scaled so that their mean is the square of the rms slope `rms_slope` [1].
    """
    squared = np.zeros_like(z)
    for axis, spacing in enumerate(spacings):
        difference = (np.diff(z, axis=axis) / spacing) ** 2
        pad = [(1, 1) if n == axis else (0, 0) for n in range(z.ndim)]
        padded = np.pad(difference, pad, mode="edge")
        squared += 0.5 * (np.delete(padded, 0, axis) + np.delete(padded, -1, axis))
    return HeightSample(z.ravel(), (squared * (rms_slope**2 / squared.mean())).ravel())


def _shortest_resolved_wave(heights: ScanHeights) -> float:
    """Shortest wavelength [m] that counts for the rms slope."""
    return SHORTEST_WAVE_OVER_SPACING * max(
        (heights.dx, heights.dy) if isinstance(heights, ArealMap) else (heights.dx,)
    )
