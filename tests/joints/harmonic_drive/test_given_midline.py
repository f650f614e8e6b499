"""Laws `catalogue` and `table`: catalogue lines and measured points against the exported midline."""

import csv
from dataclasses import replace
from importlib.resources import files

import numpy as np
import pytest
from conftest import refused_line
from jointfmu_tools.common.pressure import judge_joint_stiffness
from jointfmu_tools.joints.harmonic_drive import catalogue
from jointfmu_tools.joints.harmonic_drive.new import NEW_JOINT_COMMAND
from jointfmu_tools.studies.uncertainty import propagate
from jointfmu_tools.studies.uncertainty.problem import define_joint_study
from scipy.interpolate import PchipInterpolator

from jointfmu.joints import KINDS
from jointfmu.joints.harmonic_drive.hysteresis import HISTORY_LAYOUT, stiffness_exponent
from jointfmu.joints.harmonic_drive.prescribed_midline import (
    CatalogueDriveParameters,
    MeasuredMidline,
    TableDriveParameters,
)
from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring, torque_curve
from jointfmu.parameters import format_parameter_file, load_default, load_parameter_file
from jointfmu.quantity import build_parameter_set, replace_values

SAME = 1e-12
"""Round-off of the spline's coefficients; the lines themselves are exact."""
STATED = 0.005
"""Accuracy of the whole curve with its corners, as stated in the documentation."""
TEXT = (files("jointfmu_models") / "reference" / "harmonic_drive_catalogue_stiffness.csv").read_text("utf-8")
ROWS = list(csv.DictReader(TEXT.splitlines()))
COLUMNS = {"K1": "K1_Nm_per_rad", "K2": "K2", "T1": "T1_Nm", "T2": "T2_Nm"}
CSG_17 = {"K1": 1e4, "K2": 1.4e4, "K3": 1.6e4, "T1": 3.9, "T2": 12.0}


def lines(T, K1, K2, K3, T1, T2):
    """Wind-up of the three catalogue lines at torques, integrated from the compliance steps."""
    return np.interp(T, [0.0, T1, T2, 1e3 * T2], np.cumsum([0.0, T1 / K1, (T2 - T1) / K2, (999.0 * T2) / K3]))


def drive(**changes):
    values = {"ratio": 100.0, "d": 0.5, "rated_torque": 31.0, "max_torque": 124.0}
    return CatalogueDriveParameters(**CSG_17 | values | changes)


def named(name):
    return NEW_JOINT_COMMAND.make_joint(
        dict.fromkeys(option.name for option in NEW_JOINT_COMMAND.command_options) | {"catalogue": name}
    ).parameter_file


def name_of(row):
    group, ratio = row["series"].removeprefix("HD "), "100" if row["ratio"] == "80+" else row["ratio"]
    return f"{group}-{ratio}" if "/" not in group else f"CSG-{row['size']}-{ratio}"


# the catalogue's lines


@pytest.mark.parametrize("row", ROWS, ids=name_of)
def test_every_row_keeps_its_angles(row):
    """The exported spring keeps the angles of every row at T1, T2, rated and peak torque, and exactly outside
    the corners."""
    K = {
        n: float(row[k]) for n, k in (("K1", "K1_Nm_per_rad"), ("K2", "K2"), ("T1", "T1_Nm"), ("T2", "T2_Nm"))
    }
    K["K3"] = catalogue.find_drive(name_of(row)).known_numbers["K3"].si_value
    d = named(name_of(row)).values
    spring = HarmonicDriveSpring.tabulate(d)
    for T in (d.T1, d.T2, d.rated_torque, d.max_torque, -d.rated_torque):
        assert float(spring.evaluate_torque(T)["phi_rel"]) == pytest.approx(
            np.sign(T) * lines(abs(T), **K), rel=STATED
        )
    T = np.linspace(0.0, 1.5 * d.max_torque, 3001)[1:]
    phi = lines(T, **K)
    away = np.all([np.abs(phi / corner - 1.0) > d.corner for corner in d.corner_wind_ups], axis=0)
    state = spring.evaluate_torque(T)
    np.testing.assert_allclose(state["phi_rel"], phi, rtol=STATED)
    np.testing.assert_allclose(state["phi_rel"][away], phi[away], rtol=SAME)
    step = np.where(K["T1"] > T, K["K1"], np.where(K["T2"] > T, K["K2"], K["K3"]))
    np.testing.assert_allclose(state["K_WTS"][away], step[away], rtol=SAME)


