"""Numbers of the FMUs: equal to the package's laws, at once, and consistent among themselves."""

import csv
import io
from collections.abc import Callable
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import Fmu
from fmpy import simulate_fmu
from jointfmu_fmu_src.building import build
from scipy.integrate import cumulative_simpson, quad

from jointfmu import ramp
from jointfmu.curve import MAX_ERROR
from jointfmu.interface import at_pressure, stiffness_curve
from jointfmu.joints import MODELS
from jointfmu.joints.bolted_joint.law import pressures, shear_ratio
from jointfmu.joints.bolted_joint.spring import BoltedJointSpring
from jointfmu.joints.gear_contact.spring import GearContactSpring
from jointfmu.joints.harmonic_drive.law import drive_stiffness
from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring
from jointfmu.parameters import default
from jointfmu.quantity import build as make
from jointfmu.quantity import flatten

Host = Callable[..., Fmu]
Inputs = dict[str, float]

SAME = 1e-12
"""The FMU calls the package with the same numbers: round-off of another order of sums at most."""
TABLE = 5.0 * MAX_ERROR
"""FMU against a law that is not tabulated: what a table may err, times 5 where errors add up."""

NAMES = list(MODELS)
RANGES: dict[str, dict[str, tuple[float, float]]] = {
    "HarmonicDriveSpring": {"phi1": (-0.1, 0.1), "w1": (-50, 50), "phi2": (-3e-3, 3e-3), "w2": (-0.5, 0.5)},
    "HarmonicDriveCompliance": {"tau": (-25, 25)},
    "BoltedJoint": {
        "preload": (2e3, 3e4), "moment": (-1500, 1500),
        "s_rel_x": (-2e-6, 2e-6), "s_rel_y": (-2e-6, 2e-6), "s_rel_z": (-1e-6, 3e-6),
        "v_rel_x": (-1e-3, 1e-3), "v_rel_y": (-1e-3, 1e-3), "v_rel_z": (-1e-3, 1e-3),
    },
    "GearContact": {"f": (1, 6e4)},
}  # fmt: skip
"""Inputs of the random states, all inside the tables."""
STATE: dict[str, Inputs] = {
    "HarmonicDriveSpring": {"phi1": 0.01, "w1": 0.3, "phi2": 6e-4, "w2": -0.02},
    "HarmonicDriveCompliance": {"tau": 3.0},
    "BoltedJoint": {
        "preload": 9e3, "moment": 800.0, "s_rel_x": 1e-6, "s_rel_y": -2e-6, "s_rel_z": 5e-7,
        "v_rel_x": 1e-3, "v_rel_y": 2e-3, "v_rel_z": -1e-3,
    },
    "GearContact": {"f": 2e4},
}  # fmt: skip
"""One state with nothing zero."""
DRIVE_BASE = {"eccentricity": 1e-5}
"""With an eccentricity, so that what it costs matters."""
WITHOUT_EFFECT = {
    "HarmonicDriveSpring": {"mu"},
    "HarmonicDriveCompliance": {"mu", "ratio", "d"},
    "BoltedJoint": {"mu", "row_bolts"},
    "GearContact": {"A_0"},
}
"""Parameters that no output shows. mu: the traction ratio is given relative to it. ratio, d: the
wave generator is locked and there is no speed. row_bolts: only where a row opens (a warning).
A_0: the load alone decides the spots."""


@pytest.fixture(params=NAMES)
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


def random_inputs(name: str, count: int, seed: int) -> list[Inputs]:
    rng = np.random.default_rng(seed)
    return [{k: float(rng.uniform(*limits)) for k, limits in RANGES[name].items()} for _ in range(count)]


def parameters(name: str, changes: dict[str, Any] | None = None) -> Any:
    values = default(MODELS[name].joint).values
    return make(type(values), flatten(values) | (changes or {}))


