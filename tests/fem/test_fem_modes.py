"""Modes of two bodies on contact springs, against closed forms."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from jointfmu_tools.fem.contact import ContactInterface
from jointfmu_tools.fem.elasticity import ElasticBody
from jointfmu_tools.fem.modes import compute_modes
from scipy.linalg import eigh
from scipy.optimize import brentq
from skfem import MeshHex, MeshQuad

pytestmark = pytest.mark.slow


@dataclass(frozen=True)
class Block:
    length: float = 0.3
    width: float = 0.2
    thickness: float = 0.1
    E: float = 2e11
    nu: float = 0.28
    density: float = 7800.0

    @property
    def mass(self):
        return self.density * self.length * self.width * self.thickness

    def body(self, size, sign):
        x, y, z = (steps(end, size) for end in (self.length, self.width, self.thickness))
        mesh = MeshHex.init_tensor(x - 0.5 * self.length, y - 0.5 * self.width, np.sort(sign * z))
        return ElasticBody(mesh, self.E, self.nu, self.density)

    def contact(self, size):
        x, y = steps(self.length, size), steps(self.width, size)
        return ContactInterface.from_mesh(MeshQuad.init_tensor(x - 0.5 * self.length, y - 0.5 * self.width))


def steps(end, size):
    return np.linspace(0.0, end, round(end / size) + 1)


def solve(below, above, size, normal, tangential, count=6):
    """Modes of two blocks with the same plan; if `below` is None, of a block and its mirror image."""
    bodies = tuple(one.body(size, sign) for one, sign in ((below, -1), (above, 1)) if one)
    interface = above.contact(size)
    ones = np.ones(interface.quadrature_area.size)
    return bodies, compute_modes(bodies, interface, normal * ones, tangential * ones, count)


def test_rod_of_two_halves():
    # without lateral contraction u_z(z) solves the rod exactly: with the interface's k per area and
    # q = 2 pi f sqrt(density/E) of a half rod of length L, E q tan(q L) = 2 k (halves against each other)
    k, length = 4e11, 0.6
    half = Block(length=0.05, width=0.05, thickness=length, nu=0.0)
    found = solve(None, half, 0.05, k, k, 24)[1].natural_frequencies
    speed = np.sqrt(half.E / half.density)
    root = brentq(lambda q: half.E * q * np.tan(q * length) - 2.0 * k, 1e-6, 0.5 * np.pi / length - 1e-9)
    for q in (root, np.pi / length):
        # quadratic elements of length h raise f by (q h)^4/1440; the interface's share of the strain is exact
        error = found / (q * speed / (2.0 * np.pi)) - 1.0
        nearest = error[np.argmin(np.abs(error))]
        assert 0.0 < nearest < 1.001 * (q * 0.05) ** 4 / 1440.0


def rigid_frequencies(one, other, normal, tangential):
    """Frequencies of two rigid plates on distributed springs: twelve degrees of freedom about the centres of
    mass."""
    mass, stiffness = [], np.zeros((12, 12))
    for plate in (one, other):
        m = plate.density * plate.length * plate.width * plate.thickness
        a, b, c = plate.length, plate.width, plate.thickness
        mass += [m, m, m, m * (b**2 + c**2) / 12, m * (a**2 + c**2) / 12, m * (a**2 + b**2) / 12]
    nodes, weights = np.polynomial.legendre.leggauss(2)
    for s, ws in zip(nodes, weights, strict=True):
        for t, wt in zip(nodes, weights, strict=True):
            x, y = 0.5 * one.length * s, 0.5 * one.width * t
            rows = []
            for plate, sign in ((one, -1.0), (other, 1.0)):
                z = -sign * 0.5 * plate.thickness  # of the contact from the centre
                rows.append(sign * np.array([[1, 0, 0, 0, z, -y], [0, 1, 0, -z, 0, x], [0, 0, 1, y, -x, 0]]))
            gap = np.hstack(rows)
            area = one.length * one.width * ws * wt / 4.0
            stiffness += area * gap.T @ np.diag([tangential, tangential, normal]) @ gap
    return np.sqrt(np.maximum(eigh(stiffness, np.diag(mass), eigvals_only=True)[6:], 0.0)) / (2.0 * np.pi)


@pytest.mark.parametrize("other", [Block(E=2e17), Block(E=2e17, thickness=0.15, density=2700.0)])
def test_rigid_bodies(other):
    one = Block(E=2e17)
    _, found = solve(one, other, 0.05, 3e11, 1e11)
    # the blocks are 1e6 times as stiff as the springs: their compliance lowers f by about 1e-6
    np.testing.assert_allclose(
        found.natural_frequencies, rigid_frequencies(one, other, 3e11, 1e11), rtol=1e-5
    )
    assert found.assembly_mass == pytest.approx(one.mass + other.mass, rel=1e-12)


def test_mirror_image_is_the_other_body():
    _, halves = solve(None, Block(), 0.05, 5e11, 2e11)
    _, whole = solve(Block(), Block(), 0.05, 5e11, 2e11)
    np.testing.assert_allclose(
        halves.natural_frequencies, whole.natural_frequencies, rtol=1e-9
    )  # eigsh stops at round-off
    assert halves.assembly_mass == pytest.approx(whole.assembly_mass, rel=1e-12)


def test_shapes_have_unit_mass():
    for below in (None, Block()):
        bodies, found = solve(below, Block(), 0.05, 5e11, 2e11, 4)
        for shape in found.mode_shapes:
            # the halves are equal, so each carries half of the kinetic energy
            energy = [float(u.ravel() @ bodies[-1].mass_matrix @ u.ravel()) for u in (shape[1],)]
            assert energy == pytest.approx([0.5], rel=1e-8)
            assert shape[0].shape == shape[1].shape


def test_stiffer_contact_rings_higher():
    soft, hard, glued = (
        solve(None, Block(), 0.05, k, 0.45 * k)[1].natural_frequencies for k in (2e11, 8e11, 1e16)
    )
    assert np.all(soft < hard)
    assert np.all(hard < glued)
    # glued, the two are one block: split in the middle it has a soft joint nowhere
    thick = Block(thickness=0.2)
    other, far = replace(thick, thickness=0.05), replace(thick, thickness=0.15)
    np.testing.assert_allclose(solve(other, far, 0.05, 1e16, 1e16)[1].natural_frequencies, glued, rtol=1e-4)


def test_a_contact_that_does_not_hold_is_refused():
    with pytest.raises(RuntimeError, match="does not hold the bodies"):
        solve(None, Block(), 0.1, 5e11, 0.0)


def test_finer_elements_converge():
    # conforming elements stiffen a body: every frequency falls towards its limit, at least at first order
    f = [solve(None, Block(), size, 5e11, 2e11)[1].natural_frequencies for size in (0.1, 0.05, 0.025)]
    first, second = f[0] / f[1] - 1.0, f[1] / f[2] - 1.0
    assert np.all(second > 0.0)
    assert np.all(second < 0.5 * first)
