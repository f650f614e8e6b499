"""Partial slip by boundary elements: two equal elastic bodies, normal contact, then Coulomb friction.

The square has the side 1, the contact modulus E* is 1, and so is the friction coefficient: it scales forces
and displacements. For equal bodies the normal and the tangential problem are uncoupled. A wave of wavenumber
k is displaced by 2 p/k under a pressure, by 2 q/k under a traction along the wave, and by 2 q/(k (1 - nu))
under one across it (Boussinesq, Cerruti; G = (1 - nu) E*).

Both problems minimize x.Cx/2 - x.b over the admissible x: pressures >= 0, or tractions within the friction
limit of each point. One method solves both: projected gradients with the momentum of Nesterov (2004), for a
known range of eigenvalues of C.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy import fft
from scipy.sparse.linalg import LinearOperator, eigsh

TOLERANCE, MAX_STEPS = 1e-7, 5000
"""Last gradient step over the solution [1]; largest number of steps."""
STEP_RATIO = 0.95
"""Step over the largest convergent step [1]: the largest eigenvalue is known to 1 %, from below."""


@dataclass(frozen=True)
class HalfSpace:
    """Compliance of the interface in Fourier space.

    points : grid points along a side
    period : points after which the tractions repeat; twice `points` for one square that does not repeat
    normal : (waves) normal compliance; shear : (3, waves) tangential compliance xx, xy, yy
    """

    points: int
    period: int
    nu: float
    normal: np.ndarray
    shear: np.ndarray

    @property
    def min_compliance(self):
        """Smallest eigenvalue of the compliance: the shortest wave, along the diagonal."""
        return np.min(self.normal[self.normal > 0.0])

    @property
    def stiffness_ratio(self):
        """K_T/K_N [1] of a round contact (Mindlin)."""
        return 2.0 * (1.0 - self.nu) / (2.0 - self.nu)

    def normal_displacement(self, pressure):
        """Normal displacement (points, points) under a pressure."""
        return self._back(self.normal * self._waves(pressure))

    def tangential_displacement(self, traction):
        """Displacements (2, points, points) along the surface under tractions of the same shape."""
        (x, y), (xx, xy, yy) = self._waves(traction), self.shear
        return self._back(np.stack([xx * x + xy * y, xy * x + yy * y]))

    def _waves(self, field):
        return fft.rfft2(field, (self.period, self.period))

    def _back(self, waves):
        return fft.irfft2(waves, (self.period, self.period))[..., : self.points, : self.points]


def periodic(points, nu):
    """Half-space with a periodic square; displacements are relative to their mean."""
    f = np.fft.fftfreq(points, 1.0 / points)[:, None], np.fft.rfftfreq(points, 1.0 / points)
    k = 2.0 * np.pi * np.hypot(*f)
    k[0, 0] = np.inf
    cosine, sine = (2.0 * np.pi * one / k for one in f)
    along, across = 2.0 / k, 2.0 / (k * (1.0 - nu))
    paired = (np.abs(f[0]) < points / 2) & (f[1] < points / 2)  # the shortest wave has no opposite
    shear = (
        along * cosine**2 + across * sine**2,
        (along - across) * cosine * sine * paired,
        along * sine**2 + across * cosine**2,
    )
    return HalfSpace(points, points, nu, along, np.stack(shear))


def single_square(points, nu):
    """Half-space with one loaded square that does not repeat: uniform traction on each element (Love)."""
    edge = (np.fft.fftfreq(2 * points, 0.5 / points)[:, None] + (-0.5, 0.5)) / points
    x, y = edge.T[:, :, None], edge.T[:, None, None, :]

    def element(primitive):
        corner = primitive(x, y)
        return corner[1, 1] - corner[1, 0] - corner[0, 1] + corner[0, 0]

    xx = element(lambda x, y: y * np.arcsinh(x / np.abs(y)))  # of x^2/r^3
    xy = element(lambda x, y: -np.hypot(x, y))  # of x y/r^3
    yy = xx.T
    part = nu / (1.0 - nu)
    fields = (xx + yy, xx + yy + part * xx, part * xy, xx + yy + part * yy)
    normal, *shear = fft.rfft2(np.stack(fields) / np.pi).real
    return HalfSpace(points, 2 * points, nu, normal, np.stack(shear))


@dataclass(frozen=True)
class Contact:
    """Two bodies in normal contact.

    heights, pressure : (points, points)
    approach          : approach of the mean planes, zero where heights of zero touch
    steps             : gradient steps of the normal and of the tangential problem
    """

    space: HalfSpace
    heights: np.ndarray
    approach: float
    pressure: np.ndarray
    steps: tuple[float, float]

    @classmethod
    def at_approach(cls, space, heights, approach):
        """Solve the normal contact at an approach."""
        crude = 1.0 / np.max(np.abs(space.normal))
        start = np.zeros_like(heights)
        pressure = _pressure(space, heights + approach, start, np.ones_like(heights, dtype=bool), crude)
        touching = pressure > 0.0
        both = np.stack([touching, touching])
        steps = tuple(
            STEP_RATIO / _max_eigenvalue(compliance, where)
            for compliance, where in (
                (space.normal_displacement, touching),
                (space.tangential_displacement, both),
            )
        )
        return cls(space, heights, approach, pressure, steps)

    @property
    def load(self):
        """Mean pressure over the square; as friction is 1, also the friction limit of the whole contact."""
        return float(np.mean(self.pressure))

    @property
    def area(self):
        """Real area over nominal [1]."""
        return float(np.mean(self.pressure > 0.0))

    def loads_unloaded(self, drops):
        """Loads (n) at approaches that are smaller than the present one by `drops` (n)."""
        loads, pressure, touching = np.empty(len(drops)), self.pressure, self.pressure > 0.0
        for i in np.argsort(drops):
            gap = self.heights + self.approach - drops[i]
            pressure = _pressure(self.space, gap, pressure, touching, self.steps[0])
            loads[i] = pressure.mean()
        return loads

    def unsheared(self):
        """Contact state without shear."""
        nothing = np.zeros((2, *self.pressure.shape))
        return Sheared(np.zeros(2), nothing, nothing)

    def shear_to(self, before, shift):
        """State of shear after a straight path to `shift` (2): each point sticks, or slips along its
        traction."""
        pull = before.displacement + (np.asarray(shift) - before.shift)[:, None, None]

        def allowed(traction):
            size = np.hypot(*traction)
            return traction * (self.pressure / np.maximum(size, np.maximum(self.pressure, 1e-300)))

        compliance = self.space.tangential_displacement
        traction = _minimize(
            compliance, pull, allowed, before.traction, self.steps[1], self.space.min_compliance
        )
        return replace(before, shift=np.asarray(shift), traction=traction, displacement=compliance(traction))


@dataclass(frozen=True)
class Sheared:
    """State of a sheared contact.

    shift : (2) relative displacement of the bodies
    traction, displacement : (2, points, points), and the elastic displacement that it causes
    """

    shift: np.ndarray
    traction: np.ndarray
    displacement: np.ndarray

    @property
    def force(self):
        """Tangential force (2) over the nominal area."""
        return self.traction.mean(axis=(1, 2))


def _pressure(space, overlap, start, where, step):
    def compressive(p):
        return np.where(where, np.maximum(p, 0.0), 0.0)

    return _minimize(space.normal_displacement, overlap, compressive, start, step, space.min_compliance)


def _minimize(compliance, load, project, start, step, min_compliance):
    """Minimum of x.Cx/2 - x.load on the set onto which `project` projects; eigenvalues of C are >=
    `min_compliance`."""
    root = np.sqrt(step * min_compliance)
    momentum = (1.0 - root) / (1.0 + root)
    old = ahead = project(start)
    for _ in range(MAX_STEPS):
        new = project(ahead + step * (load - compliance(ahead)))
        if np.max(np.abs(ahead - new)) <= TOLERANCE * np.max(np.abs(new)):
            return new
        old, ahead = new, new + momentum * (new - old)
    raise RuntimeError(f"no convergence in {MAX_STEPS} steps")


def _max_eigenvalue(compliance, where):
    """Largest eigenvalue of a compliance on the points `where`."""
    count, field = int(where.sum()), np.zeros(where.shape)

    def product(values):
        field[where] = values.ravel()
        return compliance(field)[where]

    operator = LinearOperator((count, count), product, dtype=float)
    return float(eigsh(operator, 1, v0=np.ones(count), tol=0.01, return_eigenvectors=False)[0])
