"""Angles of the drive: signed ratio, kinematic error, lost motion, hysteresis; virtual work and energy."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from jointfmu.joints.harmonic_drive import hysteresis
from jointfmu.joints.harmonic_drive.hysteresis import HISTORY_LAYOUT, HYSTERESIS_SLIDER_COUNT
from jointfmu.joints.harmonic_drive.law import drive_stiffness
from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring
from jointfmu.parameters import load_default

ERROR = {"error_1": 4e-5, "error_1_phase": 0.7, "error_2": 2e-4, "error_2_phase": -0.4, "error_4": 5e-5}
ROUND_OFF = 1e-12
PLAY = 3e-4


def default_spring(**changes):
    return HarmonicDriveSpring.tabulate(replace(load_default("harmonic_drive").values, **changes))


def energy(law, phi1, phi2):
    """Energy [J] stored in the spring."""
    return float(law.curve.energy(abs(float(law.evaluate_motion(phi1, 0.0, phi2, 0.0)["phi_rel"]))))


# Ratio


def test_a_negative_ratio_is_the_motor_turned_round():
    plain, turned = default_spring(ratio=80.0, **ERROR), default_spring(ratio=-80.0)
    motion = np.array([0.03, 2.0, 7e-4, -0.01])
    other = turned.evaluate_motion(-motion[0], -motion[1], *motion[2:])
    same = default_spring(ratio=80.0).evaluate_motion(*motion)
    for name, sign in (("phi_rel", 1.0), ("tau", 1.0), ("tau2", 1.0), ("tau1", -1.0), ("K_WTS", 1.0)):
        assert float(other[name]) == pytest.approx(sign * float(same[name]), rel=ROUND_OFF)
    assert float(plain.evaluate_motion(*motion)["tau"]) != float(same["tau"])


def test_no_ratio_is_refused_in_one_line():
    with pytest.raises(
        ValueError, match=r"^ratio = 0 is outside .*: allowed are \(-inf, 0\) and \(0, inf\)$"
    ):
        default_spring(ratio=0.0)


# Kinematic error


@pytest.mark.parametrize("ratio", [100.0, -50.0])
def test_torques_are_those_of_virtual_work(ratio):
    law, rng = default_spring(ratio=ratio, **ERROR), np.random.default_rng(1)
    for phi1, wound in zip(rng.uniform(-20.0, 20.0, 20), rng.uniform(-1.5e-3, 1.5e-3, 20), strict=True):
        phi2 = phi1 / ratio + wound
        found = law.evaluate_motion(phi1, 0.0, phi2, 0.0)
        h, k = 1e-5, 1e-7
        tau1 = (energy(law, phi1 - h, phi2) - energy(law, phi1 + h, phi2)) / (2.0 * h)
        tau2 = (energy(law, phi1, phi2 - k) - energy(law, phi1, phi2 + k)) / (2.0 * k)
        # differences of second order: the third derivative of the energy, and round-off 1e-16/h
        assert float(found["tau1"]) == pytest.approx(tau1, rel=1e-5, abs=1e-8)
        assert float(found["tau2"]) == pytest.approx(tau2, rel=1e-5, abs=1e-5)


def test_damping_takes_power_from_both_flanges():
    """Power d der(phi_rel)^2 of the damper is the power of the flanges minus the power of the spring."""
    law = default_spring(d=2.0, **ERROR)
    motion = (3.0, 40.0, 0.0305, -0.3)
    still, moving = law.evaluate_motion(3.0, 0.0, 0.0305, 0.0), law.evaluate_motion(*motion)
    put_in = -sum(float(moving[f"tau{i}"] - still[f"tau{i}"]) * motion[2 * i - 1] for i in (1, 2))
    h = 1e-7
    ahead = law.evaluate_motion(3.0 + 40.0 * h, 0.0, 0.0305 - 0.3 * h, 0.0)
    rate = float(ahead["phi_rel"] - still["phi_rel"]) / h
    assert put_in == pytest.approx(2.0 * rate**2, rel=1e-5)


def ripple(law, inertia, speed, periods=60):
    """Amplitude [rad] of the output's ripple, two periods per motor turn, at a motor speed [rad/s]."""
    end = periods * np.pi / speed

    def rate(t, y):
        found = law.evaluate_motion(speed * t, speed, *y)
        return [y[1], float(found["tau2"]) / inertia]

    times = np.linspace(0.75 * end, end, 1500, endpoint=False)  # whole periods
    start = [0.0, speed / law.joint.ratio]
    y = solve_ivp(rate, (0.0, end), start, "DOP853", times, rtol=1e-8, atol=1e-11).y[0]
    beside = y - speed * times / law.joint.ratio
    return 2.0 * abs(np.mean((beside - beside.mean()) * np.exp(-2j * speed * times)))


