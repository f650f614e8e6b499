"""Natural modes of two free-free bodies that are coupled by the stiffness of their contact.

The contact stiffness is prescribed, or follows from the contact pressure of a bolted assembly.
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
"""Number of rigid-body modes of a free assembly."""
SHIFT = 100.0
"""Frequency f [Hz] of the shift -(2 pi f)^2 of the eigensolver; far below the elastic modes."""
ACCURATE = 1e-8
"""Relative tolerance of the eigensolver for mode shapes [1]; the error of frequencies is its square."""
LEAST = 1.0
"""Frequency [Hz] below which a mode counts as rigid-body mode."""


@dataclass(frozen=True, slots=True)
class NaturalModes:
    """Elastic natural modes of an assembly, in order of increasing frequency.

    frequency : (k) [Hz]
    shape     : for each mode, displacement (n, 3) [1] of the nodes of each body, of modal mass 1 kg
    mass      : mass of the assembly [kg]
    """

    frequency: Array
    shape: tuple[tuple[Array, ...], ...]
    mass: float


def modes(
    bodies: tuple[ElasticBody, ...], interface: Interface, normal: Array, tangential: Array, count: int = 6
) -> NaturalModes:
    """The lowest elastic modes of an assembly without supports.

    bodies     : side 1 and side 2, or side 2 alone if side 1 is its mirror image
    normal_stiffness : normal stiffness per area (q) [N/m3] at the quadrature points of the interface
    tangential_stiffness : tangential stiffness per area (q) [N/m3] there
    count      : number of modes

    Raises RuntimeError if the contact stiffness leaves more than six rigid-body modes.
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
    end = RIGID + count
    return NaturalModes(frequency[RIGID:end], tuple(motion[1] for motion in motions[RIGID:end]), mass)


def _springs(
    bodies: tuple[ElasticBody, ...], interface: Interface, stiffness: Mapping[int, Array]
) -> sp.csr_matrix:
    """Stiffness matrix (n, n) [N/m] of the interface.

    stiffness : {axis 0, 1 or 2: stiffness per area (q) [N/m3]}; axes that are missing have none
    """
    signs = (1.0, -1.0)[: len(bodies)]
    total: sp.csr_matrix | float = 0.0
    for axis, density in stiffness.items():
        opening = sp.hstack([s * trace(body, interface, axis) for s, body in zip(signs, bodies, strict=True)])
        total = total + opening.T @ sp.diags(interface.area * density) @ opening
    return sp.csr_matrix(total)


def _lowest(
    bodies: tuple[ElasticBody, ...], springs: sp.csr_matrix, count: int
) -> list[tuple[float, tuple[Array, ...]]]:
    """Lowest frequencies [Hz] and mode shapes, by shift-invert Lanczos.

    The shift makes the matrix positive definite in spite of the rigid-body modes.
    """
    mass = sp.block_diag([body.mass for body in bodies], format="csr")
    stiffness = sp.block_diag([body.stiffness for body in bodies], format="csr") + springs
    shift = -((2.0 * np.pi * SHIFT) ** 2)
    factor = Cholesky(stiffness - shift * mass)
    inverse = LinearOperator(stiffness.shape, matvec=factor.solve, dtype=np.float64)
    start = np.random.default_rng(1).standard_normal(stiffness.shape[0])
    squares, shapes = eigsh(stiffness, k=count, M=mass, sigma=shift, OPinv=inverse, v0=start, tol=ACCURATE)
    ends = np.cumsum([body.size for body in bodies])[:-1]
    by_body = [tuple(block.reshape(-1, 3) for block in np.split(shape, ends)) for shape in shapes.T]
    return list(zip(np.sqrt(np.maximum(squares, 0.0)) / (2.0 * np.pi), by_body, strict=True))


def _both(shape: Array, sign: float) -> tuple[Array, Array]:
    """Mode shapes (n, 3) of both bodies, of modal mass 1 kg, from the shape of side 2.

    Side 1 is the mirror image of side 2 in the plane z = 0, times `sign` (1 or -1).
    """
    side2 = np.sqrt(0.5) * shape
    return sign * side2 * np.array([1.0, 1.0, -1.0]), side2


REFINEMENT = 0.5
"""Refinement [1] of the meshes for frequencies in many load states. Twice this refinement lowers the
frequencies of the box specimen by less than 1 % (docs/finite_elements_explanation.md)."""


def computed(solution: JointSolution, shear: float, count: int = 6) -> NaturalModes:
    """Natural modes of a preloaded joint: the contact stiffness at each point follows from its pressure.

    tangential_stiffness_ratio : [1] tangential over normal stiffness of the interface
    count : number of modes
    """
    return _on(solution.joint, solution.contact.stiffness, shear, count)


def uniform(
    joint: BoltedContact, law: PressureLaw, force: float, shear: float, count: int = 6
) -> NaturalModes:
    """Natural modes for a uniform contact pressure: the total bolt force [N] over the contact area.

    tangential_stiffness_ratio : [1] tangential over normal stiffness of the interface
    count : number of modes
    """
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
    """Natural frequencies (states, count) [Hz] of an assembly in several load states.

    joint  : gives the interface law; its contact area is replaced by that of the assembly
    tangential_stiffness_ratio : [1] tangential over normal stiffness of the interface
    states : preload [N] per bolt and moment [N.m] about x of each load state
    uniform_pressure : distribute the bolt force uniformly over the contact, instead of computing the pressure
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
    """Natural modes for a normal stiffness per area (q) [N/m3] and the tangential stiffness ratio [1]."""
    return modes(joint.bodies, joint.interface, normal, shear * normal, count)
