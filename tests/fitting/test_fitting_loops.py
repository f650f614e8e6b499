"""Fits of joints with hysteresis: law of a loop, quantities read from data, round trips, refused files."""

import json
from contextlib import chdir
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from conftest import refused_line
from jointfmu_tools import cli
from jointfmu_tools.inputs.fitting import branches, decay
from jointfmu_tools.inputs.fitting.hysteresis import HysteresisLaw, NonlinearSpring, Oscillator
from jointfmu_tools.inputs.fitting.least_squares import FitSolution, Unknown
from jointfmu_tools.inputs.fitting.measurement import (
    MIN_MEASUREMENT_ROW_COUNT,
    MeasurementColumns,
    read_columns,
)
from jointfmu_tools.inputs.fitting.outcome import FitPlot, FitResult
from jointfmu_tools.joints.bolted_joint.fit import loop
from jointfmu_tools.joints.harmonic_drive.fit.hysteresis import LOOP_COLUMN_NAMES as DRIVE_HEADS
from oracles import joint_measurements as measurements

from jointfmu.joints.bolted_joint.joint import BoltedJointSpring
from jointfmu.parameters import load_default, load_parameter_file
from jointfmu.quantity.units import unit_sizes

PRELOAD = measurements.PRELOAD
K, C = 2e9, 4e13
PARABOLA = HysteresisLaw(lambda u: K * u - C * u**2, lambda u: K * u**2 / 2.0 - C * u**3 / 3.0)
"""Friction law B = K u - C u^2, for which the expected values below are known in closed form."""
SPRING = NonlinearSpring(lambda u: K * u, lambda u: 0.5 * K * u**2)
AMPLITUDES = np.array([1e-7, 1e-6, 1e-5])

# The law of a loop


def test_first_loading_is_the_normal_curve_once_more():
    """B(u) = mu (F_N(0) - F_N(kappa u/mu)) with the normal force of the exported joint at all of
    its nodes."""
    joint = load_default("bolted_joint").values
    law, told = loop.make_shear_loop_law(joint, PRELOAD)
    spring = BoltedJointSpring.from_interface_nodes(joint)

    def state(apart):
        return spring.evaluate(PRELOAD, 0.0, (0.0, 0.0, apart), (0.0, 0.0, 0.0))

    rest = state(0.0)
    kappa = float(joint.shear_stiffness_ratio())
    motion = np.array([1e-8, 1e-7, 1e-6, 5e-6, 9e-6])
    expected = [-joint.mu * state(kappa * u / joint.mu)["f_z"] for u in motion]
    np.testing.assert_allclose(law.friction_force(motion), expected, rtol=3e-6)  # the table of 48 steps
    assert law.friction_force(np.array([1.0])) == pytest.approx([joint.mu * joint.n_bolts * PRELOAD])
    assert told["shear_stiffness"][0] == pytest.approx(kappa * rest["K_zz"], rel=1e-5)
    assert told["shear_stiffness"][0] == pytest.approx(rest["K_xx"], rel=5e-3)  # that of the patches
    near = [state(s)["K_zz"] for s in (-1e-9, 1e-9)]
    load = joint.n_bolts * PRELOAD
    power = (near[0] - near[1]) / 2e-9 * load / rest["K_zz"] ** 2  # d ln K/d ln P at dP = K du
    assert told["exponent"][0] == pytest.approx(power, rel=1e-4)


def test_work_is_the_integral_of_the_friction():
    law, u = measurements.joint_law(), np.linspace(0.0, 12e-6, 20001)
    whole = np.concatenate(
        [[0.0], np.cumsum(0.5 * (law.friction_force(u)[1:] + law.friction_force(u)[:-1])) * u[1]]
    )
    np.testing.assert_allclose(law.friction_work(u)[1000:], whole[1000:], rtol=1e-6)  # trapezoids


def test_loop_of_a_parabola():
    """The stiffness is K - C a, the area 4/3 C a^3; the loop by the trapezoidal rule has the same area."""
    stiffness, loss = PARABOLA.equivalent_spring(AMPLITUDES)
    np.testing.assert_allclose(stiffness, K - C * AMPLITUDES, rtol=1e-12)
    area = 4.0 / 3.0 * C * AMPLITUDES**3
    np.testing.assert_allclose(loss, area / (np.pi * stiffness * AMPLITUDES**2), rtol=1e-9)
    u = 1e-6 * np.cos(np.linspace(0.0, np.pi, 4001))
    falling = PARABOLA.force_change(u, np.full(u.size, 1e-6))
    middle = falling - 0.5 * falling[-1]
    assert 2.0 * np.sum(0.5 * (middle[1:] + middle[:-1]) * np.diff(u)) == pytest.approx(area[1], rel=1e-5)


