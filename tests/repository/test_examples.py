"""The scripts in `examples` run in an empty folder and write their pictures; the guide shows each of them."""

import os
import re
import subprocess
import sys
from pathlib import Path
from runpy import run_path
from typing import Any

import numpy as np
import pytest
from clients import needs
from conftest import here_alone
from jointfmu_tools import cli
from PIL import Image

ROOT = Path(__file__).resolve().parents[2]
SCRIPTS = sorted((ROOT / "examples").glob("*.py"))
NEEDED = {"bracket": needs("gmsh")}
"""{script: packages or programs that it needs in addition to the extra `test`}."""
ALONE = {"mujoco_arm", "sweep"}
"""Scripts that run in a process of their own: MuJoCo loads a plugin only once, and a sweep starts processes.
The others run in this process and share the finite-element solutions of other tests."""
IMAGES = ROOT / "docs" / "images"
PAGE = (ROOT / "docs" / "examples.md").read_text(encoding="utf-8")


def stem(path: Path) -> str:
    return path.stem


START_PROCESS = subprocess.run


def run_in_this_process(command: list[str], **options: Any) -> Any:
    """Replace `subprocess.run`: `python -m jointfmu ...` runs in this process, for this platform only. Other
    commands, such as the compiler, run in processes of their own."""
    if command[:3] != [sys.executable, "-m", "jointfmu"]:
        return START_PROCESS(command, **options)
    assert options == {"check": True}
    assert cli.main(command[3:]) == 0
    return None


@pytest.mark.slow
@pytest.mark.parametrize("script", [pytest.param(s, marks=NEEDED.get(s.stem, ())) for s in SCRIPTS], ids=stem)
def test_an_example_runs_and_writes_its_picture(
    script: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if script.stem not in ALONE:
        import matplotlib.pyplot as plt

        monkeypatch.chdir(tmp_path)
        monkeypatch.setattr(subprocess, "run", run_in_this_process)
        plt.switch_backend("agg")
        with here_alone():
            run_path(str(script), run_name="__main__")
        plt.close("all")
    else:
        done = subprocess.run(
            [sys.executable, script],
            cwd=tmp_path,
            env=os.environ | {"MPLBACKEND": "agg"},
            capture_output=True,
            text=True,
            timeout=200,
        )
        assert done.returncode == 0, done.stderr
    drawn, shown = (
        np.asarray(Image.open(path).convert("L").resize((32, 24), Image.Resampling.BOX), dtype=float)
        for path in (tmp_path / f"{script.stem}.png", IMAGES / f"example_{script.stem}.png")
    )
    # the guide's picture is the script's: a curve that moves by a cell takes 0.05 to 0.9, other fonts 0.01
    assert np.corrcoef(drawn.ravel(), shown.ravel())[0, 1] > 0.98


@pytest.mark.parametrize("script", SCRIPTS, ids=stem)
def test_an_example_is_short_and_shown(script: Path) -> None:
    assert len(script.read_text(encoding="utf-8").splitlines()) < (
        150 if script.stem == "robot_controller" else 50
    )
    assert f"](../examples/{script.name})" in PAGE
    assert f"](images/example_{script.stem}.png)" in PAGE


def test_the_guide_shows_no_example_that_is_gone() -> None:
    assert len(SCRIPTS) == 9
    assert {*re.findall(r"\(\.\./examples/(\w+)\.py\)", PAGE)} == {script.stem for script in SCRIPTS}
