"""FMUs of the harmonic drive: equal to the law, inverse to each other, and with friction."""

import math
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from browser import Browser, browser
from clients import needs
from conftest import made_once
from joint_cases import SAME, TABLE, law, parameters, random_inputs
from jointfmu_tools.joints.harmonic_drive.efficiency import make_test_rig
from jointfmu_tools.joints.harmonic_drive.job import LABORATORY_MODELS
from jointfmu_tools.pages.laboratory.assemble import write_laboratory
from jointfmu_tools.run.ramps import ramp
from jointfmu_tools.systems.master import Slave
from natives import Host, close, jacobian
from scipy.integrate import cumulative_simpson, quad

from jointfmu.joints import MODELS
from jointfmu.joints.harmonic_drive.law import drive_stiffness
from jointfmu.parameters import load_default


def test_parameters_count_until_initialization_ends(fmu: Host) -> None:
    instance = fmu("HarmonicDriveCompliance")
    instance.set_values({"K_FTS0": 1e4})  # before setup: start values may be set right after instantiation
    instance.fmu.setupExperiment(startTime=0.0)
    instance.fmu.enterInitializationMode()
    assert instance.at({"tau": 3.0})["K_FTS"] == pytest.approx(1e4, rel=SAME)
    instance.set_values({"K_FTS0": 3e4})
    assert instance.get("K_FTS", "K_FTS0") == {"K_FTS": pytest.approx(3e4, rel=SAME), "K_FTS0": 3e4}
    instance.fmu.exitInitializationMode()
    expected = law("HarmonicDriveCompliance", parameters("HarmonicDriveCompliance", {"K_FTS0": 3e4}))
    assert instance.get() == pytest.approx(expected({"tau": 3.0}), rel=SAME)


def test_spring_and_compliance_are_inverse(fmu: Host) -> None:
    spring, compliance = fmu("HarmonicDriveSpring").start(), fmu("HarmonicDriveCompliance").start()
    for tau in np.concatenate([np.linspace(-29.9, 29.9, 40), [-1e-6, 1e-9]]):
        wound = compliance.at({"tau": tau})
        found = spring.at({"phi2": wound["phi_rel"]})
        assert found["tau"] == pytest.approx(tau, rel=SAME)
        for stiffness in ("K_WTS", "K_TS", "K_FTS", "K_TS_pair"):
            assert found[stiffness] == pytest.approx(wound[stiffness], rel=SAME)


def test_torques_act_as_the_contract_says(fmu: Host) -> None:
    spring, still = fmu("HarmonicDriveSpring"), fmu("HarmonicDriveSpring")
    spring.start({"ratio": 50.0, "d": 0.7})
    still.start({"ratio": 50.0, "d": 0.7})
    for v in random_inputs("HarmonicDriveSpring", 30, seed=7):
        found = spring.at(v)
        assert found["phi_rel"] == pytest.approx(v["phi2"] - v["phi1"] / 50.0, rel=SAME, abs=1e-18)
        elastic = still.at({"phi2": found["phi_rel"]})["tau"]
        damping = 0.7 * (v["w2"] - v["w1"] / 50.0)
        assert found["tau"] == pytest.approx(elastic + damping, rel=1e-11)  # both ways cancel a little
        assert found["tau1"] == pytest.approx(found["tau"] / 50.0, rel=SAME)
        assert found["tau2"] == -found["tau"]
        parts = 1.0 / found["K_FTS"] + 1.0 / found["K_TS"]
        assert found["K_WTS"] == pytest.approx(1.0 / parts, rel=SAME)
        assert found["K_FTS"] > found["K_WTS"] < found["K_TS"]


