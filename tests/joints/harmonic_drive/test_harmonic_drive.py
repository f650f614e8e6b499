"""Torsional spring of the harmonic drive: law, table, and outputs of both FMUs."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

from jointfmu.contact.interface import evaluate_at_pressure
from jointfmu.contact.laws.hu2023 import critical_area
from jointfmu.joints import KINDS
from jointfmu.joints.harmonic_drive.law import (
    HarmonicDriveParameters,
    contact_pair_stiffness,
    drive_stiffness,
    peak_pressure,
)
from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring, torque_curve
from jointfmu.mechanics.curve import MAX_INTERPOLATION_ERROR
from jointfmu.parameters import load_default, load_parameter_file
from jointfmu.quantity import build_parameter_set, flatten_parameters

EPS = np.finfo(float).eps
STENCIL = np.array([1.0, -8.0, 0.0, 8.0, -1.0]) / 12.0
"""Central difference with five points; its error is h^4/30 times the fifth derivative."""
FIVE = np.arange(-2, 3)

DRIVE = load_default("harmonic_drive").values


def drive(**values):
    """Default drive with changed values; a double underscore in an argument name stands for a dot."""
    changes = {name.replace("__", "."): value for name, value in values.items()}
    return build_parameter_set(HarmonicDriveParameters, flatten_parameters(DRIVE) | changes)


SETS = {
    "default": DRIVE,
    "eccentric": drive(eccentricity=3e-5, radial_deformation=0.2e-3),
    "soft": drive(surface__D=2.6, surface__r_m=3e-7, traction_ratio=0.0, K_FTS0=7e3),
    "wide": drive(torque_smoothing=0.5, max_torque=12.0, traction="real_area", shear_traction=5e5),
    "rough": load_parameter_file(KINDS["harmonic_drive"].default_file("roughness")).values,
}
each_drive = pytest.mark.parametrize("it", SETS.values(), ids=SETS)


@pytest.fixture(scope="module")
def springs():
    return {name: HarmonicDriveSpring.tabulate(it) for name, it in SETS.items()}


@pytest.fixture(scope="module")
def spring(springs):
    return springs["default"]


def still(spring, phi):
    """Outputs at a wind-up, at rest."""
    return spring.evaluate_motion(0.0, 0.0, phi, 0.0)


# The law


@each_drive
def test_peak_pressure(it):
    """The peak pressure has its exact derivative, its symmetry, and its two defining values."""
    T = np.array([1e-3, 0.03, 0.1, 1.0, 5.0, 20.0])
    h = 1e-3 * T
    around = peak_pressure(it, T + h * FIVE[:, None])[0]
    p, slope = peak_pressure(it, T)
    # (h/T)^4 of truncation and eps p/h of round-off
    error = np.abs(slope - STENCIL @ around / h)
    assert np.all(error <= 1e-9 * slope + 10.0 * EPS * p / h)
    np.testing.assert_array_equal(peak_pressure(it, -T)[0], p)
    np.testing.assert_array_equal(peak_pressure(it, -T)[1], -slope)
    assert peak_pressure(it, 0.0)[1] == 0.0
    loss = it.zero_torque_pressure - peak_pressure(it, 0.0)[0]
    assert loss == pytest.approx(it.peak_pressure_reduction, rel=1e-13, abs=1e-6)  # difference of 1e8 Pa
    rated = peak_pressure(it, it.rated_torque)[0] + it.peak_pressure_reduction
    assert rated == pytest.approx(it.rated_pressure, rel=1e-13)  # round-off


@each_drive
def test_derivatives_of_the_stiffness(it):
    """dK_TS/dT and dK_WTS/dT agree with central differences for both laws."""
    T = np.array([0.02, 0.3, 2.0, 5.0, 11.0])
    h = 1e-3 * np.hypot(T, it.torque_smoothing)
    for law in (contact_pair_stiffness, drive_stiffness):
        value, slope = law(it, T)
        around = law(it, T + h * FIVE[:, None])[0]
        # the law is smooth over h: (h/T)^4 of truncation, and the same sum's round-off eps/h
        np.testing.assert_allclose(slope, STENCIL @ around / h, rtol=1e-6)
        assert np.all(slope > 0.0)
        assert np.all(np.diff(value) > 0.0)
        assert law(it, 0.0)[1] == 0.0


@each_drive
def test_eq_46(it):
    """The stiffness obeys Eq. 46: 1/K_WTS = 1/K_FTS + 1/K_TS."""
    T = np.array([0.0, 0.5, 3.0, 12.0])
    total = drive_stiffness(it, T)[0]
    contact = contact_pair_stiffness(it, T)[0]
    np.testing.assert_allclose(1.0 / total, 1.0 / it.K_FTS0 + 1.0 / contact, rtol=1e-14)  # round-off
    np.testing.assert_array_equal(drive_stiffness(it, -T)[0], total)


def test_printed_equations():
    """K_TS by Eqs. 17, 18, 23, 28, 30, 39, 45 in the symbols of the paper, at the mean pressure."""
    s, T = DRIVE.surface, np.array([0.5, 5.0, 20.0])
    P = DRIVE.mean_over_peak * peak_pressure(DRIVE, T)[0]
    bodies = (DRIVE.flexspline, DRIVE.bearing)
    E = 1.0 / sum((1.0 - b.nu**2) / b.E for b in bodies)
    shear = 1.0 / sum((2.0 - b.nu) * 2.0 * (1.0 + b.nu) / b.E for b in bodies)
    f_e = 2 ** (5 - s.D) * E * np.sqrt(np.pi) * s.G ** (s.D - 2) * np.sqrt(np.log(s.gamma))
    f_e /= 3.0 * s.r_m ** (s.D - 1)  # over s^1.5, Eq. 9
    root = P / (f_e * (3 - s.D) / (4 - s.D))  # of the largest spot's area
    psi = 5.454 * np.exp((1.0 - s.D) / 0.628) + 1.499
    K_N = (s.D - 1) / (0.5 * s.D - 1) * E / np.sqrt(np.pi) * psi ** (1.5 - 0.5 * s.D) * root
    K_T = 4.0 * shear / E * (1.0 - DRIVE.traction_ratio) ** (1.0 / 3.0) * K_N
    state = evaluate_at_pressure(DRIVE.contact_pair_law, P)
    np.testing.assert_allclose(state["K_N"], K_N, rtol=1e-12)  # round-off
    np.testing.assert_allclose(state["K_T"], K_T, rtol=1e-12)
    np.testing.assert_allclose(state["F"], P * DRIVE.node_area, rtol=1e-12)
    found = contact_pair_stiffness(DRIVE, T)[0] / DRIVE.drive_scale
    np.testing.assert_allclose(found, DRIVE.A_0 / DRIVE.node_area * K_T * 2.0 * DRIVE.radius, rtol=1e-12)


def test_roughness_has_no_scale():
    """K_TS by the energy of a unit twist with the law at the mean pressure."""
    it, T = SETS["rough"], np.array([0.0, 1.0, 5.0, 25.0])
    p = it.mean_over_peak * peak_pressure(it, T)[0]
    expected = evaluate_at_pressure(it.law, p)["K_T"] * it.radius**2
    np.testing.assert_allclose(contact_pair_stiffness(it, T)[0], expected, rtol=1e-12)  # round-off
    assert HarmonicDriveSpring.tabulate(it).evaluate_torque(5.0)["K_TS_pair"] == pytest.approx(
        expected[2], rel=1e-6
    )


def test_beyond_rated_torque_the_stiffness_settles():
    """K3 = 7100 N.m/rad of catalogue drives of size 14, within a tenth in their range of 10 to 30 N.m."""
    K = drive_stiffness(DRIVE, np.array([10.0, 15.0, 30.0, 1e3, 1e9]))[0]
    np.testing.assert_allclose(K[:3], 7100.0, rtol=0.11)
    assert K[4] == pytest.approx(K[3], rel=1e-8)
    rated = DRIVE.rated_torque
    most = np.sqrt(
        DRIVE.zero_torque_pressure**2
        + (DRIVE.rated_pressure**2 - DRIVE.zero_torque_pressure**2)
        * (2.0 * rated - DRIVE.torque_smoothing)
        / (rated * 17.0**-0.25 * 2.0 - DRIVE.torque_smoothing)
    )
    assert peak_pressure(DRIVE, 1e3)[0] + DRIVE.peak_pressure_reduction == pytest.approx(
        most, rel=1e-3
    )  # T_s^2


def test_published_stiffness():
    """Hu 2023: K_TS of sections 3.2 and 3.4, K_WTS of sections 3.1 and 4; all fitted, to 1e-8."""
    assert float(contact_pair_stiffness(DRIVE, 5.0)[0]) == pytest.approx(4.0 * 1820.44, rel=1e-8)
    best = replace(DRIVE, radial_deformation=0.21e-3)
    assert float(contact_pair_stiffness(best, 5.0)[0]) == pytest.approx(4.0 * 1940.49, rel=1e-8)
    assert drive_stiffness(DRIVE, np.array([0.5, 5.0]))[0] == pytest.approx([2524.92, 5294.0], rel=1e-8)


@pytest.mark.parametrize("torque", [0.0, 1.0, 3.0, 5.0])
def test_eccentricity_and_deformation_lower_the_stiffness(torque):
    offsets = np.linspace(0.0, 5e-5, 6)
    eccentric = [float(contact_pair_stiffness(replace(DRIVE, eccentricity=e), torque)[0]) for e in offsets]
    assert np.all(np.diff(eccentric) < 0.0)
    for sign in (-1.0, 1.0):
        ws = DRIVE.optimum_deformation + sign * np.linspace(0.0, 2.5e-5, 6)
        deformed = [
            float(contact_pair_stiffness(replace(DRIVE, radial_deformation=w), torque)[0]) for w in ws
        ]
        assert np.all(np.diff(deformed) < 0.0)


def test_softer_body_is_the_one_that_yields_first():
    assert DRIVE.flexspline.sigma_y < DRIVE.bearing.sigma_y
    swapped = replace(DRIVE, flexspline=DRIVE.bearing, bearing=DRIVE.flexspline)
    assert DRIVE.law.side1.E == swapped.law.side1.E == DRIVE.flexspline.E
    assert DRIVE.law.side2.nu == swapped.law.side2.nu == DRIVE.bearing.nu
    assert DRIVE.law.sigma_y == swapped.law.sigma_y == DRIVE.flexspline.sigma_y
    assert contact_pair_stiffness(swapped, 5.0) == contact_pair_stiffness(DRIVE, 5.0)
    hard = drive(flexspline__sigma_y=2.5e9)
    assert hard.law.sigma_y == DRIVE.bearing.sigma_y
    assert hard.law.side1.E == DRIVE.bearing.E


# The table


@each_drive
def test_windup_is_the_integral_of_dT_over_K(it, springs):
    """The wind-up agrees with adaptive quadrature of 1/K_WTS from zero, to MAX_INTERPOLATION_ERROR."""
    curve = next(spring.curve for spring in springs.values() if spring.joint is it)
    torques = [0.0, 0.2 * it.torque_smoothing, it.torque_smoothing, 0.5, 5.0, it.max_torque]
    phi = 0.0
    for low, high in pairwise(torques):
        phi += quad(lambda T: 1.0 / float(drive_stiffness(it, T)[0]), low, high, epsabs=0.0, epsrel=1e-10)[0]
        assert float(curve.inverse(high)) == pytest.approx(phi, rel=MAX_INTERPOLATION_ERROR)
        load, stiffness = curve.derivatives(phi, 1)
        assert load == pytest.approx(high, rel=MAX_INTERPOLATION_ERROR)
        assert stiffness == pytest.approx(float(drive_stiffness(it, high)[0]), rel=MAX_INTERPOLATION_ERROR)


@pytest.mark.slow
@each_drive
def test_table_follows_the_law_between_its_nodes(it, springs):
    curve = next(spring.curve for spring in springs.values() if spring.joint is it)
    assert curve.interpolation_error <= MAX_INTERPOLATION_ERROR
    x = curve.displacement
    T, K = curve.derivatives((x[:-1] + np.linspace(0.0, 1.0, 8)[:, None] * np.diff(x)).ravel(), 1)
    np.testing.assert_allclose(K, drive_stiffness(it, T)[0], rtol=MAX_INTERPOLATION_ERROR)
    assert np.all(np.diff(curve.load) > 0.0)
    assert curve.end_point[1] == pytest.approx(it.max_torque, rel=1e-12)  # sinh of asinh
    assert (x[0], curve.load[0]) == (0.0, 0.0)


@pytest.mark.parametrize("side", ["flexspline", "bearing"])
def test_spots_that_would_yield_are_refused(side):
    """The largest spot reaches s_ec where F_r/S_r reaches the pressure at max_torque."""
    it = drive(**{f"{side}__sigma_y": 3e8})
    with pytest.raises(ValueError, match=rf"{side}\.sigma_y = 3e\+08 Pa is outside \(") as error:
        torque_curve(it)
    least = float(str(error.value).split("(")[1].split(",")[0])
    edge = drive(**{f"{side}__sigma_y": least})
    ends = evaluate_at_pressure(edge.contact_pair_law, peak_pressure(edge, edge.max_torque)[0])[
        "largest_spot"
    ]
    assert ends == pytest.approx(critical_area(edge.contact_pair_law), rel=1e-5)  # six digits of the message


@pytest.mark.parametrize(
    ("D", "r_m", "traction", "eccentricity", "K_FTS0", "smoothing"),
    [
        (2.49, 4.6e-7, 0.66, 4.5e-6, 42e3, 0.52),
        (2.71, 2.6e-6, 0.43, 5.9e-6, 71e3, 0.03),
        (2.43, 2.4e-7, 0.59, 3.7e-5, 25e3, 0.63),
        (2.61, 1.3e-6, 0.39, 3.0e-5, 88e3, 0.11),
        (2.22, 1.0e-8, 0.0, 0.0, 5e3, 1.0),
    ],
)
def test_tables_of_other_drives(D, r_m, traction, eccentricity, K_FTS0, smoothing):
    it = drive(
        surface__D=D,
        surface__r_m=r_m,
        traction_ratio=traction,
        eccentricity=eccentricity,
        K_FTS0=K_FTS0,
        torque_smoothing=smoothing,
    )
    curve = torque_curve(it)
    assert curve.interpolation_error <= MAX_INTERPOLATION_ERROR
    assert np.all(np.diff(curve.load) > 0.0)
    assert np.all(np.diff(curve.stiffness) > 0.0)
    assert curve.stiffness_slope_start[0] == 0.0


# The spring


@pytest.mark.parametrize("name", SETS)
def test_torque_is_odd_and_stiffness_even(springs, name):
    phi = np.concatenate([[0.0], np.geomspace(1e-12, 1e-2, 101)])
    there, back = still(springs[name], phi), still(springs[name], -phi)
    np.testing.assert_array_equal(back["tau"], -there["tau"])
    np.testing.assert_array_equal(back["phi_rel"], -phi)
    for quantity in ("K_WTS", "K_TS", "K_FTS", "K_TS_pair", "p_max"):
        np.testing.assert_array_equal(back[quantity], there[quantity])
    T = np.geomspace(1e-9, 50.0, 51)
    negative, positive = (springs[name].evaluate_torque(torque)["phi_rel"] for torque in (-T, T))
    np.testing.assert_array_equal(negative, -positive)


@pytest.mark.parametrize("name", SETS)
def test_smooth_through_zero(springs, name):
    """First and second differences of T over an odd extension: slope K(0), no kink and no curvature."""
    spring = springs[name]
    K_0 = float(still(spring, 0.0)["K_WTS"])
    scale = spring.joint.torque_smoothing / K_0  # rad, over which the stiffness bends
    h = 1e-3 * scale
    tau = still(spring, h * np.arange(-5, 6))["tau"]
    first, second = np.diff(tau) / h, np.diff(tau, 2) / h**2
    # T = K_0 phi + K'' phi^3/6 with K'' scale^2 < K_0: (6 h/scale)^2 of curvature
    np.testing.assert_allclose(first, K_0, rtol=36e-6)
    assert np.all(np.abs(second) * scale < 1e-2 * K_0)
    assert abs(second[4]) * scale < 1e-9 * K_0  # at zero itself only round-off eps/(h/scale)
    K = still(spring, h * np.array([-1.0, 0.0, 1.0]))["K_WTS"]
    assert K[0] == K[2]
    assert K[2] == pytest.approx(K[1], rel=1e-6)  # (h/scale)^2


@pytest.mark.parametrize("name", SETS)
def test_inverse_is_consistent(springs, name):
    """Compliance and spring follow the same law, also beyond the table."""
    spring = springs[name]
    T = np.concatenate([np.geomspace(1e-9, 1.0, 201), np.linspace(-1.5, 1.5, 202)]) * spring.joint.max_torque
    given_torque = spring.evaluate_torque(T)
    given_angle = still(spring, given_torque["phi_rel"])
    # the polynomial's round-off: 60 eps, carried 0.5 of the table beyond its end over a segment of 0.02
    np.testing.assert_allclose(given_angle["tau"], T, rtol=60 * EPS * 25, atol=60 * EPS * 0.1)
    for quantity in ("K_WTS", "K_TS", "K_FTS", "K_TS_pair", "p_max"):
        np.testing.assert_allclose(given_angle[quantity], given_torque[quantity], rtol=1e-12)  # round-off


@pytest.mark.parametrize("name", SETS)
def test_stiffness_is_the_exact_derivative(springs, name):
    spring = springs[name]
    end = spring.curve.end_point[0]
    for phi in np.geomspace(1e-3, 0.99, 25) * end:
        left = int(np.searchsorted(spring.curve.displacement, phi)) - 1
        a, b = spring.curve.displacement[left : left + 2]
        middle, h = 0.5 * (a + b), (b - a) / 8.0
        slope = STENCIL @ still(spring, middle + h * FIVE)["tau"] / h
        K = float(still(spring, middle)["K_WTS"])
        # truncation h^4/30 of the fifth derivative of a table whose bends are below 100 K/segment^2
        # would be 1e-9 at most; round-off 20 eps tau/(h K)
        noise = 1e2 * EPS * spring.curve.load[left + 1] / (h * K)
        assert slope == pytest.approx(K, rel=1e-9 + noise)


def test_eq_46_of_the_outputs(spring):
    phi = np.linspace(-6e-3, 6e-3, 41)
    out = still(spring, phi)
    # K_TS comes from a difference of compliances: K_TS/K_WTS times round-off
    np.testing.assert_allclose(1 / out["K_WTS"], 1 / out["K_FTS"] + 1 / out["K_TS"], rtol=1e-14)
    np.testing.assert_array_equal(out["K_FTS"], DRIVE.K_FTS0)
    np.testing.assert_allclose(out["K_TS_pair"] * DRIVE.drive_scale, out["K_TS"], rtol=4 * EPS)
    inside = np.abs(out["tau"]) < DRIVE.max_torque
    expected = contact_pair_stiffness(DRIVE, out["tau"][inside])[0]
    # MAX_INTERPOLATION_ERROR of K_WTS, amplified K_TS/K_WTS <= 2 in the difference
    np.testing.assert_allclose(out["K_TS"][inside], expected, rtol=4 * MAX_INTERPOLATION_ERROR)
    np.testing.assert_allclose(out["p_max"], peak_pressure(DRIVE, out["tau"])[0], rtol=1e-14)  # round-off


def test_torques_on_the_flanges(spring):
    """tau1 = tau/ratio, tau2 = -tau; the wind-up is phi2 - phi1/ratio."""
    rng = np.random.default_rng(1)
    phi1, w1 = rng.uniform(-3, 3, (2, 50))
    phi2 = phi1 / DRIVE.ratio + rng.uniform(-4e-3, 4e-3, 50)
    w2 = rng.uniform(-0.1, 0.1, 50)
    out = spring.evaluate_motion(phi1, w1, phi2, w2)
    np.testing.assert_array_equal(out["tau1"], out["tau"] / 100.0)
    np.testing.assert_array_equal(out["tau2"], -out["tau"])
    np.testing.assert_array_equal(out["phi_rel"], phi2 - phi1 / 100.0)
    elastic = still(spring, out["phi_rel"])["tau"]
    np.testing.assert_array_equal(np.sign(elastic), np.sign(out["phi_rel"]))
    rate = w2 - w1 / 100.0
    np.testing.assert_allclose(out["tau"] - elastic, DRIVE.d * rate, atol=8 * EPS * 30)  # tau up to 30
    # what the element takes from the flanges beyond the elastic part is dissipated
    power = -(out["tau1"] * w1 + out["tau2"] * w2) - elastic * rate
    np.testing.assert_allclose(power, DRIVE.d * rate**2, atol=1e-12)  # round-off of a few watts
    assert np.all(power > -1e-12)


def test_rigid_rotation_makes_no_torque(spring):
    """Both flanges rotated at the ratio: the wind-up is exactly zero for binary-exact angles."""
    out = spring.evaluate_motion(100.0 * 0.25, 100.0 * 0.5, 0.25, 0.5)
    assert (out["phi_rel"], out["tau"], out["tau1"], out["tau2"]) == (0.0, 0.0, 0.0, 0.0)


def energy(spring, start, end, pieces):
    """Integral of tau dphi by ten Gauss-Legendre nodes on each of the pieces."""
    x, w = np.polynomial.legendre.leggauss(10)
    ends = np.linspace(start, end, pieces + 1)
    half = 0.5 * np.diff(ends)[:, None]
    return float(np.sum(half * w * still(spring, ends[:-1, None] + half * (1.0 + x))["tau"]))


def test_closed_cycle_returns_its_energy(spring):
    """Path back and forth through zero on different points; the energy agrees with the energy of the law."""
    turns = [0.0, 4e-3, -2e-3, 1e-3, -4.5e-3, 0.0]  # rad, past the end of the table at 4.36e-3
    parts = [energy(spring, a, b, 400 + 37 * i) for i, (a, b) in enumerate(pairwise(turns))]
    # pieces of 1e-5 rad do not end at the nodes, where the third derivative jumps by interpolation
    # errors: better than MAX_INTERPOLATION_ERROR of the energy
    assert sum(parts) == pytest.approx(0.0, abs=MAX_INTERPOLATION_ERROR * max(np.abs(parts)))
    T = float(still(spring, 4e-3)["tau"])
    expected = quad(lambda t: t / float(drive_stiffness(DRIVE, t)[0]), 0.0, T, epsabs=0.0, epsrel=1e-10)[0]
    assert parts[0] == pytest.approx(expected, rel=2 * MAX_INTERPOLATION_ERROR)  # of load and of stiffness


def test_damping_dissipates(spring):
    """A cycle at angular frequency omega dissipates pi d omega phi^2, for any spring."""
    omega, phi = 20.0, 3e-3
    t = np.arange(4096) / 4096 * 2 * np.pi / omega
    out = spring.evaluate_motion(0.0, 0.0, phi * np.sin(omega * t), phi * omega * np.cos(omega * t))
    lost = np.mean(out["tau"] * phi * omega * np.cos(omega * t)) * 2 * np.pi / omega
    # a periodic sum over 4096 points: the elastic part cancels by symmetry
    assert lost == pytest.approx(np.pi * DRIVE.d * omega * phi**2, rel=1e-10)


def test_beyond_the_table_the_tangent_continues(spring):
    end, torque = spring.curve.end_point
    out = still(spring, np.array([end, 1.1 * end, 3.0 * end, -3.0 * end]))
    K = out["K_WTS"][0]
    np.testing.assert_allclose(out["K_WTS"], K, rtol=1e-12)  # round-off
    expected = torque + K * (np.array([1.0, 1.1, 3.0, 3.0]) - 1.0) * end
    np.testing.assert_allclose(np.abs(out["tau"]), expected, rtol=1e-12)  # round-off
    assert out["tau"][3] < 0.0


# Refusals


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"eccentricity": 2e-4}, ("eccentricity = 0.0002 m", "[0, ")),
        ({"eccentricity": -1e-6}, ("eccentricity = -1e-06 m", "[0, 0.001)")),
        ({"eccentricity": float("nan")}, ("eccentricity = nan m", "[0, 0.001)")),
        ({"radial_deformation": 0.3e-3}, ("radial_deformation = 0.0003 m",)),
        ({"radial_deformation": 0.0}, ("radial_deformation = 0 m", "(0, 0.002)")),
        ({"rated_pressure": 3e7}, ("rated_pressure = 3e+07 Pa", "zero_torque_pressure")),
        ({"surface__D": 3.0}, ("D = 3", "(2, 3)")),
        ({"flexspline__sigma_y": 0.0}, ("flexspline.sigma_y = 0 Pa", "(0, inf)")),
        ({"K_FTS0": float("inf")}, ("K_FTS0 = inf N.m/rad", "(0, inf)")),
        ({"traction_ratio": 1.0}, ("traction_ratio = 1", "[0, 1)")),
        ({"d": -0.1}, ("d = -0.1 N.m.s/rad", "[0, inf)")),
        ({"ratio": 0.0}, ("ratio = 0", "(0, inf)")),
    ],
)
def test_impossible_drives_are_refused(changes, words):
    with pytest.raises(ValueError, match=next(iter(changes)).split("__")[-1]) as error:
        drive(**changes)
    assert "\n" not in str(error.value)
    for word in words:
        assert word in str(error.value)


def test_the_allowed_eccentricity_is_what_the_message_says():
    with pytest.raises(ValueError, match="eccentricity") as error:
        drive(eccentricity=2e-4)
    limit = float(str(error.value).split("[0, ")[1].split(")")[0])
    assert peak_pressure(drive(eccentricity=0.999 * limit), 0.0)[0] > 0.0
    with pytest.raises(ValueError, match="eccentricity"):
        drive(eccentricity=1.001 * limit)
