"""Loads over time in model exchange: their corners are time events, so that solvers do not miss a pulse."""

import ctypes
from collections.abc import Callable, Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import Fmu, here_alone, made_once
from fmpy.fmi2 import fmi2EventInfo
from jointfmu_fmu_src.native.build import build_native_fmu
from jointfmu_fmu_src.partners import load_partner_parameters
from jointfmu_fmu_src.partners.laws import ForceProfile
from numpy.typing import NDArray
from scipy.integrate import BDF

from jointfmu.quantity import flatten_parameters

pytestmark = pytest.mark.slow

PULSE = {"pulse_height": 3.0, "pulse_start": 1.0, "pulse_rise": 2e-4, "pulse_hold": 1e-3}
MASS = 2.0
LOADS = pytest.mark.parametrize("name", ["ForceProfile", "TorqueProfile"])
Make = Callable[[str], Fmu]


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    def make(out: Path) -> None:
        with here_alone():
            for name in ("ForceProfile", "TorqueProfile", "TranslationalMass"):
                for version in "23":
                    build_native_fmu(name, load_partner_parameters(name), out / f"fmi{version}", version)

    return made_once(tmp_path_factory, "events", make)


@pytest.fixture
def exchange(folder: Path, version: str) -> Iterator[Make]:
    """Function that makes instances for model exchange."""
    made: list[Fmu] = []

    def instance(name: str) -> Fmu:
        made.append(Fmu(folder / version / f"{name}.fmu", exchange=True))
        return made[-1]

    yield instance
    for one in made:
        one.free_instance()


def next_event(fmu: Fmu) -> float:
    """Time of the next event that an FMU in event mode announces [s]; infinite if there is none."""
    if fmu.version == 3:
        *_, defined, time = fmu.fmu.updateDiscreteStates()
        return float(time) if defined else np.inf
    info = fmi2EventInfo()
    fmu.fmu.fmi2NewDiscreteStates(fmu.fmu.component, ctypes.byref(info))
    return float(info.nextEventTime) if info.nextEventTimeDefined else np.inf


def corners(name: str, changes: dict[str, float]) -> list[float]:
    """Times between which a load is one polynomial, found from its values over time."""
    given = flatten_parameters(load_partner_parameters(name).values) | changes
    times = {given["ramp_start"], given["ramp_start"] + given["ramp_duration"]}
    edge = given["pulse_start"]
    for way in (0.0, given["pulse_rise"], given["pulse_hold"], given["pulse_rise"]):
        edge += way
        times.add(edge)
    return sorted(times)


@LOADS
def test_every_corner_is_announced_in_its_order(exchange: Make, name: str) -> None:
    changes = PULSE | {"ramp_start": 0.25, "ramp_duration": 0.5}
    fmu = exchange(name).start(changes)
    seen = []
    while np.isfinite(time := next_event(fmu)):
        seen.append(time)
        fmu.fmu.enterContinuousTimeMode()
        fmu.fmu.setTime(time)
        fmu.fmu.enterEventMode()
    assert seen == pytest.approx(corners(name, changes), rel=1e-13)
    assert len(seen) == 6


def test_an_event_takes_the_parameters_that_were_changed_in_it(exchange: Make) -> None:
    fmu = exchange("ForceProfile").start(PULSE | {"ramp_start": 5.0})
    assert next_event(fmu) == 1.0
    fmu.set_values({"pulse_start": 0.125})
    assert next_event(fmu) == 0.125


def test_bodies_have_no_time_events(exchange: Make) -> None:
    assert next_event(exchange("TranslationalMass").start()) == np.inf


def driven(load: Fmu, mass: Fmu, stop: float, with_events: bool) -> NDArray[np.float64]:
    """Position and speed at the end of a mass that a load moves from rest, integrated by scipy's BDF."""
    pair = (ctypes.c_double * 2)()
    rates = mass.fmu.getDerivatives if mass.version == 2 else mass.fmu.getContinuousStateDerivatives

    def derivative(time: float, x: NDArray[np.float64]) -> NDArray[np.float64]:
        for fmu in (load, mass):
            fmu.fmu.setTime(time)
        mass.set_values({"f_a": load.get("f")["f"]})
        pair[:] = x
        mass.fmu.setContinuousStates(pair, 2)
        rates(pair, 2)
        return np.array(pair)

    time, state = 0.0, np.zeros(2)
    while time < stop:
        until = min(stop, next_event(load)) if with_events else stop
        next_event(mass)
        for fmu in (load, mass):
            fmu.fmu.enterContinuousTimeMode()
        solver = BDF(derivative, time, state, until, rtol=1e-8, atol=1e-12)
        while solver.status == "running":
            solver.step()
        time, state = until, solver.y
        derivative(time, state)
        for fmu in (load, mass):
            fmu.fmu.enterEventMode()
    return state


def test_a_solver_at_rest_meets_the_pulse(exchange: Make) -> None:
    """Twice the integral of the force is exact, because the mean edge of the pulse is at half its height.
    Without events the solver steps over the pulse, and the mass stays at rest."""

    def run(with_events: bool) -> Any:
        return driven(exchange("ForceProfile").start(PULSE), exchange("TranslationalMass").start({"m": MASS}),
                      2.0, with_events)  # fmt: skip

    assert run(False).tolist() == [0.0, 0.0]
    width = PULSE["pulse_rise"] + PULSE["pulse_hold"]
    speed = PULSE["pulse_height"] * width / MASS
    middle = PULSE["pulse_start"] + PULSE["pulse_rise"] + 0.5 * PULSE["pulse_hold"]
    np.testing.assert_allclose(run(True), [speed * (2.0 - middle), speed], rtol=1e-6)  # a hundred times rtol


def test_corners_are_where_a_course_changes_its_polynomial() -> None:
    """The third derivative of a quintic edge jumps at its ends and nowhere else."""
    given = flatten_parameters(load_partner_parameters("ForceProfile").values) | PULSE
    given |= {"ramp_height": 1.0, "ramp_start": 0.25, "ramp_duration": 0.5}
    given |= {"pulse_rise": 0.25, "pulse_hold": 0.25}
    load = ForceProfile(**given)
    ends = sorted(float(t) for t in load.find_corner_times())
    assert ends == corners("ForceProfile", given)
    for begin, end in pairwise([0.0, *ends, 2.5]):
        t = np.linspace(begin, end, 13)
        y = np.array([load.evaluate_outputs({"time": x, "f_in": 0.0})["f"] for x in t])
        np.testing.assert_allclose(np.polyval(np.polyfit(t - begin, y, 5), t - begin), y, atol=1e-9)
