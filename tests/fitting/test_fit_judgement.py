"""Judgement of a fit: implausible values, assumed exponents, undetermined values, misfits, lower bounds.

The measurements are those of an Iwan element with uniformly distributed sliders: in first loading its force
is K u - K^2 u^2/(4 F) up to the friction limit F, so its stiffness falls with the power 1/2 of the load.
"""

from pathlib import Path

import numpy as np
import pytest
from conftest import refused_line
from jointfmu_tools import cli
from jointfmu_tools.inputs.fitting import branches
from jointfmu_tools.inputs.fitting.hysteresis import HysteresisLaw, Oscillator
from jointfmu_tools.inputs.fitting.outcome import find_parameter_combinations
from jointfmu_tools.joints.bolted_joint.fit import loop

from jointfmu.joints.bolted_joint.law import working_preload
from jointfmu.parameters import load_default, load_parameter_file

DATA = Path(__file__).parent / "data"
JOINT = load_parameter_file(DATA / "angle.toml")
PRELOAD, MASS, EXPONENT = 28696.0, 2.0, 0.5
STIFFNESS, LIMIT = 3e10, 3000.0
NORMAL_FORCE = float(working_preload(JOINT.values, PRELOAD))


def first_loading(u):
    u = np.minimum(u, 2.0 * LIMIT / STIFFNESS)
    return STIFFNESS * u - STIFFNESS**2 * u**2 / (4.0 * LIMIT)


def work(u):
    slip = 2.0 * LIMIT / STIFFNESS
    inside = np.minimum(u, slip)
    return STIFFNESS * inside**2 / 2.0 - STIFFNESS**2 * inside**3 / (12.0 * LIMIT) + LIMIT * (u - inside)


IWAN = HysteresisLaw(first_loading, work)


def iwan_loops(amplitude, seed=0, noise=0.003, samples=200):
    """Displacement and force of two loops from rest, with noise relative to their ranges."""
    motion = amplitude * np.sin(np.linspace(0.0, 5.0 * np.pi, round(2.5 * samples)))
    turns = amplitude * np.array([0.0, 1.0, -1.0, 1.0, -1.0, 1.0])
    branch = np.clip((np.arange(motion.size) / (motion.size - 1) * 5.0 + 0.5).astype(int), 0, 5)
    start_force = first_loading(amplitude) * np.sign(turns)
    force = start_force[branch] + IWAN.force_change(motion, turns[branch])
    force[branch == 0] = first_loading(motion[branch == 0])
    rng = np.random.default_rng(seed)
    return tuple(
        values + noise * np.max(values) * rng.standard_normal(values.size) for values in (motion, force)
    )


def save(path, heading, *columns):
    np.savetxt(path, np.stack(columns, axis=1), delimiter=",", header=heading, comments="")
    return path


def loops_file(path, amplitude, **options):
    return save(path, "displacement [m],force [N]", *iwan_loops(amplitude, **options))


def backbone_file(path, largest_slip):
    """Frequency and damping over the amplitude, up to a friction force of `largest_slip` times the limit."""
    largest = 2.0 * LIMIT / STIFFNESS * (1.0 - np.sqrt(1.0 - largest_slip))
    amplitude = largest * np.geomspace(0.1, 1.0, 20)
    columns = Oscillator(IWAN, MASS).free_vibration(amplitude)
    return save(path, "displacement [m],frequency [Hz],damping [1]", amplitude, *columns)


def test_a_wrong_mass_gives_no_friction_coefficient(tmp_path, capsys):
    """Grams in place of kilograms: the stiffness, and with it mu, is a thousand times too large."""
    path, out = backbone_file(tmp_path / "decay.csv", 0.4), tmp_path / "joint.toml"
    words = ["fit", "loop", path, "--params", DATA / "angle.toml", "--preload", PRELOAD, "--out", out]
    assert cli.main([*map(str, words), "--modal-mass", str(1e3 * MASS)]) == 1
    assert not out.exists()
    assert "--modal-mass 2000 kg" in capsys.readouterr().err
    assert cli.main([*map(str, words), "--modal-mass", str(MASS)]) == 0


