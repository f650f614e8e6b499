"""The lapped beam tightened, its first mode, and all that its interface needs to know of the bodies.

All but the interface is linear: under loads along the mode it is the compliance of the patches, exactly.
"""

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from jointfmu_tools.fem.contact import ContactInterface, ContactModel, displacement_matrix
from jointfmu_tools.fem.elasticity import Cholesky
from scipy.sparse.linalg import LinearOperator, eigsh

from . import mesh
from .plan import plan
from .shanks import shanks

SHIFT = 100.0
"""Frequency [Hz] below all modes with strain, at whose negative square the eigensolver looks."""
RIGID = 3
"""Motions without strain in the plane of symmetry."""
AT_ONCE = 64
"""Right sides that are solved at once."""
AXES = (0, 1, 2)


@dataclass(frozen=True)
class Structure:
    """Meshed beam without its interface.

    bodies    : half 1 and 2
    interface : its patches, one for each element of the contact, as points of a quadrature
    bolts     : [N/m] stiffness of the shanks between the unknowns of both bodies
    """

    beam: mesh.LapBeam
    bodies: tuple
    interface: ContactInterface
    bolts: sp.csr_matrix

    @classmethod
    def of(cls, beam, size):
        """Mesh a beam; one patch for each element of the contact."""
        view = plan(beam, size)
        bodies = mesh.bodies(beam, view, size)
        return cls(
            beam, bodies, patches(ContactInterface.from_mesh(mesh.contact(beam, view))), shanks(beam, bodies)
        )

    @property
    def symmetric(self):
        """Unknowns of each body that the plane of symmetry holds."""
        return tuple(3 * np.flatnonzero(body.nodes[1] < 1e-9) + 1 for body in self.bodies)

    def relative(self, axis):
        """Displacement (P, n) of half 1 against half 2 along an axis: along z the approach."""
        return sp.hstack(
            [
                s * displacement_matrix(b, self.interface, axis)
                for s, b in zip((1.0, -1.0), self.bodies, strict=True)
            ]
        )

    def tightened(self, law, preload, gap=None):
        """Equilibrium without friction under a preload [N] of each bolt; gap [m] at places x, y or None."""
        heads = [f"head{i}" for i in range(len(self.beam.bolts))]
        pull = [sum(b.uniform_load(b.mesh.boundaries[name]) for name in heads) for b in self.bodies]
        loads = [0.5 * preload * sign * load for sign, load in zip((1.0, -1.0), pull, strict=True)]
        first, second = self.symmetric
        slides = 3 * _ends(self.bodies[1])[0]
        held = (np.union1d(first, pins(self.bodies[0])), np.union1d(second, slides))
        model = ContactModel(self.bodies, self.interface, law, gap, fixed_unknowns=held)
        area = self.interface.quadrature_area.sum()
        return model.solve(loads, 0.5 * preload * len(heads) / area)

    def stiffness(self, springs):
        """[N/m] of the beam on springs (P, 3) [N/m3] at its patches, along x, y and z."""
        total = sp.block_diag([body.stiffness for body in self.bodies], format="csr") + self.bolts
        for axis in AXES:
            opening = self.relative(axis)
            total = total + opening.T @ sp.diags(self.interface.quadrature_area * springs[:, axis]) @ opening
        return total.tocsr()


def _ends(body):
    """Nodes at both ends of a body on the line y = z = 0."""
    x, y, z = body.nodes
    line = np.flatnonzero((np.abs(y) < 1e-9) & (np.abs(z) < 1e-9))
    return line[np.argmin(x[line])], line[np.argmax(x[line])]


def pins(body):
    """Three unknowns that stop the motions of a body in the plane of symmetry."""
    first, last = _ends(body)
    return np.array([3 * first, 3 * first + 2, 3 * last + 2])


def patches(interface):
    """One point for each element of a contact: mean displacement, area and centroid."""
    count, points = interface.basis.dx.shape
    rows = np.repeat(np.arange(count), points)
    share = sp.csr_matrix((interface.quadrature_area, (rows, np.arange(rows.size))), shape=(count, rows.size))
    area = np.asarray(share.sum(axis=1)).ravel()
    mean = sp.diags(1.0 / area) @ share
    return ContactInterface(
        interface.basis,
        interface.nodes,
        (mean @ interface.interpolation_matrix).tocsr(),
        area,
        mean @ interface.quadrature_position,
    )


@dataclass(frozen=True)
class Reduced:
    """The first mode of the tightened beam, and its patches.

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
        """[Hz] of the first mode."""
        return float(self.frequencies[0])


def spectrum(structure, springs, count=3):
    """Frequencies [Hz] and shapes (n, count) of the lowest modes; modal mass of the whole beam 1 kg."""
    free = _free(structure)
    stiffness = structure.stiffness(springs)[free][:, free]
    mass = sp.block_diag([body.mass for body in structure.bodies], format="csr")[free][:, free]
    shift = -((2.0 * np.pi * SHIFT) ** 2)
    factor = Cholesky(stiffness - shift * mass)
    inverse = LinearOperator(stiffness.shape, matvec=factor.solve, dtype=np.float64)
    start = np.random.default_rng(1).standard_normal(free.size)
    squares, shapes = eigsh(stiffness, k=RIGID + count, M=mass, sigma=shift, OPinv=inverse, v0=start)
    whole = np.zeros((sum(b.unknown_count for b in structure.bodies), count))
    order = np.argsort(squares)[RIGID:]
    whole[free] = shapes[:, order] / np.sqrt(2.0)
    return np.sqrt(np.maximum(squares[order], 0.0)) / (2.0 * np.pi), whole


def _free(structure):
    """Unknowns of both bodies that the plane of symmetry leaves free."""
    first, second = structure.symmetric
    size = structure.bodies[0].unknown_count
    return np.setdiff1d(
        np.arange(size + structure.bodies[1].unknown_count), np.concatenate([first, second + size])
    )


def reduced(structure, law, preload, shear, gap=None):
    """Tighten the bolts to a preload [N] each, then mode and compliance; shear is K_T/K_N [1].

    gap : [m] of the unloaded faces at places x, y; None: they are plane
    """
    solution = structure.tightened(law, preload, gap)
    normal = solution.stiffness
    springs = np.stack([shear * normal, shear * normal, normal], axis=1)
    frequencies, shapes = spectrum(structure, springs)
    shape = shapes[:, 0] * np.sign(shapes[_tip(structure), 0])
    motion = np.stack([structure.relative(axis) @ shape for axis in AXES], axis=1)
    compliance = _compliance(structure, springs)
    at = structure.interface
    tip = float(shape[_tip(structure)])
    return Reduced(
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
    """Unknown of the deflection of the left end."""
    x, y, z = structure.bodies[0].nodes
    return 3 * int(np.argmin(x + 1e-3 * np.abs(y) + 1e-3 * np.abs(z))) + 2


def _compliance(structure, springs):
    """Relative displacement (3 P) of the patches by pairs of forces (3 P): patch by patch x, y, z."""
    free = np.setdiff1d(_free(structure), pins(structure.bodies[0]))
    factor = Cholesky(structure.stiffness(springs)[free][:, free])
    stacked = sp.vstack([structure.relative(axis) for axis in AXES]).tocsr()
    count = stacked.shape[0] // 3
    opening = stacked[np.arange(3 * count).reshape(3, count).T.ravel()][:, free]
    columns = []
    for i in range(0, 3 * count, AT_ONCE):
        columns.append(opening @ factor.solve(opening[i : i + AT_ONCE].T.toarray()))
    return np.hstack(columns)
