"""Continuous states that a host sets in model exchange: all at once, or by value reference."""

import ctypes
import math
from collections.abc import Callable
from pathlib import Path

import fmpy
import numpy as np
import pytest
from conftest import Fmu, here_alone, made_once, run_client, unpack
from jointfmu_fmu_src.native.build import build_native_fmu
from jointfmu_fmu_src.partners import load_partner_parameters
from jointfmu_fmu_src.partners.laws import GRAVITY
from jointfmu_tools.systems.fmu.assembly import assemble_system
from jointfmu_tools.systems.fmu.build import build_system_fmus
from jointfmu_tools.systems.system import load_system
from scipy.integrate import solve_ivp

pytestmark = pytest.mark.slow  # builds FMUs

STATES = {
    "RotationalInertia": {"phi": 0.4, "w": -1.5},
    "TranslationalMass": {"s": 2e-3, "v": 0.25},
    "robot_joint": {"motor.phi": 0.1, "link.phi": 1e-3, "motor.w": 0.5, "link.w": -0.02},
}
"""{FMU: values of its continuous states other than the start values}."""
START = {"RotationalInertia": {"J": 0.5, "m": 2.0, "l": 0.1, "tau_a": 0.3}}

SetStates = Callable[[Fmu, dict[str, float]], None]
NAMES = pytest.mark.parametrize("name", list(STATES))
VERSIONS = pytest.mark.parametrize("version", ["2", "3"])
MODES = pytest.mark.parametrize("continuous", [False, True], ids=["event mode", "continuous-time mode"])


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    def make(out: Path) -> None:
        with here_alone():
            for name in ("RotationalInertia", "TranslationalMass"):
                for version in "23":
                    build_native_fmu(name, load_partner_parameters(name), out / f"fmi{version}", version)
            build_system_fmus(
                assemble_system(load_system("robot_joint")), out, platforms=(fmpy.platform_tuple,)
            )

    return made_once(tmp_path_factory, "set_states", make)


def file_of(folder: Path, name: str, version: str) -> Path:
    return folder / f"fmi{version}" / f"{name}.fmu"


def vector(fmu: Fmu, getter: str) -> list[float]:
    """Continuous states of an FMU, or their derivatives."""
    n = fmu.description.numberOfContinuousStates
    values = (ctypes.c_double * n)()
    getattr(fmu.fmu, getter)(values, n)
    return list(values)


def rates(fmu: Fmu) -> list[float]:
    """Derivatives of the continuous states."""
    return vector(fmu, "getDerivatives" if fmu.version == 2 else "getContinuousStateDerivatives")


def set_vector(fmu: Fmu, states: dict[str, float]) -> None:
    """Set all continuous states at once."""
    n = len(states)
    fmu.fmu.setContinuousStates((ctypes.c_double * n)(*states.values()), n)


@pytest.mark.parametrize(
    ("set_states", "continuous"),
    [
        pytest.param(set_vector, False, id="vector, event mode"),
        pytest.param(Fmu.set_values, False, id="reference, event mode"),
        pytest.param(Fmu.set_values, True, id="reference, continuous-time mode"),
    ],
)
@NAMES
@VERSIONS
def test_derivatives_and_outputs_follow_states_that_a_host_sets(
    folder: Path, version: str, name: str, set_states: SetStates, continuous: bool
) -> None:
    """Derivatives and outputs agree with those after setting the state vector in continuous-time mode."""
    path, states, start = file_of(folder, name, version), STATES[name], START.get(name, {})
    expected, fmu = (Fmu(path, exchange=True).start(start) for _ in range(2))
    expected.fmu.enterContinuousTimeMode()
    set_vector(expected, states)
    if continuous:
        fmu.fmu.enterContinuousTimeMode()
    before = rates(fmu)
    set_states(fmu, states)
    assert rates(fmu) == rates(expected) != before
    assert fmu.get() == expected.get()
    assert vector(fmu, "getContinuousStates") == list(states.values())
    for one in (expected, fmu):
        one.free_instance()


