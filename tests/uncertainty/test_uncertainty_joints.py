"""Uncertainty of joints: outputs of a sample against the springs, refused samples, and the command."""

import csv
import io
import json
from dataclasses import replace

import numpy as np
import pytest
from conftest import refused_line
from joint_cases import JOINTS
from jointfmu_tools import cli
from jointfmu_tools.joints.bolted_joint.gross_slip import loss_factor
from jointfmu_tools.studies.uncertainty import propagate
from jointfmu_tools.studies.uncertainty.problem import define_joint_study
from jointfmu_tools.studies.uncertainty.runs import StudyExecution
from scipy.integrate import quad

from jointfmu.joints import KINDS
from jointfmu.joints.bolted_joint.joint import BoltedJointSpring
from jointfmu.joints.bolted_joint.law import node_pressure, with_rigid_members
from jointfmu.parameters import load_default
from jointfmu.quantity import build_parameter_set, flatten_fields, flatten_parameters

pytestmark = pytest.mark.slow


def sample_of(task, points, i):
    """Values of sample i by column, and its parameter set and load factor, built with all checks."""
    settings = dict(task.list_run_settings(points)[i])
    columns = task.run_evaluator.evaluate_sample(settings)
    settings.pop(task.ramped_input.name, None)
    file = task.run_evaluator.parameter_file
    joint = build_parameter_set(type(file.values), {**file.values_by_name, **settings})
    return columns, joint


@pytest.mark.parametrize(
    ("joint", "study"), [(kind, study) for kind, joint in JOINTS.items() for study in joint.studies]
)
def test_outputs_are_those_of_the_python_law(joint, study):
    given, count = JOINTS[joint].studies[study]
    task = define_joint_study(load_default(joint), given, None, 9)
    points = propagate.draw_independent_point_sets(task, 256, 5)[0]
    curves = task.run_evaluator.load_curves
    model = KINDS[joint].find_model(curves.fmu_name)
    for i in range(min(count, 8)):
        columns, parameters = sample_of(task, points, i)
        spring = model.tabulate(replace(parameters, **curves.fixed_parameters))
        stated = {v.name: 0.0 for v in model.inputs} | dict(curves.fixed_inputs(parameters))
        for row, load in enumerate(columns[task.ramped_input.name]):
            exact = model.evaluate(spring, stated | {task.ramped_input.name: float(load)})
            for variable in curves.outputs:
                scale = np.abs(columns[variable.name]).max()
                found = columns[variable.name][row]
                assert found == pytest.approx(exact[variable.name], rel=1e-8, abs=1e-10 * scale)
                # without load there is no stiffness, damping or displacement
                if load == 0.0 and variable.name not in JOINTS[joint].unloaded:
                    assert found == 0.0


@pytest.mark.parametrize("law", ["zhao2018", "roughness"])
def test_approach_and_loss_factor_of_the_bolted_joint(law):
    """The results agree with quadrature of the compliance of patches and nodes, and with the loop of the
    whole interface."""
    task = define_joint_study(load_default("bolted_joint", law), {"mu": "0.1..0.2", "H": "+-5%"}, None, 5)
    columns, joint = sample_of(task, propagate.draw_independent_point_sets(task, 4, 5)[0], 0)
    joint = replace(with_rigid_members(joint), embedding=0.0)
    spring = BoltedJointSpring.from_joint(joint)
    points = spring.points

    def rate(log):
        pressure = node_pressure(
            joint, points.preload_pressure_ratio, points.moment_pressure_ratio, np.exp(log), 0.0
        )
        K = spring.curve.derivatives(spring.curve.inverse(pressure), 1)[1] @ points.area_share
        return joint.n_bolts * np.exp(log) / (joint.A_0 * K)

    loads = columns["preload"][1:]
    for i, load in enumerate(loads, 1):
        integral = quad(rate, np.log(load) - 50.0, np.log(load), epsrel=1e-7, limit=400)[0]
        assert columns["approach"][i] == pytest.approx(integral, rel=1e-4)
        shear = 0.05 * joint.n_bolts * load
        assert columns["loss_factor"][i] == pytest.approx(loss_factor(spring, load, shear), rel=2e-3)
        assert columns["slip_force"][i] == pytest.approx(joint.mu * joint.n_bolts * load)
    assert columns["approach"][0] == columns["loss_factor"][0] == 0.0


