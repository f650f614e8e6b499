"""The benchmark runs and compares the right thing; its times are not tested."""

import importlib.util
from pathlib import Path

BENCHMARKS = Path(__file__).resolve().parent.parent / "benchmarks"


def test_pressure_inversion(monkeypatch, capsys):
    path = BENCHMARKS / "pressure_inversion.py"
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    monkeypatch.setattr(module, "POINTS", 100)
    monkeypatch.setattr(module, "OBVIOUS", 3)
    module.main()  # asserts itself that both ways find the same spots
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines[2:]] == ["zhao2018", "hu2023", "yu2022"]
    assert all(float(line.split()[-1]) > 0.0 for line in lines[2:])
