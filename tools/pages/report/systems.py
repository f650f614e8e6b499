"""Figures of joints in systems: resonance, free decay, joint loads over time, and tip error of an arm."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from jointfmu.joints import KINDS
from jointfmu.quantity import Array

from ...common.shown import format_unit
from ...systems.decays import FreeDecay
from ...systems.ringing import (
    FreeVibration,
    VibratingJoint,
    VibrationTest,
    compute_frequency_curve,
    find_vibrating_joints,
)
from ...systems.system import System
from ...systems.wiring import find_model, find_signals
from .figure import Figure, Panel, Series

RESONANCE_FIGURE_SIZE, DECAY_FIGURE_SIZE = (9.6, 4.0), (11.4, 3.8)
"""Sizes [inch] of the pictures of resonance and of free decay."""
_ENVELOPE_SIDES = ((1.0, "above"), (-1.0, "below"))
"""Sign and name of both envelopes of a decaying vibration."""


def resonance_figures(
    vibrations_by_system: Mapping[str, Sequence[FreeVibration]], joint_name: str, fmu_folder: Path
) -> list[Figure]:
    """Resonance figures of all systems in which a joint of this kind vibrates with a body.
    vibrations_by_system : {system: results at each load}
    fmu_folder           : folder with the FMUs (FMI 2.0)
    """
    return [
        _resonance_figure(name, item, vibrations_by_system[name], fmu_folder)
        for name, item in _vibrating_systems(joint_name)
        if name in vibrations_by_system
    ]


def _vibrating_systems(joint_name: str) -> list[tuple[str, VibratingJoint]]:
    """Systems whose vibrating joint is of the kind `joint_name`: (name of the system, vibrating joint)."""
    return [
        (name, item) for name, item in find_vibrating_joints().items() if item.joint.joint_kind == joint_name
    ]


def _resonance_figure(
    system_name: str,
    vibrating_joint: VibratingJoint,
    free_vibrations: Sequence[FreeVibration],
    fmu_folder: Path,
) -> Figure:
    """Figure of the resonance frequency of one system as a function of the joint's load."""
    body, moving = vibrating_joint.vibration_test, vibrating_joint.moving_body.name
    return Figure(
        f"In a system: resonance of the {system_name.replace('_', ' ')} over its "
        f"{body.load_axis.quantity_name}",
        f"The {moving} vibrates freely about a working point, {body.support_description}. First chart: "
        "resonance frequency; circles are peaks of the spectrum of the simulated signal, the line is the "
        f"square root of {body.stiffness_output} over the inertia of the {moving}. Second chart: free decay "
        f"at the first {body.load_axis.quantity_name}, with the envelopes of the stated damping. Friction is "
        "left out.",
        resonance_charts(free_vibrations, vibrating_joint, fmu_folder),
    )


def ring_down_figures(free_decays: Mapping[str, Sequence[FreeDecay]], joint_name: str) -> list[Figure]:
    """Figures of the free decay of all systems with a slipping joint of this kind."""
    return [
        _ring_down_figure(name, item, free_decays[name])
        for name, item in _vibrating_systems(joint_name)
        if name in free_decays
    ]


def _ring_down_figure(
    system_name: str, vibrating_joint: VibratingJoint, free_decays: Sequence[FreeDecay]
) -> Figure:
    """Figure of the free decay of one system with a slipping joint."""
    body, moving, (point, *_) = vibrating_joint.vibration_test, vibrating_joint.moving_body.name, free_decays
    has_law = point.half_loop_loss_factor is not None
    deflection = (
        f"{body.deflection_axis.display_factor * body.deflection_for_slip.deflection:g} "
        f"{format_unit(body.deflection_axis.unit)}"
    )
    return Figure(
        f"In a system: free decay of the {system_name.replace('_', ' ')}",
        f"The {moving}, {body.support_description}, is released from a deflection of {deflection} "
        f"({body.deflection_for_slip.description}) at {body.load_axis.display_factor * point.joint_load:g} "
        f"{body.load_axis.unit}. Circles: frequency and damping ratio of the simulated signal in windows of "
        "two to five periods, over the mean amplitude. Line: values from the energy loss of the joint's "
        "hysteresis loops of the same amplitude, with viscous damping"
        + (
            "; dashes: half of eta_loop, the law before its discretization into sliders. "
            if has_law
            else ". "
        )
        + "Because of friction the joint becomes stiffer and less damped as the amplitude decreases.",
        decay_charts(free_decays, body),
    )