def test_the_drive_is_odd_in_torque_and_at_rest_without_load(fmu: Host) -> None:
    spring, compliance = fmu("HarmonicDriveSpring").start(), fmu("HarmonicDriveCompliance").start()
    assert spring.get("tau", "phi_rel") == {"tau": 0.0, "phi_rel": 0.0}
    assert compliance.get("phi_rel") == {"phi_rel": 0.0}
    assert spring.get("K_WTS")["K_WTS"] > 0.0
    for tau in (0.01, 1.0, 20.0):
        there, back = compliance.at({"tau": tau}), compliance.at({"tau": -tau})
        assert back == there | {"phi_rel": -there["phi_rel"]}


def test_torque_against_the_stiffness_of_the_law_without_a_table(fmu: Host) -> None:
    drive, compliance = parameters("HarmonicDriveCompliance"), fmu("HarmonicDriveCompliance").start()

    def rate(T: float) -> float:
        return float(1.0 / drive_stiffness(drive, T)[0])

    for low, high in pairwise((0.0, 0.05, 0.5, 5.0, 29.0)):
        a, b = (compliance.at({"tau": T}) for T in (low, high))
        assert b["K_WTS"] == pytest.approx(1.0 / rate(high), rel=TABLE)
        # QUADPACK to 1e-10, far below what the table may err
        integral = quad(rate, low, high, epsrel=1e-10, limit=200)[0]
        assert b["phi_rel"] - a["phi_rel"] == pytest.approx(integral, rel=TABLE)


def test_the_torque_ramp_agrees_with_scipy(fmus: Path) -> None:
    c = ramp.run_ramp(fmus / "HarmonicDriveCompliance.fmu", "tau", 5.0, 0.01).variable_columns
    assert len(c["tau"]) == 501
    # Simpson's rule at 0.01 N.m, a fifth of the length over which the stiffness bends
    phi = cumulative_simpson(1.0 / c["K_WTS"], x=c["tau"], initial=0.0)
    assert np.max(np.abs(c["phi_rel"] - phi)) < 1e-6 * np.max(np.abs(phi))
    assert c["phi_rel"][0] == 0.0
    assert np.all(np.diff(c["K_WTS"]) > 0.0)  # the drive stiffens


def test_derivatives_keep_the_closed_relations_of_the_drive(host: Host, version: str) -> None:
    ratio, d = 80.0, 0.7
    spring = host("HarmonicDriveSpring", version).start({"ratio": ratio, "d": d})
    compliance = host("HarmonicDriveCompliance", version).start()
    beyond = {"phi1": 0.0, "w1": 0.0, "phi2": 0.05, "w2": 1.0}
    for state in (*random_inputs("HarmonicDriveSpring", 20, seed=33), beyond):
        values, J = spring.at(state), jacobian(spring)
        K = values["K_WTS"]
        assert J["tau", "phi2"] == close(K, 1e-12)
        assert J["tau", "phi1"] == close(-K / ratio, 1e-12)
        assert (J["tau", "w2"], J["tau", "w1"]) == close((d, -d / ratio), 1e-12)
        for moved in state:
            assert J["tau1", moved] == close(J["tau", moved] / ratio, 1e-12)
            assert J["tau2", moved] == -J["tau", moved]
            series = J["K_TS", moved] / values["K_TS"] ** 2 - J["K_WTS", moved] / K**2
            assert abs(series) <= 1e-12 * abs(J["K_WTS", moved]) / K**2
        assert (J["phi_rel", "phi1"], J["phi_rel", "phi2"]) == close((-1.0 / ratio, 1.0), 1e-12)
    assert J["K_WTS", "phi2"] == 0.0  # beyond the table: a straight line
    for tau in (*np.linspace(-29.0, 29.0, 15), 100.0):
        wound, J = compliance.at({"tau": float(tau)}), jacobian(compliance)
        assert J["phi_rel", "tau"] == close(1.0 / wound["K_WTS"], 1e-12)
    assert J["K_WTS", "tau"] == 0.0


# At work: what stands holds, what swings stops, what errs ripples


