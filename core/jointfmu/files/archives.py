"""Zip archives, FMUs above all: names and declared sizes are checked before anything is unpacked.

No member is unpacked beyond its declared size, so the sizes of the archive's list bound memory and disk.
"""

import os
import struct
import zipfile
import zlib
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path

from .reading import check_regular

DESCRIPTION = "modelDescription.xml"
"""The member that every FMU has."""
MAX_MEMBERS = 20_000
"""Members of an archive [1]."""
MAX_SIZE = 1 << 30
"""Unpacked size of all members [byte]."""
MAX_TEXT_SIZE = 1 << 26
"""Unpacked size of a member that is read or parsed as a whole, as XML is [byte]."""
MAX_RATIO = 100
"""Unpacked size of all members over the size of the archive [1], where it is above SMALL_SIZE."""
SMALL_SIZE = 1 << 26
"""Unpacked size [byte] up to which the ratio is free."""
_METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
"""Those of FMI. Others unpack a member in one go, whatever size it declares."""
_BROKEN = (
    zipfile.BadZipFile,
    zlib.error,
    struct.error,
    EOFError,
    NotImplementedError,
    OverflowError,
    UnicodeDecodeError,
)
"""What zipfile raises of a broken archive."""


@contextmanager
def opened(path: str | Path) -> Iterator[zipfile.ZipFile]:
    """An FMU as an archive that may be unpacked; `content` and `extract` do it.

    Raises ValueError, one line: there is no such file, it is a pipe or device, no zip or a broken one, it has
    no description, or `check` refuses it.
    """
    expected = f"a zip with {DESCRIPTION}"
    if not os.path.exists(path):
        raise ValueError(f"{path}: there is no such file; expected an FMU")
    check_regular(path, "an FMU")
    try:
        with zipfile.ZipFile(path) as archive:
            if DESCRIPTION not in archive.namelist():
                raise ValueError(f"{path}: is no FMU (it has no {DESCRIPTION}); expected {expected}")
            check(path, archive)
            yield archive
    except OSError as error:
        raise ValueError(f"{path}: cannot be read ({error.strerror or error}); expected an FMU") from None
    except _BROKEN as error:
        reason = " ".join(str(error).split()) or type(error).__name__
        raise ValueError(f"{path}: is no FMU ({reason}); expected {expected}") from None


def check(path: str | Path, archive: zipfile.ZipFile) -> None:
    """Raise ValueError, one line, for an archive that is not to be unpacked.

    Refused are too many members, too large ones, too high a ratio (a zip bomb), encryption, compression
    other than deflate, and names that lead out of the folder into which the archive is unpacked.
    """
    members = archive.infolist()
    if len(members) > MAX_MEMBERS:
        raise ValueError(f"{path}: has {len(members)} members; allowed are {MAX_MEMBERS}")
    for member in members:
        name = member.filename
        if "\\" in name or ":" in name or name.startswith("/") or ".." in name.split("/"):
            raise ValueError(f"{path}: has a member {name[:80]!r}; expected names inside of the archive")
        if member.flag_bits & 1 or member.compress_type not in _METHODS:
            raise ValueError(
                f"{path}: {name[:80]!r} is encrypted or compressed otherwise; expected deflate or none"
            )
        if name.endswith(".xml"):
            _check_text_size(path, member)
    size, packed = sum(member.file_size for member in members), os.stat(path).st_size
    if size > MAX_SIZE:
        raise ValueError(f"{path}: has {size} bytes unpacked; allowed are {MAX_SIZE}")
    if size > SMALL_SIZE and size > MAX_RATIO * packed:
        raise ValueError(
            f"{path}: has {size} bytes unpacked, {size / packed:.0f} times its own size; allowed are "
            f"{MAX_RATIO} times, or {SMALL_SIZE} bytes"
        )


def check_if_zip(path: str | Path) -> None:
    """`check` a file that may be an archive (X3P), which another package will unpack."""
    with suppress(*_BROKEN), zipfile.ZipFile(path) as archive:
        check(path, archive)


def content(archive: zipfile.ZipFile, name: str) -> bytes:
    """A member of an archive. Raises KeyError if there is none, ValueError if it is too large."""
    member = archive.getinfo(name)
    _check_text_size(str(archive.filename), member)
    with archive.open(member) as stream:
        return stream.read(member.file_size)


class Members(Mapping[str, bytes]):
    """{name: content} of an FMU's members, each read when it is asked for. Raises ValueError as `opened`."""

    def __init__(self, path: str | Path) -> None:
        self._path = path
        self._archive: zipfile.ZipFile | None = None
        with opened(path) as archive:
            self._names = dict.fromkeys(archive.namelist())

    @contextmanager
    def open_for_reading(self) -> Iterator[None]:
        """Open the archive once for all members that the body reads."""
        with opened(self._path) as self._archive:
            try:
                yield
            finally:
                self._archive = None

    def __contains__(self, name: object) -> bool:
        return name in self._names

    def __getitem__(self, name: str) -> bytes:
        if self._archive:
            return content(self._archive, name)
        with opened(self._path) as archive:
            return content(archive, name)

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)


def _check_text_size(path: str | Path, member: zipfile.ZipInfo) -> None:
    if member.file_size > MAX_TEXT_SIZE:
        raise ValueError(
            f"{path}: {member.filename[:80]!r} has {member.file_size} bytes unpacked; "
            f"allowed are {MAX_TEXT_SIZE}"
        )


def extract(archive: zipfile.ZipFile, folder: str | Path, include: Callable[[str], bool]) -> None:
    """Unpack the members of a checked archive whose names are included."""
    archive.extractall(folder, [name for name in archive.namelist() if include(name)])
