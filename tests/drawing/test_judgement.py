"""Judgement printed with every stiffness: ratio to the estimate from roughness, range of the law."""

import json

import numpy as np
import pytest
from conftest import refused_line
from jointfmu_tools import cli
from jointfmu_tools.common.judgement import MAX_STIFFNESS_OVER_ESTIMATE, assess_law_stiffness, find_rms_height
from jointfmu_tools.common.pressure import find_nominal_pressure_model, judge_joint_stiffness
from jointfmu_tools.fem.convergence import check_bolt_symmetry
from jointfmu_tools.inputs.drawing.tables import read_threads
from jointfmu_tools.inputs.drawing.vdi2230 import describe_stated_bolt, proof_load, stress_area
from jointfmu_tools.inputs.fields.nodal_result import ContactPressureField
from jointfmu_tools.joints.bolted_joint.gross_slip import loss_factor

from jointfmu.contact.interface import evaluate_at_pressure, find_validity_violations
from jointfmu.contact.roughness import PERSSON_GAMMA, predicted_stiffness
from jointfmu.joints import KINDS
from jointfmu.joints.bolted_joint.joint import BoltedJointSpring
from jointfmu.parameters import format_parameter_file, load_default, load_parameter_file

BOLTED = load_default("bolted_joint")
REST = (0.0, 0.0, 0.0)


def rough(joint, h):
    return load_default(joint).with_roughness({"h": h}, "user", "test")


# The level


def test_the_ratio_is_that_of_the_joint():
    """The printed ratio is K_zz of the joint (uneven pressure) over F/(0.45 h).

    It is within 10 % of the ratio of the law at the mean pressure.
    """
    found = judge_joint_stiffness(BOLTED, [9e3, 15e3])
    for ratio, preload in zip(found.stiffness_comparison.stiffness_over_estimate, (9e3, 15e3), strict=True):
        K = BoltedJointSpring.from_joint(BOLTED.values).evaluate(preload, 0.0, REST, REST)["K_zz"]
        assert ratio == pytest.approx(K * PERSSON_GAMMA * find_rms_height(BOLTED) / (8 * preload), rel=0.1)
    assert found.warnings == ()


def test_the_law_roughness_is_judged_by_its_own_height():
    """With many spots on 0.04 m2 the ratio is that of the estimate, plus a small part for the few spots."""
    found = judge_joint_stiffness(load_default("bolted_joint", "roughness"), [9e3])
    assert found.stiffness_comparison.stiffness_over_estimate == pytest.approx([1.0], abs=0.05)


def test_a_height_that_is_no_roughness():
    file = load_default("bolted_joint", "roughness").with_values({"h": 8e-3}, "user", "test")
    assert judge_joint_stiffness(file, [9e3]).warnings[0].startswith("h = 0.008 m is too large for a ")


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_factor_of_three_either_way(side):
    p = 1e6
    k = evaluate_at_pressure(BOLTED.values, p)["K_N"] / BOLTED.values.A_0
    for factor, doubtful in (
        (0.99 * MAX_STIFFNESS_OVER_ESTIMATE, False),
        (1.01 * MAX_STIFFNESS_OVER_ESTIMATE, True),
    ):
        h = factor**side * p / (PERSSON_GAMMA * k)
        found = assess_law_stiffness(BOLTED.values, [p], h)
        assert found.stiffness_comparison.stiffness_over_estimate == pytest.approx([factor**side], rel=1e-9)
        assert bool(found.warnings) == found.stiffness_comparison.is_doubtful == doubtful
    assert f"{found.stiffness_comparison.stiffness_over_estimate[0]:.3g} times" in found.warnings[0]
    assert "measure the joint" in found.warnings[0]


def test_what_is_not_known_is_not_judged():
    for joint in KINDS:
        file = load_default(joint)
        found = judge_joint_stiffness(file)
        assert (found.stiffness_comparison is None) == (find_rms_height(file) is None)
        assert judge_joint_stiffness(file).to_json()["warnings"] == []
    assert assess_law_stiffness(BOLTED.values, [0.0], 1e-6).stiffness_comparison is None


