"""Figures of joints in systems."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from ..drawing import BLUE, GREY, RED, labels, svg
from ..ringing import Ringing


def ringing(found: Sequence[Ringing], load: str, factor: float, deflection: str, scale: float) -> str:
    """Resonance over the load, and one free decay with the envelope of the stated damping."""

    def draw(figure: Figure) -> None:
        left, right = figure.subplots(1, 2)
        x = [factor * point.load for point in found]
        left.plot(x, [p.expected / (2.0 * np.pi) for p in found], color=BLUE, label="sqrt(K/J)")
        peaks = [p.frequency / (2.0 * np.pi) for p in found]
        left.plot(x, peaks, "o", color=RED, mfc="white", label="simulated")
        left.legend()
        labels(left, load, "resonance [Hz]")
        first = found[0]
        envelope = first.signal[0] * np.exp(-first.stated * first.expected * first.time)
        right.plot(1e3 * first.time, scale * first.signal, color=BLUE)
        for sign in (1.0, -1.0):
            right.plot(1e3 * first.time, sign * scale * envelope, "--", color=GREY)
        right.set_xlabel("time [ms]")
        right.set_ylabel(deflection)
        right.set_xlim(left=0.0)

    return svg(draw, (9.6, 4.0))
