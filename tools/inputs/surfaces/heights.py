"""Height data on a uniform grid (profiles, areal maps), and checks of grids and of files."""

import re
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from jointfmu.quantity import Array

from ...common.columns import CONTROL_CHARACTER_PATTERN

FORM_NAMES = ("tilt", "mean", "curvature")
"""Forms that can be removed: a plane (default), the mean height, a surface of second order."""
MIN_PROFILE_POINTS = 128
"""Smallest number of points of a profile: the lags of the structure function then span 0.9 decades."""
MIN_AREAL_POINTS = 64
"""Smallest number of points along each side of an areal map."""
RELATIVE_ROUND_OFF = 1e-9
"""Variation of the heights over their absolute value [1], below which it is round-off."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Profile:
    """Profile of a surface: heights at equally spaced points along a line.

    z         : heights (n,) [m], NaN where missing
    dx        : spacing [m]
    scan_name : name of the scan in messages
    """

    z: Array
    dx: float
    scan_name: str

    def __post_init__(self) -> None:
        if self.z.size < MIN_PROFILE_POINTS:
            raise ValueError(
                f"{self.scan_name}: {self.z.size} points, a profile needs at least {MIN_PROFILE_POINTS}"
            )
        _check_heights(self.scan_name, self.z, self.dx)

    @property
    def side_lengths(self) -> tuple[float, ...]:
        """Evaluation length [m] of the profile."""
        return (self.z.size * self.dx,)

    def replace_heights(self, z: Array) -> "Profile":
        """Copy of the profile with other heights."""
        return replace(self, z=z)


@dataclass(frozen=True, slots=True, kw_only=True)
class ArealMap:
    """Map of surface heights at the points of a rectangular grid (areal scan).

    z         : heights (ny, nx) [m], NaN where missing
    dx, dy    : spacing [m]
    scan_name : name of the scan in messages
    """

    z: Array
    dx: float
    dy: float
    scan_name: str

    def __post_init__(self) -> None:
        if min(self.z.shape) < MIN_AREAL_POINTS:
            shape = " x ".join(str(n) for n in self.z.shape[::-1])
            raise ValueError(
                f"{self.scan_name}: {shape} points, an areal map needs at least {MIN_AREAL_POINTS} x "
                f"{MIN_AREAL_POINTS}"
            )
        _check_heights(self.scan_name, self.z, self.dx, self.dy)

    @property
    def side_lengths(self) -> tuple[float, ...]:
        """Side lengths along x and y [m]."""
        return self.z.shape[1] * self.dx, self.z.shape[0] * self.dy

    def replace_heights(self, z: Array) -> "ArealMap":
        """Copy of the map with other heights."""
        return replace(self, z=z)


ScanHeights = Profile | ArealMap
"""Heights of a scan: profile or areal map."""


def _check_heights(scan_name: str, z: Array, *spacings: float) -> None:
    """Raise ValueError if a spacing is not positive, or if all heights are missing or constant."""
    for spacing in spacings:
        if not (np.isfinite(spacing) and spacing > 0.0):
            raise ValueError(f"{scan_name}: spacing = {spacing:g} m is outside (0, inf)")
    valid = z[np.isfinite(z)]
    if valid.size == 0:
        raise ValueError(f"{scan_name}: all {z.size} heights are missing or NaN")
    low, high = float(valid.min()), float(valid.max())
    if high - low <= RELATIVE_ROUND_OFF * max(abs(low), abs(high)):
        raise ValueError(f"{scan_name}: all heights are {low:g} m, a constant surface has no D and no G")


GridIndices = NDArray[np.int64]
"""Array of indices of grid points."""

GRID_TOLERANCE = 0.05
"""Largest deviation of a position from a regular grid over the grid spacing [1]."""
MAX_POSITION_OVER_LAST_DIGIT = 1e9
"""Largest position over the unit of its last digit [1]; beyond it, the last digit is unknown."""


def fit_regular_grid(
    scan_path: Path, axis_name: str, positions: Array, unit_size: float, allow_repeats: bool = False
) -> tuple[GridIndices, float]:
    """Fit a regular grid to positions (n,); return the grid index of each position, from 0, and the spacing.

    scan_path, axis_name : file and axis, for messages
    positions            : increasing positions as the file states them, in a unit of `unit_size` metres
    allow_repeats        : whether rounding may make neighbours equal

    First, the spacing is (last - first)/(n - 1). Each position must lie on the grid within GRID_TOLERANCE of
    the spacing, or within rounding: half a unit of its last digit plus half a unit of the last digit of the
    ends. If this fails, points are missing: the spacing is then the median gap, and each position must be a
    multiple of it. Raises ValueError if this fails too.
    """
    if positions.size < 2 or not np.all(np.isfinite(positions)):
        raise ValueError(
            f"{scan_path}: {axis_name} has a gap or a single value; expected increasing positions"
        )
    gaps = np.diff(positions)
    if positions[-1] == positions[0] or (not allow_repeats and gaps.min() <= 0.0):
        raise ValueError(
            f"{scan_path}: {axis_name} has repeated values; give every position once"
            + ("" if allow_repeats else " (a map needs three columns: x, y and the heights z)")
        )
    offset = positions - positions[0]
    step = float(offset[-1] / (positions.size - 1))
    index = np.arange(positions.size)
    digit = last_printed_digit_size(positions)
    rounding = 0.5 * (digit + max(digit[0], digit[-1]))
    if np.all(_grid_distance(offset, index, step) <= np.maximum(GRID_TOLERANCE * step, rounding)):
        return index, step
    if np.median(gaps) > 0.0:
        step = float(offset[-1] / max(np.rint(offset[-1] / np.median(gaps)), 1.0))
    index = np.rint(offset / step).astype(np.int64)
    if (
        gaps.min() <= 0.0
        or np.diff(index).min() < 1
        or _grid_distance(offset, index, step).max() > GRID_TOLERANCE * step
    ):
        raise ValueError(
            f"{scan_path}: the spacing of {axis_name} varies ({gaps.min() * unit_size:.4g} to "
            f"{gaps.max() * unit_size:.4g} m); resample to a constant one"
        )
    return index, step


def _grid_distance(positions: Array, grid_indices: GridIndices, grid_spacing: float) -> Array:
    """Distance of each position from its point of a regular grid."""
    return np.asarray(np.abs(positions - grid_indices * grid_spacing))


def last_printed_digit_size(positions: Array) -> Array:
    """Unit of the last printed digit of each position (n,).

    The positions have a fixed number of decimals or of significant digits.

    0 if the positions have more digits than MAX_POSITION_OVER_LAST_DIGIT.
    """
    sizes = np.where(positions == 0.0, 1.0, np.abs(positions))
    decade = 10.0 ** np.floor(np.log10(sizes))
    decimal, significant = _common_power_of_ten(positions), _common_power_of_ten(sizes / decade) * decade
    return np.maximum(decimal, significant)


def _common_power_of_ten(position_numbers: Array) -> float:
    """Largest power of ten, at most 1, of which all numbers are multiples: the unit of their last digit.

    0 if the largest number is more than MAX_POSITION_OVER_LAST_DIGIT times that power.
    """
    largest = float(np.abs(position_numbers).max())
    for power in range(0, -16, -1):
        scaled = position_numbers * 10.0**-power
        if largest * 10.0**-power > MAX_POSITION_OVER_LAST_DIGIT:
            break
        if np.abs(scaled - np.rint(scaled)).max() < 1e-6:
            return float(10.0**power)
    return 0.0


MAX_CHECKED_FILE_SIZE = 2**22
"""Largest size [bytes] of a text file in which the check counts the numbers."""
NON_SURFACE_SIGNATURES = {
    b"\x89PNG": "a PNG picture",
    b"\xff\xd8\xff": "a JPEG picture",
    b"GIF8": "a GIF picture",
    b"%PDF": "a PDF",
    b"MZ": "a program",
    b"\x7fELF": "a program",
}
"""First bytes of files that cannot be a surface, and what they are."""
SUFFIXES_WITH_SIGNATURE = (
    *("al3d", "bcr", "bcrf", "datx", "frt", "gwy", "h5", "jpk", "lext", "mdt", "mi", "nc", "npy", "npz"),
    *("opd", "os3d", "qep", "sdf", "sur", "tmd", "vk3", "vk4", "vk6", "vk7", "x3p", "zmg", "zon"),
)
"""Suffixes of formats of SurfaceTopography that begin with a known signature."""
SCAN_FORMAT_SIGNATURES = (
    *(b"aISO-1.0", b"bISO-1.0", b"\x01\xb0\x93\xff", b"PK\x03\x04", b"fileType", b"CDF", b"\x89HDF"),
    *(b"\x93NUMPY", b"II*\0", b"MM\0*", b"DIGITAL SURF", b"DSCOMPRESSED", b"Binary TrueMap", b"VK"),
    *(b"Zeta-Instruments", b"KPK", b"OmniSurf3D", b"AliconaImaging", b"fileformat = bcr", b"f\0i\0l\0e"),
    *(b"\xff\xfef\0i", b"\xfe\xff\0f\0i", b"\x88\x1b\x03", b"GWY", b"FRTM_GLIDERV", b"WSxM file copyright"),
)
"""Signatures (first bytes) of the known formats; the signature of Wyko OPD begins at the third byte."""
_NUMBER_BYTES_PATTERN = re.compile(rb"\d+")
"""Pattern of a number in the bytes of a file."""


def check_surface_file(scan_path: Path) -> None:
    """Raise ValueError if a file has the first bytes of another format, or too few numbers for a scan."""
    with scan_path.open("rb") as file:
        start = file.read(64)
    if kind := next(
        (text for signature, text in NON_SURFACE_SIGNATURES.items() if start.startswith(signature)), None
    ):
        raise ValueError(f"{scan_path}: is not a surface scan: it is {kind}")
    if scan_path.suffix[1:].lower() in SUFFIXES_WITH_SIGNATURE and not has_scan_signature(start):
        raise ValueError(
            f"{scan_path}: is not a surface scan: it has not the content of a {scan_path.suffix} file or "
            "another scan"
        )
    if scan_path.stat().st_size > MAX_CHECKED_FILE_SIZE:
        return
    data = scan_path.read_bytes()
    if (
        not CONTROL_CHARACTER_PATTERN.search(data)
        and (count := len(_NUMBER_BYTES_PATTERN.findall(data))) < MIN_PROFILE_POINTS
    ):
        raise ValueError(
            f"{scan_path}: is not a surface scan: a text of {count} numbers, a profile needs at least "
            f"{MIN_PROFILE_POINTS} points"
        )


def has_scan_signature(first_bytes: bytes) -> bool:
    """Whether the first bytes of a file are the signature of a known format of instruments."""
    return first_bytes.startswith(SCAN_FORMAT_SIGNATURES) or first_bytes[2:].startswith(b"Directory")