def test_mu_of_an_assumed_exponent_is_marked(tmp_path):
    """Far below gross slip only the ratio exponent/mu shows; the law has the exponent 1, the data 1/2."""
    ratio, mu = EXPONENT * NORMAL_FORCE / LIMIT, LIMIT / NORMAL_FORCE
    found = loop.fit(backbone_file(tmp_path / "low.csv", 0.3), JOINT, preload=PRELOAD, modal_mass=MASS)
    assert found.parameters.values.mu > 1.5 * mu
    assert found.facts["exponent"][0] / found.parameters.values.mu == pytest.approx(ratio, rel=0.1)
    (note,) = (text for text in found.notes if "exponent/mu" in text)
    assert f"{found.facts['exponent'][0] / found.parameters.values.mu:.4g}" in note
    slipped = loop.fit(loops_file(tmp_path / "high.csv", 20.0 * LIMIT / STIFFNESS), JOINT, preload=PRELOAD)
    assert not any("exponent/mu" in text for text in slipped.notes)
    assert slipped.parameters.values.mu == pytest.approx(mu, rel=0.02)


@pytest.fixture(scope="module")
def fit_with_exponent(tmp_path_factory):
    """Fit of a law whose exponent fits the data; the level G has nearly no effect at this exponent."""
    path = loops_file(tmp_path_factory.mktemp("loops") / "loops.csv", 4.0 * LIMIT / STIFFNESS)
    return loop.fit(path, load_default("bolted_joint"), preload=PRELOAD / 8.0)


@pytest.mark.slow
def test_a_value_that_the_data_do_not_determine_is_an_estimate(fit_with_exponent):
    determined = {row["name"]: row["determined"] for row in fit_with_exponent.list_fitted_parameters()}
    assert determined == {"mu": True, "surface.G": False, "surface.D": True}
    kinds = {name: fit_with_exponent.parameters.origins[name] for name in determined}
    assert kinds == {"mu": "calibration", "surface.G": "estimate", "surface.D": "calibration"}
    assert "not determined" in fit_with_exponent.parameters.sources["surface.G"]


@pytest.mark.slow
def test_a_combination_names_every_parameter_that_its_deviation_needs(fit_with_exponent):
    """The deviation of the named product, by the covariance of its factors, is the printed deviation."""
    solution = fit_with_exponent.solution
    names = [unknown.parameter_name for unknown in solution.unknowns]
    determined = [one for one in find_parameter_combinations(solution) if one.is_determined]
    assert determined
    for combination in determined:
        exponents = np.array([combination.exponents.get(name, 0.0) for name in names])
        deviation = np.sqrt(exponents @ solution.covariance @ exponents)
        # each parameter that is left out adds less than the deviation of the combination
        assert deviation == pytest.approx(combination.relative_deviation, rel=1.0)


def test_a_law_of_another_shape_is_told_by_its_friction_limit(tmp_path):
    """Loops that just reach gross slip: the flat ends show the limit, the fitted law misses it."""
    path = loops_file(tmp_path / "loops.csv", 2.6 * LIMIT / STIFFNESS)
    found = loop.fit(path, JOINT, preload=PRELOAD)
    assert found.facts["slip_force"][0] == pytest.approx(LIMIT, rel=0.01)
    assert found.facts["friction_limit"][0] > 1.02 * LIMIT
    (note,) = (text for text in found.notes if "flat ends alone" in text)
    assert float(note.rsplit("= ", 1)[1]) == pytest.approx(LIMIT / NORMAL_FORCE, rel=0.01)


def test_a_law_that_misses_the_stiffness_after_reversals_is_told():
    """A Jenkins element has a sharp corner; the law of the interface comes near it only if it is stiffer."""
    found = loop.fit(DATA / "sampled_densely_after_reversals.csv", JOINT, preload=PRELOAD)
    assert found.facts["shear_stiffness"][0] > 1.2 * 5.7e10
    assert any("times the stiffness of the data, 5.7e+10 N/m" in text for text in found.notes)


