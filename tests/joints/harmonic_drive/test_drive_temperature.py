"""Friction over temperature: the law and its constants, its heat on any path, and rest at any temperature."""

import csv
import math
from dataclasses import replace
from importlib.resources import files

import numpy as np
import pytest
from conftest import Fmu
from natives import close

from jointfmu.joints.harmonic_drive import friction
from jointfmu.joints.harmonic_drive.friction import REFERENCE, limits, viscous
from jointfmu.joints.harmonic_drive.spring import MEMORY, HarmonicDriveSpring
from jointfmu.parameters import default

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


def spring(**changes):
    return HarmonicDriveSpring.of(replace(default("harmonic_drive").values, **changes))


def test_each_part_follows_its_own_exponential():
    drive = spring(**ALL, temperature_factor=1.3).joint
    for kelvin in (253.15, REFERENCE, 353.15):
        wet, dry = (math.exp(-c * (kelvin - REFERENCE)) for c in THINNING.values())
        assert float(viscous(drive, 5.0, kelvin)) == pytest.approx(1.3 * wet * 2e-4 * 5.0, rel=1e-14)
        for side, reference in zip(limits(drive, 5.0, 2.0, kelvin), limits(drive, 5.0, 2.0), strict=True):
            assert float(side) == pytest.approx(dry * float(reference), rel=1e-14)


def test_the_default_coefficient_is_that_of_a_light_machine_oil():
    """2/3 of the viscosity's: a rolling bearing's torque goes with viscosity^(2/3)."""
    found = {
        row["oil"]: 2.0 / 3.0 * math.log(float(row["T30_mPas"]) / float(row["T100_mPas"])) / 70.0
        for row in OILS
    }
    own = default("harmonic_drive").values.viscous_temperature_coefficient
    assert own == round(found["light machine oil"], 3)
    assert (round(min(found.values()), 3), round(max(found.values()), 3)) == (0.02, 0.042)


@pytest.mark.slow
@pytest.mark.parametrize("kelvin", [253.15, 353.15])
def test_a_drive_in_the_cold_and_in_the_warm_holds_what_it_bears(kelvin):
    """1e5 steps under 0.7 of the limit there, shaken by 0.1 of it: not 1e-12 rad of drift.

    The oscillation dies out by viscous friction, of which a sixth is left in the warm.
    """
    law, inertia, step = spring(friction_coulomb=0.05, friction_viscous=3e-3, **THINNING), 3e-5, 1e-4
    most = float(limits(law.joint, 0.0, 0.0, kelvin)[0])
    brake, joint = law.friction, law.joint
    phi, w, memory = 0.0, 0.0, friction.MEMORY.rest()
    places = np.empty(100_000)
    for k in range(places.size):
        held = brake.moved(memory, phi, w, (most, most))
        torque = 0.7 * most + 0.1 * most * math.sin(2.0 * math.pi * k / 500)
        w += step / inertia * (torque - float(held.traction) - float(viscous(joint, w, kelvin)))
        memory = brake.after(held, phi, (most, most))
        phi += step * w
        places[k] = phi
    late = places[places.size // 2 :]
    assert np.max(np.abs(late[500:] - late[:-500])) < 1e-12


def stored(law, memory, out):
    """Energy (n) [J] of the spring, of the sliders of the hysteresis and of those of the friction."""
    parts = MEMORY.split(memory)
    pairs = ((parts["force"], law.hysteresis.stiffness), (parts["brake"], law.friction.stiffness))
    sliders = sum(np.sum(force**2 / (2.0 * K), axis=-1) for force, K in pairs)
    return law.curve.energy(np.abs(out["phi_rel"])) + sliders


WAVES, STEPS, RUNS = 3, 1000, 1000


def smooth(rng, size, t):
    """Random sums of sines (n, steps) of an amplitude, and their rates."""
    share = size * rng.dirichlet(np.ones(WAVES), RUNS)
    rate, phase = rng.uniform(0.5, 3.0, (RUNS, WAVES)), rng.uniform(0.0, 2.0 * np.pi, (RUNS, WAVES))
    angle = rate[..., None] * t + phase[..., None]
    return (
        np.einsum("nk,nkt->tn", share, np.sin(angle)),
        np.einsum("nk,nkt->tn", share * rate, np.cos(angle)),
    )


@pytest.mark.slow  # 1000 trajectories of 1000 steps
@pytest.mark.parametrize("ratio", [100.0, -80.0])
def test_random_trajectories_make_heat_only_and_all_work_is_accounted_for(ratio, native, fmus):
    """All friction on and the temperature moving. Work is that of both torques by the trapezium rule.

    The first trajectory is that of every flavour too.
    """
    law, rng = spring(**ALL, d=0.3, ratio=ratio), np.random.default_rng(24)
    t = np.linspace(0.0, 2.0, STEPS)
    phi1, w1 = smooth(rng, 0.6, t)
    wound, rise = smooth(rng, 1.2e-3, t)
    warmth = REFERENCE + smooth(rng, 40.0, t)[0]
    phi2, w2 = phi1 / ratio + wound, w1 / ratio + rise
    memory = np.broadcast_to(law.rest(), (RUNS, law.rest().size))
    first = []
    work, wet, through, before, lost = np.zeros(RUNS), np.zeros(RUNS), np.zeros(RUNS), None, np.zeros(RUNS)
    for k in range(STEPS):
        out, memory = law.driven((phi1[k], w1[k], phi2[k], w2[k]), memory, warmth[k])
        assert np.all(out["E_loss"] >= lost)
        lost = out["E_loss"]
        first.append({name: float(np.broadcast_to(x, RUNS)[0]) for name, x in out.items()})
        slope = (out["tau1"] + out["tau_friction"]) / out["tau"] if k else 0.0
        damped = 0.3 * (w2[k] - w1[k] * slope) ** 2 + w1[k] * viscous(law.joint, w1[k], warmth[k])
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
        for row, expected in zip(rows, first, strict=True):
            assert drive.at(row) == close(expected)
            drive.step()
        drive.free()