def test_stiffness_is_the_derivative_and_has_no_kink():
    """Central differences, and the derivative of the stiffness on both sides of every node."""
    curve = torque_curve(drive())
    x, h = np.linspace(1e-6, curve.end_point[0], 4001), 1e-8
    slope = (curve.derivatives(x + h, 0)[0] - curve.derivatives(x - h, 0)[0]) / (2.0 * h)
    np.testing.assert_allclose(slope, curve.derivatives(x, 1)[1], rtol=1e-6)  # round-off of 1e-13 N m over h
    assert np.all(curve.stiffness_slope_start[1:] == curve.stiffness_slope_end[:-1])
    assert curve.stiffness_slope_start[0] == 0.0  # the odd continuation has none either
    K = curve.derivatives(x, 1)[1]
    assert np.all(np.diff(K) >= -1e-6)
    assert (K[0], K[-1]) == pytest.approx((1e4, 1.6e4), rel=1e-12)


def test_a_drive_that_softens_and_lines_without_a_corner():
    soft = HarmonicDriveSpring.tabulate(drive(K3=9e3))
    T = np.array([1.0, 8.0, 60.0])
    np.testing.assert_allclose(
        soft.evaluate_torque(T)["phi_rel"], lines(T, **CSG_17 | {"K3": 9e3}), rtol=SAME
    )
    plain = HarmonicDriveSpring.tabulate(drive(K2=1e4, K3=1e4))
    np.testing.assert_allclose(plain.evaluate_torque(T)["phi_rel"], T / 1e4, rtol=SAME)


def test_parts_and_pressure_of_a_given_midline():
    """1/K_WTS = 1/K_FTS + 1/K_TS with equal parts at the largest stiffness of the drive; no pressure."""
    state = HarmonicDriveSpring.tabulate(drive()).evaluate_torque([0.0, 8.0, 60.0])
    np.testing.assert_allclose(1.0 / state["K_FTS"] + 1.0 / state["K_TS"], 1.0 / state["K_WTS"], rtol=SAME)
    np.testing.assert_array_equal(state["K_FTS"], 3.2e4)
    assert state["K_TS"][-1] == pytest.approx(3.2e4, rel=SAME)
    np.testing.assert_array_equal(state["K_TS_pair"], state["K_TS"])
    np.testing.assert_array_equal(state["p_max"], 0.0)


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"T2": 3.0}, r"T2 = 3 N.m is outside \(3.9, inf\): it must exceed T1"),
        ({"K1": 0.0}, r"K1 = 0 N.m/rad is outside \(0, 1e\+12\]: stiffness below T1"),
        (
            {"corner": 0.5},
            r"corner = 0.5 is outside \[0, 0.425868\): the corners at T1 and T2 must not overlap",
        ),
        ({"K1": 67.0}, r"K1 = 67 N.m/rad is outside \(561.7\d*, 1e\+12\]: it is too far below K2"),
        ({"corner": -0.1}, r"corner = -0.1 is outside \[0, 1\)"),
    ],
)
def test_lines_that_cannot_be_are_refused(changes, text):
    with pytest.raises(ValueError, match=text):
        drive(**changes)


def test_the_table_reaches_past_the_second_corner():
    """If T2 is set above max_torque, the end of the table moves, and nothing is refused."""
    curve = torque_curve(drive(T2=200.0))
    assert curve.end_point[1] > 200.0
    assert float(curve.inverse(300.0)) == pytest.approx(lines(300.0, **CSG_17 | {"T2": 200.0}), rel=SAME)


def test_hysteresis_of_a_drive_without_a_pair():
    """Exponential as Dahl's friction, with the stated width after rated torque; the energy balance closes."""
    loss = 3e-4
    assert stiffness_exponent(drive()) == 1.0
    spring = HarmonicDriveSpring.tabulate(drive(hysteresis_loss=loss))
    hysteresis = spring.hysteresis
    limit, stiffness = np.sum(hysteresis.friction_limit), np.sum(hysteresis.stiffness)
    phi = np.linspace(0.0, 3.0 * limit / stiffness, 50)
    rest = np.broadcast_to(HISTORY_LAYOUT.virgin_history(), (50, HISTORY_LAYOUT.virgin_history().size))
    dahl = limit * (1.0 - np.exp(-stiffness * phi / limit))
    np.testing.assert_allclose(hysteresis.advance(rest, phi).traction, dahl, atol=2e-3 * limit)
    memory, wound = HISTORY_LAYOUT.virgin_history(), []
    for tau in (31.0, 0.0, -31.0, 0.0):
        state, memory = spring.advance_torque(tau, memory)
        wound.append(float(state["phi_rel"]))
    assert wound[1] - wound[3] == pytest.approx(loss, rel=1e-3)  # Masing's rule from rest: the last digits


