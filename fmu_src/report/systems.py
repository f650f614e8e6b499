"""Figures of joints in systems."""

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np
from matplotlib.figure import Figure as Canvas

from ..decays import Decay
from ..drawing import BLUE, GREY, RED, labels, svg
from ..ringing import Body, Ringing, Rung, rings
from .figure import Figure

SIZE, WIDE = (9.6, 4.0), (11.4, 3.8)


def resonances(found: Mapping[str, Sequence[Ringing]]) -> list[Figure]:
    """A figure per system that rings."""
    bodies = rings()
    return [_resonance(name, bodies[name], points) for name, points in found.items()]


def _resonance(name: str, one: Rung, points: Sequence[Ringing]) -> Figure:
    body, moving = one.body, one.moving.name
    return Figure(
        f"In a system: resonance of the {name.replace('_', ' ')} over its {body.load.name}",
        f"The {moving} rings about a working point, {body.doc}. Circles: peak of the simulated signal's "
        f"spectrum; line: square root of {body.stiffness} over the {moving}'s inertia. Right: the decay at "
        f"the first {body.load.name}, between the envelopes of the stated damping. Friction is left out.",
        svg(partial(draw, points=points, body=body), SIZE),
    )


def ring_downs(decays: Mapping[str, Sequence[Decay]]) -> list[Figure]:
    """A figure per system whose joint slips."""
    bodies = rings()
    return [_ring_down(name, bodies[name], points) for name, points in decays.items()]


def _ring_down(name: str, one: Rung, points: Sequence[Decay]) -> Figure:
    body, moving, (point, *_) = one.body, one.moving.name, points
    said = point.law is not None
    pulled = f"{body.deflection.factor * body.pull.deflection:g} {body.deflection.unit}"
    return Figure(
        f"In a system: ring-down of the {name.replace('_', ' ')}",
        f"The {moving}, {body.doc}, is pulled by {pulled} ({body.pull.doc}) at "
        f"{body.load.factor * point.load:g} {body.load.unit} and let go. Circles: frequency and damping "
        "ratio in windows of two to five periods of the simulated signal, over the amplitude in their "
        "middle; line: what the energy of the joint's own loops of that amplitude demands, viscous damping "
        "included"
        + ("; dashes: half of eta_loop, the law without its division into sliders. " if said else ". ")
        + "The joint's friction alone makes it stiffer and less damped as the motion dies out.",
        svg(partial(draw_decays, points=points, body=body), WIDE),
    )


def draw(canvas: Canvas, points: Sequence[Ringing], body: Body) -> None:
    """Resonance over the load, and one free decay with the envelope of the stated damping."""
    left, right = canvas.subplots(1, 2)
    points = sorted(points, key=lambda point: point.load)
    x = [body.load.factor * point.load for point in points]
    left.plot(x, [p.expected / (2.0 * np.pi) for p in points], color=BLUE, label="sqrt(K/J)")
    peaks = [p.frequency / (2.0 * np.pi) for p in points]
    left.plot(x, peaks, "o", color=RED, mfc="white", label="simulated", clip_on=False, zorder=3)
    left.legend()
    labels(left, body.load.label, "resonance [Hz]")
    if min(x) < 0.0:
        left.set_xlim(left=None, auto=True)
    first, scale = points[0], body.deflection.factor
    envelope = first.signal[0] * np.exp(-first.stated * first.expected * first.time)
    right.plot(1e3 * first.time, scale * first.signal, color=BLUE)
    for sign in (1.0, -1.0):
        right.plot(1e3 * first.time, sign * scale * envelope, "--", color=GREY)
    right.set_title(f"free decay at {x[0]:g} {body.load.unit}", fontsize=10)
    right.set_xlabel("time [ms]")
    right.set_ylabel(body.deflection.label)
    right.set_xlim(left=0.0)


def draw_decays(canvas: Canvas, points: Sequence[Decay], body: Body) -> None:
    """The first decay; frequency and damping over the amplitude, with those of the joint's loops."""
    left, middle, right = canvas.subplots(1, 3)
    scale = body.deflection.factor
    left.plot(1e3 * points[0].time, scale * points[0].signal, color=BLUE, lw=0.8)
    left.set_title(f"{body.load.factor * points[0].load:g} {body.load.unit}", fontsize=10)
    left.set_xlabel("time [ms]")
    left.set_ylabel(body.deflection.label)
    left.set_xlim(left=0.0)
    for k, point in enumerate(points):
        hertz = 0.5 / np.pi
        shown = (
            (middle, hertz * point.frequency, hertz * point.expected),
            (right, 100.0 * point.damping, 100.0 * point.stated),
        )
        for axes, found, loops in shown:
            axes.plot(scale * point.amplitude, loops, color=BLUE, label="" if k else "loops")
            axes.plot(scale * point.amplitude, found, "o", color=RED, mfc="white", label="" if k else "decay")
        if point.law is not None:
            label = "" if k else "eta_loop/2"
            right.plot(scale * point.amplitude, 100.0 * point.law, "--", color=GREY, label=label)
            right.legend()
    for axes, label in ((middle, "frequency [Hz]"), (right, "damping ratio [%]")):
        axes.set_xlabel(f"amplitude [{body.deflection.unit}]")
        axes.set_ylabel(label)
        axes.set_xlim(left=0.0)
    right.set_ylim(bottom=0.0)
    middle.legend()
