"""Friction at the wave generator: torque, energy, holding at rest, temperature."""

import csv
import math
from dataclasses import replace
from importlib.resources import files

import numpy as np
import pytest
from conftest import Fmu
from natives import close

from jointfmu.joints.harmonic_drive.friction import (
    HISTORY_LAYOUT,
    REFERENCE_TEMPERATURE,
    SLIDER_STIFFNESS_SHARES,
    FrictionSliders,
    friction_limits,
    viscous_torque,
)
from jointfmu.joints.harmonic_drive.spring import HISTORY_LAYOUT as STATES
from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring
from jointfmu.parameters import load_default

DRY = {"friction_coulomb": 0.03, "friction_stribeck": 0.02, "load_loss": 0.15}
PRESLIDING = 0.01
"""Presliding angle [rad], the default."""
ROUND_OFF = 1e-12


def spring(**changes):
    return HarmonicDriveSpring.tabulate(replace(load_default("harmonic_drive").values, **changes))


def started(law, *motion):
    """History of a drive after its initial inputs."""
    return law.advance_motion(motion, law.initial_history())[1]


def turning(law, speed, tau=0.0):
    """Friction torque [N.m] of a drive at steady speed, with a torque at the output [N.m]."""
    wound = float(law.evaluate_torque(tau)["phi_rel"])
    memory, ratio = started(law, 0.0, speed, wound, speed / law.joint.ratio), law.joint.ratio
    phi1 = np.copysign(20.0 * PRESLIDING, speed)
    out, _ = law.advance_motion((phi1, speed, phi1 / ratio + wound, speed / ratio), memory)
    assert float(out["tau"]) == pytest.approx(tau, abs=1e-9)
    return float(out["tau_friction"])


# Torque


def test_friction_builds_up_as_that_of_dahl():
    law, phi1 = spring(friction_coulomb=0.05), np.linspace(0.0, 6.0 * PRESLIDING, 101)
    found = law.advance_motion((phi1, 0.0, phi1 / 100.0, 0.0), started(law, 0.0, 0.0, 0.0, 0.0))[0][
        "tau_friction"
    ]
    dahl = 0.05 * (1.0 - np.exp(-phi1 / PRESLIDING))
    assert np.max(np.abs(found - dahl)) < 0.01 * 0.05  # as `FRICTION_SLIDER_COUNT` says
    assert found[-1] == pytest.approx(0.05, rel=ROUND_OFF)


@pytest.mark.parametrize("speed", [-200.0, -0.5, 3.0, 150.0])
@pytest.mark.parametrize("tau", [-4.0, 0.0, 5.0])
@pytest.mark.parametrize("ratio", [100.0, -50.0])
def test_steady_friction_is_that_of_speed_and_load(speed, tau, ratio):
    law = spring(**DRY, friction_viscous=1e-4, stribeck_speed=2.0, temperature_factor=1.3, ratio=ratio)
    dry = 0.03 + 0.02 * np.exp(-((speed / 2.0) ** 2)) + 0.15 * abs(tau / ratio)
    # |tau| is smooth through zero: tanh(4/0.05) is 1
    assert turning(law, speed, tau) == pytest.approx(1.3 * (np.sign(speed) * dry + 1e-4 * speed), rel=1e-9)


RIPPLE = {"friction_1": 0.012, "friction_1_phase": 0.4, "friction_2": 0.008, "friction_2_phase": -1.0}


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_friction_over_the_turn_of_the_wave_generator(sense):
    """In slow motion over two turns the friction is the limit at each angle; its mean is that
    without ripple."""
    law = spring(**DRY, **RIPPLE, presliding=1e-4)
    angles = sense * np.linspace(0.0, 4.0 * np.pi, 1_001)
    memory, found = law.initial_history(), []
    for phi1 in angles:
        out, memory = law.advance_motion((phi1, sense * 1e-3, phi1 / 100.0, sense * 1e-5), memory)
        found.append(float(out["tau_friction"]))
    ripple = 0.012 * np.sin(angles + 0.4) + 0.008 * np.sin(2.0 * angles - 1.0)
    np.testing.assert_allclose(found[10:], sense * (0.05 + ripple)[10:], rtol=1e-4)
    assert np.mean(found[501:]) == pytest.approx(sense * 0.05, rel=1e-4)


