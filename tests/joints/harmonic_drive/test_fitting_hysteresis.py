"""Loops and decays of a harmonic drive: its law, round trips, what a file may be."""

import json

import drive_measurements as measurements
import numpy as np
import pytest
from jointfmu_tools import cli
from jointfmu_tools.fitting import decay
from jointfmu_tools.fitting.hysteresis import Oscillator
from jointfmu_tools.joints.harmonic_drive.fit import hysteresis
from memory_measurements import save

from jointfmu.joints.harmonic_drive.hysteresis import MEMORY
from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring
from jointfmu.parameters import default, load

ARCMIN = measurements.ARCMIN


def test_law_is_the_exported_one():
    drive = measurements.file("harmonic_drive", measurements.DRIVE).values
    spring, law = HarmonicDriveSpring.of(drive), hysteresis.law(drive)
    for u in (1e-6, 1e-4, 2e-3):
        moved = float(spring.hysteresis.moved(MEMORY.rest(), u).traction)
        assert law.friction(np.array([u]))[0] == pytest.approx(moved, rel=1e-12)
        assert law.elastic.force(np.array([-u]))[0] == -spring.curve.derivatives(u, 0)[0]


def test_energies_are_the_integrals_of_the_torques():
    law, u = measurements.drive_law(), np.linspace(0.0, 2e-3, 20001)
    for torque, energy in ((law.friction(u), law.work(u)), (law.elastic.force(u), law.elastic.energy(u))):
        whole = np.concatenate([[0.0], np.cumsum(0.5 * (torque[1:] + torque[:-1])) * u[1]])
        np.testing.assert_allclose(energy[1000:], whole[1000:], rtol=1e-6)  # trapezoids


def test_branches_are_as_far_apart_as_stated():
    """After rated torque, without torque: hysteresis_loss."""
    drive = measurements.file("harmonic_drive", measurements.DRIVE).values
    law = hysteresis.law(drive)
    u = np.linspace(0.0, 3e-3, 30001)
    top = np.interp(drive.rated_torque, law.friction(u) + law.elastic.force(u), u)
    down = np.linspace(top, -top, 40001)
    torque = drive.rated_torque + law.change(down, np.full(down.size, top))
    assert 2.0 * np.interp(0.0, torque[::-1], down[::-1]) == pytest.approx(drive.hysteresis_loss, rel=1e-4)


@pytest.mark.slow
def test_free_vibration_agrees_with_integration_in_time():
    """Velocity Verlet, 1e-5 with 500 steps a period; the windows miss what their own spreads say."""
    found = decay.points(*measurements.drive_decay())
    frequency, damping = Oscillator(measurements.drive_law(), measurements.INERTIA).free(found.amplitude)
    assert np.all(np.abs(found.frequency / frequency - 1.0) < found.frequency_spread + 2e-4)
    assert np.all(np.abs(found.damping / damping - 1.0) < found.damping_spread / damping + 1e-2)


@pytest.mark.slow
@pytest.mark.parametrize("case", measurements.CASES)
def test_round_trip(case, tmp_path):
    """The benchmark's 100 seeds in small: chance puts 1 % of the fits outside three deviations."""
    found, true = measurements.CASES[case](np.random.default_rng(3), tmp_path / "measured.csv")
    for name, deviation in found.solution.deviations.items():
        assert abs(np.log(found.solution.values[name] / true[name])) < 3.0 * deviation, name


@pytest.mark.slow
def test_the_command_writes_the_hysteresis(tmp_path, capsys):
    """Torque and angle are told from force and displacement by their names; the zeros are anywhere."""
    rng = np.random.default_rng(1)
    run, angle, torque = measurements.loops(measurements.drive_law(), measurements.TURNS, rng)
    path, out = tmp_path / "loops.csv", tmp_path / "drive.toml"
    save(path, "run [1], angle [deg], torque [N.m]", (run, np.degrees(angle) + 0.5, torque - 1.0))
    assert cli.main(["fit", "loop", str(path), "--out", str(out), "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    # a hundredth of the amplitude: what the noise of 1e3 samples leaves
    assert document["facts"]["offset"]["value"] == pytest.approx(np.radians(0.5), abs=1e-5)
    assert document["joint"] == "harmonic_drive"
    assert {row["name"] for row in document["unknowns"]} == set(measurements.DRIVE)
    values = load(out, "harmonic_drive").values
    assert values.hysteresis_loss == pytest.approx(measurements.DRIVE["hysteresis_loss"], rel=0.02)
    assert values.K_FTS0 == default("harmonic_drive").values.K_FTS0


@pytest.mark.slow
def test_mid_line_and_hysteresis_at_once(tmp_path):
    true = {**measurements.DRIVE, "drive_scale": 4.3}
    law = hysteresis.law(measurements.file("harmonic_drive", true).values)
    run, angle, torque = measurements.loops(law, measurements.TURNS, np.random.default_rng(1))
    path = save(tmp_path / "loops.csv", "run [1], angle [rad], torque [N.m]", (run, angle, torque))
    found = hysteresis.fit(path, free=[*hysteresis.FREE, "drive_scale"]).solution
    for name, deviation in found.deviations.items():
        assert abs(np.log(found.values[name] / true[name])) < 3.0 * deviation, name
