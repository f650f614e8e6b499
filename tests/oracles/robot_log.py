"""Synthetic logs of a robot joint with known friction, and the fit of this friction.

An arm on the exported spring of the package swings under gravity while the drive warms up. The log has a
quantized encoder and a noisy current. A second kind of log is a table of steady speeds.
"""

import tempfile
from functools import cache
from pathlib import Path

import numpy as np
from jointfmu_tools.common import columns
from jointfmu_tools.joints.harmonic_drive.fit import log
from jointfmu_tools.joints.harmonic_drive.new import NEW_JOINT_COMMAND

from jointfmu.joints.harmonic_drive.friction import friction_limits, viscous_torque
from jointfmu.joints.harmonic_drive.spring import HarmonicDriveSpring

TRUE_VALUES = {
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
"""Inertias [kg.m2] of arm and rotor; gravity torque of the horizontal arm [N.m]."""
STEP, TIME = 2e-3, 60.0
"""Sampling interval and duration of the log [s]."""
BITS = 2.0 * np.pi / 2**17
"""Resolution of the encoder [rad]."""
CONSTANT, NOISE = 0.1, 0.1
"""Torque constant of the motor [N.m/A]; standard deviation of a current [A], 20 % of the dry friction."""
SPEEDS = (0.01, 0.05, 0.1, 0.2, 0.5, 0.8, 1.5, 2.2, 3.2)
"""Steady speeds of the joint [rad/s]."""


def drive():
    """Parameter file of the drive with the true values."""
    given = dict.fromkeys(option.name for option in NEW_JOINT_COMMAND.command_options) | {
        "catalogue": "CSG-25-100"
    }
    return NEW_JOINT_COMMAND.make_joint(given).parameter_file.with_values(TRUE_VALUES, "user", "made up")


def start():
    """Parameter file with the start values of the fit: the same drive with another friction."""
    other = {name: 1.4 * value for name, value in TRUE_VALUES.items() if name != "stribeck_speed"}
    other |= {name: 1.2 * TRUE_VALUES[name] for name in ("K1", "K2", "K3")}
    return drive().with_values(other, "user", "start")


@cache
def motion(duration, step):
    """Exact signals: time [s], joint angle [rad], motor torque [N.m], temperature [K], motor angle [rad]."""
    t = np.arange(0.0, duration, step)
    waves = ((0.7, 0.31, 0.0), (0.4, 0.83, 1.0), (0.05, 2.3, 2.0))
    q, dq, ddq = (
        sum(
            a * (2.0 * np.pi * f) ** n * np.sin(2.0 * np.pi * f * t + p + 0.5 * np.pi * n)
            for a, f, p in waves
        )
        for n in range(3)
    )
    temperature = 293.15 + 25.0 * t / duration
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


def write_swing(path, seed, duration=TIME, step=STEP):
    """Write a log of the swing with units, in an unusual order of columns.

    duration, step : time of the log and its step [s]
    """
    rng = np.random.default_rng(seed)
    t, q, torque, temperature, phi1 = motion(duration, step)
    current = torque / CONSTANT + NOISE * rng.standard_normal(t.size)
    seen = BITS * np.round((q + BITS * rng.random()) / BITS)
    motor = BITS * np.round(phi1 / BITS)
    heads = [("q_motor", "rad"), ("current", "A"), ("temperature", "degC"), ("q", "deg"), ("t", "s")]
    values = [motor, current, temperature - 273.15, np.degrees(seen), t]
    path.write_text(columns.format_table(heads, values, 9))


def write_steady_speeds(path, seed):
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
        write_swing,
        {"torque_constant": CONSTANT, "motor_inertia": ROTOR},
    ),
    "36 steady speeds at two temperatures, 2 % of noise": (write_steady_speeds, {}),
}


def fit_log(make, options, seed):
    """Fit one log that `make` writes."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "log.csv"
        make(path, seed)
        return log.fit([path], start(), **options)
