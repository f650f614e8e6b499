"""Efficiency, starting and back-driving torque by running the FMU: closed forms, the catalogue's values."""

import math
from pathlib import Path

import pytest
from jointfmu_fmu_src.joints.harmonic_drive import figures
from jointfmu_fmu_src.joints.harmonic_drive.efficiency import bench, catalogue

GREASE = {
    "friction_coulomb": 0.02,
    "friction_stribeck": 0.01,
    "stribeck_speed": 5.0,
    "friction_viscous": 2e-4,
}
GIVEN = GREASE | {"load_loss": 0.12}


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


def test_catalogue_drives(fmu: Path) -> None:
    """Starting torque by construction; back-driving where the model leaves room for it, else within 5 %."""
    for drive in catalogue():
        with bench(fmu, drive.parameters) as found:
            start, back = found.starting_torque(), found.back_driving_torque(20.0)
        assert start == pytest.approx(drive.starting_torque, rel=1e-9)
        met = drive.parameters["load_loss"] > 0.0
        assert back == pytest.approx(drive.back_driving_torque, rel=1e-6 if met else 0.05)


def test_the_report_draws_it(fmu: Path) -> None:
    *curves, back = figures.friction(fmu)
    for panel in curves:
        slow, _, fast = (series.y for series in panel.series)
        assert all(0.0 < b < a < 1.0 for a, b in zip(slow, fast, strict=True))
        assert list(slow) == sorted(slow)
    assert [*back.series[0].titles] == [drive.name for drive in catalogue()]
