"""Fits of measured curves: round trips, undetermined parameters, loops, faulty files."""

import json
from dataclasses import replace
from time import process_time

import numpy as np
import pytest
from conftest import refused_line
from jointfmu_tools import cli
from jointfmu_tools.common import columns
from jointfmu_tools.inputs.fitting.backbone import find_backbone
from jointfmu_tools.inputs.fitting.least_squares import Unknown, solve_least_squares
from jointfmu_tools.joints.bolted_joint.fit import preload
from jointfmu_tools.joints.harmonic_drive.fit import torque_angle
from jointfmu_tools.joints.harmonic_drive.fit.drive import compute_wind_up
from oracles import curve_measurements as measurements
from oracles.joint_measurements import save
from surroundings import environment

from jointfmu.joints.bolted_joint.joint import BoltedJointSpring
from jointfmu.parameters import format_parameter_file, load_default, load_parameter_file

pytestmark = pytest.mark.slow

ARCMIN = np.pi / 10800.0


@pytest.fixture
def loops(tmp_path):
    torque, angle = measurements.loops(np.random.default_rng(1))
    return save(tmp_path / "loops.csv", "torque [N.m], angle [arcmin]", torque, angle / ARCMIN)


@pytest.fixture
def stiffness(tmp_path):
    columns = measurements.preload_series(np.random.default_rng(1), "stiffness", 0.02)
    return save(tmp_path / "stiffness.csv", "preload [N], stiffness [N/m]", *columns)


# Least squares


def test_a_line_has_its_textbook_covariance():
    """For ln y = ln a + b ln x the covariance is noise^2 (X^T X)^-1 with the columns 1 and b ln x."""
    rng, x = np.random.default_rng(1), np.geomspace(1.0, 10.0, 50)
    y = np.log(3.0 * x**0.7) + 0.01 * rng.standard_normal(x.size)
    unknowns = [Unknown("a", "1", 1.0, 0.0, np.inf), Unknown("b", "1", 1.0, 0.0, np.inf)]
    found = solve_least_squares(unknowns, lambda v: np.log(v["a"] * x ** v["b"]) - y)
    b, ln_a = np.polyfit(np.log(x), y, 1)
    # the ridge is 1e-4 of a data point's weight, the data count 50
    assert found.values["b"] == pytest.approx(b, rel=1e-4)
    assert np.log(found.values["a"]) == pytest.approx(ln_a, rel=1e-4)
    X = np.stack([np.ones_like(x), b * np.log(x)], axis=1)
    expected = found.noise**2 * np.linalg.inv(X.T @ X)
    np.testing.assert_allclose(found.covariance, expected, rtol=1e-3)


@pytest.mark.parametrize("case", measurements.CASES)
def test_round_trip(case, tmp_path):
    """A small version of the script's 100 seeds: by chance 1 % of the fits are outside three deviations."""
    found = [measurements.errors(measurements.CASES[case], seed, tmp_path) for seed in range(2)]
    assert all(abs(z) <= 3.0 for one in found for _, z in one.values())
    assert all(abs(error) < 0.6 for one in found for error, _ in one.values())


# Torque-angle


def test_loop_is_taken_apart(loops):
    """The fit finds what the script added to the loop: drift 0.3 arcmin, offset 5 arcmin."""
    facts = torque_angle.fit(loops).facts
    torque, angle = measurements.loops(np.random.default_rng(1), noise=0.0, drift=0.0)
    (fall, up), (rise, down) = (
        (torque[k][::way], angle[k][::way]) for k, way in ((slice(200, 400), -1), (slice(400, 600), 1))
    )
    grid = np.linspace(-24.0, 24.0, 2001)
    gap = np.interp(grid, fall, up) - np.interp(grid, rise, down)
    expected = {"backlash": gap[1000], "loop_area": 0.024 * np.sum(gap), "drift": 0.3 * ARCMIN}
    for name, value in expected.items():
        # four standard deviations, and the loss of a gap that is a polygon of 40 pieces, or a parabola
        assert abs(facts[name][0] - value) < 4.0 * facts[f"{name}_deviation"][0] + 5e-3 * value, name
    assert facts["offset"][0] == pytest.approx(5.0 * ARCMIN, abs=0.01 * ARCMIN)
    assert facts["noise"][0] == pytest.approx(0.03 * ARCMIN, rel=0.1)


