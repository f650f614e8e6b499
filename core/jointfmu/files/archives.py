"""Zip archives (FMUs): names and declared sizes of the members are checked before anything is unpacked.

No member is unpacked beyond its declared size, so the declared sizes limit memory and disk space.
"""

import os
import struct
import zipfile
import zlib
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path

from .reading import check_regular_file

MODEL_DESCRIPTION_NAME = "modelDescription.xml"
"""Name of the member that every FMU has."""
MAX_MEMBERS = 20_000
"""Largest number of members of an archive [1]."""
MAX_UNPACKED_SIZE = 1 << 30
"""Largest unpacked size of all members [byte]."""
MAX_TEXT_SIZE = 1 << 26
"""Largest unpacked size [byte] of a member that is read as a whole, for example XML."""
MAX_UNPACKED_OVER_ARCHIVE_SIZE = 100
"""Largest ratio [1] of the unpacked size of all members to the size of the archive.

It applies to unpacked sizes above MIN_SUSPICIOUS_SIZE.
"""
MIN_SUSPICIOUS_SIZE = 1 << 26
"""Unpacked size [byte] up to which MAX_UNPACKED_OVER_ARCHIVE_SIZE does not apply."""
_COMPRESSION_METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
"""Compression methods that FMI allows. Python ignores the declared size when it unpacks other methods."""
_ARCHIVE_ERRORS = (
    zipfile.BadZipFile,
    zlib.error,
    struct.error,
    EOFError,
    NotImplementedError,
    OverflowError,
    UnicodeDecodeError,
)
"""Exceptions that zipfile raises for a corrupt archive."""


@contextmanager
def open_archive(path: str | Path) -> Iterator[zipfile.ZipFile]:
    """Context with the checked zip archive of an FMU, for `read_member` and `extract_members`.

    Raises ValueError, one line, if the file does not exist, is a pipe or device, is no zip file or a corrupt
    one, has no model description, or fails `check_members`.
    """
    expected = f"a zip with {MODEL_DESCRIPTION_NAME}"
    if not os.path.exists(path):
        raise ValueError(f"{path}: there is no such file; expected an FMU")
    check_regular_file(path, "an FMU")
    try:
        with zipfile.ZipFile(path) as archive:
            if MODEL_DESCRIPTION_NAME not in archive.namelist():
                raise ValueError(
                    f"{path}: is not an FMU (it has no {MODEL_DESCRIPTION_NAME}); expected {expected}"
                )
            check_members(path, archive)
            yield archive
    except OSError as error:
        raise ValueError(f"{path}: cannot be read ({error.strerror or error}); expected an FMU") from None
    except _ARCHIVE_ERRORS as error:
        reason = " ".join(str(error).split()) or type(error).__name__
        raise ValueError(f"{path}: is not an FMU ({reason}); expected {expected}") from None


def check_members(path: str | Path, archive: zipfile.ZipFile) -> None:
    """Raise ValueError, one line, if it is not safe to unpack an archive.

    Errors are too many members, too large members, too high a compression ratio (a zip bomb), encryption,
    compression other than deflate, and names that lead out of the target folder.
    """
    members = archive.infolist()
    if len(members) > MAX_MEMBERS:
        raise ValueError(f"{path}: has {len(members)} members; allowed are {MAX_MEMBERS}")
    for member in members:
        name = member.filename
        if "\\" in name or ":" in name or name.startswith("/") or ".." in name.split("/"):
            raise ValueError(f"{path}: has a member {name[:80]!r}; expected names inside the archive")
        if member.flag_bits & 1 or member.compress_type not in _COMPRESSION_METHODS:
            raise ValueError(
                f"{path}: {name[:80]!r} is encrypted or uses another compression; expected deflate or none"
            )
        if name.endswith(".xml"):
            _check_text_size(path, member)
    size, packed = sum(member.file_size for member in members), os.stat(path).st_size
    if size > MAX_UNPACKED_SIZE:
        raise ValueError(f"{path}: has {size} bytes unpacked; allowed are {MAX_UNPACKED_SIZE}")
    if size > MIN_SUSPICIOUS_SIZE and size > MAX_UNPACKED_OVER_ARCHIVE_SIZE * packed:
        raise ValueError(
            f"{path}: has {size} bytes unpacked, {size / packed:.0f} times its packed size; allowed are "
            f"{MAX_UNPACKED_OVER_ARCHIVE_SIZE} times, or {MIN_SUSPICIOUS_SIZE} bytes"
        )


def check_zip(path: str | Path) -> None:
    """Check the members of a file that another package will unpack (X3P); a file that is no zip passes."""
    with suppress(*_ARCHIVE_ERRORS), zipfile.ZipFile(path) as archive:
        check_members(path, archive)


def read_member(archive: zipfile.ZipFile, member_name: str) -> bytes:
    """Read a member of an archive. Raises KeyError if it does not exist, ValueError if it is too large."""
    member = archive.getinfo(member_name)
    _check_text_size(str(archive.filename), member)
    with archive.open(member) as stream:
        return stream.read(member.file_size)


class FmuMembers(Mapping[str, bytes]):
    """Mapping {name: content} of the members of an FMU, read on access.

    Raises ValueError as `open_archive` does.
    """

    def __init__(self, path: str | Path) -> None:
        self._path = path
        self._archive: zipfile.ZipFile | None = None
        with open_archive(path) as archive:
            self._names = dict.fromkeys(archive.namelist())

    @contextmanager
    def open_for_reading(self) -> Iterator[None]:
        """Context in which the archive stays open, to read several members."""
        with open_archive(self._path) as self._archive:
            try:
                yield
            finally:
                self._archive = None

    def __contains__(self, name: object) -> bool:
        return name in self._names

    def __getitem__(self, name: str) -> bytes:
        if self._archive:
            return read_member(self._archive, name)
        with open_archive(self._path) as archive:
            return read_member(archive, name)

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)


def _check_text_size(path: str | Path, member: zipfile.ZipInfo) -> None:
    """Raise ValueError if a member of an archive is too large to be read as a whole (MAX_TEXT_SIZE)."""
    if member.file_size > MAX_TEXT_SIZE:
        raise ValueError(
            f"{path}: {member.filename[:80]!r} has {member.file_size} bytes unpacked; "
            f"allowed are {MAX_TEXT_SIZE}"
        )


def extract_members(archive: zipfile.ZipFile, folder: str | Path, is_included: Callable[[str], bool]) -> None:
    """Unpack members of a checked archive into a folder: those whose names `is_included` accepts."""
    archive.extractall(folder, [name for name in archive.namelist() if is_included(name)])
