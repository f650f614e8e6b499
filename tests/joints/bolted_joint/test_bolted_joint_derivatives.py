"""Derivatives of the bolted joint's FMU keep the closed relations of the joint."""

import math
from itertools import combinations

import pytest
from joint_cases import RANGES, parameters, random_inputs
from natives import Host, close, jacobian

STILL = dict.fromkeys((f"{rate}_{axis}" for rate in ("v_rel", "omega") for axis in "xyz"), 0.0)
APART = ("preload", "moment", "s_rel_z", "theta_x", "theta_y")
FORCES = ("f_x", "f_y", "f_z", "m_x", "m_y", "m_z")
MOTIONS = ("s_rel_x", "s_rel_y", "s_rel_z", "theta_x", "theta_y", "theta_z")
STIFFNESS = ("K_xx", "K_yy", "K_zz", "K_rx", "K_ry", "K_rz")


@pytest.mark.parametrize("memory", [True, False])
def test_derivatives_keep_the_closed_relations_of_the_bolted_joint(
    host: Host, version: str, memory: bool
) -> None:
    instance, joint = host("BoltedJoint", version), parameters("BoltedJoint")
    given = {"memory": memory, "damping": True, "plastic_damping": True}
    for state in random_inputs("BoltedJoint", 20, seed=34):
        instance.reset()  # the stiffness is that of a further motion: begin as far apart as it ends
        instance.start(given | {name: state[name] for name in APART})
        values = instance.at(state | STILL)
        J = jacobian(instance)
        for f, s, K in zip(FORCES, MOTIONS, STIFFNESS, strict=True):
            if not memory or f in ("f_z", "m_x", "m_y"):  # else it is that of a further motion
                assert J[f, s] == close(-values[K], 1e-9)
        for axis in "xyz":
            assert J[f"f_{axis}", f"v_rel_{axis}"] == close(-values[f"C_{2 * axis}"], 1e-12)
        for (f, s), (g, t) in combinations(zip(FORCES, MOTIONS, strict=True), 2):
            lift = {f, g} & {"f_z", "m_x", "m_y"} and {f, g} & {"f_x", "f_y", "m_z"}
            scale = math.sqrt(abs(J[f, s] * J[g, t]))
            if memory and lift:  # shear does not lift, whatever lifting does to the friction
                assert 0.0 in (J[f, t], J[g, s])
            else:  # a potential
                assert abs(J[f, t] - J[g, s]) <= 1e-9 * scale, (f, t)
    tight = dict.fromkeys(RANGES["BoltedJoint"], 0.0) | {"preload": 9e3}
    instance.reset()
    instance.start(tight)
    assert jacobian(instance)["p_mean", "preload"] == close(joint.n_bolts / joint.A_0, 1e-9)
    apart = instance.at(tight | {"s_rel_z": 1e-3})
    J = jacobian(instance)
    assert apart["p_max"] == 0.0
    assert J["f_z", "preload"] == close(-joint.n_bolts, 1e-9)  # all of it is lost
    assert {value for key, value in J.items() if key[1] not in ("preload", "moment")} == {0.0}
    instance.at(dict.fromkeys(tight, 0.0))  # nor is there anything without preload
    assert set(jacobian(instance).values()) == {0.0}


@pytest.mark.parametrize("memory", [True, False])
def test_all_36_slopes_are_those_of_the_forces_after_a_path(host: Host, version: str, memory: bool) -> None:
    """Against central differences of the same instance, which are trials; slips and openings on the way."""
    states = random_inputs("BoltedJoint", 6, seed=35)
    instance = host("BoltedJoint", version).start({"memory": memory} | states[0])
    for state in states[1:]:
        instance.step()
        values = instance.at(state)
        J = jacobian(instance)
        for s, size in zip(MOTIONS, 3 * [1e-6] + 3 * [1e-5], strict=True):
            h = 1e-4 * size  # truncation h^2, 1e-8, and round-off 1e-16/1e-4; sliders slip between the ends
            up, down = (instance.at(state | {s: state[s] + d * h}) for d in (1.0, -1.0))
            for f in FORCES:
                slope = (up[f] - down[f]) / (2.0 * h)
                scale = abs(J[f, s]) + 1e-2 * abs(values[f]) / size
                assert abs(slope - J[f, s]) <= 1e-3 * scale, (f, s)
        assert instance.at(state) == values  # trials left no trace


def test_slopes_of_accepted_states_are_the_mean_of_both_directions(host: Host, version: str) -> None:
    """On a way whose load changes: forces at their limit are not beyond it by round-off, as the limit's parts
    cancel. Against central differences as above."""
    size = dict(zip(MOTIONS, (3e-7, 2e-7, 1e-7, 3e-6, 3e-6, 6e-6), strict=True))
    instance, h = host("BoltedJoint", version).start({"preload": 9e3}), 1e-10
    for n in range(24):
        state = {s: a * math.sin(0.1 * n * (1.0 + 0.1 * k)) for k, (s, a) in enumerate(size.items())}
        instance.at(state)
        instance.step()
        J = jacobian(instance)
        up, down = (instance.at(state | {"s_rel_x": state["s_rel_x"] + d * h}) for d in (1.0, -1.0))
        for f in ("f_x", "f_y"):
            slope = (up[f] - down[f]) / (2.0 * h)
            assert abs(slope - J[f, "s_rel_x"]) <= 1e-3 * abs(J["f_x", "s_rel_x"]), (n, f)
        instance.at(state)


def test_an_accepted_state_tells_the_tangent_of_a_further_motion(fmu: Host, host: Host, version: str) -> None:
    """Whatever the steps that led there: K_yy, K_rz and derivatives against differences of the same instance.

    Along x sliders at their limits slip on or stick: K_xx is the slope of going on, the derivative the mean.
    """
    end, found = 0.6e-6, []
    for steps in (1, 7, 200):
        instance, python = host("BoltedJoint", version).start({"preload": 9e3}), fmu("BoltedJoint")
        python.start({"preload": 9e3})
        for k in range(steps):
            tried = instance.at({"s_rel_x": end * (k + 1) / steps})
            instance.step()
        values, J = instance.get(), jacobian(instance)
        assert values == tried
        at = instance.at
        for s, f, K in (("s_rel_y", "f_y", "K_yy"), ("theta_z", "m_z", "K_rz")):
            h = 1e-11 if s == "s_rel_y" else 1e-10  # sliders at their limits turn by a ten-thousandth
            up, down = (at({"s_rel_x": end, s: d * h})[f] for d in (1.0, -1.0))
            at({s: 0.0})
            assert values[K] == pytest.approx((down - up) / (2.0 * h), rel=1e-3)
            assert J[f, s] == close(-values[K], 1e-9 if K == "K_yy" else 1e-3)  # K_rz of one direction
        on, there = (at({"s_rel_x": end + d})["f_x"] for d in (1e-12, 0.0))
        assert values["K_xx"] == pytest.approx((there - on) / 1e-12, rel=1e-3)
        back = at({"s_rel_x": end - 1e-12})["f_x"]
        assert J["f_x", "s_rel_x"] == pytest.approx((on - back) / 2e-12, rel=1e-3)  # of both directions
        assert instance.at({"s_rel_x": end}) == values
        found.append([values[K] for K in ("K_xx", "K_yy", "K_rz")])
        if steps < 10:
            for k in range(steps):
                python.at({"s_rel_x": end * (k + 1) / steps})
                python.step()
            assert python.get() == close(values)
            assert python.at({"s_rel_x": end}) == close(values)
    assert found[0] == close(found[1], 1e-9)
    assert found[0] == close(found[2], 1e-9)
