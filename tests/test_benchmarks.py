"""The benchmarks run and compare the right things; their times are not tested."""

import importlib.util
import platform
import re
import sys
from pathlib import Path

import pytest

from jointfmu.joints import MODELS

BENCHMARKS = Path(__file__).resolve().parent.parent / "benchmarks"


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
    assert [line.split()[0] for line in lines[2:]] == ["zhao2018", "hu2023", "yu2022"]
    assert all(float(line.split()[-1]) > 0.0 for line in lines[2:])


@pytest.mark.skipif((sys.platform, platform.machine()) != ("linux", "x86_64"), reason="needs Linux on x86_64")
def test_native_fmus(native, fmus, tmp_path, monkeypatch, capsys):
    module = benchmark("native_fmus")
    for short in ("ROUNDS", "REPEATS"):
        monkeypatch.setattr(module, short, 1)
    monkeypatch.setattr(module, "PYTHON_CYCLES", 2)
    monkeypatch.setattr(sys, "path", list(sys.path))  # pythonfmu adds to it
    for folder in (native / "fmi2", native / "fmi3", fmus):
        (tmp_path / folder.name).mkdir()
        for fmu in folder.glob("*.fmu"):
            (tmp_path / folder.name / fmu.name).symlink_to(fmu)
    module.report(module.measure(tmp_path))  # the host fails if a call does
    rows = [line.split() for line in capsys.readouterr().out.splitlines()[2:]]
    flavours = [(name, flavour) for name in MODELS for flavour in ("fmi2", "fmi3", "python")]
    assert [tuple(row[:2]) for row in rows] == [*flavours, ("PassThrough", "fmi2"), ("PassThrough", "fmi3")]
    assert all(float(row[2].replace(",", "")) > 0.0 for row in rows)
    assert [row[3] for row in rows[-2:]] == ["1.0", "1.0"]


def test_the_readme_names_every_file():
    """Each file or folder once as a row's subject, and no row of a file that is gone."""
    text = (BENCHMARKS / "README.md").read_text()
    cells = [line.split(" | ")[0] for line in text.splitlines() if line.startswith("| `")]
    named = {name for cell in cells for name in re.findall(r"`([a-z_]+(?:\.py|\.c|/))", cell)}
    there = {path.name + "/" * path.is_dir() for path in BENCHMARKS.iterdir() if path.name[0].isalpha()}
    assert named == there - {"README.md"}