@cache
def tabulated(joint: str, p: Any) -> Any:
    classes = {"bolted_joint": BoltedJointSpring, "gear_contact": GearContactSpring}
    return classes.get(joint, HarmonicDriveSpring).of(p)


def law(name: str, p: Any) -> Callable[[Inputs], dict[str, float]]:
    """The joint of the package behind an FMU."""

    def outputs(v: Inputs) -> dict[str, Any]:
        if name == "HarmonicDriveSpring":
            return spring.motion(v["phi1"], v["w1"], v["phi2"], v["w2"])
        if name == "HarmonicDriveCompliance":
            return spring.windup(v["tau"])
        if name == "BoltedJoint":
            s, w = ([v[f"{kind}_rel_{axis}"] for axis in "xyz"] for kind in "sv")
            return spring.motion(v["preload"], v["moment"], tuple(s), tuple(w))
        return spring.approach(v["f"])

    spring = tabulated(MODELS[name].joint, p)
    return lambda v: {k: float(x) for k, x in outputs(v).items()}


# The numbers themselves


def test_outputs_are_those_of_the_package(fmu: Host, name: str) -> None:
    instance, expected = fmu(name).start(), law(name, parameters(name))
    for inputs in random_inputs(name, 40, seed=1):
        assert instance.at(inputs) == pytest.approx(expected(inputs), rel=SAME)
    assert not instance.messages


def test_random_parameters_reach_the_law(fmu: Host, name: str) -> None:
    rng, start = np.random.default_rng(2), flatten(default(MODELS[name].joint).values)
    instance = fmu(name)
    for inputs in random_inputs(name, 5, seed=3):
        scaled = {k: start[k] * float(rng.uniform(0.95, 1.05)) for k in MODELS[name].parameter_fields()}
        scaled |= {k: float(rng.integers(8, 12)) for k in scaled if k == "n_bolts"}
        scaled |= {k: float(rng.integers(1, 4)) for k in scaled if k == "row_bolts"}
        instance.reset()
        changes = {k: v for k, v in scaled.items() if not isinstance(start[k], bool)}
        instance.start(changes | inputs)
        assert instance.get() == pytest.approx(law(name, parameters(name, changes))(inputs), rel=SAME)


def test_each_parameter_changes_the_outputs_that_it_should(fmu: Host, name: str) -> None:
    start = flatten(default(MODELS[name].joint).values)
    base = DRIVE_BASE if name.startswith("HarmonicDrive") else {}
    special = {"bearing.sigma_y": 0.8 * start.get("flexspline.sigma_y", 1.0)}  # the softer body counts
    special |= {"n_bolts": 9.0, "row_bolts": 2.0}  # whole numbers
    if name == "GearContact":
        base = {"rigid_flat": False}  # with a rigid flat the second body does not matter
    instance, without = fmu(name).start(base | STATE[name]), set()
    before = instance.get()
    assert all(before.values())
    for parameter in MODELS[name].parameter_fields():
        value = (base | start)[parameter] if parameter not in base else base[parameter]
        change = (not value) if isinstance(value, bool) else special.get(parameter, 1.001 * value)
        instance.reset()
        instance.start(base | {parameter: change} | STATE[name])
        found = instance.get()
        expected = law(name, parameters(name, base | {parameter: change}))(STATE[name])
        assert found == pytest.approx(expected, rel=SAME), parameter
        if found == pytest.approx(before, rel=SAME):
            without.add(parameter)
    assert without == WITHOUT_EFFECT[name]


def test_rigid_flat_takes_the_second_body_out(fmu: Host) -> None:
    def at(**changes: Any) -> dict[str, float]:
        return fmu("GearContact").start(changes | STATE["GearContact"]).get()

    rigid, both = at(rigid_flat=True), at(rigid_flat=False)
    assert at() == rigid  # the default
    assert at(**{"rigid_flat": True, "side2.E": 1e11}) == rigid
    assert at(**{"rigid_flat": False, "side2.E": 1e11}) != both
    # two equal bodies are as soft as one of half the modulus against a rigid flat
    assert at(**{"rigid_flat": True, "side1.E": 1.03e11}) == pytest.approx(both, rel=1e-9)