def test_decay_of_a_parabola():
    """The decrement to second order, by hand: (2/3) e (1 + 2 e), e = C h/K."""
    e = np.array([1e-3, 2e-3])
    omega, decrement = PARABOLA.free_decay(e * K / C, 5.0)
    np.testing.assert_allclose(decrement, 2.0 / 3.0 * e * (1.0 + 2.0 * e), rtol=2e-5)  # third order
    np.testing.assert_allclose(omega, np.sqrt((K - C * e * K / C) / 5.0), rtol=2e-6)  # second order


def test_decay_of_a_viscous_spring():
    """A spring with viscous damping and without friction: frequency sqrt(K/M), decrement pi d/(2 sqrt(K M))
    per half period."""
    law = HysteresisLaw(lambda u: 0.0 * u, lambda u: 0.0 * u, SPRING, viscous_damping=200.0)
    omega, decrement = law.free_decay(AMPLITUDES, 5.0)
    np.testing.assert_allclose(omega, np.sqrt(K / 5.0), rtol=1e-9)
    np.testing.assert_allclose(decrement, 0.5 * np.pi * 200.0 / np.sqrt(K * 5.0), rtol=1e-5)  # second order


def test_free_vibration_agrees_with_integration_in_time():
    """Velocity Verlet with 500 steps per period is accurate to 1e-5; the windows deviate by less than their
    own estimate."""
    found = decay.analyse_decay(*measurements.joint_decay())
    law, mass = measurements.joint_law(), measurements.MASS
    frequency, damping = Oscillator(law, mass).free_vibration(found.motion_amplitude)
    assert np.all(np.abs(found.frequency / frequency - 1.0) < found.frequency_deviation + 2e-4)
    assert np.all(np.abs(found.damping_ratio / damping - 1.0) < found.damping_deviation / damping + 5e-3)
    assert found.damping_ratio[0] > 2.0 * found.damping_ratio[-1]


def test_response_agrees_with_integration_in_time():
    """Amplitude of the steady state; the first harmonic neglects 1/9 of the third one, less than 1 %."""
    law, mass, force, frequency = measurements.joint_law(), measurements.MASS, 800.0, 1080.0
    expected = Oscillator(law, mass).response_amplitude(
        np.array([frequency]), np.array([force]), np.array([1e-6])
    )[0]
    found = measurements.forced(law, mass, force, frequency, 3.0 * expected)
    assert found == pytest.approx(expected, rel=1e-2)


# Branches


def joint_loops(**noise):
    return measurements.loops(measurements.joint_law(), (2e-6, 6e-6), np.random.default_rng(1), **noise)


def test_branches_follow_their_law():
    run, motion, force = joint_loops()
    parts = [("", motion[run == k], force[run == k]) for k in (1.0, 2.0)]
    found = branches.cut_branches(parts)
    assert found.branch_start_motion.size == 6  # three turning points inside each run of two periods
    law = measurements.joint_law()
    _, start, rest = found.fit_turning_points(law, np.full(found.joint_motion.size, 30.0))
    # the noise is 0.3 % of the force, and 0.1 % of the motion
    assert np.std(rest[found.run_of_sample == 1]) < 6e-3 * force.max()
    np.testing.assert_allclose(np.abs(start[found.branch_start_motion > 3e-6]), 6e-6, rtol=5e-3)


def test_a_branch_ends_where_it_passes_the_turning_point_before():
    """In loops of growing amplitude, the part beyond the last loop has another history and belongs to no
    branch."""
    turns = np.array([0.0, 1.0, -1.5, 2.0, -2.0])
    motion = np.concatenate([np.linspace(a, b, 50, endpoint=False) for a, b in pairwise(turns)])
    found = branches.cut_branches([("", motion, motion)])
    ends = [
        (
            found.joint_motion[found.branch_of_sample == k].min(),
            found.joint_motion[found.branch_of_sample == k].max(),
        )
        for k in range(3)
    ]
    assert ends[0][0] == pytest.approx(-1.5, abs=0.1)
    assert ends[1][1] == pytest.approx(1.0, abs=0.1)
    assert ends[2][0] == pytest.approx(-1.5, abs=0.1)


