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
MAX_ARCHIVE_MEMBERS = 20_000
"""Largest number of members of an archive [1]."""
MAX_UNPACKED_SIZE = 1 << 30
"""Largest unpacked size of all members [byte]."""
MAX_TEXT_MEMBER_SIZE = 1 << 26
"""Largest unpacked size [byte] of a member that is read as a whole, for example XML."""
MAX_UNPACKED_OVER_ARCHIVE_SIZE = 100
"""Largest ratio [1] of the unpacked size of all members to the size of the archive.

It applies to unpacked sizes above MAX_SIZE_WITHOUT_COMPRESSION_LIMIT.
"""
MAX_SIZE_WITHOUT_COMPRESSION_LIMIT = 1 << 26
"""Largest unpacked size [byte] to which MAX_UNPACKED_OVER_ARCHIVE_SIZE does not apply."""
_ALLOWED_COMPRESSION_METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
"""Compression methods that FMI allows. Python ignores the declared size when it unpacks other methods."""
_CORRUPT_ARCHIVE_EXCEPTIONS = (
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
def open_archive(archive_path: str | Path) -> Iterator[zipfile.ZipFile]:
    """Context with the zip archive of an FMU, after a check that it is safe to unpack.

    Raises ValueError, one line, if the file does not exist, is a pipe or device, is no zip file or a corrupt
    one, has no model description, or is not safe (see `check_members`).
    """
    expected = f"a zip with {MODEL_DESCRIPTION_NAME}"
    if not os.path.exists(archive_path):
        raise ValueError(f"{archive_path}: there is no such file; expected an FMU")
    check_regular_file(archive_path, "an FMU")
    try:
        with zipfile.ZipFile(archive_path) as archive:
            if MODEL_DESCRIPTION_NAME not in archive.namelist():
                raise ValueError(
                    f"{archive_path}: is not an FMU (it has no {MODEL_DESCRIPTION_NAME}); expected {expected}"
                )
            check_members(archive_path, archive)
            yield archive
    except OSError as error:
        raise ValueError(
            f"{archive_path}: cannot be read ({error.strerror or error}); expected an FMU"
        ) from None
    except _CORRUPT_ARCHIVE_EXCEPTIONS as error:
        reason = " ".join(str(error).split()) or type(error).__name__
        raise ValueError(f"{archive_path}: is not an FMU ({reason}); expected {expected}") from None


def check_members(archive_path: str | Path, archive: zipfile.ZipFile) -> None:
    """Raise ValueError, one line, if it is not safe to unpack an archive.

    Errors are too many members, too large members, too high a compression ratio (a zip bomb), encryption,
    compression other than deflate, and names that lead out of the target folder.
    """
    members = archive.infolist()
    if len(members) > MAX_ARCHIVE_MEMBERS:
        raise ValueError(
            f"{archive_path}: contains {len(members)} files; allowed are at most {MAX_ARCHIVE_MEMBERS}"
        )
    for member in members:
        name = member.filename
        if "\\" in name or ":" in name or name.startswith("/") or ".." in name.split("/"):
            raise ValueError(
                f"{archive_path}: member {name[:80]!r} would be unpacked outside the folder of the FMU; "
                "expected a relative path without '..', ':' and backslash"
            )
        if member.flag_bits & 1 or member.compress_type not in _ALLOWED_COMPRESSION_METHODS:
            raise ValueError(
                f"{archive_path}: member {name[:80]!r} is encrypted, or compressed by another method than "
                "deflate; expected neither"
            )
        if name.endswith(".xml"):
            _check_text_size(archive_path, member)
    size, packed = sum(member.file_size for member in members), os.stat(archive_path).st_size
    if size > MAX_UNPACKED_SIZE:
        raise ValueError(
            f"{archive_path}: has {size} bytes unpacked; allowed are at most {MAX_UNPACKED_SIZE}"
        )
    if size > MAX_SIZE_WITHOUT_COMPRESSION_LIMIT and size > MAX_UNPACKED_OVER_ARCHIVE_SIZE * packed:
        raise ValueError(
            f"{archive_path}: has {size} bytes unpacked, {size / packed:.0f} times its packed size; allowed "
            f"are at most {MAX_UNPACKED_OVER_ARCHIVE_SIZE} times, or at most "
            f"{MAX_SIZE_WITHOUT_COMPRESSION_LIMIT} bytes"
        )


def check_zip(archive_path: str | Path) -> None:
    """Raise ValueError if it is not safe to unpack a zip file, such as an X3P; a file that is no zip passes.

    For files that another package unpacks.
    """
    with suppress(*_CORRUPT_ARCHIVE_EXCEPTIONS), zipfile.ZipFile(archive_path) as archive:
        check_members(archive_path, archive)


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

    def __init__(self, fmu_path: str | Path) -> None:
        self._path = fmu_path
        self._archive: zipfile.ZipFile | None = None
        with open_archive(fmu_path) as archive:
            self._names = dict.fromkeys(archive.namelist())

    @contextmanager
    def open_for_reading(self) -> Iterator[None]:
        """Context in which the archive stays open, to read several members."""
        with open_archive(self._path) as self._archive:
            try:
                yield
            finally:
                self._archive = None

    def __contains__(self, member_name: object) -> bool:
        return member_name in self._names

    def __getitem__(self, member_name: str) -> bytes:
        if self._archive:
            return read_member(self._archive, member_name)
        with open_archive(self._path) as archive:
            return read_member(archive, member_name)

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)


def _check_text_size(archive_path: str | Path, archive_member: zipfile.ZipInfo) -> None:
    """Raise ValueError if a member of an archive is larger than MAX_TEXT_MEMBER_SIZE."""
    if archive_member.file_size > MAX_TEXT_MEMBER_SIZE:
        raise ValueError(
            f"{archive_path}: {archive_member.filename[:80]!r} has {archive_member.file_size} bytes "
            f"unpacked; allowed are at most {MAX_TEXT_MEMBER_SIZE}"
        )


def extract_members(
    archive: zipfile.ZipFile, target_folder: str | Path, is_included: Callable[[str], bool]
) -> None:
    """Unpack members of a checked archive into a folder: those whose names `is_included` accepts."""
    archive.extractall(target_folder, [name for name in archive.namelist() if is_included(name)])
