"""Input files: a pipe or a device is refused before it is opened, which could wait for ever."""

import os
import stat
from pathlib import Path


def check_regular(path: str | Path, expected: str) -> None:
    """Raise ValueError if a path leads to a pipe, a device or a socket; a missing file passes.

    expected : what the file should be, for the error
    """
    try:
        mode = os.stat(path).st_mode
    except OSError:  # reading says why
        return
    if stat.S_ISREG(mode) or stat.S_ISDIR(mode):
        return
    kind = "a pipe" if stat.S_ISFIFO(mode) else "a socket" if stat.S_ISSOCK(mode) else "a device"
    raise ValueError(f"{path}: is {kind}, no regular file; expected {expected}")


def read_bytes(path: str | Path, expected: str) -> bytes:
    """Content of a file.

    expected : what the file should be, for the error

    Raises ValueError, one line, if there is none, or it cannot be read or is no regular file.
    """
    check_regular(path, expected)
    try:
        return Path(path).read_bytes()
    except OSError as error:
        raise ValueError(f"{path}: cannot be read ({error.strerror}); expected {expected}") from None
