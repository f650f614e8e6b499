"""The gear contact for many samples at once: K_N and approach along a ramp of force."""

from collections.abc import Mapping

import numpy as np

from jointfmu.joints.gear_contact import KIND
from jointfmu.joints.gear_contact.spring import Contact, GearContactSpring
from jointfmu.quantity import Array

from ...batch.approach import columns, held, tabulate
from ...uncertainty.problem import Reduced


def evaluate(
    parameters: type[Contact], values: Mapping[str, object], loads: Array, factor: Array
) -> dict[str, Array]:
    """K_N [N/m] and s_rel [m] (n, m) at the forces factor (n, 1) times loads (m) [N], ascending.

    values : by structured name, numbers or samples (n)
    """
    contact = columns(parameters, values, 1)
    scale = factor / contact.A_0
    touching = loads > 0.0
    rows, _ = tabulate(contact, scale * np.min(loads[touching]), scale * loads[-1])
    logs = held(rows, np.log(loads[touching]), np.log(scale), np.log(contact.hardness))
    K, s = np.zeros((2, factor.size, loads.size))
    K[:, touching], s[:, touching] = contact.A_0 * np.exp(logs["k"]), np.exp(logs["s"])
    return {"K_N": K, "s_rel": s}


def exact(joint: Contact, loads: Array) -> dict[str, Array]:
    """K_N and s_rel (m) of the exported spring at forces (m) [N]; no stiffness without force."""
    state = GearContactSpring.of(joint).approach(loads)
    return {name: np.where(loads > 0.0, state[name], 0.0) for name in REDUCED.units}


REDUCED = Reduced(
    load=KIND.variables["f"],
    outputs=tuple(KIND.variables[name] for name in ("K_N", "s_rel")),
    to=lambda contact: 3e3,
    most=lambda contact: contact.hardness * contact.A_0,
    evaluate=evaluate,
    exact=exact,
)
