"""Natural modes of two free-free bodies that are coupled by the stiffness of their contact.

The contact stiffness is prescribed, or follows from the contact pressure of a bolted assembly.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import LinearOperator, eigsh

from jointfmu.mechanics.curve import tabulate_approach
from jointfmu.quantity import Array

from ..inputs.fields.bolted_interface import BoltedInterface
from .bolted_contact import BoltedContact, JointSolution
from .contact import ContactInterface, PressureLaw, displacement_matrix
from .elasticity import CholeskyFactor, ElasticBody
from .geometry import Assembly

RIGID_MODE_COUNT = 6
"""Number of rigid-body modes of a free assembly [1]."""
EIGENVALUE_SHIFT_FREQUENCY = 100.0
"""Frequency f [Hz] of the shift -(2 pi f)^2 of the eigensolver; far below the elastic modes."""
EIGENSOLVER_TOLERANCE = 1e-8
"""Relative tolerance of the eigensolver for mode shapes [1]; the error of frequencies is its square."""
MIN_ELASTIC_FREQUENCY = 1.0
"""Frequency [Hz] below which a mode counts as rigid-body mode."""


@dataclass(frozen=True, slots=True)
class NaturalModes:
    """Elastic natural modes of an assembly, in order of increasing frequency.

    natural_frequencies : (k) [Hz]
    mode_shapes         : for each mode, displacement (n, 3) [1] of the nodes of each body, of modal mass 1 kg
    assembly_mass       : mass of the assembly [kg]
    """

    natural_frequencies: Array
    mode_shapes: tuple[tuple[Array, ...], ...]
    assembly_mass: float


def compute_modes(
    bodies: tuple[ElasticBody, ...],
    contact_interface: ContactInterface,
    normal_stiffness: Array,
    tangential_stiffness: Array,
    mode_count: int = 6,
) -> NaturalModes:
    """Compute the lowest elastic modes of an assembly without supports.

    bodies               : side 1 and side 2, or side 2 alone if side 1 is its mirror image
    normal_stiffness     : normal stiffness per area (q) [N/m3] at the quadrature points of the interface
    tangential_stiffness : tangential stiffness per area (q) [N/m3] at these points
    mode_count           : number of modes

    Raises RuntimeError if the contact stiffness leaves more than six rigid-body modes.
    """
    if len(bodies) == 2:
        springs = _interface_stiffness(
            bodies, contact_interface, {0: tangential_stiffness, 1: tangential_stiffness, 2: normal_stiffness}
        )
        motions = _solve_lowest_modes(bodies, springs, RIGID_MODE_COUNT + mode_count)
    else:
        motions = []
        for stiffness, sign in (
            ({2: normal_stiffness}, 1.0),
            ({0: tangential_stiffness, 1: tangential_stiffness}, -1.0),
        ):
            half = _solve_lowest_modes(
                bodies,
                2.0 * _interface_stiffness(bodies, contact_interface, stiffness),
                RIGID_MODE_COUNT // 2 + mode_count,
            )
            motions += [(f, _mirror_mode_shape(shape[0], sign)) for f, shape in half]
        motions.sort(key=lambda motion: motion[0])
    frequency = np.array([motion[0] for motion in motions])
    if frequency[RIGID_MODE_COUNT] < MIN_ELASTIC_FREQUENCY:
        raise RuntimeError(
            f"the contact leaves more than {RIGID_MODE_COUNT} rigid motions: the contact does not hold the "
            "bodies together; increase the preload"
        )
    mass = sum(float(body.mass_matrix.sum()) / 3.0 for body in bodies) * (3 - len(bodies))
    end = RIGID_MODE_COUNT + mode_count
    return NaturalModes(
        frequency[RIGID_MODE_COUNT:end], tuple(motion[1] for motion in motions[RIGID_MODE_COUNT:end]), mass
    )


def _interface_stiffness(
    bodies: tuple[ElasticBody, ...],
    contact_interface: ContactInterface,
    stiffness_per_area: Mapping[int, Array],
) -> sp.csr_matrix:
    """Stiffness matrix (n, n) [N/m] of the interface.

    stiffness_per_area : {axis 0, 1 or 2: stiffness per area (q) [N/m3]}; axes that are missing have none
    """
    signs = (1.0, -1.0)[: len(bodies)]
    total: sp.csr_matrix | float = 0.0
    for axis, density in stiffness_per_area.items():
        opening = sp.hstack(
            [
                s * displacement_matrix(body, contact_interface, axis)
                for s, body in zip(signs, bodies, strict=True)
            ]
        )
        total = total + opening.T @ sp.diags(contact_interface.quadrature_area * density) @ opening
    return sp.csr_matrix(total)


def _solve_lowest_modes(
    bodies: tuple[ElasticBody, ...], interface_stiffness: sp.csr_matrix, mode_count: int
) -> list[tuple[float, tuple[Array, ...]]]:
    """Lowest frequencies [Hz] and mode shapes, by shift-invert Lanczos.

    The shift makes the matrix positive definite in spite of the rigid-body modes.
    """
    mass = sp.block_diag([body.mass_matrix for body in bodies], format="csr")
    stiffness = sp.block_diag([body.stiffness_matrix for body in bodies], format="csr") + interface_stiffness
    shift = -((2.0 * np.pi * EIGENVALUE_SHIFT_FREQUENCY) ** 2)
    factor = CholeskyFactor(stiffness - shift * mass)
    inverse = LinearOperator(stiffness.shape, matvec=factor.solve_linear_system, dtype=np.float64)
    start = np.random.default_rng(1).standard_normal(stiffness.shape[0])
    squares, shapes = eigsh(
        stiffness, k=mode_count, M=mass, sigma=shift, OPinv=inverse, v0=start, tol=EIGENSOLVER_TOLERANCE
    )
    ends = np.cumsum([body.unknown_count for body in bodies])[:-1]
    by_body = [tuple(block.reshape(-1, 3) for block in np.split(shape, ends)) for shape in shapes.T]
    return list(zip(np.sqrt(np.maximum(squares, 0.0)) / (2.0 * np.pi), by_body, strict=True))


def _mirror_mode_shape(side2_shape: Array, mirror_sign: float) -> tuple[Array, Array]:
    """Mode shapes (n, 3) of both bodies, of modal mass 1 kg, from the shape of side 2.

    Side 1 is the mirror image of side 2 in the plane z = 0, times `mirror_sign` (1 or -1).
    """
    side2 = np.sqrt(0.5) * side2_shape
    return mirror_sign * side2 * np.array([1.0, 1.0, -1.0]), side2


DEFAULT_MESH_REFINEMENT = 0.5
"""Refinement [1] of the meshes for frequencies in many load states. Twice this refinement lowers the
frequencies of the box specimen by less than 1 % (docs/finite_elements_explanation.md)."""


def compute_preloaded_modes(
    joint_solution: JointSolution, tangential_stiffness_ratio: float, mode_count: int = 6
) -> NaturalModes:
    """Natural modes of a preloaded joint: the contact stiffness at each point follows from its pressure.

    tangential_stiffness_ratio : [1] tangential over normal stiffness of the interface
    mode_count                 : number of modes
    """
    return _compute_modes_for_stiffness(
        joint_solution.bolted_contact,
        joint_solution.contact_solution.contact_stiffness,
        tangential_stiffness_ratio,
        mode_count,
    )


def compute_uniform_pressure_modes(
    bolted_contact: BoltedContact,
    pressure_law: PressureLaw,
    total_bolt_force: float,
    tangential_stiffness_ratio: float,
    mode_count: int = 6,
) -> NaturalModes:
    """Natural modes for a uniform contact pressure: the total bolt force [N] over the contact area.

    tangential_stiffness_ratio : [1] tangential over normal stiffness of the interface
    mode_count                 : number of modes
    """
    area = bolted_contact.contact_interface.quadrature_area
    approach = pressure_law.inverse(np.asarray(total_bolt_force / area.sum()))
    stiffness = float(pressure_law.derivatives(approach, 1)[1])
    return _compute_modes_for_stiffness(
        bolted_contact, np.full(area.shape, stiffness), tangential_stiffness_ratio, mode_count
    )


def compute_frequencies(
    assembly: Assembly,
    joint_parameters: BoltedInterface,
    tangential_stiffness_ratio: float,
    load_states: Sequence[tuple[float, float]],
    refinement: float = DEFAULT_MESH_REFINEMENT,
    mode_count: int = 6,
    is_pressure_uniform: bool = False,
) -> Array:
    """Compute the natural frequencies (load states, modes) [Hz] of an assembly in several load states.

    joint_parameters : gives the interface law; its contact area is replaced by the area of the assembly
    tangential_stiffness_ratio : [1] tangential over normal stiffness of the interface
    load_states : preload [N] per bolt and moment [N.m] about x of each load state
    is_pressure_uniform : distribute the bolt force uniformly over the contact, and compute no pressure
    """
    law = tabulate_approach(replace(joint_parameters, A_0=assembly.contact_area))
    contact = BoltedContact.from_assembly(assembly, refinement)
    rows = []
    for preload, moment in load_states:
        if is_pressure_uniform:
            force = float(assembly.bolt_forces(preload, moment).sum())
            rows.append(
                compute_uniform_pressure_modes(
                    contact, law, force, tangential_stiffness_ratio, mode_count
                ).natural_frequencies
            )
        else:
            rows.append(
                compute_preloaded_modes(
                    contact.solve_equilibrium(law, preload, moment), tangential_stiffness_ratio, mode_count
                ).natural_frequencies
            )
    return np.array(rows)


def _compute_modes_for_stiffness(
    bolted_contact: BoltedContact, normal_stiffness: Array, tangential_stiffness_ratio: float, mode_count: int
) -> NaturalModes:
    """Natural modes for a normal stiffness per area (q) [N/m3] and the tangential stiffness ratio [1]."""
    return compute_modes(
        bolted_contact.bodies,
        bolted_contact.contact_interface,
        normal_stiffness,
        tangential_stiffness_ratio * normal_stiffness,
        mode_count,
    )
