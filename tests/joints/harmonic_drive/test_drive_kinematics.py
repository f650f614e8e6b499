"""Signed ratio, kinematic error and lost motion of the harmonic drive: virtual work, ripple, catalogue."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring
from jointfmu.parameters import default

ERROR = {"error_1": 4e-5, "error_1_phase": 0.7, "error_2": 2e-4, "error_2_phase": -0.4, "error_4": 5e-5}
ROUND_OFF = 1e-12
PLAY = 3e-4


def spring(**changes):
    return HarmonicDriveSpring.of(replace(default("harmonic_drive").values, **changes))


def energy(law, phi1, phi2):
    """Stored in the spring [J]."""
    return float(law.curve.energy(abs(float(law.motion(phi1, 0.0, phi2, 0.0)["phi_rel"]))))


# Ratio


def test_a_negative_ratio_is_the_motor_turned_round():
    plain, turned = spring(ratio=80.0, **ERROR), spring(ratio=-80.0)
    motion = np.array([0.03, 2.0, 7e-4, -0.01])
    other = turned.motion(-motion[0], -motion[1], *motion[2:])
    same = spring(ratio=80.0).motion(*motion)
    for name, sign in (("phi_rel", 1.0), ("tau", 1.0), ("tau2", 1.0), ("tau1", -1.0), ("K_WTS", 1.0)):
        assert float(other[name]) == pytest.approx(sign * float(same[name]), rel=ROUND_OFF)
    assert float(plain.motion(*motion)["tau"]) != float(same["tau"])


def test_no_ratio_is_refused_in_one_line():
    with pytest.raises(
        ValueError, match=r"^ratio = 0 is outside .*: allowed are \(-inf, 0\) and \(0, inf\)$"
    ):
        spring(ratio=0.0)


# Kinematic error


@pytest.mark.parametrize("ratio", [100.0, -50.0])
def test_torques_are_those_of_virtual_work(ratio):
    law, rng = spring(ratio=ratio, **ERROR), np.random.default_rng(1)
    for phi1, wound in zip(rng.uniform(-20.0, 20.0, 20), rng.uniform(-1.5e-3, 1.5e-3, 20), strict=True):
        phi2 = phi1 / ratio + wound
        found = law.motion(phi1, 0.0, phi2, 0.0)
        h, k = 1e-5, 1e-7
        tau1 = (energy(law, phi1 - h, phi2) - energy(law, phi1 + h, phi2)) / (2.0 * h)
        tau2 = (energy(law, phi1, phi2 - k) - energy(law, phi1, phi2 + k)) / (2.0 * k)
        # differences of second order: the third derivative of the energy, and round-off 1e-16/h
        assert float(found["tau1"]) == pytest.approx(tau1, rel=1e-5, abs=1e-8)
        assert float(found["tau2"]) == pytest.approx(tau2, rel=1e-5, abs=1e-5)


def test_damping_takes_power_from_both_flanges():
    """What the damper takes, d der(phi_rel)^2, is what the flanges put in beside the spring."""
    law = spring(d=2.0, **ERROR)
    motion = (3.0, 40.0, 0.0305, -0.3)
    still, moving = law.motion(3.0, 0.0, 0.0305, 0.0), law.motion(*motion)
    put_in = -sum(float(moving[f"tau{i}"] - still[f"tau{i}"]) * motion[2 * i - 1] for i in (1, 2))
    h = 1e-7
    ahead = law.motion(3.0 + 40.0 * h, 0.0, 0.0305 - 0.3 * h, 0.0)
    rate = float(ahead["phi_rel"] - still["phi_rel"]) / h
    assert put_in == pytest.approx(2.0 * rate**2, rel=1e-5)


def ripple(law, inertia, speed, periods=60):
    """Amplitude [rad] of the output's ripple [rad], twice per turn, at a speed [rad/s] of the motor."""
    end = periods * np.pi / speed

    def rate(t, y):
        found = law.motion(speed * t, speed, *y)
        return [y[1], float(found["tau2"]) / inertia]

    times = np.linspace(0.75 * end, end, 1500, endpoint=False)  # whole periods
    start = [0.0, speed / law.joint.ratio]
    y = solve_ivp(rate, (0.0, end), start, t_eval=times, rtol=1e-8, atol=1e-11).y[0]
    beside = y - speed * times / law.joint.ratio
    return 2.0 * abs(np.mean((beside - beside.mean()) * np.exp(-2j * speed * times)))


