"""Synthetic loops, decays and responses of joints with friction, with seeded noise; fits of a bolted joint.

Loops follow Masing's rule. Decays are integrated in time with the same rule. Responses have the first
harmonic only, as the fit does.
"""

from functools import cache

import numpy as np
from jointfmu_tools.inputs.fitting.hysteresis import Oscillator
from jointfmu_tools.joints.bolted_joint.fit import loop

from jointfmu.parameters import load_default

PRELOAD, MASS = 9e3, 50.0
JOINT = {"mu": 0.22, "surface.G": 2.5e-8, "surface.D": 1.38}
SHEARS = (1e-6, 3e-6, 6e-6, 9e-6)
NOISE = 3e-3
"""Noise of force or torque over its amplitude in a run [1]."""
MOTION_NOISE = 1e-3
"""Noise of the motion over its amplitude in a run [1]."""
DECAY_NOISE, RESPONSE_NOISE = 3e-3, 1e-2


def file(kind, values):
    """Default parameter file with the true values of the synthetic measurements."""
    return load_default(kind).with_values(values, "user", "synthetic")


@cache
def joint_law():
    """Hysteresis law of a joint in shear, with the true parameters."""
    return loop.make_shear_loop_law(file("bolted_joint", JOINT).values, PRELOAD)[0]


def loops(law, amplitudes, rng, cycles=2, points=100, noise=NOISE):
    """Run number, motion and force of loops u = a cos(angle) with noise; each amplitude is a run."""
    angle = 2.0 * np.pi * np.arange(cycles * points) / points
    branch = (2 * np.arange(cycles * points)) // points
    runs = []
    for number, a in enumerate(amplitudes, 1):
        start = np.where(branch % 2 == 0, a, -a)
        motion, top = a * np.cos(angle), 0.5 * law.force_change(np.array([a]), np.array([-a]))
        force = np.copysign(top, start) + law.force_change(motion, start)
        motion = motion + min(noise, MOTION_NOISE) * a * rng.standard_normal(motion.size)
        force = force + noise * top * rng.standard_normal(motion.size)
        runs.append(np.stack([np.full(motion.size, float(number)), motion, force]))
    return np.concatenate(runs, axis=1)


def decay(law, inertia, amplitude, periods=60, steps=500, kept=25):
    """Time and motion of a body released at an amplitude after first loading, by velocity Verlet."""
    grid = np.linspace(0.0, 1.1 * amplitude, 4001)
    friction = law.friction_force(grid)
    elastic = law.elastic_spring.elastic_force(grid) if law.elastic_spring else 0.0 * grid
    stiffness = (friction[1] + elastic[1]) / grid[1]
    h = 2.0 * np.pi * np.sqrt(inertia / stiffness) / steps
    turn, held = amplitude, friction[-1] if amplitude > grid[-1] else np.interp(amplitude, grid, friction)

    def memory(x):
        return held + np.copysign(2.0 * np.interp(0.5 * abs(x - turn), grid, friction), x - turn)

    def rate(x, v):
        pull = memory(x) + np.copysign(np.interp(abs(x), grid, elastic), x)
        return -(pull + law.viscous_damping * v) / inertia

    x, v, a, motion = amplitude, 0.0, rate(amplitude, 0.0), [amplitude]
    for k in range(1, periods * steps + 1):
        half = v + 0.5 * h * a
        x += h * half
        a = rate(x, half)
        new = half + 0.5 * h * a
        if new * v < 0.0:
            held, turn = memory(x), x
        v = new
        if k % (steps // kept) == 0:
            motion.append(x)
    return h * (steps // kept) * np.arange(len(motion)), np.array(motion)


def forced(law, inertia, force, frequency, reach, periods=60, steps=400):
    """Steady amplitude under a harmonic force, integrated from rest with parallel sliders."""
    grid = np.linspace(0.0, reach, 400)
    stiffness = -np.diff(np.diff(law.friction_force(grid)) / grid[1], append=0.0)
    limit = stiffness * grid[1:]
    w, h = 2.0 * np.pi * frequency, 1.0 / frequency / steps
    x = v = 0.0
    sliders = np.zeros(limit.size)
    seen = []
    for k in range(periods * steps):
        step = h * v
        sliders = np.clip(sliders + stiffness * step, -limit, limit)
        x += step
        v += h / inertia * (force * np.sin(w * (k + 1) * h) - np.sum(sliders))
        if k >= (periods - 2) * steps:
            seen.append(x)
    return 0.5 * float(np.ptp(seen))


@cache
def joint_decay():
    """Decay of a mass on the joint, with the true parameters."""
    return decay(joint_law(), MASS, 3e-6)


def response(law, inertia, forces, frequencies):
    """Frequency, force and amplitude at several force levels."""
    f, F = (column.ravel() for column in np.meshgrid(frequencies, forces))
    return (
        f,
        F,
        Oscillator(law, inertia).response_amplitude(f, F, F / law.equivalent_spring(np.array([1e-9]))[0]),
    )


@cache
def joint_response():
    """Response of a mass on the joint with the true parameters, up to half of gross slip."""
    return response(
        joint_law(), MASS, np.array([20.0, 200.0, 1000.0, 2500.0]), np.linspace(900.0, 1300.0, 21)
    )


def save(path, heading, *columns):
    """Write columns as a CSV file."""
    np.savetxt(path, np.stack(columns, axis=1), delimiter=",", header=heading, comments="")
    return path


def joint_loops_fit(rng, path):
    """Fit loops of a bolted joint in shear; the largest amplitude is 81 % of gross slip."""
    run, motion, force = loops(joint_law(), SHEARS, rng)
    save(path, "run [1], displacement [um], force [N]", run, 1e6 * motion, force)
    return loop.fit(path, preload=PRELOAD), JOINT


def joint_decay_fit(rng, path):
    """Fit the decay of a mass on a bolted joint; the fractal dimension is known."""
    time, motion = joint_decay()
    motion = motion + DECAY_NOISE * motion[0] * rng.standard_normal(motion.size)
    save(path, "time [s], displacement [um]", time, 1e6 * motion)
    known = file("bolted_joint", {"surface.D": JOINT["surface.D"]})
    return loop.fit(path, known, preload=PRELOAD, modal_mass=MASS), JOINT


def joint_response_fit(rng, path):
    """Fit the response of a mass on a bolted joint at four force levels; the fractal dimension is known."""
    f, F, a = joint_response()
    a = a * np.exp(RESPONSE_NOISE * rng.standard_normal(a.size))
    save(path, "frequency [Hz], force [N], displacement [um]", f, F, 1e6 * a)
    known = file("bolted_joint", {"surface.D": JOINT["surface.D"]})
    return loop.fit(path, known, preload=PRELOAD, modal_mass=MASS), JOINT


CASES = {
    "loops of a joint": joint_loops_fit,
    "decay on a joint": joint_decay_fit,
    "response of a joint": joint_response_fit,
}
