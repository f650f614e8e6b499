"""`jointfmu cache`: what is kept, and that nothing else is removed."""

import json
from pathlib import Path

import pytest
from jointfmu_tools.cli import main


def test_only_what_is_kept_is_removed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("JOINTFMU_CACHE", str(tmp_path))
    for name in ("parts/casadi-1_ziglang-1/A.tar.xz", "zig/o/b", "mine.txt"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("12345")
    assert main(["cache", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {"folder": str(tmp_path), "files": 2, "bytes": 10}
    for _ in range(2):
        assert main(["cache", "--clear"]) == 0
        assert capsys.readouterr().out.startswith(f"{tmp_path}: 0 files, 0.0 MB")
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]
