"""FMU of the bolted joint: equal to its law, potential, derivatives; laboratory and report."""

import math
from dataclasses import replace
from importlib.resources import files
from itertools import combinations
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from conftest import here_alone
from joint_cases import RANGES, SAME, STATE, TABLE, parameters, random_inputs
from jointfmu_fmu_src.building import build_fmus
from jointfmu_tools.joints.bolted_joint.field import PlaneLayout
from jointfmu_tools.joints.bolted_joint.picture import AREA_CELL_OVERLAP, _area_cell_sizes, draw_plan
from jointfmu_tools.joints.bolted_joint.report import make_plan_and_section_figure
from jointfmu_tools.pages.laboratory.describe import list_modules
from jointfmu_tools.pages.report.load_history import LoadHistory
from jointfmu_tools.run.ramps import ramp
from natives import SAME as SAME_FLAVOURS
from natives import Host, close, jacobian, near, package
from scipy.integrate import cumulative_simpson
from webassembly import Instance

from jointfmu.contact.interface import stiffness_curve
from jointfmu.joints import MODELS
from jointfmu.joints.bolted_joint.joint import BoltedJointSpring, contact_points
from jointfmu.joints.bolted_joint.law import preload_pressure
from jointfmu.mechanics.footprint.distribution import NodalField, encode_nodal_field
from jointfmu.mechanics.footprint.plate import BoltedPlate
from jointfmu.parameters import load_default, load_parameter_file

MOVED = ("s_rel_x", "s_rel_y", "s_rel_z", "theta_x", "theta_y", "theta_z")


def test_bolted_joint_at_rest_follows_the_law_without_a_table(fmu: Host) -> None:
    joint, instance = parameters("BoltedJoint"), fmu("BoltedJoint").start()
    spring = BoltedJointSpring.from_joint(joint)
    for preload, moment in ((5e3, 0.0), (9e3, 600.0), (2e4, -1500.0)):
        found = instance.at({"preload": preload, "moment": moment})
        node = preload_pressure(joint, spring.points, preload, moment)
        k = stiffness_curve(joint, node)[0]
        K_zz = joint.A_0 * float(spring.points.area_share @ k)
        expected = {"K_zz": K_zz, "p_max": float(node.max())}
        assert {n: found[n] for n in expected} == pytest.approx(expected, rel=TABLE)
        assert found["K_xx"] == pytest.approx(
            joint.shear_stiffness_ratio() * K_zz, rel=5e-3
        )  # by the patches
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


@pytest.mark.slow
def test_springs_that_just_touch_have_a_friction(host: Host, tmp_path: Path) -> None:
    """In a range that has just come into full contact, one slider has only round-off as limit. A negative
    limit made all forces NaN after some hundred steps of this path."""
    file = Path(str(files("jointfmu_models"))) / "bolted_joint/box_specimen_roughness.toml"
    with here_alone("3"):
        build_fmus(["BoltedJoint"], ["fmi3"], load_parameter_file(file), tmp_path)
    joint, heat = host("BoltedJoint", folder=tmp_path).start({"preload": 1e4}), 0.0
    most = dict(zip(MOVED, (2.6e-6, 8.4e-7, 6.8e-7, 4.6e-5, 6.8e-6, 7.6e-6), strict=True))
    for k in range(1200):
        waves = np.sin(np.pi / 32.0 * k * (1.0 + 0.1 * np.arange(6)))
        joint.set_values({name: float(x * wave) for (name, x), wave in zip(most.items(), waves, strict=True)})
        joint.step()
        before, heat = heat, joint.get("E_loss")["E_loss"]
        assert heat >= before


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


def test_the_preload_ramp_agrees_with_scipy(native: Path) -> None:
    path = native / "fmi3" / "BoltedJoint.fmu"
    c = ramp.run_ramp(path, "preload", 3e4, 100.0).variable_columns
    assert len(c["preload"]) == 301
    assert np.all(np.diff(c["K_zz"]) > 0.0)
    assert not np.any([c["f_x"], c["f_y"], c["f_z"]])
    assert relative(c["p_mean"], c["preload"] * 8.0 / 0.0382) < 1e-9  # equilibrium, 8 bolts on A_0
    pulled = ramp.run_ramp(path, "s_rel_z", 5e-6, 1e-8, {"preload": 9e3}).variable_columns
    force = -cumulative_simpson(pulled["K_zz"], x=pulled["s_rel_z"], initial=0.0)
    assert relative(pulled["f_z"], force) < 1e-6  # Simpson's rule at 500 steps


