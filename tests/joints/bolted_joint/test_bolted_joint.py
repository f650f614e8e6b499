"""Bolted joint without history: forces from a potential, stiffness, separation, damping, rotation."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jointfmu.contact.interface import evaluate_at_pressure
from jointfmu.contact.laws import mindlin
from jointfmu.joints.bolted_joint.joint import BoltedJointSpring
from jointfmu.joints.bolted_joint.law import BoltedJointParameters, preload_pressure
from jointfmu.mechanics.curve import MAX_INTERPOLATION_ERROR
from jointfmu.mechanics.footprint.bolts import PressureDistribution
from jointfmu.parameters import load_default
from jointfmu.quantity import build_parameter_set, flatten_parameters

EPS = np.finfo(float).eps
STENCIL = np.array([1.0, -8.0, 0.0, 8.0, -1.0]) / 12.0
"""Central difference with five points; its error is h^4/30 times the fifth derivative."""
FIVE = np.arange(-2, 3)
STEP = 3e-10
"""Of the differences [m]: 3e-4 of the shear at which the friction of the joint is used up (1 um). Nodes that
are nearly open have a thousandth of that, so truncation is 3e-10 of K, as is what the third derivative jumps
by at nodes of the table; round-off of the force over the step is eps 72 kN/(3e-10 m K) = 3e-12 for
K = 2e10 N/m."""
SLOPE = 1e-8
"""Relative tolerance of such a difference [1]."""

JOINT = replace(load_default("bolted_joint").values, memory=False, damping=True)
STILL = (0.0, 0.0, 0.0)
LOADS = [(9e3, 0.0), (15e3, 4500.0), (500.0, -100.0)]
each_load = pytest.mark.parametrize(("preload", "moment"), LOADS)


def changed(**values):
    return build_parameter_set(BoltedJointParameters, flatten_parameters(JOINT) | values)


@pytest.fixture(scope="module")
def spring():
    return BoltedJointSpring.from_interface_nodes(JOINT)


@pytest.fixture(scope="module")
def plastic(spring):
    """Joint with the normal damping of the paper."""
    return replace(spring, joint=replace(JOINT, plastic_damping=True))


@pytest.fixture(scope="module")
def even(spring):
    """The same joint under a uniform pressure, with three nodes of unequal area share."""
    position = np.array([[0.1, 0.02], [-0.05, 0.1], [-0.025, -0.2]])
    share = np.array([0.4, 0.4, 0.2])
    shape = PressureDistribution(share, position, np.ones(3), np.zeros(3))
    return replace(spring.with_nodes(shape), joint=replace(JOINT, plastic_damping=True))


def total(preload):
    return JOINT.n_bolts * preload


# Tightened state


@each_load
def test_no_force_when_tightened(spring, preload, moment):
    out = spring.evaluate(preload, moment, STILL, STILL)
    assert (out["f_x"], out["f_y"]) == (0.0, 0.0)
    assert out["f_z"] == pytest.approx(0.0, abs=1e2 * EPS * total(preload))  # round-off of a thousand nodes
    p = preload_pressure(JOINT, spring.points, preload, moment)
    # the inverse of the table is exact to round-off; where p is small the approach's own counts
    assert out["p_mean"] == pytest.approx(total(preload) / JOINT.A_0, rel=1e-12)
    assert out["p_max"] == pytest.approx(np.max(p), rel=1e-12)


def test_outputs_are_named_as_promised(spring):
    names = "f_x f_y f_z K_xx K_yy K_zz C_xx C_yy C_zz eta_t eta_n K_rx K_ry K_rz p_mean p_max"
    assert set(names.split()) <= set(spring.evaluate(9e3, 0.0, STILL, STILL))


def test_uniform_pressure_is_the_law(even):
    """The sum over nodes is the law of the whole area at the mean pressure, to MAX_INTERPOLATION_ERROR."""
    out = even.evaluate(9e3, 0.0, STILL, STILL)
    law = {name: float(value) for name, value in evaluate_at_pressure(JOINT, total(9e3) / JOINT.A_0).items()}
    assert out["K_zz"] == pytest.approx(law["K_N"], rel=MAX_INTERPOLATION_ERROR)
    assert out["K_xx"] == out["K_yy"] == pytest.approx(law["K_T"], rel=MAX_INTERPOLATION_ERROR)
    assert out["eta_n"] == pytest.approx(law["eta_n"], rel=MAX_INTERPOLATION_ERROR)
    assert out["eta_t"] == pytest.approx(law["eta_t"], rel=4 * EPS)
    assert out["C_zz"] == pytest.approx(law["C_N"], rel=2 * MAX_INTERPOLATION_ERROR)
    assert out["C_xx"] == out["C_yy"] == pytest.approx(law["C_T"], rel=2 * MAX_INTERPOLATION_ERROR)
    assert out["p_max"] == pytest.approx(out["p_mean"], rel=1e-13)  # round-off of the shares


@each_load
def test_stiffness_is_the_sum_of_the_nodes_own_laws(spring, preload, moment):
    """The stiffness is the sum of the law at each node's pressure, weighted by the area share of the node."""
    p = preload_pressure(JOINT, spring.points, preload, moment)
    assert (
        np.min(p) > spring.curve.load[np.searchsorted(spring.curve.displacement, 0.0)]
    )  # outside the closing
    law = evaluate_at_pressure(JOINT, p)
    out = spring.evaluate(preload, moment, STILL, STILL)
    assert out["K_zz"] == pytest.approx(spring.points.area_share @ law["K_N"], rel=MAX_INTERPOLATION_ERROR)
    assert out["K_xx"] == pytest.approx(spring.points.area_share @ law["K_T"], rel=MAX_INTERPOLATION_ERROR)


