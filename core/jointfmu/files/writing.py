"""Files and folders that are written whole or not at all."""

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path


def write_text(path: str | Path, text: str) -> None:
    """Write a text file (UTF-8) as `write_bytes` does; ValueError also for what is no text."""
    try:
        data = text.encode()
    except UnicodeEncodeError as error:
        raise ValueError(f"{path}: cannot be written ({error.reason}); expected text") from None
    write_bytes(path, data)


def write_bytes(path: str | Path, data: bytes) -> None:
    """Write a file in one go: beside its place, then renamed; a failure leaves nothing behind.

    Raises ValueError naming the path if it cannot be written.
    """
    beside = _beside(Path(path))
    try:
        beside.write_bytes(data)
        beside.chmod(0o644)
        beside.replace(path)
    except OSError as error:
        raise _unwritable(path, error) from None
    finally:
        beside.unlink(missing_ok=True)


@contextmanager
def made_folder(path: Path) -> Iterator[None]:
    """A folder, made with those above it where need be; what was made goes again, if empty, on a failure.

    Raises ValueError naming the path if it cannot be made.
    """
    new = [folder for folder in (path, *path.parents) if not folder.exists()]
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise _unwritable(path, error) from None
    try:
        yield
    except BaseException:
        with suppress(OSError):  # the first that is not empty ends it
            for folder in new:
                folder.rmdir()
        raise


def check_writable(path: str | Path) -> None:
    """Raise ValueError naming the path if `write_text` could not write it; makes nothing."""
    path = Path(path)
    if path.is_dir():
        raise ValueError(f"{path}: is a folder; expected a file to write")
    parent = next(folder for folder in path.absolute().parents if folder.exists())
    if not parent.is_dir() or not os.access(parent, os.W_OK):
        raise ValueError(f"{path}: cannot be written ({parent} is not writable); expected a writable place")


def _beside(path: Path) -> Path:
    """A new empty file in the folder of `path`, which is made if need be."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    except OSError as error:
        raise _unwritable(path, error) from None
    os.close(handle)
    return Path(name)


def _unwritable(path: str | Path, error: OSError) -> ValueError:
    return ValueError(f"{path}: cannot be written ({error.strerror}); expected a writable place")