# Right at once


def test_outputs_are_right_in_initialization_and_at_the_first_point(fmu: Host, name: str) -> None:
    expected = law(name, parameters(name))
    first, second = random_inputs(name, 2, seed=4)
    instance = fmu(name)
    instance.fmu.setupExperiment(startTime=0.0)
    instance.fmu.enterInitializationMode()
    assert instance.at(first) == pytest.approx(expected(first), rel=SAME)
    assert instance.at(second) == pytest.approx(expected(second), rel=SAME)
    instance.fmu.exitInitializationMode()
    assert instance.get() == pytest.approx(expected(second), rel=SAME)


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


def test_a_step_with_unchanged_inputs_changes_nothing(fmu: Host, name: str) -> None:
    instance = fmu(name).start()
    for inputs in random_inputs(name, 5, seed=5):
        before = instance.at(inputs)
        for size in (1.0, 1e-6, 1e3):
            instance.fmu.doStep(currentCommunicationPoint=instance.time, communicationStepSize=size)
            instance.time += size
            assert instance.get() == before
            assert instance.get(*inputs) == inputs


def test_outputs_do_not_depend_on_the_way_there(fmu: Host, name: str) -> None:
    there, back = random_inputs(name, 2, seed=6)
    instance = fmu(name).start(there)
    before = instance.get()
    instance.at(back)
    instance.step()
    assert instance.get() != before
    assert instance.at(there) == before


# The harmonic drive


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


# The bolted joint


def test_bolted_joint_at_rest_follows_the_law_without_a_table(fmu: Host) -> None:
    joint, instance = parameters("BoltedJoint"), fmu("BoltedJoint").start()
    spring = BoltedJointSpring.of(joint)
    for preload, moment in ((5e3, 0.0), (9e3, 600.0), (2e4, -1500.0)):
        found = instance.at({"preload": preload, "moment": moment})
        node = pressures(joint, spring.shape, preload, moment)
        k = stiffness_curve(joint, node)[0]
        K_zz = joint.A_0 * float(spring.shape.share @ k)
        expected = {"K_zz": K_zz, "K_xx": shear_ratio(joint) * K_zz, "p_max": float(node.max())}
        assert {n: found[n] for n in expected} == pytest.approx(expected, rel=TABLE)
        assert [found["f_x"], found["f_y"], found["f_z"]] == [0.0, 0.0, 0.0]
        # the shape has a mean of 1 and a tilt of 0: what the bolts press is what the contact carries
        mean = preload * joint.n_bolts / joint.A_0
        assert found["p_mean"] == pytest.approx(mean, rel=1e-9)


def test_stiffness_is_the_derivative_of_the_force(fmu: Host) -> None:
    instance = fmu("BoltedJoint").start()
    for state in random_inputs("BoltedJoint", 15, seed=8):
        state |= {"v_rel_x": 0.0, "v_rel_y": 0.0, "v_rel_z": 0.0}  # damping off: elastic force only
        K = instance.at(state)
        slopes = {}
        h = 1e-10  # central difference: error h^2 f'''/6 and round-off 1e-16 f/(K h) both below 1e-6
        for moved in "xyz":
            s = f"s_rel_{moved}"
            up, down = instance.at(state | {s: state[s] + h}), instance.at(state | {s: state[s] - h})
            slopes |= {force + moved: (up[f"f_{force}"] - down[f"f_{force}"]) / (2.0 * h) for force in "xyz"}
        for axis in "xyz":
            assert slopes[2 * axis] == pytest.approx(-K[f"K_{2 * axis}"], rel=1e-6)
        scale = 1e-6 * K["K_zz"]
        for a, b in ("xy", "xz", "yz"):  # a potential: mixed derivatives are equal
            assert slopes[a + b] == pytest.approx(slopes[b + a], rel=1e-6, abs=scale)