@pytest.mark.slow  # some simulations
def test_velocity_ripple_resonates_at_half_the_natural_frequency():
    """The amplitude agrees with the closed form of an oscillator whose rest position oscillates."""
    inertia, amplitude, damping = 0.05, 1e-6, 1.5
    law = default_spring(error_2=amplitude, d=damping)
    natural = float(np.sqrt(law.curve.stiffness[0] / inertia))
    zeta = damping / (2.0 * inertia * natural)
    parts = np.array([0.48, 0.5, 0.7])
    found = np.array([ripple(law, inertia, part * natural) for part in parts])
    r = 2.0 * parts
    top, bottom = 1.0 + (2.0 * zeta * r) ** 2, (1.0 - r**2) ** 2 + (2.0 * zeta * r) ** 2
    # the stiffness grows by 0.1 % within the ripple, and the start dies out to exp(-60 pi zeta 0.75/0.7)
    assert found == pytest.approx(amplitude * np.sqrt(top / bottom), rel=0.02)
    assert parts[np.argmax(found)] == 0.5
    assert found.max() > 5.0 * amplitude


# Lost motion


def test_lost_motion_is_what_the_catalogue_measures_beside_the_wind_up():
    """The angle between +4 % and -4 % of rated torque increases by it."""
    stiff, loose = default_spring(), default_spring(lost_motion=PLAY)
    torque = 0.04 * stiff.joint.rated_torque
    wound = [law.evaluate_torque([torque, -torque])["phi_rel"] for law in (stiff, loose)]
    before, after = (float(angle[0] - angle[1]) for angle in wound)
    assert after - before == pytest.approx(PLAY, rel=1e-3)  # as `WIDTH` says
    beyond = [float(law.evaluate_torque(4.0)["phi_rel"]) for law in (stiff, loose)]
    assert beyond[1] - beyond[0] == pytest.approx(0.5 * PLAY, rel=1e-6)  # half, to six digits of the table


def test_the_stiffness_with_play_is_the_slope_of_the_torque_and_has_no_jump():
    law = default_spring(lost_motion=PLAY)
    phi, h = np.linspace(-6e-4, 6e-4, 241), 1e-9
    found = law.evaluate_motion(0.0, 0.0, phi, 0.0)
    slope = (
        law.evaluate_motion(0.0, 0.0, phi + h, 0.0)["tau"]
        - law.evaluate_motion(0.0, 0.0, phi - h, 0.0)["tau"]
    ) / (2.0 * h)
    assert found["K_WTS"] == pytest.approx(slope, rel=1e-5)  # round-off 1e-16/h over 20 N.m/rad
    assert 1.0 / found["K_WTS"] == pytest.approx(1.0 / found["K_FTS"] + 1.0 / found["K_TS"], rel=1e-9)
    play, pair = 0.01 * 5.0 / (0.5 * PLAY), float(default_spring().curve.stiffness[0])
    assert float(law.curve.stiffness[0]) == pytest.approx(1.0 / (1.0 / play + 1.0 / pair), rel=ROUND_OFF)
    fine = law.evaluate_motion(0.0, 0.0, np.linspace(-6e-4, 6e-4, 20001), 0.0)["K_WTS"]
    # a step of 6e-8 rad; the stiffness rises by 3e3 N.m/rad within some 3e-5 rad
    assert np.max(np.abs(np.diff(fine))) < 20.0


