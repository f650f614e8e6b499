"""Files and folders that are written whole or not at all."""

import os
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from errno import ENOTDIR
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


def write_files(folder: Path, files: Mapping[str, str]) -> list[Path]:
    """Write text files, {path in the folder: text}, all of them or none: beside the folder, then moved.

    Raises ValueError naming the folder if they cannot be written; a folder that was made for them goes again.
    """
    with made_folder(folder.parent):
        try:
            with tempfile.TemporaryDirectory(dir=folder.parent, prefix=f".{folder.name}.") as work:
                for name, text in files.items():
                    file = Path(work) / name
                    file.parent.mkdir(parents=True, exist_ok=True)
                    file.write_text(text, encoding="utf-8", newline="\n")
                for name in files:
                    (folder / name).parent.mkdir(parents=True, exist_ok=True)
                    (Path(work) / name).replace(folder / name)
        except OSError as error:
            raise _unwritable(folder, error) from None
    return [folder / name for name in files]


def check_writable(path: str | Path) -> None:
    """Raise ValueError naming the path if `write_text` could not write it; leaves nothing.

    To be called before long work.
    """
    path = Path(path)
    if path.is_dir():
        raise ValueError(f"{path}: is a folder; expected a file to write")
    _check_place(path, next(folder for folder in path.absolute().parents if folder.exists()))


def check_folder(path: str | Path) -> None:
    """Raise ValueError naming the path if no files could be written into this folder; leaves nothing.

    To be called before long work.
    """
    path = Path(path).absolute()
    _check_place(path, next(folder for folder in (path, *path.parents) if folder.exists()))


def _check_place(path: Path, folder: Path) -> None:
    """Try to make a file in a folder that exists."""
    try:
        if not folder.is_dir():
            raise OSError(ENOTDIR, os.strerror(ENOTDIR))
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise ValueError(
            f"{path}: cannot be written ({folder}: {error.strerror}); expected a writable place"
        ) from None


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
