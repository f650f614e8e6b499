"""Largest stable communication steps of a co-simulation: body in one FMU, spring and damper in another.

The body is integrated with velocity Verlet steps at constant force. The force of a step belongs to position
and speed at its start (step_at_once). Or it belongs to position and speed one step earlier, extrapolated with
its last change (step_side_by_side).
"""

import numpy as np

from ..quantity import Number, select

MAX_STABLE_STEP = 1e3
"""Largest reported stable step [s]: used if every step is stable (no stiffness, or fixed bodies)."""
STABLE_STEP_OUTPUTS = (
    (
        "step_at_once",
        "largest stable step for a sequential (Gauss-Seidel) master, which passes the new "
        "force on before the body steps",
    ),
    (
        "step_side_by_side",
        "largest stable step for a parallel (Jacobi) master with lag_b = 1; 0: unstable at any step",
    ),
)
"""Names and meanings of the outputs of a joint with the largest stable steps."""
_DAMPER_STEP_FACTOR = 0.39
"""Largest stable step times d/J [1], damper without spring, force one step late; fit to eigenvalues."""


def mobility(body_inertia: Number, lever_arm: Number = 1.0) -> Number:
    """Mobility lever_arm^2/J: inverse equivalent mass of a body with inertia J at a lever arm [1 or m].

    Inertia 0 stands for a fixed body; its mobility is 0.
    """
    is_free = body_inertia > 0.0
    return select(is_free, lever_arm**2 / select(is_free, body_inertia, 1.0), 0.0 * body_inertia)


def largest_stable_steps(
    joint_stiffness: Number, joint_damping: Number, body_mobility: Number
) -> tuple[Number, Number]:
    """Largest stable co-simulation steps [s]: with a force without delay, and with a force one step late.

    The force is one step late with a parallel master.

    joint_stiffness, joint_damping : K and d at the present state, in SI
    body_mobility : w = 1/J of the body, or the sum of 1/J of both bodies [1/kg or 1/(kg.m2)]

    With omega^2 = K w and e = d w = 2 zeta omega they are

        2/((omega^2 + e^2)^(1/2) + e),    (e/(omega^4 + (e/b)^3 e))^(1/3)

    with b = _DAMPER_STEP_FACTOR. The first is exact. The second is within 5 % of the eigenvalue analysis up
    to zeta = 4. For small damping they are 2/omega and (2 zeta)^(1/3)/omega. With a late force and no damping
    no step is stable: the second is 0.
    """
    square = (
        select(joint_stiffness > 0.0, joint_stiffness, 0.0 * joint_stiffness) * body_mobility
        + (2.0 / MAX_STABLE_STEP) ** 2
    )
    damping_rate = joint_damping * body_mobility
    is_damped = damping_rate > 0.0
    safe_rate = select(is_damped, damping_rate, 1.0)
    late_step = (safe_rate / (square**2 + safe_rate**4 / _DAMPER_STEP_FACTOR**3)) ** (1.0 / 3.0)
    return 2.0 / (np.sqrt(square + damping_rate**2) + damping_rate), select(
        is_damped, late_step, select(body_mobility > 0.0, 0.0 * damping_rate, MAX_STABLE_STEP)
    )
