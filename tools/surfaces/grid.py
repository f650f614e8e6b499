"""Regular positions from columns of a file, which round them and leave points out."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from jointfmu.quantity import Array

Places = NDArray[np.int64]

NOISE = 0.05
"""Largest deviation from a regular grid [1], over its spacing, that needs no explanation."""
DIGITS = 1e9
"""Largest number of units of the last digit that a position may have."""


def places(path: Path, name: str, at: Array, factor: float, repeats: bool = False) -> tuple[Places, float]:
    """Place of every position (n,) on a regular grid, from 0 on, and the spacing.

    path, name : for messages
    at         : rising positions as the file states them, in a unit of `factor` metres
    repeats    : whether rounding may make neighbours equal

    The spacing is (last - first)/(n - 1). Every position must lie where it belongs within NOISE of the
    spacing, or within rounding: half a unit of its last digit, and half a unit of that of the ends, which
    are rounded too. Where that fails, points are missing: the spacing is then the middle gap, and every
    position a multiple of it. Raises ValueError if that fails as well.
    """
    if at.size < 2 or not np.all(np.isfinite(at)):
        raise ValueError(f"{path}: {name} has a gap or a single value; expected positions in rising order")
    gaps = np.diff(at)
    if at[-1] == at[0] or (not repeats and gaps.min() <= 0.0):
        raise ValueError(f"{path}: {name} repeats values; expected every position once")
    whole = at - at[0]
    step = float(whole[-1] / (at.size - 1))
    place = np.arange(at.size)
    digit = last_digit(at)
    rounding = 0.5 * (digit + max(digit[0], digit[-1]))
    if np.all(_off(whole, place, step) <= np.maximum(NOISE * step, rounding)):
        return place, step
    step = (
        float(whole[-1] / max(np.rint(whole[-1] / np.median(gaps)), 1.0)) if np.median(gaps) > 0.0 else step
    )
    place = np.rint(whole / step).astype(np.int64)
    if gaps.min() <= 0.0 or np.diff(place).min() < 1 or _off(whole, place, step).max() > NOISE * step:
        raise ValueError(
            f"{path}: the spacing of {name} varies ({gaps.min() * factor:.4g} to "
            f"{gaps.max() * factor:.4g} m); resample to a constant one"
        )
    return place, step


def _off(at: Array, place: Places, step: float) -> Array:
    """Distance of every position from its place."""
    return np.asarray(np.abs(at - place * step))


def last_digit(at: Array) -> Array:
    """Unit of the last digit of every position (n,): of decimals or of significant digits, as they have.

    0 where they have more than DIGITS.
    """
    sizes = np.where(at == 0.0, 1.0, np.abs(at))
    decade = 10.0 ** np.floor(np.log10(sizes))
    decimal, significant = _exact(at), _exact(sizes / decade) * decade
    return np.maximum(decimal, significant)


def _exact(numbers: Array) -> float:
    """The largest power of ten, at most 1, of which all are multiples; 0 if that is more than DIGITS."""
    most = float(np.abs(numbers).max())
    for power in range(0, -16, -1):
        scaled = numbers * 10.0**-power
        if most * 10.0**-power > DIGITS:
            break
        if np.abs(scaled - np.rint(scaled)).max() < 1e-6:
            return float(10.0**power)
    return 0.0
