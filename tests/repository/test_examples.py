"""The examples run as notebooks and as scripts, and show each figure once; the guide shows each of them."""

import os
import re
import subprocess
import sys
from functools import cache
from pathlib import Path
from runpy import run_path
from types import SimpleNamespace
from typing import Any

import nbformat
import numpy as np
import pytest
from clients import needs
from conftest import here_alone, made_once
from jointfmu_tools import cli
from PIL import Image

ROOT = Path(__file__).resolve().parents[2]
SCRIPTS = sorted((ROOT / "examples").glob("*.py"))
NEEDED = {"bracket": "gmsh"}
"""{script: client that it needs}."""
IMAGES = ROOT / "docs" / "images"
PAGE = (ROOT / "docs" / "examples.md").read_text(encoding="utf-8")
SETUP = f"""
import sys
sys.path[:0] = {[str(ROOT / "tests" / folder) for folder in ("", "support", "repository")]}
import test_examples
test_examples.prepare_kernel()
"""
"""First cell of a notebook in these tests."""
START_PROCESS = subprocess.run


@cache
def notebooks() -> SimpleNamespace:
    """The module docs/notebooks.py."""
    return SimpleNamespace(**run_path(str(ROOT / "docs" / "notebooks.py")))


def stem(path: Path) -> str:
    return path.stem


def prepare_kernel() -> None:
    """Build FMUs for this machine only, and run commands in the process of the kernel."""
    here_alone().__enter__()
    subprocess.run = run_in_this_process  # type: ignore[assignment]


def run_in_this_process(command: list[str], **options: Any) -> Any:
    """Replace `subprocess.run`: `python -m jointfmu ...` runs in this process. Other commands, such as the
    compiler, run in processes of their own."""
    if command[:3] != [sys.executable, "-m", "jointfmu"]:
        return START_PROCESS(command, **options)
    assert options == {"check": True}
    assert cli.main(command[3:]) == 0
    return None


def run_example(script: Path, factory: pytest.TempPathFactory) -> Path:
    """Folder with the notebook of an example, with its output, and all files that the example writes."""

    def make(out: Path) -> None:
        out.mkdir()
        notebook = notebooks().read_notebook(script)
        notebook.cells.insert(0, nbformat.v4.new_code_cell(SETUP))
        notebooks().run_notebook(notebook, out)
        del notebook.cells[0]
        nbformat.write(notebook, out / f"{script.stem}.ipynb")

    return made_once(factory, f"example-{script.stem}", make)


def count_pictures(cell: Any) -> int:
    return sum("image/png" in output.get("data", {}) for output in cell.get("outputs", ()))


@pytest.mark.slow
@pytest.mark.parametrize(
    "script",
    [pytest.param(s, marks=needs(NEEDED[s.stem]) if s.stem in NEEDED else ()) for s in SCRIPTS],
    ids=stem,
)
def test_a_notebook_runs_and_shows_its_picture(
    script: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    folder = run_example(script, tmp_path_factory)
    cells = nbformat.read(folder / f"{script.stem}.ipynb", as_version=4).cells
    assert sum(map(count_pictures, cells)) == 1
    kinds = {output.output_type for cell in cells for output in cell.get("outputs", ())}
    assert kinds <= {"stream", "display_data"}  # no value of a last line that is no result
    drawn, shown = (
        np.asarray(Image.open(path).convert("L").resize((32, 24), Image.Resampling.BOX), dtype=float)
        for path in (folder / f"{script.stem}.png", IMAGES / f"example_{script.stem}.png")
    )
    # the guide's picture is the script's: a curve that moves by a cell takes 0.05 to 0.9, other fonts 0.01
    assert np.corrcoef(drawn.ravel(), shown.ravel())[0, 1] > 0.98


@pytest.mark.slow
def test_a_script_runs(tmp_path: Path) -> None:
    script = ROOT / "examples" / "drive_resonance.py"
    subprocess.run(
        [sys.executable, script],
        cwd=tmp_path,
        env=os.environ | {"MPLBACKEND": "agg"},
        check=True,
        timeout=200,
    )
    assert (tmp_path / "drive_resonance.png").exists()


FIGURE_CELLS = {
    "import jointfmu\nlaw = jointfmu.law('zhao2018')": 0,
    "figure = law.plot()": 1,  # the first figure of the kernel
    "figure": 1,
    "law.plot()": 1,
    "law.plot()\nprint('text')": 1,
    "display(law.plot())": 1,
    "import matplotlib.pyplot as plt\nfigure = law.plot()\nplt.show()": 1,
    "plt.plot([0, 1]);": 1,  # of the user, after those of jointfmu
}
"""{cell: pictures that it displays}."""


@pytest.mark.slow
def test_a_notebook_shows_each_figure_once(tmp_path: Path) -> None:
    notebook = nbformat.v4.new_notebook(cells=[*map(nbformat.v4.new_code_cell, FIGURE_CELLS)])
    notebooks().run_notebook(notebook, tmp_path)
    assert {cell.source: count_pictures(cell) for cell in notebook.cells} == FIGURE_CELLS


@pytest.mark.slow
def test_a_page_of_a_failed_example_states_the_error(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    (pages := tmp_path / "pages").mkdir()
    script = tmp_path / "broken.py"
    script.write_text('# %% [markdown]\n# # Title\n\n# %%\nraise ValueError("gmsh is missing")\n')
    notebooks().write_page(script, pages, None)
    assert "because the script failed on this machine: gmsh is missing*" in (pages / "broken.md").read_text()
    assert "broken.py: ValueError: gmsh is missing" in capfd.readouterr().err


def test_a_script_shows_each_figure_once(monkeypatch: pytest.MonkeyPatch) -> None:
    import matplotlib.pyplot as plt

    import jointfmu

    plt.switch_backend("agg")
    plt.close("all")
    figure = jointfmu.law("zhao2018").plot()
    assert [plt.figure(number) for number in plt.get_fignums()] == [figure]  # what `plt.show` displays
    plt.close("all")


@pytest.mark.parametrize("script", SCRIPTS, ids=stem)
def test_an_example_is_short_and_shown(script: Path) -> None:
    cells = notebooks().read_notebook(script).cells
    assert [cell.cell_type for cell in cells] == ["markdown", *("code" for _ in cells[1:])]
    length = sum(len(cell.source.splitlines()) for cell in cells[1:])
    assert length < (150 if script.stem == "robot_controller" else 50)
    assert f"](../examples/{script.name})" in PAGE
    assert f"](images/example_{script.stem}.png)" in PAGE


def test_the_guide_shows_no_example_that_is_gone() -> None:
    assert len(SCRIPTS) == 9
    assert {*re.findall(r"\(\.\./examples/(\w+)\.py\)", PAGE)} == {script.stem for script in SCRIPTS}