DRY = {"friction_coulomb": 0.03, "friction_stribeck": 0.02, "stribeck_speed": 5.0}
MOTION, MOTOR = ("phi1", "w1", "phi2", "w2"), 3e-5
"""Input names, and moment of inertia of the motor [kg m2]."""


@pytest.fixture
def path(native: Path) -> Path:
    return native / "fmi2" / "HarmonicDriveSpring.fmu"


def wound_up(path: Path, torque: float) -> float:
    """Wind-up [rad] under a torque [N.m]."""
    with Slave(path.with_name("HarmonicDriveCompliance.fmu"), {"tau": torque}, (), ("phi_rel",)) as drive:
        return drive.get_outputs()[0]


@pytest.mark.parametrize(("dither", "kelvin"), [(0.0, 253.15), (0.1, 253.15), (0.2, 353.15)])
def test_a_drive_at_rest_holds_a_torque_below_its_limit_without_drift(
    path: Path, dither: float, kelvin: float
) -> None:
    """A torque of 0.7 times the friction limit causes no drift in 1e5 steps: motor without current, with and
    without vibration, cold and warm."""
    warmer = kelvin - 293.15
    most, step, steps, period = 0.05 * np.exp(-0.01 * warmer), 1e-4, 100_000, 500
    wound, phi, w = wound_up(path, 0.7 * 100.0 * most), 0.0, 0.0
    places = np.empty(steps)
    wet = 1e-3 * np.exp(0.023 * warmer)
    start = DRY | {"friction_viscous": wet, "temperature": kelvin, "phi2": wound}
    with Slave(path, start, MOTION, ("tau1",)) as drive:
        for k in range(steps):
            (torque,) = drive.get_outputs()
            w += step / MOTOR * (torque + dither * most * np.sin(2.0 * np.pi * k / period))
            phi += step * w
            drive.set_inputs(phi, w, wound + phi / 100.0, w / 100.0)
            drive.do_step(k * step, step)
            places[k] = phi
    assert 0.002 < places[-1] < 0.2  # it has given way to where its friction bears the load
    late = places[steps // 2 :]
    # the oscillation dies out like exp(-friction_viscous t/(2 J)), exp(-83) after half of the steps
    assert np.max(np.abs(late[period:] - late[:-period])) < 1e-12


def swing(path: Path, given: dict[str, float], step: float = 1e-4, steps: int = 40_000) -> np.ndarray:
    """Angle and speed (steps, 2) of a pendulum on the drive, motor without current."""
    link, weight = 0.05, 8.0
    x = np.array([0.0, 0.0, 0.0, 0.0])
    x[0], x[2] = 60.0, 0.6
    found = np.empty((steps, 2))
    start = dict(zip(MOTION, x, strict=True))
    with Slave(path, given | start, MOTION, ("tau1", "tau2")) as drive:
        for k in range(steps):
            tau1, tau2 = drive.get_outputs()
            x[1] += step * tau1 / MOTOR
            x[3] += step * (tau2 - weight * np.sin(x[2])) / link
            x[0], x[2] = x[0] + step * x[1], x[2] + step * x[3]
            drive.set_inputs(*x)
            drive.do_step(k * step, step)
            found[k] = x[2:]
    return found


def test_a_swinging_link_stops_where_friction_holds_it(path: Path) -> None:
    """It stops where its weight torque is below the motor friction times the ratio, not at the bottom."""
    free, braked = swing(path, {}), swing(path, DRY | {"friction_viscous": 1e-3})
    assert np.ptp(free[-10_000:, 0]) > 1.0
    late = braked[-5_000:]
    assert np.max(np.abs(late[:, 1])) < 1e-6
    assert np.ptp(late[:, 0]) < 1e-7
    assert 0.05 < 8.0 * abs(np.sin(late[-1, 0])) < 100.0 * 0.05


def test_the_output_ripples_most_at_half_its_natural_frequency(path: Path) -> None:
    inertia, step = 0.05, 2e-4
    with Slave(path, {}, (), ("K_WTS",)) as drive:
        natural = np.sqrt(drive.get_outputs()[0] / inertia)
    ripple = []
    for part in (0.35, 0.5, 0.65):
        speed = part * natural
        phi2, w2, speeds = 0.0, speed / 100.0, np.empty(20_000)
        with Slave(path, {"error_2": 2e-5, "d": 1.0, "w1": speed, "w2": w2}, MOTION, ("tau2",)) as drive:
            for k in range(speeds.size):
                w2 += step * drive.get_outputs()[0] / inertia
                phi2 += step * w2
                drive.set_inputs(speed * step * (k + 1), speed, phi2, w2)
                drive.do_step(k * step, step)
                speeds[k] = w2
        ripple.append(np.ptp(speeds[-5_000:]))
    assert ripple[1] > 3.0 * max(ripple[0], ripple[2])


# The laboratory turns the drive under load as the bench of the report does


NAME = "HarmonicDriveSpring"
SPEED = 150.0
"""Speed of the wave generator [rad/s]."""


@pytest.fixture(scope="module")
def shown(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    folder = made_once(tmp_path_factory, "page", lambda out: write_laboratory(out / "laboratory.html"))
    with browser() as one:
        one.open(folder / "laboratory.html")
        yield one


SCRIPT = """(async () => {
  const lab = await laboratory;
  await lab.choose("HarmonicDriveSpring", 0);
  for (const [name, value] of Object.entries(lab.about.example.values)) lab.values.set(name, value);
  for (const [name, value] of Object.entries(GIVEN)) lab.values.set(name, value);
  lab.turn.speed_now = SPEED;
  lab.draw();
  const [gain] = lab.turn.gain.series, [torque] = lab.turn.over.series, [error] = lab.turn.wave.series;
  return { loads: gain.x, efficiency: gain.y, torque: torque.y, error: error.y };
})()"""


@pytest.mark.slow
@needs("Chromium")
@pytest.mark.parametrize("ratio", [100.0, -80.0])
def test_efficiency_is_that_of_the_bench(shown: Browser, ratio: float) -> None:
    given = {"ratio": ratio, "hysteresis_loss": 0.0, "error_2": 0.0, "temperature_factor": 1.3}
    found = shown.run(SCRIPT.replace("GIVEN", str(given)).replace("SPEED", str(SPEED)))
    example = LABORATORY_MODELS[NAME].example_values
    assert example
    file = load_default("harmonic_drive").with_values({**example.values, **given}, "user", "a test")
    bench = make_test_rig(MODELS[NAME], file)
    assert len(found["loads"]) > 10
    for load, value in zip(found["loads"], found["efficiency"], strict=True):
        # friction has built up to 1 - exp(-50) in the page, to 1 - exp(-20) on the bench
        assert value == pytest.approx(100.0 * bench.efficiency(SPEED, load), rel=1e-6), load


@pytest.mark.slow
@needs("Chromium")
def test_the_error_comes_twice_a_turn_and_takes_no_work(shown: Browser) -> None:
    amplitude = 1.5e-4
    losses = ("friction_coulomb", "friction_viscous", "load_loss", "load_loss_back", "hysteresis_loss")
    without = dict.fromkeys(losses, 0.0)
    given = without | {"error_2": amplitude}
    found = shown.run(SCRIPT.replace("GIVEN", str(given)).replace("SPEED", str(SPEED)))
    arcmin = math.degrees(1.0) * 60.0
    assert max(found["error"]) == pytest.approx(amplitude * arcmin, rel=2e-3)  # the nearest of 2 deg
    signs = [a * b < 0.0 for a, b in zip(found["error"], found["error"][1:], strict=False)]
    assert sum(signs) == 4
    assert found["efficiency"] == pytest.approx([100.0] * len(found["efficiency"]), rel=1e-6)
    assert max(found["torque"]) - min(found["torque"]) > 0.0