@pytest.mark.slow  # some simulations
def test_velocity_ripple_resonates_at_half_the_natural_frequency():
    """Against the closed form of an oscillator whose rest position oscillates."""
    inertia, amplitude, damping = 0.05, 1e-6, 1.5
    law = spring(error_2=amplitude, d=damping)
    natural = float(np.sqrt(law.curve.stiffness[0] / inertia))
    zeta = damping / (2.0 * inertia * natural)
    parts = np.array([0.2, 0.4, 0.48, 0.5, 0.52, 0.7])
    found = np.array([ripple(law, inertia, part * natural) for part in parts])
    r = 2.0 * parts
    top, bottom = 1.0 + (2.0 * zeta * r) ** 2, (1.0 - r**2) ** 2 + (2.0 * zeta * r) ** 2
    # the stiffness grows by 0.1 % within the ripple, and the start dies out to exp(-60 pi zeta 0.75/0.2)
    assert found == pytest.approx(amplitude * np.sqrt(top / bottom), rel=0.02)
    assert parts[np.argmax(found)] == 0.5
    assert found.max() > 5.0 * amplitude


# Lost motion


def test_lost_motion_is_what_the_catalogue_measures_beside_the_wind_up():
    """The angle between +4 % and -4 % of rated torque grows by it."""
    stiff, loose = spring(), spring(lost_motion=PLAY)
    torque = 0.04 * stiff.joint.rated_torque
    wound = [law.windup([torque, -torque])["phi_rel"] for law in (stiff, loose)]
    before, after = (float(angle[0] - angle[1]) for angle in wound)
    assert after - before == pytest.approx(PLAY, rel=1e-3)  # as `lost_motion.WIDTH` says
    beyond = [float(law.windup(4.0)["phi_rel"]) for law in (stiff, loose)]
    assert beyond[1] - beyond[0] == pytest.approx(0.5 * PLAY, rel=1e-6)  # half, to six digits of the table


def test_the_stiffness_with_play_is_the_slope_of_the_torque_and_has_no_jump():
    law = spring(lost_motion=PLAY)
    phi, h = np.linspace(-6e-4, 6e-4, 241), 1e-9
    found = law.motion(0.0, 0.0, phi, 0.0)
    slope = (law.motion(0.0, 0.0, phi + h, 0.0)["tau"] - law.motion(0.0, 0.0, phi - h, 0.0)["tau"]) / (
        2.0 * h
    )
    assert found["K_WTS"] == pytest.approx(slope, rel=1e-5)  # round-off 1e-16/h over 20 N.m/rad
    assert 1.0 / found["K_WTS"] == pytest.approx(1.0 / found["K_FTS"] + 1.0 / found["K_TS"], rel=1e-9)
    play, pair = 0.01 * 5.0 / (0.5 * PLAY), float(spring().curve.stiffness[0])
    assert float(law.curve.stiffness[0]) == pytest.approx(1.0 / (1.0 / play + 1.0 / pair), rel=ROUND_OFF)
    fine = law.motion(0.0, 0.0, np.linspace(-6e-4, 6e-4, 20001), 0.0)["K_WTS"]
    # a step of 6e-8 rad; the stiffness rises by 3e3 N.m/rad within some 3e-5 rad
    assert np.max(np.abs(np.diff(fine))) < 20.0


def test_a_loop_with_lost_motion_opens_as_stated_and_closes_in_energy():
    law = spring(lost_motion=PLAY, hysteresis_loss=2e-4, error_2=1e-4)
    memory, angle = law.rest(), []
    for tau in (5.0, 0.0, -5.0, 0.0):
        out, memory = law.loaded(tau, memory)
        angle.append(float(out["phi_rel"]))
    assert angle[1] - angle[3] == pytest.approx(2e-4, rel=1e-9)
    memory, work, before = law.rest(), 0.0, None
    for phi1, phi2 in zip(
        np.linspace(0.0, 9.0, 4001), 1e-3 * np.sin(np.linspace(0.0, 9.0, 4001)), strict=True
    ):
        out, memory = law.driven((phi1, 0.0, phi1 / 100.0 + phi2, 0.0), memory)
        now = (phi1, phi1 / 100.0 + phi2, float(out["tau1"]), float(out["tau2"]))
        if before:
            work -= sum(0.5 * (now[i + 2] + before[i + 2]) * (now[i] - before[i]) for i in (0, 1))
        before = now
    springs = memory[: law.hysteresis.limit.size] ** 2 / (2.0 * law.hysteresis.stiffness)
    stored = float(law.curve.energy(abs(float(out["phi_rel"])))) + float(np.sum(springs))
    assert work == pytest.approx(stored + float(out["E_loss"]), rel=1e-5)  # trapezia of 4000 steps
