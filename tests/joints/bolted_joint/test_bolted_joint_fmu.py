"""The FMU of the bolted joint: equal to its law, with a potential, and nothing left when pulled apart."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import Fmu
from joint_cases import RANGES, SAME, STATE, TABLE, parameters, random_inputs
from jointfmu_tools.ramps import ramp
from natives import SAME as SAME_FLAVOURS
from natives import jacobian, near, package
from scipy.integrate import cumulative_simpson

from jointfmu.contact.interface import stiffness_curve
from jointfmu.joints.bolted_joint.law import pressures, shear_ratio
from jointfmu.joints.bolted_joint.spring import BoltedJointSpring

Host = Callable[..., Fmu]


def test_bolted_joint_at_rest_follows_the_law_without_a_table(fmu: Host) -> None:
    joint, instance = parameters("BoltedJoint"), fmu("BoltedJoint").start()
    spring = BoltedJointSpring.of(joint)
    for preload, moment in ((5e3, 0.0), (9e3, 600.0), (2e4, -1500.0)):
        found = instance.at({"preload": preload, "moment": moment})
        node = pressures(joint, spring.shape, preload, moment)
        k = stiffness_curve(joint, node)[0]
        K_zz = joint.A_0 * float(spring.shape.share @ k)
        expected = {"K_zz": K_zz, "p_max": float(node.max())}
        assert {n: found[n] for n in expected} == pytest.approx(expected, rel=TABLE)
        assert found["K_xx"] == pytest.approx(shear_ratio(joint) * K_zz, rel=5e-3)  # by the patches
        assert [found["f_x"], found["f_y"], found["f_z"]] == [0.0, 0.0, 0.0]
        # the shape has a mean of 1 and a tilt of 0: what the bolts press is what the contact carries
        mean = preload * joint.n_bolts / joint.A_0
        assert found["p_mean"] == pytest.approx(mean, rel=1e-9)


def test_stiffness_is_the_derivative_of_the_force(fmu: Host) -> None:
    instance = fmu("BoltedJoint").start({"memory": False})
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
    instance = fmu("BoltedJoint").start({"plastic_damping": True, "damping": True})
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


def relative(found: Any, expected: Any) -> float:
    return float(np.max(np.abs(np.asarray(found) - expected)) / np.max(np.abs(expected)))


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


def test_loops_are_the_packages_down_to_no_amplitude(fmu: Host, host: Host, version: str) -> None:
    """In all flavours, though differences of energies would cancel; so are their derivatives."""
    python, native = fmu("BoltedJoint").start(), host("BoltedJoint", version).start()
    for size in (1e-17, 1e-14, 1e-12, 1e-10, 1e-8, 2e-8, 5e-8, 1e-7):
        state = {"preload": 9e3, "moment": 300.0, "s_rel_x": 0.6 * size, "s_rel_y": -0.8 * size}
        found, other, J = native.at(state), python.at(state), jacobian(native)
        h = 1e-3 * size  # truncation h^2
        up, down = (native.at(state | {"s_rel_x": state["s_rel_x"] + d * h}) for d in (1.0, -1.0))
        for name in ("eta_loop", "C_loop"):
            assert found[name] == pytest.approx(other[name], rel=SAME_FLAVOURS, abs=0.0)
            assert J[name, "s_rel_x"] == pytest.approx((up[name] - down[name]) / (2.0 * h), rel=1e-4)


def test_a_joint_that_hardly_moves_is_the_packages(host: Host, version: str) -> None:
    """Noise while it is tightened and opened, then shear beyond rest: the same numbers, and slopes."""
    rng, places = np.random.default_rng(46), ("s_rel_x", "s_rel_y", "s_rel_z", "theta_x", "theta_z")
    instance, expected = host("BoltedJoint", version).start(), package("BoltedJoint").after()
    zero = dict.fromkeys(RANGES["BoltedJoint"], 0.0)
    for size in (*(8 * [1e-12]), 1e-10, 1e-9, 3e-9, 1e-8, 1e-7, 3e-7):
        noise = size * rng.normal(size=5) * np.array([1.0, 1.0, 100.0, 10.0, 1.0])
        state = zero | {"preload": 3e3 + 2e4 * rng.random()} | dict(zip(places, noise.tolist(), strict=True))
        found, J = instance.at(state), jacobian(instance)
        assert found == near("BoltedJoint", expected(state))
        for name in ("s_rel_x", "preload"):
            h = 1e-5 * max(abs(state[name]), 1e-3 * size)
            up, down = (instance.at(state | {name: state[name] + d * h})["f_x"] for d in (1.0, -1.0))
            scale = abs(J["f_x", "s_rel_x"]) * (1.0 if name == "s_rel_x" else size / state[name])
            assert abs((up - down) / (2.0 * h) - J["f_x", name]) <= 2e-3 * scale
        instance.at(state)
        instance.step()
        expected = expected.after(state)
