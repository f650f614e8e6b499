"""Pressure over the contacts: bolts on a frame, lobes of the wave generator, and sums over nodes."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from jointfmu.footprint.bolts import BoltPattern, cells, pressure_shape, unit_pressures
from jointfmu.footprint.lobes import two_lobes
from jointfmu.footprint.nodes import Footprint
from jointfmu.footprint.shape import ALIKE
from jointfmu.interface import at_pressure
from jointfmu.joints.bolted_joint.law import pressures, row_forces
from jointfmu.joints.harmonic_drive.law import footprint, pair_stiffness, peak_pressure
from jointfmu.parameters import default
from jointfmu.quantity import flatten

EPS = np.finfo(float).eps
SUM = 1e-12
"""Sums over a thousand nodes of normalised pressures [1]: round-off."""
FIT = 1e-8
"""Relative residual at which the calibration is accepted [1]."""

JOINT = default("bolted_joint").values
DRIVE = default("harmonic_drive").values

patterns = st.builds(
    BoltPattern,
    row_spacing=st.floats(0.15, 0.6),
    column_spacing=st.floats(0.15, 0.6),
    flange_width=st.floats(0.03, 0.07),
    hole_diameter=st.floats(0.005, 0.02),
    decay_length=st.floats(0.003, 0.3),
    decay_exponent=st.floats(0.6, 3.0),
)


# Bolts


@settings(max_examples=25)
@given(pattern=patterns)
def test_force_is_conserved(pattern):
    """1 N in a bolt is 1 N in the contact, for each bolt and for the shapes of all."""
    areas, points = cells(pattern)
    np.testing.assert_allclose(unit_pressures(pattern, areas, points, points) @ areas, 1.0, rtol=SUM)
    shape = pressure_shape(pattern)
    assert shape.share.sum() == pytest.approx(1.0, rel=SUM)
    assert shape.share @ shape.equal == pytest.approx(1.0, rel=SUM)
    assert shape.share @ shape.tilt == pytest.approx(0.0, abs=SUM)
    np.testing.assert_allclose(shape.share @ shape.position, 0.0, atol=SUM)  # m, about the centroid


def test_cells_fill_the_frame():
    """Their area is that of the frame without its holes, and they lie on its solid part."""
    pattern = JOINT.pattern
    areas, points = cells(pattern)
    width = pattern.flange_width
    outer = (pattern.column_spacing + width) * (pattern.row_spacing + width)
    inner = (pattern.column_spacing - width) * (pattern.row_spacing - width)
    holes = 8.0 * np.pi * (0.5 * pattern.hole_diameter) ** 2
    # cells are cut in 8 x 8: edges of 3.2 m are met to a tenth of a sub-cell of 0.7 mm, holes alike
    assert areas.sum() == pytest.approx(outer - inner - holes, rel=6e-3)
    assert areas.sum() == pytest.approx(JOINT.A_0, rel=5e-4)  # A_0 is this area in three digits
    assert np.all(areas > 0.0)
    assert np.all(
        np.abs(points) <= 0.5 * np.array([pattern.column_spacing, pattern.row_spacing]) + 0.5 * width
    )
    assert 1000 < len(points) < 1300  # about as fine as Zhao's mesh of 1019


def test_bolts_sit_on_the_frame():
    bolts = JOINT.pattern.bolts
    assert len(bolts) == JOINT.n_bolts
    np.testing.assert_allclose(bolts.sum(axis=0), 0.0, atol=EPS)
    np.testing.assert_array_equal(bolts[:3, 1], 0.5 * JOINT.row_distance)
    np.testing.assert_array_equal(bolts[5:, 1], -0.5 * JOINT.row_distance)
    np.testing.assert_array_equal(np.sort(bolts[:3, 0]), [-0.1, 0.0, 0.1])


def mirrored(points, values, sign):
    """Values at the mirror images of the nodes, in the nodes' own order."""
    order, image = (np.lexsort(np.round(p * 1e9).T) for p in (points, points * sign))
    out = np.empty_like(values)
    out[image] = values[order]
    return out


@settings(max_examples=10)
@given(pattern=patterns)
def test_shapes_are_symmetric(pattern):
    shape = pressure_shape(pattern)
    for sign, parity in (((-1, 1), 1.0), ((1, -1), -1.0)):
        for values, factor in ((shape.equal, 1.0), (shape.tilt, parity), (shape.share, 1.0)):
            image = mirrored(shape.position, values, np.array(sign))
            # round-off of the positions over the decay length
            np.testing.assert_allclose(image, factor * values, rtol=1e-9, atol=1e-9 * np.max(np.abs(values)))


