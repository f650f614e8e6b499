"""The benchmarks run and compare the right things; their times are not tested."""

import importlib.util
import re
import subprocess
import sys
from pathlib import Path

import pytest
from clients import needs
from conftest import here_alone

from jointfmu.joints import MODELS

BENCHMARKS = Path(__file__).resolve().parents[2] / "benchmarks"


def benchmark(name):
    spec = importlib.util.spec_from_file_location(name, BENCHMARKS / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_pressure_inversion(monkeypatch, capsys):
    module = benchmark("pressure_inversion")
    monkeypatch.setattr(module, "POINTS", 100)
    monkeypatch.setattr(module, "OBVIOUS", 3)
    module.main()  # asserts itself that both ways find the same spots
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines[2:]] == ["zhao2018", "hu2023", "yu2022", "roughness"]
    assert all(float(line.split()[-1]) > 0.0 for line in lines[2:])


@needs("Linux on x86_64")
def test_native_fmus(fmus, tmp_path, monkeypatch, capsys):
    """Of FMI 2.0: 3.0 is compiled and timed by the same lines."""
    module = benchmark("native_fmus")
    monkeypatch.setattr(module, "NATIVE", ("fmi2",))
    for short in ("ROUNDS", "REPEATS"):
        monkeypatch.setattr(module, short, 1)
    monkeypatch.setattr(module, "PYTHON_CYCLES", 2)
    monkeypatch.setattr(sys, "path", list(sys.path))  # pythonfmu adds to it
    (tmp_path / fmus.name).mkdir()
    for fmu in fmus.glob("*.fmu"):
        (tmp_path / fmus.name / fmu.name).symlink_to(fmu)
    with here_alone("2"):
        module.report(module.measure(tmp_path))  # the host fails if a call does
    table, _, promised = capsys.readouterr().out.partition("\n\n")
    rows = [line.split() for line in table.splitlines()[2:]]
    flavours = [(name, flavour) for name in MODELS for flavour in ("fmi2", "python")]
    native = [(name, "fmi2") for name in (*module.OTHERS, *module.PASS_THROUGH)]
    assert [tuple(row[:2]) for row in rows] == [*flavours, *native]
    assert all(float(row[2].replace(",", "")) > 0.0 for row in rows)
    assert [row[3] for row in rows if row[0] == "PassThrough"] == ["1.0"]
    assert len(promised.splitlines()) == (5 + len(module.OTHERS) + len(MODELS))
    assert all(" us of " in line for line in promised.splitlines())


@pytest.mark.slow
def test_mujoco_plugin():
    """In a process of its own: MuJoCo takes a plugin of a name once, and dies of a second one."""
    names = benchmark("mujoco_plugin").CASES
    few = "import mujoco_plugin as m; m.REPEATS = m.PYTHON_STEPS = 2; m.main()"
    done = subprocess.run([sys.executable, "-c", few], cwd=BENCHMARKS, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    _, *rows, _ = done.stdout.splitlines()
    assert [row.split("  ")[0] for row in rows] == [*names]
    assert all(" us  of 2 us " in row for row in rows)


def test_the_readme_names_every_file():
    """Each file or folder once as a row's subject, and no row of a file that is gone."""
    text = (BENCHMARKS / "README.md").read_text()
    cells = [line.split(" | ")[0] for line in text.splitlines() if line.startswith("| `")]
    named = {name for cell in cells for name in re.findall(r"`([a-z_]+(?:\.py|\.c|/))", cell)}
    there = {path.name + "/" * path.is_dir() for path in BENCHMARKS.iterdir() if path.name[0].isalpha()}
    assert named == there - {"README.md"}
