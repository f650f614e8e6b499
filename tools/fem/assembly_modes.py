"""Modes of a bolted assembly whose contact has the stiffness of its pressure."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jointfmu.mechanics.curve import approach_curve

from ..fields.clamped import BoltedInterface
from .bolted_contact import BoltedContact, JointSolution
from .contact import PressureLaw
from .elasticity import Array
from .geometry import Assembly
from .modes import NaturalModes, modes

REFINEMENT = 0.5
"""Of the meshes for frequencies of many states [1]; twice as fine ones lower those of the box specimen by
less than 1 % (docs/finite_elements.md)."""


def computed(solution: JointSolution, shear: float, count: int = 6) -> NaturalModes:
    """Modes about the tightened state: every place of the contact has the stiffness of its pressure.

    shear : [1] tangential over normal stiffness of the interface
    count : of modes
    """
    return _on(solution.joint, solution.contact.stiffness, shear, count)


def uniform(
    joint: BoltedContact, law: PressureLaw, force: float, shear: float, count: int = 6
) -> NaturalModes:
    """Modes if the total force [N] of the bolts were spread evenly over the contact."""
    area = joint.interface.area
    approach = law.inverse(np.asarray(force / area.sum()))
    stiffness = float(law.derivatives(approach, 1)[1])
    return _on(joint, np.full(area.shape, stiffness), shear, count)


def frequencies(
    assembly: Assembly,
    joint: BoltedInterface,
    shear: float,
    states: Sequence[tuple[float, float]],
    refinement: float = REFINEMENT,
    count: int = 6,
    even: bool = False,
) -> Array:
    """Natural frequencies (states, count) [Hz] of an assembly.

    joint  : gives the interface law; its area is that of the assembly
    shear  : [1] tangential over normal stiffness of the interface
    states : preloads [N] per bolt and moments [N.m]
    even   : with the bolts' force spread evenly over the contact, instead of the computed field
    """
    law = approach_curve(replace(joint, A_0=assembly.contact_area))
    contact = BoltedContact.of(assembly, refinement)
    rows = []
    for preload, moment in states:
        if even:
            force = float(assembly.bolt_forces(preload, moment).sum())
            rows.append(uniform(contact, law, force, shear, count).frequency)
        else:
            rows.append(computed(contact.solve(law, preload, moment), shear, count).frequency)
    return np.array(rows)


def _on(joint: BoltedContact, normal: Array, shear: float, count: int) -> NaturalModes:
    return modes(joint.bodies, joint.interface, normal, shear * normal, count)
