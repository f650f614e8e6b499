"""Loads at which a field's sums are kept."""

from collections.abc import Iterator
from itertools import count
from typing import NamedTuple

import numpy as np
from scipy.stats import qmc

from jointfmu.mechanics.footprint.shape import PressureShape

from .clamped import BoltedInterface

PRELOADS = (0.05, 3.0)
"""Range of the preload over the one of the field [1]."""
OPENED = 0.001
"""Part of the preload's force [1] whose nodes may have been opened by the largest moment."""
PRESSED = 0.03
"""How far the joint is pressed together, over how far it is drawn apart until it is fully open [1]."""
SEED = 1


class Load(NamedTuple):
    """A state of the joint.

    preload : over the field's [1]
    moment  : over the one at which a row of bolts has no force left [1]
    apart   : normal motion over the one that opens the joint fully [1]
    """

    preload: float
    moment: float
    apart: float


def largest_moment(joint: BoltedInterface, shape: PressureShape) -> float:
    """Over the one at which a row of bolts has no force left [1]: up to where the sums are to be kept.

    There, or where nodes that carried the part OPENED of the preload are open.
    """
    force = shape.share * shape.equal
    touching = force > 0.0
    over = np.abs(shape.tilt[touching]) * joint.row_bolts / joint.n_bolts
    with np.errstate(divide="ignore"):
        opening = shape.equal[touching] / over
    order = np.argsort(opening)
    opened = np.cumsum(force[touching][order])
    return float(min(opening[order][np.searchsorted(opened, OPENED)], 1.0))


def first_loads(limit: float) -> list[Load]:
    """Loads to begin with, up to a moment over the one that unloads a row [1]."""
    inside = [limit * m for m in (-1.0, -0.97, -0.9, -0.8, -0.5, 0.0, 0.5, 0.8, 0.9, 0.97, 1.0)]
    still = [Load(p, m, 0.0) for p in PRELOADS for m in (*inside, *((-1.0, 1.0) if limit < 1.0 else ()))]
    apart = (-PRESSED, -0.4 * PRESSED, 0.05, 0.2, 0.4, 0.55, 0.65, 0.75, 0.85)
    moved = [Load(p, m, s) for p in PRELOADS for m in inside[::2] for s in apart]
    steep = [limit * m for m in (-0.95, -0.85, -0.7, 0.7, 0.85, 0.95)]  # where nodes open row by row
    return still + moved + [Load(PRELOADS[0], m, s) for m in steep for s in (0.3, 0.45, 0.6)]


def further_loads(limit: float) -> Iterator[Load]:
    """Loads without end, every third one at rest."""
    sequence = qmc.Halton(3, seed=SEED)
    low, high = np.log(PRELOADS)
    for i in count():
        a, b, c = sequence.random(1)[0]
        apart = c * (1.0 + PRESSED) - PRESSED if i % 3 else 0.0
        yield Load(float(np.exp(low + a * (high - low))), float(limit * (2.0 * b - 1.0)), float(apart))
