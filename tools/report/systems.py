"""Figures of joints in systems, and of what a system does over time; of an arm also the tip's error."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from jointfmu.joints import KINDS
from jointfmu.quantity import Array

from ..shown import spelled
from ..systems.decays import Decay
from ..systems.ringing import Body, Ringing, VibratingJoint, stiffness_line, vibrating_joints
from ..systems.system import System
from ..systems.wiring import model_of, wires
from .figure import Figure, Panel, Series

SIZE, WIDE = (9.6, 4.0), (11.4, 3.8)
_WAYS = ((1.0, "above"), (-1.0, "below"))


def resonances(found: Mapping[str, Sequence[Ringing]], joint: str, folder: Path) -> list[Figure]:
    """A figure per system of a joint that rings; `folder` has the FMUs (FMI 2.0)."""
    return [_resonance(name, one, found[name], folder) for name, one in _ringing(joint) if name in found]


def _ringing(joint: str) -> list[tuple[str, VibratingJoint]]:
    """The systems in which a joint of the kind rings."""
    return [(name, one) for name, one in vibrating_joints().items() if one.joint.kind == joint]


def _resonance(name: str, one: VibratingJoint, points: Sequence[Ringing], folder: Path) -> Figure:
    body, moving = one.body, one.moving.name
    return Figure(
        f"In a system: resonance of the {name.replace('_', ' ')} over its {body.load.name}",
        f"The {moving} rings about a working point, {body.doc}. Circles: peak of the simulated signal's "
        f"spectrum; line: square root of {body.stiffness} over the {moving}'s inertia. Then the decay at "
        f"the first {body.load.name}, between the envelopes of the stated damping. Friction is left out.",
        resonance_panels(points, one, folder),
    )


def ring_downs(decays: Mapping[str, Sequence[Decay]], joint: str) -> list[Figure]:
    """A figure per system of a joint that slips."""
    return [_ring_down(name, one, decays[name]) for name, one in _ringing(joint) if name in decays]


def _ring_down(name: str, one: VibratingJoint, points: Sequence[Decay]) -> Figure:
    body, moving, (point, *_) = one.body, one.moving.name, points
    said = point.law is not None
    pulled = f"{body.deflection.factor * body.pull.deflection:g} {spelled(body.deflection.unit)}"
    return Figure(
        f"In a system: ring-down of the {name.replace('_', ' ')}",
        f"The {moving}, {body.doc}, is pulled by {pulled} ({body.pull.doc}) at "
        f"{body.load.factor * point.load:g} {body.load.unit} and let go. Circles: frequency and damping "
        "ratio in windows of two to five periods of the simulated signal, over the amplitude in their "
        "middle; line: what the energy of the joint's own loops of that amplitude demands, viscous damping "
        "included"
        + ("; dashes: half of eta_loop, the law without its division into sliders. " if said else ". ")
        + "The joint's friction alone makes it stiffer and less damped as the motion dies out.",
        decay_panels(points, body),
    )


def resonance_panels(points: Sequence[Ringing], one: VibratingJoint, folder: Path) -> list[Panel]:
    """Resonance over the load, and one free decay with the envelope of the stated damping."""
    points, body = sorted(points, key=lambda point: point.load), one.body
    x = [body.load.factor * point.load for point in points]
    hertz = 0.5 / np.pi
    loads, expected = stiffness_line(one, folder, points)
    over = [
        Series("sqrt(K/J)", body.load.factor * loads, hertz * expected),
        Series("simulated", x, [hertz * p.frequency for p in points], "empty"),
    ]
    first, scale = points[0], body.deflection.factor
    envelope = scale * first.signal[0] * np.exp(-first.stated * first.expected * first.time)
    time = 1e3 * first.time
    decay = [Series("decay", time, scale * first.signal)]
    decay += [Series(f"envelope, {way}", time, sign * envelope, dashed=True) for sign, way in _WAYS]
    return [
        Panel("Resonance over the load", body.load.label, "resonance [Hz]", over),
        Panel(f"Free decay at {x[0]:g} {body.load.unit}", "time [ms]", body.deflection.label, decay),
    ]


def decay_panels(points: Sequence[Decay], body: Body) -> list[Panel]:
    """The first decay; frequency and damping over the amplitude, with those of the joint's loops."""
    scale, hertz, first = body.deflection.factor, 0.5 / np.pi, points[0]
    frequency, damping = [], []
    for point in points:
        at = f", {body.load.factor * point.load:g} {body.load.unit}" if len(points) > 1 else ""
        x = scale * point.amplitude
        frequency += [
            Series(f"loops{at}", x, hertz * point.expected),
            Series(f"decay{at}", x, hertz * point.frequency, "empty"),
        ]
        damping += [
            Series(f"loops{at}", x, 100.0 * point.stated),
            Series(f"decay{at}", x, 100.0 * point.damping, "empty"),
        ]
        if point.law is not None:
            damping.append(Series(f"eta_loop/2{at}", x, 100.0 * point.law, dashed=True))
    over = f"amplitude [{body.deflection.unit}]"
    signal = [Series("decay", 1e3 * first.time, scale * first.signal)]
    shown = f"Decay at {body.load.factor * first.load:g} {body.load.unit}"
    return [
        Panel(shown, "time [ms]", body.deflection.label, signal),
        Panel("Frequency over the amplitude", over, "frequency [Hz]", frequency),
        Panel("Damping over the amplitude", over, "damping ratio [%]", damping),
    ]


