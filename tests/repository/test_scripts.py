"""Benchmarks and studies run, and each has its row in the README of its folder. Times are not tested."""

import ast
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from clients import needs

from jointfmu.joints import MODELS

ROOT = Path(__file__).resolve().parents[2]
SCRIPTS = [path for folder in ("benchmarks", "studies") for path in sorted((ROOT / folder).glob("*.py"))]


def run(script: str, *words: str) -> str:
    """Standard output of a script, run in a process of its own as users run it."""
    done = subprocess.run(
        [sys.executable, str(ROOT / script), *words], capture_output=True, text=True, env=os.environ
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def table_lines(text: str) -> list[str]:
    return [line for line in text.splitlines() if line.startswith("| ")]


def test_interface_laws_are_compared_with_brentq():
    """The benchmark runs and checks that its own inversion and brentq find the same spots."""
    lines = run("benchmarks/interface_laws.py", "--quick").splitlines()
    assert [line.split()[0] for line in lines[2:]] == ["zhao2018", "hu2023", "yu2022", "roughness", "table"]
    rates = [line.split()[1:4] for line in lines[2:]]  # the ratio after them rounds to 0 on a busy machine
    assert all(float(rate) > 0.0 for row in rates for rate in row)


@pytest.mark.slow
@needs("Linux on x86_64")
def test_native_fmus_are_timed_in_every_flavour():
    """The benchmark times every flavour; its C host ends with an error if a call of an FMU fails."""
    table, _, targets = run("benchmarks/native_fmus.py", "--quick").partition("\n\n")
    rows = [line.split() for line in table.splitlines()[2:]]
    flavours = ("fmi2", "fmi3", "python")
    assert [tuple(row[:2]) for row in rows if row[0] in MODELS] == [(m, f) for m in MODELS for f in flavours]
    assert all(float(row[2].replace(",", "")) > 0.0 for row in rows)
    assert [row[3] for row in rows if row[0] == "PassThrough"] == ["1.0", "1.0"]
    assert targets
    assert all(" us of " in line or " kB of " in line for line in targets.splitlines())


@pytest.mark.slow
def test_the_plugin_is_timed_beside_python():
    _, *rows, _ = run("benchmarks/mujoco_joints.py", "--run", "plugin", "--quick").splitlines()
    assert [row.split("  ")[0] for row in rows] == ["elastic", "hysteresis", "hysteresis and friction"]
    assert all(" us  of 2 us " in row for row in rows)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("page", "sections"),
    [
        ("harmonic_drive_explanation", ("single-drives", "load", "speed", "load-and-speed", "examples")),
        ("harmonic_drive_explanation", ("friction",)),
    ],
)
def test_pages_have_the_tables_of_their_study(page, sections):
    """The page has all rows of drives of its study; its other rows are shortened."""
    text = (ROOT / "docs" / f"{page}.md").read_text(encoding="utf-8")
    rows = [row for row in table_lines(run(f"studies/{page}.py", *sections)) if row.startswith("| RT1-H")]
    assert rows
    assert all(row in text for row in rows)


@pytest.mark.parametrize("folder", ["benchmarks", "studies"])
def test_the_readme_names_every_file(folder):
    """No row or sentence names a missing file."""
    text = (ROOT / folder / "README.md").read_text(encoding="utf-8")
    named = set(re.findall(r"`([a-z_]+\.(?:py|c))`", text))
    assert named == {path.name for path in (ROOT / folder).iterdir() if path.suffix in (".py", ".c")}


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_a_study_belongs_to_a_page_or_to_another_study(path):
    if path.parent.name == "benchmarks" or (ROOT / "docs" / f"{path.stem}.md").exists():
        return
    imported = re.compile(rf"^(?:import {path.stem}\b|from {path.stem} import)", re.M)
    assert any(imported.search(other.read_text(encoding="utf-8")) for other in path.parent.glob("*.py"))


def imported_modules(path: Path) -> set[str]:
    names = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            names.add(node.module.partition(".")[0])
    return names


def test_no_test_imports_a_benchmark_or_a_study():
    scripts = {path.stem for path in SCRIPTS}
    tests = (ROOT / "tests").rglob("*.py")
    assert {p.name: found for p in tests if (found := imported_modules(p) & scripts)} == {}
