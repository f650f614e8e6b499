"""Load cycles of FMUs: path of the input, conjugate output, dissipated energy."""

import json

import numpy as np
import pytest
from conftest import refused_line
from jointfmu_tools import cli
from jointfmu_tools.joints.bolted_joint.fit import loop as shear
from jointfmu_tools.joints.harmonic_drive.fit import hysteresis
from jointfmu_tools.run.ramps import loops, ramp

from jointfmu.parameters import load_default

HYSTERESIS = {"hysteresis_loss": 3.5e-4, "hysteresis_stiffness": 6000.0}
SET = [f"{name}={value}" for name, value in HYSTERESIS.items()]
AMPLITUDES = (1e-4, 1e-3)
FINE = loops.CyclicInputPath(waveform="sine", points_per_cycle=400)


@pytest.fixture(scope="module")
def drive(native):
    """Load cycles of a drive with hysteresis."""
    fmu = native / "fmi2" / "HarmonicDriveSpring.fmu"
    return loops.run_loops(fmu, "phi2", AMPLITUDES, FINE, start_values=HYSTERESIS)


@pytest.mark.parametrize("shape", loops.WAVEFORMS)
def test_first_loading_then_whole_cycles(shape):
    points = loops.CyclicInputPath(
        centre_value=1.0, waveform=shape, points_per_cycle=8, cycle_count=2
    ).compute_input_values(3.0)
    near = 1.5 if shape == "triangle" else 3.0 * np.sqrt(0.5)
    cycle = [0.0, near, 3.0, near, 0.0, -near, -3.0, -near]
    np.testing.assert_allclose(points, 1.0 + np.array([*cycle, *cycle, *cycle[:3]]), atol=1e-12)


@pytest.mark.parametrize("amplitude", range(2))
def test_hysteresis_appears(drive, amplitude):
    """Area by Masing's rule from the law, not from the FMU. Errors: trapezoidal rule with 400 points, and the
    sliders."""
    row = drive.compute_quantities_of_loops()[amplitude]
    law = hysteresis.make_hysteresis_law(
        load_default("harmonic_drive").with_values(HYSTERESIS, "user", "test").values
    )
    u = np.array([AMPLITUDES[amplitude]])
    assert row["loss"] == pytest.approx(float(law.loop_area(u)[0]), rel=1e-3)
    assert row["loss"] == pytest.approx(row["E_loss"], rel=1e-3)
    force = law.friction_force(u) + law.elastic_spring.elastic_force(u)
    assert row["secant_stiffness"] == pytest.approx(float(force[0] / u[0]), rel=1e-9)
    assert row["loss_factor"] == pytest.approx(row["loss"] / (np.pi * force[0] * u[0]), rel=1e-12)


def test_force_acts_on_the_joint(drive):
    """The printed force acts on the joint: it has the sign of the motion, opposite to tau2 on the flange."""
    assert (
        drive.displacement_name,
        drive.force_name,
        drive.force_sign,
        drive.displacement_and_force_units,
    ) == (
        "phi2",
        "tau2",
        -1.0,
        ("rad", "N.m"),
    )
    loop = drive.loops[1]
    np.testing.assert_array_equal(loop.forces, -loop.path_result.variable_columns["tau2"])
    assert loop.forces[100] == loop.forces.max() == pytest.approx(loop.forces[-1], rel=1e-9)


@pytest.mark.parametrize("version", ["fmi2", "fmi3"])
def test_without_memory_nothing_is_lost(native, version):
    """A joint without history has no loss in cycles of the force about a compressed working point."""
    fmu = native / version / "GearContact.fmu"
    found = loops.run_loops(fmu, "f", [100.0, 300.0], loops.CyclicInputPath(centre_value=500.0))
    assert (found.displacement_name, found.force_name) == ("s_rel", "f")
    assert [row["loss"] for row in found.compute_quantities_of_loops()] == [0.0, 0.0]
    assert found.compute_quantities_of_loops()[1]["force"] == 300.0
    assert "E_loss" not in found.compute_quantities_of_loops()[0]


@pytest.mark.parametrize(
    ("fmu", "input_name", "expected"),
    [
        ("BoltedJoint", "s_rel_x", "f_x"),
        ("BoltedJoint", "s_rel_z", "f_z"),
        ("HarmonicDriveSpring", "phi1", "tau1"),
        ("HarmonicDriveSpring", "phi2", "tau2"),
        ("HarmonicDriveCompliance", "tau", "phi_rel"),
        ("GearContact", "f", "s_rel"),
        ("GearMesh", "phi1", "tau1"),
    ],
)
def test_conjugate_output(native, fmu, input_name, expected):
    with ramp.unpack_fmu(native / "fmi3" / f"{fmu}.fmu") as (_, description):
        assert (
            loops.find_conjugate_output(*loops.input_and_output_units(description), input_name, None, fmu)
            == expected
        )


