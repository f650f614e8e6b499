"""Preloaded lapped beam, reduced exactly to its first mode and the compliance of its contact patches.

Only the interface is nonlinear, so for loads along the mode the reduction is exact.
"""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from jointfmu_tools.fem.contact import ContactInterface, ContactModel, displacement_matrix
from jointfmu_tools.fem.elasticity import CholeskyFactor
from scipy.sparse.linalg import LinearOperator, eigsh

from . import mesh
from .plan import plan
from .shanks import shanks

SHIFT = 100.0
"""Shift of the eigensolver [Hz], below all elastic modes."""
RIGID = 3
"""Number of rigid modes in the plane of symmetry."""
RIGHT_SIDES_PER_SOLVE = 64
"""Number of right sides in one solution."""
AXES = (0, 1, 2)


@dataclass(frozen=True)
class Structure:
    """Meshed beam without interface.

    bodies    : half 1 and 2
    interface : patches of the contact, one for each element of the contact, as points of a quadrature
    bolts     : [N/m] stiffness of the shanks between the unknowns of both bodies
    """

    beam: mesh.LapBeam
    bodies: tuple
    interface: ContactInterface
    bolts: sp.csr_matrix

    @classmethod
    def of(cls, beam, size):
        """Mesh of a beam, with one friction patch for each element of the contact."""
        view = plan(beam, size)
        bodies = mesh.bodies(beam, view, size)
        return cls(
            beam, bodies, patches(ContactInterface.from_mesh(mesh.contact(beam, view))), shanks(beam, bodies)
        )

    @property
    def symmetric(self):
        """Unknowns of each body that the symmetry fixes."""
        return tuple(3 * np.flatnonzero(body.node_positions[1] < 1e-9) + 1 for body in self.bodies)

    def relative(self, axis):
        """Displacement (P, n) of half 1 relative to half 2 along an axis; along z the approach."""
        return sp.hstack(
            [
                s * displacement_matrix(b, self.interface, axis)
                for s, b in zip((1.0, -1.0), self.bodies, strict=True)
            ]
        )

    def solve_preload(self, law, preload, gap=None):
        """Solve the frictionless contact under a preload [N] of each bolt; gap [m] at places x, y or None."""
        heads = [f"head{i}" for i in range(len(self.beam.bolts))]
        pull = [sum(b.distribute_unit_force(b.mesh.boundaries[name]) for name in heads) for b in self.bodies]
        loads = [0.5 * preload * sign * load for sign, load in zip((1.0, -1.0), pull, strict=True)]
        first, second = self.symmetric
        slides = 3 * _ends(self.bodies[1])[0]
        held = (np.union1d(first, pinned_unknowns(self.bodies[0])), np.union1d(second, slides))
        model = ContactModel(self.bodies, self.interface, law, gap, fixed_unknowns=held)
        area = self.interface.quadrature_area.sum()
        return model.solve_equilibrium(loads, 0.5 * preload * len(heads) / area)

    def stiffness(self, springs):
        """Stiffness matrix [N/m] with springs (P, 3) [N/m3] along x, y and z at the patches."""
        total = sp.block_diag([body.stiffness_matrix for body in self.bodies], format="csr") + self.bolts
        for axis in AXES:
            opening = self.relative(axis)
            total = total + opening.T @ sp.diags(self.interface.quadrature_area * springs[:, axis]) @ opening
        return total.tocsr()


def _ends(body):
    """Nodes at both ends of a body on the line y = z = 0."""
    x, y, z = body.node_positions
    line = np.flatnonzero((np.abs(y) < 1e-9) & (np.abs(z) < 1e-9))
    return line[np.argmin(x[line])], line[np.argmax(x[line])]


def pinned_unknowns(body):
    """Three unknowns that fix the rigid motion of a body in the plane of symmetry."""
    first, last = _ends(body)
    return np.array([3 * first, 3 * first + 2, 3 * last + 2])


def patches(interface):
    """Friction patches, one for each element of a contact: mean displacement, area and centroid."""
    count, points = interface.finite_element_basis.dx.shape
    rows = np.repeat(np.arange(count), points)
    share = sp.csr_matrix((interface.quadrature_area, (rows, np.arange(rows.size))), shape=(count, rows.size))
    area = np.asarray(share.sum(axis=1)).ravel()
    mean = sp.diags(1.0 / area) @ share
    return ContactInterface(
        interface.finite_element_basis,
        interface.node_positions,
        (mean @ interface.interpolation_matrix).tocsr(),
        area,
        mean @ interface.quadrature_position,
    )


