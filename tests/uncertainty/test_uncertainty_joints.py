"""The reduced evaluation of many samples against the exported springs, and the command."""

import csv
import io
import json

import numpy as np
import pytest
from conftest import refused_line
from joint_cases import JOINTS
from jointfmu_tools import cli
from jointfmu_tools.studies.uncertainty import propagate
from jointfmu_tools.studies.uncertainty.problem import reduced_curves, state_problem

from jointfmu.joints import KINDS
from jointfmu.parameters import load_default
from jointfmu.quantity import build_parameter_set, flat_fields, flatten_parameters

pytestmark = pytest.mark.slow

REDUCED = 1e-4
"""Relative error that the reduced evaluation states (docs/uncertainty_reference.md)."""


@pytest.mark.parametrize(
    ("joint", "study"), [(kind, study) for kind, joint in JOINTS.items() for study in joint.studies]
)
def test_reduced_evaluation_against_the_springs(joint, study):
    given, count = JOINTS[joint].studies[study]
    task = state_problem(load_default(joint), given, None, 9)
    points = propagate.sample_designs(task, 256, 5)[0][:count]
    outcome = propagate.evaluate_samples(task, points, task.loads, "")
    assert np.all(outcome.accepted)
    for i in range(count):
        values, factor, _ = propagate.select_sample(task, points, i)
        exact = task.curves.exact(build_parameter_set(KINDS[joint].parameters, values), factor * task.loads)
        for output, value in exact.items():
            found = outcome.outputs[output][:, i]
            assert found[1:] == pytest.approx(value[1:], rel=REDUCED), (output, values)
            # without load there is no stiffness, damping or displacement
            if output not in JOINTS[joint].unloaded:
                assert found[0] == 0.0


@pytest.mark.parametrize("joint", [name for name, kind in KINDS.items() if "roughness" in kind.laws])
def test_reduced_evaluation_of_the_law_roughness(joint):
    """The same error, over the roughness that people know within a factor of two."""
    given = {"h": "+-30%", "hurst": "0.4..0.9", "longest_wave": "loguniform(2e-4, 5e-3)"}
    task = state_problem(load_default(joint, "roughness"), given, None, 9)
    found = propagate.compute_bands(task, propagate.sample_designs(task, 64, 5)[0])
    assert found.refusals.count == 0
    assert found.reduction_error < REDUCED


@pytest.mark.parametrize("joint", KINDS)
def test_one_sample_does_not_see_its_neighbours(joint):
    """Blocks share places of interpolation: the order of the error, not more."""
    task = state_problem(load_default(joint), {JOINTS[joint].varied: "+-2%"}, None, 7)
    points = propagate.sample_designs(task, 64, 0)[0]
    together = propagate.evaluate_samples(task, points, task.loads, "")
    alone = propagate.evaluate_samples(task, points[40:41], task.loads, "")
    for output, value in together.outputs.items():
        assert value[:, 40] == pytest.approx(alone.outputs[output][:, 0], rel=1e-5)


def test_pattern_of_the_bolts_may_be_uncertain():
    task = state_problem(load_default("bolted_joint"), {"pattern.decay_length": "+-20%"}, None, 4)
    found = propagate.compute_bands(task, propagate.sample_designs(task, 4, 0)[0])
    assert found.reduction_error < REDUCED
    assert found.refusals.count == 0


def test_slip_force_has_the_band_of_friction():
    task = state_problem(load_default("bolted_joint"), {"mu": "0.1..0.3"}, None, 4)
    found = propagate.compute_bands(task, propagate.sample_designs(task, 1024, 0)[0])
    slip, mu = found.quantiles["slip_force"][:, -1], 0.1 + 0.2 * np.array(propagate.QUANTILES)
    assert slip == pytest.approx(mu / task.values["mu"] * found.nominal["slip_force"][-1], rel=2e-3)
    assert np.ptp(found.quantiles["K_zz"][:, -1]) == 0.0
    # loss goes about as 1/mu under an equal shear, faster as more slips
    lost = found.quantiles["loss_factor"][::-1, -1] * mu
    assert np.all(np.diff(lost) < 0.0)
    assert lost[0] / lost[-1] < 1.5


def test_nominal_is_the_parameter_file():
    task = state_problem(load_default("gear_contact"), {"A_0": "+-1%", "surface1.G": 3e-10}, None, 4)
    changed = load_default("gear_contact").with_values({"surface1.G": 3e-10}, "user", "")
    found = propagate.compute_bands(task, propagate.sample_designs(task, 4, 0)[0])
    exact = reduced_curves(KINDS["gear_contact"]).exact(changed.values, task.loads)
    assert found.nominal["K_N"] == pytest.approx(exact["K_N"], rel=REDUCED)