def test_uneven_pressure_is_softer_than_even(spring, even):
    """K_N grows less than proportionally with the pressure; the mean of a concave law is smaller (Jensen)."""
    uneven, flat = (s.evaluate(9e3, 0.0, STILL, STILL)["K_zz"] for s in (spring, even))
    assert uneven < flat


def test_shear_ratio_is_that_of_the_law():
    for joint in (JOINT, changed(traction_ratio=0.6, spot_stiffness="hertz")):
        for p in (1e5, 1e8):
            law = evaluate_at_pressure(joint, p)
            found = float(law["K_T"] / law["K_N"])
            assert joint.shear_stiffness_ratio() == pytest.approx(found, rel=1e-13)  # round-off


# Forces and stiffnesses away from the tightened state

states = st.tuples(st.floats(-2e-6, 2e-6), st.floats(-2e-6, 2e-6), st.floats(-5e-6, 5e-6))
loads = st.sampled_from(LOADS)


def forces(spring, load, s):
    out = spring.evaluate(*load, tuple(s), STILL)
    return np.array([out["f_x"], out["f_y"], out["f_z"]])


def potential(spring, load, s):
    """Potential U(s) of the joint; V is the exact integral of the table on each interval."""
    curve, area, rho = spring.curve, JOINT.A_0 * spring.points.area_share, JOINT.shear_stiffness_ratio()
    start = spring.preloaded_approach(*load)
    a, h = curve._coefficients, np.diff(curve.displacement)
    whole = np.concatenate([[0.0], np.cumsum(h * (a / np.arange(1.0, 7.0)[:, None]).sum(axis=0))])
    delta = start - s[2]
    inside = np.clip(delta, curve.displacement[0], curve.displacement[-1])
    i = np.clip(np.searchsorted(curve.displacement, inside, side="right") - 1, 0, h.size - 1)
    t = (inside - curve.displacement[i]) / h[i]
    V = whole[i] + h[i] * sum(a[k, i] * t ** (k + 1) / (k + 1) for k in range(6))
    k = curve.derivatives(delta, 1)[1]
    tight, u = curve.derivatives(start, 0)[0], np.hypot(s[0], s[1])
    R = np.sqrt(1.0 + (rho * k * u / (JOINT.mu * tight)) ** 2)
    return float(area @ V + area @ (rho * k * u**2 / (1.0 + R)) + area @ tight * s[2])