def test_loops_are_the_packages_down_to_no_amplitude(fmu: Host, host: Host, version: str) -> None:
    """Loops of all flavours agree with the package, derivatives included, down to amplitudes at which
    differences of energies would cancel."""
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
    """Noise during tightening and opening, then shear beyond stick: same numbers and derivatives as the
    package."""
    rng, places = np.random.default_rng(46), ("s_rel_x", "s_rel_y", "s_rel_z", "theta_x", "theta_z")
    instance, expected = host("BoltedJoint", version).start(), package("BoltedJoint").after()
    zero, n_bolts = dict.fromkeys(RANGES["BoltedJoint"], 0.0), parameters("BoltedJoint").n_bolts
    for size in (*(8 * [1e-12]), 1e-10, 1e-9, 3e-9, 1e-8, 1e-7, 3e-7):
        noise = size * rng.normal(size=5) * np.array([1.0, 1.0, 100.0, 10.0, 1.0])
        state = zero | {"preload": 3e3 + 2e4 * rng.random()} | dict(zip(places, noise.tolist(), strict=True))
        found, J = instance.at(state), jacobian(instance)
        due = expected(state)
        # m_x and m_y are sums of preloads times arms that cancel: 1e-14 of the terms is their round-off
        for axis in "xy":
            terms = n_bolts * state["preload"] * np.sqrt(due[f"K_r{axis}"] / due["K_zz"])
            moment = pytest.approx(due.pop(f"m_{axis}"), rel=SAME_FLAVOURS, abs=1e-14 * terms)
            assert found.pop(f"m_{axis}") == moment
        assert found == near("BoltedJoint", due)
        for name in ("s_rel_x", "preload"):
            h = 1e-5 * max(abs(state[name]), 1e-3 * size)
            up, down = (instance.at(state | {name: state[name] + d * h})["f_x"] for d in (1.0, -1.0))
            scale = abs(J["f_x", "s_rel_x"]) * (1.0 if name == "s_rel_x" else size / state[name])
            assert abs((up - down) / (2.0 * h) - J["f_x", name]) <= 2e-3 * scale
        instance.at(state)
        instance.step()
        expected = expected.after(state)


