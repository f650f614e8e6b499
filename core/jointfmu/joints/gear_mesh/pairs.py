"""How many tooth pairs are in contact over the mesh cycle."""

import numpy as np

from ...quantity import Number, smooth_step, smooth_step_integral, smooth_step_slopes

_NARROW = 1e-6
"""Overlap ratio [1] below which the mean over it differs from the middle by less than the round-off of
a difference over it: 1/24 of its square times the curvature, at most 6/width^2.
"""


def pairs(
    contact_ratio: Number, engagement: Number, overlap_ratio: Number, phase: Number
) -> tuple[Number, Number]:
    """Tooth pairs in contact [1] at a phase (...) [1] of the mesh cycle, and their slope in the phase.

    The pairs of a helical mesh are counted in lines of contact over the full width. Each of its
    transverse sections is a spur mesh, see `_section`, and the sections are spread evenly over
    `overlap_ratio` cycles. So the number is the mean of a section's over that length, which keeps its
    mean over a cycle, the contact ratio, and takes from its fluctuation.
    """
    helical = overlap_ratio > _NARROW
    length = np.where(helical, overlap_ratio, 1.0)
    here, slope, _ = _section(contact_ratio, engagement, phase)
    after, _, to = _section(contact_ratio, engagement, phase + 0.5 * length)
    before, _, since = _section(contact_ratio, engagement, phase - 0.5 * length)
    mean = contact_ratio + (to - since) / length
    return np.where(helical, mean, here), np.where(helical, (after - before) / length, slope)


def _section(contact_ratio: Number, engagement: Number, phase: Number) -> tuple[Number, Number, Number]:
    """Tooth pairs in a transverse section [1], their slope, and their integral less that of the mean.

    Of the contact ratio the whole part is always in contact, and one pair more during the rest of the
    cycle, centred at whole phases. It comes and goes by `smooth_step`, centred at the ends of that time, over
    `engagement` times the shorter of the times with and without it. Even in the phase, and the
    contact ratio on average over a cycle.
    """
    least = np.floor(contact_ratio)
    part = contact_ratio - least
    width = engagement * np.minimum(part, 1.0 - part)
    changing = width > 0.0
    length = np.where(changing, width, 1.0)
    away = phase - np.floor(phase + 0.5)
    first = 0.5 + 0.5 * part / length
    place = first - np.abs(away) / length
    share, (slope, _) = smooth_step(place), smooth_step_slopes(place)
    passed = length * (first - 0.5 - smooth_step_integral(place)) - part * np.abs(away)
    return (
        least + np.where(changing, share, 0.0),
        np.where(changing, -np.sign(away) * slope / length, 0.0),
        np.where(changing, np.sign(away) * passed, 0.0),
    )
