"""Rms height and slope of all waves up to a longest one: of a scan.

h and slope are those of an isotropic surface, as the contact laws mean them. A line has the height of its
surface where the surface has no longer waves, and 1/sqrt(2) of its slope.
"""

from dataclasses import dataclass

import numpy as np

from .heights import Areal, Heights

FEWEST = 5.0
"""Shortest wave of the slope, in spacings: shorter ones are noise and the instrument's (docs/surfaces.md)."""
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
    from scipy.fft import dctn  # slow to import, and commands need D and G without a scan

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
