"""Directional and adjoint derivatives of the native FMUs are those of the package, and exact."""

import math

import numpy as np
import pytest
from natives import DIFFERENCE, JUMPS, NAMES, VERSIONS, Host, close, differences, jacobian
from test_fmu_values import RANGES, STATE, parameters, random_inputs

from jointfmu.joints import MODELS


@pytest.fixture(params=NAMES)
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


def test_directional_derivatives_are_those_of_the_package(host: Host, name: str, exchange: bool) -> None:
    two, three = (host(name, v, exchange=exchange).start() for v in VERSIONS)
    for state in random_inputs(name, 12, seed=32):
        values = three.at(state)
        two.set(state)
        found = jacobian(three)
        assert jacobian(two) == found
        for moved in state:
            expected, size = differences(name, state, moved)
            for output, value in values.items():
                scale = max(abs(value), abs(found[output, moved]) * size)
                allowed = (JUMPS if output == "K_zz" else DIFFERENCE) * scale / size
                assert abs(found[output, moved] - expected[output]) <= allowed, (output, moved)
        model = MODELS[name]
        apart = {key for key in found if key[1] not in model.depends(key[0])}
        assert {key: found[key] for key in apart} == dict.fromkeys(apart, 0.0)


def test_derivatives_keep_the_closed_relations_of_the_drive(host: Host, version: str) -> None:
    ratio, d = 80.0, 0.7
    spring = host("HarmonicDriveSpring", version).start({"ratio": ratio, "d": d})
    compliance = host("HarmonicDriveCompliance", version).start()
    beyond = {"phi1": 0.0, "w1": 0.0, "phi2": 0.05, "w2": 1.0}
    for state in (*random_inputs("HarmonicDriveSpring", 20, seed=33), beyond):
        values, J = spring.at(state), jacobian(spring)
        K = values["K_WTS"]
        assert J["tau", "phi2"] == close(K, 1e-12)
        assert J["tau", "phi1"] == close(-K / ratio, 1e-12)
        assert (J["tau", "w2"], J["tau", "w1"]) == close((d, -d / ratio), 1e-12)
        for moved in state:
            assert J["tau1", moved] == close(J["tau", moved] / ratio, 1e-12)
            assert J["tau2", moved] == -J["tau", moved]
            series = J["K_TS", moved] / values["K_TS"] ** 2 - J["K_WTS", moved] / K**2
            assert abs(series) <= 1e-12 * abs(J["K_WTS", moved]) / K**2
        assert (J["phi_rel", "phi1"], J["phi_rel", "phi2"]) == close((-1.0 / ratio, 1.0), 1e-12)
    assert J["K_WTS", "phi2"] == 0.0  # beyond the table: a straight line
    for tau in (*np.linspace(-29.0, 29.0, 15), 100.0):
        wound, J = compliance.at({"tau": float(tau)}), jacobian(compliance)
        assert J["phi_rel", "tau"] == close(1.0 / wound["K_WTS"], 1e-12)
    assert J["K_WTS", "tau"] == 0.0


def test_derivatives_keep_the_closed_relations_of_the_bolted_joint(host: Host, version: str) -> None:
    instance, joint = host("BoltedJoint", version).start(), parameters("BoltedJoint")
    for state in random_inputs("BoltedJoint", 20, seed=34):
        values = instance.at(state | {"v_rel_x": 0.0, "v_rel_y": 0.0, "v_rel_z": 0.0})
        J = jacobian(instance)
        for axis in "xyz":
            K, C = values[f"K_{2 * axis}"], values[f"C_{2 * axis}"]
            assert J[f"f_{axis}", f"s_rel_{axis}"] == close(-K, 1e-10)
            assert J[f"f_{axis}", f"v_rel_{axis}"] == close(-C, 1e-12)
        for a, b in ("xy", "xz", "yz"):  # a potential
            mixed = J[f"f_{a}", f"s_rel_{b}"]
            assert abs(mixed - J[f"f_{b}", f"s_rel_{a}"]) <= 1e-12 * values["K_zz"]
        about = J["K_rx", "s_rel_z"] + J["K_ry", "s_rel_z"]
        share = values["K_rz"] / (values["K_rx"] + values["K_ry"])
        assert J["K_rz", "s_rel_z"] == close(share * about, 1e-12)
    tight = dict.fromkeys(RANGES["BoltedJoint"], 0.0) | {"preload": 9e3}
    instance.at(tight)
    assert jacobian(instance)["p_mean", "preload"] == close(joint.n_bolts / joint.A_0, 1e-9)
    apart = instance.at(tight | {"s_rel_z": 1e-3})
    J = jacobian(instance)
    assert apart["p_max"] == 0.0
    assert J["f_z", "preload"] == close(-joint.n_bolts, 1e-9)  # all of it is lost
    assert {value for key, value in J.items() if key[1] not in ("preload", "moment")} == {0.0}
    instance.at(dict.fromkeys(tight, 0.0))  # nor is there anything without preload
    assert set(jacobian(instance).values()) == {0.0}


def test_derivatives_keep_the_closed_relations_of_the_gear_contact(host: Host, version: str) -> None:
    instance = host("GearContact", version).start()
    for f in (1e-3, 1.0, 300.0, 2e4, 6e4, 1e6):
        values, J = instance.at({"f": f}), jacobian(instance)
        assert J["s_rel", "f"] == close(1.0 / values["K_N"], 1e-12)
        assert J["A_r", "f"] > 0.0
    for f in (0.0, -5.0):
        instance.at({"f": f})
        assert set(jacobian(instance).values()) == {0.0}


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
