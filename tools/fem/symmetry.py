"""Bolts that symmetry makes alike must show alike pressures: what a mesh that is too coarse breaks first."""

import numpy as np
from numpy.typing import NDArray

from ..fields.contact import ContactField

Array = NDArray[np.float64]

UNLIKE = 0.1
"""Relative difference of the greatest pressures around alike bolts, which a fine mesh stays below [1]."""
_SAME = 1e-6
"""Distance [m] within which a mirrored bolt lies on another one."""


def alike(bolts: Array, moment: bool) -> NDArray[np.int64]:
    """The first bolt (n) that each one equals by a mirror in x = 0 and, without a moment about x, in y = 0.

    bolts : (n, 2) [m]. The bodies are symmetric to both planes; a mirror counts if it maps bolts on bolts.
    """
    first = np.arange(len(bolts))
    for mirror in ((-1.0, 1.0),) if moment else ((-1.0, 1.0), (1.0, -1.0)):
        far = np.hypot(*(bolts[:, None] * mirror - bolts[None]).T).T
        image = far.argmin(axis=1)
        if np.all(far[np.arange(len(bolts)), image] < _SAME):
            first = np.minimum(first, first[image])
    return first


def unlike_holes(field: ContactField, bolts: Array, moment: bool) -> list[str]:
    """The warning if the greatest pressures around alike bolts differ by more than UNLIKE."""
    if not len(bolts):
        return []
    near = np.hypot(*(field.position[:, None] - bolts[None]).T).argmin(axis=0)
    peak = np.array([np.max(field.pressure[near == i], initial=0.0) for i in range(len(bolts))])
    first = alike(bolts, moment)
    spread = peak / np.array([np.min(peak[first == one]) for one in first]).clip(1e-9)
    worst = int(np.argmax(spread))
    if not spread[worst] > 1.0 + UNLIKE:
        return []
    x, y = bolts[worst]
    return [
        f"the pressure around the bolt at ({x:g}, {y:g}) m is {spread[worst]:.3g} times that around a bolt "
        "that symmetry makes alike: the mesh is too coarse around the holes, take a larger --refinement"
    ]