@given(pattern=patterns, r=st.floats(0.0, 1.0), further=st.floats(1e-3, 1.0))
def test_pressure_decays_with_the_distance(pattern, r, further):
    near, far = pattern.decay(np.array([r, r + further]))
    assert 0.0 < far < near <= 1.0


def test_pressure_of_one_bolt_falls_outwards():
    areas, points = cells(JOINT.pattern)
    for bolt, unit in zip(
        JOINT.pattern.bolts, unit_pressures(JOINT.pattern, areas, points, points), strict=True
    ):
        outwards = np.argsort(np.hypot(*(points - bolt).T))
        assert np.all(np.diff(unit[outwards]) <= 0.0)


@pytest.mark.parametrize(("preload", "moment"), [(9e3, 0.0), (15e3, 4500.0), (15e3, -2000.0)])
def test_pressures_are_those_of_the_bolt_forces(preload, moment):
    """Every bolt's own force spread by the decay: rows of three, changed by M/(L_a N_b)."""
    shift = moment / (JOINT.row_distance * 3)
    forces = preload + shift * np.array([1, 1, 1, 0, 0, -1, -1, -1])
    assert row_forces(JOINT, preload, moment) == pytest.approx((forces[0], forces[-1]), rel=1e-15)
    areas, points = cells(JOINT.pattern)
    expected = forces @ unit_pressures(JOINT.pattern, areas, points, points) * areas.sum() / JOINT.A_0
    shape = pressure_shape(JOINT.pattern)
    found = pressures(JOINT, shape, preload, moment)
    np.testing.assert_allclose(found, expected, rtol=SUM)
    assert np.all(found > 0.0)
    assert JOINT.A_0 * shape.share @ found == pytest.approx(8 * preload, rel=SUM)


def test_published_bolt_forces():
    """Zhao 2018, section 3: 15 kN and 4500 N m give 20 and 10 kN."""
    assert row_forces(JOINT, 15e3, 4500.0) == pytest.approx((20e3, 10e3), rel=1e-15)


def test_published_pressures():
    """Zhao 2018, section 3: 7.98 MPa at the holes, 0.62 MPa between bolts, at 9 kN (both fitted)."""
    shape = pressure_shape(JOINT.pattern)
    p = pressures(JOINT, shape, 9e3, 0.0)
    assert np.max(p) == pytest.approx(7.98e6, rel=FIT)
    rim = np.min(np.hypot(*(shape.position[np.argmax(p)] - JOINT.pattern.bolts).T))
    assert rim < 0.5 * JOINT.pattern.hole_diameter + JOINT.pattern.flange_width / 7  # within one cell
    areas, points = cells(JOINT.pattern)
    between = 0.5 * (JOINT.pattern.bolts[0] + JOINT.pattern.bolts[3])
    unit = unit_pressures(JOINT.pattern, areas, points, between[None, :]).sum()
    assert 9e3 * unit * areas.sum() / JOINT.A_0 == pytest.approx(0.62e6, rel=FIT)


def test_pressures_of_many_load_cases():
    shape = pressure_shape(JOINT.pattern)
    preload, moment = np.array([[5e3], [9e3]]), np.array([0.0, 1e3, 2e3])
    together = pressures(JOINT, shape, preload, moment)
    assert together.shape == (2, 3, shape.share.size)
    # the same sum of two products
    np.testing.assert_allclose(together[1, 2], pressures(JOINT, shape, 9e3, 2e3), rtol=4 * EPS)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"hole_diameter": 0.04}, ("hole_diameter", "0.04 m", "(0, 0.04)")),
        ({"decay_length": 0.0}, ("decay_length", "0 m", "(0, inf)")),
        ({"flange_width": float("nan")}, ("flange_width", "nan m", "(0, inf)")),
    ],
)
def test_impossible_patterns_are_refused(change, words):
    with pytest.raises(ValueError, match=next(iter(change))) as error:
        replace(JOINT.pattern, **change)
    assert all(word in str(error.value) for word in words)


# Lobes

ELLIPSE = {"mismatch": 3e8, "radius": 0.017, "deformation": 2e-4, "length": 0.01, "cup": 0.02}
NO_BREAKS = np.array([1e15])
"""A law that changes its regime far above every pressure [Pa]."""


