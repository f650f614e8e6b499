"""Boundary elements of two equal elastic bodies: normal contact, then shear with Coulomb's friction.

The square has the side 1, the contact modulus E* is 1 and so is the friction: it scales forces and shifts.
Between equal bodies a pressure shifts nothing and a traction lifts nothing, the two problems are apart.
A wave of wavenumber k moves the surfaces by 2 p/k under a pressure, by 2 q/k under a traction along the wave
and by 2 q/(k (1 - nu)) under one across it (Boussinesq, Cerruti; G = (1 - nu) E*).

Both problems look for the least of x.Cx/2 - x.pull among what is allowed: pressures that do not pull, or
tractions within the friction of each point. One method serves both: projected gradients with the momentum of
Nesterov (2004) for a known range of compliances.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy import fft
from scipy.sparse.linalg import LinearOperator, eigsh

TOLERANCE, MOST = 1e-7, 5000
"""Last step of the gradients over the solution [1]; most steps."""
BELOW = 0.95
"""Step over the largest that converges [1]; its bound is known to a hundredth, from the wrong side."""


@dataclass(frozen=True)
class HalfSpace:
    """Compliance of the interface in waves.

    points  : along a side; period : points after which tractions repeat, twice `points` for a lone square
    normal  : (waves); shear : (3, waves) xx, xy, yy
    """

    points: int
    period: int
    nu: float
    normal: np.ndarray
    shear: np.ndarray

    @property
    def least(self):
        """Smallest compliance of any traction: that of the shortest wave, across the diagonal."""
        return np.min(self.normal[self.normal > 0.0])

    @property
    def ratio(self):
        """K_T/K_N [1] of a round contact (Mindlin)."""
        return 2.0 * (1.0 - self.nu) / (2.0 - self.nu)

    def lifted(self, pressure):
        """Normal displacement (points, points) under a pressure."""
        return self._back(self.normal * self._waves(pressure))

    def shifted(self, traction):
        """Displacements (2, points, points) along the surface under tractions of the same shape."""
        (x, y), (xx, xy, yy) = self._waves(traction), self.shear
        return self._back(np.stack([xx * x + xy * y, xy * x + yy * y]))

    def _waves(self, field):
        return fft.rfft2(field, (self.period, self.period))

    def _back(self, waves):
        return fft.irfft2(waves, (self.period, self.period))[..., : self.points, : self.points]


def periodic(points, nu):
    """Half-space whose square repeats; displacements count from their mean."""
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


def lone(points, nu):
    """Half-space with one square: uniform traction on each element (Love), padded with zeros."""
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
    """Bodies pressed together; all that touches under a smaller approach touches here.

    heights, pressure : (points, points); approach : of the mean planes, counted from heights of zero
    steps             : of the gradients, normal and along the surface
    """

    space: HalfSpace
    heights: np.ndarray
    approach: float
    pressure: np.ndarray
    steps: tuple[float, float]

    @classmethod
    def at(cls, space, heights, approach):
        """Contact at an approach."""
        crude = 1.0 / np.max(np.abs(space.normal))
        start = np.zeros_like(heights)
        pressure = _pressure(space, heights + approach, start, np.ones_like(heights, dtype=bool), crude)
        touching = pressure > 0.0
        both = np.stack([touching, touching])
        steps = tuple(
            BELOW / _largest(act, where) for act, where in ((space.lifted, touching), (space.shifted, both))
        )
        return cls(space, heights, approach, pressure, steps)

    @property
    def load(self):
        """Mean pressure of the square, the friction limit of the whole contact too."""
        return float(np.mean(self.pressure))

    @property
    def area(self):
        """Real area over nominal [1]."""
        return float(np.mean(self.pressure > 0.0))

    def lighter(self, drops):
        """Loads (n) at approaches that are smaller by `drops` (n)."""
        loads, pressure, touching = np.empty(len(drops)), self.pressure, self.pressure > 0.0
        for i in np.argsort(drops):
            gap = self.heights + self.approach - drops[i]
            pressure = _pressure(self.space, gap, pressure, touching, self.steps[0])
            loads[i] = pressure.mean()
        return loads

    def at_rest(self):
        """No shear."""
        nothing = np.zeros((2, *self.pressure.shape))
        return Sheared(np.zeros(2), nothing, nothing)

    def moved(self, before, shift):
        """The shear after a straight path to `shift` (2): each point sticks, or slips along its traction."""
        pull = before.give + (np.asarray(shift) - before.shift)[:, None, None]

        def allowed(traction):
            size = np.hypot(*traction)
            return traction * (self.pressure / np.maximum(size, np.maximum(self.pressure, 1e-300)))

        traction = _least(self.space.shifted, pull, allowed, before.traction, self.steps[1], self.space.least)
        return replace(before, shift=np.asarray(shift), traction=traction, give=self.space.shifted(traction))


@dataclass(frozen=True)
class Sheared:
    """Shear of a contact: shift (2) of the bodies; traction and its elastic give, (2, points, points)."""

    shift: np.ndarray
    traction: np.ndarray
    give: np.ndarray

    @property
    def force(self):
        """Force (2) over the nominal area."""
        return self.traction.mean(axis=(1, 2))


def _pressure(space, overlap, start, where, step):
    return _least(
        space.lifted, overlap, lambda p: np.where(where, np.maximum(p, 0.0), 0.0), start, step, space.least
    )


def _least(act, pull, allowed, start, step, least):
    """What is allowed and makes x.act(x)/2 - x.pull least; `least` is the smallest eigenvalue of act."""
    root = np.sqrt(step * least)
    momentum = (1.0 - root) / (1.0 + root)
    old = ahead = allowed(start)
    for _ in range(MOST):
        new = allowed(ahead + step * (pull - act(ahead)))
        if np.max(np.abs(ahead - new)) <= TOLERANCE * np.max(np.abs(new)):
            return new
        old, ahead = new, new + momentum * (new - old)
    raise RuntimeError(f"no convergence in {MOST} steps")


def _largest(act, where):
    """Largest eigenvalue of a compliance on the points `where`."""
    count, field = int(where.sum()), np.zeros(where.shape)

    def product(values):
        field[where] = values.ravel()
        return act(field)[where]

    operator = LinearOperator((count, count), product, dtype=float)
    return float(eigsh(operator, 1, v0=np.ones(count), tol=0.01, return_eigenvectors=False)[0])
