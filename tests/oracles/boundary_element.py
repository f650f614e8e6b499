"""Rough normal contact by boundary elements (tamaas, AGPL: for tests and studies only), and their checks.

The square has the side 1 and the half-space the contact modulus 1: in SI the solvers' tolerances fail.
"""

from dataclasses import dataclass

import numpy as np
from scipy import ndimage
from scipy.sparse.linalg import LinearOperator, cg

try:
    import tamaas as tm
except ImportError:  # it has wheels for some platforms only; there this module can be imported, not used
    pass
else:
    tm.set_log_level(tm.LogLevel.error)


@dataclass(frozen=True)
class Contact:
    """Rough contact under a mean pressure p (over E*).

    area, plastic : real area over nominal, share of it at the hardness
    separation    : distance of the mean planes (of the side)
    stiffness     : stiffness per nominal area (E* over side)
    isolated      : 2 sum sqrt(a_i/pi) over the spots, the stiffness if no spot felt another
    """

    p: float
    area: float
    plastic: float
    separation: float
    stiffness: float
    isolated: float
    pressure: np.ndarray


def half_space(points, nu=None):
    """Periodic half-space with E* = 1; a Poisson ratio nu is needed for tractions in three directions."""
    kind = tm.model_type.basic_2d if nu is None else tm.model_type.surface_2d
    model = tm.ModelFactory.createModel(kind, [1.0, 1.0], [points, points])
    model.nu = nu or 0.0
    model.E = 1.0 - model.nu**2
    return model


def displaced(model, traction, free=False):
    """Displacement of the surface under a traction; `free`: of a single half-space that is not periodic."""
    if free:
        tm.ModelFactory.registerNonPeriodic(model, "dcfft")
        displacement = np.zeros_like(traction)
        model.operators["dcfft"](traction, displacement)
        return displacement
    model.traction[:] = traction
    model.solveNeumann()
    return np.array(model.displacement)


def press(heights, pressures, hardness=np.inf, iterations=200):
    """Contacts of a rigid rough surface (heights over the side) with the half-space, at increasing mean
    pressures.

    The elastic solution uses Polonsky and Keer's conjugate gradients. If its pressure exceeds the hardness,
    Kato's solver continues from it with the pressure limited to the hardness: perfectly plastic spots, whose
    flow does not lift their surroundings.
    """
    surface = np.ascontiguousarray(heights - np.mean(heights))
    model = half_space(surface.shape[0])
    elastic = tm.PolonskyKeerRey(model, surface, 1e-9)
    elastic.max_iter = 3000
    plastic = tm.KatoSaturated(model, surface, 1e-7, hardness)
    plastic.max_iter = iterations
    contacts = []
    for p in pressures:
        try:
            elastic.solve(float(p))
        except tm.FloatingPointError:
            raise ValueError(
                f"p = {p:g} E*: a single point touches; take a larger p or more points"
            ) from None
        if np.max(model.traction) > hardness:
            plastic.solve(float(p))
        contacts.append(_contact(model, surface, float(p), hardness))
    return contacts


def _contact(model, surface, p, hardness):
    pressure = np.array(model.traction)
    touching = pressure > 0.0
    full = pressure >= hardness * (1.0 - 1e-9)
    elastic = touching & ~full
    lifted = displaced(model, pressure) - surface
    separation = -np.mean(lifted[elastic if elastic.any() else touching])
    labels, _ = ndimage.label(touching)
    spots = np.bincount(labels.ravel())[1:] / touching.size
    return Contact(
        p=p,
        area=float(np.mean(touching)),
        plastic=float(full.sum() / touching.sum()),
        separation=float(separation),
        stiffness=bonded(touching),
        isolated=float(2.0 * np.sqrt(spots / np.pi).sum()),
        pressure=pressure,
    )