# Derivatives keep the closed relations of the joint


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
    """All 36 slopes agree with central differences of trial evaluations of the same instance, with slip and
    opening along the path."""
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
    """Forces at their limit exceed it by no round-off, although the terms of the limit cancel. Against
    central differences as above."""
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
    """For any previous steps, K_yy, K_rz and derivatives agree with differences of the same instance.

    Along x, sliders are at their limits. K_xx is the slope if the motion continues (they slip on); the
    derivative is the mean of this slope and of the slope after a reversal (they stick).
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
            # of a turn more slips on one way than the other: 0.3 % less than the mean
            assert values[K] == pytest.approx((down - up) / (2.0 * h), rel=1e-3 if K == "K_yy" else 5e-3)
            assert J[f, s] == close(-values[K], 1e-9 if K == "K_yy" else 5e-3)  # K_rz of one direction
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


# The laboratory's pressure map


COMPILED = 1e-9
"""Difference between two mathematical libraries for the same table [1]."""


@pytest.mark.slow
@pytest.mark.parametrize("law", ["zhao2018", "roughness"])
def test_the_map_is_the_pressure_at_the_points(law):
    module = next(
        m for m in list_modules() if m.fmu_model.name == "BoltedJoint" and m.parameter_files[0].law == law
    )
    joint = module.parameter_files[0].values
    shape = contact_points(joint.pattern)
    spring = BoltedJointSpring.from_interface_nodes(joint, shape)
    instance = Instance(module, module.compile_module())
    for moment, apart, turn in ((0.0, 0.0, 0.0), (1500.0, 2e-7, 1e-6)):
        given = {"preload": 12e3, "moment": moment, "s_rel_z": apart, "theta_x": turn, "theta_y": -turn}
        assert instance.start(given)
        found = instance.map()
        assert found[:, :2] == pytest.approx(shape.position, rel=1e-12, abs=1e-15)
        assert found[:, 2] == pytest.approx(shape.area_share, rel=1e-15)
        x, y = shape.position.T
        approach = spring.preloaded_approach(12e3, moment) - (apart + turn * y + turn * x)
        expected = spring.curve.derivatives(approach, 0)[0]
        assert found[:, 3] == pytest.approx(expected, rel=COMPILED, abs=COMPILED * float(np.max(expected)))
        assert float(found[:, 3].max()) == instance.get()["p_max"]


# The report: its loops and its picture


SVG = "{http://www.w3.org/2000/svg}"
YELLOW = "#fde725"
"""Colour at the end of the colour scale."""


@pytest.mark.slow
@pytest.mark.parametrize("mu", [0.15, 0.0015])
def test_loops_show_partial_slip_whatever_the_friction(mu: float) -> None:
    """The smallest loop keeps part of its stiffness, the largest one stays below the friction limit and
    dissipates."""
    file = load_default("bolted_joint").with_values({"mu": mu, "memory": True}, "user", "friction")
    model = MODELS["BoltedJoint"]
    course = LoadHistory(model, file)
    small, *_, large = course.compute_loops().compute_quantities_of_loops()
    point = {**course.loop_inputs, "s_rel_x": 0.0}
    stiff = model.evaluate(course.tabulated_joint, point)["K_xx"]
    assert small["secant_stiffness"] > 0.25 * stiff
    assert large["force"] <= mu * course.loop_inputs["preload"] * file.values_by_name["n_bolts"] * (
        1.0 + 1e-9
    )
    if mu < 0.1:
        assert large["motion"] < 0.5 * model.load_cycle.input_amplitude
        # slides freely over more than a third of the way back
        assert large["loss_factor"] > 0.7


def test_the_picture_shows_pressure_and_bolts_where_they_are() -> None:
    """Cells fill the frame, the brightest cell is at a bolt, and the bolts are numbered in their order."""
    joint = load_default("bolted_joint").values
    shape = joint.pattern.pressure_distribution()
    drawn = ElementTree.fromstring(draw_plan(joint, 9e3, 0.0))
    cells = [rect for rect in drawn.iter(f"{SVG}rect") if rect.get("fill") not in ("#fff", "none", None)]
    sides = [[float(rect.get(side)) - AREA_CELL_OVERLAP for side in ("width", "height")] for rect in cells]
    area = np.sum(np.prod(sides[: len(shape.area_share)], axis=1))
    outer = next(rect for rect in drawn.iter(f"{SVG}rect") if rect.get("fill") == "none")
    scale = float(outer.get("width")) / (joint.pattern.column_spacing + joint.pattern.flange_width)
    assert area / scale**2 == pytest.approx(joint.A_0, rel=0.03)  # drawn to tenths of 5 px
    (x, y), *_ = [
        np.array([float(rect.get("x")), float(rect.get("y"))]) for rect in cells if rect.get("fill") == YELLOW
    ]
    holes = {(float(c.get("cx")), float(c.get("cy"))) for c in drawn.iter(f"{SVG}circle")}
    assert len(holes) == len(joint.pattern.bolt_positions_from_middle)
    assert min(np.hypot(x - a, y - b) for a, b in holes) < scale * joint.pattern.hole_diameter
    told = [text.text for text in drawn.iter(f"{SVG}text")]
    assert [text for text in told if text and text.isdigit()][:8] == [str(i + 1) for i in range(8)]
    strip = BoltedPlate(
        length=0.15, width=0.04, x=(0.0,), y=(0.0,), hole_diameter=0.009, cone_diameter=0.02
    )  # its cells are no squares: they are as wide as its columns
    sides = _area_cell_sizes(
        SimpleNamespace(A_0=strip.area, pattern=strip), strip.pressure_distribution().area_share
    )
    np.testing.assert_allclose(
        sides.max(axis=0), np.array([0.15, 0.04]) / strip.coarse_cell_counts, rtol=1e-4
    )


@pytest.mark.slow
def test_the_picture_of_points_without_an_outline() -> None:
    """One dot per point at its position; there are no bolts, and the page says so."""
    file = load_default("bolted_joint")
    shape = file.values.pattern.pressure_distribution()
    half = np.flatnonzero(shape.position[:, 1] > 0.0)
    some = shape.select_nodes(half)
    share = some.area_share / some.area_share.sum()
    moved = replace(some, area_share=share, position=some.position - share @ some.position)
    moved = replace(
        moved,
        preload_pressure_ratio=some.preload_pressure_ratio / (share @ some.preload_pressure_ratio),
        moment_pressure_ratio=some.moment_pressure_ratio - share @ some.moment_pressure_ratio,
    )
    joint = replace(file.values, pattern=NodalField(**encode_nodal_field(moved)))
    drawn = ElementTree.fromstring(draw_plan(joint, 9e3, 0.0))
    discs = list(drawn.iter(f"{SVG}circle"))
    assert len(discs) == len(share)
    places = np.array([[float(disc.get("cx")), -float(disc.get("cy"))] for disc in discs])
    scale = np.ptp(places, axis=0) / np.ptp(moved.position, axis=0)
    np.testing.assert_allclose(scale[0], scale[1], rtol=1e-2)
    told = [text.text for text in drawn.iter(f"{SVG}text")]
    wide = 1e3 * np.ptp(moved.position[:, 0])
    assert f"points over {wide:.4g} mm, x to the right" in told
    assert len(PlaneLayout.from_joint_parameters(joint).bolt_positions) == 0
    figure = make_plan_and_section_figure(LoadHistory(MODELS["BoltedJoint"], replace(file, values=joint)))
    assert "no bolt positions" in figure.description
    assert len(figure.svg_pictures) == 1