@settings(max_examples=30)
@given(load=loads, s=states)
def test_force_is_minus_the_gradient_of_the_potential(spring, load, s):
    s, h = np.array(s), 2e-9
    f = forces(spring, load, s)
    scale = total(load[0]) + np.abs(f)
    for axis in range(3):
        shift = np.outer(FIVE * h, np.eye(3)[axis])
        slope = STENCIL @ [potential(spring, load, s + d) for d in shift] / h
        # (h/0.1 um)^4 of truncation where nodes are nearly open, eps U/h of round-off: 1e-8 N
        assert f[axis] == pytest.approx(-slope, rel=0.0, abs=1e-7 * scale[axis])


@settings(max_examples=20)
@given(load=loads, s=states)
def test_stiffness_is_the_exact_derivative(spring, load, s):
    """All nine derivatives of the force: the outputs on the diagonal, a symmetric matrix."""
    s = np.array(s)
    out = spring.evaluate(*load, tuple(s), STILL)
    matrix = np.empty((3, 3))
    for axis in range(3):
        shift = np.outer(FIVE * STEP, np.eye(3)[axis])
        matrix[:, axis] = -STENCIL @ [forces(spring, load, s + d) for d in shift] / STEP
    scale = max(out["K_zz"], out["K_xx"], 1.0)
    noise = SLOPE * scale + 20.0 * EPS * total(load[0]) / STEP
    opening = spring.curve.derivatives(spring.curve.displacement[0] + STEP, 3)[3]
    noise += STEP**2 * spring.joint.A_0 * float(opening)  # the third derivative begins there with a jump
    assert matrix[0, 0] == pytest.approx(out["K_xx"], rel=0.0, abs=noise)
    assert matrix[1, 1] == pytest.approx(out["K_yy"], rel=0.0, abs=noise)
    assert matrix[2, 2] == pytest.approx(out["K_zz"], rel=0.0, abs=noise)
    np.testing.assert_allclose(matrix, matrix.T, rtol=0.0, atol=noise)


def test_mixed_derivative_is_not_lost(spring):
    """Opening reduces the tangential force and shear increases the normal one, with equal derivatives."""
    s, h = np.array([1e-6, 0.0, 1e-6]), STEP
    z = STENCIL @ [forces(spring, LOADS[0], s + d) for d in np.outer(FIVE * h, [0, 0, 1])] / h
    x = STENCIL @ [forces(spring, LOADS[0], s + d) for d in np.outer(FIVE * h, [1, 0, 0])] / h
    assert z[0] == pytest.approx(x[2], rel=1e-6)  # SLOPE of K, a hundred times larger
    K_xx = spring.evaluate(*LOADS[0], tuple(s), STILL)["K_xx"]
    assert z[0] > 0.01 * K_xx  # N/m: well above the differences' own error


@pytest.mark.slow
@settings(max_examples=2)
@given(load=loads, corners=st.lists(states, min_size=2, max_size=3))
def test_closed_cycles_return_their_energy(spring, load, corners):
    """Work around a closed polygon through the tightened state, with normal and tangential motion."""
    x, w = np.polynomial.legendre.leggauss(8)
    path = [np.zeros(3), *map(np.array, corners), np.zeros(3)]
    works = []
    for a, b in pairwise(path):
        for i in range(8):
            ends = a + (b - a) * i / 8, a + (b - a) * (i + 1) / 8
            middle, half = 0.5 * (ends[0] + ends[1]), 0.5 * (ends[1] - ends[0])
            works.append(
                sum(wi * forces(spring, load, middle + xi * half) @ half for xi, wi in zip(x, w, strict=True))
            )
    # nodes of the table are crossed between the Gauss points: jumps of the third derivative
    assert sum(works) == pytest.approx(0.0, abs=1e-7 * np.sum(np.abs(works)))


def test_pressed_together_it_gets_stiffer(spring):
    z = np.linspace(0.0, -1e-5, 11)
    out = [spring.evaluate(9e3, 0.0, (0.0, 0.0, float(v)), STILL) for v in z]
    for name in ("K_zz", "K_xx", "K_rx", "K_rz", "p_mean", "p_max", "f_z"):
        assert np.all(np.diff([o[name] for o in out]) > 0.0)
    assert out[1]["f_z"] > 0.0  # pushes side 2 back