@NAMES
@VERSIONS
def test_states_are_outputs_between_steps_of_co_simulation(folder: Path, version: str, name: str) -> None:
    fmu = Fmu(file_of(folder, name, version)).start()
    state = next(iter(STATES[name]))
    assert f"{state} is an output" in fmu.refused(fmu.set_values, {state: 0.0})
    fmu.free_instance()


@MODES
@VERSIONS
def test_accelerations_are_not_settable(folder: Path, version: str, continuous: bool) -> None:
    fmu = Fmu(file_of(folder, "RotationalInertia", version), exchange=True).start()
    if continuous:
        fmu.fmu.enterContinuousTimeMode()
    assert "a is an output" in fmu.refused(fmu.set_values, {"a": 0.0})
    fmu.free_instance()


CASADI = """
import json, sys
import casadi as ca
file, folder = sys.argv[1:]
case = json.load(open(file))
dae = ca.DaeBuilder("fmu", folder, {})
for name, value in case["parameters"].items():
    dae.set(name, value)
f = dae.create("f", ["x", "u"], ["ode"])
x, u = ca.MX.sym("x", dae.nx()), ca.MX.sym("u", dae.nu())
problem = {"x": x, "u": u, "ode": f(x, u)}
options = {"reltol": 1e-10, "abstol": 1e-12}
motion = ca.integrator("motion", "cvodes", problem, 0.0, case["times"], options)
found = motion(x0=[case["states"][n] for n in dae.x()], u=[case["inputs"].get(n, 0.0) for n in dae.u()])
json.dump({"x": dae.x(), "motion": found["xf"].full().tolist()}, open(file, "w"))
"""


def integrate(
    path: Path,
    tmp_path: Path,
    parameters: dict[str, float],
    states: dict[str, float],
    inputs: dict[str, float],
    times: np.ndarray,
) -> np.ndarray:
    """Continuous states at times, integrated by CasADi, which sets states by value reference."""
    case = {"parameters": parameters, "states": states, "inputs": inputs, "times": times.tolist()}
    found = run_client(CASADI, tmp_path, unpack(path, path.stat().st_mtime_ns)[0], **case)
    assert found["x"] == list(states)
    return np.array(found["motion"])


@VERSIONS
def test_casadi_integrates_a_pendulum(folder: Path, tmp_path: Path, version: str) -> None:
    J, m, length, torque = 0.5, 2.0, 0.1, 0.3
    times, states = np.linspace(0.25, 2.0, 8), STATES["RotationalInertia"]
    path = file_of(folder, "RotationalInertia", version)
    found = integrate(path, tmp_path, {"J": J, "m": m, "l": length}, states, {"tau_a": torque}, times)

    def derivative(_: float, x: np.ndarray) -> list[float]:
        return [x[1], (torque - m * GRAVITY * length * math.sin(x[0])) / J]

    expected = solve_ivp(
        derivative, (0.0, 2.0), list(states.values()), "DOP853", times, rtol=1e-12, atol=1e-13
    ).y
    np.testing.assert_allclose(found, expected, atol=1e-7)


@VERSIONS
def test_casadi_integrates_a_system_without_accepting_steps(
    folder: Path, tmp_path: Path, version: str
) -> None:
    """CasADi never completes an integrator step, so joints start from the history after initialization."""
    times, states = np.array([0.01, 0.02]), STATES["robot_joint"]
    path = file_of(folder, "robot_joint", version)
    found = integrate(path, tmp_path, {}, states, {"drive.temperature": 293.15}, times)
    fmu = Fmu(path, exchange=True).start({"drive.temperature": 293.15})
    fmu.fmu.enterContinuousTimeMode()

    def derivative(time: float, x: np.ndarray) -> list[float]:
        fmu.fmu.setTime(time)
        set_vector(fmu, dict(zip(states, x, strict=True)))
        return rates(fmu)

    expected = solve_ivp(
        derivative, (0.0, times[-1]), list(states.values()), "DOP853", times, rtol=1e-10, atol=1e-12
    ).y
    np.testing.assert_allclose(found, expected, atol=1e-5 * np.abs(expected).max())
    fmu.free_instance()
