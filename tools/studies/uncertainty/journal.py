"""Folder of a study: `study.json` describes the study, `runs.jsonl` has one line for each finished run.

A line is appended in one write and flushed to the disk. Therefore a study may be killed at any time: at most
an unfinished last line is lost, and the next start removes it. Each line is a JSON object with `run` (index
in the study), `parameters`, and either `columns` (results of the ramp) or `error` (message). Lines are
checked when they are read, because the folder may come from an untrusted source.
"""

import hashlib
import json
import os
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from math import isfinite
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np

from jointfmu.files.reading import check_regular_file, read_bytes
from jointfmu.files.text import check_text, replace_unprintable
from jointfmu.files.writing import ensure_folder, write_text

STUDY_FILE, RUNS_FILE, BANDS_FILE = "study.json", "runs.jsonl", "bands.csv"
SOBOL_RUNS_FILE = "index_runs.jsonl"
"""Name of the file with further runs, for Sobol' indices."""
LOCKED_BYTE_POSITION = 1 << 40
"""Position of the locked byte in the file of runs [byte], beyond all runs."""


def sha256_hex(hashed_bytes: bytes) -> str:
    """SHA-256 digest of bytes, as hexadecimal text."""
    return hashlib.sha256(hashed_bytes).hexdigest()


def claim_study_folder(study_folder: Path, study_record: Mapping[str, object]) -> None:
    """Write the record of a study into its folder, or check that the folder already holds this study.

    Raises ValueError if the folder holds another study (the message names a difference) or other files.
    """
    path = study_folder / STUDY_FILE
    if not path.exists():
        if study_folder.exists() and not (study_folder.is_dir() and not any(study_folder.iterdir())):
            raise ValueError(
                f"{study_folder}: contains other files than those of a study; state a new or empty folder"
            )
        write_text(path, json.dumps(study_record, indent=1) + "\n")
        return
    data = read_bytes(path, "a study")
    try:
        present = json.loads(data.decode())
    except (ValueError, RecursionError) as error:
        raise ValueError(f"{path}: is not a study ({error}); expected another folder") from None
    if not isinstance(present, dict):
        raise ValueError(f"{path}: is not a study (no JSON object); expected another folder")
    if present == json.loads(json.dumps(study_record)):
        return
    changed = sorted(key for key in {*present, *study_record} if present.get(key) != study_record.get(key))
    old, new = (json.dumps(record.get(changed[0])) for record in (present, study_record))
    raise ValueError(
        f"{study_folder}: holds another study ({replace_unprintable(changed[0])[:60]} = {old[:60]}, now "
        f"{new[:60]}); repeat that study, or state another folder"
    )


@contextmanager
def open_claimed_folder(study_folder: Path, study_record: Mapping[str, object]) -> Iterator[None]:
    """Context manager that claims the folder of a study, see `claim_study_folder`.

    If the context raises ValueError before a run is finished, a new folder is removed again.
    """
    new = not (study_folder / STUDY_FILE).exists()
    with ensure_folder(study_folder):
        claim_study_folder(study_folder, study_record)
        try:
            yield
        except ValueError:
            runs = study_folder / RUNS_FILE
            if new and not (runs.exists() and runs.stat().st_size):
                runs.unlink(missing_ok=True)
                (study_folder / STUDY_FILE).unlink()
            raise


class RunJournal:
    """File of finished runs of a study, open for appending and locked by this process.

    run_count     : number of runs of the study
    finished_runs : indices of the finished runs
    failed_count  : number of failed runs
    first_failure : entry of the first failed run, or None

    Entering the context raises ValueError, one line, if another process has locked the file, or if a row is
    no run of the study.
    """

    def __init__(self, study_folder: Path, run_count: int, journal_file_name: str = RUNS_FILE) -> None:
        self.run_count = run_count
        self.path = study_folder / journal_file_name
        self.finished_runs: set[int] = set()
        self.failed_count = 0
        self.first_failure: dict[str, object] | None = None

    def __enter__(self) -> "RunJournal":
        check_regular_file(self.path, "the journal of a study")
        self.file = self.path.open("ab")
        try:
            _lock_file(self.file.fileno())
        except OSError:
            self.file.close()
            raise ValueError(
                f"{self.path.parent}: another command is writing here; wait, or state another folder"
            ) from None
        end = 0
        try:
            for row, (entry, end) in enumerate(_read_journal_lines(self.path), 1):  # noqa: B007
                if entry["run"] >= self.run_count:
                    raise _make_row_error(
                        self.path, row, f"the study has {self.run_count} runs, no run {entry['run']}"
                    )
                self._count_finished_run(entry)
            self.file.truncate(end)
        except BaseException:
            self.file.close()
            raise
        return self

    def __exit__(
        self, error_type: type[BaseException] | None, error: object, traceback: TracebackType | None
    ) -> None:
        self.file.close()

    def append_entries(self, *entries: Mapping[str, Any]) -> None:
        """Append the entries of finished runs, except of runs that are already in the file."""
        for entry in entries:
            if entry["run"] not in self.finished_runs:
                self.file.write(json.dumps(entry, default=np.ndarray.tolist).encode() + b"\n")
                self._count_finished_run(entry)
        self.file.flush()
        os.fsync(self.file.fileno())

    def _count_finished_run(self, journal_entry: Mapping[str, Any]) -> None:
        """Update the counts and the first failure with an entry."""
        self.finished_runs.add(int(journal_entry["run"]))
        if "error" in journal_entry:
            self.failed_count += 1
            self.first_failure = self.first_failure or dict(journal_entry)


