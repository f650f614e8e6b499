"""Print the tables of docs/validity_friction.md, two minutes; `--images` draws its picture too.

`python benchmarks/partial_slip.py [--images]`
"""

import sys
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from itertools import product

import numpy as np
import slip_cases as cases
import slip_picture
import slip_tables as tables
from boundary_element import press, refined

from jointfmu.progress import track_progress

NU = 0.3
SEPARATIONS = {500: 1.0, 501: 1.5, 700: 1.0, 701: 1.5}
"""Seeds, and how far apart the mean planes are when they are sheared [rms heights]: two loads."""
HURST = (0.3, 0.55, 0.8)
SEEDS = {1: (700, 701), 4: (700, 701), 8: (700,)}
"""Of surfaces with waves up to side/1, side/4 and side/8."""
STRETCH = 4
"""Textured surfaces: so much shorter are their waves along x."""
SPHERES = tuple(product((0.0, NU), (24, 48, 96)))
"""Poisson's ratio and points along a side."""
GRIDS = (1, 2, 4)
"""Refinements of one surface of COARSE points."""
COARSE = 64


@dataclass(frozen=True)
class Surface:
    """One rough surface, sheared along x and along y."""

    hurst: float
    roll_off: int
    seed: int = 700
    nu: float = NU
    stretch: int = 1

    def contact(self):
        z = cases.heights(self.hurst, self.roll_off, self.seed, stretch=self.stretch)
        return cases.rough(z, self.nu, SEPARATIONS[self.seed])

    def compared(self):
        contact = self.contact()
        told = cases.foretold(contact)
        return [cases.compared(contact, told, axis) for axis in (0, 1)]


ISOTROPIC = [Surface(H, r, seed) for r, seeds in SEEDS.items() for H in HURST for seed in seeds]
OTHERS = {
    "one hill, other seeds": [Surface(H, 1, seed) for H in HURST for seed in (500, 501)],
    "nu = 0": [Surface(0.3, 4, nu=0.0), Surface(0.8, 1, nu=0.0)],
    "nu = 0.49": [Surface(0.3, 4, nu=0.49), Surface(0.8, 4, nu=0.49)],
    "textured": [Surface(0.3, 1, stretch=STRETCH), Surface(0.8, 1, stretch=STRETCH)],
}


def grid(factor):
    """One rough surface on a finer grid."""
    contact = cases.rough(refined(cases.heights(0.8, 4, 700, points=COARSE), factor), NU)
    return cases.compared(contact, cases.foretold(contact, amplitudes=(0.5, 0.9)))


def tamaas():
    """Largest difference of pressures from tamaas' [mean pressures], and of approaches [rms heights]."""
    z = cases.heights(0.8, 4, 700, points=COARSE)
    contact = cases.rough(z, NU)
    other = press(z, [contact.load])[0]
    pressure = np.max(np.abs(other.pressure - contact.pressure)) / contact.load
    return pressure, abs(other.separation + contact.approach) / z.std()


def main():
    """Print the tables."""
    surfaces = [*ISOTROPIC, *(s for some in OTHERS.values() for s in some)]
    with ProcessPoolExecutor() as pool:
        spheres = [pool.submit(cases.sphere_misses, points, nu) for nu, points in SPHERES]
        grids = pool.map(grid, GRIDS)
        rough = track_progress(pool.map(Surface.compared, surfaces), "surfaces", len(surfaces))
        found = dict(zip(surfaces, rough, strict=True))
        tables.solver(*tamaas())
        tables.spheres(SPHERES, [one.result() for one in spheres])
        tables.grids([COARSE * factor for factor in GRIDS], list(grids))
    kinds = {}
    for s in ISOTROPIC:
        kinds.setdefault((s.hurst, s.roll_off), []).extend(found[s])
    tables.displacements(kinds)
    tables.loops(kinds)
    groups = {
        "waves up to the side": [one for s in ISOTROPIC if s.roll_off == 1 for one in found[s]],
        "waves up to side/4, side/8": [one for s in ISOTROPIC if s.roll_off > 1 for one in found[s]],
        **{name: [one for s in some for one in found[s]] for name, some in OTHERS.items()},
        "textured, across the ridges": [found[s][0] for s in OTHERS["textured"]],
        "textured, along the ridges": [found[s][1] for s in OTHERS["textured"]],
    }
    tables.summary(groups)
    tables.exponents(groups)
    if "--images" in sys.argv:
        slip_picture.draw(ISOTROPIC[-1].contact(), [one for s in ISOTROPIC for one in found[s]])


if __name__ == "__main__":
    main()