@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize("amplitude_over_slip", [0.1, 0.5, 2.0])
def test_noise_does_not_lift_the_lower_bound_of_the_stiffness(seed, amplitude_over_slip):
    motion, force = iwan_loops(amplitude_over_slip * 2.0 * LIMIT / STIFFNESS, seed, noise=0.02)
    found = branches.cut_branches([("", motion, force)])
    assert 0.5 * STIFFNESS < found.min_rest_stiffness < STIFFNESS


@pytest.mark.parametrize("name", ["gross_slip_2um.csv", "gross_slip_50um.csv"])
def test_few_samples_give_a_lower_bound_too(name):
    motion, force = np.loadtxt(DATA / name, delimiter=",", skiprows=1).T
    assert branches.cut_branches([("", motion, force)]).min_rest_stiffness < 5.7e10


def test_the_printed_noise_is_that_of_the_force(tmp_path):
    """Noise of 1 % of the amplitude is 0.5 % of the range of the force."""
    law = loop.make_shear_loop_law(JOINT.values, PRELOAD)[0]
    motion = 3e-8 * np.sin(np.linspace(0.0, 5.0 * np.pi, 1000))
    turns = 3e-8 * np.array([0.0, 1.0, -1.0, 1.0, -1.0, 1.0])
    branch = np.clip((np.arange(1000) / 999.0 * 5.0 + 0.5).astype(int), 0, 5)
    force = law.force_change(motion, turns[branch])
    force += float(law.friction_force(np.array([3e-8]))[0]) * np.sign(turns[branch])
    noise = 0.01 * np.max(force) * np.random.default_rng(0).standard_normal(force.size)
    path = save(tmp_path / "loops.csv", "displacement [m],force [N]", motion, force + noise)
    found = loop.fit(path, JOINT, preload=PRELOAD)
    assert found.facts["noise"][0] == pytest.approx(0.005, rel=0.1)


def test_the_force_that_clamps_the_joint_is_stated(tmp_path):
    path = backbone_file(tmp_path / "decay.csv", 0.4)
    found = loop.fit(path, JOINT, preload=PRELOAD, modal_mass=MASS)
    clamping = found.facts["clamping_force"][0]
    assert clamping == PRELOAD - JOINT.values.embedding
    mu = found.parameters.values.mu
    assert found.facts["friction_limit"][0] == pytest.approx(mu * clamping * JOINT.values.n_bolts)


def test_a_soft_structure_is_no_roughness(tmp_path):
    """A frequency a tenth of that of the joint needs a hundred times the height of the roughness."""
    path = backbone_file(tmp_path / "decay.csv", 0.4)
    found = loop.fit(path, JOINT, preload=PRELOAD, modal_mass=0.05 * MASS)
    assert found.parameters.values.h > 10.0 * JOINT.values.h
    assert any("--series-stiffness" in text for text in found.notes)
    assert not any(
        "--series-stiffness" in text for text in loop.fit(path, JOINT, preload=PRELOAD, modal_mass=MASS).notes
    )


def test_loops_of_a_soft_structure_need_its_stiffness(tmp_path, capsys):
    """The structure is sixty times softer than the interface; the ratio might be that of a wrong unit."""
    series = STIFFNESS / 60.0
    motion, force = iwan_loops(4.0 * LIMIT / STIFFNESS, noise=0.0)
    path = save(tmp_path / "soft.csv", "displacement [m],force [N]", motion + force / series, force)
    line = refused_line(capsys, "fit", "loop", path, "--params", DATA / "angle.toml", "--preload", PRELOAD)
    assert "sides = elastic, or state --series-stiffness" in line
    found = loop.fit(path, JOINT, ["mu", "h", "series_stiffness"], preload=PRELOAD)
    assert found.solution.values["series_stiffness"] == pytest.approx(series, rel=0.05)
    assert found.parameters.values.mu == pytest.approx(LIMIT / NORMAL_FORCE, rel=0.02)
