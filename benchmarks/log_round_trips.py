"""Does a robot's log give back the friction that it was made with?

    python benchmarks/log_round_trips.py [SEEDS]

The table of docs/fitting_explanation.md: a joint with the exported spring of the package, its arm swinging
under gravity while the drive warms up, seen through a quantized encoder and a noisy current; and tables of
steady speeds.
"""

import sys
import tempfile
from functools import cache
from pathlib import Path

import numpy as np
from jointfmu_tools.common import columns
from jointfmu_tools.joints.harmonic_drive.fit import log
from jointfmu_tools.joints.harmonic_drive.new import NEW

from jointfmu.joints.harmonic_drive.friction import friction_limits, viscous_torque
from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring

TRUE = {
    "friction_coulomb": 0.05,
    "friction_stribeck": 0.03,
    "stribeck_speed": 10.0,
    "friction_viscous": 4e-4,
    "load_loss": 0.1,
    "load_loss_back": 0.06,
    "viscous_temperature_coefficient": 0.023,
    "dry_temperature_coefficient": 0.01,
    "K1": 31e3,
    "K2": 50e3,
    "K3": 57e3,
    "hysteresis_loss": 0.8 * np.pi / 10800.0,
}
ARM, ROTOR, GRAVITY = 2.0, 1e-4, 60.0
"""Inertias [kg.m2] of the arm and of the rotor, torque of the arm's weight held level [N.m]."""
STEP, TIME = 2e-3, 60.0
"""Of the log [s]."""
BITS = 2.0 * np.pi / 2**17
"""Step of the encoder [rad]."""
CONSTANT, NOISE = 0.1, 0.1
"""Torque over current of the motor [N.m/A]; standard deviation of a current [A], 20 % of the dry friction."""
SPEEDS = (0.01, 0.05, 0.1, 0.2, 0.5, 0.8, 1.5, 2.2, 3.2)
"""Steady speeds of the joint [rad/s]."""


def drive():
    """The parameter file that the logs are made with."""
    given = dict.fromkeys(option.name for option in NEW.options) | {"catalogue": "CSG-25-100"}
    return NEW.make_joint(given).file.with_values(TRUE, "user", "made up")


def start():
    """What the fit begins with: the same drive, another friction."""
    other = {name: 1.4 * value for name, value in TRUE.items() if name != "stribeck_speed"}
    other |= {name: 1.2 * TRUE[name] for name in ("K1", "K2", "K3")}
    return drive().with_values(other, "user", "start")


@cache
def motion():
    """Time [s], joint's angle [rad], motor's torque [N.m], temperature [K], motor's angle [rad], no noise."""
    t = np.arange(0.0, TIME, STEP)
    waves = ((0.7, 0.31, 0.0), (0.4, 0.83, 1.0), (0.05, 2.3, 2.0))
    q, dq, ddq = (
        sum(
            a * (2.0 * np.pi * f) ** n * np.sin(2.0 * np.pi * f * t + p + 0.5 * np.pi * n)
            for a, f, p in waves
        )
        for n in range(3)
    )
    temperature = 293.15 + 25.0 * t / TIME
    spring = HarmonicDriveSpring.tabulate(drive().values)
    ratio, load = spring.joint.ratio, ARM * ddq + GRAVITY * np.cos(q)
    wound, phi = spring.initial_history(), np.empty(t.size)
    for n, torque in enumerate(-load):
        out, wound = spring.advance_torque(torque, wound)
        phi[n] = float(out["phi_rel"])
    phi1 = ratio * (q - phi)
    w1 = np.gradient(phi1, t)
    memory, torque = spring.initial_history(), np.zeros(t.size)
    for n, now in enumerate(zip(phi1, w1, q, dq, strict=True)):
        out, memory = spring.advance_motion(now, memory, temperature[n])
        torque[n] = -float(out["tau1"])
    return t, q, np.sign(ratio) * (torque + ROTOR * np.gradient(w1, t)), temperature, phi1


def moving(path, seed):
    """Write a log of the motion, with units, columns in another order than anybody expects."""
    rng = np.random.default_rng(seed)
    t, q, torque, temperature, phi1 = motion()
    current = torque / CONSTANT + NOISE * rng.standard_normal(t.size)
    seen = BITS * np.round((q + BITS * rng.random()) / BITS)
    motor = BITS * np.round(phi1 / BITS)
    heads = [("q_motor", "rad"), ("current", "A"), ("temperature", "degC"), ("q", "deg"), ("t", "s")]
    values = [motor, current, temperature - 273.15, np.degrees(seen), t]
    path.write_text(columns.format_table(heads, values, 9))


def steady(path, seed):
    """Write a table of steady speeds of both senses at two temperatures, with 2 % of noise."""
    rng = np.random.default_rng(seed)
    dq = np.array([sign * speed for sign in (-1.0, 1.0) for speed in SPEEDS] * 2)
    temperature = np.repeat([293.15, 318.15], 2 * len(SPEEDS))
    w1, free = np.abs(drive().values.ratio) * dq, drive().values
    torque = np.sign(dq) * friction_limits(free, w1, 0.0, temperature)[0] + viscous_torque(
        free, w1, temperature
    )
    torque *= 1.0 + 0.02 * rng.standard_normal(dq.size)
    path.write_text(
        columns.format_table(
            [("tau", "N.m"), ("dq", "rad/s"), ("temperature", "K")], [torque, dq, temperature], 9
        )
    )


CASES = {
    "arm that swings for a minute, 17 bit of encoder, 20 % of noise": (
        moving,
        {"torque_constant": CONSTANT, "motor_inertia": ROTOR},
    ),
    "36 steady speeds at two temperatures, 2 % of noise": (steady, {}),
}


ROTORLESS = "the same, inertia of the rotor not stated"
"""A third of the whole inertia is the rotor's."""
FEWER = 6
"""Seeds of all over those of that log, whose fit takes three times as long."""


def trip(make, options, seed):
    """The fit to one log."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "log.csv"
        make(path, seed)
        return log.fit([path], start(), **options)


def trips(make, options, seeds):
    """{parameter: (relative errors, whether its interval holds the truth)} of the seeds, and the last fit."""
    found = {}
    for seed in range(seeds):
        fit = trip(make, options, seed)
        for label in fit.solution.values:
            errors, held = found.setdefault(label, ([], []))
            errors.append(fit.parameters.values_by_name[label] / TRUE[label] - 1.0)
            if label in fit.confidence_intervals:
                low, high = fit.confidence_intervals[label]
                held.append(low <= TRUE[label] <= high)
    return found, fit


def main(seeds):
    """Print a table in Markdown."""
    print("| log | parameter | median error | 95 % interval holds it |\n|---|---|---|---|")
    cases = {name: (*case, seeds) for name, case in CASES.items()}
    cases[ROTORLESS] = moving, {"torque_constant": CONSTANT}, -(-seeds // FEWER)
    for name, case in cases.items():
        found, fit = trips(*case)
        for label, (errors, held) in found.items():
            cells = f"{100.0 * np.median(np.abs(errors)):.2g} %", f"{sum(held)} of {len(held)}"
            print(f"| {name} | `{label}` | {' | '.join(cells)} |")
        print(f"<!-- {fit.facts} {fit.notes} -->", file=sys.stderr)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 100)
