"""The compiled joint and the Python law give the same numbers for every joint and law."""

import gc
import itertools
import pickle

import numpy as np
import pytest
from clients import needs
from joint_cases import NAMES, random_inputs
from jointfmu_tools.run import engine
from jointfmu_tools.run.engine import CompiledJoint, ParametricJoint, PythonJoint, open_joint
from surroundings import environment, missing_package, temporary_folder

import jointfmu
from jointfmu.joints import KINDS, MODELS
from jointfmu.parameters import load_default

LAWS = [(name, law, model.name) for name, kind in KINDS.items() for law in kind.laws for model in kind.models]
SAME = 1e-9
"""Largest difference [1] of FMU and package on a path, over the largest value of the output."""


def a_path(python, seed, count=25):
    """Random inputs that the joint accepts: within its load ramp and the motions of its load cycle."""
    model, random = python.fmu_model, np.random.default_rng(seed)
    ramp, start = model.ramp, {v.name: 0.0 for v in model.inputs}
    inputs = start | {ramp.input_name: ramp.end_value * random.uniform(0.1, 0.9)}
    if model.load_cycle:
        inputs |= {n: float(v) for n, v in model.load_cycle.variable_values.items() if n in inputs}
        name, amplitude = model.load_cycle.input_name, model.load_cycle.input_amplitude
        inputs[name] = amplitude * random.uniform(-1.0, 1.0, count)
    else:
        inputs[ramp.input_name] = ramp.end_value * random.uniform(0.0, 1.0, count)
    return inputs


def largest_difference(one, other):
    """Largest difference of two results over the largest value of each output."""
    sizes = {name: float(np.max(np.abs(column))) or 1.0 for name, column in other.variable_columns.items()}
    return max(
        float(np.max(np.abs(one.variable_columns[n] - other.variable_columns[n]))) / size
        for n, size in sizes.items()
    )


@pytest.mark.parametrize(("kind", "law", "fmu"), LAWS)
def test_the_compiled_joint_gives_the_numbers_of_the_python_law(kind, law, fmu):
    file = load_default(kind, law)
    model = KINDS[kind].find_model(fmu).with_parameters(kind, file.values)
    compiled, python = CompiledJoint(model, file), PythonJoint(model, file)
    for seed, each in enumerate((False, True)):
        path = a_path(python, seed)
        assert (
            largest_difference(
                compiled.evaluate_path(path, restart_at_each_point=each),
                python.evaluate_path(path, restart_at_each_point=each),
            )
            <= SAME
        )
    values = {name: file.values_by_name[name] for name in model.parameter_fields()}
    number = next(name for name, value in values.items() if isinstance(value, float) and value)
    for joint in (compiled, python):
        joint.set_parameters({number: 1.01 * values[number]})
    path = a_path(python, 2)
    found = compiled.evaluate_path(path)
    assert largest_difference(found, python.evaluate_path(path)) <= SAME


@pytest.mark.parametrize("name", NAMES)
def test_any_motion_has_the_numbers_of_the_python_law(name):
    """Compiled joint and Python law agree along random motions: inputs change together, then one by one.

    The contacts stick, slip, open and close.
    """
    file, corners = load_default(MODELS[name].joint), random_inputs(name, 12, seed=7)
    model = MODELS[name].with_parameters(file.joint, file.values)
    rows = [
        {n: a[n] + part * (b[n] - a[n]) for n in a}
        for a, b in itertools.pairwise(corners)
        for part in (0.0, 1e-5, 0.03, 0.3)
    ]
    for n in rows[0]:
        rows.append(rows[-1] | {n: corners[0][n]})
    path = {n: np.array([row[n] for row in rows]) for n in rows[0]}
    found, expected = (joint(model, file).evaluate_path(path) for joint in (CompiledJoint, PythonJoint))
    assert largest_difference(found, expected) <= SAME


def test_a_path_begins_in_the_virgin_state():
    plate = jointfmu.load("BoltedJoint")
    path = {"preload": 9e3, "s_rel_x": [0.0, 5e-6, 0.0]}
    first = plate.follow(**path)
    np.testing.assert_array_equal(plate.follow(**path)["f_x"], first["f_x"])
    assert plate.evaluate(**path)["f_x"][2] == 0.0 != first["f_x"][2]


def test_both_refuse_the_same_value_with_one_line():
    file = load_default("bolted_joint")
    model = KINDS["bolted_joint"].models[0]
    for joint in (CompiledJoint(model, file), PythonJoint(model, file)):
        joint.set_parameters({"mu": -1.0})
        with pytest.raises(ValueError, match=r"mu = -1 is outside") as refused:
            joint.evaluate_path({"preload": 9e3})
        assert "\n" not in str(refused.value)
        joint.set_parameters({"mu": 0.2})
        assert joint.evaluate_path({"preload": 9e3}).variable_columns["K_zz"][0] > 0.0


