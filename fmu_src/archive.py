"""FMU files: reproducible zip archives, and atomic replacement of the target file."""

import os
import tempfile
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from jointfmu.files.writing import ensure_folder


@contextmanager
def staging_folder(target_path: Path) -> Iterator[Path]:
    """Temporary folder next to a target file; on success the file made in it replaces the target atomically.

    The file must have the name of the target. If the target is a symbolic link, its destination is replaced.

    Raises ValueError if the folder cannot be written. A parent folder created here is removed on failure.
    """
    destination = Path(os.path.realpath(target_path))
    try:
        with (
            ensure_folder(destination.parent),
            tempfile.TemporaryDirectory(dir=destination.parent, prefix=".build-") as folder,
        ):
            yield Path(folder)
            (Path(folder) / target_path.name).replace(destination)
    except OSError as error:
        raise ValueError(
            f"{target_path}: cannot be written ({error.strerror}); expected a writable folder"
        ) from None


def write_archive(content_by_path: Mapping[str, bytes], archive_path: Path) -> None:
    """Write a zip archive of {path: content}; equal content gives equal bytes."""
    with zipfile.ZipFile(archive_path, "w") as archive:
        for name, content in sorted(content_by_path.items()):
            info = zipfile.ZipInfo(name, date_time=(1980, 1, 1, 0, 0, 0))
            info.create_system = 3
            info.external_attr = 0o644 << 16
            archive.writestr(info, content, zipfile.ZIP_DEFLATED, 9)
