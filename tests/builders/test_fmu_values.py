"""Outputs of the FMUs: equal to the package's laws, at any time, and consistent with each other."""

import csv
import io
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from conftest import Fmu
from fmpy import simulate_fmu
from joint_cases import CASES, NAMES, RANGES, SAME, STATE, law, parameters, random_inputs
from jointfmu_fmu_src.building import build_fmus
from jointfmu_tools.run.ramps import ramp

from jointfmu.joints import MODELS
from jointfmu.parameters import load_default
from jointfmu.quantity import flatten_parameters

Host = Callable[..., Fmu]


@pytest.fixture(params=NAMES)
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


# The numbers themselves


def test_outputs_are_those_of_the_package(fmu: Host, name: str) -> None:
    instance, expected = fmu(name).start(), law(name, parameters(name)).after()
    for inputs in random_inputs(name, 40, seed=1):
        assert instance.at(inputs) == pytest.approx(expected(inputs), rel=SAME)
    assert not instance.messages


def test_random_parameters_reach_the_law(fmu: Host, name: str) -> None:
    rng, start = np.random.default_rng(2), flatten_parameters(load_default(MODELS[name].joint).values)
    instance = fmu(name)
    for inputs in random_inputs(name, 5, seed=3):
        scaled = {k: start[k] * float(rng.uniform(0.95, 1.05)) for k in MODELS[name].parameter_fields()}
        scaled |= {k: float(rng.integers(*ends)) for k, ends in CASES[name].tuning.counted.items()}
        instance.reset()
        changes = {k: v for k, v in scaled.items() if not isinstance(start[k], bool)}
        instance.start(changes | inputs)
        assert instance.get() == pytest.approx(law(name, parameters(name, changes))(inputs), rel=SAME)


def test_each_parameter_changes_the_outputs_that_it_should(fmu: Host, name: str) -> None:
    start, case = flatten_parameters(load_default(MODELS[name].joint).values), CASES[name]
    base = dict(case.tuning.base)
    instance, without = fmu(name).start(base | STATE[name]), set()
    before = instance.get()
    assert all(before.values())
    for parameter in MODELS[name].parameter_fields():
        value = (start | base)[parameter]
        change = (not value) if isinstance(value, bool) else case.tuning.moved.get(parameter, 1.001 * value)
        instance.reset()
        instance.start(base | {parameter: change} | STATE[name])
        found = instance.get()
        expected = law(name, parameters(name, base | {parameter: change}))(STATE[name])
        assert found == pytest.approx(expected, rel=SAME), parameter
        if found == pytest.approx(before, rel=SAME):
            without.add(parameter)
    assert without == case.tuning.without_effect


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
    """Outputs of models without history depend on the present inputs only."""
    there, back = random_inputs(name, 2, seed=6)
    instance = fmu(name).start(there | CASES[name].tuning.also)
    before = instance.get()
    instance.at(back)
    instance.step()
    assert instance.get() != before
    assert instance.at(there) == before


# Load ramps


def test_ten_times_larger_steps_meet_the_same_points(fmus: Path, name: str) -> None:
    path, r = fmus / f"{name}.fmu", MODELS[name].ramp
    fine, coarse = (
        ramp.run_ramp(path, r.input_name, r.end_value, r.value_step * factor) for factor in (1.0, 10.0)
    )
    assert not fine.log_messages
    for column, values in coarse.variable_columns.items():
        # nothing depends on the way there; only the points differ by round-off
        np.testing.assert_allclose(values, fine.variable_columns[column][::10], rtol=1e-9, atol=1e-15)


def test_a_partial_last_step_ends_exactly_where_asked(fmus: Path) -> None:
    path = fmus / "HarmonicDriveCompliance.fmu"
    found = ramp.run_ramp(path, "tau", -1.0, -0.3)
    assert found.variable_columns["tau"] == pytest.approx([0.0, -0.3, -0.6, -0.9, -1.0], rel=SAME)
    whole = ramp.run_ramp(path, "tau", -1.0, -1.0)
    assert found.variable_columns["phi_rel"][-1] == whole.variable_columns["phi_rel"][-1]


def test_a_ramp_takes_settings_of_parameters_and_inputs(fmus: Path) -> None:
    settings = {"surface.D": 1.45, "moment": 300.0}
    c = ramp.run_ramp(fmus / "BoltedJoint.fmu", "preload", 9e3, 9e3, settings).variable_columns
    inputs = dict.fromkeys(RANGES["BoltedJoint"], 0.0) | {"preload": 9e3, "moment": 300.0}
    expected = law("BoltedJoint", parameters("BoltedJoint", {"surface.D": 1.45}))(inputs)
    assert {k: v[-1] for k, v in c.items() if k != "preload"} == pytest.approx(expected, rel=SAME)
    gear = ramp.run_ramp(fmus / "GearContact.fmu", "f", 1e3, 1e3, {"rigid_flat": False}).variable_columns
    softer = law("GearContact", parameters("GearContact", {"rigid_flat": False}))({"f": 1e3})
    assert gear["K_N"][-1] == pytest.approx(softer["K_N"], rel=SAME)


