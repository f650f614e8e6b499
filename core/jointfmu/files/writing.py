"""Atomic writing of files and folders: they are complete, or nothing has changed."""

import os
import stat
import sys
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from errno import ENOTDIR
from pathlib import Path


def write_text(output_path: str | Path, file_text: str) -> None:
    """Write a text file in UTF-8 atomically: to a temporary file, which is then renamed.

    Raises ValueError, which names the path, if the file cannot be written or UTF-8 cannot encode the text.
    """
    try:
        data = file_text.encode()
    except UnicodeEncodeError:
        raise ValueError(
            f"{output_path}: cannot be written; expected a text of valid Unicode characters"
        ) from None
    write_bytes(output_path, data)


def write_bytes(output_path: str | Path, file_content: bytes) -> None:
    """Write a file atomically: to a temporary file in the same folder, which is then renamed.

    A symbolic link stays; the file that it leads to is replaced. A device, a pipe or standard output is
    written directly. A failure leaves nothing behind.

    Raises ValueError, which names the path, if the file cannot be written.
    """
    if is_stream(output_path):
        _write_stream(output_path, file_content)
        return
    target = Path(os.path.realpath(output_path))
    temporary = _create_temporary_file(output_path, target)
    try:
        temporary.write_bytes(file_content)
        temporary.chmod(0o644)
        temporary.replace(target)
    except OSError as error:
        raise _make_write_error(output_path, error) from None
    finally:
        temporary.unlink(missing_ok=True)


def is_stream(output_path: str | Path) -> bool:
    """Whether a path leads to a device, a pipe or an output of this process: these cannot be replaced."""
    try:
        status = os.stat(output_path)
    except OSError:
        return False
    return (
        not (stat.S_ISREG(status.st_mode) or stat.S_ISDIR(status.st_mode))
        or _find_output_descriptor(status) is not None
    )


def is_standard_output(output_path: str | Path) -> bool:
    """Whether a path leads to the standard output of this process; False for the null device."""
    try:
        status = os.stat(output_path)
        return _find_output_descriptor(status) == 1 and not os.path.samestat(status, os.stat(os.devnull))
    except OSError:
        return False


def _find_output_descriptor(file_status: os.stat_result) -> int | None:
    """File descriptor of standard output (1) or standard error (2), if the file is one of them; else None.

    file_status : status of the file
    """
    for descriptor in (1, 2):
        with suppress(OSError):  # this process has closed it
            if os.path.samestat(file_status, os.fstat(descriptor)):
                return descriptor
    return None


def _write_stream(output_path: str | Path, stream_content: bytes) -> None:
    """Write bytes to a device, a pipe, or an output stream of this process, which is flushed first.

    Raises BrokenPipeError if standard output is a pipe whose reader has ended.
    """
    descriptor = _find_output_descriptor(os.stat(output_path))
    try:
        if descriptor is None:
            with open(output_path, "wb") as stream:
                stream.write(stream_content)
        else:
            for printed in (sys.stdout, sys.stderr):
                printed.flush()
            with open(descriptor, "wb", closefd=False) as stream:
                stream.write(stream_content)
    except OSError as error:
        if descriptor is not None and isinstance(error, BrokenPipeError):
            raise
        raise _make_write_error(output_path, error) from None


@contextmanager
def ensure_folder(folder_path: Path) -> Iterator[None]:
    """Context in which a folder exists; it is created, with its parents, if necessary.

    On an exception the new folders are removed again, if they are empty. Raises ValueError, which names the
    path, if the folder cannot be created.
    """
    new = [folder for folder in (folder_path, *folder_path.parents) if not folder.exists()]
    try:
        folder_path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise _make_write_error(folder_path, error) from None
    try:
        yield
    except BaseException:
        with suppress(OSError):  # stop at the first folder that is not empty
            for folder in new:
                folder.rmdir()
        raise


def write_files(output_folder: Path, text_by_file_name: Mapping[str, str]) -> list[Path]:
    """Write text files, {path in the folder: text}, first to a temporary folder, then move them.

    Raises ValueError, which names the folder, if they cannot be written; a new folder is removed again.
    Returns the paths of the files.
    """
    with ensure_folder(output_folder.parent):
        try:
            with tempfile.TemporaryDirectory(
                dir=output_folder.parent, prefix=f".{output_folder.name}."
            ) as work:
                for name, text in text_by_file_name.items():
                    file = Path(work) / name
                    file.parent.mkdir(parents=True, exist_ok=True)
                    file.write_text(text, encoding="utf-8", newline="\n")
                for name in text_by_file_name:
                    target = Path(os.path.realpath(output_folder / name))
                    target.parent.mkdir(parents=True, exist_ok=True)
                    (Path(work) / name).replace(target)
        except OSError as error:
            raise _make_write_error(output_folder, error) from None
    return [output_folder / name for name in text_by_file_name]


def check_writable(output_path: Path, output_folder: Path) -> None:
    """Raise ValueError, which names the path, if no file can be created in a folder.

    If the folder does not exist, its nearest existing parent is checked. Call it before long work; it leaves
    no file behind.
    """
    output_folder = output_folder.absolute()
    output_folder = next(parent for parent in (output_folder, *output_folder.parents) if parent.exists())
    try:
        if not output_folder.is_dir():
            raise OSError(ENOTDIR, os.strerror(ENOTDIR))
        with tempfile.TemporaryFile(dir=output_folder):
            pass
    except OSError as error:
        raise ValueError(
            f"{output_path}: cannot be written ({output_folder}: {error.strerror}); expected a writable place"
        ) from None


def _create_temporary_file(output_path: str | Path, target_path: Path) -> Path:
    """Create an empty temporary file in the folder of `target_path`, and this folder if necessary.

    target_path : file that will be replaced, with links resolved
    output_path : the same file as the user states it, for the error message

    Raises ValueError if the file cannot be created.
    """
    try:
        target_path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=target_path.parent, prefix=f".{target_path.name}.")
    except OSError as error:
        raise _make_write_error(output_path, error) from None
    os.close(handle)
    return Path(name)


def _make_write_error(output_path: str | Path, os_error: OSError) -> ValueError:
    """ValueError, one line, for an output path that could not be written, from the OSError."""
    return ValueError(f"{output_path}: cannot be written ({os_error.strerror}); expected a writable place")