def test_refused_samples_are_counted_with_the_reason():
    """Eccentricity of normal(5e-6, 5e-6): 15.87 % lie below zero."""
    task = state_problem(load_default("harmonic_drive"), {"eccentricity": "normal(5e-6, 5e-6)"}, None, 3)
    found = propagate.compute_bands(task, propagate.sample_designs(task, 1024, 0)[0])
    assert found.refusals.count == pytest.approx(0.158655 * 1024, abs=1.5)  # a balanced sequence
    assert "is outside [0, 0.001): installation eccentricity" in found.refusals.reason
    assert found.refusals.example["eccentricity"] < 0.0
    assert np.all(np.isfinite(found.quantiles["K_WTS"]))


def test_samples_that_only_the_law_refuses():
    """A dimension so close to 1 that the critical spot overflows: found one by one."""
    task = state_problem(load_default("bolted_joint"), {"surface.D": "1.0001..1.3"}, None, 3)
    points = propagate.sample_designs(task, 256, 0)[0]
    outcome = propagate.evaluate_samples(task, points, task.loads, "")
    for i in np.flatnonzero(~outcome.accepted):
        values, _, _ = propagate.select_sample(task, points, int(i))
        with pytest.raises(ValueError, match=r"representable|no stiffness"):
            reduced_curves(KINDS["bolted_joint"]).exact(
                build_parameter_set(KINDS["bolted_joint"].parameters, values), task.loads
            )
    refused = propagate.summarise_refusals(task, points, outcome.accepted)
    assert 0 < refused.count == np.count_nonzero(~outcome.accepted) < 200
    assert "D" in refused.reason


def test_loads_beyond_the_table_are_refused():
    """normal(29, 1) about the end of the table at 30 N.m: 15.87 % lie above."""
    given = {"surface.D": "+-1%", "tau": "normal(29, 1)"}
    task = state_problem(load_default("harmonic_drive"), given, None, 3)
    found = propagate.compute_bands(task, propagate.sample_designs(task, 1024, 0)[0])
    assert found.refusals.count == pytest.approx(0.158655 * 1024, abs=1.5)
    assert "is outside (0, 30]: up to the end of the tabulated law" in found.refusals.reason


def test_all_refused():
    given = {"eccentricity": "0.9e-3..0.99e-3"}  # allowed each for itself, but the pair loses contact
    task = state_problem(load_default("harmonic_drive"), given, None, 3)
    with pytest.raises(RuntimeError, match="all 8 samples are rejected; the first: eccentricity = "):
        propagate.compute_bands(task, propagate.sample_designs(task, 8, 0)[0])


def test_a_study_that_misses_the_spring_is_refused(monkeypatch):
    monkeypatch.setattr(propagate, "MAX_REDUCTION_ERROR", 1e-12)
    task = state_problem(load_default("harmonic_drive"), {"surface.D": "+-1%"}, None, 3)
    with pytest.raises(
        RuntimeError, match=r"differs from the " r"evaluation of the " r"joint by .* " r"at surface\.D = "
    ):
        propagate.compute_bands(task, propagate.sample_designs(task, 8, 0)[0])


RUN = ("uncertainty", "harmonic_drive", "--set", "surface.D=2.45..2.6", "surface.G=lognormal(20%)")