def test_damping_opposes_the_speed(fmu: Host) -> None:
    instance = fmu("BoltedJoint").start()
    state = STATE["BoltedJoint"] | {"v_rel_x": 0.0, "v_rel_y": 0.0, "v_rel_z": 0.0}
    still = instance.at(state)
    for axis in "xyz":
        moving = instance.at(state | {f"v_rel_{axis}": 1e-3})
        damped = still[f"f_{axis}"] - 1e-3 * still[f"C_{2 * axis}"]
        assert moving[f"f_{axis}"] == pytest.approx(damped, rel=SAME)
        assert still[f"C_{2 * axis}"] > 0.0


def test_pulled_apart_the_preload_is_all_that_is_lost(fmu: Host) -> None:
    joint = parameters("BoltedJoint")
    instance = fmu("BoltedJoint").start({"preload": 9e3})
    pulled = [instance.at({"s_rel_z": z})["f_z"] for z in np.linspace(0.0, 5e-5, 30)]
    assert np.all(np.diff(pulled) <= 0.0)
    assert pulled[1] < 0.0
    apart = instance.get()
    # to the round trip of the table's inverse at tightening
    assert apart["f_z"] == pytest.approx(-9e3 * joint.n_bolts, rel=1e-9)
    stiffness = [k for k in apart if k.startswith("K_")]
    assert stiffness
    assert {k: apart[k] for k in stiffness} == dict.fromkeys(stiffness, 0.0)
    assert [apart["p_mean"], apart["p_max"], apart["C_zz"]] == [0.0, 0.0, 0.0]


# The gear contact


def test_gear_contact_follows_the_law_without_a_table(fmu: Host) -> None:
    contact, instance = parameters("GearContact"), fmu("GearContact").start()
    for f in (300.0, 2e3, 2e4, 6e4):
        found, expected = instance.at({"f": f}), at_pressure(contact, f / contact.A_0)
        assert found["K_N"] == pytest.approx(float(expected["K_N"]), rel=TABLE)
        for output in ("A_r", "elastic_fraction"):
            assert found[output] == pytest.approx(float(expected[output]), rel=SAME)
    assert found["elastic_fraction"] > 0.0
    assert list(instance.at({"f": 0.0}).values()) == [0.0] * 4


# Load ramps


def relative(found: Any, expected: Any) -> float:
    return float(np.max(np.abs(np.asarray(found) - expected)) / np.max(np.abs(expected)))


def test_the_torque_ramp_agrees_with_scipy(fmus: Path) -> None:
    c = ramp.run(fmus / "HarmonicDriveCompliance.fmu", "tau", 5.0, 0.01).columns
    assert len(c["tau"]) == 501
    # Simpson's rule at 0.01 N.m, a fifth of the length over which the stiffness bends
    phi = cumulative_simpson(1.0 / c["K_WTS"], x=c["tau"], initial=0.0)
    assert relative(c["phi_rel"], phi) < 1e-6
    assert c["phi_rel"][0] == 0.0
    assert np.all(np.diff(c["K_WTS"]) > 0.0)  # the drive stiffens


def test_the_preload_ramp_agrees_with_scipy(fmus: Path) -> None:
    path = fmus / "BoltedJoint.fmu"
    c = ramp.run(path, "preload", 3e4, 100.0).columns
    assert len(c["preload"]) == 301
    assert np.all(np.diff(c["K_zz"]) > 0.0)
    assert not np.any([c["f_x"], c["f_y"], c["f_z"]])
    assert relative(c["p_mean"], c["preload"] * 8.0 / 0.0382) < 1e-9  # equilibrium, 8 bolts on A_0
    pulled = ramp.run(path, "s_rel_z", 5e-6, 1e-8, {"preload": 9e3}).columns
    force = -cumulative_simpson(pulled["K_zz"], x=pulled["s_rel_z"], initial=0.0)
    assert relative(pulled["f_z"], force) < 1e-6  # Simpson's rule at 500 steps


