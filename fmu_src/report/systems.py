"""Figures of joints in systems."""

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np
from matplotlib.figure import Figure as Canvas

from jointfmu.systems import System, system

from ..drawing import BLUE, GREY, RED, labels, svg
from ..ringing import Body, Ringing, body_on
from .figure import Figure

SIZE = (9.6, 4.0)


def resonances(rings: Mapping[str, Sequence[Ringing]]) -> list[Figure]:
    """A figure per system that rings."""
    return [_resonance(name, system(name), points) for name, points in rings.items()]


def _resonance(name: str, example: System, points: Sequence[Ringing]) -> Figure:
    body = body_on(example.joint)
    moving = example.body.partition(".")[0]
    return Figure(
        f"In a system: resonance of the {name.replace('_', ' ')} over its {body.load.name}",
        f"The {moving} rings about a working point, {body.doc}. Circles: peak of the simulated signal's "
        f"spectrum; line: square root of {body.stiffness} over the {moving}'s inertia. Right: the decay at "
        f"the first {body.load.name}, between the envelopes of the stated damping.",
        svg(partial(draw, points=points, body=body), SIZE),
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
