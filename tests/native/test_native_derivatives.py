"""Directional and adjoint derivatives of the native FMUs are those of the package, and exact."""

import math
from pathlib import Path

import numpy as np
import pytest
from clients import needs
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
    instance, inputs = host(name, version).start(), list(STATE[name])
    instance.set_values(STATE[name])  # not accepted: at a corner the mean of both sides is not linear
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
    """One-sided differences of second order above and below an input: {output: differences}."""
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
    """Springs that come into contact under the preload of the first shear are stiff across the shear only."""
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


SIZES = {"preload": 1e4, "moment": 500.0, "s_rel_x": 1e-6, "s_rel_y": 1e-6, "s_rel_z": 5e-7}
SIZES |= {"theta_x": 1e-5, "theta_y": 1e-5, "theta_z": 2e-5, "v_rel_x": 1e-3, "omega_z": 1e-2}
"""Sizes of the inputs [N, N.m, m, rad, m/s, rad/s]."""
MOMENTS = ("initialization", "tried step", "accepted step")
STEPS = (1e-4, 1e-5, 1e-6, 1e-7)
"""Steps of the differences over the size of an input [1]."""


JUMPING = ("K_", "C_loop", "step_", "E_loss")
"""Prefixes of outputs that may jump: stiffnesses at accepted inputs, where slipping points stick after a
reversal; the heat, in third order of the step, where springs come into contact at its end."""


def random_state(rng: np.random.Generator, preload: float, still: float) -> dict[str, float]:
    """Random inputs; each motion is zero with the probability `still`."""
    motions = {n: s * rng.uniform(-0.5, 0.5) * (rng.random() > still) for n, s in SIZES.items() if s < 1e-4}
    state = dict.fromkeys(SIZES, 0.0) | {"preload": preload} | motions
    if rng.random() < 0.6:
        return state
    return state | {"preload": preload * rng.uniform(0.6, 1.2), "moment": rng.uniform(-300.0, 300.0)}


def after_a_history(instance: Fmu, moment: str, seed: int, preload: float) -> dict[str, float]:
    """Inputs after random motion, at a moment of the simulation; every other motion passes through the
    tightened state."""
    rng = np.random.default_rng(seed)
    still = 0.3 if seed % 2 else 0.7
    instance.enter_initialization()
    instance.set_values(state := random_state(rng, preload, still))
    if moment == "initialization":
        return state
    if not seed % 2:
        instance.set_values(dict.fromkeys(SIZES, 0.0) | {"preload": preload})
    instance.fmu.exitInitializationMode()
    steps = 1 + seed % 4
    for step in range(steps):
        instance.set_values(state := random_state(rng, preload, still))
        if step < steps - 1 or moment == "accepted step":
            instance.step()
    return state


def check_mean_of_sides(instance: Fmu, state: dict[str, float], nominal: dict[str, float]) -> None:
    """Assert that the derivatives of all outputs are the mean of the one-sided differences.

    They agree for at least one of the STEPS: a shorter step has more round-off, a longer one crosses other
    kinks. The tolerance is the sum of 1e-4 of the larger difference quotient (truncation), 1 % of the
    difference of both sides, and 1e-13 of the nominal value over the step (round-off; elastic sides find
    their equilibrium to 1e-13 of all forces).
    """
    found = jacobian(instance)
    for name, size in SIZES.items():
        each = [sides(instance, state, name, step * size) for step in STEPS]
        for output in instance.outputs:
            value, missed = found[output, name], []
            gaps = [abs(up - down) for up, down in (ends[output] for ends in each)]
            if output.startswith(JUMPING) and gaps[-1] > 100.0 * gaps[0]:
                continue  # it jumps
            for step, gap, ends in zip(STEPS, gaps, each, strict=True):
                up, down = ends[output]
                least = 1e-13 * nominal.get(output, 1e4) / (step * size)
                allowed = 1e-4 * max(abs(up), abs(down)) + 0.01 * gap + least
                missed.append(abs(value - 0.5 * (up + down)) / allowed)
            assert min(missed) <= 1.0, (output, name, value, [ends[output] for ends in each])


@pytest.mark.parametrize("moment", MOMENTS)
def test_derivatives_in_random_states_are_the_mean_of_both_sides(
    host: Host, version: str, moment: str
) -> None:
    """In random states, the derivative of every output with respect to every input is the mean of the slopes
    on both sides."""
    nominal = {v.name: v.nominal for v in MODELS["BoltedJoint"].outputs}
    for seed in range(16):
        instance = host("BoltedJoint", version)
        check_mean_of_sides(instance, after_a_history(instance, moment, seed, 1e4), nominal)


@needs("gmsh")
@pytest.mark.parametrize("moment", MOMENTS)
def test_derivatives_of_elastic_sides_are_the_mean_of_both_sides(
    host: Host, elastic_joint: Path, version: str, moment: str
) -> None:
    """With elastic sides, too, the derivatives are the mean of both sides.

    The sliders that slip on either side depend on the deformation of the sides in that direction.
    """
    nominal = {v.name: v.nominal for v in MODELS["BoltedJoint"].outputs}
    for seed in (1, 3, 5, 7, 9):
        instance = host("BoltedJoint", version, elastic_joint)
        check_mean_of_sides(instance, after_a_history(instance, moment, seed, 15e3), nominal)


def test_the_largest_of_equal_pressures_has_the_mean_of_both_sides(host: Host, version: str) -> None:
    """A tilt increases the pressure on one side and reduces it on the other, where pressures are equally
    large."""
    instance = host("BoltedJoint", version).start({"preload": 1e4})
    state = {"preload": 1e4, "theta_x": 0.0, "theta_y": 0.0, "moment": 0.0}
    found = jacobian(instance)
    for name in ("theta_x", "theta_y", "moment"):
        up, down = sides(instance, state, name, 1e-4 * SIZES[name])["p_max"]
        assert up == pytest.approx(-down, rel=1e-3)
        assert up > 0.0
        assert abs(found["p_max", name]) <= 1e-6 * up
    assert found["p_max", "preload"] > 0.0


def test_derivatives_by_parameters_and_of_inputs_are_refused(host: Host, version: str) -> None:
    instance = host("GearContact", version).start({"f": 900.0})
    f, e, K = (instance.variables[n].valueReference for n in ("f", "e", "K_N"))
    derivative = instance.fmu.getDirectionalDerivative
    assert "e is among the knowns; expected inputs" in instance.refused(derivative, [K], [e], [1.0])
    assert "f is among the unknowns; expected outputs" in instance.refused(derivative, [f], [f], [1.0])
    instance.set_values({"f": math.nan})
    assert instance.refused(derivative, [K], [f], [1.0]).startswith("f = nan N is outside (-inf, inf)")