def test_pulled_apart(spring):
    """After separation the force equals the lost preload, without stiffness and damping."""
    for preload, moment in LOADS:
        apart = float(np.max(spring.preloaded_approach(preload, moment)) - spring.curve.displacement[0])
        out = spring.evaluate(preload, moment, (1e-6, -2e-6, apart * (1.0 + 1e-12)), (1e-3, 1e-3, 1e-3))
        # the sum of a thousand node forces
        assert out["f_z"] == pytest.approx(-total(preload), rel=1e-12)
        for name in ("f_x", "f_y", "K_xx", "K_yy", "K_zz", "C_xx", "C_yy", "C_zz", "K_rx", "K_ry", "K_rz"):
            assert out[name] == 0.0, name
        assert (out["p_mean"], out["p_max"]) == (0.0, 0.0)
        far = spring.evaluate(preload, moment, (0.0, 0.0, 1.0), STILL)
        assert far["f_z"] == out["f_z"]
        before = spring.evaluate(preload, moment, (0.0, 0.0, 0.5 * apart), STILL)
        assert -total(preload) < before["f_z"] < 0.0
        assert before["K_zz"] > 0.0


def test_force_of_the_pull_is_monotone(spring):
    z = np.linspace(-5e-6, 4e-5, 200)
    out = [spring.evaluate(9e3, 0.0, (0.0, 0.0, float(v)), STILL) for v in z]
    assert np.all(np.diff([o["f_z"] for o in out]) <= 0.0)
    assert np.all(np.diff([o["K_zz"] for o in out]) <= 0.0)


def test_signs_along_each_axis(plastic):
    """A positive displacement gives a negative force, and so does a positive rate."""
    spring = plastic
    for axis, name in enumerate(("f_x", "f_y", "f_z")):
        unit = np.eye(3)[axis]
        moved = spring.evaluate(9e3, 0.0, tuple(1e-7 * unit), STILL)
        assert moved[name] < 0.0
        other = spring.evaluate(9e3, 0.0, tuple(-1e-7 * unit), STILL)
        assert other[name] > 0.0
        fast = spring.evaluate(9e3, 0.0, STILL, tuple(1e-3 * unit))
        damping = fast[f"C_{name[-1]}{name[-1]}"]
        assert fast[name] == pytest.approx(-1e-3 * damping, rel=0.0, abs=1e2 * EPS * total(9e3))
        assert damping > 0.0


# Damping


@each_load
def test_loss_factors_and_damping(plastic, preload, moment):
    """eta_n: plastic over elastic work of all nodes; eta_t from the traction ratio; C = eta sqrt(M K)."""
    spring = plastic
    out = spring.evaluate(preload, moment, STILL, STILL)
    law = evaluate_at_pressure(JOINT, preload_pressure(JOINT, spring.points, preload, moment))
    plastic, elastic = (spring.points.area_share @ law[name] for name in ("W_NP", "W_NE"))
    assert out["eta_n"] == pytest.approx(plastic / elastic, rel=MAX_INTERPOLATION_ERROR)
    ratio = (
        12.0 * mindlin.dissipated_energy_function(0.1) / (5.0 * np.pi * mindlin.stored_energy_function(0.1))
    )
    assert out["eta_t"] == pytest.approx(ratio / (1.0 - ratio), rel=1e-13)  # round-off
    assert out["eta_t"] == pytest.approx(2.0 * 0.1 / (9.0 * np.pi), rel=0.1)  # its limit for small x
    for axis, eta in (("xx", "eta_t"), ("yy", "eta_t"), ("zz", "eta_n")):
        expected = out[eta] * np.sqrt(JOINT.mass * out[f"K_{axis}"])
        assert out[f"C_{axis}"] == pytest.approx(expected, rel=1e-13)  # round-off


@each_load
def test_plastic_work_of_first_loading_damps_on_demand_only(spring, plastic, preload, moment):
    """Without this option the normal motion dissipates nothing; all other outputs, eta_n included, are the
    same."""
    moving = (1e-3, 1e-3, 1e-3)
    off, on = (joint.evaluate(preload, moment, STILL, moving) for joint in (spring, plastic))
    assert not JOINT.plastic_damping
    assert off["C_zz"] == 0.0 < on["C_zz"]
    assert off["f_z"] == pytest.approx(on["f_z"] + 1e-3 * on["C_zz"], abs=1e2 * EPS * total(preload))
    normal = ("C_zz", "f_z", "m_x", "m_y", "step_at_once", "step_side_by_side")
    assert {n: v for n, v in off.items() if n not in normal} == {
        n: v for n, v in on.items() if n not in normal
    }


