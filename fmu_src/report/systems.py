"""Figures of joints in systems."""

from collections.abc import Sequence
from functools import partial
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from ..drawing import BLUE, GREY, RED, labels, svg
from ..ringing import Ringing

SIZE = (9.6, 4.0)


class Axes(NamedTuple):
    """Names of load and deflection with the units shown, and the factors from SI to these."""

    load: str
    load_factor: float
    deflection: str
    deflection_factor: float


AXES = {
    "robot_joint": Axes("torque [N m]", 1.0, "wind-up [urad]", 1e6),
    "bolted_column": Axes("preload [kN]", 1e-3, "motion [nm]", 1e9),
}


def ringing(found: Sequence[Ringing], system: str) -> str:
    """The figure of `draw` as inline SVG."""
    return svg(partial(draw, found=found, system=system), SIZE)


def draw(figure: Figure, found: Sequence[Ringing], system: str) -> None:
    """Resonance over the load, and one free decay with the envelope of the stated damping."""
    axes = AXES[system]
    left, right = figure.subplots(1, 2)
    points = sorted(found, key=lambda point: point.load)
    x = [axes.load_factor * point.load for point in points]
    left.plot(x, [p.expected / (2.0 * np.pi) for p in points], color=BLUE, label="sqrt(K/J)")
    peaks = [p.frequency / (2.0 * np.pi) for p in points]
    left.plot(x, peaks, "o", color=RED, mfc="white", label="simulated", clip_on=False, zorder=3)
    left.legend()
    labels(left, axes.load, "resonance [Hz]")
    if min(x) < 0.0:
        left.set_xlim(left=None, auto=True)
    first, scale = points[0], axes.deflection_factor
    envelope = first.signal[0] * np.exp(-first.stated * first.expected * first.time)
    right.plot(1e3 * first.time, scale * first.signal, color=BLUE)
    for sign in (1.0, -1.0):
        right.plot(1e3 * first.time, sign * scale * envelope, "--", color=GREY)
    right.set_title(
        f"free decay at {axes.load_factor * first.load:g} {axes.load.split('[')[1][:-1]}", fontsize=10
    )
    right.set_xlabel("time [ms]")
    right.set_ylabel(axes.deflection)
    right.set_xlim(left=0.0)
