"""The hysteresis of the harmonic drive: its loop, its sliders, its energy."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

from jointfmu.joints.harmonic_drive import hysteresis
from jointfmu.joints.harmonic_drive.hysteresis import MEMORY, SLIDERS
from jointfmu.joints.harmonic_drive.law import drive_stiffness
from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring
from jointfmu.parameters import default

ARCMIN = np.pi / 180.0 / 60.0
ROUND_OFF = 1e-12
"""Sums of 44 sliders over some hundred steps."""
EXPONENTS = (1.0 / 3.0, 0.6, 0.9, 1.0)


def drive(law=None, **changes):
    return replace(default("harmonic_drive", law).values, **changes)


def spring(law=None, loss=ARCMIN, **changes):
    return HarmonicDriveSpring.of(drive(law, hysteresis_loss=loss, **changes))


def along(law, path, memory=None):
    """Torque, loss and memory along a path of wind-ups [rad]."""
    memory, torque, loss = law.rest() if memory is None else memory, [], []
    for phi in path:
        out, memory = law.driven((0.0, 0.0, phi, 0.0), memory)
        torque.append(float(out["tau"]))
        loss.append(float(out["E_loss"]))
    return np.array(torque), np.array(loss), memory


def stored(law, memory):
    """Energy [J] of the midline and of the sliders."""
    springs = memory[:SLIDERS] ** 2 / (2.0 * law.hysteresis.stiffness)
    return float(law.curve.energy(abs(memory[SLIDERS]))) + float(np.sum(springs))


# The friction of the theorem


def test_exponent_is_that_of_the_pairs_law():
    """K_N in proportion to P as Hu 2023 is printed; between few spots and many ones with a roughness."""
    assert float(hysteresis.exponent(drive())) == pytest.approx(1.0, abs=1e-12)
    rough = drive("roughness")
    assert 1.0 / (1.0 + rough.hurst) < hysteresis.exponent(rough) < 1.0


def friction_left(m, travel):
    """s [1] of the theorem after a travel K_h phi/M_f [1] from rest."""
    left = 1.0 - (1.0 - m) * np.asarray(travel)
    return np.exp(-np.asarray(travel)) if m == 1.0 else np.maximum(left, 0.0) ** (1.0 / (1.0 - m))


def shared(m):
    return (np.array(share) for share in hysteresis.shares(m))


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
    """8 (integral of the curve from rest, less half of its last triangle), from a tenth of M_f on."""
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
    """After rated torque one way and the other, step by step; 1 % is asked for, found is round-off."""
    found = spring(law, loss * ARCMIN, hysteresis_stiffness=stiffness)
    memory, place = MEMORY.rest(), []
    for start, end in pairwise((0.0, 1.0, 0.0, -1.0, 0.0, 1.0, 0.0)):
        for tau in found.joint.rated_torque * np.linspace(start, end, 12):
            out, memory = found.loaded(tau, memory)
        place.append(float(out["phi_rel"]))
    assert place[1] - place[3] == pytest.approx(loss * ARCMIN, rel=1e-9)
    assert place[5] == pytest.approx(place[1], rel=1e-9)


def test_fully_slipped_friction_carries_the_midline_at_half_of_the_loss():
    """With an extra stiffness so large that all sliders have turned round before the torque is zero."""
    found = spring(hysteresis_stiffness=1e5)
    midline = float(found.curve.derivatives(0.5 * ARCMIN)[0])
    assert np.sum(found.hysteresis.limit) == pytest.approx(midline, rel=1e-12)
    assert np.sum(spring().hysteresis.limit) == pytest.approx(0.31, abs=0.005)  # as docs/models.md prints it


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
        HarmonicDriveSpring.of(drive(**changes))
    assert words in str(refusal.value)
    assert "\n" not in str(refusal.value)


# Paths


def test_without_hysteresis_it_is_the_spring_of_the_midline():
    law, phi = spring(loss=0.0), np.linspace(-3e-3, 3e-3, 41)
    load, stiffness = law.curve.derivatives(np.abs(phi), 1)
    found = law.motion(0.0, 0.0, phi, 0.0)
    assert np.array_equal(found["tau"], np.copysign(load, phi))
    assert np.array_equal(found["K_WTS"], stiffness)
    torque, loss, memory = along(law, phi)
    assert np.array_equal(torque, found["tau"])
    assert not np.any(loss)
    assert not np.any(memory[:SLIDERS])
    tau = np.linspace(-25.0, 25.0, 41)
    assert np.array_equal(law.windup(tau)["phi_rel"], np.copysign(law.curve.inverse(np.abs(tau)), tau))


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
    assert memory[:SLIDERS] == pytest.approx(untouched[:SLIDERS], abs=ROUND_OFF)


def test_ten_times_larger_steps_agree():
    law = spring()
    corners = np.array([0.0, 7e-4, -2e-4, 5e-4, -9e-4, 0.0])
    coarse = np.concatenate([np.linspace(p, q, 5)[1:] for p, q in pairwise(corners)])
    fine = np.concatenate([np.linspace(p, q, 41)[1:] for p, q in pairwise(corners)])
    large, small = along(law, coarse), along(law, fine)
    assert small[0][9::10] == pytest.approx(large[0], abs=ROUND_OFF)
    assert small[1][9::10] == pytest.approx(large[1], rel=1e-11)


def test_work_is_stored_or_lost_along_random_paths():
    """Work of a step: the midline's energy, and trapezia between places where a slider begins to slip."""
    law, rng = spring(), np.random.default_rng(3)
    memory, work, previous = law.rest(), 0.0, 0.0
    for end in np.cumsum(rng.normal(0.0, 4e-4, 400)):
        start = memory[SLIDERS]
        k, limit, way = law.hysteresis.stiffness, law.hysteresis.limit, end - start
        slips = start + (np.copysign(limit, way) - memory[:SLIDERS]) / k
        inside = slips[(slips - start) * (slips - end) < 0.0]
        corners = np.sort(np.array([start, *inside, end]))[:: 1 if way > 0.0 else -1]
        friction = law.hysteresis.moved(memory[: SLIDERS + 2], corners).traction
        work += float(np.sum(0.5 * (friction[1:] + friction[:-1]) * np.diff(corners)))
        work += float(law.curve.energy(abs(end)) - law.curve.energy(abs(start)))
        out, memory = law.driven((0.0, 0.0, end, 0.0), memory)
        assert float(out["E_loss"]) >= previous
        previous = float(out["E_loss"])
        assert work == pytest.approx(stored(law, memory) + previous, rel=1e-9, abs=1e-12)
    assert previous > 0.01


def test_compliance_is_the_inverse_of_the_spring():
    law, rng = spring("roughness"), np.random.default_rng(5)
    memory = other = law.rest()
    for tau in rng.normal(0.0, 4.0, 200):
        wound, memory = law.loaded(tau, memory)
        turned, other = law.driven((0.0, 0.0, wound["phi_rel"], 0.0), other)
        assert turned["tau"] == pytest.approx(tau, rel=ROUND_OFF, abs=ROUND_OFF)
        assert (turned["K_WTS"], turned["E_loss"]) == (wound["K_WTS"], wound["E_loss"])
        assert np.array_equal(memory, other)


def test_memory_given_stays_as_it_is():
    law = spring()
    memory = along(law, [3e-4])[2]
    before = memory.copy()
    law.driven((0.0, 0.0, -5e-4, 0.0), memory)
    law.loaded(-1.0, memory)
    assert np.array_equal(memory, before)