def test_friction_below_zero_is_refused():
    with pytest.raises(
        ValueError, match=r"friction_1 = 0.025 N.m is outside \[0, 0.02\]: friction_1 \+ friction_2"
    ):
        spring(friction_coulomb=0.03, friction_1=0.025, friction_2=0.01)
    with pytest.raises(ValueError, match=r"friction_1 = 0 N\.m: the other parameters leave no value"):
        spring(friction_coulomb=0.03, friction_2=0.04)


def test_without_friction_nothing_acts_and_nothing_is_remembered():
    law = spring()
    out, memory = law.advance_motion((3.0, 100.0, 0.0305, 1.0), law.initial_history())
    assert float(out["tau_friction"]) == 0.0
    assert not np.any(memory[-12:])
    assert float(out["tau1"]) == float(out["tau"]) / 100.0


def test_a_drive_begins_where_it_is():
    """Far from zero at rest the drive has no friction, in rotation it has the friction of its speed; no heat
    in both cases."""
    law = spring(**DRY)
    for speed, share in ((0.0, 0.0), (2.0, 1.0), (-2.0, -1.0)):
        out, memory = law.advance_motion((500.0, speed, 5.0, speed / 100.0), law.initial_history())
        most = float(friction_limits(law.joint, speed, 0.0)[0])
        assert float(out["tau_friction"]) == pytest.approx(share * most, rel=ROUND_OFF)
        assert float(out["E_loss"]) == 0.0
        after = law.advance_motion((500.0, speed, 5.0, speed / 100.0), memory)[0]
        assert float(after["tau_friction"]) == pytest.approx(share * most, rel=ROUND_OFF)


# Energy


def test_work_of_a_straight_path_is_exact_while_the_limit_changes():
    """The work of one step equals the work of very many small steps by the trapezoidal rule."""
    brake, rng = FrictionSliders(5.0 * SLIDER_STIFFNESS_SHARES), np.random.default_rng(4)
    memory = brake.pack_history(
        brake.advance(HISTORY_LAYOUT.virgin_history(), 0.0, 0.0, (0.05, 0.08)), 0.0, (0.05, 0.08)
    )
    for _ in range(5):
        before = memory
        phi, most = before[-4] + rng.normal(0.0, 0.02), rng.uniform(0.0, 0.1, 2)
        once = brake.advance(before, phi, 0.0, most)
        steps, work, loss = 1000, 0.0, 0.0
        for part in np.linspace(0.0, 1.0, steps + 1)[1:]:
            at = before[-4] + part * (phi - before[-4]), before[-3:-1] + part * (most - before[-3:-1])
            few = brake.advance(memory, at[0], 0.0, at[1])
            work += 0.5 * (np.sum(memory[:-4]) + float(few.traction)) * (at[0] - memory[-4])
            loss += float(few.dissipated_energy)
            memory = brake.pack_history(few, *at)
        stored = [float(np.sum(m[:-4] ** 2 / (2.0 * brake.stiffness))) for m in (before, memory)]
        assert once.force == pytest.approx(memory[:-4], abs=ROUND_OFF)
        assert float(once.dissipated_energy) == pytest.approx(loss, rel=1e-9, abs=ROUND_OFF)
        # a corner of a slider's force lies within one of the steps
        assert work == pytest.approx(
            stored[1] - stored[0] + float(once.dissipated_energy), abs=8 * 0.1 * 0.08 / steps
        )


def test_no_path_gives_energy_back_from_heat():
    law = spring(
        **DRY, **RIPPLE, load_loss_back=0.4, friction_viscous=1e-4, hysteresis_loss=2e-4, error_2=1e-4
    )
    rng = np.random.default_rng(5)
    memory, previous = started(law, 0.0, 0.0, 0.0, 0.0), 0.0
    for _ in range(500):
        phi1 = rng.normal(0.0, 0.05)
        motion = (phi1, rng.normal(0.0, 20.0), phi1 / 100.0 + rng.normal(0.0, 8e-4), rng.normal())
        out, memory = law.advance_motion(motion, memory)
        assert float(out["E_loss"]) >= previous
        previous = float(out["E_loss"])


@pytest.mark.parametrize("ratio", [100.0, -100.0])
def test_the_load_costs_its_share_by_who_drives(ratio):
    """Lifting a load and being driven by it, for both senses of rotation and both signs of the ratio."""
    start, given = 0.02, {"friction_coulomb": 0.02, "load_loss": 0.1, "load_loss_back": 0.3, "d": 0.0}
    law, T = spring(**given, friction_stribeck=0.0, ratio=ratio), 5.0
    for sense in (1.0, -1.0):
        for drives, share in ((True, 0.1), (False, 0.3)):
            # torque of the spring that turns the wave generator with or against its motion
            tau = math.copysign(T, ratio) * sense * (-1.0 if drives else 1.0)
            wound = math.copysign(float(law.curve.inverse(T)), tau)
            _, memory = law.advance_motion((0.0, 0.0, wound, 0.0), law.initial_history())
            far = sense * 40.0 * PRESLIDING
            out, _ = law.advance_motion((far, 0.0, far / ratio + wound, 0.0), memory)
            assert float(out["tau_friction"]) == pytest.approx(sense * (start + share * T / 100.0), rel=1e-9)


