"""Largest stable steps of a co-simulation: a body on a spring and a dashpot that are another FMU.

The body takes velocity Verlet steps with the force held; the force at a step's begin is that of the place and
speed there, or of those one step before, carried on along its last change.
"""

import numpy as np

from ..quantity import Number, where

LONGEST = 1e3
"""[s]: without stiffness, and of what is held, no step is too long; this one stands for it."""
STEPS = (
    ("step_at_once", "largest stable step if the master passes the new force on before the body steps"),
    (
        "step_side_by_side",
        "largest stable step for a parallel (Jacobi) master with lag_b = 1; 0: unstable at any step",
    ),
)
"""Names and meanings of outputs of a joint."""
_DAMPED = 0.39
"""Step times d/J [1] that is stable one step late on a dashpot alone, as fitted to the eigenvalues."""


def mobility(inertia: Number, lever: Number = 1.0) -> Number:
    """lever^2/J of a body at a lever [1 or m]; 0 of one whose inertia is 0: it is held."""
    free = inertia > 0.0
    return where(free, lever**2 / where(free, inertia, 1.0), 0.0 * inertia)


def stable_steps(stiffness: Number, damping: Number, mobility: Number) -> tuple[Number, Number]:
    """Largest stable steps [s] where the force arrives at once, and one step late (side by side).

    stiffness K, damping d : at the present state, in SI
    mobility w             : 1/J of the body, or the sum of both bodies' [1/kg or 1/(kg.m2)]

    With omega^2 = K w and e = d w = 2 zeta omega they are

        2/((omega^2 + e^2)^(1/2) + e),    (e/(omega^4 + (e/b)^3 e))^(1/3)

    the first exact, the second within 5 % of the eigenvalues' up to zeta = 4; 2/omega and
    (2 zeta)^(1/3)/omega for little damping. Late and without damping none is stable: 0.
    """
    square = where(stiffness > 0.0, stiffness, 0.0 * stiffness) * mobility + (2.0 / LONGEST) ** 2
    lost = damping * mobility
    damped = lost > 0.0
    some = where(damped, lost, 1.0)
    late = (some / (square**2 + some**4 / _DAMPED**3)) ** (1.0 / 3.0)
    return 2.0 / (np.sqrt(square + lost**2) + lost), where(
        damped, late, where(mobility > 0.0, 0.0 * lost, LONGEST)
    )