@dataclass(frozen=True)
class ReducedBeam:
    """First mode of the preloaded beam, and its contact patches.

    frequencies : [Hz] of the lowest modes, linear
    tip        : [1/kg^0.5] deflection of the end in the first mode of a whole beam of modal mass 1 kg
    approach   : (P) [m] of the patches at tightening
    springs    : (P, 3) [N/m3] of the interface at tightening
    area       : (P) [m2] of half the width; `position` (P, 2) [m]
    shape      : (P, 3) [1/kg^0.5] relative displacement in that mode
    compliance : (3 P, 3 P) [m/N] relative displacement by pairs of forces, interface as springs
    """

    frequencies: np.ndarray
    tip: float
    approach: np.ndarray
    springs: np.ndarray
    area: np.ndarray
    position: np.ndarray
    shape: np.ndarray
    compliance: np.ndarray

    @property
    def frequency(self):
        """Frequency [Hz] of the first mode."""
        return float(self.frequencies[0])


def spectrum(structure, springs, count=3):
    """Frequencies [Hz] and shapes (n, count) of the lowest modes; modal mass of the whole beam 1 kg."""
    free = _free_unknowns(structure)
    stiffness = structure.stiffness(springs)[free][:, free]
    mass = sp.block_diag([body.mass_matrix for body in structure.bodies], format="csr")[free][:, free]
    shift = -((2.0 * np.pi * SHIFT) ** 2)
    factor = CholeskyFactor(stiffness - shift * mass)
    inverse = LinearOperator(stiffness.shape, matvec=factor.solve_linear_system, dtype=np.float64)
    start = np.random.default_rng(1).standard_normal(free.size)
    squares, shapes = eigsh(stiffness, k=RIGID + count, M=mass, sigma=shift, OPinv=inverse, v0=start)
    whole = np.zeros((sum(b.unknown_count for b in structure.bodies), count))
    order = np.argsort(squares)[RIGID:]
    whole[free] = shapes[:, order] / np.sqrt(2.0)
    return np.sqrt(np.maximum(squares[order], 0.0)) / (2.0 * np.pi), whole


def _free_unknowns(structure):
    """Unknowns of both bodies that the symmetry leaves free."""
    first, second = structure.symmetric
    size = structure.bodies[0].unknown_count
    return np.setdiff1d(
        np.arange(size + structure.bodies[1].unknown_count), np.concatenate([first, second + size])
    )


def reduce_beam(structure, law, preload, shear, gap=None):
    """Preload the bolts [N], then compute mode and compliance; `shear` is K_T/K_N [1].

    gap : [m] of the unloaded faces at places x, y; None: they are plane
    """
    solution = structure.solve_preload(law, preload, gap)
    normal = solution.contact_stiffness
    springs = np.stack([shear * normal, shear * normal, normal], axis=1)
    frequencies, shapes = spectrum(structure, springs)
    shape = shapes[:, 0] * np.sign(shapes[_tip(structure), 0])
    motion = np.stack([structure.relative(axis) @ shape for axis in AXES], axis=1)
    compliance = _compliance(structure, springs)
    at = structure.interface
    tip = float(shape[_tip(structure)])
    return ReducedBeam(
        frequencies,
        tip,
        solution.approach,
        springs,
        at.quadrature_area,
        at.quadrature_position,
        motion,
        compliance,
    )


def _tip(structure):
    """Index of the vertical displacement of the left end."""
    x, y, z = structure.bodies[0].node_positions
    return 3 * int(np.argmin(x + 1e-3 * np.abs(y) + 1e-3 * np.abs(z))) + 2


def _compliance(structure, springs):
    """Compliance (3 P, 3 P) [m/N] of the patches for pairs of opposite forces, ordered by patch, then x, y,
    z."""
    free = np.setdiff1d(_free_unknowns(structure), pinned_unknowns(structure.bodies[0]))
    factor = CholeskyFactor(structure.stiffness(springs)[free][:, free])
    stacked = sp.vstack([structure.relative(axis) for axis in AXES]).tocsr()
    count = stacked.shape[0] // 3
    opening = stacked[np.arange(3 * count).reshape(3, count).T.ravel()][:, free]
    columns = []
    for i in range(0, 3 * count, RIGHT_SIDES_PER_SOLVE):
        columns.append(
            opening @ factor.solve_linear_system(opening[i : i + RIGHT_SIDES_PER_SOLVE].T.toarray())
        )
    return np.hstack(columns)