def test_one_share_is_both_unless_another_is_stated():
    one, both = (spring(**DRY | {"load_loss_back": back}) for back in (-1.0, DRY["load_loss"]))
    rng, memories = np.random.default_rng(1), [law.initial_history() for law in (one, both)]
    for _ in range(50):
        phi1 = rng.normal(0.0, 0.05)
        motion = (phi1, rng.normal(0.0, 20.0), phi1 / 100.0 + rng.normal(0.0, 8e-4), rng.normal())
        found = [
            law.advance_motion(motion, memory) for law, memory in zip((one, both), memories, strict=True)
        ]
        memories = [memory for _, memory in found]
        assert all(float(found[0][0][name]) == float(found[1][0][name]) for name in found[0][0])


# Motion


def coast(law, inertia, speed, step, count):
    """Angle and speed (count + 1, 2) of a coasting motor while the output follows without load."""
    phi, w, found = 0.0, speed, [(0.0, speed)]
    out, memory = law.advance_motion((0.0, w, 0.0, w / 100.0), law.initial_history())
    for _ in range(count):
        w += step * float(out["tau1"]) / inertia
        phi += step * w
        out, memory = law.advance_motion((phi, w, phi / 100.0, w / 100.0), memory)
        found.append((phi, w))
    return np.array(found)


def test_a_coasting_motor_stops_after_the_way_that_its_energy_lasts():
    """J w^2/2 = M phi; the remaining oscillation in the presliding range decays."""
    inertia, speed, friction = 3e-5, 30.0, 0.03
    law = spring(friction_coulomb=friction, friction_viscous=0.0)
    ends = 0.5 * inertia * speed**2 / friction
    found = coast(law, inertia, speed, 1e-4, 1500)
    stop = inertia * speed / friction  # [s]
    before = found[: int(0.9 * stop / 1e-4)]
    t = 1e-4 * np.arange(len(before))
    assert before[:, 1] == pytest.approx(speed - friction / inertia * t, abs=0.01 * speed)
    assert found[-1, 0] == pytest.approx(ends, abs=3.0 * PRESLIDING)  # the sliders spring back
    swing = [np.ptp(part) for part in np.split(found[600:1500, 0], 3)]
    assert np.all(np.diff(swing) < 0.0)
    assert swing[-1] < 0.5 * PRESLIDING


# Temperature: the law and its constants, heat on any path, rest


THINNING = {"viscous_temperature_coefficient": 0.03, "dry_temperature_coefficient": 0.01}
ALL = THINNING | {
    "friction_coulomb": 0.03,
    "friction_stribeck": 0.02,
    "stribeck_speed": 20.0,
    "friction_viscous": 2e-4,
    "load_loss": 0.1,
    "load_loss_back": 0.25,
    "hysteresis_loss": 2e-4,
    "lost_motion": 1e-4,
    "error_2": 1e-4,
}
OILS = list(
    csv.DictReader(
        (files("jointfmu_models") / "reference" / "lubricant_viscosity.csv").read_text("utf-8").splitlines()
    )
)


def test_each_part_follows_its_own_exponential():
    drive = spring(**ALL, temperature_factor=1.3).joint
    for kelvin in (253.15, REFERENCE_TEMPERATURE, 353.15):
        wet, dry = (math.exp(-c * (kelvin - REFERENCE_TEMPERATURE)) for c in THINNING.values())
        assert float(viscous_torque(drive, 5.0, kelvin)) == pytest.approx(1.3 * wet * 2e-4 * 5.0, rel=1e-14)
        for side, reference in zip(
            friction_limits(drive, 5.0, 2.0, kelvin), friction_limits(drive, 5.0, 2.0), strict=True
        ):
            assert float(side) == pytest.approx(dry * float(reference), rel=1e-14)