def test_damping_grows_with_the_mass_as_its_root(plastic):
    heavy = replace(plastic, joint=replace(plastic.joint, mass=4.0 * JOINT.mass))
    light, more = (s.evaluate(9e3, 0.0, STILL, STILL) for s in (plastic, heavy))
    for name in ("C_xx", "C_yy", "C_zz"):
        assert more[name] == pytest.approx(2.0 * light[name], rel=4 * EPS)
    assert more["K_zz"] == light["K_zz"]


def test_loss_factor_while_closing(even):
    """While the contact closes, eta_n keeps its value at the end of the closing."""
    curve = even.curve
    edge = float(curve.load[np.searchsorted(curve.displacement, 0.0)])
    at_edge, below = (even.evaluate(part * edge * JOINT.A_0 / 8, 0.0, STILL, STILL) for part in (1.0, 0.1))
    assert below["eta_n"] == pytest.approx(at_edge["eta_n"], rel=1e-12)  # round-off
    law = evaluate_at_pressure(JOINT, edge)
    assert at_edge["eta_n"] == pytest.approx(float(law["eta_n"]), rel=1e-10)  # 1e-12 of the load, steep


# Rotation


@each_load
def test_rotational_stiffness_about_the_centroid(spring, preload, moment):
    """Rotational stiffnesses are sums of A k y^2, A k x^2 and rho A k (x^2 + y^2) about the centroid."""
    out = spring.evaluate(preload, moment, STILL, STILL)
    law = evaluate_at_pressure(JOINT, preload_pressure(JOINT, spring.points, preload, moment))
    x, y = spring.points.position.T
    share = spring.points.area_share
    assert share @ x == pytest.approx(0.0, abs=1e-15)  # m, the origin is the centroid
    assert share @ y == pytest.approx(0.0, abs=1e-15)
    assert out["K_rx"] == pytest.approx(share @ (law["K_N"] * y**2), rel=MAX_INTERPOLATION_ERROR)
    assert out["K_ry"] == pytest.approx(share @ (law["K_N"] * x**2), rel=MAX_INTERPOLATION_ERROR)
    assert out["K_rz"] == pytest.approx(share @ (law["K_T"] * (x**2 + y**2)), rel=MAX_INTERPOLATION_ERROR)
    assert out["K_rx"] > out["K_ry"]  # the frame is longer along y


def test_rotation_of_three_nodes(even):
    out = even.evaluate(9e3, 0.0, STILL, STILL)
    # 0.4 * 0.02^2 + 0.4 * 0.1^2 + 0.2 * 0.2^2 and 0.4 * 0.1^2 + 0.4 * 0.05^2 + 0.2 * 0.025^2, in m2
    assert out["K_rx"] == pytest.approx(0.01216 * out["K_zz"], rel=1e-13)  # round-off
    assert out["K_ry"] == pytest.approx(0.005125 * out["K_zz"], rel=1e-13)
    assert out["K_rz"] == pytest.approx(0.017285 * out["K_xx"], rel=1e-13)


# Limits


def test_without_preload(spring):
    """The faces touch without force and all outputs are finite; under compression the joint carries load."""
    out = spring.evaluate(0.0, 0.0, STILL, STILL)
    assert all(np.isfinite(value) for value in out.values())
    for name in ("f_x", "f_y", "f_z", "K_xx", "K_zz", "C_xx", "C_zz", "K_rz", "p_mean", "p_max"):
        assert out[name] == 0.0, name
    pressed = spring.evaluate(0.0, 0.0, (0.0, 0.0, -2e-5), STILL)
    assert pressed["f_z"] == pytest.approx(JOINT.A_0 * pressed["p_mean"], rel=1e-12)  # sum of a thousand
    assert pressed["f_z"] > 0.0
    apart = spring.evaluate(0.0, 0.0, (1e-6, 0.0, 1e-6), (1.0, 1.0, 1.0))
    assert apart["f_x"] == apart["f_y"] == apart["f_z"] == 0.0


