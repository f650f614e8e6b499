"""Native FMUs against the package and the python flavour: numbers, states, derivatives, messages.

FMI 2.0 and 3.0 are tested alike, co-simulation and model exchange wherever they could differ.
"""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import Fmu, here_alone
from fmpy import simulate_fmu
from fmpy.fmi1 import FMICallException
from fmpy.validation import validate_fmu
from joint_cases import CASES, NAMES, RANGES, STATE, TUNED, law, random_inputs
from jointfmu_fmu_src.building import build_fmus
from natives import VERSIONS, Host, attempt, close, near, package, settle, slope

from jointfmu.joints import MODELS
from jointfmu.parameters import load_default
from jointfmu.quantity import build_parameter_set as make
from jointfmu.quantity import flatten_parameters


@pytest.fixture(params=NAMES)
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


# The numbers themselves


@pytest.mark.parametrize("interface", ["CoSimulation", "ModelExchange"])
def test_fmpy_simulates_the_default_experiment(native: Path, name: str, version: str, interface: str) -> None:
    path, model = str(native / version / f"{name}.fmu"), MODELS[name]
    assert validate_fmu(path) == []
    stop, inputs = model.ramp.end_value / model.ramp.value_step, [v.name for v in model.inputs]
    signal = np.zeros(2, dtype=[("time", float), *((i, float) for i in inputs)])
    signal["time"][1], signal[model.ramp.input_name][1] = stop, model.ramp.end_value
    outputs, interval = [v.name for v in model.outputs], stop / 20.0
    found = simulate_fmu(
        path,
        fmi_type=interface,
        solver="CVode",
        input=signal,
        output=[*inputs, *outputs],
        output_interval=interval,
    )
    assert found["time"] == close(np.arange(21) * interval)  # to the stop time of the default experiment
    lag = interval if interface == "CoSimulation" else 0.0  # there an input holds during a step
    assert found[model.ramp.input_name] == close(np.maximum(found["time"] - lag, 0.0) * model.ramp.value_step)
    expected = package(name)
    for row in found:
        assert {o: row[o] for o in outputs} == near(name, expected({i: row[i] for i in inputs}))


def test_all_flavours_and_interfaces_give_the_numbers_of_the_package(
    host: Host, fmu: Host, name: str
) -> None:
    python, expected, r = fmu(name).start(), package(name).after(), MODELS[name].ramp
    natives = [host(name, v, exchange=kind).start() for v in VERSIONS for kind in (False, True)]
    rest = {n: max(low, 0.0) for n, (low, _) in RANGES[name].items()}  # no lubricant is at 0 K
    ramp = [rest | {r.input_name: x} for x in np.linspace(0.0, r.end_value, 11)]
    for inputs in (*ramp, *random_inputs(name, 20, seed=21)):
        found, *others = (one.at(inputs) for one in natives)
        assert others == [found] * 3
        assert found == near(name, expected(inputs))
        assert python.at(inputs) == near(name, found)
    assert not [m for one in natives for m in one.messages if m.fmi_status]


def test_each_input_counts_when_it_moves_alone(host: Host, name: str, version: str) -> None:
    instance, expected = host(name, version).start(), package(name).after()
    for moved, value in STATE[name].items():
        for factor in (0.0, 0.5, 1.5):
            instance.at(STATE[name])
            found = instance.at({moved: factor * value})
            assert found == near(name, expected(STATE[name] | {moved: factor * value})), moved


def varied(name: str, rng: np.random.Generator) -> dict[str, Any]:
    """Parameters around the defaults, some of them outside their allowed range."""
    changes: dict[str, Any] = {}
    start = flatten_parameters(load_default(MODELS[name].joint).values)
    for parameter, item in MODELS[name].parameter_fields().items():
        value, meta = start[parameter], item.metadata
        if isinstance(value, bool):
            changes[parameter] = bool(rng.integers(2))
        elif meta["whole"]:
            changes[parameter] = value + float(rng.integers(-1, 2))
        else:
            low, high = meta["interval"].low, meta["interval"].high
            width = 0.05 * (high - low)
            if math.isfinite(width):
                changes[parameter] = float(rng.uniform(max(low, value - width), min(high, value + width)))
            else:
                changes[parameter] = value * float(np.exp(rng.normal(0.0, 0.1)))
    return changes