# a measured table


def table(torque, angle, **changes):
    values = {"ratio": 100.0, "d": 0.5, "rated_torque": 31.0}
    return TableDriveParameters(
        table=MeasuredMidline(torque=tuple(torque), angle=tuple(angle)), **values | changes
    )


def random_table(rng, n):
    return np.cumsum(rng.lognormal(0.0, 1.5, n)), 1e-4 * np.cumsum(rng.lognormal(0.0, 1.5, n))


def test_a_table_of_a_smooth_law_gives_it_back():
    """T = K x (1 + b x^2): the error of the stiffness is of the order of the spacing, the error of the
    torque of its square."""
    x = np.linspace(0.0, 2e-3, 41)[1:]
    K, b = 1e4, 2e5
    spring = HarmonicDriveSpring.tabulate(table(K * x * (1.0 + b * x**2), x))
    at = np.linspace(1e-5, 1.95e-3, 500)
    load, stiffness = spring.curve.derivatives(at, 1)
    np.testing.assert_allclose(load, K * at * (1.0 + b * at**2), rtol=5e-4)
    np.testing.assert_allclose(stiffness, K * (1.0 + 3.0 * b * at**2), rtol=1e-2)


@pytest.mark.parametrize("seed", range(20))
def test_any_rising_table_gives_a_rising_curve_through_its_points(seed):
    """Random steps of the stiffness over decades: the curve stays increasing and smooth, with slopes of
    PCHIP."""
    torque, angle = random_table(np.random.default_rng(seed), 30)
    d = table(torque, angle)
    curve = torque_curve(d)
    np.testing.assert_allclose(curve.derivatives(angle, 0)[0], torque, rtol=SAME)
    inside = np.linspace(0.0, 1.1 * angle[-1], 20001)
    K = curve.derivatives(inside, 1)[1]
    assert np.all(K > 0.0)
    assert np.max(K) < 0.5 * d.K_FTS * (1.0 + 1e-2)  # sampled at other places
    both = np.concatenate([-angle[::-1], [0.0], angle]), np.concatenate([-torque[::-1], [0.0], torque])
    scipy = PchipInterpolator(*both).derivative()(angle[:-1])
    np.testing.assert_allclose(curve.stiffness[1:-1], scipy, rtol=1e-9)


def test_a_table_is_odd_and_goes_on_with_its_last_stiffness():
    torque, angle = random_table(np.random.default_rng(1), 12)
    spring = HarmonicDriveSpring.tabulate(table(torque, angle))
    np.testing.assert_allclose(spring.evaluate_torque(-torque)["phi_rel"], -angle, rtol=SAME)
    end = spring.curve.stiffness[-1]
    beyond = spring.evaluate_torque(torque[-1] + 5.0)
    assert float(beyond["phi_rel"]) == pytest.approx(angle[-1] + 5.0 / end, rel=SAME)
    assert float(beyond["K_WTS"]) == pytest.approx(end)


@pytest.mark.parametrize(
    ("torque", "angle", "text"),
    [
        ((1.0, 3.0, 2.0), (1e-4, 2e-4, 3e-4), r"table.torque\[2\] = 2 N.m is outside \(3, inf\)"),
        ((1.0, 2.0, 3.0), (1e-4, 2e-4, 2e-4), r"table.angle\[2\] = 0.0002 rad is outside \(0.0002, inf\)"),
        ((0.0, 2.0), (1e-4, 2e-4), r"torque\[0\] = 0 N.m is outside \(0, inf\)"),
        ((1.0, 2.0), (1e-4,), "have 2 and 1 numbers; expected the same number, from 2 to 1000"),
        ((1.0,), (1e-4,), "have 1 and 1 numbers"),
    ],
)
def test_tables_that_do_not_rise_are_refused(torque, angle, text):
    with pytest.raises(ValueError, match=text):
        table(torque, angle)


# both, as other laws


@pytest.mark.parametrize("law", ["catalogue", "table"])
def test_files_are_read_and_written(law, tmp_path):
    file = load_default("harmonic_drive", law)
    path = tmp_path / "drive.toml"
    path.write_text(format_parameter_file(file), encoding="utf-8")
    assert load_parameter_file(path) == file
    assert file.law == law
    assert judge_joint_stiffness(file).stiffness_comparison is None  # there is no interface to judge