def resonance_charts(
    free_vibrations: Sequence[FreeVibration], vibrating_joint: VibratingJoint, fmu_folder: Path
) -> list[Panel]:
    """Charts: resonance frequency against load; one free decay, with envelopes of the joint's damping."""
    free_vibrations, body = (
        sorted(free_vibrations, key=lambda point: point.joint_load),
        vibrating_joint.vibration_test,
    )
    x = [body.load_axis.display_factor * point.joint_load for point in free_vibrations]
    hertz = 0.5 / np.pi
    loads, expected = compute_frequency_curve(vibrating_joint, fmu_folder, free_vibrations)
    over = [
        Series("sqrt(K/J)", body.load_axis.display_factor * loads, hertz * expected),
        Series("simulated", x, [hertz * p.frequency for p in free_vibrations], "empty"),
    ]
    first, scale = free_vibrations[0], body.deflection_axis.display_factor
    envelope = (
        scale * first.deflection[0] * np.exp(-first.expected_damping * first.expected_frequency * first.time)
    )
    time = 1e3 * first.time
    decay = [Series("decay", time, scale * first.deflection)]
    decay += [
        Series(f"envelope, {side}", time, sign * envelope, is_dashed=True) for sign, side in _ENVELOPE_SIDES
    ]
    return [
        Panel("Resonance over the load", body.load_axis.axis_label, "resonance [Hz]", over),
        Panel(
            f"Free decay at {x[0]:g} {body.load_axis.unit}",
            "time [ms]",
            body.deflection_axis.axis_label,
            decay,
        ),
    ]


def decay_charts(free_decays: Sequence[FreeDecay], vibration_test: VibrationTest) -> list[Panel]:
    """Charts of the first free decay, and of frequency and damping against amplitude.

    The results of the decay are compared with those of the joint's hysteresis loops.
    """
    scale, hertz, first = vibration_test.deflection_axis.display_factor, 0.5 / np.pi, free_decays[0]
    frequency, damping = [], []
    for point in free_decays:
        load = (
            f", {vibration_test.load_axis.display_factor * point.joint_load:g} "
            f"{vibration_test.load_axis.unit}"
            if len(free_decays) > 1
            else ""
        )
        x = scale * point.amplitude
        frequency += [
            Series(f"loops{load}", x, hertz * point.expected_frequency),
            Series(f"decay{load}", x, hertz * point.frequency, "empty"),
        ]
        damping += [
            Series(f"loops{load}", x, 100.0 * point.expected_damping),
            Series(f"decay{load}", x, 100.0 * point.damping, "empty"),
        ]
        if point.half_loop_loss_factor is not None:
            damping.append(
                Series(f"eta_loop/2{load}", x, 100.0 * point.half_loop_loss_factor, is_dashed=True)
            )
    over = f"amplitude [{vibration_test.deflection_axis.unit}]"
    signal = [Series("decay", 1e3 * first.time, scale * first.deflection)]
    load_axis = vibration_test.load_axis
    title = f"Decay at {load_axis.display_factor * first.joint_load:g} {load_axis.unit}"
    return [
        Panel(title, "time [ms]", vibration_test.deflection_axis.axis_label, signal),
        Panel("Frequency over the amplitude", over, "frequency [Hz]", frequency),
        Panel("Damping over the amplitude", over, "damping ratio [%]", damping),
    ]


MOTION_FIGURE_SIZE = (11.4, 3.8)
"""Size [inch] of the picture of a simulated system."""
_PLOT_INTERVALS = 400
"""Number of intervals of a curve over time; the smallest and the largest point of each is drawn."""
SystemResults = Mapping[str, Array]
"""Results of a simulated system: {COMPONENT.OUTPUT: values (n)} and `time` (n) [s]."""


def list_output_units(system: System) -> dict[str, str]:
    """Units of all outputs, of the tip of an arm, and of `time`: {COMPONENT.OUTPUT: unit}."""
    outputs = {
        f"{name}.{v.name}": v.unit
        for name, part in system.components.items()
        for v in find_model(part).outputs
    }
    if system.arm:
        outputs |= dict.fromkeys((f"tip.{x}" for x in "xyz"), "m")
    return {"time": "s"} | outputs