def test_random_parameters_give_the_numbers_or_the_refusal_of_the_package(host: Host, name: str) -> None:
    rng, accepted, cases = np.random.default_rng(22), 0, 30
    natives = [host(name, v) for v in VERSIONS]
    for i in range(cases):
        instance, changes = natives[i % 2], varied(name, rng)
        instance.reset()
        expected, reason = attempt(package, name, changes)
        if reason:
            assert instance.refused(instance.start, changes) == reason
            continue
        accepted += 1
        instance.start(changes)
        expected = expected.after()
        for inputs in random_inputs(name, 4, seed=i):
            assert instance.at(inputs) == close(expected(inputs)), changes
    assert accepted >= cases // 6


def test_each_parameter_changes_the_outputs_that_it_should(host: Host, name: str, version: str) -> None:
    start, case = flatten_parameters(load_default(MODELS[name].joint).values), CASES[name]
    base = dict(case.tuning.base)
    instance, without = host(name, version), set()
    instance.enter_initialization()  # from rest, as in the package
    before = instance.at(base | STATE[name])
    for parameter in MODELS[name].parameter_fields():
        value = (start | base)[parameter]
        change = (not value) if isinstance(value, bool) else case.tuning.moved.get(parameter, 1.001 * value)
        found = instance.at({parameter: change})
        assert found == close(package(name, base | {parameter: change})(STATE[name])), parameter
        if found == close(before):
            without.add(parameter)
        assert instance.at({parameter: value}) == before
    assert without == case.tuning.without_effect


@pytest.mark.parametrize("version", VERSIONS)
def test_a_boolean_is_read_as_it_was_set(host: Host, version: str) -> None:
    instance = host("GearContact", version).start(STATE["GearContact"])
    reference, seen = [instance.variables["rigid_flat"].valueReference], []
    for value in (True, False, True):
        instance.set_values({"rigid_flat": value})
        assert [bool(v) for v in instance.fmu.getBoolean(reference)] == [value]
        seen.append(instance.get())
    assert seen[0] == seen[2] != seen[1]
    assert seen[1] == close(package("GearContact", {"rigid_flat": False})(STATE["GearContact"]))


# Right at once


def test_outputs_are_right_in_initialization_and_after_each_set(
    host: Host, name: str, version: str, exchange: bool
) -> None:
    expected, instance = package(name), host(name, version, exchange=exchange)
    first, second, third = random_inputs(name, 3, seed=24)
    instance.set_values(first)  # start values may be set right after instantiation
    instance.enter_initialization()
    assert instance.get() == close(expected(first))
    assert instance.at(second) == close(expected(second))
    instance.fmu.exitInitializationMode()
    assert instance.get() == close(expected(second))
    expected = expected.after(second)
    assert instance.at(third) == close(expected(third))
    settle(instance)
    assert instance.get() == close(expected(third))
    if exchange:  # without an event's update nothing was accepted
        instance.fmu.enterContinuousTimeMode()
        assert instance.at(first) == close(expected(first))
    instance.fmu.terminate()
    assert instance.get() == close(expected(first if exchange else third))


def test_parameters_count_until_initialization_ends(host: Host, version: str, exchange: bool) -> None:
    instance = host("HarmonicDriveCompliance", version, exchange=exchange)
    instance.set_values({"K_FTS0": 1e4, "tau": 3.0})
    instance.enter_initialization()
    assert instance.get("K_FTS") == {"K_FTS": 1e4}
    instance.set_values({"K_FTS0": 3e4})
    assert instance.get("K_FTS", "K_FTS0") == {"K_FTS": 3e4, "K_FTS0": 3e4}
    instance.fmu.exitInitializationMode()
    assert instance.get() == close(package("HarmonicDriveCompliance", {"K_FTS0": 3e4})({"tau": 3.0}))


# Steps


def reached(instance: Fmu) -> float:
    """Time of the simulation that an instance has reached."""
    last_successful_time = 2
    if instance.version == 2:
        return float(instance.fmu.getRealStatus(last_successful_time))
    return instance.get("time")["time"]


def test_steps_of_any_size_end_where_they_should_and_change_nothing(
    host: Host, name: str, version: str
) -> None:
    instance, rng = host(name, version).start(), np.random.default_rng(25)
    for inputs in random_inputs(name, 12, seed=25):
        before = instance.at(inputs)
        instance.step(float(10.0 ** rng.uniform(-9.0, 4.0)))
        assert instance.get() == before
        assert instance.get(*inputs) == inputs
        assert reached(instance) == instance.time > 0.0