def test_the_loop_of_a_drive_has_its_midline():
    """At the tips of the loop friction acts on both branches, so their mean deviates by half the gap at zero
    torque."""
    line = find_backbone(*measurements.loops(np.random.default_rng(1), noise=0.0, drift=0.0))
    drive = load_default("harmonic_drive").with_values(measurements.DRIVE, "user", "true").values
    rest = line.angle - 5.0 * ARCMIN - compute_wind_up(drive, line.torque)
    # 0.5 mN m of noise in the torque moves the angle by 2e-3 arcmin where the drive is soft
    assert np.max(np.abs(rest)) < 0.01 * ARCMIN


def test_torque_before_angle_before_unit(loops, tmp_path):
    """Units and column order are those of the heading; other columns are ignored."""
    torque, arcmin = np.loadtxt(loops, delimiter=",", skiprows=1).T
    other = tmp_path / "other.csv"
    text = [
        f"{i};{a / 60.0:.12g};{T * 1e3:.12g}" for i, (T, a) in enumerate(zip(torque, arcmin, strict=True))
    ]
    other.write_text("# drive 7\ntime [s]; Angle [deg]; Torque [mN.m]\n" + "\n".join(text))
    one, two = torque_angle.fit(loops).solution.values, torque_angle.fit(other).solution.values
    assert two == pytest.approx(one, rel=1e-5)  # twelve digits, and the end of the fit


def test_one_direction_has_no_loop():
    drive = load_default("harmonic_drive").values
    torque = np.linspace(0.0, 20.0, 100)
    line = find_backbone(torque, compute_wind_up(drive, torque))
    assert (line.loop_area, line.backlash, line.drift) == (None, None, None)
    np.testing.assert_array_equal(line.torque, torque)


def test_single_open_loop_has_no_drift():
    drive = load_default("harmonic_drive").values
    torque = np.concatenate([np.linspace(-9.0, 9.0, 200), np.linspace(9.0, -9.0, 200)])
    gap = 1e-4 * np.repeat([-0.5, 0.5], 200) * (1.0 - (torque / 9.0) ** 2)
    line = find_backbone(torque, compute_wind_up(drive, torque) + gap)
    assert line.drift is None
    assert line.backlash[0] == pytest.approx(1e-4, rel=0.01)
    assert line.loop_area[0] == pytest.approx(2.0 / 3.0 * 1e-4 * 18.0, rel=0.01)


def test_what_is_not_determined_is_said_by_name(loops):
    """The result names the undetermined combination: drive_scale and mean_over_peak act only as a product."""
    found = torque_angle.fit(loops, fitted_names=[*torque_angle.DEFAULT_FITTED_PARAMETERS, "mean_over_peak"])
    rows = {row["name"]: row["determined"] for row in found.list_fitted_parameters()}
    assert rows == {
        "K_FTS0": True,
        "drive_scale": False,
        "zero_torque_pressure": True,
        "mean_over_peak": False,
    }
    assert (
        "the data do not determine drive_scale, mean_over_peak: other values fit as well" in found.warnings()
    )
    known = torque_angle.fit(loops).solution.values
    mean = load_default("harmonic_drive").values.mean_over_peak
    product = found.solution.values["drive_scale"] * found.solution.values["mean_over_peak"] / mean
    assert product == pytest.approx(known["drive_scale"], rel=1e-4)


def test_a_small_range_leaves_the_end_open(tmp_path):
    """Data up to 2 N.m leave K_FTS0 undetermined, on which they hardly depend."""
    torque, angle = measurements.loops(np.random.default_rng(1), amplitude=2.0, gap=0.0)
    path = save(tmp_path / "small.csv", "torque [N.m], angle [rad]", torque, angle)
    assert "K_FTS0" in torque_angle.fit(path).warnings()[0]


def test_another_size_of_drive(tmp_path):
    """A drive 50 times as stiff at 50 times the torque has the same wind-up."""
    torque, angle = measurements.loops(np.random.default_rng(1))
    path = save(tmp_path / "big.csv", "torque [N.m], angle [rad]", 50.0 * torque, angle)
    found = torque_angle.fit(path, rated_torque=250.0)
    assert found.parameters.values.max_torque == pytest.approx(1500.0)
    assert found.solution.values["K_FTS0"] == pytest.approx(50.0 * measurements.DRIVE["K_FTS0"], rel=0.1)


