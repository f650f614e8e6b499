"""Hysteresis and friction in the FMUs: the package's numbers, history and derivatives in every flavour."""

import struct
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any
from xml.etree import ElementTree
from zipfile import ZipFile

import numpy as np
import pytest
from conftest import Fmu, run_host
from natives import Host, close, jacobian, slope

from jointfmu.joints import MODELS
from jointfmu.joints.harmonic_drive.spring import HISTORY_LAYOUT
from jointfmu.parameters import load_default

SPRING, COMPLIANCE = NAMES = ("HarmonicDriveSpring", "HarmonicDriveCompliance")
LOOP = {"hysteresis_loss": 3e-4}
ALL = LOOP | {
    "lost_motion": 1e-4, "error_2": 1e-4, "error_2_phase": 0.3, "error_4": 2e-5, "ratio": -80.0,
    "load_loss": 0.2, "load_loss_back": 0.45,
    "friction_coulomb": 0.03, "friction_stribeck": 0.02, "stribeck_speed": 0.3, "friction_viscous": 1e-3,
}  # fmt: skip
SETS = pytest.mark.parametrize(
    ("name", "given"),
    [(SPRING, LOOP), (COMPLIANCE, LOOP), (SPRING, ALL)],
    ids=["spring", "compliance", "all"],
)
TINY = 1e-15
"""Round-off [N.m, rad, J] of slider sums in another order, where the sum is zero."""
TURNS = (7e-4, 2e-4, 6e-4, -9e-4, -9e-4, 1e-4, 12e-4, 0.0)
"""Wind-ups of a path with minor loops and a rest."""


@pytest.fixture
def instance(native: Path, fmus: Path) -> Iterator[Any]:
    """Function that makes instances of any flavour; they are freed after the test."""
    made: list[Fmu] = []

    def make(name: str, flavour: str, exchange: bool = False) -> Fmu:
        folder = fmus if flavour == "python" else native / flavour
        made.append(Fmu(folder / f"{name}.fmu", exchange=exchange))
        return made[-1]

    yield make
    for one in made:
        one.free_instance()


def path(name: str, given: Mapping[str, float] = LOOP) -> list[dict[str, float]]:
    """Inputs along a path: angles and speeds of both flanges, or the torque for the same wind-ups.

    With friction the temperature moves too.
    """
    if name == COMPLIANCE:
        return [{"tau": 4e3 * phi} for phi in TURNS]
    warmth = [{"temperature": 268.0 + 10.0 * k} if "friction_coulomb" in given else {} for k in range(8)]
    far = 30.0 if "friction_coulomb" in given else 3.0
    motor, output = far, 1.0 + far / given.get("ratio", 100.0)
    return [
        {"phi1": motor * phi, "w1": 0.1 * k, "phi2": output * phi, "w2": -0.01 * k} | warmth[k]
        for k, phi in enumerate(TURNS)
    ]


def accept(instance: Fmu) -> None:
    """Accept the inputs by a step, in either interface."""
    if instance.is_model_exchange:
        instance.fmu.completedIntegratorStep()
    else:
        instance.step()


def begin(instance: Fmu, values: Mapping[str, float]) -> Fmu:
    """Initialize an instance."""
    instance.start(values)
    if instance.is_model_exchange:
        instance.fmu.enterContinuousTimeMode()
    return instance


def package(name: str, changes: Mapping[str, float] = LOOP) -> Iterator[Any]:
    """Generator of the package's results: send inputs, receive outputs and history after the step to them."""
    model, file = MODELS[name], load_default("harmonic_drive").with_values(changes, "user", "test")
    spring = model.tabulate(file.values)
    inputs = {v.name: v.start for v in model.inputs}
    memory = model.advance(spring, inputs, model.initial_history(spring))[1]
    found = None
    while True:
        inputs |= yield found
        out, memory = model.advance(spring, inputs, memory)
        found = {k: float(v) for k, v in out.items()}, memory


def saved(instance: Fmu) -> bytes:
    """Serialized state of the FMU as bytes."""
    state = instance.fmu.getFMUState()
    data = instance.fmu.serializeFMUState(state)
    instance.fmu.freeFMUState(state)
    return bytes(data)