def test_a_simulation_may_start_at_any_time(host: Host, version: str) -> None:
    instance = host("GearContact", version)
    instance.set_values({"f": 900.0})
    instance.enter_initialization(start=-5.0, stop=-3.0)
    instance.fmu.exitInitializationMode()
    instance.step()
    assert reached(instance) == -4.0
    assert instance.get() == host("GearContact", version).start({"f": 900.0}).get()


def test_input_derivatives_extrapolate_one_step(host: Host, name: str) -> None:
    rng, start = np.random.default_rng(26), STATE[name]
    instance, other = host(name, "fmi2"), host(name, "fmi2").start(start)
    slopes = {k: value * float(rng.uniform(-0.1, 0.1)) for k, value in start.items()}
    instance.start(start)
    before = instance.get()
    slope(instance, **slopes)
    assert instance.get() == before  # nothing moves without a step
    instance.step(0.5)
    moved = {k: start[k] + 0.5 * slopes[k] for k in start}
    assert instance.get(*start) == moved
    assert instance.get() == other.at(moved) != before
    instance.step(0.5)  # the derivatives were for one step
    assert instance.get(*start) == moved
    assert instance.get() == other.get()


def test_a_step_with_input_derivatives_starts_at_the_inputs(host: Host) -> None:
    """Friction follows the path through the inputs that were set before the step, not straight to its end."""
    moving, stepwise, straight = (host("BoltedJoint", "fmi2").start({"preload": 9e3}) for _ in range(3))
    for instance in (moving, stepwise):
        instance.set_values({"s_rel_x": 1e-6})
    slope(moving, s_rel_x=-2e-6)
    stepwise.step()
    for instance in (stepwise, straight):
        instance.set_values({"s_rel_x": -1e-6})
    for instance in (moving, stepwise, straight):
        instance.step()
    assert moving.get() == stepwise.get()
    assert moving.get("E_loss")["E_loss"] > 2.0 * straight.get("E_loss")["E_loss"] > 0.0


def test_input_derivatives_that_cannot_be_used_are_refused(host: Host) -> None:
    instance = host("GearContact", "fmi2").start({"f": 900.0})
    before = instance.get()
    f, e = (instance.variables[n].valueReference for n in ("f", "e"))
    for references, orders, values in (([f], [2], [1.0]), ([e], [1], [1.0]), ([f], [1], [math.nan])):
        message = instance.refused(instance.fmu.setRealInputDerivatives, references, orders, values)
        assert message.startswith("fmi2SetRealInputDerivatives: ")
        assert "; expected " in message
    slope(instance, f=-1e308)
    instance.set_values({"f": -1e308})
    with pytest.raises(FMICallException):  # not finite at the end of the step
        instance.step()
    instance.set_values({"f": 900.0})
    slope(instance, f=0.0)
    instance.step()
    assert instance.get() == before


# Tunable parameters


def test_a_parameter_changed_between_steps_is_as_if_it_had_always_been_so(
    host: Host, name: str, version: str, exchange: bool
) -> None:
    """After a change between steps, the outputs are those of an instance that started with the changed value;
    the history of the earlier path is kept."""
    instance, fresh = (host(name, version, exchange=exchange) for _ in range(2))
    given = STATE[name] | CASES[name].tuning.also
    before = instance.start(given).get()
    start = flatten_parameters(load_default(MODELS[name].joint).values)
    changes: dict[str, Any] = {}
    for parameter, value in TUNED[name].items():
        settle(instance)
        changes[parameter] = value
        last, found = instance.get(), instance.at({parameter: value})
        fresh.reset()
        assert found == fresh.start(changes | given).get() != last
        settle(instance)
        assert instance.get() == found
    assert instance.at({p: start[p] for p in TUNED[name]}) == before
    settle(instance)
    assert instance.get() == before
    evaluations = [m for m in instance.messages if "tables evaluated again" in m.message_text]
    assert len(evaluations) == len(changes) + 1