def swung(law, turns):
    """Force (n) over motions (n) from rest through turning points; each branch lies within the one before."""
    motion, force, reached = [], [], 0.0
    for a, b in pairwise(turns):
        way = np.linspace(a, b, 200, endpoint=False)
        motion.append(way)
        force.append(reached + law.force_change(way, np.full(way.size, a)))
        reached += float(law.force_change(np.array([b]), np.array([a]))[0])
    return np.concatenate(motion), np.concatenate(force)


@pytest.mark.parametrize("middle", [0.0, 4e-6])
def test_the_place_of_rest_is_found_in_loops(middle):
    """A stiffening spring, for any zero of the motion, also if it is loaded to one side."""
    hardening = NonlinearSpring(lambda u: K * u + 1e20 * u**3, lambda u: 0.5 * K * u**2 + 2.5e19 * u**4)
    law = replace(PARABOLA, elastic_spring=hardening)
    motion, force = swung(law, [middle + a for a in (5e-6, -5e-6, 5e-6, -5e-6)])
    found = branches.cut_branches([("", motion + 3e-5, force - 7e3)])
    rest = found.rest_position(law, found.residual_scale)
    assert rest == pytest.approx(3e-5, rel=1e-6)
    # steps of 50 nm: the turning points are the outermost samples
    assert np.max(
        np.abs(found.fit_turning_points(law.with_rest_position(rest), found.residual_scale)[2])
    ) < 1e-9 * np.ptp(force)


def test_a_linear_spring_has_no_place_of_rest():
    law = replace(PARABOLA, elastic_spring=SPRING)
    motion, force = swung(law, [5e-6, -5e-6, 5e-6, -5e-6])
    found = branches.cut_branches([("", motion + 3e-5, force - 7e3)])
    assert found.rest_position(law, found.residual_scale) in (0.0, pytest.approx(3e-5, rel=2e-3))
    assert np.max(np.abs(found.residuals(law, found.residual_scale))) < 1e-9


def test_noise_does_not_widen_the_loops():
    """The largest of several noisy samples is two deviations too large; the vertex of the parabola is not."""
    rng = np.random.default_rng(1)
    motion = np.cos(np.linspace(1.0, 99.0, 98 * 300)) + 1e-3 * rng.standard_normal(98 * 300)
    turns = branches.find_turning_points(motion)
    values = [
        abs(branches.refine_turning_point(motion, k, branches.estimate_noise_deviation(motion)))
        for k in turns
    ]
    assert turns.size == 31
    assert np.mean(np.abs(motion[turns])) > 1.0 + 1.5e-3
    assert np.mean(values) == pytest.approx(1.0, abs=4e-4)


def test_motion_at_the_turning_points_is_part_of_the_doubt():
    """The turning points of a coarsely sampled motion have a deviation of the order of half a step."""
    motion = np.abs((np.arange(200) * 0.07 + 0.03) % 4.0 - 2.0)
    found = branches.cut_branches([("", motion, 2.0 * motion)])
    assert np.all(found.branch_start_motion_standard_deviation > 0.02)


# Round trips


@pytest.mark.slow
@pytest.mark.parametrize("case", measurements.CASES)
def test_round_trip(case, tmp_path):
    """A small version of the benchmark's 100 seeds: by chance 1 % of the fits are outside three
    deviations."""
    found, true = measurements.CASES[case](np.random.default_rng(3), tmp_path / "measured.csv")
    for name, deviation in found.solution.relative_deviations.items():
        assert abs(np.log(found.solution.values[name] / true[name])) < 3.0 * deviation, name
    assert found.solution.noise == pytest.approx(1.0, abs=0.35)  # the groups are weighted by their own