@pytest.mark.parametrize(
    ("fmu_name", "driven", "end", "step"),
    [
        ("HarmonicDriveSpring", "phi2", 1.5e-3, 3e-6),
        ("HarmonicDriveCompliance", "tau", 5.0, 0.01),
        ("BoltedJoint", "preload", 3e4, 100.0),
        ("GearContact", "f", 3e3, 10.0),
    ],
)
def test_ten_times_larger_steps_meet_the_same_points(
    fmus: Path, fmu_name: str, driven: str, end: float, step: float
) -> None:
    path = fmus / f"{fmu_name}.fmu"
    fine, coarse = (ramp.run(path, driven, end, step * factor) for factor in (1.0, 10.0))
    assert not fine.messages
    for column, values in coarse.columns.items():
        # nothing depends on the way there; only the points differ by round-off
        np.testing.assert_allclose(values, fine.columns[column][::10], rtol=1e-9, atol=1e-15)


def test_a_partial_last_step_ends_exactly_where_asked(fmus: Path) -> None:
    path = fmus / "HarmonicDriveCompliance.fmu"
    found = ramp.run(path, "tau", -1.0, -0.3)
    assert found.columns["tau"] == pytest.approx([0.0, -0.3, -0.6, -0.9, -1.0], rel=SAME)
    whole = ramp.run(path, "tau", -1.0, -1.0)
    assert found.columns["phi_rel"][-1] == whole.columns["phi_rel"][-1]


def test_a_ramp_takes_settings_of_parameters_and_inputs(fmus: Path) -> None:
    settings = {"surface.D": 1.45, "moment": 300.0}
    c = ramp.run(fmus / "BoltedJoint.fmu", "preload", 9e3, 9e3, settings).columns
    inputs = dict.fromkeys(RANGES["BoltedJoint"], 0.0) | {"preload": 9e3, "moment": 300.0}
    expected = law("BoltedJoint", parameters("BoltedJoint", {"surface.D": 1.45}))(inputs)
    assert {k: v[-1] for k, v in c.items() if k != "preload"} == pytest.approx(expected, rel=SAME)
    gear = ramp.run(fmus / "GearContact.fmu", "f", 1e3, 1e3, {"rigid_flat": False}).columns
    softer = law("GearContact", parameters("GearContact", {"rigid_flat": False}))({"f": 1e3})
    assert gear["K_N"][-1] == pytest.approx(softer["K_N"], rel=SAME)


def test_csv_holds_every_output_with_its_unit_to_the_last_bit(fmus: Path) -> None:
    result = ramp.run(fmus / "GearContact.fmu", "f", 100.0, 30.0)
    header, *rows = csv.reader(io.StringIO(result.csv()))
    assert header == ["f [N]", "s_rel [m]", "K_N [N/m]", "A_r [m2]", "elastic_fraction [1]"]
    assert len(rows) == 5
    columns = np.array(rows, dtype=float).T
    for found, expected in zip(columns, result.columns.values(), strict=True):
        assert np.array_equal(found, expected)


def test_fmpy_simulates_the_load_ramp(fmus: Path, name: str) -> None:
    r = MODELS[name].ramp
    stop = r.end / r.step
    signal = np.array([(0.0, 0.0), (stop, r.end)], dtype=[("time", float), (r.input, float)])
    found = simulate_fmu(str(fmus / f"{name}.fmu"), input=signal, stop_time=stop, output_interval=stop / 10)
    assert len(found) == 11
    at_end = ramp.run(fmus / f"{name}.fmu", r.input, r.end * 0.9, r.end * 0.9).columns
    for output in (v.name for v in MODELS[name].outputs):
        # fmpy holds an input during a step: what it reports at the end was set one step before
        assert found[output][-1] == pytest.approx(at_end[output][-1], rel=1e-9)


# State


