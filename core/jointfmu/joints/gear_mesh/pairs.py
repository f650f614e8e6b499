"""How many tooth pairs are in contact over the mesh cycle."""

import numpy as np

from ...quantity import Number


def rise(x: Number) -> tuple[Number, Number]:
    """From 0 at x <= 0 to 1 at x >= 1, twice continuously differentiable, and its slope."""
    r = np.minimum(np.maximum(x, 0.0), 1.0)
    return r * r * r * (10.0 + r * (6.0 * r - 15.0)), 30.0 * (r * (1.0 - r)) ** 2


def pairs(contact_ratio: Number, engagement: Number, phase: Number) -> tuple[Number, Number]:
    """Tooth pairs in contact [1] at a phase (...) [1] of the mesh cycle, and their slope in the phase.

    Of the contact ratio the whole part is always in contact, and one pair more during the rest of the
    cycle, centred at whole phases. It comes and goes by `rise`, centred at the ends of that time, over
    `engagement` times the shorter of the times with and without it. Even in the phase, and the
    contact ratio on average over a cycle.
    """
    least = np.floor(contact_ratio)
    part = contact_ratio - least
    width = engagement * np.minimum(part, 1.0 - part)
    changing = width > 0.0
    length = np.where(changing, width, 1.0)
    away = phase - np.floor(phase + 0.5)
    share, slope = rise(0.5 + (0.5 * part - np.abs(away)) / length)
    return least + np.where(changing, share, 0.0), np.where(changing, -np.sign(away) * slope / length, 0.0)