def test_a_loop_with_lost_motion_opens_as_stated_and_closes_in_energy():
    law = default_spring(lost_motion=PLAY, hysteresis_loss=2e-4, error_2=1e-4)
    memory, angle = law.initial_history(), []
    for tau in (5.0, 0.0, -5.0, 0.0):
        out, memory = law.advance_torque(tau, memory)
        angle.append(float(out["phi_rel"]))
    assert angle[1] - angle[3] == pytest.approx(2e-4, rel=1e-9)
    memory, work, before = law.initial_history(), 0.0, None
    for phi1, phi2 in zip(
        np.linspace(0.0, 9.0, 4001), 1e-3 * np.sin(np.linspace(0.0, 9.0, 4001)), strict=True
    ):
        out, memory = law.advance_motion((phi1, 0.0, phi1 / 100.0 + phi2, 0.0), memory)
        now = (phi1, phi1 / 100.0 + phi2, float(out["tau1"]), float(out["tau2"]))
        if before:
            work -= sum(0.5 * (now[i + 2] + before[i + 2]) * (now[i] - before[i]) for i in (0, 1))
        before = now
    springs = memory[: law.hysteresis.friction_limit.size] ** 2 / (2.0 * law.hysteresis.stiffness)
    stored = float(law.curve.energy(abs(float(out["phi_rel"])))) + float(np.sum(springs))
    assert work == pytest.approx(stored + float(out["E_loss"]), rel=1e-5)  # trapezia of 4000 steps


# Hysteresis: its loop, its sliders, its energy


ARCMIN = np.pi / 180.0 / 60.0
EXPONENTS = (1.0 / 3.0, 0.6, 0.9, 1.0)


def drive(law=None, **changes):
    return replace(load_default("harmonic_drive", law).values, **changes)


def spring(law=None, loss=ARCMIN, **changes):
    return HarmonicDriveSpring.tabulate(drive(law, hysteresis_loss=loss, **changes))


def along(law, path, memory=None):
    """Torque, loss and history along a path of wind-ups [rad]."""
    memory, torque, loss = law.initial_history() if memory is None else memory, [], []
    for phi in path:
        out, memory = law.advance_motion((0.0, 0.0, phi, 0.0), memory)
        torque.append(float(out["tau"]))
        loss.append(float(out["E_loss"]))
    return np.array(torque), np.array(loss), memory


def stored(law, memory):
    """Energy [J] stored in the midline and in the sliders."""
    springs = memory[:HYSTERESIS_SLIDER_COUNT] ** 2 / (2.0 * law.hysteresis.stiffness)
    return float(law.curve.energy(abs(memory[HYSTERESIS_SLIDER_COUNT]))) + float(np.sum(springs))


# The friction of the theorem


def test_exponent_is_that_of_the_pairs_law():
    """The exponent m of K_N ~ P^m is 1 for Hu 2023 as printed; for `roughness` it is below 1 (few spots)."""
    assert float(hysteresis.stiffness_exponent(drive())) == pytest.approx(1.0, abs=1e-12)
    rough = drive("roughness")
    assert 1.0 / (1.0 + rough.hurst) < hysteresis.stiffness_exponent(rough) < 1.0


def friction_left(m, travel):
    """Remaining friction s [1] of the theorem after a displacement K_h phi/M_f [1] from rest."""
    left = 1.0 - (1.0 - m) * np.asarray(travel)
    return np.exp(-np.asarray(travel)) if m == 1.0 else np.maximum(left, 0.0) ** (1.0 / (1.0 - m))


def shared(m):
    return (np.array(share) for share in hysteresis.slider_shares(m))


@pytest.mark.parametrize("m", EXPONENTS)
def test_sliders_follow_the_theorem_from_rest(m):
    springs, friction = shared(m)
    assert (springs.sum(), friction.sum()) == pytest.approx((1.0, 1.0), rel=1e-15 * springs.size)
    assert np.all(np.diff(friction / springs) > 0.0)  # in the order in which they slip
    travel = np.linspace(0.0, 8.0, 5000)
    torque = np.minimum(np.outer(travel, springs), friction).sum(axis=1)
    assert np.max(np.abs(torque - (1.0 - friction_left(m, travel)))) < 2e-3  # of M_f, as SLIDERS says


@pytest.mark.parametrize("m", EXPONENTS)
def test_loops_have_the_area_of_masings_rule(m):
    """Loop areas are 8 (I - B a/2), I the integral of the first loading B up to the amplitude a.

    Checked from a tenth of M_f on.
    """
    springs, friction = shared(m)
    place = friction / springs
    most = 8.0 if m == 1.0 else 1.0 / (1.0 - m)
    for used in (0.1, 0.11, 0.12, 0.14, 0.17, 0.2, 0.3, 0.5, 0.8, 0.95):
        left = 1.0 - used
        travel = -np.log(left) if m == 1.0 else (1.0 - left ** (1.0 - m)) / (1.0 - m)
        assert travel < most
        below = quad(lambda x, m=m: 1.0 - float(friction_left(m, x)), 0.0, travel, epsabs=1e-14)[0]
        exact = 8.0 * (below - 0.5 * used * travel)
        found = np.sum(4.0 * friction * np.maximum(travel - place, 0.0))
        assert found == pytest.approx(exact, rel=1e-2)