def test_a_small_preload_is_continuous_to_none(plastic):
    """While the contact closes, no output but the loss factors jumps."""
    spring = plastic
    previous = spring.evaluate(1.0, 0.0, STILL, STILL)
    for preload in (1e-2, 1e-4, 1e-8):
        out = spring.evaluate(preload, 0.0, STILL, STILL)
        assert all(np.isfinite(value) for value in out.values())
        for name in ("K_xx", "K_zz", "C_xx", "C_zz", "K_rx", "p_max"):
            assert 0.0 < out[name] < previous[name]
        previous = out


@pytest.mark.parametrize("moment", [2e4, -2e4, 1e7])
def test_an_open_row(spring, moment):
    """A moment larger than the preload allows: no tension in any node, and no force in the
    tightened state."""
    preload = 9e3
    assert abs(moment) / (JOINT.row_distance * JOINT.row_bolts) > preload
    p = preload_pressure(JOINT, spring.points, preload, moment)
    assert np.min(p) == 0.0
    assert np.max(p) > np.max(preload_pressure(JOINT, spring.points, preload, 0.0))
    open_side = np.sign(spring.points.position[p == 0.0, 1])
    assert np.all(open_side == -np.sign(moment))
    out = spring.evaluate(preload, moment, STILL, STILL)
    assert all(np.isfinite(value) for value in out.values())
    assert out["f_z"] == pytest.approx(0.0, abs=1e2 * EPS * JOINT.A_0 * out["p_mean"])
    assert out["p_mean"] > total(preload) / JOINT.A_0  # the clipped part is missing
    assert out["K_zz"] > 0.0


def test_the_sign_of_a_moment_does_not_matter_to_a_symmetric_frame(spring):
    one, other = (spring.evaluate(15e3, m, (1e-7, 0.0, -1e-7), STILL) for m in (4500.0, -4500.0))
    assert one["m_y"] == pytest.approx(0.0, abs=1e-9)  # N.m: round-off of 1e5 N times 0.1 m
    for name, value in one.items():
        sign = -1.0 if name in ("m_x", "m_y", "m_z") else 1.0
        # cells mirror to round-off of their centroids
        assert other[name] == pytest.approx(sign * value, rel=1e-9, abs=1e-9), name


def test_beyond_the_table_the_tangent_continues(even):
    """Beyond the approach at which the pressure reaches the hardness, the force is linear."""
    end = even.curve.end_point[0] - float(even.preloaded_approach(9e3, 0.0)[0])
    one, two, three = (even.evaluate(9e3, 0.0, (0.0, 0.0, -end - d), STILL) for d in (1e-6, 2e-6, 3e-6))
    rise = two["f_z"] - one["f_z"]
    assert three["f_z"] - two["f_z"] == pytest.approx(rise, rel=1e-9)  # differences of 1e8 N
    assert one["K_zz"] == pytest.approx(three["K_zz"], rel=1e-12)  # round-off
    assert one["K_zz"] == pytest.approx(rise / 1e-6, rel=1e-9)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"row_bolts": 5.0}, ("row_bolts = 5", "[1, 4]")),
        ({"n_bolts": 0.0}, ("n_bolts = 0", "[1, inf)")),
        ({"row_distance": 0.0}, ("row_distance = 0 m", "(0, inf)")),
        ({"pattern.hole_diameter": 0.05}, ("hole_diameter = 0.05 m", "(0, 0.04)")),
        ({"traction_ratio": 1.0}, ("traction_ratio = 1", "[0, 1)")),
        ({"critical_area": "other"}, ("critical_area = 'other'", "continuity, printed, yield")),
        ({"mass": float("nan")}, ("mass = nan kg", "(0, inf)")),
    ],
)
def test_impossible_joints_are_refused(changes, words):
    with pytest.raises(ValueError, match=words[0].split(" ")[0]) as error:
        changed(**changes)
    assert "\n" not in str(error.value)
    for word in words:
        assert word in str(error.value)
