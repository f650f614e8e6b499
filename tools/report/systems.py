"""Figures of joints in systems."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure as Canvas

from ..shown import spelled
from ..systems.decays import Decay
from ..systems.ringing import Body, Ringing, VibratingJoint, stiffness_line, vibrating_joints
from .figure import Figure, Panel, Series, drawn

SIZE, WIDE = (9.6, 4.0), (11.4, 3.8)
_WAYS = ((1.0, "above"), (-1.0, "below"))


def resonances(found: Mapping[str, Sequence[Ringing]], joint: str, folder: Path) -> list[Figure]:
    """A figure per system of a joint that rings; `folder` has the FMUs (FMI 2.0)."""
    bodies = {name: one for name, one in vibrating_joints().items() if one.joint.kind == joint}
    return [
        _resonance(name, bodies[name], points, folder) for name, points in found.items() if name in bodies
    ]


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
    bodies = {name: one for name, one in vibrating_joints().items() if one.joint.kind == joint}
    return [_ring_down(name, bodies[name], points) for name, points in decays.items() if name in bodies]


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


def draw(canvas: Canvas, points: Sequence[Ringing], one: VibratingJoint, folder: Path) -> None:
    """Resonance and decay as a picture; `folder` has the FMUs (FMI 2.0)."""
    drawn(canvas, resonance_panels(points, one, folder))


def draw_decays(canvas: Canvas, points: Sequence[Decay], body: Body) -> None:
    """Frequency and damping over the amplitude as a picture."""
    drawn(canvas, decay_panels(points, body))