def test_fmpy_tunes_a_parameter_at_an_event(native: Path, version: str) -> None:
    signal = np.array(
        [(0.0, 0.0, 2e4), (5.0, 2.0, 2e4), (5.0, 2.0, 3e4), (10.0, 4.0, 3e4)],
        dtype=[("time", float), ("tau", float), ("K_FTS0", float)],
    )
    name = "HarmonicDriveCompliance"
    expected = {value: package(name, {"K_FTS0": value}) for value in (2e4, 3e4)}
    outputs = [v.name for v in MODELS[name].outputs]
    for interface in ("CoSimulation", "ModelExchange"):
        found = simulate_fmu(
            str(native / version / f"{name}.fmu"),
            fmi_type=interface,
            input=signal,
            output=["tau", "K_FTS0", *outputs],
            stop_time=10.0,
            output_interval=0.5,
        )
        assert set(found["K_FTS0"]) == expected.keys()
        assert found["tau"][-1] >= 3.8
        for row in found:
            assert {o: row[o] for o in outputs} == close(expected[row["K_FTS0"]]({"tau": row["tau"]}))


def test_a_parameter_out_of_range_refuses_every_call_until_it_is_right(
    host: Host, version: str, exchange: bool
) -> None:
    instance = host("GearContact", version, exchange=exchange).start({"f": 900.0})
    before = instance.get()
    instance.set_values({"e": 2.0})
    end_of_event = {"fmi2": "newDiscreteStates", "fmi3": "updateDiscreteStates"}[version]
    for call in (instance.get, getattr(instance.fmu, end_of_event) if exchange else instance.step):
        assert instance.refused(call) == "e = 2 is outside [0, 1): eccentricity of the contact ellipses"
    assert instance.get("e", "f") == {"e": 2.0, "f": 900.0}
    instance.set_values({"e": 0.2})
    assert instance.get() == before
    settle(instance)
    assert instance.get() == before


def test_a_parameter_is_not_set_in_continuous_time(host: Host, version: str) -> None:
    instance = host("GearContact", version, exchange=True).start({"f": 900.0})
    instance.fmu.enterContinuousTimeMode()
    before = instance.get()
    assert "e is a tunable parameter" in instance.refused(instance.set_values, {"e": 0.3})
    assert "event mode" in instance.refused(instance.set_values, {"rigid_flat": False})
    assert instance.get() == before
    instance.fmu.enterEventMode()
    assert instance.at({"e": 0.3}) != before


def test_reconfiguration_mode_takes_parameters(host: Host, name: str, exchange: bool) -> None:
    instance, fresh = (host(name, "fmi3", exchange=exchange) for _ in range(2))
    given = STATE[name] | CASES[name].tuning.also
    instance.start(given).fmu.enterConfigurationMode()
    instance.set_values(TUNED[name])
    instance.fmu.exitConfigurationMode()
    assert instance.get() == fresh.start(TUNED[name] | given).get()


# Parameter files


@pytest.mark.parametrize(
    ("name", "changes"), [(name, changes) for name, case in CASES.items() for changes in case.tuning.baked]
)
def test_a_parameter_file_is_baked_in(host: Host, tmp_path: Path, name: str, changes: dict[str, Any]) -> None:
    file = load_default(MODELS[name].joint).with_values(changes, "user", "test")
    with here_alone("3"):
        build_fmus([name], ["fmi3"], file, tmp_path)
    instance, plain = host(name, folder=tmp_path).start(STATE[name]), host(name).start(STATE[name])
    assert instance.get() != plain.get()
    for parameter, value in changes.items():
        if parameter in instance.variables:
            assert json.loads(instance.variables[parameter].start) == value
    expected = law(name, file.values).after(STATE[name])
    for inputs in random_inputs(name, 20, seed=38):
        assert instance.at(inputs) == close(expected(inputs))
    rng, accepted = np.random.default_rng(39), 0
    for i in range(10):  # every other parameter can be set as ever
        tuned = varied(name, rng)
        instance.reset()
        values = flatten_parameters(file.values) | tuned
        expected, reason = attempt(lambda v: law(name, make(type(file.values), v)), values)
        if reason:
            assert instance.refused(instance.start, tuned) == reason
            continue
        accepted += 1
        instance.start(tuned)
        expected = expected.after()
        for inputs in random_inputs(name, 3, seed=i):
            assert instance.at(inputs) == close(expected(inputs))
    assert accepted > 0
