"""Journal of a study: contents that another program or person may have written into its folder."""

import json
import os
from pathlib import Path
from typing import Any

import pytest
from clients import needs
from jointfmu_tools.studies.uncertainty import journal
from jointfmu_tools.studies.uncertainty.sweep import format_quantiles_csv

from jointfmu.files.text import replace_unprintable

GOOD: dict[str, Any] = {
    "run": 0,
    "parameters": {"surface.D": 2.5},
    "columns": {"tau": [0.0, 1.0], "K_WTS": [1.0, 2]},
}
FAILED = {"run": 1, "parameters": {"mode": "a", "n": 1, "on": True}, "error": "refused"}
ESC = "\x1b]0;owned\x07"


def columns(**changed: object) -> dict[str, object]:
    return {**GOOD, "run": 2, "columns": {**GOOD["columns"], **changed}}


WRONG = {
    "a list": [1, 2],
    "a number": 3,
    "a text": "run",
    "null": None,
    "no index": {**GOOD, "run": "2"},
    "true as index": {**GOOD, "run": True},
    "a negative index": {**GOOD, "run": -1},
    "an index beyond the study": {**GOOD, "run": 8},
    "a run twice": GOOD,
    "no parameters": {"run": 2, "columns": GOOD["columns"]},
    "a list of parameters": {**GOOD, "run": 2, "parameters": [1]},
    "a parameter that is a list": {**GOOD, "run": 2, "parameters": {"D": [1]}},
    "a parameter that is not finite": {**GOOD, "run": 2, "parameters": {"D": float("inf")}},
    "neither columns nor error": {"run": 2, "parameters": {}},
    "columns and error": {**GOOD, "run": 2, "error": "x"},
    "an error that is not a text": {"run": 2, "parameters": {}, "error": 5},
    "a list of columns": {**GOOD, "run": 2, "columns": [1.0]},
    "no columns": {**GOOD, "run": 2, "columns": {}},
    "a column that is a number": columns(K_WTS=1.0),
    "a short column": columns(K_WTS=[1.0]),
    "a text in a column": columns(K_WTS=[1.0, "2"]),
    "true in a column": columns(K_WTS=[1.0, True]),
    "NaN in a column": columns(K_WTS=[1.0, float("nan")]),
    "infinity in a column": columns(K_WTS=[1.0, float("inf")]),
    "a column that the others do not have": columns(K=[1.0, 2.0]),
    "shorter columns than the others": columns(tau=[0.0], K_WTS=[1.0]),
    "ESC in an error": {"run": 2, "parameters": {}, "error": ESC},
    "ESC in a parameter's name": {**GOOD, "run": 2, "parameters": {ESC: 1.0}},
    "ESC in a parameter": {**GOOD, "run": 2, "parameters": {"mode": ESC}},
    "ESC in a column's name": columns(**{ESC: [1.0, 2.0]}),
}
BROKEN = {
    "no JSON": b"run 2",
    "no text": b"\xff\xfe\x00",
    "a number that is too large": json.dumps(columns(K_WTS=[1.0, 2.0])).replace("2.0]", "1e999]").encode(),
    "a number of 5000 digits": b'{"run": ' + 5000 * b"1" + b"}",
    "too deep": 100_000 * b"[",
    "empty": b"",
}


def written(folder: Path, *lines: bytes) -> Path:
    folder.mkdir()
    path = folder / journal.RUNS_FILE
    path.write_bytes(b"".join(line + b"\n" for line in lines))
    return path


def refused(folder: Path) -> str:
    """Error message of both readers of a journal: one printable line."""
    with pytest.raises(ValueError, match=r"runs\.jsonl") as said:
        journal.RunJournal(folder, 8).__enter__()
    text = str(said.value)
    assert replace_unprintable(text) == text
    assert len(text.removeprefix(str(folder))) < 400
    return text


@pytest.mark.parametrize("line", [*WRONG.values(), *BROKEN.values()], ids=[*WRONG, *BROKEN])
def test_a_row_that_no_study_wrote_is_named_in_one_line(line: object, tmp_path: Path) -> None:
    raw = line if isinstance(line, bytes) else json.dumps(line).encode()
    path = written(tmp_path / "out", json.dumps(GOOD).encode(), json.dumps(FAILED).encode(), raw)
    before = path.read_bytes()
    assert refused(path.parent).startswith(f"{path}: row 3: ")
    assert path.read_bytes() == before


def test_rows_of_a_study_are_read(tmp_path: Path) -> None:
    path = written(tmp_path / "out", json.dumps(GOOD).encode(), json.dumps(FAILED).encode())
    with journal.RunJournal(path.parent, 8) as held:
        assert (held.finished_runs, held.failed_count) == ({0, 1}, 1)
        held.append_entries({**GOOD, "run": 5})
    assert [one["run"] for one in journal.read_journal_entries(path.parent)] == [0, 1, 5]
    units = {"tau": "N.m", "K_WTS": "N.m/rad"}
    assert format_quantiles_csv(path.parent, units).splitlines()[1].startswith("0.0,1.0,")


@needs("Linux or macOS")
def test_a_pipe_in_its_place_is_refused(tmp_path: Path) -> None:
    for name in (journal.RUNS_FILE, journal.STUDY_FILE):
        os.mkfifo(tmp_path / name)
    with pytest.raises(ValueError, match=r"runs\.jsonl: is a pipe, not a regular file"):
        journal.RunJournal(tmp_path, 8).__enter__()
    with pytest.raises(ValueError, match=r"study\.json: is a pipe, not a regular file"):
        journal.claim_study_folder(tmp_path, {"fmu": "a.fmu"})


@pytest.mark.parametrize("text", ["[1, 2]", "null", 100_000 * "[", "{", "\x1b"])
def test_a_study_that_is_none_is_refused(text: str, tmp_path: Path) -> None:
    (tmp_path / journal.STUDY_FILE).write_text(text)
    with pytest.raises(ValueError, match=r"study.json: is not a study"):
        journal.claim_study_folder(tmp_path, {"fmu": "a.fmu"})


@pytest.mark.parametrize("held", [{"fmu": ESC}, {ESC: 1, "fmu": "a.fmu"}])
def test_a_foreign_study_is_named_in_printable_text(held: dict[str, object], tmp_path: Path) -> None:
    (tmp_path / journal.STUDY_FILE).write_text(json.dumps(held))
    with pytest.raises(ValueError, match="holds another study") as said:
        journal.claim_study_folder(tmp_path, {"fmu": "a.fmu"})
    assert replace_unprintable(str(said.value)) == str(said.value)