def test_the_command_prints_a_table_and_writes_what_fit_reads(native, tmp_path, capsys):
    fmu, path, picture = native / "fmi3" / "HarmonicDriveSpring.fmu", tmp_path / "l.csv", tmp_path / "l.png"
    words = ["ramp", fmu, "--input", "phi2", "--loop", *AMPLITUDES, "--set", *SET, "--csv", path]
    assert cli.main([*map(str, words), "--plot", str(picture)]) == 0
    printed = capsys.readouterr()
    head, *rows = printed.out.splitlines()
    assert printed.err == "angle = phi2, torque = -tau2\n"
    assert head.startswith("angle [rad],torque [N.m],secant_stiffness [N.m/rad],loss [J],loss_factor [1]")
    assert len(rows) == len(AMPLITUDES) + 2
    assert picture.read_bytes().startswith(b"\x89PNG")
    table = np.genfromtxt(path, delimiter=",", names=True, deletechars="")
    assert table.dtype.names[:3] == ("run_[1]", "angle_[rad]", "torque_[N.m]")
    assert set(table["run_[1]"]) == {1.0 + i for i in range(len(AMPLITUDES))}
    found = hysteresis.fit(path).solution.values
    assert found == pytest.approx(HYSTERESIS, rel=1e-6)


def test_loops_of_a_bolted_joint_give_its_friction_and_level_back(native, tmp_path):
    """The FMU has few sliders and patches, the law all nodes: the loops agree within 2 %."""
    path, true = tmp_path / "shear.csv", load_default("bolted_joint").values
    fmu, amplitudes = native / "fmi3" / "BoltedJoint.fmu", ["5e-7", "2e-6", "6e-6"]
    words = ["--input", "s_rel_x", "--loop", *amplitudes, "--set", "preload=9e3", "--csv", path, "--json"]
    assert cli.main([*map(str, ["ramp", fmu, *words])]) == 0
    found = shear.fit(path, fitted_names=["mu", "surface.G"], preload=9e3)
    assert found.solution.values["mu"] == pytest.approx(true.mu, rel=2e-3)  # as the force in gross slip
    assert found.facts["shear_stiffness"][0] == pytest.approx(
        shear.shear_stiffness_at_rest(true, 9e3), rel=0.01
    )
    assert found.facts["loop_area"][0] == pytest.approx(found.facts["loop_area_law"][0], rel=0.01)


def test_the_command_prints_json(native, capsys):
    fmu = str(native / "fmi2" / "BoltedJoint.fmu")
    words = [
        "--input",
        "s_rel_x",
        "--loop",
        "1e-6",
        "--points",
        "40",
        "--cycles",
        "1",
        "--set",
        "preload=9e3",
    ]
    assert cli.main(["ramp", fmu, *words, "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert (document["motion"], document["force"], document["sign"]) == ("s_rel_x", "f_x", -1.0)
    (row,) = document["rows"]
    assert row["motion"] == pytest.approx(1e-6)
    assert len(row["forces"]) == 51
    assert row["closed"] == 10
    assert cli.main(["ramp", fmu, *words[:-2], "--json"]) == 0  # without preload nothing holds it
    (row,) = json.loads(capsys.readouterr().out)["rows"]
    assert (row["force"], row["loss_factor"]) == (0.0, 0.0)


GEAR = ["--input", "f"]
SHEAR = ["--input", "s_rel_x", "--loop", "1e-6"]


@pytest.mark.parametrize(
    ("fmu", "words", "said"),
    [
        ("GearContact", GEAR, "state --to with --step, or --loop"),
        ("GearContact", [*GEAR, "--to", "1"], "state --to with --step, or --loop"),
        ("GearContact", [*GEAR, "--to", "1", "--step", "1", "--loop", "1"], "--loop and --to are both given"),
        (
            "GearContact",
            [*GEAR, "--to", "1", "--step", "1", "--points", "8"],
            "--points is for load cycles",
        ),
        ("GearContact", [*GEAR, "--loop", "-1"], "loop = -1 is outside (0, inf)"),
        ("GearContact", [*GEAR, "--loop", "1", "--about", "nan"], "about = nan is outside (-inf, inf)"),
        ("BoltedJoint", [*SHEAR, "--points", "10"], "points = 10, allowed are multiples of 4 from 8"),
        ("BoltedJoint", [*SHEAR, "--cycles", "0"], "cycles = 0 is outside [1, 1000]"),
        ("BoltedJoint", [*SHEAR, "--output", "K_xx"], "'K_xx' is not an output whose product with s_rel_x"),
        ("BoltedJoint", [*SHEAR, "--plot", "a.pdf"], "'.pdf' is not that of a picture"),
        (
            "BoltedJoint",
            ["--input", "v_rel_x", "--loop", "1"],
            "no output multiplied by v_rel_x [m/s] is an energy",
        ),
        ("BoltedJoint", ["--input", "K_xx", "--loop", "1"], "unknown input 'K_xx', allowed are preload"),
        ("BoltedJoint", [*SHEAR, "--set", "mu=-1"], "mu = -1"),
    ],
)
def test_refusals(native, fmu, words, said, capsys):
    assert said in refused_line(capsys, "ramp", native / "fmi2" / f"{fmu}.fmu", *words)