def test_the_default_coefficient_is_that_of_a_light_machine_oil():
    """The coefficient is 2/3 of the coefficient of the viscosity: the torque of a rolling bearing is
    proportional to viscosity^(2/3)."""
    found = {
        row["oil"]: 2.0 / 3.0 * math.log(float(row["T30_mPas"]) / float(row["T100_mPas"])) / 70.0
        for row in OILS
    }
    own = load_default("harmonic_drive").values.viscous_temperature_coefficient
    assert own == round(found["light machine oil"], 3)
    assert (round(min(found.values()), 3), round(max(found.values()), 3)) == (0.02, 0.042)


def stored(law, memory, out):
    """Energy (n) [J] of the spring, of the hysteresis sliders and of the friction sliders."""
    parts = STATES.split(memory)
    pairs = ((parts["force"], law.hysteresis.stiffness), (parts["friction_torque"], law.friction.stiffness))
    sliders = sum(np.sum(force**2 / (2.0 * K), axis=-1) for force, K in pairs)
    return law.curve.energy(np.abs(out["phi_rel"])) + sliders


WAVES, STEPS, RUNS = 3, 1000, 200


def smooth(rng, size, t):
    """Random sums of sines (n, steps) with an amplitude, and their rates."""
    share = size * rng.dirichlet(np.ones(WAVES), RUNS)
    rate, phase = rng.uniform(0.5, 3.0, (RUNS, WAVES)), rng.uniform(0.0, 2.0 * np.pi, (RUNS, WAVES))
    angle = rate[..., None] * t + phase[..., None]
    return (
        np.einsum("nk,nkt->tn", share, np.sin(angle)),
        np.einsum("nk,nkt->tn", share * rate, np.cos(angle)),
    )


@pytest.mark.slow  # 200 trajectories of 1000 steps
@pytest.mark.parametrize("ratio", [100.0, -80.0])
def test_random_trajectories_make_heat_only_and_all_work_is_accounted_for(ratio, native, fmus):
    """With all kinds of friction and changing temperature, the work of both torques (trapezoidal rule) is
    stored or becomes heat.

    The beginning of the first trajectory is equal in every flavour, too.
    """
    law, rng = spring(**ALL, d=0.3, ratio=ratio), np.random.default_rng(24)
    t = np.linspace(0.0, 2.0, STEPS)
    phi1, w1 = smooth(rng, 0.6, t)
    wound, rise = smooth(rng, 1.2e-3, t)
    warmth = REFERENCE_TEMPERATURE + smooth(rng, 40.0, t)[0]
    phi2, w2 = phi1 / ratio + wound, w1 / ratio + rise
    memory = np.broadcast_to(law.initial_history(), (RUNS, law.initial_history().size))
    first = []
    work, wet, through, before, lost = np.zeros(RUNS), np.zeros(RUNS), np.zeros(RUNS), None, np.zeros(RUNS)
    for k in range(STEPS):
        out, memory = law.advance_motion((phi1[k], w1[k], phi2[k], w2[k]), memory, warmth[k])
        assert np.all(out["E_loss"] >= lost)
        lost = out["E_loss"]
        first.append({name: float(np.broadcast_to(x, RUNS)[0]) for name, x in out.items()})
        slope = (out["tau1"] + out["tau_friction"]) / out["tau"] if k else 0.0
        damped = 0.3 * (w2[k] - w1[k] * slope) ** 2 + w1[k] * viscous_torque(law.joint, w1[k], warmth[k])
        torques = np.stack([out["tau1"], out["tau2"]])
        places = np.stack([phi1[k], phi2[k]])
        if before is None:
            begun, start = stored(law, memory, out), lost
        else:
            part = -0.5 * (torques + before[0]) * (places - before[1])
            work += np.sum(part, axis=0)
            through += np.sum(np.abs(part), axis=0)
            wet += 0.5 * (damped + before[2]) * (t[1] - t[0])
        before = torques, places, damped
    missing = np.abs(work - (stored(law, memory, out) - begun + lost - start + wet)) / through
    print(f"ratio {ratio:g}: median {np.median(missing):.1e}, largest {missing.max():.1e} of throughput")
    assert missing.max() < 1e-5
    names = ("phi1", "w1", "phi2", "w2", "temperature")
    rows = [dict(zip(names, row, strict=True)) for row in np.stack([phi1, w1, phi2, w2, warmth])[..., 0].T]
    for folder in (native / "fmi2", native / "fmi3", fmus):
        drive = Fmu(folder / "HarmonicDriveSpring.fmu")
        drive.start(ALL | {"d": 0.3, "ratio": ratio} | rows[0])
        for row, expected in zip(rows[:250], first[:250], strict=True):
            assert drive.at(row) == close(expected)
            drive.step()
        drive.free_instance()