def dense(peak, function, *, mismatch, radius, deformation, length, cup):
    """Integral of function(p, alpha, beta, R_a) over the whole contact, over its area: both lobes,
    every angle of theta, by brute force, written in the symbols of Hu 2023, Eq. 45.

    200 x 24 Gauss-Legendre nodes per half lobe, straight in theta and z, clustered at the edge.
    """
    around, along = np.polynomial.legendre.leggauss(200), np.polynomial.legendre.leggauss(24)
    z, w_z = (0.5 * length * (1.0 + along[0]))[:, None], 0.5 * along[1][:, None]
    q, w_q = 0.5 * (1.0 + around[0]), 0.5 * around[1]
    local = peak * (1.0 - z / cup)
    edge = np.arcsin(np.sqrt(np.minimum(local / mismatch, 1.0)))
    w = deformation * (1.0 - z / cup)
    a, b = radius + w, radius - w
    total = 0.0
    for middle in (0.0, np.pi):
        for side in (-1.0, 1.0):
            th = middle + side * edge * (1.0 - q**2)
            p = np.maximum(local - mismatch * np.sin(th) ** 2, 0.0)
            R_a = np.sqrt((a * np.cos(th)) ** 2 + (b * np.sin(th)) ** 2)
            beta = np.arctan2(a * np.sin(th), b * np.cos(th)) - np.arctan2(b * np.sin(th), a * np.cos(th))
            alpha = np.arctan(deformation * np.cos(2.0 * th) / cup)
            total += np.sum(w_z * w_q * 2.0 * q * edge * function(p, alpha, beta, R_a)) / (2.0 * np.pi)
    return total


DENSE = 1e-9
"""Relative tolerance of the product's nodes against `dense` for powers of the pressure [1]: both
are Gauss-Legendre sums of the same function, smooth but for the lobe's edge."""


@pytest.mark.parametrize("peak", [1e4, 4.5e7, 9.635e7, 2.9e8])
def test_share_is_the_contact_fraction(peak):
    """In closed form around, by quadrature along."""
    field = two_lobes(np.array(peak), NO_BREAKS, **ELLIPSE)

    def fraction(z):
        local = peak * (1.0 - z / ELLIPSE["cup"]) / ELLIPSE["mismatch"]
        return 4.0 * np.arcsin(np.sqrt(local)) / (2.0 * np.pi * ELLIPSE["length"])

    expected = quad(fraction, 0.0, ELLIPSE["length"], epsabs=0.0, epsrel=1e-12)[0]
    # arcsin(sqrt) is singular where the lobes meet, at 300 MPa: six nodes along see it coming
    assert field.share.sum() == pytest.approx(expected, rel=1e-5 if peak > 2e8 else DENSE)


def test_lobes_that_meet_cover_the_circle():
    field = two_lobes(np.array(9e8), NO_BREAKS, **ELLIPSE)
    assert field.share.sum() == pytest.approx(1.0, rel=DENSE)
    least = 9e8 * (1.0 - ELLIPSE["length"] / ELLIPSE["cup"]) - 3e8
    assert np.min(field.pressure) > least
    mean = 9e8 * (1.0 - 0.5 * ELLIPSE["length"] / ELLIPSE["cup"]) - 1.5e8  # mean of sin^2 is 1/2
    assert field.mean_pressure == pytest.approx(mean, rel=DENSE)


@pytest.mark.parametrize("peak", [1e4, 4.5e7, 9.635e7])
@pytest.mark.parametrize("power", [1.0, 1.5, 2.0])
def test_quadrature_has_converged(peak, power):
    """Mean of p^power and the corrected Eq. 45 for K_N ~ p^power, K_T = 0.7 K_N."""
    field = two_lobes(np.array(peak), NO_BREAKS, **ELLIPSE)
    expected = dense(peak, lambda p, alpha, beta, R_a: p**power, **ELLIPSE)
    assert field.translation(field.pressure**power) == pytest.approx(expected, rel=DENSE)

    def eq45(p, alpha, beta, R_a):
        part = (np.cos(alpha) * np.sin(beta)) ** 2
        return R_a**2 * p**power * (part + 0.7 * (1.0 - part))

    found = field.rotation(field.pressure**power, 0.7 * field.pressure**power, (0, 0, 1))
    assert found == pytest.approx(dense(peak, eq45, **ELLIPSE), rel=DENSE)