@pytest.mark.slow
def test_the_command_writes_what_it_found(tmp_path, capsys):
    path, out, picture = tmp_path / "shear.csv", tmp_path / "joint.toml", tmp_path / "fit.png"
    run, motion, force = joint_loops()
    measurements.save(path, "run [1], displacement [um], force [kN]", run, 1e6 * motion, 1e-3 * force)
    words = [
        "fit",
        "loop",
        path,
        "--preload",
        "9e3",
        "--free",
        "mu",
        "surface.G",
        "--out",
        out,
        "--plot",
        picture,
    ]
    assert cli.main([*map(str, words), "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["joint"] == "bolted_joint"
    assert document["facts"]["friction_limit"]["value"] == pytest.approx(
        document["parameters"]["mu"] * 8 * 9e3
    )
    file = load_parameter_file(out, "bolted_joint")
    assert file.values.mu == document["parameters"]["mu"]
    assert file.sources["mu"].startswith("fitted to shear.csv")
    assert "preload 9000 N" in file.sources["mu"]
    assert picture.read_bytes().startswith(b"\x89PNG")


@pytest.mark.slow
def test_law_of_a_roughness_has_a_level_and_no_exponent(tmp_path):
    file = load_parameter_file("models/bolted_joint/box_specimen_roughness.toml", "bolted_joint")
    law = loop.make_shear_loop_law(file.with_values({"mu": 0.3, "h": 4e-6}, "user", "true").values, PRELOAD)[
        0
    ]
    run, motion, force = measurements.loops(law, (1e-6, 4e-6), np.random.default_rng(1))
    path = measurements.save(
        tmp_path / "m.csv", "run [1], displacement [um], force [N]", run, 1e6 * motion, force
    )
    found = loop.fit(path, file, preload=PRELOAD).solution
    assert found.values.keys() == {"mu", "h"}
    for name, true in (("mu", 0.3), ("h", 4e-6)):
        assert abs(np.log(found.values[name] / true)) < 3.0 * found.relative_deviations[name]


# Files that are refused

TURNS = "run [1], displacement [um], force [N]"
VIBRATION = ["--preload", "9e3", "--modal-mass", "50"]


def write(folder, heading, *columns):
    return measurements.save(folder / "bad.csv", heading, *columns)


def ringing(folder, growth=-3.0, samples=500):
    t = np.linspace(0.0, 1.0, samples)
    return write(folder, "time [s], displacement [um]", t, np.exp(growth * t) * np.cos(60.0 * t))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            lambda run, u, F: (run, u, -F),
            "run 1: the force decreases as the motion increases; reverse the sign",
        ),
        (lambda run, u, F: (run[::-1], u[::-1], F[::-1]), "the loop creates energy, area = -"),
        (lambda run, u, F: (run, np.linspace(0.0, 1.0, u.size), u), "the motion never reverses"),
    ],
    ids=["sign", "direction", "ramp"],
)
def test_loops_that_are_none(change, message, tmp_path, capsys):
    run, motion, force = change(*joint_loops())
    path = write(tmp_path, TURNS, run, 1e6 * motion, force)
    line = refused_line(capsys, "fit", "loop", path, "--preload", "9e3")
    assert str(path) in line
    assert message in line


def test_a_small_loop_that_runs_back_is_refused(tmp_path, capsys):
    """The loop area is below a percent of its bounding box, yet many times the noise."""
    run, motion, force = measurements.loops(
        measurements.joint_law(), (1e-7,), np.random.default_rng(1), noise=1e-5
    )
    path = write(tmp_path, TURNS, run, 1e6 * motion[::-1], force[::-1])
    assert "creates energy" in refused_line(capsys, "fit", "loop", path, "--preload", "9e3")


def test_a_growing_vibration_is_refused(tmp_path, capsys):
    line = refused_line(capsys, "fit", "loop", ringing(tmp_path, growth=5.0), *VIBRATION)
    assert "a joint cannot create energy" in line


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ([], "preload = 0 N is outside (0, inf); state that of each bolt in the test (--preload)"),
        (["--preload", "9e3"], "has a vibration (decay); state the modal mass (--modal-mass)"),
        (["--preload", "9e3", "--modal-mass", "-1"], "modal mass = -1 is outside (0, inf)"),
        ([*VIBRATION, "--damping-ratio", "0.5"], "damping ratio = 0.5 is outside [0, 0.3)"),
        (
            [*VIBRATION, "--inertia", "1"],
            "has the columns of a bolted_joint; --inertia is for a harmonic_drive only",
        ),
        (["--preload", "1e9", "--modal-mass", "50"], "allowed is up to"),
        ([*VIBRATION, "--free", "surface.X"], "'surface.X' is not a parameter to fit"),
    ],
)
def test_options_that_are_refused(options, message, tmp_path, capsys):
    assert message in refused_line(capsys, "fit", "loop", ringing(tmp_path), *options)