def memory_of(instance: Fmu) -> np.ndarray:
    """History after the last accepted inputs, from the end of a native state (snapshot.c)."""
    inputs = sum(v.causality == "input" for v in instance.variables.values())
    tail = f"<{2 * HISTORY_LAYOUT.value_count}d{inputs}dIIQ"
    numbers = struct.unpack(tail, saved(instance)[-struct.calcsize(tail) :])
    assert numbers[-2] == 1  # there are accepted inputs
    return np.array(numbers[: 2 * HISTORY_LAYOUT.value_count]).reshape(2, HISTORY_LAYOUT.value_count)[
        numbers[-3]
    ]


# The package's numbers


@SETS
def test_outputs_and_memory_are_the_packages(
    host: Host, name: str, given: dict[str, float], version: str, exchange: bool
) -> None:
    found, expected = begin(host(name, version, exchange=exchange), given), package(name, given)
    next(expected)
    for inputs in path(name, given):
        outputs, memory = expected.send(inputs)
        assert found.at(inputs) == close(outputs)
        accept(found)
        assert found.get() == close(outputs)
        assert memory_of(found) == pytest.approx(memory, rel=1e-9, abs=TINY)


@SETS
def test_the_python_flavour_is_the_package(instance: Any, name: str, given: dict[str, float]) -> None:
    found, expected = begin(instance(name, "python"), given), package(name, given)
    next(expected)
    for inputs in path(name, given):
        outputs, _ = expected.send(inputs)
        assert found.at(inputs) == outputs
        found.step()
        assert found.get() == outputs


@pytest.mark.parametrize("flavour", ["fmi2", "fmi3", "python"])
def test_the_loop_opens_as_stated(instance: Any, flavour: str) -> None:
    compliance = begin(instance(COMPLIANCE, flavour), LOOP)
    zero = []
    for tau in (5.0, 0.0, -5.0, 0.0):
        zero.append(compliance.at({"tau": tau})["phi_rel"])
        compliance.step()
    assert zero[1] - zero[3] == close(3e-4)


@SETS
def test_derivatives_are_those_at_the_accepted_state(
    host: Host, name: str, given: dict[str, float], version: str
) -> None:
    """Derivatives agree with central differences of trial evaluations, away from reversals of the motion."""
    found, driven = begin(host(name, version), given), "tau" if name == COMPLIANCE else "phi2"
    size = {"tau": 1.0, "phi1": 0.1, "phi2": 1e-3, "w1": 1.0, "w2": 0.01, "temperature": 10.0}
    for inputs in path(name, given)[:-1]:
        found.set_values(inputs)
        found.step()
        for part in (0.4, -0.7):
            there = inputs | {driven: inputs[driven] + 0.3 * part * size[driven]}
            found.at(there)
            J = jacobian(found)
            for moved in there:
                h = 1e-6 * size[moved]
                up, down = (found.at(there | {moved: there[moved] + sign * h}) for sign in (1, -1))
                for output in found.outputs:
                    expected = (up[output] - down[output]) / (2.0 * h)
                    # round-off of the difference; no slider begins to slip within it
                    assert J[output, moved] == pytest.approx(expected, rel=1e-6, abs=1e-9 / size[moved])


# States


@SETS
def test_trials_leave_no_trace(instance: Any, name: str, given: dict[str, float]) -> None:
    for flavour, exchange in (
        ("fmi2", False),
        ("fmi2", True),
        ("fmi3", False),
        ("fmi3", True),
        ("python", False),
    ):
        plain, tried = (begin(instance(name, flavour, exchange), given) for _ in range(2))
        for inputs in path(name, given):
            for other in reversed(path(name, given)):
                tried.at(other)
            assert tried.at(inputs) == plain.at(inputs)
            accept(tried), accept(plain)
            for other in path(name, given):
                tried.at(other)
            assert tried.at(inputs) == plain.get()


@pytest.mark.parametrize("flavour", ["fmi2", "fmi3", "python"])
@SETS
def test_no_step_changes_an_output_whose_inputs_did_not_change(
    instance: Any, name: str, given: dict[str, float], flavour: str
) -> None:
    found = begin(instance(name, flavour), given)
    for inputs in path(name, given):
        before = found.at(inputs)
        slopes = None if flavour == "python" else jacobian(found)
        for _ in range(3):
            found.step()
            assert found.get() == before
            assert slopes is None or jacobian(found) == slopes


