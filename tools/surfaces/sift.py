"""Files that are plainly no surface, refused before a reader is imported, which takes a second or two."""

import re
from pathlib import Path

from .heights import LEAST_PROFILE

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
_CONTROL = re.compile(rb"[\x00-\x08\x0e-\x1f]")
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
    if not _CONTROL.search(data) and (count := len(_NUMBER.findall(data))) < LEAST_PROFILE:
        raise ValueError(
            f"{path}: is no surface: a text of {count} numbers, "
            f"a profile needs at least {LEAST_PROFILE} points"
        )


def signed(start: bytes) -> bool:
    """Whether a file that starts so has one of the formats with known first bytes."""
    return start.startswith(SIGNATURES) or start[2:].startswith(b"Directory")
