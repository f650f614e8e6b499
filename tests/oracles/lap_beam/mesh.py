"""Meshes of a beam of two halves, lapped over its middle and bolted: half of its width, by symmetry.

x runs along the beam, y across it from the plane of symmetry, z through its height; the contact is z = 0.
Half 1 reaches from the left end to the right end of the lap, below the contact; half 2 is half 1 turned by
180 degrees about y. Head (or nut) and washers of a bolt are a disc on the outer face.
"""

from dataclasses import dataclass

import numpy as np
from jointfmu_tools.fem.elasticity import ElasticBody
from skfem import MeshHex, MeshQuad

HEADS = "head{}"
"""Name of the facets that the shank of bolt i loads: face of the disc above the hole."""


@dataclass(frozen=True)
class LapBeam:
    """Lengths [m] and material of the beam.

    length, lap  : lengths of the whole beam and of the overlap
    side         : height of the section; `width` the other side of it, None: a square
    bolts        : positions along x from the middle
    hole, washer : diameters of the clearance hole and of what presses on the outer face
    shank        : diameter of a bolt
    bolt_volume  : [m3] of a bolt with its nut and washers
    E, nu, density : [Pa], [1], [kg/m3] of beam and bolts
    """

    length: float
    lap: float
    side: float
    bolts: tuple[float, ...]
    hole: float
    washer: float
    shank: float
    bolt_volume: float
    E: float
    nu: float
    density: float
    width: float | None = None

    @property
    def across(self) -> float:
        """Width [m] of the cross section."""
        return self.side if self.width is None else self.width

    @property
    def head(self) -> float:
        """Height [m] of the disc that represents a bolt end: two discs have the volume of a bolt."""
        return self.bolt_volume / (0.5 * np.pi * self.washer**2)

    @property
    def holes(self) -> tuple[float, ...]:
        """Bolt positions along x if the beam has holes; else none."""
        return self.bolts if self.hole > 0.0 else ()


def bodies(beam, view, size):
    """Both halves of the beam; their boundaries under the bolt heads are named head0, head1, ..."""
    return tuple(ElasticBody(_half(beam, view, size, side), beam.E, beam.nu, beam.density) for side in (1, 2))


def contact(beam, view):
    """Plane mesh of the contact."""
    touching = (np.abs(view.centres[0]) < 0.5 * beam.lap) & ~view.cells_within(0.5 * beam.hole, beam.holes)
    used, cells = np.unique(view.cells[:, touching], return_inverse=True)
    return MeshQuad(np.ascontiguousarray(view.points[:, used]), np.ascontiguousarray(cells.reshape(4, -1)))


def _half(beam, view, size, side):
    """Mesh of half 1 or 2 of the beam, extruded level by level from the plan."""
    end, out = 0.5 * beam.lap, 1.0 if side == 2 else -1.0
    x, drilled = view.centres[0] * out, view.cells_within(0.5 * beam.hole, beam.holes)
    arm, own = x > end, (x > -end) & ~drilled
    under = view.cells_within(0.5 * beam.washer, beam.holes)
    height = 0.5 * beam.side
    levels = height * size.levels
    slabs = [(-z, arm) for z in levels[:0:-1]] + [(z, own) for z in levels[:-1]]
    levels = [z for z, _ in slabs] + [height]
    if beam.holes:
        slabs.append((height, under))
        levels.append(height + beam.head)
    count, lower, upper = view.points.shape[1], [], []
    for k, (_, solid) in enumerate(slabs):
        lower.append(view.cells[:, solid] + k * count)
        upper.append(view.cells[:, solid] + (k + 1) * count)
    (a, b, c, d), (e, f, g, h) = np.hstack(lower), np.hstack(upper)
    corners = np.stack([g, c, f, h, b, d, e, a]) if side == 2 else np.stack([c, g, b, d, f, h, a, e])
    used, cells = np.unique(corners, return_inverse=True)
    points = np.vstack([np.tile(view.points, len(levels)), np.repeat(levels, count)[None] * out])
    mesh = MeshHex(np.ascontiguousarray(points[:, used]), np.ascontiguousarray(cells.reshape(8, -1)))
    return mesh.with_boundaries(_pulled(mesh, beam, out * height))


def _pulled(mesh, beam, height):
    """Facets that the bolt shanks load: {name: facets}."""
    x, y, z = mesh.p[:, mesh.facets].mean(axis=1)
    free = np.zeros(z.size, dtype=bool)
    free[mesh.boundary_facets()] = True
    flat = free & (np.abs(z - height) < 1e-9) & (np.ptp(mesh.p[2, mesh.facets], axis=0) < 1e-9)
    return {
        HEADS.format(i): np.flatnonzero(flat & (np.hypot(x - at, y) < 0.5 * beam.hole))
        for i, at in enumerate(beam.holes)
    }