def read_journal_entries(study_folder: Path, journal_file_name: str = RUNS_FILE) -> Iterator[dict[str, Any]]:
    """Entries of all finished runs of a folder. Raises ValueError, one line, for a row that is not a run."""
    return (entry for entry, _ in _read_journal_lines(study_folder / journal_file_name))


def _read_journal_lines(journal_path: Path) -> Iterator[tuple[dict[str, Any], int]]:
    """Yield (entry, position of its end in the file [byte]) of each complete line.

    Raises ValueError, one line, for a row that is not a run, a repeated run, or columns of another length.
    """
    end, rows, shape = 0, dict[int, int](), dict[str, int]()
    check_regular_file(journal_path, "the journal of a study")
    with journal_path.open("rb") as file:
        for row, line in enumerate(file, 1):
            if not line.endswith(b"\n"):
                return
            try:
                entry = json.loads(line.decode())
                _check_journal_entry(entry)
                if (first_row := rows.setdefault(entry["run"], row)) != row:
                    raise ValueError(f"run {entry['run']} is already in row {first_row}")
                if lengths := {name: len(values) for name, values in entry.get("columns", {}).items()}:
                    shape = shape or lengths
                    if lengths != shape:
                        raise ValueError("its columns are not those of the other runs")
            except (ValueError, RecursionError) as error:
                raise _make_row_error(journal_path, row, str(error)) from None
            end += len(line)
            yield entry, end


def _make_row_error(journal_path: Path, row_number: int, error_reason: str) -> ValueError:
    """Error for a row of the file of runs that is not a run of the study."""
    return ValueError(
        f"{journal_path}: row {row_number}: {replace_unprintable(error_reason)[:200]}; expected a run as the "
        "command wrote it: delete the row, and the same command repeats its run"
    )


def _check_journal_entry(journal_entry: object) -> None:
    """Raise ValueError if a JSON value is no journal entry of a run."""
    if not isinstance(journal_entry, dict):
        raise ValueError(f"{_format_json_value(journal_entry)} is not a JSON object")
    run, parameters = journal_entry.get("run"), journal_entry.get("parameters")
    if type(run) is not int or run < 0:
        raise ValueError(f"run = {_format_json_value(run)} is not the number of a run, 0, 1, 2, ...")
    if not isinstance(parameters, dict):
        raise ValueError(f"parameters = {_format_json_value(parameters)} is not a JSON object")
    for name, value in parameters.items():
        check_text("a name in parameters", name)
        if isinstance(value, str):
            check_text(f"parameter {name}", value)
        elif type(value) is not bool and not _is_finite_number(value):
            raise ValueError(
                f"parameter {name} = {_format_json_value(value)} is not a finite number, word, true or false"
            )
    if ("columns" in journal_entry) == ("error" in journal_entry):
        raise ValueError("has both columns and error, or neither")
    if "error" in journal_entry:
        if not isinstance(journal_entry["error"], str):
            raise ValueError(f"error = {_format_json_value(journal_entry['error'])} is not a text")
        check_text("error", journal_entry["error"])
        return
    columns = journal_entry["columns"]
    if not isinstance(columns, dict) or not columns:
        raise ValueError(
            f"columns = {_format_json_value(columns)} is not a JSON object with lists of numbers"
        )
    lengths = set()
    for name, values in columns.items():
        check_text("a name in columns", name)
        if not isinstance(values, list):
            raise ValueError(f"column {name} = {_format_json_value(values)} is not a list")
        if wrong := [value for value in values if not _is_finite_number(value)]:
            raise ValueError(
                f"column {name} has {_format_json_value(wrong[0])}, which is not a finite number"
            )
        lengths.add(len(values))
    if len(lengths) > 1 or 0 in lengths:
        raise ValueError(f"its columns differ in length: {' and '.join(map(str, sorted(lengths)))} values")


def _is_finite_number(json_value: object) -> bool:
    """Whether a JSON value is a finite number (no boolean)."""
    return type(json_value) is int or (type(json_value) is float and isfinite(json_value))


def _format_json_value(json_value: object) -> str:
    """Format a JSON value in at most 60 characters."""
    return json.dumps(json_value)[:60]


def _lock_file(file_descriptor: int) -> None:
    """Lock the file of runs for this process until it is closed; OSError if another process has locked it."""
    if sys.platform == "win32":
        import msvcrt

        os.lseek(
            file_descriptor, LOCKED_BYTE_POSITION, os.SEEK_SET
        )  # locked bytes cannot be read: lock a byte beyond all runs
        msvcrt.locking(file_descriptor, msvcrt.LK_NBLCK, 1)
    else:
        import fcntl

        fcntl.flock(file_descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
