"""Natural frequencies of two bodies that float freely, held together by the stiffness of their contact:
with given stiffnesses, and of a bolted assembly with those of its pressure.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import LinearOperator, eigsh

from jointfmu.mechanics.curve import approach_curve
from jointfmu.quantity import Array

from ..fields.clamped import BoltedInterface
from .bolted_contact import BoltedContact, JointSolution
from .contact import Interface, PressureLaw, trace
from .elasticity import Cholesky, ElasticBody
from .geometry import Assembly

RIGID = 6
"""Motions without strain of an assembly that floats freely."""
SHIFT = 100.0
"""Frequency [Hz] at whose negative square the eigensolver looks; far below the elastic modes."""
ACCURATE = 1e-8
"""Of shapes [1]; frequencies are so to its square."""
LEAST = 1.0
"""Frequency [Hz] below which a motion counts as rigid."""


@dataclass(frozen=True, slots=True)
class NaturalModes:
    """Modes with strain, by rising frequency.

    frequency : (k) [Hz]
    shape     : k times the displacement (n, 3) of the nodes of each body, of modal mass 1 kg [1]
    mass      : [kg] of the assembly
    """

    frequency: Array
    shape: tuple[tuple[Array, ...], ...]
    mass: float


def modes(
    bodies: tuple[ElasticBody, ...], interface: Interface, normal: Array, tangential: Array, count: int = 6
) -> NaturalModes:
    """The lowest modes with strain of the assembly, free on all sides.

    bodies     : side 1 and side 2, or side 2 alone if side 1 is its mirror image
    normal, tangential : (q) [N/m3] stiffness per area at the quadrature points of the interface
    count      : of modes

    Raises RuntimeError if the contact does not hold the bodies together.
    """
    if len(bodies) == 2:
        springs = _springs(bodies, interface, {0: tangential, 1: tangential, 2: normal})
        motions = _lowest(bodies, springs, RIGID + count)
    else:
        motions = []
        for stiffness, sign in (({2: normal}, 1.0), ({0: tangential, 1: tangential}, -1.0)):
            half = _lowest(bodies, 2.0 * _springs(bodies, interface, stiffness), RIGID // 2 + count)
            motions += [(f, _both(shape[0], sign)) for f, shape in half]
        motions.sort(key=lambda motion: motion[0])
    frequency = np.array([motion[0] for motion in motions])
    if frequency[RIGID] < LEAST:
        raise RuntimeError(f"the contact leaves more than {RIGID} rigid motions: it does not hold the bodies")
    mass = sum(float(body.mass.sum()) / 3.0 for body in bodies) * (3 - len(bodies))
    last = RIGID + count
    return NaturalModes(frequency[RIGID:last], tuple(motion[1] for motion in motions[RIGID:last]), mass)


def _springs(
    bodies: tuple[ElasticBody, ...], interface: Interface, stiffness: Mapping[int, Array]
) -> sp.csr_matrix:
    """Stiffness matrix [N/m] of the interface; stiffness per area (q) [N/m3] along some of the axes."""
    signs = (1.0, -1.0)[: len(bodies)]
    total: sp.csr_matrix | float = 0.0
    for axis, density in stiffness.items():
        opening = sp.hstack([s * trace(body, interface, axis) for s, body in zip(signs, bodies, strict=True)])
        total = total + opening.T @ sp.diags(interface.area * density) @ opening
    return sp.csr_matrix(total)


def _lowest(
    bodies: tuple[ElasticBody, ...], springs: sp.csr_matrix, count: int
) -> list[tuple[float, tuple[Array, ...]]]:
    """Frequencies [Hz] and shapes: Lanczos on the inverse, shifted so that rigid motions do no harm."""
    mass = sp.block_diag([body.mass for body in bodies], format="csr")
    stiffness = sp.block_diag([body.stiffness for body in bodies], format="csr") + springs
    shift = -((2.0 * np.pi * SHIFT) ** 2)
    factor = Cholesky(stiffness - shift * mass)
    inverse = LinearOperator(stiffness.shape, matvec=factor.solve, dtype=np.float64)
    start = np.random.default_rng(1).standard_normal(stiffness.shape[0])
    squares, shapes = eigsh(stiffness, k=count, M=mass, sigma=shift, OPinv=inverse, v0=start, tol=ACCURATE)
    ends = np.cumsum([body.size for body in bodies])[:-1]
    parts = [tuple(part.reshape(-1, 3) for part in np.split(shape, ends)) for shape in shapes.T]
    return list(zip(np.sqrt(np.maximum(squares, 0.0)) / (2.0 * np.pi), parts, strict=True))


def _both(shape: Array, sign: float) -> tuple[Array, Array]:
    """Side 1, the mirror image in z = 0 (its opposite for sign -1), and side 2, together of mass 1 kg."""
    above = np.sqrt(0.5) * shape
    return sign * above * np.array([1.0, 1.0, -1.0]), above


REFINEMENT = 0.5
"""Of the meshes for frequencies of many states [1]; twice as fine ones lower those of the box specimen by
less than 1 % (docs/finite_elements_explanation.md)."""


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