@pytest.mark.parametrize("law", ["catalogue", "table"])
def test_a_file_without_an_interface_says_so(law, capsys):
    path = KINDS["harmonic_drive"].default_file(law)
    line = refused_line(capsys, "law", "hu2023", "--pressure", "1e6", "--params", path)
    assert f"law = {law!r} is not the law of an interface" in line


@pytest.mark.slow
@pytest.mark.parametrize(
    ("law", "given"),
    [
        ("catalogue", {"K1": "+-20%", "K2": "+-20%", "T1": "+-20%", "corner": "0.002..0.1", "tau": "+-20%"}),
        ("table", {"d": "+-10%", "tau": "+-20%"}),
    ],
)
def test_uncertainty(law, given):
    task = define_joint_study(load_default("harmonic_drive", law), given, None, 33)
    points = propagate.draw_independent_point_sets(task, 64, 5)[0]
    assert propagate.compute_bands(task, points).refused_samples.refused_count == 0
    file = task.run_evaluator.parameter_file
    for settings in task.list_run_settings(points)[:4]:
        columns = task.run_evaluator.evaluate_sample(settings)
        values = {k: v for k, v in settings.items() if k != "tau"}
        drive = build_parameter_set(type(file.values), {**file.values_by_name, **values})
        exact = HarmonicDriveSpring.tabulate(replace(drive, hysteresis_loss=0.0)).evaluate_torque(
            columns["tau"]
        )
        for name in ("K_WTS", "phi_rel"):
            np.testing.assert_allclose(columns[name], exact[name], rtol=1e-8)


def test_the_fractal_drive_as_a_table_is_near_it():
    """The shipped table represents a measurement: 19 points of the default drive."""
    file, exact = load_default("harmonic_drive", "table"), torque_curve(load_default("harmonic_drive").values)
    points = file.values.table
    np.testing.assert_allclose(exact.inverse(points.torque), points.angle, rtol=1e-5)  # six digits
    torque = np.linspace(1.0, 30.0, 100)
    np.testing.assert_allclose(torque_curve(file.values).inverse(torque), exact.inverse(torque), rtol=2e-3)


def test_tuned_parameters_are_those_of_the_law():
    kind = KINDS["harmonic_drive"]
    spring = kind.models[0].with_parameters("harmonic_drive", drive())
    assert {"K1", "K2", "K3", "T1", "T2", "corner", "ratio", "d"} <= set(spring.parameter_fields())
    assert replace_values(drive(), {"K1": 9e3}).K1 == 9e3
    measured = kind.models[0].with_parameters("harmonic_drive", table((1.0, 2.0), (1e-4, 2e-4)))
    assert not any(name.startswith("table") for name in measured.parameter_fields())


def test_names_stand_for_the_rows():
    assert {name_of(row) for row in ROWS} <= {item.joint_name for item in catalogue.list_drives()}


def test_lost_motion_adds_to_the_lines_and_a_measured_curve_has_it_already():
    plain, loose = (HarmonicDriveSpring.tabulate(drive(lost_motion=x)) for x in (0.0, 2e-4))
    rated = plain.joint.rated_torque
    T = rated * np.array([0.002, 0.005, 0.013, 0.04, 0.08, 0.3, 1.0])
    play = 1e-4 * np.tanh(T / (0.01 * rated))
    found = loose.evaluate_torque(T)
    before = plain.evaluate_torque(T)
    # the spline between nodes of the play, as `PLAY_NODE_COUNT` says
    assert found["phi_rel"] - before["phi_rel"] == pytest.approx(play, abs=1e-8 * rated / 1e4)
    slope = 1e-4 * (1.0 - np.tanh(T / (0.01 * rated)) ** 2) / (0.01 * rated)
    assert 1.0 / found["K_WTS"] == pytest.approx(1.0 / before["K_WTS"] + slope, rel=1e-5)
    with pytest.raises(
        ValueError, match=r"^lost_motion = 0.0002 rad is outside \[0, 0\]: the measured midline"
    ):
        replace(load_default("harmonic_drive", "table").values, lost_motion=2e-4)
    with pytest.raises(
        ValueError, match=r"^lost_motion = 0.0002 rad is outside \[0, 0\]: with lost motion, T1 must be above"
    ):
        drive(lost_motion=2e-4, rated_torque=1e3)
