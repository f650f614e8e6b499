"""Figures of joints in systems: resonance, free decay, joint loads over time, and tip error of an arm."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from jointfmu.joints import KINDS
from jointfmu.quantity import Array

from ..shown import format_unit
from ..systems.decays import Decay
from ..systems.ringing import Body, Ringing, VibratingJoint, stiffness_line, vibrating_joints
from ..systems.system import System
from ..systems.wiring import model_of, wires
from .figure import Figure, Panel, Series

RESONANCE_SIZE, DECAY_SIZE = (9.6, 4.0), (11.4, 3.8)
"""Sizes [inch] of the pictures of resonance and of free decay."""
_ENVELOPE_SIDES = ((1.0, "above"), (-1.0, "below"))
"""Sign and name of both envelopes."""


def resonance_figures(results: Mapping[str, Sequence[Ringing]], joint: str, folder: Path) -> list[Figure]:
    """Resonance figures of all systems with a joint of this kind.

    results : {system: results at each load}
    folder  : folder with the FMUs (FMI 2.0)
    """
    return [
        _resonance_figure(name, item, results[name], folder)
        for name, item in _vibrating_systems(joint)
        if name in results
    ]


def _vibrating_systems(joint: str) -> list[tuple[str, VibratingJoint]]:
    """Systems in which the vibrating joint is of this kind: (name, vibrating joint)."""
    return [(name, item) for name, item in vibrating_joints().items() if item.joint.kind == joint]


def _resonance_figure(
    name: str, vibrating_joint: VibratingJoint, points: Sequence[Ringing], folder: Path
) -> Figure:
    body, moving = vibrating_joint.body, vibrating_joint.moving.name
    return Figure(
        f"In a system: resonance of the {name.replace('_', ' ')} over its {body.load.name}",
        f"The {moving} vibrates freely about a working point, {body.doc}. First chart: resonance frequency; "
        "circles are peaks of the spectrum of the simulated signal, the line is the square root of "
        f"{body.stiffness} over the inertia of the {moving}. Second chart: free decay at the first "
        f"{body.load.name}, with the envelopes of the stated damping. Friction is left out.",
        resonance_panels(points, vibrating_joint, folder),
    )


def ring_down_figures(decays: Mapping[str, Sequence[Decay]], joint: str) -> list[Figure]:
    """Free-decay figures of all systems with a slipping joint of this kind."""
    return [
        _ring_down_figure(name, item, decays[name])
        for name, item in _vibrating_systems(joint)
        if name in decays
    ]


def _ring_down_figure(name: str, vibrating_joint: VibratingJoint, points: Sequence[Decay]) -> Figure:
    body, moving, (point, *_) = vibrating_joint.body, vibrating_joint.moving.name, points
    has_law = point.law is not None
    deflection = f"{body.deflection.factor * body.pull.deflection:g} {format_unit(body.deflection.unit)}"
    return Figure(
        f"In a system: free decay of the {name.replace('_', ' ')}",
        f"The {moving}, {body.doc}, is released from a deflection of {deflection} ({body.pull.doc}) at "
        f"{body.load.factor * point.load:g} {body.load.unit}. Circles: frequency and damping ratio of the "
        "simulated signal in windows of two to five periods, over the mean amplitude. Line: values from the "
        "energy loss of the joint's hysteresis loops of the same amplitude, with viscous damping"
        + (
            "; dashes: half of eta_loop, the law before its discretization into sliders. "
            if has_law
            else ". "
        )
        + "Because of friction the joint becomes stiffer and less damped as the amplitude decreases.",
        decay_panels(points, body),
    )


def resonance_panels(points: Sequence[Ringing], vibrating_joint: VibratingJoint, folder: Path) -> list[Panel]:
    """Panels: resonance over the load, and one free decay with the envelopes of the stated damping."""
    points, body = sorted(points, key=lambda point: point.load), vibrating_joint.body
    x = [body.load.factor * point.load for point in points]
    hertz = 0.5 / np.pi
    loads, expected = stiffness_line(vibrating_joint, folder, points)
    over = [
        Series("sqrt(K/J)", body.load.factor * loads, hertz * expected),
        Series("simulated", x, [hertz * p.frequency for p in points], "empty"),
    ]
    first, scale = points[0], body.deflection.factor
    envelope = scale * first.signal[0] * np.exp(-first.stated * first.expected * first.time)
    time = 1e3 * first.time
    decay = [Series("decay", time, scale * first.signal)]
    decay += [
        Series(f"envelope, {side}", time, sign * envelope, dashed=True) for sign, side in _ENVELOPE_SIDES
    ]
    return [
        Panel("Resonance over the load", body.load.label, "resonance [Hz]", over),
        Panel(f"Free decay at {x[0]:g} {body.load.unit}", "time [ms]", body.deflection.label, decay),
    ]


def decay_panels(points: Sequence[Decay], body: Body) -> list[Panel]:
    """Panels of the first free decay, and of frequency and damping over the amplitude.

    The results of the decay are compared with those of the joint's hysteresis loops.
    """
    scale, hertz, first = body.deflection.factor, 0.5 / np.pi, points[0]
    frequency, damping = [], []
    for point in points:
        load = f", {body.load.factor * point.load:g} {body.load.unit}" if len(points) > 1 else ""
        x = scale * point.amplitude
        frequency += [
            Series(f"loops{load}", x, hertz * point.expected),
            Series(f"decay{load}", x, hertz * point.frequency, "empty"),
        ]
        damping += [
            Series(f"loops{load}", x, 100.0 * point.stated),
            Series(f"decay{load}", x, 100.0 * point.damping, "empty"),
        ]
        if point.law is not None:
            damping.append(Series(f"eta_loop/2{load}", x, 100.0 * point.law, dashed=True))
    over = f"amplitude [{body.deflection.unit}]"
    signal = [Series("decay", 1e3 * first.time, scale * first.signal)]
    title = f"Decay at {body.load.factor * first.load:g} {body.load.unit}"
    return [
        Panel(title, "time [ms]", body.deflection.label, signal),
        Panel("Frequency over the amplitude", over, "frequency [Hz]", frequency),
        Panel("Damping over the amplitude", over, "damping ratio [%]", damping),
    ]


MOTION_SIZE = (11.4, 3.8)
"""Size [inch] of the picture of a simulated system."""
_PLOT_INTERVALS = 400
"""Number of intervals of a curve over time; the smallest and the largest point of each is drawn."""
SystemRun = Mapping[str, Array]
"""Results of a simulated system: {COMPONENT.OUTPUT: values (n)} and `time` (n) [s]."""


def output_units(system: System) -> dict[str, str]:
    """Units of all outputs and of `time`: {COMPONENT.OUTPUT: unit}."""
    outputs = {
        f"{name}.{v.name}": v.unit for name, part in system.components.items() for v in model_of(part).outputs
    }
    return {"time": "s"} | outputs


def joint_load_outputs(system: System) -> dict[str, tuple[str, str]]:
    """Outputs of the joints that act as force or torque on the connected body: {joint: (output, unit)}."""
    outputs = {}
    for wire in wires(system):
        if wire.source in system.joints:
            variable = KINDS[system.joints[wire.source].kind].variables[wire.output]
            outputs[wire.source] = (f"{wire.source}.{wire.output}", variable.unit)
    return outputs


def wind_up_and_tip_error(system: System, run: SystemRun) -> tuple[Array, Array, Array]:
    """Commanded angles and wind-up (times, axes) [rad] of an arm, and its tip error (times) [m].

    The tip error is the distance between the tip at the angles of the links and at the commanded angles.
    """
    commanded, links = [], []
    for name in system.arm.names:
        drive = system.joints[f"{name}_drive"]
        assert drive.file
        commanded.append(run[f"{name}_motor.phi"] / drive.file.values_by_name["ratio"])
        links.append(run[f"{name}_link.phi"])
    q, real = np.stack(commanded, axis=1), np.stack(links, axis=1)
    error = np.linalg.norm(system.arm.tip(real) - system.arm.tip(q), axis=1)
    return q, real - q, error


def _thin_series(name: str, time: Array, values: Array) -> Series:
    """Series with the smallest and the largest point of each of _PLOT_INTERVALS intervals."""
    size = -(-values.size // _PLOT_INTERVALS)
    intervals = [(k, values[k : k + size]) for k in range(0, values.size, size)]
    indices = sorted({k + int(f(interval)) for k, interval in intervals for f in (np.argmin, np.argmax)})
    return Series(name, time[indices], values[indices])


def system_panels(system: System, run: SystemRun) -> list[Panel]:
    """Panels of the joint loads over time; for an arm also of wind-up and tip error."""
    over = "time [s]"
    outputs = joint_load_outputs(system)
    unit = " or ".join(dict.fromkeys(unit for _, unit in outputs.values()))
    curves = [
        _thin_series(name.removesuffix("_drive"), run["time"], run[output])
        for name, (output, _) in outputs.items()
    ]
    charts = [Panel("Loads of the joints", over, f"load [{unit}]", curves)]
    if system.arm:
        _, wind_up, error = wind_up_and_tip_error(system, run)
        curves = [
            _thin_series(name, run["time"], 1e3 * values)
            for name, values in zip(system.arm.names, wind_up.T, strict=True)
        ]
        charts.append(Panel("Wind-up of the drives", over, "wind-up [mrad]", curves))
        tip = [_thin_series("tip", run["time"], 1e3 * error)]
        charts.append(Panel("Error of the tip", over, "error [mm]", tip))
    return charts


def motion_figures(runs: Mapping[str, tuple[System, SystemRun]], joint: str) -> list[Figure]:
    """Figures of the motion of all arms that have a joint of this kind."""
    return [
        _motion_figure(system, run)
        for system, run in runs.values()
        if joint in {part.kind for part in system.joints.values()}
    ]


def _motion_figure(system: System, run: SystemRun) -> Figure:
    _, wind_up, error = wind_up_and_tip_error(system, run)
    (largest, worst) = np.max(np.abs(wind_up), axis=0), float(np.max(error))
    soft = system.arm.names[int(np.argmax(largest))]
    return Figure(
        f"In a system: the {system.name.replace('_', ' ')}",
        f"The motors move the arm from the upright pose to the final pose within {system.arm.duration:g} s. "
        "Charts: torques of the drives on their links; wind-up of the drives; tip error, the distance of the "
        f"tip from its position with rigid drives. The tip error is at most {1e3 * worst:.2f} mm, and "
        f"{1e3 * error[-1]:.2f} mm at the end, under the weight. The {soft} has the largest wind-up, "
        f"{1e3 * np.max(largest):.2f} mrad. The loads of the drives are those of a rigid arm: the effect of "
        "one drive's wind-up on the other drives is neglected.",
        system_panels(system, run),
    )
