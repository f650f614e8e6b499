"""The folder of a sweep: `study.json` says what is swept, `runs.jsonl` has one line per finished run.

Lines are only ever appended, each in one write and flushed to the disk, so a sweep may be killed at any
time: at most an unfinished last line is lost, which the next sweep cuts off. Every line holds `run` (its
index in the study), `parameters`, and either `columns` (the ramp) or `error` (the failure's message).
"""

import hashlib
import json
import os
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType
from typing import Any

from jointfmu.files.writing import made_folder, write_text

STUDY, RUNS, BANDS = "study.json", "runs.jsonl", "bands.csv"
FAR = 1 << 40
"""Place in the file of runs [byte] that no run reaches."""


def digest(data: bytes) -> str:
    """SHA-256 as text."""
    return hashlib.sha256(data).hexdigest()


def claim(folder: Path, study: Mapping[str, object]) -> None:
    """Make the folder this study's, or check that it already is.

    Raises ValueError if it holds another study (the line names what differs) or foreign files.
    """
    path = folder / STUDY
    if not path.exists():
        if folder.exists() and not (folder.is_dir() and not any(folder.iterdir())):
            raise ValueError(f"{folder}: holds something else than a sweep; expected a new or empty folder")
        write_text(path, json.dumps(study, indent=1) + "\n")
        return
    try:
        held = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise ValueError(f"{path}: is no study of a sweep ({error}); expected another folder") from None
    if held == json.loads(json.dumps(study)):
        return
    held = held if isinstance(held, dict) else {}
    changed = sorted(key for key in {*held, *study} if held.get(key) != study.get(key))
    before, now = (json.dumps(record.get(changed[0])) for record in (held, study))
    raise ValueError(
        f"{folder}: holds another study ({changed[0]} = {before[:60]}, now {now[:60]}); "
        "expected the same study or another folder"
    )


@contextmanager
def claimed(folder: Path, study: Mapping[str, object]) -> Iterator[None]:
    """`claim`; a folder that is new is removed again if the work is refused before any run is finished."""
    new = not (folder / STUDY).exists()
    with made_folder(folder):
        claim(folder, study)
        try:
            yield
        except ValueError:
            runs = folder / RUNS
            if new and not (runs.exists() and runs.stat().st_size):
                runs.unlink(missing_ok=True)
                (folder / STUDY).unlink()
            raise


class Journal:
    """The file of runs, open for appending; only one process may hold it."""

    def __init__(self, folder: Path) -> None:
        self.path = folder / RUNS
        self.finished: set[int] = set()
        self.failed = 0
        self.first_failure: dict[str, object] | None = None

    def __enter__(self) -> "Journal":
        self.file = self.path.open("ab")
        try:
            _lock(self.file.fileno())
        except OSError:
            self.file.close()
            raise ValueError(
                f"{self.path.parent}: another sweep is writing here; wait or choose another folder"
            ) from None
        end = 0
        for entry, end in _lines(self.path):  # noqa: B007
            self._note(entry)
        self.file.truncate(end)
        return self

    def __exit__(
        self, error_type: type[BaseException] | None, error: object, trace: TracebackType | None
    ) -> None:
        self.file.close()

    def add(self, entry: Mapping[str, object]) -> None:
        """Append a finished run, once."""
        if entry["run"] in self.finished:
            return
        self.file.write(json.dumps(entry).encode() + b"\n")
        self.file.flush()
        os.fsync(self.file.fileno())
        self._note(entry)

    def _note(self, entry: Mapping[str, Any]) -> None:
        self.finished.add(int(entry["run"]))
        if "error" in entry:
            self.failed += 1
            self.first_failure = self.first_failure or dict(entry)


def entries(folder: Path) -> Iterator[dict[str, Any]]:
    """All finished runs of a folder."""
    return (entry for entry, _ in _lines(folder / RUNS))


def _lines(path: Path) -> Iterator[tuple[dict[str, Any], int]]:
    """Complete lines and where each ends in the file; stops before an unfinished one."""
    end = 0
    with path.open("rb") as file:
        for line in file:
            if not line.endswith(b"\n"):
                return
            try:
                entry = json.loads(line)
            except ValueError:
                raise ValueError(f"{path}: byte {end} begins no run; the file was changed") from None
            end += len(line)
            yield entry, end


def _lock(handle: int) -> None:
    """Hold the file until it is closed; OSError if another process does."""
    if sys.platform == "win32":
        import msvcrt

        os.lseek(handle, FAR, os.SEEK_SET)  # what is locked cannot be read, so a byte behind all runs
        msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
    else:
        import fcntl

        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