@pytest.mark.parametrize(
    ("heading", "message"),
    [
        ("run [1], displacement [mm], force [N]", "in um, where the heading says mm, or the force is in kN"),
        ("run [1], displacement [um], force [kN]", "in mm, where the heading says um, or the force is in N,"),
    ],
)
def test_a_stiffness_in_a_wrong_unit_is_questioned(heading, message, tmp_path, capsys):
    run, motion, force = joint_loops()
    path = write(tmp_path, heading, run, 1e6 * motion, force)
    line = refused_line(capsys, "fit", "loop", path, "--preload", "9e3", "--out", tmp_path / "joint.toml")
    assert f"likely the displacement is {message}" in line
    assert not (tmp_path / "joint.toml").exists()


def test_a_mass_says_nothing_about_loops(tmp_path, capsys):
    run, motion, force = joint_loops()
    path = write(tmp_path, TURNS, run, 1e6 * motion, force)
    assert "has loops, so" in refused_line(capsys, "fit", "loop", path, *VIBRATION)


@pytest.mark.parametrize(
    ("heading", "rows", "message"),
    [
        (
            "force [N], time [s]",
            (1, 2),
            "has no column of angle (harmonic_drive) or displacement (bolted_joint); expected one",
        ),
        ("displacement [um], angle [rad]", (1, 2), "has more than one column of angle"),
        ("displacement [um], weight [N]", (1, 2), "has displacement alone; expected displacement with force"),
        (
            "displacement [um], frequency [Hz], damping [1]",
            (1, -2, 3),
            "frequency = -2 Hz is outside (0, inf)",
        ),
        ("displacement [um], frequency [Hz], force [N]", (1, 2, 0), "force = 0 N is outside (0, inf)"),
        ("displacement [um], time [s]", (1, 2), "time does not increase at row 2"),
    ],
)
def test_columns_that_are_refused(heading, rows, message, tmp_path, capsys):
    path = write(tmp_path, heading, *(np.full(20, float(x)) for x in rows))
    assert message in refused_line(capsys, "fit", "loop", path, *VIBRATION)


def test_a_record_needs_samples_and_periods(tmp_path, capsys):
    line = refused_line(capsys, "fit", "loop", ringing(tmp_path, samples=40), *VIBRATION)
    assert "samples per period, at least 10 are needed" in line
    line = refused_line(capsys, "fit", "loop", ringing(tmp_path, growth=-40.0), *VIBRATION)
    assert "are above the noise, at least 4 are needed" in line


def test_kinds_of_files(tmp_path):
    heads = MeasurementColumns("force", "displacement", unit_sizes("N"), unit_sizes("m", "um"))
    for names, kind in (
        ("displacement [um], force [N], time [s]", "loops"),
        ("time [s], displacement [um]", "decay"),
        ("frequency [Hz], displacement [um], damping [1]", "backbone"),
        ("frequency [Hz], displacement [um], force [N]", "response"),
    ):
        path = write(tmp_path, names, *(np.ones(10) for _ in names.split(",")))
        assert read_columns(path, heads)[0] == kind


@pytest.mark.slow
def test_frequency_and_damping_over_the_amplitude(tmp_path):
    """A backbone that another program evaluated; the damping ratio of the structure is fitted too."""
    a = np.geomspace(1e-7, 3e-6, 25)
    frequency, damping = Oscillator(measurements.joint_law(), measurements.MASS, 0.004).free_vibration(a)
    rng = np.random.default_rng(1)
    frequency, damping = (
        x * np.exp(s * rng.standard_normal(25)) for x, s in ((frequency, 1e-3), (damping, 0.03))
    )
    path = write(tmp_path, "displacement [um], frequency [Hz], damping [1]", 1e6 * a, frequency, damping)
    known = measurements.file("bolted_joint", {"surface.D": measurements.JOINT["surface.D"]})
    found = loop.fit(
        path, known, ["mu", "surface.G", "damping_ratio"], preload=PRELOAD, modal_mass=measurements.MASS
    )
    true = measurements.JOINT | {"damping_ratio": 0.004}
    for name, deviation in found.solution.relative_deviations.items():
        assert abs(np.log(found.solution.values[name] / true[name])) < 3.0 * deviation, name
    assert len(found.fit_plots) == 2


