"""Free decay of a body on a joint with hysteresis: frequency and damping over amplitude, by running FMUs."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jointfmu_fmu_src.partners import PARTNERS
from scipy.interpolate import CubicSpline

from jointfmu.progress import track_progress
from jointfmu.quantity import Array

from ..inputs.fitting import decay
from ..inputs.fitting.hysteresis import HysteresisLaw
from ..run.ramps import loops
from .master import Slave, simulate_body_on_joint
from .ringing import STEPS_PER_PERIOD, VibratingJoint, VibrationTest, WorkingPoint, find_vibrating_joints

SIMULATED_PERIOD_COUNT = 60
"""Number of periods of a simulated decay [1]."""
FINAL_POSITION_PERIOD_COUNT = 10
"""Number of last periods [1], whose mean is the final position; friction shifts it from the working point."""
MAX_HALF_CYCLE_DECREMENT_OVER_DAMPING_RATIO = 2.0
"""Upper bound of the half-cycle decrement over the damping ratio [1].

The half-cycle decrement is the logarithm of the amplitude at the start of a half cycle over the mean
amplitude of this half cycle. The ratio is pi/2 for small damping, here with a margin."""
FREQUENCY_TOLERANCE = 5e-3
"""Relative tolerance [1] of the frequency in a window of a decay, against a loop of equal amplitude."""
DAMPING_TOLERANCE = 2e-2
"""Relative tolerance [1] of the damping in a window of a decay, against a loop of equal amplitude.

The damping is not compared in the first window, whose two periods take half of the amplitude.
"""
MIN_EVALUATED_OVER_INITIAL_AMPLITUDE = 0.01
"""Amplitude over the initial amplitude of a decay [1], below which the decay is not evaluated."""


@dataclass(frozen=True, slots=True)
class FreeDecay:
    """Simulated free decay of a body on a joint about one working point.

    joint_load            : load on the joint, in SI units
    amplitude             : (n) [m or rad], decreasing
    frequency             : (n) angular frequency [rad/s] at these amplitudes
    damping               : (n) damping ratio [1] at these amplitudes
    expected_frequency    : (n) angular frequency [rad/s] by the energy of the joint's loops about the final
        position
    expected_damping      : (n) damping ratio [1] by the same loops, with viscous damping
    half_loop_loss_factor : (n) half of the joint's output eta_loop [1]; None: the joint has no such output
    time                  : [s]
    deflection            : deflection from the working point [m or rad]
    log_messages          : log messages of the FMUs
    """

    joint_load: float
    amplitude: Array
    frequency: Array
    damping: Array
    expected_frequency: Array
    expected_damping: Array
    half_loop_loss_factor: Array | None
    time: Array
    deflection: Array
    log_messages: tuple[str, ...]


def simulate_example_decays(fmu_folder: Path) -> dict[str, list[FreeDecay]]:
    """Simulate free vibrations that decay by slip, for all shipped systems with one vibrating joint.

    Returns the simulated vibrations by the name of the system.

    fmu_folder : folder of the FMUs (FMI 2.0)
    """
    pulls = [
        (name, joint, joint.vibration_test.deflection_for_slip)
        for name, joint in find_vibrating_joints().items()
    ]
    return {
        name: simulate_decays(joint, fmu_folder, pull.deflection, [pull.joint_load])
        for name, joint, pull in pulls
    }


def simulate_decays(
    vibrating_joint: VibratingJoint,
    fmu_folder: Path,
    initial_deflection: float,
    joint_loads: Sequence[float] | None = None,
    inertia: float | None = None,
    joint_parameters: Mapping[str, object] | None = None,
) -> list[FreeDecay]:
    """Simulate free decays of the body of a system on its joint, one for each load.

    fmu_folder         : folder of the FMUs (FMI 2.0) of joint and body
    initial_deflection : [m or rad] from the working point
    joint_loads        : loads in SI units; None: the largest example load of the joint
    inertia            : [kg.m2 or kg] of the body; None: inertia in the system
    joint_parameters   : parameters of the joint that replace those of the system

    Raises ValueError if an FMU is missing or returns an error, or if too few periods can be resolved.
    """
    parameters = {**vibrating_joint.parameters, **(joint_parameters or {})}
    joint_loads = (
        [
            max(
                vibrating_joint.vibration_test.find_example_loads(
                    fmu_folder / f"{vibrating_joint.fmu_name}.fmu", parameters
                )
            )
        ]
        if joint_loads is None
        else joint_loads
    )
    inertia = vibrating_joint.inertia if inertia is None else inertia
    return [
        _simulate_decay(vibrating_joint, fmu_folder, load, parameters, inertia, initial_deflection)
        for load in track_progress(joint_loads, "ring", len(joint_loads))
    ]


def _simulate_decay(
    vibrating_joint: VibratingJoint,
    fmu_folder: Path,
    joint_load: float,
    joint_parameters: Mapping[str, Any],
    inertia: float,
    initial_deflection: float,
) -> FreeDecay:
    """Simulate the free decay at one load, and compute frequency and damping by the joint's loops."""
    body, path = vibrating_joint.vibration_test, fmu_folder / f"{vibrating_joint.fmu_name}.fmu"
    rest, partner = body.find_working_point(path, joint_load, joint_parameters), PARTNERS[body.body_model]
    states = [v.name for v in partner.outputs[: partner.state_count]]
    # away from zero: monotonic loading, as the FMU starts at zero
    pulled = rest.position + np.copysign(initial_deflection, rest.position)
    start = {vibrating_joint.inertia_parameter: inertia, states[0]: pulled}
    settings = {**joint_parameters, **body.find_start_values(joint_load)}
    step = 2.0 * np.pi / np.sqrt(rest.stiffness / inertia) / STEPS_PER_PERIOD
    with (
        Slave(
            path, {**settings, body.motion_inputs[0]: pulled}, body.motion_inputs, (body.force_output,)
        ) as slave,
        Slave(
            fmu_folder / f"{body.body_model}.fmu", start, [v.name for v in partner.inputs], states
        ) as moving,
    ):
        signal = (
            simulate_body_on_joint(
                slave, moving, rest.force, step, SIMULATED_PERIOD_COUNT * STEPS_PER_PERIOD
            )[:, 0]
            - rest.position
        )
        messages = tuple(dict.fromkeys(slave.log_messages + moving.log_messages))
    time = np.asarray(step * np.arange(signal.size), dtype=np.float64)
    points = decay.analyse_decay(time, signal, f"load = {joint_load:g}: ")
    is_resolved = points.motion_amplitude > MIN_EVALUATED_OVER_INITIAL_AMPLITUDE * initial_deflection
    amplitude = points.motion_amplitude[is_resolved]
    loop_amplitudes = amplitude * np.exp(
        MAX_HALF_CYCLE_DECREMENT_OVER_DAMPING_RATIO * points.damping_ratio[is_resolved]
    )
    settled = rest._replace(
        position=rest.position + float(np.mean(signal[-FINAL_POSITION_PERIOD_COUNT * STEPS_PER_PERIOD :]))
    )
    expected, stated, law = _evaluate_loops(
        path, settings, body, settled, inertia, amplitude, loop_amplitudes
    )
    frequency = 2.0 * np.pi * points.frequency[is_resolved]
    damping = points.damping_ratio[is_resolved]
    return FreeDecay(joint_load, amplitude, frequency, damping, expected, stated, law, time, signal, messages)


