"""Warnings, refusals and log messages of native FMUs: the same words as in the python flavour."""

import math
from typing import Any

import numpy as np
import pytest
from case import Beyond
from fmpy.fmi1 import FMICallException
from joint_cases import BEYOND, CASES, GOOD, NAMES, RANGES, parameters
from natives import SAME, VERSIONS, Host, attempt, close, jacobian, near, package, settle

from jointfmu.joints import MODELS
from jointfmu.parameters import load_default
from jointfmu.quantity import build_parameter_set as make
from jointfmu.quantity import flatten_parameters

TOO_LARGE = "the inputs are too large, the output tau1 is not finite"
"""Reason of an error by inputs for which the output tau1 of a drive overflows."""


@pytest.fixture(params=NAMES)
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


# Warnings


def test_a_list_of_intermediate_variables_is_left_out_with_a_warning(host: Host, name: str) -> None:
    instance = host(name, "fmi3")
    instance.fmu.fmi3FreeInstance(instance.fmu.component)
    instance.fmu.instantiate(
        logMessage=lambda env, status, category, text: instance._store_log_message(status, category, text),
        requiredIntermediateVariables=[1, 2],
    )
    assert instance.warnings == [
        "fmi3InstantiateCoSimulation: the required intermediate variables are ignored; expected none, "
        "because this FMU has no intermediate update"
    ]
    instance.start(GOOD[name]).step()


@pytest.mark.parametrize(("name", "beyond"), BEYOND)
def test_beyond_the_table_the_last_tangent_continues_with_one_warning(
    host: Host, version: str, exchange: bool, name: str, beyond: Beyond
) -> None:
    driven, far, answer, stiffness, text, inverse, lever = beyond
    instance = host(name, version, exchange=exchange).start(GOOD[name])
    assert not instance.warnings
    x, found = [far, 1.5 * far, 2.0 * far], []
    for value in x:
        found.append(instance.at({driven: value}))
        settle(instance)
    (warning,) = instance.warnings
    assert text in warning
    assert not [m for m in instance.messages if m.fmi_status > 1]
    y = [f[answer] for f in found]
    assert y[2] - y[1] == close(y[1] - y[0])  # a straight line
    tangent = abs((y[1] - y[0]) / (x[1] - x[0])) / lever
    slope = 1.0 / tangent if inverse else tangent
    assert [f[stiffness] for f in found] == close([slope] * 3)
    instance.reset()
    instance.start(GOOD[name] | {driven: far})
    assert instance.warnings == [warning] * 2  # again after a reset


def test_each_way_of_leaving_the_tables_is_warned_of_once_as_in_the_package(
    host: Host, name: str, version: str
) -> None:
    model, rng, also = MODELS[name], np.random.default_rng(37), dict(CASES[name].tuning.also)
    spring, instance = model.tabulate(parameters(name, also)), host(name, version).start(GOOD[name] | also)
    warned: dict[int, str] = {}
    for _ in range(150):
        # far outside, and on both sides of every limit
        state = {k: float(rng.normal()) * 3.0 * max(map(abs, ends)) for k, ends in RANGES[name].items()}
        state |= {v.name: abs(state[v.name]) for v in model.inputs if v.minimum == 0.0}
        outputs = model.evaluate(spring, state)
        for key, text in model.find_warnings(spring, {**state, **outputs}).items():
            warned.setdefault(key, text)
        assert instance.at(state) == near(name, {k: float(v) for k, v in outputs.items()})
        assert instance.warnings == list(warned.values())
    assert len(warned) == len(model.validity_limits)
    assert {m.message_category for m in instance.messages if m.fmi_status == 1} == {"logStatusWarning"}


def test_an_input_at_zero_in_place_of_its_start_value_is_warned_of_once(
    host: Host, fmu: Host, version: str
) -> None:
    """An input at 0 in place of its start value gives one warning, and no second one about its effects.

    Some tools set all inputs to 0 before a run.
    """
    name = "HarmonicDriveSpring"
    zeros = dict.fromkeys((v.name for v in MODELS[name].inputs), 0.0)
    for instance in (host(name, version), fmu(name)):
        instance.start().step()
        assert not instance.warnings
        instance.reset()
        instance.start(zeros)
        instance.get()
        instance.step()
        assert instance.warnings == [
            "temperature = 0 K in place of its start value = 293.15 K: some tools set all inputs to 0; "
            "connect the input, or set its value"
        ]
        instance.reset()
        instance.start()
        instance.set_values(zeros)  # between initialization and the first step
        instance.step()
        assert len(instance.warnings) == 2


