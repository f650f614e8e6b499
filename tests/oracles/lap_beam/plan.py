"""Plan view of half the width of a lapped beam: quadrilaterals, small at holes and ends of the lap."""

from dataclasses import dataclass, field

import numpy as np

GROWTH = 1.6
"""Ratio of the sizes of neighbouring elements [1]."""


@dataclass(frozen=True)
class Fineness:
    """Element sizes [m]: in the lap at the holes and far from them, in the arms; layers in half the height.

    Layers and elements of the arms are small at the contact and where it ends, and grow by GROWTH.
    """

    near: float = 2.6e-3
    far: float = 3.6e-3
    arm: float = 25e-3
    layers: int = 3

    @property
    def levels(self):
        """Levels of the layers over half the height [1]."""
        return (GROWTH ** np.arange(self.layers + 1) - 1.0) / (GROWTH**self.layers - 1.0)

    def arms(self, reach):
        """Element ends [m] of an arm of a length [m], from the lap on."""
        sizes = []
        while sum(sizes) < reach:
            sizes.append(min(self.arm, self.far * GROWTH ** len(sizes)))
        return np.cumsum(sizes) * (reach / sum(sizes)) if sizes else np.zeros(0)


@dataclass(frozen=True)
class Plan:
    """Plane mesh in plan view: points (2, n) [m], corners of the quadrilaterals (4, m)."""

    points: np.ndarray
    cells: np.ndarray
    centres: np.ndarray = field(init=False)

    def __post_init__(self):
        object.__setattr__(self, "centres", self.points[:, self.cells].mean(axis=1))

    def cells_within(self, radius, places):
        """Mask (m) of the cells within a radius [m] of positions along x."""
        x, y = self.centres
        return np.any([np.hypot(x - at, y) < radius for at in places], axis=0) if places else x > np.inf


def plan(beam, size):
    """Plan mesh: lap by gmsh with the outlines of holes and washers, continued by the arms."""
    points, cells = _lap(beam, size)
    for end in (-0.5 * beam.lap, 0.5 * beam.lap):
        rim = np.flatnonzero(np.abs(points[0] - end) < 1e-9)
        rim = rim[np.argsort(points[1, rim])]
        for x in end + np.sign(end) * size.arms(0.5 * (beam.length - beam.lap)):
            new = points.shape[1] + np.arange(rim.size)
            points = np.hstack([points, np.stack([np.full(rim.size, x), points[1, rim]])])
            strip = np.stack([rim[:-1], new[:-1], new[1:], rim[1:]])
            cells = np.hstack([cells, strip if end > 0.0 else strip[::-1]])
            rim = new
    return Plan(points, cells)


def _lap(beam, size):
    """Points (2, n) [m] and cells (4, m) of half the width of the lap."""
    import gmsh

    half = 0.5 * beam.lap
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        occ = gmsh.model.occ
        whole = (2, occ.addRectangle(-half, 0.0, 0.0, beam.lap, 0.5 * beam.across))
        circles = [(x, d) for x in beam.holes for d in (beam.hole, beam.washer)]
        discs = [(2, occ.addDisk(x, 0.0, 0.0, 0.5 * d, 0.5 * d)) for x, d in circles]
        if discs:
            discs, _ = occ.intersect(discs, [whole], removeTool=False)
            occ.fragment([whole], discs)
        occ.synchronize()
        _graded(beam, size)
        options = {"Algorithm": 8, "RecombineAll": 1, "RecombinationAlgorithm": 1, "SubdivisionAlgorithm": 1}
        for name, value in (options | {"Smoothing": 10, "RandomSeed": 1}).items():
            gmsh.option.setNumber(f"Mesh.{name}", value)
        gmsh.model.mesh.generate(2)
        tags, places, _ = gmsh.model.mesh.getNodes()
        kinds, _, nodes = gmsh.model.mesh.getElements(2)
    finally:
        gmsh.finalize()
    assert list(kinds) == [3], "quadrilaterals only"
    row = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    row[tags.astype(np.int64)] = np.arange(tags.size)
    used, cells = np.unique(row[nodes[0].astype(np.int64)].reshape(-1, 4).T, return_inverse=True)
    points, cells = places.reshape(-1, 3)[used, :2].T, cells.reshape(4, -1)
    a, b, c, d = (points[:, corner] for corner in cells)
    (x1, y1), (x2, y2) = c - a, d - b
    up = x1 * y2 > x2 * y1
    return np.ascontiguousarray(points), np.where(up, cells, cells[::-1])


def _graded(beam, size):
    """Element size as a function of the distance from the holes; gmsh makes elements of half the requested
    size."""
    import gmsh

    mesh = gmsh.model.mesh.field
    rims = []
    for x in beam.holes:
        rims.append(mesh.add("MathEval"))
        away = f"Abs(Sqrt((x-({x:.12g}))^2+y^2)-{0.5 * beam.hole:.12g})"
        mesh.setString(rims[-1], "F", f"{2 * size.near:.12g}+0.3*{away}")
    rims.append(mesh.add("MathEval"))
    mesh.setString(rims[-1], "F", f"{2 * size.far:.12g}")
    least = mesh.add("Min")
    mesh.setNumbers(least, "FieldsList", rims)
    mesh.setAsBackgroundMesh(least)
    for name in ("MeshSizeExtendFromBoundary", "MeshSizeFromPoints", "MeshSizeFromCurvature"):
        gmsh.option.setNumber(f"Mesh.{name}", 0)
