"""Loops in gross slip: stiffness after reversals, plateau, work, clearance, unit suggestions."""

import json
from pathlib import Path

import numpy as np
import pytest
from conftest import refused_line
from jointfmu_tools import cli
from jointfmu_tools.inputs.fitting import branches
from jointfmu_tools.joints.bolted_joint.fit import loop

from jointfmu.parameters import load_parameter_file

DATA = Path(__file__).parent / "data"
JOINT = DATA / "angle.toml"
PRELOAD, SLIP_FORCE, STIFFNESS = 28696.0, 3368.0, 5.707e10
OPTIONS = ("--params", JOINT, "--preload", "28696")


def jenkins_loop(amplitude, samples=400, cycles=2, stiffness=STIFFNESS, slip_force=SLIP_FORCE):
    """Displacement and force of a Jenkins element under a triangular displacement."""
    motion = amplitude * (np.abs((np.arange(cycles * samples) * 4.0 / samples + 1.0) % 4.0 - 2.0) - 1.0)
    force, now, before = np.empty(motion.size), 0.0, 0.0
    for k, u in enumerate(motion):
        now = float(np.clip(now + stiffness * (u - before), -slip_force, slip_force))
        force[k], before = now, u
    return motion, force


def save(path, motion, force, heading="displacement [m],force [N]"):
    np.savetxt(path, np.stack([motion, force], axis=1), delimiter=",", header=heading, comments="")
    return path


def cut(motion, force):
    return branches.cut_branches([("", motion, force)])


@pytest.mark.parametrize("name", ["gross_slip_2um.csv", "gross_slip_50um.csv"])
def test_friction_of_loops_in_gross_slip(name):
    found = loop.fit(DATA / name, load_parameter_file(JOINT), preload=PRELOAD)
    assert found.facts["friction_limit"][0] == pytest.approx(SLIP_FORCE, rel=0.02)
    assert found.parameters.values.mu == pytest.approx(0.153, rel=0.02)
    assert found.facts["shear_stiffness"][0] == pytest.approx(STIFFNESS, rel=0.01)
    assert found.rejection_reason() is None


def test_loops_without_samples_in_the_reversal_do_not_determine_the_stiffness(tmp_path, capsys):
    out = tmp_path / "joint.toml"
    words = ["fit", "loop", DATA / "gross_slip_50um.csv", *OPTIONS, "--out", out, "--json"]
    assert cli.main([str(word) for word in words]) == 0
    said = json.loads(capsys.readouterr().out)
    (line,) = (text for text in said["warnings"] if "do not determine h" in text)
    assert "the stiffness after a reversal is at least" in line
    assert [row["name"] for row in said["unknowns"]] == ["mu"]
    start = load_parameter_file(JOINT)
    assert load_parameter_file(out).values.h == start.values.h


def test_stiffness_after_reversals_is_no_secant_of_a_slipped_loop():
    for amplitude, samples in ((2e-7, 400), (2e-6, 800), (2e-6, 4000)):
        found = cut(*jenkins_loop(amplitude, samples))
        assert found.is_stiffness_resolved
        assert found.rest_stiffness == pytest.approx(STIFFNESS, rel=0.1)
        assert found.slip_force == pytest.approx(SLIP_FORCE, rel=1e-3)
    coarse = cut(*jenkins_loop(5e-5, 400))
    assert not coarse.is_stiffness_resolved
    assert coarse.rest_stiffness < STIFFNESS
    assert coarse.slip_force == pytest.approx(SLIP_FORCE, rel=1e-3)


def test_the_work_decides_and_not_the_rows():
    """After reversals rows are dense, so most rows have a force against the displacement."""
    table = np.loadtxt(DATA / "sampled_densely_after_reversals.csv", delimiter=",", skiprows=1)
    motion, force = table.T
    assert np.cov(motion, force)[0, 1] < 0.0
    found = loop.fit(
        DATA / "sampled_densely_after_reversals.csv", load_parameter_file(JOINT), preload=PRELOAD
    )
    assert found.parameters.values.mu == pytest.approx(0.153, rel=0.02)


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (lambda u, F: (u, -F), "the loop creates energy"),
        (lambda u, F: (u, -F), "reverse the sign of one column"),
        (lambda u, F: (u[::-1], F[::-1]), "reverse the order of the rows"),
    ],
)
def test_slipped_loops_the_other_way_round_are_refused(change, text):
    motion, force = jenkins_loop(2e-6)
    with pytest.raises(ValueError, match=text):
        cut(*change(motion, force))


def bearing_loop():
    """Loop with gross slip through a clearance of 3 um on each side, until the bolt bears."""
    motion, force = jenkins_loop(5e-6, 800)
    return motion, force + 2e10 * np.sign(motion) * np.maximum(np.abs(motion) - 3e-6, 0.0)


def test_loops_that_bear_after_slip_are_named(tmp_path, capsys):
    path = save(tmp_path / "bears.csv", *bearing_loop())
    line = refused_line(capsys, "fit", "loop", path, *OPTIONS)
    assert "slips at about" in line
    assert "through a clearance" in line
    assert "then bears" in line
    assert cut(*jenkins_loop(5e-6, 800)).find_clearance_slip() is None


def test_noise_is_no_bearing():
    rng = np.random.default_rng(0)
    motion, force = jenkins_loop(2e-6, 400, cycles=4)
    noisy = cut(
        motion + 1e-3 * 2e-6 * rng.standard_normal(motion.size),
        force + 0.02 * SLIP_FORCE * rng.standard_normal(force.size),
    )
    assert noisy.find_clearance_slip() is None
    assert noisy.slip_force == pytest.approx(SLIP_FORCE, rel=0.02)


@pytest.mark.parametrize("samples", [60, 400, 4000])
def test_noise_on_a_loop_that_sticks_is_no_bearing(samples):
    rng = np.random.default_rng(1)
    for noise in (0.003, 0.02, 0.05):
        motion, force = jenkins_loop(1e-7, samples, cycles=3, slip_force=1e9)
        force = force + noise * np.ptp(force) * rng.standard_normal(force.size)
        assert cut(motion, force).find_clearance_slip() is None


def test_a_plausible_slip_force_leaves_the_displacement_alone(tmp_path, capsys):
    """Displacements in mm under a heading in m: the plateau of the force shows that the force is right."""
    motion, force = jenkins_loop(2e-6)
    path = save(tmp_path / "m.csv", 1e3 * motion, force)
    line = refused_line(capsys, "fit", "loop", path, *OPTIONS)
    assert "likely the displacement is in mm, where the heading says m;" in line
    assert "the force is in" not in line


def test_a_slip_force_that_no_friction_has_is_refused(tmp_path, capsys):
    motion, force = jenkins_loop(2e-6)
    path = save(tmp_path / "kN.csv", motion, force, "displacement [m],force [kN]")
    line = refused_line(capsys, "fit", "loop", path, *OPTIONS)
    assert "the force at gross slip is 3.368e+06 N, which needs mu = 153" in line
    assert "(--preload)" in line