def test_breaks_do_not_change_what_is_smooth():
    """Nodes pieced together at pressures inside, at the ends of, and outside the lobe."""
    peak = np.array(9.635e7)
    plain = two_lobes(peak, NO_BREAKS, **ELLIPSE)
    for breaks in ([5e7], [1e3, 2e7, 9e7, 5e8], [9.635e7, 0.0], [5e7, 5e7]):
        field = two_lobes(peak, np.array(breaks), **ELLIPSE)
        assert field.share.sum() == pytest.approx(plain.share.sum(), rel=DENSE)
        assert field.mean_pressure == pytest.approx(plain.mean_pressure, rel=DENSE)
        assert np.all(field.pressure >= 0.0)


def test_a_law_without_breaks():
    """No regime ends at all: the same nodes as with a break far away, but for an empty piece."""
    plain = two_lobes(np.array(9.635e7), np.array([]), **ELLIPSE)
    far = two_lobes(np.array(9.635e7), NO_BREAKS, **ELLIPSE)
    assert plain.share.sum() == pytest.approx(far.share.sum(), rel=DENSE)
    assert plain.mean_pressure == pytest.approx(far.mean_pressure, rel=DENSE)


def test_lobes_that_meet_pass_no_break():
    """Where even the minor axis is above the last break, that piece is empty, not undefined."""
    for breaks in ([5e7], [1e7, 5e7]):
        field = two_lobes(np.array(9e8), np.array(breaks), **ELLIPSE)
        assert field.share.sum() == pytest.approx(1.0, rel=DENSE)
        assert np.all(np.isfinite(field.pressure))


def test_a_break_is_integrated_exactly():
    """A stiffness with a kink in the pressure, as the laws have: smooth only between the breaks."""
    kink = 6e7

    def stiffness(p):
        return np.where(p < kink, p, kink + 3.0 * (p - kink))

    peak = 9.635e7
    args = {k: v for k, v in ELLIPSE.items() if k in ("mismatch", "length", "cup")}

    def along(z):
        local = peak * (1.0 - z / args["cup"])
        edge, inner = (np.arcsin(np.sqrt(max(local - p, 0.0) / args["mismatch"])) for p in (0.0, kink))

        def p(theta):
            return local - args["mismatch"] * np.sin(theta) ** 2

        parts = (
            quad(lambda t: float(stiffness(p(t))), *ends, epsrel=1e-12)[0]
            for ends in ((0, inner), (inner, edge))
        )
        return 4.0 * sum(parts) / (2.0 * np.pi * args["length"])

    gone = args["cup"] * (1.0 - kink / peak)  # beyond this z no pressure reaches the kink
    expected = quad(along, 0.0, gone, epsrel=1e-10)[0] + quad(along, gone, args["length"], epsrel=1e-10)[0]
    field = two_lobes(np.array(peak), np.array([kink]), **ELLIPSE)
    # around it is exact; along, six nodes see the root-like end of the inner lobe at z = 7.5 mm of 10
    assert field.translation(stiffness(field.pressure)) == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize("torque", [0.0, 0.5, 5.0, 30.0])
def test_pair_stiffness_against_a_dense_field(torque):
    """K_TS of the product against Eq. 45, corrected and written out, over a much denser field."""
    law = DRIVE.law

    def eq45(p, alpha, beta, R_a):
        state = at_pressure(law, p)
        part = (np.cos(alpha) * np.sin(beta)) ** 2
        return R_a**2 * (state["K_N"] * part + state["K_T"] * (1.0 - part))

    expected = dense(
        float(peak_pressure(DRIVE, torque)[0]),
        eq45,
        mismatch=DRIVE.mismatch_pressure,
        radius=DRIVE.radius,
        deformation=DRIVE.radial_deformation,
        length=DRIVE.A_0 / (2.0 * np.pi * DRIVE.radius),
        cup=DRIVE.cup_length,
    )
    # six nodes along the contact see the regimes of the law end at different places
    assert float(pair_stiffness(DRIVE, torque)[0]) == pytest.approx(DRIVE.pair_scale * expected, rel=1e-6)