@pytest.mark.parametrize("joint", [name for name in KINDS if find_nominal_pressure_model(KINDS[name])])
def test_every_joint_is_judged_under_its_load(joint):
    file = rough(joint, 2e-6)
    how, found = find_nominal_pressure_model(KINDS[joint]), judge_joint_stiffness(file)
    assert how.load_variable in KINDS[joint].variables
    pressure = how.mean_pressure(file.values, how.default_load(file.values))
    assert found.stiffness_comparison.nominal_pressure == pytest.approx([pressure])
    law = KINDS[joint].extract_law(file.values)
    expected = (
        evaluate_at_pressure(law, pressure)["K_N"]
        / law.A_0
        * how.joint_to_law_stiffness_ratio(file.values, how.default_load(file.values))
    )
    assert found.stiffness_comparison.normal_stiffness == pytest.approx([float(expected)], rel=1e-9)
    assert found.stiffness_comparison.stiffness_over_estimate == pytest.approx(
        [float(expected) / predicted_stiffness(pressure, 2e-6)], rel=1e-9
    )


def test_the_start_value_of_the_load_is_a_working_point(tmp_path):
    text = format_parameter_file(BOLTED).replace("preload = { value = 0.0", "preload = { value = 12e3")
    (tmp_path / "tight.toml").write_text(text)
    found = judge_joint_stiffness(load_parameter_file(tmp_path / "tight.toml"))
    assert found.stiffness_comparison.nominal_pressure == pytest.approx([8 * 12e3 / BOLTED.values.A_0])


# Where the law ends


def test_beyond_the_hardness_and_the_nominal_area():
    law, H = BOLTED.values, BOLTED.values.H
    assert find_validity_violations(law, 1e8) == []
    (area,) = find_validity_violations(law, 1e9)
    hard, same = find_validity_violations(law, 1.01 * H)
    assert f"{H:.4g} Pa" in hard
    limit = float(area.split("above ")[-1].split()[0])
    assert limit == float(same.split("above ")[-1].split()[0])
    assert evaluate_at_pressure(law, limit)["A_r"] == pytest.approx(
        law.A_0, rel=0.01
    )  # three digits are printed


def test_the_law_roughness_is_proven_in_a_range():
    """The command warns outside the validated range: x = p A_0/(E* h longest_wave) >= 0.3, y = p
    longest_wave/(E* h) <= 1.5 (validity_stiffness.md)."""
    law = load_default("gear_mesh", "roughness").values
    modulus = 0.5 * 206e9 / (1.0 - 0.26**2) * law.h
    few, flat = 0.3 * modulus * law.longest_wave / law.A_0, 1.5 * modulus / law.longest_wave
    assert find_validity_violations(law, 1.01 * few) == []
    (line,) = find_validity_violations(law, 0.99 * few)
    assert f"below {few:.3g} Pa, the lower end of the checked range" in line
    (line,) = [text for text in find_validity_violations(law, 1.01 * flat) if "wave" in text]
    assert f"above {flat:.3g} Pa, the upper end of the checked range" in line
    assert not any("wave" in text for text in find_validity_violations(law, 0.99 * flat))
    (line,) = assess_law_stiffness(law, [0.5 * few, 2.0 * few], law.h).warnings
    assert f"{0.5 * few:.4g} Pa is below" in line


@pytest.mark.parametrize(
    ("d", "area", "proof"), [(12, 84.3, 81_800), (16, 157, 152_000), (20, 245, 238_000), (30, 561, 544_000)]
)
def test_bolts_of_iso_898_1(d, area, proof):
    """Stress areas and proof loads of class 12.9 as in the standard's tables, three digits."""
    assert 1e6 * stress_area(read_threads()[f"M{d}"]) == pytest.approx(area, rel=4e-3)
    load, name = proof_load(1e-3 * (d + 1.5))
    assert load == pytest.approx(proof, rel=4e-3)
    assert f"M{d}, class 12.9" in name


def test_a_stated_bolt_has_its_own_proof_load():
    """The proof load is 580 MPa (ISO 898-1, class 8.8) times 84.3 mm2, or 92.1 mm2 for the fine thread."""
    for name, expected in (("M12", 48.9e3), ("M12x1.25", 53.4e3)):
        source = f"stated on the drawing; {describe_stated_bolt(name, '8.8')}"
        load, title = proof_load(18e-3, source)
        assert load == pytest.approx(expected, rel=2e-3)
        assert title == f"the proof load of {name}-8.8 (ISO 898-1)"


