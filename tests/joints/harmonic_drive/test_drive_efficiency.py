"""Efficiency, starting and back-driving torque by running the FMU: closed forms, the catalogue's values."""

import math
from pathlib import Path

import pytest
from jointfmu_tools.joints.harmonic_drive import job
from jointfmu_tools.joints.harmonic_drive.efficiency import bench, printed_drives, spring_bench
from jointfmu_tools.report.course import Course
from jointfmu_tools.report.joint import write_joint_report

from jointfmu.joints import KINDS, MODELS
from jointfmu.parameters import ParameterFile, default

GREASE = {
    "friction_coulomb": 0.02,
    "friction_stribeck": 0.01,
    "stribeck_speed": 5.0,
    "friction_viscous": 2e-4,
}
GIVEN = GREASE | {"load_loss": 0.12}
SPRING = MODELS["HarmonicDriveSpring"]


@pytest.fixture
def fmu(native: Path) -> Path:
    return native / "fmi2" / "HarmonicDriveSpring.fmu"


@pytest.mark.parametrize("ratio", [100.0, -50.0])
@pytest.mark.parametrize("speed", [3.0, 100.0])
@pytest.mark.parametrize("load", [0.5, 5.0, 20.0])
def test_efficiency_is_that_of_the_torques(fmu: Path, ratio: float, speed: float, load: float) -> None:
    carried = load / abs(ratio)
    no_load = 0.02 + 0.01 * math.exp(-((speed / 5.0) ** 2)) + 2e-4 * speed
    expected = carried / (carried * 1.12 + no_load)
    with bench(fmu, GIVEN | {"ratio": ratio, "lost_motion": 1e-4}) as drive:
        found = drive.efficiency(speed, load)
    assert found == pytest.approx(expected, rel=1e-6)  # |tau| is smooth: tanh(0.5/0.05)
    assert 0.0 < found < 1.0


def test_without_friction_nothing_is_lost_and_nothing_holds(fmu: Path) -> None:
    with bench(fmu, {}) as drive:
        assert drive.efficiency(100.0, 5.0) == pytest.approx(1.0, rel=1e-12)
        assert drive.starting_torque() == 0.0
        assert drive.back_driving_torque(10.0) == 0.0


@pytest.mark.parametrize("ratio", [100.0, -50.0])
def test_back_driving_takes_the_starting_torque_and_what_the_load_adds(fmu: Path, ratio: float) -> None:
    given = GIVEN | {"ratio": ratio}
    with bench(fmu, given) as drive:
        start, back = drive.starting_torque(), drive.back_driving_torque(20.0)
    assert start == pytest.approx(0.03, rel=1e-9)
    assert back == pytest.approx(abs(ratio) * start / (1.0 - 0.12), rel=1e-6)
    with bench(fmu, given | {"load_loss": 1.1}) as drive:
        assert drive.back_driving_torque(20.0) == math.inf


def test_the_report_draws_it(fmu: Path) -> None:
    *curves, back = job.friction(fmu)
    for panel in curves:
        slow, _, fast, *_ = (series.y for series in panel.series)
        assert all(0.0 < b < a < 1.0 for a, b in zip(slow, fast, strict=True))
        assert list(slow) == sorted(slow)
    assert [*back.series[0].titles] == [drive.name for drive in printed_drives()]


def drive_file(**changes: float) -> ParameterFile:
    return default("harmonic_drive").with_values(changes, "user", "test")


@pytest.mark.parametrize("ratio", [100.0, -50.0])
def test_the_python_drive_on_the_bench_is_the_fmu(fmu: Path, ratio: float) -> None:
    given = GIVEN | {"ratio": ratio}
    own = spring_bench(SPRING, drive_file(**given))
    with bench(fmu, given) as drive:
        for speed, load in ((3.0, 0.5), (100.0, 5.0)):
            # the table of the FMU is the same to 1e-9
            assert own.efficiency(speed, load) == pytest.approx(drive.efficiency(speed, load), rel=1e-9)
        assert own.starting_torque() == pytest.approx(drive.starting_torque(), rel=1e-9)
        assert own.back_driving_torque(20.0) == pytest.approx(drive.back_driving_torque(20.0), rel=1e-8)


def test_the_page_of_a_drive_says_what_friction_costs(tmp_path: Path) -> None:
    write_joint_report(tmp_path / "drive.html", drive_file(**GIVEN, ratio=100.0))
    page = (tmp_path / "drive.html").read_text(encoding="utf-8")
    assert "Starting torque of the motor without load: 0.03 N m." in page
    assert f"drives the motor back: {100.0 * 0.03 / 0.88:.4g} N m." in page
    for law in KINDS["harmonic_drive"].laws:  # of a straight line the wind-up is at the bracket's end
        other = default("harmonic_drive", law).with_values(GIVEN, "user", "test")
        bench = spring_bench(SPRING, other)
        for load in (0.2, 1.0, 5.0):
            carried = load / abs(bench.ratio)
            expected = carried / (1.12 * carried + 0.02 + 0.01 * math.exp(-400.0) + 0.02)
            # |tau| is smooth: tanh(0.2/0.1)
            assert bench.efficiency(100.0, load) == pytest.approx(expected, rel=1e-2), (law, load)
    write_joint_report(tmp_path / "plain.html", drive_file())
    assert "None with these parameters" in (tmp_path / "plain.html").read_text(encoding="utf-8")


def test_a_law_that_reaches_twice_as_far_has_twice_the_ramp() -> None:
    model = MODELS["HarmonicDriveCompliance"]
    course = Course(model, drive_file(max_torque=2.0 * default("harmonic_drive").values.max_torque))
    assert course.end == pytest.approx(2.0 * model.ramp.end, rel=1e-9)