MOTION_SIZE = (11.4, 3.8)
_STRETCHES = 400
"""Of a run: of each its least and its greatest point are drawn."""
Run = Mapping[str, Array]
"""{COMPONENT.OUTPUT: values} and `time` [s]."""


def units(system: System) -> dict[str, str]:
    """{COMPONENT.OUTPUT: unit} of all outputs, and of `time`."""
    outputs = {
        f"{name}.{v.name}": v.unit for name, part in system.components.items() for v in model_of(part).outputs
    }
    return {"time": "s"} | outputs


def loads(system: System) -> dict[str, tuple[str, str]]:
    """{joint: (name of its output, unit)} of the force or torque on the body behind it."""
    found = {}
    for wire in wires(system):
        if wire.source in system.joints:
            variable = KINDS[system.joints[wire.source].kind].variables[wire.output]
            found[wire.source] = (f"{wire.source}.{wire.output}", variable.unit)
    return found


def windup(system: System, run: Run) -> tuple[Array, Array, Array]:
    """Of an arm: commanded angles and wind-up (times, axes) [rad], and the tip's error (times) [m], the
    distance between its place at the links' angles and at the commanded ones."""
    commanded, links = [], []
    for name in system.arm.names:
        drive = system.joints[f"{name}_drive"]
        assert drive.file
        commanded.append(run[f"{name}_motor.phi"] / drive.file.flat["ratio"])
        links.append(run[f"{name}_link.phi"])
    q, real = np.stack(commanded, axis=1), np.stack(links, axis=1)
    error = np.linalg.norm(system.arm.tip(real) - system.arm.tip(q), axis=1)
    return q, real - q, error


def _drawn(name: str, time: Array, values: Array) -> Series:
    size = -(-values.size // _STRETCHES)
    stretches = [(k, values[k : k + size]) for k in range(0, values.size, size)]
    kept = sorted({k + int(f(part)) for k, part in stretches for f in (np.argmin, np.argmax)})
    return Series(name, time[kept], values[kept])


def panels(system: System, run: Run) -> list[Panel]:
    """Loads of the joints over time; of an arm wind-up and the tip's error beside them."""
    over = "time [s]"
    shown = loads(system)
    unit = " or ".join(dict.fromkeys(unit for _, unit in shown.values()))
    carried = [
        _drawn(name.removesuffix("_drive"), run["time"], run[output]) for name, (output, _) in shown.items()
    ]
    found = [Panel("Loads of the joints", over, f"load [{unit}]", carried)]
    if system.arm:
        _, wound, error = windup(system, run)
        turned = [
            _drawn(name, run["time"], 1e3 * values)
            for name, values in zip(system.arm.names, wound.T, strict=True)
        ]
        found.append(Panel("Wind-up of the drives", over, "wind-up [mrad]", turned))
        tip = [_drawn("tip", run["time"], 1e3 * error)]
        found.append(Panel("Error of the tip", over, "error [mm]", tip))
    return found


def motions(runs: Mapping[str, tuple[System, Run]], joint: str) -> list[Figure]:
    """A figure for each arm with such joints."""
    return [
        _motion(system, run)
        for system, run in runs.values()
        if joint in {part.kind for part in system.joints.values()}
    ]


def _motion(system: System, run: Run) -> Figure:
    _, wound, error = windup(system, run)
    (largest, worst) = np.max(np.abs(wound), axis=0), float(np.max(error))
    soft = system.arm.names[int(np.argmax(largest))]
    return Figure(
        f"In a system: the {system.name.replace('_', ' ')}",
        f"The motors turn from upright to the end of the motion within {system.arm.duration:g} s. Torques of "
        "the drives on their links; what the drives wind up; distance of the tip from where rigid drives "
        f"would bring it, at most {1e3 * worst:.2f} mm, {1e3 * error[-1]:.2f} mm at the end, under the "
        f"weight. The {soft} winds up most, by {1e3 * np.max(largest):.2f} mrad. Motion and weight of the "
        "rigid arm load the drives; that the wind-up of one moves the others is left out.",
        panels(system, run),
    )
