"""Height data on a uniform grid: a profile or an areal map, never one for the other; what files of columns
and files that are plainly no surface need before.
"""

import re
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from jointfmu.quantity import Array

from ..columns import CONTROL

FORMS = ("tilt", "mean", "curvature")
"""What is removed before anything else: a plane (default), the mean height, a surface of second order."""
LEAST_PROFILE = 128
"""Least number of points of a profile: the lags used then span 0.9 decades."""
LEAST_AREAL = 64
"""Least number of points along either side of an areal map."""
FLAT = 1e-9
"""Largest deviation of heights over the heights themselves [1] that is round-off."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Profile:
    """Heights along a line.

    z : (n,) [m], NaN where missing; dx : spacing [m]; name : for messages
    """

    z: Array
    dx: float
    name: str

    def __post_init__(self) -> None:
        if self.z.size < LEAST_PROFILE:
            raise ValueError(f"{self.name}: {self.z.size} points, a profile needs at least {LEAST_PROFILE}")
        _check(self.name, self.z, self.dx)

    @property
    def lengths(self) -> tuple[float, ...]:
        """Evaluation length [m]."""
        return (self.z.size * self.dx,)

    def with_heights(self, z: Array) -> "Profile":
        return replace(self, z=z)


@dataclass(frozen=True, slots=True, kw_only=True)
class Areal:
    """Heights over a rectangle.

    z : (ny, nx) [m], NaN where missing; dx, dy : spacing [m]; name : for messages
    """

    z: Array
    dx: float
    dy: float
    name: str

    def __post_init__(self) -> None:
        if min(self.z.shape) < LEAST_AREAL:
            shape = " x ".join(str(n) for n in self.z.shape[::-1])
            raise ValueError(
                f"{self.name}: {shape} points, an areal map needs at least {LEAST_AREAL} x {LEAST_AREAL}"
            )
        _check(self.name, self.z, self.dx, self.dy)

    @property
    def lengths(self) -> tuple[float, ...]:
        """Side lengths along x and y [m]."""
        return self.z.shape[1] * self.dx, self.z.shape[0] * self.dy

    def with_heights(self, z: Array) -> "Areal":
        return replace(self, z=z)


Heights = Profile | Areal


def _check(name: str, z: Array, *spacings: float) -> None:
    for spacing in spacings:
        if not (np.isfinite(spacing) and spacing > 0.0):
            raise ValueError(f"{name}: spacing = {spacing:g} m is outside (0, inf)")
    valid = z[np.isfinite(z)]
    if valid.size == 0:
        raise ValueError(f"{name}: all {z.size} heights are missing or NaN")
    low, high = float(valid.min()), float(valid.max())
    if high - low <= FLAT * max(abs(low), abs(high)):
        raise ValueError(f"{name}: all heights are {low:g} m, a constant surface has no D and no G")


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


SMALL = 2**22
"""Size [B] of files whose numbers are counted."""
FOREIGN = {
    b"\x89PNG": "a PNG picture",
    b"\xff\xd8\xff": "a JPEG picture",
    b"GIF8": "a GIF picture",
    b"%PDF": "a PDF",
    b"MZ": "a program",
    b"\x7fELF": "a program",
}
"""First bytes of files that are given by mistake."""
SIGNED = (
    *("al3d", "bcr", "bcrf", "datx", "frt", "gwy", "h5", "jpk", "lext", "mdt", "mi", "nc", "npy", "npz"),
    *("opd", "os3d", "qep", "sdf", "sur", "tmd", "vk3", "vk4", "vk6", "vk7", "x3p", "zmg", "zon"),
)
"""Suffixes of formats of SurfaceTopography that begin with known bytes."""
SIGNATURES = (
    *(b"aISO-1.0", b"bISO-1.0", b"\x01\xb0\x93\xff", b"PK\x03\x04", b"fileType", b"CDF", b"\x89HDF"),
    *(b"\x93NUMPY", b"II*\0", b"MM\0*", b"DIGITAL SURF", b"DSCOMPRESSED", b"Binary TrueMap", b"VK"),
    *(b"Zeta-Instruments", b"KPK", b"OmniSurf3D", b"AliconaImaging", b"fileformat = bcr", b"f\0i\0l\0e"),
    *(b"\xff\xfef\0i", b"\xfe\xff\0f\0i", b"\x88\x1b\x03", b"GWY", b"FRTM_GLIDERV", b"WSxM file copyright"),
)
"""First bytes of those formats; Wyko OPD has its name from the third byte on."""
_NUMBER = re.compile(rb"\d+")


def check(path: Path) -> None:
    """Raise ValueError, one line, if a file is plainly no surface."""
    with path.open("rb") as file:
        start = file.read(64)
    if what := next((text for mark, text in FOREIGN.items() if start.startswith(mark)), None):
        raise ValueError(f"{path}: is no surface: it is {what}")
    if path.suffix[1:].lower() in SIGNED and not signed(start):
        raise ValueError(
            f"{path}: is no surface: it does not begin as a {path.suffix} file, nor as any other"
        )
    if path.stat().st_size > SMALL:
        return
    data = path.read_bytes()
    if not CONTROL.search(data) and (count := len(_NUMBER.findall(data))) < LEAST_PROFILE:
        raise ValueError(
            f"{path}: is no surface: a text of {count} numbers, "
            f"a profile needs at least {LEAST_PROFILE} points"
        )


def signed(start: bytes) -> bool:
    """Whether a file that starts so has one of the formats with known first bytes."""
    return start.startswith(SIGNATURES) or start[2:].startswith(b"Directory")
