"""The gear contact for many samples at once: K_N and approach along a ramp of force."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..joints.gear_contact.spring import GearContact
from .approach import held, tabulate
from .samples import columns

Array = NDArray[np.float64]


def evaluate(values: Mapping[str, Any], loads: Array, factor: Array) -> dict[str, Array]:
    """K_N [N/m] and s_rel [m] (n, m) at the forces factor (n, 1) times loads (m) [N], ascending.

    values : by structured name, numbers or samples (n)
    """
    contact = columns(GearContact, values, 1)
    scale = factor / contact.A_0
    touching = loads > 0.0
    rows, _ = tabulate(contact, scale * np.min(loads[touching]), scale * loads[-1])
    found = held(rows, np.log(loads[touching]), np.log(scale), np.log(contact.hardness))
    K, s = np.zeros((2, factor.size, loads.size))
    K[:, touching], s[:, touching] = contact.A_0 * np.exp(found["k"]), np.exp(found["s"])
    return {"K_N": K, "s_rel": s}