def test_csv_holds_every_output_with_its_unit_to_the_last_bit(fmus: Path) -> None:
    result = ramp.run_ramp(fmus / "GearContact.fmu", "f", 100.0, 30.0)
    header, *rows = csv.reader(io.StringIO(result.format_time_series_csv()))
    assert header == ["f [N]", "s_rel [m]", "K_N [N/m]", "A_r [m2]", "elastic_fraction [1]"]
    assert len(rows) == 5
    columns = np.array(rows, dtype=float).T
    for found, expected in zip(columns, result.variable_columns.values(), strict=True):
        assert np.array_equal(found, expected)


def test_fmpy_simulates_the_load_ramp(fmus: Path, name: str) -> None:
    r = MODELS[name].ramp
    stop = r.end_value / r.value_step
    signal = np.array([(0.0, 0.0), (stop, r.end_value)], dtype=[("time", float), (r.input_name, float)])
    found = simulate_fmu(str(fmus / f"{name}.fmu"), input=signal, stop_time=stop, output_interval=stop / 10)
    assert len(found) == 11
    at_end = ramp.run_ramp(
        fmus / f"{name}.fmu", r.input_name, r.end_value * 0.9, r.end_value * 0.9
    ).variable_columns
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


def test_a_restored_instance_is_past_initialization(fixed: Host) -> None:
    sender, receiver = fixed("GearContact").start({"f": 500.0}), fixed("GearContact").start()
    data = sender.fmu.serializeFMUState(sender.fmu.getFMUstate())
    receiver.fmu.setFMUstate(receiver.fmu.deSerializeFMUstate(data))
    assert "fixed parameter" in receiver.refused(receiver.set_values, {"e": 0.3})
    assert receiver.get() == sender.get()


@pytest.mark.parametrize(
    ("name", "moves", "tuned"),
    [
        ("BoltedJoint", ("s_rel_x", (3e-6, -2e-6, -2e-6, 4e-6, 0.0)), {"mu": 0.3, "H": 2e9}),
        ("HarmonicDriveSpring", ("phi2", (4e-4, -2e-4, -2e-4, 5e-4, 0.0)), {"K_FTS0": 8e3, "mu": 0.12}),
    ],
)
def test_parameters_are_tuned_during_a_run_as_in_the_native_flavour(
    fmu: Host, native: Path, name: str, moves: tuple[str, tuple[float, ...]], tuned: dict[str, float]
) -> None:
    """The path continues from the accepted inputs; the friction of the drive acts too."""
    acting = {"BoltedJoint": {"preload": 9e3}, "HarmonicDriveSpring": {"hysteresis_loss": 3e-4}}[name]
    found = []
    for instance in (fmu(name), fmu(name, folder=native / "fmi2")):
        instance.start(acting)
        rows = []
        for i, value in enumerate(moves[1]):
            if i == 2:
                instance.set_values(tuned)
                rows.append(instance.get(*instance.outputs))
            instance.set_values({moves[0]: value})
            instance.step()
            rows.append(instance.get(*instance.outputs))
        found.append(rows)
    for own, other in zip(*found, strict=True):
        for output, value in other.items():
            scale = max(abs(row[output]) for row in found[1])
            assert own[output] == pytest.approx(value, rel=1e-9, abs=1e-9 * scale), output


def test_reset_restores_the_defaults(fmu: Host, name: str) -> None:
    fresh, used = fmu(name).start(), fmu(name)
    names = [v.name for v in fresh.variables.values() if v.type == "Real"]
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
    file = load_default("gear_contact").with_values({"e": 0.3, "rigid_flat": False}, "user", "test")
    build_fmus([], ["python"], file, tmp_path)
    assert [p.name for p in (tmp_path / "python").iterdir()] == ["GearContact.fmu"]
    other = fmu("GearContact", tmp_path / "python").start({"f": 2e4})
    expected = law("GearContact", file.values)({"f": 2e4})
    assert other.get() == pytest.approx(expected, rel=SAME)
    assert other.get() != fmu("GearContact").start({"f": 2e4}).get()


def test_an_output_changes_with_the_inputs_it_is_said_to_depend_on_and_with_no_other(name: str) -> None:
    model, base = MODELS[name], dict(CASES[name].tuning.base)
    laws = [law(name, parameters(name, base | more)) for more in ({}, dict(CASES[name].tuning.also))]
    laws += [from_rest.after() for from_rest in laws]  # some of a memory acts once it has begun
    still = [found(STATE[name]) for found in laws]
    for variable in model.inputs:
        state = {**STATE[name], variable.name: 1.01 * STATE[name][variable.name]}
        both = list(zip([found(state) for found in laws], still, strict=True))
        changed = {o.name for o in model.outputs if any(m[o.name] != s[o.name] for m, s in both)}
        assert changed == {o.name for o in model.outputs if variable.name in model.list_dependencies(o.name)}
