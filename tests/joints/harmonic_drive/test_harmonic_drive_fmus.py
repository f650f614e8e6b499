"""The FMUs of the harmonic drive: equal to its law, inverse to each other, and as the contract says."""

from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from conftest import Fmu
from joint_cases import SAME, TABLE, law, parameters, random_inputs
from jointfmu_tools.ramps import ramp
from scipy.integrate import cumulative_simpson, quad

from jointfmu.joints.harmonic_drive.law import drive_stiffness

Host = Callable[..., Fmu]


def test_parameters_count_until_initialization_ends(fmu: Host) -> None:
    instance = fmu("HarmonicDriveCompliance")
    instance.set({"K_FTS0": 1e4})  # before setup: start values may be set right after instantiation
    instance.fmu.setupExperiment(startTime=0.0)
    instance.fmu.enterInitializationMode()
    assert instance.at({"tau": 3.0})["K_FTS"] == pytest.approx(1e4, rel=SAME)
    instance.set({"K_FTS0": 3e4})
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
    c = ramp.run(fmus / "HarmonicDriveCompliance.fmu", "tau", 5.0, 0.01).columns
    assert len(c["tau"]) == 501
    # Simpson's rule at 0.01 N.m, a fifth of the length over which the stiffness bends
    phi = cumulative_simpson(1.0 / c["K_WTS"], x=c["tau"], initial=0.0)
    assert np.max(np.abs(c["phi_rel"] - phi)) < 1e-6 * np.max(np.abs(phi))
    assert c["phi_rel"][0] == 0.0
    assert np.all(np.diff(c["K_WTS"]) > 0.0)  # the drive stiffens