@pytest.mark.parametrize("flavour", ["fmi2", "fmi3", "python"])
def test_a_master_may_go_back(instance: Any, flavour: str) -> None:
    """Some steps, back to the saved state, then other steps: as if the first steps had not been done."""
    plain, used = (begin(instance(SPRING, flavour), LOOP) for _ in range(2))
    way = path(SPRING)
    for inputs in way[:3]:
        for one in (plain, used):
            one.set_values(inputs)
            one.step()
    state, time = used.fmu.getFMUState(), used.time
    for inputs in way[4:]:
        used.set_values(inputs)
        used.step()
    used.fmu.setFMUState(state)
    used.fmu.freeFMUState(state)
    used.time = time
    assert used.get() == plain.get()
    for inputs in way[3:]:
        for one in (plain, used):
            one.set_values(inputs)
            one.step()
        assert used.get() == plain.get()


@pytest.mark.parametrize("flavour", ["fmi2", "fmi3", "python"])
def test_a_refused_step_changes_nothing(instance: Any, flavour: str) -> None:
    found, plain = (begin(instance(SPRING, flavour), LOOP) for _ in range(2))
    for inputs in path(SPRING):
        found.set_values({"phi2": float("nan")})
        found.refused(found.step)
        for one in (found, plain):
            one.set_values(inputs)
            one.step()
        assert found.get() == plain.get()


CONTINUE = """
import sys
from pathlib import Path
from conftest import Fmu
flavour, file, data, *way = sys.argv[1:]
instance = Fmu(Path(file))
if flavour == "python":
    instance.start()
state = instance.fmu.deserializeFMUState(Path(data).read_bytes())
instance.fmu.setFMUState(state)
instance.time = 3.0
for phi in way:
    print(*(x.hex() for x in instance.at({"phi2": float(phi)}).values()))
    instance.step()
instance.free_instance()
"""


@pytest.mark.parametrize("flavour", ["fmi2", "fmi3", "python"])
def test_another_process_goes_on(
    instance: Any, native: Path, fmus: Path, tmp_path: Path, flavour: str
) -> None:
    found = begin(instance(SPRING, flavour), LOOP)
    for phi in TURNS[:3]:
        found.set_values({"phi2": phi})
        found.step()
    data = tmp_path / "state"
    data.write_bytes(saved(found))
    file = (fmus if flavour == "python" else native / flavour) / f"{SPRING}.fmu"
    done = run_host(CONTINUE, flavour, file, data, *TURNS[3:])
    assert done.returncode == 0, done.stderr
    rows = []
    for phi in TURNS[3:]:
        rows.append(" ".join(x.hex() for x in found.at({"phi2": phi}).values()))
        found.step()
    assert done.stdout.splitlines() == rows


def test_inputs_that_move_in_a_step_come_from_where_they_are(host: Host) -> None:
    """FMI 2: inputs set to the turning point, then moved by a derivative, in one step."""
    moving, plain = (begin(host(SPRING, "fmi2"), LOOP) for _ in range(2))
    for one in (moving, plain):
        one.set_values({"phi2": 6e-4})
    plain.step()
    plain.set_values({"phi2": 6e-4 + 1.0 * -2e-4})
    plain.step()
    slope(moving, phi2=-2e-4)
    moving.step()
    assert moving.get() == plain.get()


def test_a_tuned_parameter_acts_from_the_accepted_point_on(host: Host, version: str) -> None:
    found = begin(host(SPRING, version), LOOP)
    found.set_values({"phi2": 6e-4})
    found.step()
    before = found.get()
    assert found.at({"hysteresis_loss": 3e-4}) == before
    smaller = found.at({"hysteresis_loss": 1e-4})
    assert smaller["tau"] < before["tau"]
    assert smaller["E_loss"] > before["E_loss"]
    off = found.at({"hysteresis_loss": 0.0})
    assert off["E_loss"] == before["E_loss"]
    assert off["tau"] == host(SPRING, version).start({"phi2": 6e-4}).get("tau")["tau"]


@pytest.mark.parametrize(("name", "needed"), [(SPRING, True), (COMPLIANCE, True), ("GearContact", False)])
def test_descriptions_ask_for_integrator_steps(native: Path, name: str, needed: bool) -> None:
    flags = []
    for flavour in ("fmi2", "fmi3"):
        with ZipFile(native / flavour / f"{name}.fmu") as fmu:
            flags.append(
                ElementTree.fromstring(fmu.read("modelDescription.xml")).find("ModelExchange").attrib
            )
    assert flags[0]["completedIntegratorStepNotNeeded"] == str(not needed).lower()
    assert flags[1]["needsCompletedIntegratorStep"] == str(needed).lower()
