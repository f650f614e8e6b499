"""Friction and kinematic error in FMUs at work: what stands holds, what swings stops, what errs ripples."""

from pathlib import Path

import numpy as np
import pytest
from jointfmu_tools.systems.master import Slave

DRY = {"friction_coulomb": 0.03, "friction_stribeck": 0.02, "stribeck_speed": 5.0}
MOTION, MOTOR = ("phi1", "w1", "phi2", "w2"), 3e-5
"""Inputs, and inertia of the motor [kg m2]."""


@pytest.fixture
def fmu(native: Path) -> Path:
    return native / "fmi2" / "HarmonicDriveSpring.fmu"


def wound_up(fmu: Path, torque: float) -> float:
    """Wind-up [rad] under a torque [N.m]."""
    with Slave(fmu.with_name("HarmonicDriveCompliance.fmu"), {"tau": torque}, (), ("phi_rel",)) as drive:
        return drive.get()[0]


@pytest.mark.parametrize(("dither", "kelvin"), [(0.0, 253.15), (0.2, 353.15)])
def test_a_drive_at_rest_holds_a_torque_below_its_limit_without_drift(
    fmu: Path, dither: float, kelvin: float
) -> None:
    """0.7 of the limit hangs on a motor without current, which is shaken or not, cold or warm: 1e5 steps."""
    warmer = kelvin - 293.15
    most, step, steps, period = 0.05 * np.exp(-0.01 * warmer), 1e-4, 100_000, 500
    wound, phi, w = wound_up(fmu, 0.7 * 100.0 * most), 0.0, 0.0
    places = np.empty(steps)
    wet = 1e-3 * np.exp(0.023 * warmer)
    start = DRY | {"friction_viscous": wet, "temperature": kelvin, "phi2": wound}
    with Slave(fmu, start, MOTION, ("tau1",)) as drive:
        for k in range(steps):
            (torque,) = drive.get()
            w += step / MOTOR * (torque + dither * most * np.sin(2.0 * np.pi * k / period))
            phi += step * w
            drive.set(phi, w, wound + phi / 100.0, w / 100.0)
            drive.step(k * step, step)
            places[k] = phi
    assert 0.002 < places[-1] < 0.1  # it has given way to where its friction bears the load
    late = places[steps // 2 :]
    # the oscillation dies out like exp(-friction_viscous t/(2 J)), exp(-83) after half of the steps
    assert np.max(np.abs(late[period:] - late[:-period])) < 1e-12


def swing(fmu: Path, given: dict[str, float], step: float = 1e-4, steps: int = 40_000) -> np.ndarray:
    """Angle and speed (steps, 2) of a link in gravity on the drive of a motor without current."""
    link, weight = 0.05, 8.0
    x = np.array([0.0, 0.0, 0.0, 0.0])
    x[0], x[2] = 60.0, 0.6
    found = np.empty((steps, 2))
    start = dict(zip(MOTION, x, strict=True))
    with Slave(fmu, given | start, MOTION, ("tau1", "tau2")) as drive:
        for k in range(steps):
            tau1, tau2 = drive.get()
            x[1] += step * tau1 / MOTOR
            x[3] += step * (tau2 - weight * np.sin(x[2])) / link
            x[0], x[2] = x[0] + step * x[1], x[2] + step * x[3]
            drive.set(*x)
            drive.step(k * step, step)
            found[k] = x[2:]
    return found


def test_a_swinging_link_stops_where_friction_holds_it(fmu: Path) -> None:
    """Not at the bottom: where its weight is less than the friction at the motor times the ratio."""
    free, braked = swing(fmu, {}), swing(fmu, DRY | {"friction_viscous": 1e-3})
    assert np.ptp(free[-10_000:, 0]) > 1.0
    late = braked[-5_000:]
    assert np.max(np.abs(late[:, 1])) < 1e-6
    assert np.ptp(late[:, 0]) < 1e-7
    assert 0.05 < 8.0 * abs(np.sin(late[-1, 0])) < 100.0 * 0.05


def test_the_output_ripples_most_at_half_its_natural_frequency(fmu: Path) -> None:
    inertia, step = 0.05, 2e-4
    with Slave(fmu, {}, (), ("K_WTS",)) as drive:
        natural = np.sqrt(drive.get()[0] / inertia)
    ripple = []
    for part in (0.35, 0.5, 0.65):
        speed = part * natural
        phi2, w2, speeds = 0.0, speed / 100.0, np.empty(20_000)
        with Slave(fmu, {"error_2": 2e-5, "d": 1.0, "w1": speed, "w2": w2}, MOTION, ("tau2",)) as drive:
            for k in range(speeds.size):
                w2 += step * drive.get()[0] / inertia
                phi2 += step * w2
                drive.set(speed * step * (k + 1), speed, phi2, w2)
                drive.step(k * step, step)
                speeds[k] = w2
        ripple.append(np.ptp(speeds[-5_000:]))
    assert ripple[1] > 3.0 * max(ripple[0], ripple[2])