def test_published_peak_pressure():
    """Hu 2023, section 3.2: 96.35 MPa at 5 N m on the major axis at the opening (fitted)."""
    assert float(peak_pressure(DRIVE, 5.0)[0]) == pytest.approx(96.35e6, rel=FIT)
    field = footprint(DRIVE, 5.0)
    x, y, z = field.position.T
    w = DRIVE.radial_deformation * (1.0 - z / DRIVE.cup_length)
    theta = np.arctan2(y / (DRIVE.radius - w), x / (DRIVE.radius + w))
    assert theta[np.argmax(field.pressure)] == np.min(theta[z == np.min(z)])
    expected = 96.35e6 * (1.0 - z / DRIVE.cup_length) - DRIVE.mismatch_pressure * np.sin(theta) ** 2
    np.testing.assert_allclose(field.pressure, expected, rtol=0.0, atol=FIT * 96.35e6)
    assert 0.9 * 96.35e6 < np.max(field.pressure) < 96.35e6  # no node sits on the corner itself


@given(
    radius=st.floats(5e-3, 0.2),
    flatness=st.floats(1e-4, 0.05),
    cup=st.floats(0.02, 0.2),
    peak=st.floats(1e6, 5e8),
)
def test_ellipse(radius, flatness, cup, peak):
    """R_a and beta of docs/errata.md, from the nodes' positions and normals alone."""
    w0 = flatness * radius
    field = two_lobes(
        np.array(peak), NO_BREAKS, mismatch=3e8, radius=radius, deformation=w0, length=0.01, cup=cup
    )
    x, y, z = field.position.T
    w = w0 * (1.0 - z / cup)
    theta = np.arctan2(y / (radius - w), x / (radius + w))
    R_a = np.sqrt(((radius + w) * np.cos(theta)) ** 2 + ((radius - w) * np.sin(theta)) ** 2)
    np.testing.assert_allclose(np.hypot(x, y), R_a, rtol=1e-13)  # round-off
    np.testing.assert_allclose(np.sum(field.normal**2, axis=-1), 1.0, rtol=1e-13)  # round-off
    # tangent of the ellipse, d position/d theta: the normal has no part along it
    tangent = np.stack([-(radius + w) * np.sin(theta), (radius - w) * np.cos(theta)])
    along = np.sum(tangent * field.normal.T[:2], axis=0) / radius
    np.testing.assert_allclose(along, 0.0, atol=1e-13)  # round-off
    beta = np.arctan2(field.normal[:, 1], field.normal[:, 0]) - np.arctan2(y, x)
    formula = np.arctan2((radius + w) * np.sin(theta), (radius - w) * np.cos(theta))
    formula = formula - np.arctan2((radius - w) * np.sin(theta), (radius + w) * np.cos(theta))
    np.testing.assert_allclose(beta, formula, atol=1e-13)  # differences of angles of order one
    assert np.all(beta >= -1e-15)
    assert np.all(beta <= 2.0 * w / radius * (1.0 + 1e-12))
    # the cone's generator, d position/d z: up to the angle beta/2 between normal and radius
    steps = w0 / cup * np.stack([-np.cos(theta), np.sin(theta)])
    lift = np.sum(steps * field.normal.T[:2], axis=0) + field.normal[:, 2]
    assert np.all(np.abs(lift) <= w0 / cup * (beta + 1e-13))


def test_beta_reaches_its_bound():
    """Close to theta = 45 degrees beta is 2w/r: 0.023 rad for the default drive."""
    field = footprint(DRIVE, 30.0)
    beta = np.arctan2(field.normal[:, 1], field.normal[:, 0])
    beta = beta - np.arctan2(field.position[:, 1], field.position[:, 0])
    bound = 2.0 * DRIVE.radial_deformation / DRIVE.radius
    assert bound == pytest.approx(0.024, abs=1.5e-3)  # docs/errata.md, with w between 0.195 and 0.21 mm
    assert 0.85 * bound < np.max(beta) < bound  # the lobe ends at 42 degrees and w tapers along z


def test_load_cases_are_independent():
    peaks = np.array([[3e7, 9e7], [1e8, 2e8]])
    together = two_lobes(peaks, np.array([5e7]), **ELLIPSE)
    alone = two_lobes(peaks[1, 0], np.array([5e7]), **ELLIPSE)
    for name in ("share", "position", "normal", "pressure"):
        case = getattr(together, name)[1, 0][together.share[1, 0] > 0.0]  # the others are pieces of no width
        np.testing.assert_array_equal(case, getattr(alone, name))
    assert together.mean_pressure.shape == (2, 2)


