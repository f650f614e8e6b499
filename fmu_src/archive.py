"""FMU files: zip archives whose bytes depend on their content alone, put in place in one go."""

import os
import tempfile
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from jointfmu.files.writing import made_folder


@contextmanager
def workshop(target: Path) -> Iterator[Path]:
    """A temporary folder beside `target`; the file of that name made in it replaces `target` at the end, or
    the file that it leads to as a symbolic link.

    Raises ValueError if the folder cannot be written; one that was made for it goes again on a failure.
    """
    place = Path(os.path.realpath(target))
    try:
        with (
            made_folder(place.parent),
            tempfile.TemporaryDirectory(dir=place.parent, prefix=".build-") as folder,
        ):
            yield Path(folder)
            (Path(folder) / target.name).replace(place)
    except OSError as error:
        raise ValueError(
            f"{target}: cannot be written ({error.strerror}); expected a writable folder"
        ) from None


def pack(members: Mapping[str, bytes], file: Path) -> None:
    """Write an archive: members sorted, with one fixed date and system."""
    with zipfile.ZipFile(file, "w") as archive:
        for name, content in sorted(members.items()):
            info = zipfile.ZipInfo(name, date_time=(1980, 1, 1, 0, 0, 0))
            info.create_system = 3
            info.external_attr = 0o644 << 16
            archive.writestr(info, content, zipfile.ZIP_DEFLATED, 9)