@pytest.mark.slow
def test_a_structure_in_series_is_told_from_the_joint(tmp_path):
    """A beam is no joint alone: with a stated or fitted series stiffness the fit finds the joint, without it
    it does not."""
    true = measurements.file("bolted_joint", measurements.JOINT)
    joint, series = loop.shear_stiffness_at_rest(true.values, PRELOAD), 0.5
    law = loop.make_shear_loop_law(true.values, PRELOAD, series * joint)[0]
    alone = loop.make_shear_loop_law(true.values, PRELOAD)[0]
    motion = np.geomspace(1e-8, 3e-6, 20)
    both = motion + alone.friction_force(motion) / (series * joint)
    np.testing.assert_allclose(
        law.friction_force(both), alone.friction_force(motion), rtol=1e-4
    )  # between its nodes
    frequency, damping = Oscillator(law, measurements.MASS).free_vibration(np.geomspace(1e-7, 1e-5, 25))
    noise = np.random.default_rng(1)
    frequency, damping = (
        x * np.exp(s * noise.standard_normal(25)) for x, s in ((frequency, 1e-4), (damping, 0.01))
    )
    heads = "displacement [um], frequency [Hz], damping [1]"
    path = write(tmp_path, heads, 1e6 * np.geomspace(1e-7, 1e-5, 25), frequency, damping)
    start = measurements.file("bolted_joint", {"surface.D": measurements.JOINT["surface.D"]})

    def fitted(*more, **given):
        return loop.fit(
            path, start, ["mu", "surface.G", *more], preload=PRELOAD, modal_mass=measurements.MASS, **given
        )

    stated, found, rigid = fitted(series_stiffness=series * joint), fitted("series_stiffness"), fitted()
    for one in (stated, found):
        for name, deviation in one.solution.relative_deviations.items():
            want = measurements.JOINT.get(name, series * joint)
            assert abs(np.log(one.solution.values[name] / want)) < 4.0 * deviation, name
        assert one.facts["shear_stiffness"][0] == pytest.approx(joint, rel=0.02)
    assert rigid.facts["shear_stiffness"][0] < 0.5 * joint
    with pytest.raises(ValueError, match="joint and structure together have at least this stiffness"):
        fitted(series_stiffness=0.1 * joint)


@pytest.mark.parametrize(("end", "areas"), [(1.5, []), (1.76, [0.4])])
def test_an_area_is_that_of_a_loop_that_closes(end, areas):
    """The area counts from a tip on; the half branch after the last complete one closes no loop."""
    t = np.linspace(0.25, end, 400)
    motion = np.sin(2.0 * np.pi * t)
    found = branches.cut_branches(
        [("", motion, motion + 0.1 * np.sign(np.cos(2.0 * np.pi * t)))]
    ).widest_loops
    assert [area for area, _ in found] == pytest.approx(areas, rel=0.02)


def test_runs_of_their_own_size_have_their_own_noise():
    run, motion, force = joint_loops()
    force[run == 2.0] += 1e3 * np.random.default_rng(2).standard_normal(np.count_nonzero(run == 2.0))
    found = branches.cut_branches([("", motion[run == k], force[run == k]) for k in (1.0, 2.0)])
    rest = found.fit_turning_points(measurements.joint_law(), found.residual_scale)[2]
    assert np.std(rest[found.run_of_sample == 1]) > 20.0 * np.std(rest[found.run_of_sample == 0])
    assert replace(found, widest_loops=()).noise_group_of_residual is found.run_of_sample


@pytest.mark.slow
def test_level_and_exponent_of_a_vibration_go_along_the_valley_of_its_stiffness(tmp_path):
    """The stiffness is known a hundred times better than level and exponent; the search ends nevertheless."""
    a = np.geomspace(1e-7, 6e-6, 25)
    frequency, damping = Oscillator(measurements.joint_law(), measurements.MASS).free_vibration(a)
    rng = np.random.default_rng(1)
    frequency, damping = (
        x * np.exp(s * rng.standard_normal(25)) for x, s in ((frequency, 1e-4), (damping, 0.01))
    )
    path = write(tmp_path, "displacement [um], frequency [Hz], damping [1]", 1e6 * a, frequency, damping)
    names = list(loop.DEFAULT_FITTED_PARAMETERS["zhao2018"])
    found = loop.fit(path, fitted_names=names, preload=PRELOAD, modal_mass=measurements.MASS)
    for name, deviation in found.solution.relative_deviations.items():
        assert abs(np.log(found.solution.values[name] / measurements.JOINT[name])) < 3.0 * deviation, name
    assert found.facts["shear_stiffness"][0] == pytest.approx(
        loop.shear_stiffness_at_rest(measurements.file("bolted_joint", measurements.JOINT).values, PRELOAD),
        rel=1e-3,
    )
    assert found.solution.relative_deviations["surface.G"] > 100.0 * 1e-4


