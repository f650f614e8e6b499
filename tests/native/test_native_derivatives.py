"""Directional and adjoint derivatives of the native FMUs are those of the package, and exact."""

import math

import numpy as np
import pytest
from conftest import Fmu
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
            one.set_values(state)
        found, *others = map(jacobian, natives)
        assert others == [found] * 3
        for moved in state:
            check_slopes(name, state, moved, {output: found[output, moved] for output in three.outputs})
        model = MODELS[name]
        apart = {key for key in found if key[1] not in model.list_dependencies(key[0])}
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
    instance.set_values({i: 1.1 * value for i, value in STATE[name].items()})
    assert jacobian(instance) != before  # it is that of the present inputs, though no output was read
    instance.set_values(STATE[name])
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


def sides(instance: Fmu, state: dict[str, float], name: str, h: float) -> dict[str, tuple[float, float]]:
    """{output: differences of second order above and below an input}."""
    here, at = instance.at(state), {k: instance.at({name: state[name] + k * h}) for k in (-2, -1, 1, 2)}
    instance.at(state)
    return {
        o: tuple((4.0 * at[k][o] - 3.0 * y - at[2 * k][o]) / (2.0 * k * h) for k in (1, -1))
        for o, y in here.items()
    }


@pytest.mark.parametrize("accepted", [False, True])
def test_stiffnesses_of_a_sheared_joint_have_the_slopes_of_their_differences(
    host: Host, version: str, accepted: bool
) -> None:
    """Springs that begin to touch under the preload of the first shear count: stiff across it alone."""
    state = {"preload": 3e4, "s_rel_x": 5e-7, "s_rel_z": 0.0}
    instance = host("BoltedJoint", version).start({"preload": 3e4})
    instance.set_values(state)
    if accepted:
        instance.step()
    found = jacobian(instance)
    for name, h in (("preload", 0.3), ("s_rel_z", 1e-13)):
        expected = sides(instance, state, name, h)
        for output in ("K_xx", "K_yy", "K_zz", "K_rx", "K_ry", "K_rz"):
            # once accepted, all at their limits stick as soon as these grow: K_xx and K_rz jump
            up, down = expected[output]
            jumps = accepted and output in ("K_xx", "K_rz")
            grown = down if name == "preload" else up
            least = 1e-6 * abs(found["K_zz", name])
            for value in (grown,) if jumps else (up, down):
                assert found[output, name] == pytest.approx(value, rel=2e-3, abs=least), (output, name)
    assert found["K_yy", "preload"] == pytest.approx(886_260, rel=1e-4)


def test_derivatives_after_a_history_are_those_of_differences(host: Host, version: str) -> None:
    """All outputs by all inputs at tried states: within both sides, which differ at corners."""
    nominal = {v.name: v.nominal for v in MODELS["BoltedJoint"].outputs}
    sizes = {"preload": 1e4, "s_rel_x": 1e-6, "s_rel_y": 1e-6, "s_rel_z": 5e-7}
    sizes |= {"theta_x": 1e-5, "theta_y": 1e-5, "theta_z": 2e-5, "v_rel_x": 1e-3, "omega_z": 1e-3}
    for seed in range(5):
        rng, instance = np.random.default_rng(seed), host("BoltedJoint", version).start({"preload": 1e4})
        for step in range(5):
            state = {name: size * rng.uniform(-0.5, 0.5) for name, size in sizes.items() if size < 1.0}
            instance.set_values(state := {"preload": 1e4 * (1.0 - 0.3 * (step % 2)), **state})
            if step < 4:
                instance.step()
        here, found = instance.get(), jacobian(instance)
        for name, size in sizes.items():
            for output, ends in sides(instance, state, name, 1e-6 * size).items():
                least = 1e-3 * max(abs(here[output]), 1e-6 * nominal[output]) / size
                low, high = min(ends) - least, max(ends) + least
                assert low <= found[output, name] <= high, (seed, output, name)


def test_derivatives_by_parameters_and_of_inputs_are_refused(host: Host, version: str) -> None:
    instance = host("GearContact", version).start({"f": 900.0})
    f, e, K = (instance.variables[n].valueReference for n in ("f", "e", "K_N"))
    derivative = instance.fmu.getDirectionalDerivative
    assert "e is among the knowns; expected inputs" in instance.refused(derivative, [K], [e], [1.0])
    assert "f is among the unknowns; expected outputs" in instance.refused(derivative, [f], [f], [1.0])
    instance.set_values({"f": math.nan})
    assert instance.refused(derivative, [K], [f], [1.0]).startswith("f = nan N is outside (-inf, inf)")