# Refusals


def test_a_value_at_the_end_of_every_interval_is_refused_or_not_as_in_the_package(
    host: Host, name: str, version: str
) -> None:
    instance, model = host(name, version), MODELS[name]
    start, refusals = flatten_parameters(load_default(model.joint).values), 0
    for parameter, item in model.parameter_fields().items():
        meta = item.metadata
        if "unit" not in meta:
            continue
        ends = [x for x in (meta["interval"].low, meta["interval"].high) if math.isfinite(x)]
        beside = [math.nextafter(x, side) for x in ends for side in (-math.inf, math.inf) if x or side < 0.0]
        for value in (math.nan, math.inf, -math.inf, *ends, *beside):
            instance.reset()
            instance.enter_initialization()
            instance.set_values({parameter: value})
            reason = attempt(
                lambda v: model.tabulate(make(model.parameter_class, v)), start | {parameter: value}
            )[1]
            if not reason:
                instance.fmu.exitInitializationMode()
                continue
            refusals += 1
            found = instance.refused(instance.fmu.exitInitializationMode)
            if not reason.startswith("the iteration for the largest"):  # round-off decides how that fails
                assert found == reason
    assert refusals > 50


FORBIDDEN: list[tuple[str, dict[str, Any]]] = [
    *((name, {r.parameter: r.value}) for name, case in CASES.items() for r in case.refusals.refused),
    *((name, values) for name, case in CASES.items() for values in case.refusals.forbidden),
]
"""Parameter values that an FMU refuses, one set for every reason: (FMU, {parameter: value})."""


@pytest.mark.parametrize(("name", "values"), FORBIDDEN)
def test_a_refusal_reads_the_same_in_every_flavour(
    host: Host, fmu: Host, name: str, values: dict[str, Any]
) -> None:
    python, start = fmu(name), flatten_parameters(load_default(MODELS[name].joint).values)
    expected = python.refused(python.start, values)
    for version in VERSIONS:
        for exchange in (False, True):
            instance = host(name, version, exchange=exchange)
            before = instance.start(GOOD[name]).get()
            instance.reset()
            assert instance.refused(instance.start, GOOD[name] | values) == expected
            instance.set_values({k: start.get(k, 0.0) for k in values} | GOOD[name])
            instance.fmu.exitInitializationMode()  # a right value may come
            assert instance.get() == before


def test_round_off_below_a_minimum_counts_as_the_minimum_in_every_flavour(
    host: Host, fmu: Host, version: str, exchange: bool
) -> None:
    """A solver that varies an input by round-off below its minimum gets no error."""
    bounded = [(m, v) for m in NAMES for v in MODELS[m].inputs if math.isfinite(v.minimum)]
    assert {v.name for _, v in bounded} >= {"preload", "temperature"}
    for name, variable in bounded:
        for instance in (host(name, version, exchange=exchange), fmu(name)):
            expected = instance.start(GOOD[name]).at({variable.name: variable.minimum})
            assert instance.at({variable.name: variable.minimum - 1e-8}) == expected
            instance.set_values({variable.name: variable.minimum - 2.0 * variable.minimum_margin})
            assert f"{variable.name} = -" in instance.refused(instance.get)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_an_input_that_is_no_number_is_refused_and_the_instance_can_be_used_again(
    host: Host, fmu: Host, name: str, version: str, exchange: bool, value: float
) -> None:
    python = fmu(name).start(GOOD[name])
    instance, bystander = (host(name, version, exchange=exchange).start(GOOD[name]) for _ in range(2))
    before = bystander.get()
    for variable in MODELS[name].inputs:
        python.set_values({variable.name: value})
        expected = python.refused(python.get)
        python.set_values({variable.name: 0.0} | GOOD[name])
        instance.set_values({variable.name: value})
        assert instance.refused(instance.get) == expected
        if not exchange:
            assert instance.refused(instance.step) == expected
        instance.set_values({variable.name: 0.0} | GOOD[name])  # without a reset
        assert instance.get() == before
        settle(instance)
        instance.set_values({variable.name: value})
        instance.refused(instance.get)
        instance.reset()
        assert instance.start(GOOD[name]).get() == before
        settle(instance)
        assert instance.get() == before
    assert bystander.get() == before


