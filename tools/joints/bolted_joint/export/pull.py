"""The bolted joint's normal force over its separation, as a table."""

import numpy as np

from jointfmu.joints.bolted_joint.law import pressures
from jointfmu.joints.bolted_joint.spring import BoltedJointSpring
from jointfmu.quantity import Array

from ....export.tables import LoadTable, thinned

STRONGEST = 10.0
"""End of the table: its total force over the one at tightening [1]."""
_FINE = 4000
"""Points at which errors are measured on either side of the tightened state."""
_BLOCK = 100_000


def pull_table(spring: BoltedJointSpring, preload: float, moment: float, error: float) -> LoadTable:
    """Force [N] that holds the bolted joint together over its separation s_rel_z [m], stiffness [N/m].

    The bolts' own stiffness acts beside the interface. From STRONGEST times the force at tightening, pressed
    together, to where the last node opens; from there on only the bolts' force grows. The errors refer to the
    force at tightening where the load is smaller, and to the stiffness there. Raises ValueError if nothing is
    in contact or the hardness is reached.
    """
    start = spring.within_law(preload, moment)
    low, high = spring.curve.displacement[[0, -1]]
    shape = spring.shape.merged(moment=moment != 0.0)
    alike = spring.curve.inverse(pressures(spring.joint, shape, preload, moment))
    weight = spring.joint.A_0 * shape.share
    bolts = float(spring.joint.n_bolts * spring.joint.bolt_stiffness)

    def total(separation: Array) -> Array:
        blocks = np.array_split(separation[:, None], max(separation.size * alike.size // _BLOCK, 1))
        both = [[value @ weight for value in spring.curve.derivatives(alike - s, 1)] for s in blocks]
        return np.concatenate(both, axis=1)

    held, stiff = (float(value[0]) for value in total(np.zeros(1)))
    reach = np.linspace(0.0, float(high - np.max(start)), 400)
    end = float(np.interp(STRONGEST * held, total(-reach)[0], reach))
    opening = float(np.max(start) - low)
    s = np.concatenate([np.linspace(-end, 0.0, _FINE), np.linspace(0.0, opening, _FINE)[1:]])
    force, stiffness = total(s)
    pull = held - force + bolts * s
    table = thinned(s, pull, stiffness + bolts, error, (held, stiff), keep=(_FINE - 1,))
    last = [2.0 * opening, held + 2.0 * bolts * opening, bolts]
    return LoadTable(np.vstack([table.rows, last]), table.straight, table.monotone)