def test_first_friction_is_the_extra_stiffness():
    law = spring(hysteresis_stiffness=7e3)
    tiny = 1e-9
    torque, _, _ = along(law, [tiny])
    midline = float(law.curve.derivatives(tiny)[0])
    assert torque[0] - midline == pytest.approx(7e3 * tiny, rel=1e-9)


# The loop of a catalogue


@pytest.mark.parametrize("law", [None, "roughness"])
@pytest.mark.parametrize(("loss", "stiffness"), [(0.25, 0.0), (1.0, 0.0), (2.0, 0.0), (3.0, 0.0), (1.0, 2e4)])
def test_branches_at_zero_torque_are_apart_as_stated(law, loss, stiffness):
    """After rated torque in both directions, in steps, the branches at zero torque are hysteresis_loss apart;
    allowed 1 %, measured round-off."""
    found = spring(law, loss * ARCMIN, hysteresis_stiffness=stiffness)
    memory, place = HISTORY_LAYOUT.virgin_history(), []
    for start, end in pairwise((0.0, 1.0, 0.0, -1.0, 0.0, 1.0, 0.0)):
        for tau in found.joint.rated_torque * np.linspace(start, end, 12):
            out, memory = found.advance_torque(tau, memory)
        place.append(float(out["phi_rel"]))
    assert place[1] - place[3] == pytest.approx(loss * ARCMIN, rel=1e-9)
    assert place[5] == pytest.approx(place[1], rel=1e-9)


def test_fully_slipped_friction_carries_the_midline_at_half_of_the_loss():
    """The stiffness is so large that all sliders have reversed before the torque is zero."""
    found = spring(hysteresis_stiffness=1e5)
    midline = float(found.curve.derivatives(0.5 * ARCMIN)[0])
    assert np.sum(found.hysteresis.friction_limit) == pytest.approx(midline, rel=1e-12)
    assert np.sum(spring().hysteresis.friction_limit) == pytest.approx(
        0.31, abs=0.005
    )  # as docs/models.md prints it


def test_without_a_stated_stiffness_it_is_that_of_the_midline_or_as_needed():
    K = float(drive_stiffness(drive(), 0.0)[0])
    small, large = (np.sum(spring(loss=x * ARCMIN).hysteresis.stiffness) for x in (0.1, 2.0))
    assert small == pytest.approx(K, rel=1e-12)
    assert large > 3.0 * K


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"hysteresis_loss": 5e-3}, "hysteresis_loss = 0.005 rad is outside [0, 0.00"),
        ({"hysteresis_loss": 1e300}, "hysteresis_loss = 1e+300 rad is outside [0, 0.00"),
        (
            {"hysteresis_loss": 3e-4, "hysteresis_stiffness": 100.0},
            "hysteresis_stiffness = 100 N.m/rad is too",
        ),
        ({"hysteresis_loss": -1e-4}, "hysteresis_loss = -0.0001 rad is outside [0, inf)"),
    ],
)
def test_what_cannot_be_is_refused(changes, words):
    with pytest.raises(ValueError) as refusal:  # noqa: PT011 the words follow
        HarmonicDriveSpring.tabulate(drive(**changes))
    assert words in str(refusal.value)
    assert "\n" not in str(refusal.value)


# Paths


def test_without_hysteresis_it_is_the_spring_of_the_midline():
    law, phi = spring(loss=0.0), np.linspace(-3e-3, 3e-3, 41)
    load, stiffness = law.curve.derivatives(np.abs(phi), 1)
    found = law.evaluate_motion(0.0, 0.0, phi, 0.0)
    assert np.array_equal(found["tau"], np.copysign(load, phi))
    assert np.array_equal(found["K_WTS"], stiffness)
    torque, loss, memory = along(law, phi)
    assert np.array_equal(torque, found["tau"])
    assert not np.any(loss)
    assert not np.any(memory[:HYSTERESIS_SLIDER_COUNT])
    tau = np.linspace(-25.0, 25.0, 41)
    assert np.array_equal(
        law.evaluate_torque(tau)["phi_rel"], np.copysign(law.curve.inverse(np.abs(tau)), tau)
    )