def test_inputs_too_large_for_an_output_are_named(host: Host, version: str) -> None:
    instance = host("HarmonicDriveSpring", version).start(GOOD["HarmonicDriveSpring"])
    before = instance.get()
    instance.set_values({"phi2": 1e308, "w2": 3.0})
    listed = "phi2 = 1e+308 rad, w2 = 3 rad/s, temperature = 293.15 K"
    assert instance.refused(instance.step) == f"{listed}: {TOO_LARGE}"
    instance.set_values({"w2": 0.0} | GOOD["HarmonicDriveSpring"])
    assert instance.get() == before


def test_a_refusal_lists_the_largest_inputs_alone(host: Host, version: str) -> None:
    """A refusal names the largest inputs only: with all inputs, the reason at the end would be cut off."""
    instance = host("HarmonicDriveSpring", version).start(GOOD["HarmonicDriveSpring"])
    instance.set_values({"phi1": 4.0, "w1": 5.0, "phi2": 1e308, "w2": 3.0})
    said = instance.refused(instance.step)
    listed = "phi1 = 4 rad, w1 = 5 rad/s, phi2 = 1e+308 rad, temperature = 293.15 K and 1 more"
    assert said == f"{listed}: {TOO_LARGE}"


def test_a_force_that_fades_away_is_never_refused(host: Host, version: str) -> None:
    instance, expected = host("GearContact", version).start(), package("GearContact")
    for f in (5e-324, *10.0 ** np.arange(-320.0, 3.0, 4.0)):
        found, right = instance.at({"f": float(f)}), expected({"f": float(f)})
        for output in ("A_r", "elastic_fraction"):
            assert found[output] == close(right[output])
        assert found["s_rel"] == pytest.approx(right["s_rel"], rel=SAME, abs=1e-20)  # round-off of 1e-5 m
        assert all(math.isfinite(v) for v in jacobian(instance).values())
    assert not instance.warnings


# Log


def test_events_are_logged_on_request_errors_and_warnings_always(host: Host, version: str) -> None:
    for logging in (False, True):
        instance = host("GearContact", version, logging=logging).start({"f": 900.0})
        instance.at({"e": 0.3})
        instance.at({"f": -5.0})
        instance.set_values({"f": math.nan})
        instance.refused(instance.step)
        found = [(m.fmi_status, m.message_category) for m in instance.messages]
        assert found.count((3, "logStatusError")) == 1
        assert found.count((1, "logStatusWarning")) == 1
        events = [m.message_text for m in instance.messages if m.message_category == "logEvents"]
        assert ("tables evaluated again for changed parameters" in events) is logging
        assert len(found) == 2 + len(events)
        assert {m.fmi_status for m in instance.messages if m.message_category == "logEvents"} <= {0}


@pytest.mark.parametrize(
    ("on", "chosen", "expected"),
    [
        (True, ["logEvents"], {"logEvents"}),
        (True, ["logStatusError"], {"logStatusError"}),
        (True, ["logStatusWarning", "logEvents"], {"logStatusWarning", "logEvents"}),
        (True, [], {"logStatusError", "logStatusWarning", "logEvents"}),
        (False, [], {"logStatusError", "logStatusWarning"}),
        (False, ["logEvents"], {"logStatusError", "logStatusWarning"}),
    ],
)
def test_categories_are_selected(
    host: Host, version: str, on: bool, chosen: list[str], expected: set[str]
) -> None:
    instance = host("GearContact", version).start({"f": 900.0})
    instance.fmu.setDebugLogging(on, chosen)
    instance.messages.clear()
    instance.at({"e": 0.3})
    instance.at({"f": -5.0})
    instance.set_values({"f": math.nan})
    with pytest.raises(FMICallException):
        instance.step()
    assert {m.message_category for m in instance.messages} == expected


def test_an_unknown_category_is_refused(host: Host, version: str) -> None:
    instance = host("GearContact", version).start({"f": 900.0})
    message = instance.refused(instance.fmu.setDebugLogging, True, ["logEvents", "logStuff"])
    assert "'logStuff' is unknown; expected logStatusError, logStatusWarning, logEvents" in message
    instance.set_values({"f": math.nan})
    instance.refused(instance.step)  # the selection is as before