def test_a_warning_is_given_by_each_path_that_exceeds_the_law():
    plate = jointfmu.load("BoltedJoint")
    end = float(plate.values["H"] * plate.values["A_0"])
    for _ in range(2):
        (text,) = plate.evaluate(preload=[9e3, end, 2.0 * end]).messages
        assert "is outside" in text
    assert not plate.evaluate(preload=9e3).messages


@needs("gmsh")
def test_a_plot_leaves_the_library_of_the_joint_as_it_is(elastic_joint):
    """The bolt forces of elastic sides are outputs only once, even if the model gets the parameters twice."""
    plate = jointfmu.load(elastic_joint / "joint.toml")
    before = plate.follow(s_rel_x=[0.0, 1e-6])
    plate.plot()
    again = jointfmu.load(elastic_joint / "joint.toml")
    model = again.model()
    assert model.with_parameters("bolted_joint", again.file.values).outputs == model.outputs
    np.testing.assert_array_equal(again.follow(s_rel_x=[0.0, 1e-6])["F_bolt[4]"], before["F_bolt[4]"])


def test_trial_parameters_give_the_joint_that_has_them():
    file = load_default("bolted_joint")
    trial = ParametricJoint(KINDS["bolted_joint"].models[0])
    path = {"preload": 9e3, "s_rel_x": [0.0, 5e-6, 0.0]}
    not_exposed = {"pattern.decay_length": 1.1 * file.values_by_name["pattern.decay_length"]}
    for values in ({"mu": 0.1}, {"mu": 0.3, "H": 2e9}, not_exposed, {"mu": 0.1}):
        parameters = file.with_values(values, "user", "test").values
        expected = jointfmu.load("BoltedJoint").with_values(values).follow(**path)
        found = trial.open_with_parameters(parameters).evaluate_path(path).variable_columns
        np.testing.assert_array_equal(found["f_x"], expected["f_x"], str(values))


def test_without_a_compiler_the_python_law_answers_and_says_so(tmp_path, enter, capsys):
    file = load_default("gear_contact")
    model = KINDS["gear_contact"].models[0]
    wanted = CompiledJoint(model, file).evaluate_path({"f": [0.0, 500.0]})

    enter(environment(JOINTFMU_CACHE=str(tmp_path)))
    enter(missing_package("ziglang"))
    engine._announce_python_evaluation.cache_clear()
    for _ in range(2):
        joint = open_joint(model, file)
        assert isinstance(joint, PythonJoint)
    assert largest_difference(joint.evaluate_path({"f": [0.0, 500.0]}), wanted) <= SAME
    (line,) = capsys.readouterr().err.splitlines()
    assert "ziglang" in line
    assert "pip install 'jointfmu[build]'" in line


def test_on_a_platform_without_libraries_the_python_law_answers(monkeypatch, capsys):
    monkeypatch.setattr("platform.machine", lambda: "riscv64")
    engine._announce_python_evaluation.cache_clear()
    file = load_default("gear_contact")
    joint = open_joint(KINDS["gear_contact"].models[0], file)
    assert isinstance(joint, PythonJoint)
    assert "platform riscv64-" in capsys.readouterr().err


def test_the_file_of_a_library_goes_with_its_joint(tmp_path, enter):
    enter(temporary_folder(tmp_path))
    contact = jointfmu.load("GearContact")
    contact.evaluate(f=500.0)
    assert [*tmp_path.iterdir()]
    again = pickle.loads(pickle.dumps(contact))
    np.testing.assert_array_equal(again.evaluate(f=500.0)["K_N"], contact.evaluate(f=500.0)["K_N"])
    del contact, again
    gc.collect()
    assert not [*tmp_path.iterdir()]


def test_without_history_the_compiled_joint_gives_the_numbers_of_the_python_law():
    file = load_default("bolted_joint").with_values({"memory": False}, "user", "test")
    model = KINDS["bolted_joint"].models[0].with_parameters("bolted_joint", file.values)
    compiled, python = CompiledJoint(model, file), PythonJoint(model, file)
    moments = {"s_rel_y": 1e-6, "theta_x": 1e-5, "theta_y": 2e-5, "theta_z": 1e-5}  # not only round-off
    path = a_path(python, 3) | moments
    assert largest_difference(compiled.evaluate_path(path), python.evaluate_path(path)) <= SAME
