"""Surroundings of a test: environment variables, missing packages, the temporary folder, a full disk."""

import io
import os
import sys
import tempfile
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Protocol, TypeVar

T = TypeVar("T")


class Enter(Protocol):
    """Type of the fixture `enter`."""

    def __call__(self, surroundings: AbstractContextManager[T]) -> T: ...


class Terminal(io.StringIO):
    """Stream that is a terminal, for `redirect_stdout` and `redirect_stderr`."""

    def isatty(self) -> bool:
        """Whether it is a terminal."""
        return True


@contextmanager
def environment(**values: str | None) -> Iterator[None]:
    """Set environment variables; None removes a variable."""
    before = {name: os.environ.get(name) for name in values}
    try:
        _set_variables(values)
        yield
    finally:
        _set_variables(before)


def _set_variables(values: dict[str, str | None]) -> None:
    for name, value in values.items():
        if value is None:
            os.environ.pop(name, None)
        else:
            os.environ[name] = value


@contextmanager
def missing_package(name: str) -> Iterator[None]:
    """Make the import of a package fail, as on a machine without it."""
    before = sys.modules.get(name)
    sys.modules[name] = None  # type: ignore[assignment]
    try:
        yield
    finally:
        del sys.modules[name]
        if before is not None:
            sys.modules[name] = before


@contextmanager
def temporary_folder(folder: Path) -> Iterator[Path]:
    """Folder, which is made, for the temporary files of this process."""
    folder.mkdir(exist_ok=True)
    before, tempfile.tempdir = tempfile.tempdir, str(folder)
    try:
        yield folder
    finally:
        tempfile.tempdir = before


@contextmanager
def full_disk(free: int) -> Iterator[None]:
    """Refuse to write more than `free` bytes into a file (Linux or macOS)."""
    import resource

    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (free, limits[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