def test_written_file_says_where_it_comes_from(loops, tmp_path, enter, capsys):
    enter(environment(SOURCE_DATE_EPOCH="1767225600"))
    out, picture = tmp_path / "drive.toml", tmp_path / "fit.png"
    assert (
        cli.main(["fit", "torque-angle", str(loops), "--out", str(out), "--plot", str(picture), "--json"])
        == 0
    )
    document = json.loads(capsys.readouterr().out)
    file = load_parameter_file(out, "harmonic_drive")
    assert {
        n for n, s in file.sources.items() if s.startswith("fitted to loops.csv, 2026-01-01, torque -2")
    } == {*torque_angle.DEFAULT_FITTED_PARAMETERS}
    assert {file.origins[name] for name in torque_angle.DEFAULT_FITTED_PARAMETERS} == {"calibration"}
    assert document["parameters"]["K_FTS0"] == file.values.K_FTS0
    assert picture.read_bytes().startswith(b"\x89PNG")


# Preload


@pytest.mark.parametrize("direction", ["normal", "tangential"])
def test_joint_stiffness_is_the_exported_one(direction):
    """The stiffness of the fit equals that of the FMU, also at 20 N preload, where most nodes still close."""
    joint = load_default("bolted_joint").values
    spring = BoltedJointSpring.from_interface_nodes(replace(joint, memory=False))
    loads = np.array([20.0, 2e3, 3e4])
    name = {"normal": "K_zz", "tangential": "K_xx"}[direction]
    exported = [spring.evaluate(load, 0.0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))[name] for load in loads]
    # the table's error
    np.testing.assert_allclose(preload.compute_joint_stiffness(joint, loads, direction), exported, rtol=1e-8)


def test_area_has_no_effect(stiffness):
    """The law depends on loads, not on pressures, so another start value of the area stays unchanged."""
    start = load_default("bolted_joint").with_values({"A_0": 0.05}, "user", "test")
    found = preload.fit(stiffness, start, ["surface.D", "surface.G", "A_0"])
    rows = {row["name"]: row["determined"] for row in found.list_fitted_parameters()}
    assert rows == {"surface.D": True, "surface.G": True, "A_0": False}
    assert found.solution.values["A_0"] == pytest.approx(0.05, rel=0.01)  # held by the ridge


def test_frequencies_without_a_stated_mass_fit_the_mass(tmp_path):
    path = save(
        tmp_path / "f.csv",
        "preload [N], frequency [Hz]",
        *measurements.preload_series(np.random.default_rng(1), "frequency", 1e-3),
    )
    found = preload.fit(path, load_default("bolted_joint"))
    assert set(found.solution.values) == {"surface.D", "mass"}
    assert any("state the modal mass" in line for line in found.warnings())


def test_series_stiffness_is_in_series(tmp_path):
    """Joint and structure act in series: the stiffness is K/2 if both have the stiffness K."""
    joint = load_default("bolted_joint").values
    P = np.array([1e4])
    K = float(preload.compute_joint_stiffness(joint, P)[0])
    assert preload.PreloadCurve("stiffness", P, P).predict_quantity(joint, K, "normal") == pytest.approx(
        [K / 2.0]
    )


# Bad data