# Sums over nodes


def unit_vectors():
    part = st.floats(-1.0, 1.0)
    vector = st.tuples(part, part, part).map(np.array).filter(lambda v: np.linalg.norm(v) > 0.1)
    return vector.map(lambda v: v / np.linalg.norm(v))


@given(
    position=st.tuples(*[st.floats(-1.0, 1.0)] * 3),
    normal=unit_vectors(),
    axis=unit_vectors(),
    stiffness=st.tuples(st.floats(0.0, 1e9), st.floats(0.0, 1e9)),
)
def test_rotation_is_the_energy_of_a_unit_twist(position, normal, axis, stiffness):
    """d^T K d with the stiffness matrix K = K_N n n^T + K_T (1 - n n^T) of one node."""
    node = Footprint(np.array([0.25]), np.array([position]), normal[None, :], np.array([1.0]))
    K_N, K_T = stiffness
    outer = np.outer(normal, normal)
    matrix = K_N * outer + K_T * (np.eye(3) - outer)
    d = np.cross(axis, position)
    expected = 0.25 * d @ matrix @ d
    scale = (K_N + K_T) * (d @ d)
    found = node.rotation(np.array([K_N]), np.array([K_T]), axis)
    assert found == pytest.approx(expected, rel=0.0, abs=1e-14 * scale + 1e-300)  # round-off


def test_rotation_is_the_corrected_eq_45():
    """sum R_a^2 (K_N (cos a sin b)^2 + K_T (1 - (cos a sin b)^2)), alpha and beta from the normals."""
    field = footprint(DRIVE, 3.0)
    n, x = field.normal, field.position
    alpha = np.arcsin(n[:, 2])
    beta = np.arctan2(n[:, 1], n[:, 0]) - np.arctan2(x[:, 1], x[:, 0])
    R_a = np.hypot(x[:, 0], x[:, 1])
    K_N = np.linspace(1e8, 2e9, beta.size)
    K_T = K_N[::-1]
    part = (np.cos(alpha) * np.sin(beta)) ** 2
    expected = np.sum(field.share * R_a**2 * (K_N * part + K_T * (1.0 - part)))
    assert field.rotation(K_N, K_T, (0, 0, 1)) == pytest.approx(expected, rel=1e-13)  # round-off
    assert np.max(part) > 1e-5  # K_N does take part
    printed = np.sum(
        field.share * R_a * (K_N * np.sin(alpha) * np.cos(beta) + K_T * np.cos(alpha) * np.cos(beta))
    )
    assert field.rotation(K_N, K_T, (0, 0, 1)) < 0.05 * printed  # N, not N m/rad


def test_translation_and_mean():
    nodes = Footprint(np.array([0.25, 0.75]), np.zeros((2, 3)), np.ones((2, 3)), np.array([2.0, 4.0]))
    assert nodes.mean_pressure == 3.5
    assert nodes.translation(np.array([8.0, 4.0])) == 5.0


def test_calibrated_values_are_marked():
    """What the published pressures fixed says so in the parameter file."""
    kinds = default("bolted_joint").origins
    fitted = {name for name in flatten(JOINT) if kinds[name] == "calibration"}
    assert fitted == {"pattern.decay_length", "pattern.decay_exponent"}


@pytest.mark.parametrize("moment", [True, False])
def test_merged_nodes_keep_the_sums(moment):
    """Area, pressure and second moments of area in total, and node by node those that only mirrors share."""
    shape = pressure_shape(JOINT.pattern)
    merged = shape.merged(moment=moment)
    mirrors = 2 if moment else 4  # the frame's axes; a moment tells its two rows apart
    assert merged.share.size <= shape.share.size / mirrors + 4  # but for nodes on an axis
    x2, y2 = shape.position.T**2
    for found, expected in (
        (1.0, 1.0 + 0.0 * x2),
        (merged.equal, shape.equal),
        (merged.equal**2, shape.equal**2),
        (merged.x2, x2),
        (merged.y2 * merged.equal, y2 * shape.equal),
        (merged.tilt**2, moment * shape.tilt**2),
    ):
        # equal is rounded to ALIKE decimals where nodes are compared
        assert np.sum(merged.share * found) == pytest.approx(shape.share @ expected, rel=10.0**-ALIKE)
    assert np.max(merged.equal) == pytest.approx(np.max(shape.equal), rel=10.0**-ALIKE)