def _evaluate_loops(
    fmu_path: Path,
    joint_parameters: Mapping[str, object],
    vibration_test: VibrationTest,
    working_point: WorkingPoint,
    inertia: float,
    evaluated_amplitudes: Array,
    loop_amplitudes: Array,
) -> tuple[Array, Array, Array | None]:
    """Frequency (n) [rad/s] and damping ratio (n) [1] of a body by the energy of the joint's loops.

    Returns also half of the output `eta_loop` (n) [1].

    evaluated_amplitudes : (n) [m or rad] at which the loops are evaluated
    loop_amplitudes      : (n) [m or rad] of the simulated loops, a little larger
    """
    swing = loops.CyclicInputPath(centre_value=working_point.position, waveform="sine", cycle_count=1)
    run = loops.run_loops(
        fmu_path,
        vibration_test.motion_inputs[0],
        loop_amplitudes.tolist(),
        swing,
        vibration_test.force_output,
        joint_parameters,
    )
    results = [
        fit_masing_law(loop, working_point.damping).free_decay(np.array([a]), inertia)
        for loop, a in zip(run.loops, evaluated_amplitudes, strict=True)
    ]
    frequency, decrement = np.array(results)[:, :, 0].T
    deflection = np.abs(run.loops[0].displacements - working_point.position)
    eta = run.loops[0].path_result.variable_columns.get("eta_loop")
    first = slice(None, swing.points_per_cycle // 4 + 1)
    law = None if eta is None else 0.5 * np.interp(evaluated_amplitudes, deflection[first], eta[first])
    return frequency, decrement / np.hypot(np.pi, decrement), law


def fit_masing_law(hysteresis_loop: loops.HysteresisLoop, viscous_damping: float) -> HysteresisLaw:
    """Fit a hysteresis law that follows Masing's rule to a simulated hysteresis loop.

    The branch of the law is the mean of the rising and the falling branch of the loop.
    """
    motion = hysteresis_loop.displacements[hysteresis_loop.last_cycle_start_index :]
    force = hysteresis_loop.forces[hysteresis_loop.last_cycle_start_index :]
    half = motion.size // 2
    falling, rising = slice(None, half + 1), slice(half, None)
    deflection = 0.5 * (motion[0] - motion[falling])
    friction = 0.25 * (force[0] - force[falling] + force[rising] - force[half])
    curve = CubicSpline(deflection, friction)
    return HysteresisLaw(curve, curve.antiderivative(), viscous_damping=viscous_damping)