HEADING = "torque [N.m], angle [rad]"
GOOD = [f"{T},{T / 5e3}" for T in np.linspace(-5.0, 5.0, 20)]
FALLING = [f"{T},{-T / 5e3}" for T in np.linspace(-5.0, 5.0, 20)]
WAVY = [f"{T},{np.sin(T)}" for T in np.linspace(0.0, 6.0, 40)]
LEADING = [
    f"{T},{T / 5e3 + way * 1e-4 * (1 - (T / 5) ** 2)}"
    for way in (1, -1, 1, -1)
    for T in way * np.linspace(-5.0, 5.0, 40)
]
UNITS = [
    ("Nm", 1.0, "°", 180.0 / np.pi),
    ("kgf.m", 1.0 / 9.80665, "\u2032", 10800.0 / np.pi),
    ("N·cm", 100.0, "urad", 1e6),
]
BAD = {
    "no text": (b"\xff\xfe\x00\x01", "is not a text file"),
    "empty": ("# nothing", "is empty; expected columns torque [N.m"),
    "no heading": (GOOD, "the first line is"),
    "no unit": ("torque, angle [rad]", "column 'torque' has no unit"),
    "foreign unit": ("torque [lbf.in], angle [rad]", "unit 'lbf.in', allowed are N.m, mN.m, kN.m"),
    "one column": (["torque [N.m], other [rad]", *GOOD], "has no column 'angle'; expected angle [rad"),
    "twice": ("torque [N.m], torque [N.m], angle [rad]", "given twice"),
    "few": ([HEADING, *GOOD[:9]], "has 9 rows of numbers, at least 10 are needed"),
    "nan": ([HEADING, *GOOD, "nan,1"], "line 22: torque = 'nan' is not a finite"),
    "ragged": ([HEADING, *GOOD, "1"], "line 22 has 1 columns, expected 2"),
    "constant": ([HEADING, *["2,1"] * 12], "torque is 2 N.m throughout"),
    "reversed": ([HEADING, *FALLING], "reverse the sign of one column"),
    "wavy": ([HEADING, *WAVY], "does not rise with the torque between"),
    "huge": (
        [HEADING.replace("rad", "deg"), *[f"{T},{100 * T}" for T in np.linspace(-5, 5, 20)]],
        "likely the angle is in arcsec, where the heading says deg",
    ),
    "degrees": (
        [HEADING, *[f"{T},{np.degrees(T / 4e3)}" for T in np.linspace(-25, 25, 20)]],
        "likely the angle is in deg, where the heading says rad; if the units are right, start from",
    ),
    "stiff": (
        [HEADING.replace("rad", "arcsec"), *[f"{T},{0.1 * T}" for T in np.linspace(-5, 5, 20)]],
        "1e-05 to",
    ),
    "leading": ([HEADING, *LEADING], "the loop creates energy, loop_area = -"),
    "far": ([HEADING, *[f"{T},{T}" for T in range(40)]], "(--rated-torque)"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_torque_angle(case, tmp_path, capsys):
    text, message = BAD[case]
    path = tmp_path / "bad.csv"
    text = text if isinstance(text, str | bytes) else "\n".join(text)
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    line = refused_line(capsys, "fit", "torque-angle", path)
    assert str(path) in line
    assert message in line


@pytest.mark.parametrize(("force", "times", "turn", "by"), UNITS)
def test_units_of_a_record_do_not_matter(force, times, turn, by, tmp_path):
    found = []
    for head, x, y in ((HEADING, 1.0, 1.0), (f"torque [{force}], angle [{turn}]", times, by)):
        path = tmp_path / "curve.csv"
        rows = (f"{T * x!r},{(T / 5e3 - T**3 / 1e6) * y!r}" for T in np.linspace(-5.0, 5.0, 30).tolist())
        path.write_text("\n".join([head, *rows]))
        found.append(columns.read_columns(path, torque_angle.COLUMN_UNITS, 10).values_by_name)
    for name, column in found[0].items():
        assert found[1][name] == pytest.approx(column, rel=1e-14, abs=1e-18)


def test_titles_are_those_of_loops(tmp_path):
    path = tmp_path / "curve.csv"
    rows = (f"{T / 5e3 - T**3 / 1e6};{T}" for T in np.linspace(-5.0, 5.0, 30))
    path.write_text("\n".join(["Winkel (rad);Drehmoment / Nm", *rows]))
    assert torque_angle.read_torque_angle_curve(path, None, None).midline.torque == pytest.approx(
        np.linspace(-5.0, 5.0, 30)
    )


RISING = ["1e3,1e9", "2e3,2e9", "3e3,3e9", "4e3,4e9"]


@pytest.mark.parametrize(
    ("rows", "options", "message"),
    [
        ((*RISING, "-5e3,5e9"), (), "preload = -5000 N is outside (0, inf)"),
        ((*RISING, "5e3,0"), (), "stiffness = 0 N/m is outside (0, inf)"),
        (
            RISING[:1],
            ("--free", "surface.D", "surface.G"),
            "has 1 different preloads, too few for surface.D and",
        ),
        ([*RISING[:1]] * 3, ("--free", "surface.D", "surface.G"), "at least 2 are needed"),
        (("1e3,4e9", "2e3,3e9", "3e3,2e9", "4e3,1e9"), (), "falls with the preload"),
        (RISING, ("--free", "surface.D", "surface.G", "H", "A_0"), "too few for 4 unknowns"),
        (RISING, ("--free", "surface.X"), "'surface.X' is not a parameter to fit"),
        (RISING, ("--free", "Surface.G"), "(did you mean surface.G?); allowed are surface.D"),
        (RISING, ("--free", "h"), "'h' is a parameter of the law roughness, but"),
        (RISING, ("--free", "H", "H"), "'H' is given twice"),
        (RISING, ("--modal-mass", "5"), "the file has stiffnesses; leave it out"),
        (RISING, ("--series-stiffness", "-1"), "series stiffness = -1 N/m is outside (0, inf)"),
        (RISING, ("--plot", "fit.pdf"), "'.pdf' is not that of a picture"),
    ],
)
def test_bad_preload(rows, options, message, tmp_path, capsys):
    path = tmp_path / "bad.csv"
    path.write_text("\n".join(["preload [N], stiffness [N/m]", *rows]))
    assert message in refused_line(capsys, "fit", "preload", path, "--params", started(tmp_path), *options)


def started(folder):
    """Parameter file of the default joint."""
    path = folder / "start.toml"
    path.write_text(format_parameter_file(load_default("bolted_joint")))
    return path


def test_the_joint_to_start_from_must_be_stated(tmp_path, capsys):
    """Without a start file the fit would use the specimen of a paper, whose bolts and area are not the
    user's."""
    path = tmp_path / "stiffness.csv"
    path.write_text("\n".join(["preload [N], stiffness [N/m]", *RISING]))
    line = refused_line(capsys, "fit", "preload", path)
    assert "the joint to start from is missing; state its parameter file (--params)" in line


@pytest.mark.parametrize("quantity", ["stiffness", "frequency"])
def test_one_measured_number_fits_the_level(tmp_path, quantity):
    """For a joint twice as stiff, the exponent is unchanged and the law passes through the point."""
    start = load_default("bolted_joint")
    P = np.array([12e3])
    K = 2.0 * float(preload.compute_joint_stiffness(start.values, P)[0])
    value = K if quantity == "stiffness" else np.sqrt(K / 50.0) / (2.0 * np.pi)
    unit = {"stiffness": "N/m", "frequency": "Hz"}[quantity]
    path = save(tmp_path / "one.csv", f"preload [N], {quantity} [{unit}]", P, np.array([value]))
    found = preload.fit(path, start, modal_mass=None if quantity == "stiffness" else 50.0)
    assert set(found.solution.values) == {"surface.G"}
    assert preload.compute_joint_stiffness(found.parameters.values, P) == pytest.approx([K], rel=1e-4)
    assert found.rejection_reason() is None
    assert any("one preload does not determine the exponent: surface.D" in line for line in found.warnings())
    scatter = "5 % for each stiffness" if quantity == "stiffness" else "0.5 % for each frequency"
    assert any(line.startswith("one point is too few") and scatter in line for line in found.warnings())
    assert "power" not in found.facts


def test_one_measured_number_sets_the_height_of_a_roughness(tmp_path):
    start = rough_joint()
    P = np.array([12e3])
    K = 0.5 * float(preload.compute_joint_stiffness(start.values, P)[0])
    path = save(tmp_path / "one.csv", "preload [N], stiffness [N/m]", P, np.array([K]))
    found = preload.fit(path, start)
    assert found.solution.values["h"] == pytest.approx(2.0 * start.values.h, rel=0.05)
    assert found.rejection_reason() is None


def test_measured_stiffnesses_set_the_level_of_a_table(tmp_path):
    start, P = load_default("bolted_joint", "table"), np.array([4e3, 12e3])
    path = save(
        tmp_path / "k.csv",
        "preload [N], stiffness [N/m]",
        P,
        1.4 * preload.compute_joint_stiffness(start.values, P),
    )
    found = preload.fit(path, start)
    assert found.solution.values == pytest.approx({"table.factor": 1.4}, rel=1e-6)


def rough_joint():
    """The default joint with the law `roughness`."""
    from jointfmu.joints.bolted_joint import KIND
    from jointfmu.parameters import ParameterFile
    from jointfmu.quantity import build_parameter_set, flatten_fields

    known = load_default("bolted_joint").values_by_name
    known = {"h": 1e-6, "gamma": 0.45, "longest_wave": 0.8e-3, "hurst": 0.8, "slope": 0.1, **known}
    cls = KIND.laws["roughness"]
    values = {name: known[name] for name, _ in flatten_fields(cls) if name in known}
    return ParameterFile("bolted_joint", "rough", build_parameter_set(cls, values), {}, {})


def test_two_measured_numbers_fit_level_and_exponent(tmp_path):
    start = load_default("bolted_joint")
    truth = start.with_values({"surface.D": 1.3, "surface.G": 3e-8}, "user", "test").values
    P = np.array([3e3, 20e3])
    path = save(
        tmp_path / "two.csv", "preload [N], stiffness [N/m]", P, preload.compute_joint_stiffness(truth, P)
    )
    found = preload.fit(path, start)
    assert found.solution.values == pytest.approx({"surface.D": 1.3, "surface.G": 3e-8}, rel=0.01)


def test_a_file_without_stiffness_and_frequency_is_refused(tmp_path, capsys):
    path = tmp_path / "bad.csv"
    path.write_text("preload [N],f1 [Hz],f2 [Hz]\n1,2,3\n2,3,4\n")
    line = refused_line(capsys, "fit", "preload", path, "--params", started(tmp_path))
    assert "neither of stiffness and frequency, its columns are preload, f1, f2;" in line


def test_a_few_frequencies_determine_more_than_stiffnesses_do(tmp_path):
    """The assumed 0.5 % of a frequency are 1 % of the stiffness f^2; a stiffness is assumed to have 5 %."""
    start, P = rough_joint(), np.array([6e3, 12e3])
    K = preload.compute_joint_stiffness(start.values, P)
    stiffness_file = save(tmp_path / "k.csv", "preload [N], stiffness [N/m]", P, K)
    frequency_file = save(
        tmp_path / "f.csv", "preload [N], frequency [Hz]", P, np.sqrt(K / 50.0) / (2.0 * np.pi)
    )
    by_stiffness = preload.fit(stiffness_file, start).solution.relative_deviations["h"]
    by_frequency = preload.fit(frequency_file, start, modal_mass=50.0).solution.relative_deviations["h"]
    assert by_stiffness / by_frequency == pytest.approx(5.0, rel=0.05)


@pytest.mark.parametrize("points", [2, 8])
def test_a_structure_in_series_shows_in_the_power_of_the_preload(tmp_path, points):
    start, P = rough_joint(), np.geomspace(4e3, 20e3, points)
    alone = preload.compute_joint_stiffness(start.values, P)
    series = float(alone[0])
    path = save(tmp_path / "k.csv", "preload [N], stiffness [N/m]", P, 1.0 / (1.0 / alone + 1.0 / series))
    rigid, stated = preload.fit(path, start), preload.fit(path, start, series_stiffness=series)
    fitted = preload.compute_joint_stiffness(rigid.parameters.values, P)
    power = np.polyfit(np.log(P), np.log(fitted), 1)[0]
    assert rigid.facts["power_law"][0] == pytest.approx(power, rel=1e-6)
    assert rigid.facts["power"][0] < 0.8 * power
    (note,) = (line for line in rigid.notes if "power" in line)
    assert "--series-stiffness" in note
    assert not any("power" in line for line in stated.notes)


def test_german_headings_of_a_preload_curve(tmp_path):
    P, f = np.array([10.0, 40.0]), np.array([1210.0, 1385.0])
    english = preload.fit(save(tmp_path / "e.csv", "preload [kN],frequency [Hz]", P, f), rough_joint())
    german = preload.fit(save(tmp_path / "d.csv", "Vorspannkraft [kN],Frequenz [Hz]", P, f), rough_joint())
    assert german.solution.values == english.solution.values


def test_zero_cannot_be_fitted(loops, capsys):
    line = refused_line(capsys, "fit", "torque-angle", loops, "--free", "eccentricity")
    assert "eccentricity = 0 m cannot be the start value" in line


def test_another_joints_file(loops, tmp_path, capsys):
    path = tmp_path / "bolts.toml"
    path.write_text(format_parameter_file(load_default("bolted_joint")))
    assert "expected a file with joint = 'harmonic_drive'" in refused_line(
        capsys, "fit", "torque-angle", loops, "--params", path
    )


def test_the_mid_line_of_200_000_rows_takes_seconds():
    """The backbone of 200 000 samples is found in seconds: the number of knots is limited (else 3 GB)."""
    rng, phase = np.random.default_rng(0), np.linspace(0.0, 10.0 * np.pi, 200_000)
    torque, friction_torque = 25.0 * np.sin(phase), 0.3
    angle = (torque - friction_torque * np.sign(np.cos(phase))) / 8e3 + 1e-6 * rng.standard_normal(phase.size)
    begin = process_time()
    line = find_backbone(torque, angle)
    assert process_time() - begin < 5.0
    inner = np.abs(line.torque) < 20.0
    np.testing.assert_allclose(line.angle[inner], line.torque[inner] / 8e3, rtol=0.0, atol=1e-6)
