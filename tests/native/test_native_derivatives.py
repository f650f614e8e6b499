"""Directional and adjoint derivatives of the native FMUs are those of the package, and exact."""

import math

import numpy as np
import pytest
from joint_cases import NAMES, STATE, random_inputs
from natives import VERSIONS, Host, check_slopes, jacobian

from jointfmu.joints import MODELS


@pytest.fixture(params=NAMES)
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


def test_directional_derivatives_are_those_of_the_package(host: Host, name: str) -> None:
    natives = [host(name, v, exchange=kind).start() for v in VERSIONS for kind in (False, True)]
    three = natives[-1]
    for state in random_inputs(name, 12, seed=32):
        for one in natives:
            one.set(state)
        found, *others = map(jacobian, natives)
        assert others == [found] * 3
        for moved in state:
            check_slopes(name, state, moved, {output: found[output, moved] for output in three.outputs})
        model = MODELS[name]
        apart = {key for key in found if key[1] not in model.depends(key[0])}
        assert {key: found[key] for key in apart} == dict.fromkeys(apart, 0.0)


def test_derivatives_are_linear_in_the_seed_and_follow_the_state(host: Host, name: str, version: str) -> None:
    instance = host(name, version).start(STATE[name])
    inputs = list(STATE[name])
    knowns = [instance.variables[i].valueReference for i in inputs]
    before = jacobian(instance)
    seed = list(np.random.default_rng(35).normal(size=len(inputs)) * list(STATE[name].values()))
    for unknown in reversed(instance.outputs):  # some of the outputs, in another order than theirs
        (found,) = instance.fmu.getDirectionalDerivative(
            [instance.variables[unknown].valueReference], knowns, seed
        )
        terms = [before[unknown, i] * s for i, s in zip(inputs, seed, strict=True)]
        assert abs(found - sum(terms)) <= 1e-12 * sum(map(abs, terms))
    values = instance.get()
    assert jacobian(instance) == before  # asking changes nothing
    instance.set({i: 1.1 * value for i, value in STATE[name].items()})
    assert jacobian(instance) != before  # it is that of the present inputs, though no output was read
    instance.set(STATE[name])
    assert instance.get() == values


def test_the_adjoint_is_the_transpose(host: Host, name: str, exchange: bool) -> None:
    instance, rng = host(name, "fmi3", exchange=exchange).start(), np.random.default_rng(36)
    for state in random_inputs(name, 5, seed=36):
        instance.at(state)
        J, inputs = jacobian(instance), list(state)
        knowns = [instance.variables[i].valueReference for i in inputs]
        unknowns = [instance.variables[o].valueReference for o in instance.outputs]
        for output, reference in zip(instance.outputs, unknowns, strict=True):
            row = instance.fmu.getAdjointDerivative([reference], knowns, [1.0], len(knowns))
            assert row == [J[output, i] for i in inputs]
        seed = [float(rng.normal()) / max(abs(v), 1e-300) for v in instance.get().values()]
        found = instance.fmu.getAdjointDerivative(unknowns, knowns, seed, len(knowns))
        for i, value in zip(inputs, found, strict=True):
            terms = [s * J[o, i] for o, s in zip(instance.outputs, seed, strict=True)]
            assert abs(value - sum(terms)) <= 1e-12 * sum(map(abs, terms))


def test_derivatives_by_parameters_and_of_inputs_are_refused(host: Host, version: str) -> None:
    instance = host("GearContact", version).start({"f": 900.0})
    f, e, K = (instance.variables[n].valueReference for n in ("f", "e", "K_N"))
    derivative = instance.fmu.getDirectionalDerivative
    assert "e is among the knowns; expected inputs" in instance.refused(derivative, [K], [e], [1.0])
    assert "f is among the unknowns; expected outputs" in instance.refused(derivative, [f], [f], [1.0])
    instance.set({"f": math.nan})
    assert instance.refused(derivative, [K], [f], [1.0]).startswith("f = nan N is outside (-inf, inf)")
