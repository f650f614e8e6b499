"""Reading of input files. A pipe or a device is an error, before it is opened: reading might never end."""

import os
import stat
from pathlib import Path


def check_regular_file(file_path: str | Path, expected_content: str) -> None:
    """Raise ValueError if a path leads to a pipe, a device or a socket; a missing file passes.

    expected_content : what the file should be, for the error
    """
    try:
        mode = os.stat(file_path).st_mode
    except OSError:  # reading the file reports the reason
        return
    if stat.S_ISREG(mode) or stat.S_ISDIR(mode):
        return
    kind = "a pipe" if stat.S_ISFIFO(mode) else "a socket" if stat.S_ISSOCK(mode) else "a device"
    raise ValueError(f"{file_path}: is {kind}, not a regular file; expected {expected_content}")


def read_bytes(file_path: str | Path, expected_content: str) -> bytes:
    """Read the bytes of a regular file.

    expected_content : what the file should be, for the error

    Raises ValueError, one line, if the file does not exist, cannot be read or is not a regular file.
    """
    check_regular_file(file_path, expected_content)
    try:
        return Path(file_path).read_bytes()
    except OSError as error:
        raise ValueError(
            f"{file_path}: cannot be read ({error.strerror}); expected {expected_content}"
        ) from None