def test_holes_of_no_bolt():
    assert proof_load(1e-3) is None
    assert proof_load(0.5) is None
    assert proof_load(16e-3)[1].startswith("the proof load of M14")


def test_a_preload_that_no_bolt_bears():
    assert judge_joint_stiffness(BOLTED, [150e3]).warnings[0].startswith("stiffness by the law")
    first, *_ = judge_joint_stiffness(BOLTED, [155e3]).warnings
    assert first.startswith("preload = 155000 N is above 1.52e+05 N, the proof load of M16, class 12.9")


# The commands


@pytest.fixture
def fine(tmp_path):
    """Path of the box specimen's parameter file, with a surface eight times finer."""
    path = tmp_path / "fine.toml"
    path.write_text(
        format_parameter_file(BOLTED.with_roughness({"Ra1": 0.2e-6, "Ra2": 0.2e-6}, "user", "test"))
    )
    return path


COMMANDS = {
    "law": ["law", "zhao2018", "--pressure", "1e6"],
    "export": ["export", "csv", "springs", "--preload", "9e3", "--out", "{out}.csv"],
    "export without a load": ["export", "csv", "contact", "--out", "{out}.csv"],
}


@pytest.mark.parametrize("command", COMMANDS)
def test_a_command_prints_the_ratio_and_warns(command, fine, tmp_path, capsys):
    words = [word.format(out=tmp_path / "out") for word in COMMANDS[command]]
    assert cli.main([*words, "--params", str(fine)]) == 0
    out, err = capsys.readouterr()
    assert "times the roughness estimate p/(0.45 h) at" in out
    assert err.startswith("warning: stiffness by the law: 0.0")
    assert err.count("\n") == 1
    assert cli.main([*words, "--params", str(fine), "--json"]) == 0
    out, err = capsys.readouterr()
    found = json.loads(out)
    assert err == ""
    assert found["level"]["h"] == pytest.approx(0.3545e-6, rel=1e-3)
    assert all(0.03 < point["ratio"] < 0.1 for point in found["level"]["points"])
    assert [text for text in found["warnings"] if "measure the joint" in text]


@pytest.mark.slow
def test_bands_are_judged_along_their_ramp(fine, capsys):
    words = ["uncertainty", "--set", "H=+-10%", "--samples", "16", "--points", "3", "--to", "2e4", "--json"]
    assert cli.main([*words, "--params", str(fine)]) == 0
    found = json.loads(capsys.readouterr().out)
    pressures = [8 * load / BOLTED.values.A_0 for load in (1e4, 2e4)]
    assert [point["pressure"] for point in found["level"]["points"]] == pytest.approx(pressures)
    assert len(found["warnings"]) == 1


def test_the_specimen_states_its_level_without_a_warning(capsys):
    assert cli.main(["law", "zhao2018", "--pressure", "1e6"]) == 0
    out, err = capsys.readouterr()
    assert (
        out.splitlines()[-1] == "stiffness by the law: 0.448 times the roughness estimate p/(0.45 "
        "h) at 1 MPa, h = 2.84 um"
    )
    assert err == ""


def test_the_law_says_that_friction_loops_lose_more_than_eta_t(capsys):
    """eta_t of zhao2018 is that of spheres; loops of the joint follow from the curve of the interface.

    At mu = 0.5, a shear of 5 % of the force of the bolts is a traction ratio of 0.1.
    """
    assert cli.main(["law", "zhao2018", "--pressure", "1e6", "--set", "traction_ratio=0.1"]) == 0
    (note,) = [line for line in capsys.readouterr().out.splitlines() if line.startswith("eta_t: ")]
    assert cli.main(["law", "zhao2018", "--pressure", "1e6", "--set", "traction_ratio=0.1", "--json"]) == 0
    eta_t = json.loads(capsys.readouterr().out)["rows"][0]["eta_t"]
    joint = BoltedJointSpring.from_joint(BOLTED.with_values({"mu": 0.5}, "user", "test").values)
    loop = loss_factor(joint, 9e3, 0.05 * 8 * 9e3)
    assert f"about {loop / eta_t:.1f} times eta_t" in note


