"""Measured torque-angle curves and the laws of a given midline: tables, lines fitted, exports."""

import csv
import importlib.util
from pathlib import Path

import numpy as np
import pytest
from conftest import refused_line
from jointfmu_tools import cli
from jointfmu_tools.fitting.loop import Backbone
from jointfmu_tools.joints.harmonic_drive.fit import torque_angle
from jointfmu_tools.joints.harmonic_drive.fit.drive import windup

from jointfmu.joints.harmonic_drive.spring import torque_curve
from jointfmu.parameters import default, dump, load

pytestmark = pytest.mark.slow

SCRIPT = Path(__file__).resolve().parents[3] / "benchmarks" / "fit_round_trips.py"
SPEC = importlib.util.spec_from_file_location("table_trips", SCRIPT)
trips = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(trips)
ARCMIN = np.pi / 10800.0


@pytest.fixture
def loops(tmp_path):
    """Two loops of the default drive with levels of its own, 0.03 arcmin of noise, an offset and a drift."""
    torque, angle = trips.loops(np.random.default_rng(1))
    return trips.save(tmp_path / "loops.csv", "torque [Nm], angle [°]", torque, np.degrees(angle))


def test_a_table_is_the_mid_line(loops, tmp_path):
    out, picture = tmp_path / "drive.toml", tmp_path / "fit.svg"
    given = ["--law", "table", "--out", str(out), "--plot", str(picture)]
    assert cli.main(["fit", "torque-angle", str(loops), *given]) == 0
    file = load(out)
    assert file.law == "table"
    assert picture.stat().st_size > 0
    assert file.origins["table.torque"] == "calibration"
    fitted = torque_angle.fit(loops).parameters.values  # by the law that made the record
    torque = np.linspace(1.0, 24.0, 100)
    # the noise of a sample is 0.03 arcmin; a point of the table is the mean of some thirty
    np.testing.assert_allclose(windup(file.values, torque), windup(fitted, torque), atol=0.05 * ARCMIN)
    assert np.all(torque_curve(file.values).stiffness > 0.0)


def test_points_fold_both_directions_and_take_the_offset_off():
    T = np.linspace(-10.0, 10.0, 201)
    line = Backbone(T, T / 5e3 + np.sign(T) * 1e-5 * T**2 + 0.3, np.ones(T.size), 2, None, None, None)
    torque, angle, shift = torque_angle.points(line)
    assert shift == pytest.approx(0.3, abs=1e-12)
    np.testing.assert_allclose(angle, torque / 5e3 + 1e-5 * torque**2, rtol=0.02)  # means over bins
    with pytest.raises(ValueError, match="needs it to pass zero"):
        torque_angle.points(Backbone(T + 15.0, T, np.ones(T.size), 2, None, None, None))


def test_the_stiffnesses_of_lines_are_found(tmp_path):
    """A record of a catalogue drive from another row; the 41 knots of a mid-line round its corners."""
    start = default("harmonic_drive", "catalogue")
    truth = start.with_values({"K1": 4000.0, "K2": 7000.0, "K3": 7500.0}, "user", "test")
    T = np.concatenate([np.linspace(0, 25, 120), np.linspace(25, -25, 240), np.linspace(-25, 0, 120)])
    noise = 1e-6 * np.random.default_rng(0).standard_normal(T.size)
    path = trips.save(tmp_path / "c.csv", "torque [N.m], angle [rad]", T, windup(truth.values, T) + noise)
    found = torque_angle.fit(path, start)
    assert found.parameters.law == "catalogue"
    for name, value in {"K1": 4000.0, "K2": 7000.0, "K3": 7500.0}.items():
        assert found.parameters.flat[name] == pytest.approx(value, rel=0.02)


def test_what_has_nothing_to_fit_is_refused(loops, tmp_path, capsys):
    line = refused_line(capsys, "fit", "torque-angle", loops, "--law", "table", "--free", "d")
    assert "the law table has nothing to fit" in line
    given = ["--law", "table", "--out", str(tmp_path / "t.toml")]
    assert cli.main(["fit", "torque-angle", str(loops), *given]) == 0
    capsys.readouterr()
    line = refused_line(capsys, "fit", "torque-angle", loops, "--params", tmp_path / "t.toml")
    assert "--law table makes a new table" in line


@pytest.mark.parametrize("law", ["catalogue", "table"])
def test_exported_tables_keep_to_the_midline(law, tmp_path, capsys):
    path, out = tmp_path / "curve.csv", tmp_path / "drive.toml"
    file = default("harmonic_drive", law)
    out.write_text(dump(file), encoding="utf-8")
    assert cli.main(["export", "csv", "curve", "--params", str(out), "--out", str(path)]) == 0
    capsys.readouterr()
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    rows = np.array([[float(x) for x in row] for row in list(csv.reader(lines))[1:]])
    phi, tau = rows[:, 0], rows[:, 1]
    some = np.abs(tau) > 0.0
    expected = np.sign(tau) * torque_curve(file.values).inverse(np.abs(tau))
    np.testing.assert_allclose(phi[some], expected[some], rtol=1e-6)


@pytest.mark.parametrize("law", ["catalogue", "table"])
def test_the_modelica_record_is_the_midline(law):
    from jointfmu_tools.joints.harmonic_drive.modelica import COMPONENT
    from jointfmu_tools.modelica.records import curve_of

    file = default("harmonic_drive", law)
    (record,) = COMPONENT.records(file, [()])
    exact, made = torque_curve(file.values), curve_of(record.table)
    x = np.linspace(0.0, 1.2 * exact.end[0], 500)
    for a, b in zip(made.derivatives(x, 1), exact.derivatives(x, 1), strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-7, atol=1e-12)
    assert float(record.values["K_FTS0"]) == pytest.approx(file.values.K_FTS)