def test_masings_rule_and_memory_wiped_out_by_the_larger_loop():
    law = spring()
    a, b = 8e-4, 3e-4
    fine = np.linspace(0.0, 1.0, 30)
    first, _, turned = along(law, a * fine)
    down, _, _ = along(law, a - 2.0 * a * fine, turned)
    midline = np.copysign(law.curve.derivatives(np.abs(a - 2.0 * a * fine))[0], a - 2.0 * a * fine)
    friction = first - law.curve.derivatives(a * fine)[0]
    assert down - midline == pytest.approx(friction[-1] - 2.0 * friction, abs=ROUND_OFF)
    # a minor loop closes, and the larger one goes on as if it had not been
    plain, _, _ = along(law, [-a], along(law, [b], turned)[2])
    there, _, minor = along(law, [b, b + 2e-4, b], turned)
    assert there[0] == pytest.approx(there[2], abs=ROUND_OFF)
    after, _, memory = along(law, [-a], minor)
    assert after == pytest.approx(plain, abs=ROUND_OFF)
    untouched = along(law, [-a], turned)[2]
    assert memory[:HYSTERESIS_SLIDER_COUNT] == pytest.approx(
        untouched[:HYSTERESIS_SLIDER_COUNT], abs=ROUND_OFF
    )


def test_ten_times_larger_steps_agree():
    law = spring()
    corners = np.array([0.0, 7e-4, -2e-4, 5e-4, -9e-4, 0.0])
    coarse = np.concatenate([np.linspace(p, q, 5)[1:] for p, q in pairwise(corners)])
    fine = np.concatenate([np.linspace(p, q, 41)[1:] for p, q in pairwise(corners)])
    large, small = along(law, coarse), along(law, fine)
    assert small[0][9::10] == pytest.approx(large[0], abs=ROUND_OFF)
    assert small[1][9::10] == pytest.approx(large[1], rel=1e-11)


def test_work_is_stored_or_lost_along_random_paths():
    """Work of a step: change of the midline's energy, and trapezoidal rule between the points where sliders
    start to slip."""
    law, rng = spring(), np.random.default_rng(3)
    memory, work, previous = law.initial_history(), 0.0, 0.0
    for end in np.cumsum(rng.normal(0.0, 4e-4, 400)):
        start = memory[HYSTERESIS_SLIDER_COUNT]
        k, limit, way = law.hysteresis.stiffness, law.hysteresis.friction_limit, end - start
        slips = start + (np.copysign(limit, way) - memory[:HYSTERESIS_SLIDER_COUNT]) / k
        inside = slips[(slips - start) * (slips - end) < 0.0]
        corners = np.sort(np.array([start, *inside, end]))[:: 1 if way > 0.0 else -1]
        friction = law.hysteresis.advance(memory[: HYSTERESIS_SLIDER_COUNT + 2], corners).traction
        work += float(np.sum(0.5 * (friction[1:] + friction[:-1]) * np.diff(corners)))
        work += float(law.curve.energy(abs(end)) - law.curve.energy(abs(start)))
        out, memory = law.advance_motion((0.0, 0.0, end, 0.0), memory)
        assert float(out["E_loss"]) >= previous
        previous = float(out["E_loss"])
        assert work == pytest.approx(stored(law, memory) + previous, rel=1e-9, abs=1e-12)
    assert previous > 0.01


def test_compliance_is_the_inverse_of_the_spring():
    law, rng = spring("roughness"), np.random.default_rng(5)
    memory = other = law.initial_history()
    for tau in rng.normal(0.0, 4.0, 200):
        wound, memory = law.advance_torque(tau, memory)
        turned, other = law.advance_motion((0.0, 0.0, wound["phi_rel"], 0.0), other)
        assert turned["tau"] == pytest.approx(tau, rel=ROUND_OFF, abs=ROUND_OFF)
        assert (turned["K_WTS"], turned["E_loss"]) == (wound["K_WTS"], wound["E_loss"])
        assert np.array_equal(memory, other)


def test_memory_given_stays_as_it_is():
    law = spring()
    memory = along(law, [3e-4])[2]
    before = memory.copy()
    law.advance_motion((0.0, 0.0, -5e-4, 0.0), memory)
    law.advance_torque(-1.0, memory)
    assert np.array_equal(memory, before)