def test_interpolated_outputs_of_a_long_ramp_are_those_of_the_fmu():
    given = {"surface.D": "1.38..1.46", "preload": "normal(12%)"}
    long, short = (define_joint_study(load_default("bolted_joint"), given, None, n) for n in (201, 5))
    points = propagate.draw_independent_point_sets(short, 4, 5)[0]
    fine, exact = (sample_of(task, points, 1)[0] for task in (long, short))
    for name, values in exact.items():
        assert fine[name][::50] == pytest.approx(values, rel=1e-5), name


def test_pattern_of_the_bolts_may_be_uncertain():
    """The FMU does not expose the pattern: the joint is opened again for each sample."""
    task = define_joint_study(load_default("bolted_joint"), {"pattern.decay_length": "+-20%"}, None, 4)
    points = propagate.draw_independent_point_sets(task, 2, 0)[0]
    found = propagate.compute_bands(task, points)
    assert found.refused_samples.refused_count == 0
    columns, joint = sample_of(task, points, 1)
    exact = BoltedJointSpring.from_joint(joint).evaluate(30e3, 0.0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    assert columns["K_zz"][-1] == pytest.approx(exact["K_zz"], rel=1e-8)


def test_slip_force_has_the_band_of_friction():
    task = define_joint_study(load_default("bolted_joint"), {"mu": "0.1..0.3"}, None, 2)
    points = propagate.draw_independent_point_sets(task, 1024, 0)[0]
    found = propagate.compute_bands(task, points, StudyExecution(process_count=1))
    slip, mu = found.quantiles["slip_force"][:, -1], 0.1 + 0.2 * np.array(propagate.QUANTILES)
    assert slip == pytest.approx(
        mu / task.run_evaluator.parameter_file.values.mu * found.nominal_outputs["slip_force"][-1], rel=2e-3
    )
    assert np.ptp(found.quantiles["K_zz"][:, -1]) == 0.0
    # loss goes about as 1/mu under an equal shear, faster as more slips
    lost = found.quantiles["loss_factor"][::-1, -1] * mu
    assert np.all(np.diff(lost) < 0.0)
    assert lost[0] / lost[-1] < 1.5


def test_nominal_is_the_parameter_file():
    task = define_joint_study(load_default("gear_contact"), {"A_0": "+-1%", "surface1.G": 3e-10}, None, 4)
    changed = load_default("gear_contact").with_values({"surface1.G": 3e-10}, "user", "")
    found = propagate.compute_bands(task, propagate.draw_independent_point_sets(task, 4, 0)[0])
    spring = KINDS["gear_contact"].models[0].tabulate(changed.values)
    assert found.nominal_outputs["K_N"][1:] == pytest.approx(spring.evaluate(task.loads[1:])["K_N"], rel=1e-9)


def test_refused_samples_are_counted_with_the_reason():
    """Eccentricity normal(5e-6, 5e-6): 15.87 % are negative."""
    task = define_joint_study(load_default("harmonic_drive"), {"eccentricity": "normal(5e-6, 5e-6)"}, None, 3)
    found = propagate.compute_bands(task, propagate.draw_independent_point_sets(task, 256, 0)[0])
    assert found.refused_samples.refused_count == pytest.approx(
        0.158655 * 256, abs=1.5
    )  # a balanced sequence
    assert "is outside [0, 0.001): installation eccentricity" in found.refused_samples.refusal_message
    assert found.refused_samples.first_refused_sample["eccentricity"] < 0.0
    assert np.all(np.isfinite(found.quantiles["K_WTS"]))


def test_samples_that_only_the_law_refuses():
    """The law alone refuses samples whose dimension is so close to 1 that the critical spot area
    overflows."""
    task = define_joint_study(load_default("bolted_joint"), {"surface.D": "1.0001..1.3"}, None, 3)
    points = propagate.draw_independent_point_sets(task, 256, 0)[0]
    found = propagate.compute_bands(task, points)
    runs, law = task.list_run_settings(points), KINDS["bolted_joint"]
    for i in list(found.sampled_outputs.error_messages)[:3]:
        values = {**task.run_evaluator.parameter_file.values_by_name, **runs[i]}
        with pytest.raises(ValueError, match=r"representable|no stiffness"):
            law.models[0].tabulate(build_parameter_set(law.default_parameter_class, values))
    assert 0 < found.refused_samples.refused_count < 200
    assert "D" in found.refused_samples.refusal_message


def test_loads_beyond_the_table_are_refused():
    """normal(29, 1) near the end of the table at 30 N.m: 15.87 % are above."""
    given = {"surface.D": "+-1%", "tau": "normal(29, 1)"}
    task = define_joint_study(load_default("harmonic_drive"), given, None, 3)
    found = propagate.compute_bands(task, propagate.draw_independent_point_sets(task, 256, 0)[0])
    assert found.refused_samples.refused_count == pytest.approx(0.158655 * 256, abs=1.5)
    assert "is outside (0, 30]: up to the end of the tabulated law" in found.refused_samples.refusal_message


def test_all_refused():
    given = {"eccentricity": "0.9e-3..0.99e-3"}  # allowed each for itself, but the pair loses contact
    task = define_joint_study(load_default("harmonic_drive"), given, None, 3)
    with pytest.raises(
        RuntimeError,
        match="all 8 samples are rejected, state narrower distributions; the first: eccentricity = ",
    ):
        propagate.compute_bands(task, propagate.draw_independent_point_sets(task, 8, 0)[0])


RUN = ("uncertainty", "harmonic_drive", "--set", "surface.D=2.45..2.6", "surface.G=lognormal(20%)")


def test_command(tmp_path, capsys):
    table, plot = tmp_path / "bands.csv", tmp_path / "bands.png"
    files = ["--csv", str(table), "--plot", str(plot)]
    assert cli.main([*RUN, "--samples", "100", "--points", "11", "--json", *files]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["samples"] == 128
    assert found["refused"]["count"] == 0
    assert "reduction_error" not in found
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
    assert cli.main([*RUN, "--samples", "100", "--points", "11", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == found  # seeded
    assert cli.main([*RUN, "--samples", "16", "--points", "3"]) == 0
    text = capsys.readouterr().out
    assert "16 samples, 0 refused by the law" in text
    assert "varied: surface.D = 2.45..2.6, surface.G = lognormal(20%)\n" in text


def test_zero_outputs_are_left_out_and_parameters_without_effect_are_named(tmp_path, capsys):
    plot = tmp_path / "bands.svg"
    few = ["--samples", "16", "--points", "3"]
    given = ["uncertainty", "bolted_joint", "--set", "H=+-5%"]
    assert cli.main([*given, *few, "--plot", str(plot)]) == 0
    text = capsys.readouterr().out
    assert text.count("C_zz") == text.count("zero at all loads: C_zz\n") == 1
    assert "slip_force [N]\n     preload [N]  parameter file  no band" in text  # mu sets it, not H
    assert text.count("no band") == 2  # and the opening load
    assert plot.read_text().count('<g id="axes_') == 9  # of 11 outputs, without those two
    assert (
        cli.main(["uncertainty", "gear_contact", "--set", "mu=0.1..0.3", "traction_ratio=0..0.5", *few]) == 0
    )
    text = capsys.readouterr().out
    assert "varied: mu = 0.1..0.3, traction_ratio = 0..0.5: no output depends on it\n" in text
    assert "Sobol" not in text


def test_bands_of_a_truncated_distribution_are_warned_of(capsys):
    """A normal distribution of a positive parameter with a large spread has samples that the law refuses."""
    few = ["--samples", "64", "--points", "2", "--json"]
    warned = []
    for spread in ("80%", "5%"):
        assert cli.main(["uncertainty", "gear_contact", "--set", f"sigma_y=normal({spread})", *few]) == 0
        found = json.loads(capsys.readouterr().out)
        warned.append(any("truncated distributions" in text for text in found["warnings"]))
        assert warned[-1] == (found["refused"]["count"] > 0)
    assert warned == [True, False]


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
    few = ["--samples", "16", "--json"]
    assert cli.main(["uncertainty", "harmonic_drive", "--study", str(path), *few]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["parameters"] == {"surface.D": "2.45..2.6"}
    assert cli.main(["uncertainty", "harmonic_drive", "--set", "surface.D=2.45..2.6", *few]) == 0
    base = json.loads(capsys.readouterr().out)
    assert found["outputs"]["K_WTS"]["nominal"][-1] < base["outputs"]["K_WTS"]["nominal"][-1]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--set", "surface.D=2.4..2.6"], "JOINT or --params FILE is missing"),
        (["harmonic_drive"], "no parameter has a distribution; expected NAME=LOW..HIGH or a study file"),
        (["harmonic_drive", "--set", "qqq=1..2"], "unknown name 'qqq', allowed are ratio, "),
        (["bolted_joint", "--set", "Mu=0.1..0.2"], "unknown name 'Mu'; did you mean mu"),
        (["bolted_joint", "--set", "Rq1=1e-6..2e-6"], "the law of the file does not use the roughness"),
        (["bolted_joint", "--set", "mu=+-20"], "write +-20%"),
        (["bolted_joint", "--set", "mu=normal(20)"], "as in 20%"),
        (["bolted_joint", "--set", "surface.G=lognormal(12nm, 1.2)"], "not a number: write 1.2e-08"),
        (["bolted_joint", "--set", "mu=interval"], "states no interval of mu; state mu=LOW..HIGH"),
        (["harmonic_drive", "--set", "surface.D=2.4..3.1"], "surface.D = 3.1 is outside (2, 3)"),
        (["harmonic_drive", "--set", "surface.D=normal(3.5, 1)"], "surface.D = 3.5 is outside (2, 3)"),
        (["harmonic_drive", "--set", "traction=1..2"], "traction = 1..2: is a named choice"),
        (["bolted_joint", "--set", "n_bolts=6..8"], "n_bolts = 6..8: is a whole number"),
        (["bolted_joint", "--set", "H=abc"], "H = 'abc' is not a number"),
        (["bolted_joint", "--set", "H=+-5%", "--to", "-3"], "to = -3 N is outside (0, "),
        (["harmonic_drive", "--set", "ratio=+-5%", "--to", "31"], "to = 31 N.m is outside (0, 30]"),
        (["bolted_joint", "--set", "H=+-5%", "preload=-5"], "preload = -5 N is outside (0, "),
        (["bolted_joint", "--set", "H=+-5%", "preload=9e3", "--to", "5"], "is set, so there is no ramp"),
        (["bolted_joint", "--set", "H=+-5%", "--points", "1"], "points = 1 is outside [2, 10000]"),
        (["bolted_joint", "--set", "H=+-5%", "--samples", "1"], "samples = 1 is outside [2, "),
        (["bolted_joint", "--set", "H=+-5%", "--seed", "-1"], "seed = -1 is outside [0, inf)"),
        (["bolted_joint", "--set", "H=+-5%", "--plot", "a.bmp"], "allowed are .png, .svg"),
        (["bolted_joint", "--study", "no.toml"], "no.toml: cannot be read"),
        (["boltedjoint", "--set", "H=+-5%"], "unknown joint 'boltedjoint', allowed are harmonic_drive, "),
        (
            ["bolted_joint", "--set", "H=+-5%", "--step", "5"],
            "--step does not apply to a joint; leave it out",
        ),
        (["a.fmu", "--set", "H=+-5%", "--points", "5"], "--points does not apply to an FMU; leave it out"),
        (["a.fmu", "--set", "H=+-5%", "--input", "f"], "--to is missing, needed for an FMU"),
        (["bolted_joint", "--set", "H=+-5%", "--workers", "0"], "workers = 0 is outside [1, inf)"),
    ],
)
def test_refused_arguments(arguments, words, capsys):
    assert words in refused_line(capsys, "uncertainty", *arguments)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("schema = 2\n", "schema = 2, expected the line schema = 1"),
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
    """+-1 % of every number that is neither a count nor zero, in one study per joint."""
    for joint in KINDS:
        values = flatten_parameters(load_default(joint).values)
        declared = dict(flatten_fields(KINDS[joint].default_parameter_class))
        counted = {name for name, item in declared.items() if item.metadata.get("whole")}
        names = [n for n, v in values.items() if isinstance(v, float) and v and n not in counted]
        names = [n for n in names if not n.startswith("pattern.")]  # one by one, see above
        given = {name: "+-1%" for name in names if name != "traction_ratio"}
        task = define_joint_study(load_default(joint), given, None, 3)
        found = propagate.compute_bands(task, propagate.draw_independent_point_sets(task, 4, 0)[0])
        assert np.any(found.sampled_outputs.accepted_mask), joint
