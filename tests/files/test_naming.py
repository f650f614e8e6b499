"""Names that a user may give to an FMU, and refused names."""

from pathlib import Path

import pytest
from conftest import refused_line
from jointfmu_fmu_src.naming import MAX_FMU_NAME_LENGTH, check_fmu_name

from jointfmu.joints import MODELS

NAME = next(iter(MODELS))
ALLOWED = "allowed are at most 63 letters, digits and _, no digit first, no word of C, Python or Modelica"


@pytest.mark.parametrize("name", ["A", "_", "ShoulderDrive", "drive_2", "x" * MAX_FMU_NAME_LENGTH])
def test_identifiers_are_names(name: str) -> None:
    assert check_fmu_name(name) == name


@pytest.mark.parametrize(
    "name",
    ["", "2drive", "my drive", "drive-2", "drive.fmu", "../x", "Grün", "a\n", "int", "class", "x" * 64],
)
def test_all_else_is_refused_in_one_line(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    line = refused_line(capsys, "build", NAME, f"--name={name}", "--out", tmp_path / "out")
    assert "is not a model identifier" in line
    assert ALLOWED in line
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("words", "part"),
    [
        ((), f"state one FMU of {', '.join(MODELS)}"),
        (tuple(MODELS)[:2], "is for one FMU"),
        ((NAME, "--systems"), "leave out --systems"),
    ],
)
def test_a_name_is_for_one_fmu(
    words: tuple[str, ...], part: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    line = refused_line(capsys, "build", *words, "--name", "Mine", "--out", tmp_path / "out")
    assert part in line
    assert not (tmp_path / "out").exists()