def bonded(touching, nu=None, axis=2, free=False):
    """Stiffness per nominal area (E* over side) for small motions that do not change the contact area.

    This is the stiffness in vibration and ultrasound, and of a plastic contact on unloading: all points in
    contact have unit displacement. With nu, the motion is along an axis (0, 1 tangential, 2 normal) of one
    elastic body against a rigid one, with zero tractions along the other axes (as between two equal bodies).
    """
    model = half_space(touching.shape[0], nu)
    place = (touching,) if nu is None else (touching, axis)
    traction = np.zeros(model.traction.shape)

    def motion(q):
        traction[place] = q
        return displaced(model, traction, free)[place]

    count = int(touching.sum())
    q, failed = cg(LinearOperator((count, count), motion), np.ones(count), rtol=1e-7, maxiter=2000)
    if failed:
        raise RuntimeError(f"bonded contact of {count} points: no convergence")
    return float(q.sum() / touching.size)


def refined(heights, factor):
    """The same periodic surface on a grid refined by an integer factor."""
    n = heights.shape[0]
    waves, size = np.fft.fftshift(np.fft.fft2(heights)), n * factor
    pad = (size - n) // 2
    wide = np.zeros((size, size), dtype=complex)
    wide[pad : pad + n, pad : pad + n] = waves
    return np.fft.ifft2(np.fft.ifftshift(wide)).real * factor**2


def slope(heights):
    """Root mean square gradient of periodic heights on the unit square."""
    n = heights.shape[0]
    f = np.fft.fftfreq(n, 1.0 / n)
    power = np.abs(np.fft.fft2(heights)) ** 2 / n**4
    return float(2.0 * np.pi * np.sqrt(np.sum(power * (f[:, None] ** 2 + f**2))))


def hertz(points, contact=0.25, radius=10.0):
    """Relative errors (area, peak pressure, approach, stiffness) for a sphere (Hertz), not periodic.

    Closed form: a^3 = 3 F R/(4 E*), p_0 = 2 E* a/(pi R), delta = a^2/R, dF/ddelta = 2 E* a.
    """
    x = (np.arange(points) + 0.5) / points - 0.5
    surface = -(x[:, None] ** 2 + x**2) / (2.0 * radius)
    force = 4.0 * contact**3 / (3.0 * radius)
    model = half_space(points)
    tm.ModelFactory.registerNonPeriodic(model, "dcfft")
    solver = tm.PolonskyKeerRey(model, surface, 1e-12)
    solver.setIntegralOperator("dcfft")
    solver.solve(force)
    pressure = np.array(model.traction)
    touching = pressure > 0.0
    lifted = displaced(model, pressure, free=True) - surface
    exact = (np.pi * contact**2, 2.0 * contact / (np.pi * radius), contact**2 / radius, 2.0 * contact)
    found = (
        np.mean(touching),
        pressure.max(),
        np.mean(lifted[touching]),
        bonded(touching, free=True),
    )
    return np.array([f / e - 1.0 for f, e in zip(found, exact, strict=True)])


def westergaard(points, loads=(0.1, 0.3, 0.6), amplitude=0.01):
    """Relative errors (width, mean gap, stiffness) for a sinusoidal surface, the largest over loads in p*.

    Closed form with p* = pi E* amplitude and s = p/p*: s = sin^2(pi width/2), k = -p*/(amplitude ln s),
    mean gap = amplitude (1 - s + s ln s); all of the unit wavelength.
    """
    x = np.arange(points) / points
    surface = amplitude * np.cos(2.0 * np.pi * x)[:, None] * np.ones(points)
    errors = []
    for one, s in zip(press(surface, np.pi * amplitude * np.array(loads)), loads, strict=True):
        width = 2.0 / np.pi * np.arcsin(np.sqrt(s))
        gap, k = amplitude * (1.0 - s + s * np.log(s)), -np.pi / np.log(s)
        errors.append((one.area / width - 1.0, one.separation / gap - 1.0, one.stiffness / k - 1.0))
    return np.abs(errors).max(axis=0)
