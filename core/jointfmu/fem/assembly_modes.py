"""Modes of a bolted assembly whose contact has the stiffness of its pressure."""

import numpy as np

from .contact import Law
from .elasticity import Array
from .joint import BoltedContact, JointSolution
from .modes import Modes, modes


def computed(solution: JointSolution, shear: float, count: int = 6) -> Modes:
    """Modes about the tightened state: every place of the contact has the stiffness of its pressure.

    shear : [1] tangential over normal stiffness of the interface
    count : of modes
    """
    return _on(solution.joint, solution.contact.stiffness, shear, count)


def uniform(joint: BoltedContact, law: Law, force: float, shear: float, count: int = 6) -> Modes:
    """Modes if the total force [N] of the bolts were spread evenly over the contact."""
    area = joint.interface.area
    approach = law.inverse(np.asarray(force / area.sum()))
    stiffness = float(law.derivatives(approach, 1)[1])
    return _on(joint, np.full(area.shape, stiffness), shear, count)


def _on(joint: BoltedContact, normal: Array, shear: float, count: int) -> Modes:
    return modes(joint.bodies, joint.interface, normal, shear * normal, count)
