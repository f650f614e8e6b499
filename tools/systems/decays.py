"""A body let go on a joint with memory: frequency and damping over the falling amplitude, by running FMUs."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jointfmu_fmu_src.partners import PARTNERS
from scipy.interpolate import CubicSpline

from jointfmu.progress import track_progress
from jointfmu.quantity import Array

from ..fitting import decay
from ..fitting.hysteresis import HysteresisLaw
from ..ramps import loops
from .master import Slave, motion
from .ringing import PER_PERIOD, Body, Rest, VibratingJoint, vibrating_joints

PERIODS, SETTLED = 60, 10
"""Periods of a decay, and the last ones, whose mean is where the joint settles: friction holds it off its
working point."""
MAX_LOGARITHM_RATIO = 2.0
"""Logarithm of a swing's first half over its middle, over the damping ratio [1]: pi/2, and a little more."""
FREQUENCY_TOLERANCE, DAMPING_TOLERANCE = 5e-3, 2e-2
"""Of a window of a decay against the loops of its mean amplitude [1]; the damping after the first window,
within whose two periods half of the amplitude is lost."""
MIN_AMPLITUDE_RATIO = 0.01
"""Amplitude over the first one [1] down to which a decay is followed."""


@dataclass(frozen=True, slots=True)
class Decay:
    """A decay about one working point.

    load      : on the joint, SI
    amplitude, frequency, damping : (n) [m or rad], [rad/s], [1] as they fall
    expected, stated : (n) frequency [rad/s] and damping ratio [1] by the energy of the joint's loops at
        these amplitudes, about where it settles, and its viscous damping
    law       : (n) half of the joint's output eta_loop [1] there; None: it has none
    time, signal : [s], deflection from the working point [m or rad]
    messages  : what the FMUs logged
    """

    load: float
    amplitude: Array
    frequency: Array
    damping: Array
    expected: Array
    stated: Array
    law: Array | None
    time: Array
    signal: Array
    messages: tuple[str, ...]


def examples(folder: Path) -> dict[str, list[Decay]]:
    """The systems of one joint that says how it rings, pulled so that it slips.

    folder : of the FMUs (FMI 2.0)
    """
    pulls = [(name, one, one.body.pull) for name, one in vibrating_joints().items()]
    return {name: decays(one, folder, pull.deflection, [pull.load]) for name, one, pull in pulls}


def decays(
    joint: VibratingJoint,
    folder: Path,
    first: float,
    loads: Sequence[float] | None = None,
    inertia: float | None = None,
    settings: Mapping[str, object] | None = None,
) -> list[Decay]:
    """The body of a system on its joint, pulled by `first` [m or rad] from its working point and let go.

    folder   : of the FMUs (FMI 2.0) of the joint and of the body
    loads    : SI; None: the largest of those that show the joint
    inertia  : [kg.m2 or kg] of the body; None: that of the system
    settings : parameters of the joint beside those of the system

    Raises ValueError for an FMU that is missing or refuses, and where too few periods stand out.
    """
    parameters = {**joint.parameters, **(settings or {})}
    loads = [max(joint.body.loads(folder / f"{joint.fmu}.fmu", parameters))] if loads is None else loads
    inertia = joint.inertia if inertia is None else inertia
    return [
        _decay_at(joint, folder, load, parameters, inertia, first)
        for load in track_progress(loads, "ring", len(loads))
    ]


def _decay_at(
    joint: VibratingJoint,
    folder: Path,
    load: float,
    parameters: Mapping[str, Any],
    mass: float,
    first: float,
) -> Decay:
    body, path = joint.body, folder / f"{joint.fmu}.fmu"
    rest, partner = body.rest(path, load, parameters), PARTNERS[body.partner]
    states = [v.name for v in partner.outputs[: partner.state_count]]
    pulled = rest.position + np.copysign(first, rest.position)  # one way from no load: the joint begins there
    start, held = {joint.key: mass, states[0]: pulled}, {**parameters, **body.start(load)}
    step = 2.0 * np.pi / np.sqrt(rest.stiffness / mass) / PER_PERIOD
    with (
        Slave(path, {**held, body.motion[0]: pulled}, body.motion, (body.force,)) as slave,
        Slave(folder / f"{body.partner}.fmu", start, [v.name for v in partner.inputs], states) as moving,
    ):
        signal = motion(slave, moving, rest.force, step, PERIODS * PER_PERIOD)[:, 0] - rest.position
        messages = tuple(dict.fromkeys(slave.messages + moving.messages))
    time = np.asarray(step * np.arange(signal.size), dtype=np.float64)
    found = decay.analyse_decay(time, signal, f"load = {load:g}: ")
    seen = found.amplitude > MIN_AMPLITUDE_RATIO * first
    amplitude = found.amplitude[seen]
    widest = amplitude * np.exp(MAX_LOGARITHM_RATIO * found.damping[seen])
    settled = rest._replace(position=rest.position + float(np.mean(signal[-SETTLED * PER_PERIOD :])))
    expected, stated, law = _of_loops(path, held, body, settled, mass, amplitude, widest)
    frequency = 2.0 * np.pi * found.frequency[seen]
    damping = found.damping[seen]
    return Decay(load, amplitude, frequency, damping, expected, stated, law, time, signal, messages)


def _of_loops(
    path: Path,
    settings: Mapping[str, object],
    body: Body,
    rest: Rest,
    mass: float,
    amplitudes: Array,
    widest: Array,
) -> tuple[Array, Array, Array | None]:
    """Frequency [rad/s] and damping ratio [1] by the energy of loops, a little wider than the amplitudes, and
    half of `eta_loop` [1]."""
    swing = loops.CyclicPath(centre=rest.position, shape="sine", cycles=1)
    run = loops.run_loops(path, body.motion[0], widest.tolist(), swing, body.force, settings)
    found = [
        of_loop(loop, rest.damping).decay(np.array([a]), mass)
        for loop, a in zip(run.loops, amplitudes, strict=True)
    ]
    frequency, decrement = np.array(found)[:, :, 0].T
    way, eta = np.abs(run.loops[0].motion - rest.position), run.loops[0].result.columns.get("eta_loop")
    first = slice(None, swing.points // 4 + 1)
    law = None if eta is None else 0.5 * np.interp(amplitudes, way[first], eta[first])
    return frequency, decrement / np.hypot(np.pi, decrement), law


def of_loop(loop: loops.HysteresisLoop, viscous: float) -> HysteresisLaw:
    """The law by Masing's rule whose branches are the mean of a loop's two."""
    motion, force = loop.motion[loop.cycle_start :], loop.force[loop.cycle_start :]
    half = motion.size // 2
    falling, rising = slice(None, half + 1), slice(half, None)
    way = 0.5 * (motion[0] - motion[falling])
    friction = 0.25 * (force[0] - force[falling] + force[rising] - force[half])
    curve = CubicSpline(way, friction)
    return HysteresisLaw(curve, curve.antiderivative(), viscous=viscous)