@pytest.mark.parametrize(("reading", "is_load"), [("corrected", True), ("printed", False)])
def test_a_law_warns_if_its_columns_are_of_different_contacts(capsys, reading, is_load):
    """As printed, K_N and A_r of Hu 2023 are of one set of spots under the load p A_r, but F is p A_0."""
    words = ["law", "hu2023", "--pressure", "96e6", "--set", f"reading={reading}", "--json"]
    assert cli.main(words) == 0
    found = json.loads(capsys.readouterr().out)
    row = found["rows"][0]
    assert row["F"] == pytest.approx(96e6 * found["parameters"]["A_0"])
    warned = [text for text in found["warnings"] if "reading = printed" in text]
    assert (len(warned) == 0) == is_load


@pytest.mark.parametrize("name", ["Ra1", "Rq2", "surface.D"])
def test_an_unknown_name_lists_every_name_that_the_law_accepts(capsys, name):
    assert name in refused_line(capsys, "law", "roughness", "--pressure", "1e6", "--set", "Rauheit=1e-6")


def test_another_surface_has_not_the_roughness_of_the_default(capsys):
    assert cli.main(["law", "zhao2018", "--pressure", "1e6", "--set", "surface.D=1.5", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["level"] is None


def test_a_real_area_beyond_the_nominal_one(capsys):
    assert cli.main(["law", "zhao2018", "--pressure", "5e9", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["rows"][0]["A_r"] > found["parameters"]["A_0"]
    hardness, area, _ = found["warnings"]
    assert "above the hardness of the softer body, 1.96e+09 Pa" in hardness
    assert "a real contact area above the nominal area, 0.0382 m2: above " in area


def test_pressures_of_the_users_nodes(tmp_path, capsys):
    """Springs at stated pressures are judged at their mean, weighted by the areas."""
    x, y = (g.ravel() for g in np.meshgrid(np.linspace(-50, 50, 5), np.linspace(-80, 80, 5)))
    area = BOLTED.values.A_0 * 1e6 / x.size
    rows = [
        f"{i + 1},{i + 101},{a},{b},{area},{2 + b / 100}" for i, (a, b) in enumerate(zip(x, y, strict=True))
    ]
    mesh = tmp_path / "mesh.csv"
    mesh.write_text(
        "\n".join(["node_1 [1],node_2 [1],x [mm],y [mm],area [mm2],pressure [MPa]", *rows]) + "\n"
    )
    words = ["export", "csv", "springs", "--nodes", str(mesh), "--out", str(tmp_path / "s.csv"), "--json"]
    assert cli.main(words) == 0
    (point,) = json.loads(capsys.readouterr().out)["level"]["points"]
    assert point["pressure"] == pytest.approx(2e6)


# The mesh


def test_alike_bolts_with_unlike_pressures():
    """For a frame of eight bolts, the warning names the hole with the higher pressure. Under a moment, mirror
    images in y may differ without a warning."""
    bolts = np.array([(x, y) for y in (-0.15, 0.0, 0.15) for x in (-0.1, 0.0, 0.1) if x or y])
    rng = np.random.default_rng(3)
    around = rng.uniform(-0.01, 0.01, (200, 2))
    position = (bolts[:, None] + around[None]).reshape(-1, 2)
    pressure = np.tile(1e6 * np.exp(-np.hypot(*around.T) / 0.01), len(bolts))
    field = ContactPressureField(np.full(len(position), 1e-6), position, pressure)
    assert check_bolt_symmetry(field, bolts, False) == []
    hot = np.repeat(np.arange(len(bolts)) >= 5, 200)  # the row y > 0: what a moment does
    tilted = ContactPressureField(field.nodal_area, position, np.where(hot, 2.0, 1.0) * pressure)
    assert check_bolt_symmetry(tilted, bolts, True) == []
    (warning,) = check_bolt_symmetry(tilted, bolts, False)
    assert "2 times" in warning
    one = ContactPressureField(
        field.nodal_area, position, np.where(np.repeat(np.arange(8) == 7, 200), 1.3, 1.0) * pressure
    )
    for moment in (False, True):
        (warning,) = check_bolt_symmetry(one, bolts, moment)
        assert "the bolt at (0.1, 0.15) m is 1.3 times" in warning
    assert check_bolt_symmetry(one, bolts + 0.01 * np.arange(8)[:, None] ** 2, False) == []  # no symmetry