def joint_load_outputs(system: System) -> dict[str, tuple[str, str]]:
    """Outputs of the joints that act as force or torque on the connected body: {joint: (output, unit)}."""
    outputs = {}
    for wire in find_signals(system):
        if wire.source_component in system.joints:
            variable = KINDS[system.joints[wire.source_component].joint_kind].variables[wire.source_output]
            outputs[wire.source_component] = (f"{wire.source_component}.{wire.source_output}", variable.unit)
    return outputs


def wind_up_and_tip_error(system: System, system_results: SystemResults) -> tuple[Array, Array, Array]:
    """Commanded angles and wind-up (times, axes) [rad] of an arm, and its tip error (times) [m].

    The tip error is the distance between the tip at the angles of the links and at the commanded angles.
    """
    commanded, links = [], []
    for name in system.arm.axis_names:
        drive = system.joints[f"{name}_drive"]
        assert drive.parameter_file
        commanded.append(system_results[f"{name}_motor.phi"] / drive.parameter_file.values_by_name["ratio"])
        links.append(system_results[f"{name}_link.phi"])
    q, real = np.stack(commanded, axis=1), np.stack(links, axis=1)
    error = np.linalg.norm(system.arm.compute_tip_position(real) - system.arm.compute_tip_position(q), axis=1)
    return q, real - q, error


def _thin_out_series(series_name: str, time: Array, series_values: Array) -> Series:
    """Series with the smallest and the largest point of each of _PLOT_INTERVALS intervals."""
    size = -(-series_values.size // _PLOT_INTERVALS)
    intervals = [(k, series_values[k : k + size]) for k in range(0, series_values.size, size)]
    indices = sorted({k + int(f(interval)) for k, interval in intervals for f in (np.argmin, np.argmax)})
    return Series(series_name, time[indices], series_values[indices])


def system_charts(system: System, system_results: SystemResults) -> list[Panel]:
    """Charts of the joint loads over time; for an arm also of wind-up and tip error."""
    over = "time [s]"
    outputs = joint_load_outputs(system)
    unit = " or ".join(dict.fromkeys(unit for _, unit in outputs.values()))
    curves = [
        _thin_out_series(name.removesuffix("_drive"), system_results["time"], system_results[output])
        for name, (output, _) in outputs.items()
    ]
    charts = [Panel("Loads of the joints", over, f"load [{unit}]", curves)]
    if system.arm:
        _, wind_up, error = wind_up_and_tip_error(system, system_results)
        curves = [
            _thin_out_series(name, system_results["time"], 1e3 * values)
            for name, values in zip(system.arm.axis_names, wind_up.T, strict=True)
        ]
        charts.append(Panel("Wind-up of the drives", over, "wind-up [mrad]", curves))
        tip = [_thin_out_series("tip", system_results["time"], 1e3 * error)]
        charts.append(Panel("Error of the tip", over, "error [mm]", tip))
    return charts


def motion_figures(
    results_by_system: Mapping[str, tuple[System, SystemResults]], joint_name: str
) -> list[Figure]:
    """Figures of the motion of all arms that have a joint of this kind."""
    return [
        _motion_figure(system, run)
        for system, run in results_by_system.values()
        if joint_name in {part.joint_kind for part in system.joints.values()}
    ]


def _motion_figure(system: System, system_results: SystemResults) -> Figure:
    """Figure of the simulated motion of an arm."""
    _, wind_up, error = wind_up_and_tip_error(system, system_results)
    (largest, worst) = np.max(np.abs(wind_up), axis=0), float(np.max(error))
    soft = system.arm.axis_names[int(np.argmax(largest))]
    return Figure(
        f"In a system: the {system.name.replace('_', ' ')}",
        "The motors move the arm from the upright pose to the final pose within "
        f"{system.arm.motion_duration:g} s. Charts: torques of the drives on their links; wind-up of the "
        "drives; tip error, the distance of the tip from its position with rigid drives. The tip error is "
        f"at most {1e3 * worst:.2f} mm, and {1e3 * error[-1]:.2f} mm at the end, under the weight. The "
        f"{soft} has the largest wind-up, {1e3 * np.max(largest):.2f} mrad. The links are coupled, with "
        "weight, Coriolis and gyroscopic terms.",
        system_charts(system, system_results),
    )