@pytest.mark.parametrize(
    "titles",
    [
        "phi [rad],tau [N.m]",
        "Angle (rad);Torque (N.m)",
        "Drehwinkel/rad;Drehmoment/N.m",
        "Winkel [rad]\tMoment [N.m]",
    ],
)
def test_titles_as_people_write_them(tmp_path, titles):
    mark = next(m for m in ";\t," if m in titles)
    rows = "".join(f"{i}{mark}{2 * i}\n" for i in range(MIN_MEASUREMENT_ROW_COUNT))
    (tmp_path / "a.csv").write_text(f"{titles}\n{rows}")
    kind, table = read_columns(tmp_path / "a.csv", DRIVE_HEADS)
    assert kind == "loops"
    assert table.values_by_name["torque"].tolist() == [2 * a for a in table.values_by_name["angle"]]


@pytest.mark.slow
def test_a_fit_that_says_nothing_is_not_written(tmp_path, capsys, enter):
    """A fit to an elastic bar, whose loop area is noise, is refused and no file is written."""
    enter(chdir(tmp_path))
    motion = 1e-6 * np.sin(np.linspace(0.0, 6.0 * np.pi, 241))
    force = 1e9 * motion + np.random.default_rng(0).normal(0.0, 1.0, motion.size)
    rows = "".join(f"{u!r},{f!r}\n" for u, f in zip(motion.tolist(), force.tolist(), strict=True))
    (tmp_path / "bar.csv").write_text(f"displacement [m],force [N]\n{rows}")
    words = ["fit", "loop", "bar.csv", "--preload", "9e3", "--out", "bar.toml"]
    assert cli.main(words) == 1
    said = capsys.readouterr().err
    assert "the fit does not determine the joint: the area of the widest loop is " in said
    assert said.endswith("allowed is a factor of 2; bar.toml is not written, --force writes it\n")
    assert not (tmp_path / "bar.toml").exists()
    assert cli.main([*words, "--json"]) == 1
    assert json.loads(capsys.readouterr().out)["doubt"].startswith("the area of the widest loop")
    assert cli.main([*words, "--force"]) == 0
    assert load_parameter_file("bar.toml", "bolted_joint").values_by_name["mu"] > 0.0


REMEDY = "fit other parameters, or add data"


@pytest.mark.parametrize(
    ("stuck", "deviation", "h", "says"),
    [
        (
            ("mu", "h"),
            0.01,
            1e-6,
            f"mu, h ended on a bound of their intervals; {REMEDY}",
        ),
        (("mu",), 0.01, 1e-6, f"mu ended on a bound of its interval; {REMEDY}"),
        ((), 0.01, 1e-6, None),
        (
            (),
            10.0,
            1e-6,
            f"the data determine none of mu, h, nor a combination of them; {REMEDY}",
        ),
        (
            (),
            0.01,
            1.41,
            "h = 1.41e+06 um is outside (0, 100] um: too large for a roughness; check "
            "the units, and state the stiffness in series with the joint (--series-stiffness)",
        ),
    ],
)
def test_what_a_fit_does_not_say(stuck, deviation, h, says):
    """Two unknowns: the data determine one of them weakly, the other not at all."""
    wanted = tuple(Unknown(name, "1", 0.1, 1e-3, 10.0) for name in ("mu", "h"))
    seen, nothing = np.eye(2), np.zeros(2)
    values = {"mu": 0.1, "h": h}
    solution = FitSolution(wanted, values, nothing, deviation, seen, deviation**2 * seen, stuck, None)
    picture = FitPlot(nothing, nothing, nothing, (nothing, nothing), ("", "", ""))
    assert FitResult(load_default("bolted_joint"), solution, {}, picture).rejection_reason() == says
