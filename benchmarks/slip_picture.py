"""Picture of benchmarks/partial_slip.py, into docs/images."""

import numpy as np
import slip_cases as cases
import slip_theory as theory
from jointfmu_tools.common import plots
from validity_pictures import IMAGES

STATIONS = np.polynomial.legendre.leggauss(12)
"""On the branches of the loops that are drawn."""


def draw(contact, found):
    """Loops of one contact beside its normal curve, and the loss of all over the amplitude."""
    with plots.open_figure(IMAGES / "validity_partial_slip.svg", (9.6, 4.0)) as figure:
        left, right = figure.subplots(1, 2)
        loops(left, contact)
        losses(right, found)


def loops(axes, contact):
    """Loops of two amplitudes: points of boundary elements, lines of the theory and of the sphere."""
    told = cases.foretold(contact, amplitudes=())
    load, end = told.load, told.shift[-1]
    states = cases.backbone(contact, told.shift, 0)
    guess = theory.sphere(load, told.slope)
    for amplitude in (0.5, 0.9):
        state = states[cases.FORCES.index(amplitude)]
        one, far = cases.loop(contact, state, 0, STATIONS), float(state.shift[0])
        x = np.concatenate([-STATIONS[0], STATIONS[0]]) * far / end
        axes.plot(x, np.concatenate([one.back, one.again]) / load, "o", color=plots.BLUE, ms=4)
        u = np.linspace(0.0, 2.0 * far, 81)
        true = load - contact.lighter(0.5 * told.ratio * u)
        for branch, style in (
            (true, {"color": plots.RED}),
            (guess(0.5 * u), {"color": plots.GREY, "ls": "--"}),
        ):
            top = branch[-1] / load  # half the way: the backbone at the amplitude
            for sign in (1.0, -1.0):
                axes.plot(sign * (far - u) / end, sign * (top - 2.0 * branch / load), lw=1, **style)
    shift = np.append(0.0, told.shift)
    axes.plot(
        shift / end, [0.0, *(s.force[0] / load for s in states)], "s", color=plots.BLUE, ms=4, mfc="white"
    )
    u = np.linspace(0.0, end, 41)
    axes.plot(u / end, 1.0 - contact.lighter(told.ratio * u) / load, color=plots.RED, lw=1)
    axes.plot(u / end, guess(u) / load, color=plots.GREY, ls="--", lw=1)
    axes.set(
        xlabel="displacement over that at 0.9 μP", ylabel="force over μP", xticks=(-1.0, -0.5, 0.0, 0.5, 1.0)
    )


def losses(axes, found):
    """Loss of a cycle over pi times force and displacement, over the amplitude."""
    index = [cases.FORCES.index(a) for a in cases.AMPLITUDES]
    names = {
        "boundary elements": None,
        "from the normal curve": "loop_theory",
        "Mindlin's sphere": "loop_sphere",
    }
    styles = (("o", plots.BLUE), ("_", plots.RED), ("x", plots.GREY))
    for (label, name), (mark, color) in zip(names.items(), styles, strict=True):
        for i, one in enumerate(found):
            loss = one.loss * (getattr(one, name) if name else 1.0)
            work = np.pi * one.load * one.force[index] * one.shift[index]
            style = {"color": color, "ms": 3 if mark == "o" else 6, "label": label if i == 0 else None}
            axes.loglog(one.force[index], loss / work, mark, **style)
    axes.set(xlabel="amplitude of the force over μP", ylabel="loss over π times force and displacement")
    axes.set_xticks(cases.AMPLITUDES, [f"{amplitude:g}" for amplitude in cases.AMPLITUDES], minor=False)
    axes.set_xticks([], minor=True)
    axes.legend(fontsize=8)