@pytest.mark.parametrize("fmu_name", NAMES)
def test_state_restores_parameters_inputs_and_outputs(fmu: Host, fmu_name: str) -> None:
    first, second = random_inputs(fmu_name, 2, seed=9)
    instance = fmu(fmu_name)
    instance.start({"surface.gamma": 1.6} | first)
    names = ["surface.gamma", *first, *instance.outputs]
    before = instance.get(*names)
    state = instance.fmu.getFMUstate()
    for _ in range(2):  # a state can be restored more than once, and is not what the instance works on
        instance.reset()
        instance.start({"surface.gamma": 1.4} | second)
        instance.step()
        assert instance.get(*names) != before
        instance.fmu.setFMUstate(state)
        assert instance.get(*names) == before
        instance.at(second)
    instance.fmu.freeFMUstate(state)


def test_state_as_bytes_goes_into_another_instance(fmu: Host, name: str) -> None:
    first, second = random_inputs(name, 2, seed=10)
    sender, receiver = fmu(name), fmu(name)
    sender.start({"surface.gamma": 1.6} | first)
    state = sender.fmu.getFMUstate()
    data = sender.fmu.serializeFMUState(state)
    sender.fmu.freeFMUstate(state)
    receiver.start({"surface.gamma": 1.4} | second)
    names = ["surface.gamma", *first, *sender.outputs]
    assert receiver.get(*names) != sender.get(*names)
    restored = receiver.fmu.deSerializeFMUstate(data)
    receiver.fmu.setFMUstate(restored)
    receiver.fmu.freeFMUstate(restored)
    assert receiver.get(*names) == sender.get(*names)
    assert receiver.at(second) != sender.get()  # they stay two instances
    assert sender.get(*first) == first


def test_a_restored_instance_is_past_initialization(fmu: Host) -> None:
    sender, receiver = fmu("GearContact").start({"f": 500.0}), fmu("GearContact").start()
    data = sender.fmu.serializeFMUState(sender.fmu.getFMUstate())
    receiver.fmu.setFMUstate(receiver.fmu.deSerializeFMUstate(data))
    assert "fixed parameter" in receiver.refused(receiver.set, {"e": 0.3})
    assert receiver.get() == sender.get()


def test_reset_restores_the_defaults(fmu: Host, name: str) -> None:
    fresh, used = fmu(name).start(), fmu(name)
    names = [*fresh.variables]
    names.remove("rigid_flat") if "rigid_flat" in names else None
    used.start({"surface.gamma": 1.6} | random_inputs(name, 1, seed=11)[0])
    used.step()
    assert used.get(*names) != fresh.get(*names)
    used.reset()
    used.start()
    assert used.get(*names) == fresh.get(*names)
    used.reset()
    used.start({"surface.gamma": 1.6})  # parameters can be set again
    assert used.get("surface.gamma") == {"surface.gamma": 1.6}


def test_defaults_of_a_parameter_file_are_the_start_values(fmu: Host, tmp_path: Path) -> None:
    file = default("gear_contact").with_values({"e": 0.3, "rigid_flat": False}, "user", "test")
    build([], ["python"], file, tmp_path)
    assert [p.name for p in (tmp_path / "python").iterdir()] == ["GearContact.fmu"]
    other = fmu("GearContact", tmp_path / "python").start({"f": 2e4})
    expected = law("GearContact", file.values)({"f": 2e4})
    assert other.get() == pytest.approx(expected, rel=SAME)
    assert other.get() != fmu("GearContact").start({"f": 2e4}).get()


def test_an_output_changes_with_the_inputs_it_is_said_to_depend_on_and_with_no_other(name: str) -> None:
    model = MODELS[name]
    spring = model.spring(default(model.joint).values)
    base = model.evaluate(spring, STATE[name])
    for variable in model.inputs:
        moved = model.evaluate(spring, {**STATE[name], variable.name: 1.01 * STATE[name][variable.name]})
        changed = {o.name for o in model.outputs if moved[o.name] != base[o.name]}
        assert changed == {o.name for o in model.outputs if variable.name in model.depends(o.name)}
