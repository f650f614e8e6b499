"""Spring of the gear mesh: flanks and teeth in series, and torques of all pairs as a gradient."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

from jointfmu.joints import MODELS
from jointfmu.joints.gear_mesh.spring import GearMeshParameters, GearMeshSpring, base_pitch
from jointfmu.parameters import format_parameter_file, load_default, load_parameter_file
from jointfmu.quantity import replace_values

EPS = np.finfo(float).eps
STENCIL = np.array([1.0, -8.0, 0.0, 8.0, -1.0]) / 12.0
"""Central difference with five points; its error is h^4/30 times the fifth derivative."""
FIVE = np.arange(-2, 3)
GAUSS = np.polynomial.legendre.leggauss(5)

MESH = load_default("gear_mesh").values
SETS = {
    "default": MESH,
    "soft teeth": replace_values(MESH, {"K_tooth": 1e6, "backlash": 0.0, "contact_ratio": 2.3}),
    "stiff teeth": replace_values(MESH, {"K_tooth": 1e10, "engagement": 1.0, "contact_ratio": 1.1}),
    "two-bodies": replace_values(
        MESH,
        {"surface1.D": 1.6, "rigid_flat": False, "plastic_area": "kogut_etsion", "r_b2": 0.05, "A_0": 2e-5},
    ),
}
SPRINGS = {name: GearMeshSpring.tabulate(mesh) for name, mesh in SETS.items()}
each = pytest.mark.parametrize("spring", SPRINGS.values(), ids=SPRINGS)


def at(spring, s, roll):
    """Angles [rad] of both wheels for deflections s (...) [m] and rolling distances (...) [m]."""
    along = s + 0.5 * spring.joint.backlash * np.sign(s)
    return (roll + 0.5 * along) / spring.joint.r_b1, (0.5 * along - roll) / spring.joint.r_b2


def motion(spring, s, roll, rate=0.0):
    """Outputs at a deflection and a rolling distance [m]; both flanks close with the speed `rate` [m/s]."""
    phi1, phi2 = at(spring, s, roll)
    return spring.evaluate(phi1, rate / spring.joint.r_b1, phi2, 0.0)


@each
def test_stiffness_is_the_slope_of_the_force(spring):
    """The stiffness is the slope of the force along the line of action at constant phase, from first contact
    to beyond the table."""
    s = np.concatenate([np.geomspace(1e-4, 0.99, 60), [1.01, 3.0]]) * spring.curve.end_point[0]
    h = 1e-3 * s
    kinks = spring.curve.displacement[1:-1][
        spring.curve.stiffness_slope_end[:-1] != spring.curve.stiffness_slope_start[1:]
    ]
    smooth = np.all(np.abs(kinks[:, None] - s) > 2.0 * h, axis=0)  # no regime of the law ends inside
    for roll in (0.0, 0.3 * base_pitch(spring.joint), 0.345 * base_pitch(spring.joint)):
        force = motion(spring, s + h * FIVE[:, None], roll)["f"]
        K = motion(spring, s, roll)["K"]
        # truncation (h/s)^4 with the bend of a power law; angles hold the way along to EPS of their own
        noise = 20.0 * EPS * (roll + spring.joint.backlash + s) / h
        assert np.all((np.abs(STENCIL @ force / h / K - 1.0) <= 1e-7 + noise)[smooth])
    assert np.mean(smooth) > 0.9


@each
def test_torques_are_the_gradient_of_the_energy(spring):
    """dE/dphi of both wheels by differences, over the whole mesh cycle and on both flanks."""
    pitch = base_pitch(spring.joint)
    generator = np.random.default_rng(3)
    s = (
        generator.choice([-1.0, 1.0], 400)
        * spring.curve.end_point[0]
        * 10.0 ** generator.uniform(-2.0, 0.0, 400)
    )
    roll = pitch * generator.uniform(-2.0, 2.0, 400)
    phi = np.array(at(spring, s, roll))
    out = spring.evaluate(phi[0], 0.0, phi[1], 0.0)
    for i, radius in enumerate((spring.joint.r_b1, spring.joint.r_b2)):
        h = np.minimum(2e-3 * np.abs(s), 1e-4 * pitch) / radius
        moved = np.repeat(phi[:, None], 5, axis=1)
        moved[i] += h * FIVE[:, None]
        slope = STENCIL @ spring.evaluate(moved[0], 0.0, moved[1], 0.0)["E"] / h
        torque = out[f"tau{i + 1}"]
        scale = radius * np.abs(out["f"]) + np.abs(out["E"])
        noise = 50.0 * EPS * out["E"] * (1.0 + pitch / np.abs(s)) / h  # the way along again
        # truncation: (h/s)^4 of a power law; of the pairs' transition, whose fourth derivative jumps
        assert np.all(np.abs(torque + slope) <= 1e-7 * scale + noise)


@each
def test_the_transmission_error_under_constant_load_varies_with_the_pairs(spring):
    """Wheel 2 lags behind a rigid mesh by the deflection at which the pairs in contact carry the load."""
    pitch, load = base_pitch(spring.joint), 0.1 * spring.curve.end_point[1]
    phases = pitch * np.linspace(-0.5, 0.5, 21)

    errors = []
    for roll in phases:
        s = brentq(lambda s, roll=roll: motion(spring, s, roll)["f"] - load, 0.0, spring.curve.end_point[0])
        phi1, phi2 = at(spring, s, roll)
        out = motion(spring, s, roll)
        lag = spring.joint.r_b1 * phi1 + spring.joint.r_b2 * phi2 - 0.5 * spring.joint.backlash
        assert out["transmission_error"] == pytest.approx(lag, rel=1e-9, abs=1e-15)
        errors.append((float(out["pairs"]), float(out["transmission_error"])))
    pairs, lags = np.array(sorted(errors)).T
    assert pairs[-1] > pairs[0]
    assert np.all(np.diff(lags)[np.diff(pairs) > 1e-9] < 0.0)
    assert motion(spring, 0.0, phases[3])["transmission_error"] == 0.0


def closed_path(spring, seed, t):
    """Closed motion phi1, w1, phi2, w2 at times t of a period: both flanks and three mesh cycles, back and
    forth."""
    generator = np.random.default_rng(seed)
    n = np.array([1, 3, 5, 7])  # the second half of the period is the first one, reversed
    size, shift = generator.normal(size=(2, 4)) / n**2, generator.uniform(0.0, 2.0 * np.pi, (2, 4))
    angle = 2.0 * np.pi * n * t[:, None]
    largest = (0.5 * spring.joint.backlash + 0.5 * spring.curve.end_point[0], 1.5 * base_pitch(spring.joint))
    values, rates = [], []
    for part, move, most in zip(size, shift, largest, strict=True):
        value = np.sin(angle + move) @ part
        scale = most / np.max(np.abs(value))
        values.append(scale * value)
        rates.append(scale * 2.0 * np.pi * np.cos(angle + move) @ (n * part))
    (way, roll), (v, drift) = values, rates
    r_b1, r_b2 = spring.joint.r_b1, spring.joint.r_b2
    return (
        (roll + 0.5 * way) / r_b1,
        (drift + 0.5 * v) / r_b1,
        (0.5 * way - roll) / r_b2,
        (0.5 * v - drift) / r_b2,
    )


def period(panels=40_000):
    """Times and weights of a Gauss quadrature over a period, five points per panel."""
    x, weights = GAUSS
    t = (np.arange(panels)[:, None] + 0.5 * (1.0 + x)) / panels
    return t.ravel(), np.tile(0.5 * weights / panels, panels)


def undamped(spring):
    """Spring of the same mesh without damping."""
    return GearMeshSpring(
        replace_values(spring.joint, {"d": 0.0}), spring.curve, spring.closing_end_deflection
    )


@each
@pytest.mark.parametrize("seed", range(4))
def test_a_closed_path_returns_its_energy(spring, seed):
    """Over three mesh cycles with contact of both flanks and separation, the work is zero."""
    t, weights = period()
    path = closed_path(spring, seed, t)
    out = undamped(spring).evaluate(*path)
    assert np.any(out["f"] > 0.0)
    assert np.any(out["f"] < 0.0)
    assert np.ptp(out["pairs"]) > 0.99
    power = out["tau1"] * path[1] + out["tau2"] * path[3]
    moved = weights @ np.abs(power)
    # what is left is the quadrature's, across the ends of the pairs' changes: 16 times less per halving
    assert abs(weights @ power) <= 1e-9 * moved


def test_without_the_change_of_the_pairs_a_mesh_would_create_energy():
    """Torques of force times base radius alone give work on a closed path, far above the error of the
    quadrature."""
    t, weights = period()
    path = closed_path(SPRINGS["default"], 0, t)
    force = undamped(SPRINGS["default"]).evaluate(*path)["f"]
    power = -force * (MESH.r_b1 * path[1] + MESH.r_b2 * path[3])
    assert abs(weights @ power) > 1e-4 * (weights @ np.abs(power))


@each
@pytest.mark.parametrize("seed", range(2))
def test_what_a_path_loses_is_the_work_of_the_damping(spring, seed):
    t, weights = period()
    path = closed_path(spring, seed, t)
    out, elastic = spring.evaluate(*path), undamped(spring).evaluate(*path)
    power = out["tau1"] * path[1] + out["tau2"] * path[3]
    rate = spring.joint.r_b1 * path[1] + spring.joint.r_b2 * path[3]
    lost = (out["f"] - elastic["f"]) * rate
    assert np.all(lost >= 0.0)
    assert np.all(lost[out["s_rel"] == 0.0] == 0.0)
    assert weights @ lost > 0.0
    assert weights @ (power + lost) == pytest.approx(0.0, abs=1e-9 * (weights @ np.abs(power)))


@each
def test_damping_comes_in_over_the_closing(spring):
    """Zero at first contact, d when the contact has closed, smooth between."""
    still, v = undamped(spring), 0.01
    s = np.concatenate([[0.0], np.linspace(1e-3, 3.0, 2000)]) * spring.closing_end_deflection
    damped = motion(spring, s, 0.0, v)["f"] - motion(still, s, 0.0, v)["f"]
    full = spring.joint.d * v
    assert damped[0] == 0.0
    np.testing.assert_allclose(
        damped[s > 1.001 * spring.closing_end_deflection], full, rtol=1e-6
    )  # of a larger force
    # 1.875/3 of the whole over the 2000 steps at the steepest, and the force's round-off
    assert np.max(np.abs(np.diff(damped))) < 1.9 * 3.0 / 2000.0 * full
    np.testing.assert_allclose(
        motion(spring, -s, 0.0, -v)["f"], -motion(spring, s, 0.0, v)["f"], rtol=0.0, atol=0.0
    )


angles = st.floats(-20.0, 20.0)
speeds = st.floats(-100.0, 100.0)


@each
@settings(max_examples=60)
@given(phi1=angles, w1=speeds, w2=speeds, way=st.floats(-3e-4, 3e-4))
def test_odd_in_the_direction_of_rotation(spring, phi1, w1, w2, way):
    phi2 = (way - spring.joint.r_b1 * phi1) / spring.joint.r_b2
    there, back = spring.evaluate(phi1, w1, phi2, w2), spring.evaluate(-phi1, -w1, -phi2, -w2)
    for name in ("tau1", "tau2", "f", "s_rel"):
        assert float(back[name]) == -float(there[name]), name
    for name in ("K", "pairs", "E"):
        assert float(back[name]) == float(there[name]), name


@each
def test_nothing_inside_the_backlash(spring):
    way = np.linspace(-0.499, 0.499, 11) * spring.joint.backlash
    out = spring.evaluate(way / spring.joint.r_b1, 3.0, 0.0, -2.0)
    for name in ("tau1", "tau2", "s_rel", "f", "K", "E"):
        assert np.all(out[name] == 0.0), name


def test_rolling_wheels_carry_the_torque_ratio():
    """Except where the number of pairs changes, tau2/tau1 = r_b2/r_b1, both against the compressing
    motion."""
    out = motion(SPRINGS["default"], 1e-5, 0.0)
    assert out["tau1"] == pytest.approx(-MESH.r_b1 * out["f"], rel=1e-14)
    assert out["tau2"] == pytest.approx(-MESH.r_b2 * out["f"], rel=1e-14)
    assert out["f"] > 0.0


def test_mean_stiffness_is_the_contact_ratio_times_a_pairs():
    spring, s = SPRINGS["default"], 2e-5
    n = 3000
    roll = (np.arange(n) + 0.5) / n * base_pitch(MESH)
    K = motion(spring, s, roll)["K"]
    _, one = spring.curve.derivatives(s, 1)
    # the midpoint rule of a function with three derivatives between 3000 points
    assert np.mean(K) == pytest.approx(MESH.contact_ratio * float(one), rel=1e-8)


@pytest.mark.parametrize("ratio", [1.0, 2.0])
def test_a_whole_contact_ratio_has_no_mesh_cycle(ratio):
    spring = SPRINGS["default"]
    even = GearMeshSpring(
        replace_values(MESH, {"contact_ratio": ratio}), spring.curve, spring.closing_end_deflection
    )
    out = motion(even, 2e-5, np.linspace(0.0, 3.0, 50) * base_pitch(MESH))
    assert np.all(out["pairs"] == ratio)
    np.testing.assert_allclose(out["tau1"], -MESH.r_b1 * out["f"], rtol=1e-14)


def test_beyond_the_table_the_tangent_continues_with_a_warning():
    model, spring = MODELS["GearMesh"], SPRINGS["default"]
    end = spring.curve.end_point[0]
    out = motion(spring, end * np.array([1.0, 1.5, -4.0]), 0.0)
    np.testing.assert_allclose(out["K"], out["K"][0], rtol=1e-10)  # round-off over the last segment
    expected = out["f"][0] * np.array([1.0, 1.0, -1.0]) + out["K"][0] * end * np.array([0.0, 0.5, -3.0])
    np.testing.assert_allclose(out["f"], expected, rtol=1e-9)
    for s, count in ((0.5 * end, 0), (1.5 * end, 1), (-1.5 * end, 1)):
        phi1, phi2 = at(spring, s, 0.0)
        values = {"phi1": float(phi1), "w1": 0.0, "phi2": float(phi2), "w2": 0.0}
        warnings = model.find_warnings(spring, values | dict(model.evaluate(spring, values)))
        assert len(warnings) == count
        assert all("s_rel" in text and "tangent" in text for text in warnings.values())


def test_the_model_gives_its_outputs_and_depends_as_it_says():
    model, spring = MODELS["GearMesh"], SPRINGS["default"]
    rest = {"phi1": 1.4e-3, "w1": 0.1, "phi2": 0.0, "w2": 0.2}
    base = model.evaluate(spring, rest)
    assert list(base) == [v.name for v in model.outputs]
    changing = {name: set() for name in base}
    for name in rest:
        moved = model.evaluate(spring, rest | {name: rest[name] + 1e-4})
        for output in base:
            if moved[output] != base[output]:
                changing[output].add(name)
    # at this phase the number of pairs rests
    assert {name: set(model.list_dependencies(name)) for name in base} == changing | {
        "pairs": {"phi1", "phi2"}
    }
    assert {"mu", "traction_ratio"}.isdisjoint(model.parameter_fields())


@pytest.mark.parametrize("name", ["default", "soft teeth"])
def test_symbols(name):
    """The equations give the same numbers when they are evaluated with symbols, from which the C code is
    made."""
    import casadi

    from jointfmu.joints.gear_mesh.spring import deflection, mesh_outputs

    spring = SPRINGS[name]
    symbols = casadi.SX.sym("x", 8)
    x = casadi.vertsplit(symbols)
    mesh = replace_values(spring.joint, {"contact_ratio": 1.5})
    object.__setattr__(mesh, "contact_ratio", x[4])
    before = casadi.GlobalOptions.getNumpyMode()
    casadi.GlobalOptions.setNumpyMode(1)
    try:
        out = mesh_outputs(mesh, x[:4], x[5], x[6], x[7], spring.closing_end_deflection)
        function = casadi.Function("f", [symbols], [casadi.vertcat(*out.values())])
    finally:
        casadi.GlobalOptions.setNumpyMode(before)
    for roll in np.linspace(-1.0, 1.0, 21) * base_pitch(mesh):
        for s in (-2e-5, 0.3 * spring.closing_end_deflection, 2e-5):
            phi1, phi2 = at(spring, s, roll)
            moving = (phi1, 0.3, phi2, -0.1)
            for ratio in (1.0, 1.69, 2.3):
                sure = GearMeshSpring(
                    replace_values(mesh, {"contact_ratio": ratio}),
                    spring.curve,
                    spring.closing_end_deflection,
                )
                way = float(np.abs(deflection(sure.joint, moving)))
                load, stiffness = (float(y) for y in spring.curve.derivatives(way, 1))
                energy = float(spring.curve.energy(way))
                found = np.array(function([*moving, ratio, load, stiffness, energy])).ravel()
                expected = np.array([float(y) for y in sure.evaluate(*moving).values()])
                # powers are multiplied in another order
                np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-12 * abs(expected[3]) * 1e-6)


@each
def test_shapes(spring):
    phi = np.linspace(-2e-3, 2e-3, 12).reshape(3, 4)
    together = spring.evaluate(phi, 0.1, 0.0, phi)
    for name, value in together.items():
        assert np.shape(value) == (3, 4), name
        assert float(value[2, 1]) == float(spring.evaluate(phi[2, 1], 0.1, 0.0, phi[2, 1])[name])


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"r_b1": 0.0}, ("r_b1 = 0 m", "(0, inf)")),
        ({"r_b2": -0.1}, ("r_b2 = -0.1 m", "(0, inf)")),
        ({"teeth1": 12.5}, ("teeth1 = 12.5", "whole number")),
        ({"teeth1": 0.0}, ("teeth1 = 0", "[1, inf)")),
        ({"backlash": -1e-6}, ("backlash = -1e-06 m", "[0, inf)")),
        ({"K_tooth": 0.0}, ("K_tooth = 0 N/m", "(0, inf)")),
        ({"K_tooth": float("inf")}, ("K_tooth = inf N/m", "(0, inf)")),
        ({"contact_ratio": 0.99}, ("contact_ratio = 0.99", "[1, 3)")),
        ({"contact_ratio": 3.0}, ("contact_ratio = 3", "[1, 3)")),
        ({"engagement": 0.0}, ("engagement = 0", "(0, 1]")),
        ({"engagement": 1.1}, ("engagement = 1.1", "(0, 1]")),
        ({"d": -1.0}, ("d = -1 N.s/m", "[0, inf)")),
        ({"d": float("nan")}, ("d = nan N.s/m", "[0, inf)")),
        ({"e": 1.0}, ("e = 1", "[0, 1)")),
        ({"K_tooth": "stiff"}, ("K_tooth = 'stiff'", "N/m")),
    ],
)
def test_impossible_meshes_are_refused(changes, words):
    with pytest.raises(ValueError, match=next(iter(changes))) as error:
        replace_values(MESH, changes)
    assert "\n" not in str(error.value)
    for word in words:
        assert word in str(error.value)


def test_parameter_file_round_trip(tmp_path):
    file = load_default("gear_mesh")
    path = tmp_path / "mesh.toml"
    path.write_text(format_parameter_file(file))
    again = load_parameter_file(path, "gear_mesh")
    assert isinstance(again.values, GearMeshParameters)
    assert again.values == file.values
    assert (again.name, dict(again.sources)["K_tooth"]) == (file.name, file.sources["K_tooth"])


def test_default_geometry():
    """Base circles for module 4 mm at 20 degrees; contact ratio of full-depth spur teeth."""
    m, alpha, z = 4e-3, np.radians(20.0), np.array([29, 45])
    base = 0.5 * m * z * np.cos(alpha)
    assert (MESH.r_b1, MESH.r_b2) == pytest.approx(base, rel=1e-7)  # the file's digits
    tip = 0.5 * m * z + m
    length = np.sum(np.sqrt(tip**2 - base**2)) - 0.5 * m * np.sum(z) * np.sin(alpha)
    assert base_pitch(MESH) == pytest.approx(np.pi * m * np.cos(alpha), rel=1e-7)
    assert pytest.approx(length / base_pitch(MESH), abs=5e-3) == MESH.contact_ratio