def test_command(tmp_path, capsys):
    table, plot = tmp_path / "bands.csv", tmp_path / "bands.png"
    files = ["--csv", str(table), "--plot", str(plot)]
    assert cli.main([*RUN, "--samples", "1000", "--points", "11", "--json", *files]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["samples"] == 1024
    assert found["refused"]["count"] == 0
    assert 0.0 < found["reduction_error"] < REDUCED
    assert found["load"]["values"] == pytest.approx(np.linspace(0.0, 5.0, 11))
    quantiles = np.array(list(found["outputs"]["K_WTS"]["quantiles"].values()))
    assert np.all(np.diff(quantiles, axis=0) > 0.0)
    assert found["indices"]["outputs"]["K_WTS"]["surface.G"]["total"][-1] > 0.5
    rows = list(csv.reader(io.StringIO(table.read_text())))
    assert rows[0][:5] == [
        "tau [N.m]",
        "K_WTS nominal [N.m/rad]",
        "K_WTS mean [N.m/rad]",
        "K_WTS sd [N.m/rad]",
        "K_WTS 1 % [N.m/rad]",
    ]
    assert [float(row[0]) for row in rows[1:]] == found["load"]["values"]
    assert float(rows[-1][4]) == quantiles[0, -1]
    assert plot.read_bytes().startswith(b"\x89PNG")
    assert cli.main([*RUN, "--samples", "1000", "--points", "11", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == found  # seeded
    assert cli.main([*RUN, "--samples", "256", "--points", "3"]) == 0
    text = capsys.readouterr().out
    assert "256 samples, 0 refused by the law" in text
    assert "varied: surface.D = 2.45..2.6, surface.G = lognormal(20%)\n" in text


def test_what_is_zero_is_left_out_and_what_moves_nothing_is_said(tmp_path, capsys):
    plot = tmp_path / "bands.svg"
    few = ["--samples", "64", "--points", "3"]
    given = ["uncertainty", "bolted_joint", "--set", "H=+-5%"]
    assert cli.main([*given, *few, "--plot", str(plot)]) == 0
    text = capsys.readouterr().out
    assert text.count("C_zz") == text.count("zero throughout: C_zz\n") == 1
    assert plot.read_text().count('<g id="axes_') == 6
    assert (
        cli.main(["uncertainty", "gear_contact", "--set", "mu=0.1..0.3", "traction_ratio=0..0.5", *few]) == 0
    )
    text = capsys.readouterr().out
    assert "varied: mu = 0.1..0.3, traction_ratio = 0..0.5: no output depends on it\n" in text
    assert "Sobol" not in text


def test_at_one_load(tmp_path, capsys):
    plot = tmp_path / "spread.svg"
    arguments = ["uncertainty", "gear_contact", "--set", "f=2000", "surface1.D=1.4..1.5", "--plot", str(plot)]
    assert cli.main([*arguments, "--samples", "64", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["load"]["values"] == [2000.0]
    assert found["indices"] is None  # of one parameter there is nothing to tell apart
    assert "<svg" in plot.read_text()


def test_study_file(tmp_path, capsys):
    path = tmp_path / "study.toml"
    path.write_text('schema = 1\n[parameters]\nsurface.D = "2.45..2.6"\neccentricity = 5e-6\n')
    assert cli.main(["uncertainty", "harmonic_drive", "--study", str(path), "--samples", "16", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["parameters"] == {"surface.D": "2.45..2.6"}
    base = reduced_curves(KINDS["harmonic_drive"]).exact(
        load_default("harmonic_drive").values, np.array([5.0])
    )
    assert found["outputs"]["K_WTS"]["nominal"][-1] < base["K_WTS"][0]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--set", "surface.D=2.4..2.6"], "JOINT or --params FILE is missing"),
        (
            ["harmonic_drive"],
            "no parameter has a distribution; expected NAME=LOW..HIGH or a study file",
        ),
        (["harmonic_drive", "--set", "surface.X=1..2"], "unknown name 'surface.X', allowed are ratio, "),
        (["harmonic_drive", "--set", "surface.D=2.4..3.1"], "surface.D = 3.1 is outside (2, 3)"),
        (["harmonic_drive", "--set", "surface.D=normal(3.5, 1)"], "surface.D = 3.5 is outside (2, 3)"),
        (["harmonic_drive", "--set", "traction=1..2"], "traction = 1..2: is a named choice"),
        (["bolted_joint", "--set", "n_bolts=6..8"], "n_bolts = 6..8: is a whole number"),
        (["bolted_joint", "--set", "H=abc"], "H = 'abc' is not a number"),
        (["bolted_joint", "--set", "H=+-5%", "--to", "-3"], "to = -3 N is outside (0, "),
        (["harmonic_drive", "--set", "ratio=+-5%", "--to", "31"], "to = 31 N.m is outside (0, 30]"),
        (["bolted_joint", "--set", "H=+-5%", "preload=-5"], "preload = -5 N is outside (0, "),
        (["bolted_joint", "--set", "H=+-5%", "preload=9e3", "--to", "5"], "is also the ramped input"),
        (["bolted_joint", "--set", "H=+-5%", "--points", "1"], "points = 1 is outside [2, 10000]"),
        (["bolted_joint", "--set", "H=+-5%", "--samples", "1"], "samples = 1 is outside [2, "),
        (["bolted_joint", "--set", "H=+-5%", "--seed", "-1"], "seed = -1 is outside [0, inf)"),
        (["bolted_joint", "--set", "H=+-5%", "--plot", "a.bmp"], "allowed are .png, .svg"),
        (["bolted_joint", "--study", "no.toml"], "no.toml: cannot be read"),
    ],
)
def test_refused_arguments(arguments, words, capsys):
    assert words in refused_line(capsys, "uncertainty", *arguments)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("schema = 2\n", "schema = 2, allowed is 1"),
        ("schema = 1\n", "parameters = None, expected a table"),
        ("schema = 1\nother = 2\n[parameters]\nH = 1\n", "unknown entry 'other'"),
        ("schema = 1\n[parameters]\nH = [1, 2]\n", "H = [1, 2], expected a number or a text"),
        ("schema = ", "is not valid TOML"),
    ],
)
def test_refused_study_files(text, words, tmp_path, capsys):
    path = tmp_path / "study.toml"
    path.write_text(text)
    assert words in refused_line(capsys, "uncertainty", "bolted_joint", "--study", path)


def test_every_parameter_can_be_uncertain():
    """+-1 % of any number that is not counted or zero, in one study per joint."""
    for joint in KINDS:
        values = flatten_parameters(load_default(joint).values)
        declared = dict(flat_fields(KINDS[joint].parameters))
        counted = {name for name, item in declared.items() if item.metadata.get("whole")}
        names = [n for n, v in values.items() if isinstance(v, float) and v and n not in counted]
        names = [n for n in names if not n.startswith("pattern.")]  # one by one, see above
        given = {name: "+-1%" for name in names if name != "traction_ratio"}
        task = state_problem(load_default(joint), given, None, 3)
        outcome = propagate.evaluate_samples(task, propagate.sample_designs(task, 16, 0)[0], task.loads, "")
        assert np.count_nonzero(outcome.accepted) > 0, joint
