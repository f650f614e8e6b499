"""Hexahedra for two bolted bodies: one plan of quadrilaterals (gmsh), extruded layer by layer.

Both bodies share the plan, so their nodes coincide on the contact. Edges are straight: a hole is a
polygon with the area of the circle.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from skfem import MeshHex, MeshQuad

from jointfmu.quantity import Array

from .elasticity import Index
from .geometry import Assembly, Body, Layer, TappedPlate, rectangles

SIZE_AT_HOLES = 1.0 / 10.0
"""Edge of an element at a hole over the hole's circumference [1], at refinement 1."""
ELEMENTS_ACROSS = 4
"""Elements across the narrowest strip of the contact at refinement 1."""
WALL = 1.02
"""Diameter around the walls of a hole over its own [1]."""
LAYERS = 2
"""Layers of elements through the thickness under a bolt's head at refinement 1."""


@dataclass(frozen=True, slots=True)
class Plan:
    """Quadrilaterals of the plan view.

    points : (2, n) [m]
    cells  : (4, m) corners of a cell
    drilled : (m) whether a cell lies in a hole
    """

    points: Array
    cells: Index
    drilled: NDArray[np.bool_]

    def solid(self, layer: Layer) -> NDArray[np.bool_]:
        """(m) whether a cell is solid in a layer of a body."""
        x, y = self.points[:, self.cells].mean(axis=1)
        return layer.solid(x, y) & ~(self.drilled & layer.drilled)


def contact_cells(plan: Plan, assembly: Assembly) -> NDArray[np.bool_]:
    """(m) cells where the two bodies touch."""
    cells1, cells2 = (plan.solid(body.layers()[0]) for body in (assembly.side1, assembly.side2))
    return cells1 & cells2


def contact_mesh(plan: Plan, touching: NDArray[np.bool_]) -> MeshQuad:
    """The contact as a plane mesh."""
    used, cells = np.unique(plan.cells[:, touching], return_inverse=True)
    return MeshQuad(np.ascontiguousarray(plan.points[:, used]), np.ascontiguousarray(cells.reshape(4, -1)))


def sizes(assembly: Assembly, refinement: float) -> tuple[float, float]:
    """Edge length [m] of elements at the holes and far from them."""
    strips = [_strip(body) for body in (assembly.side1, assembly.side2)]
    near = np.pi * assembly.bolts.hole_diameter * SIZE_AT_HOLES
    return near / refinement, max(min(strips) / ELEMENTS_ACROSS, near) / refinement


def _strip(body: Body) -> float:
    contact = body.layers()[0]
    widths = [o - i for o, i in zip(contact.outer, contact.inner, strict=True)]
    return float(min(widths))


def plan_of(assembly: Assembly, refinement: float = 1.0) -> Plan:
    """Mesh the plan with quadrilaterals that respect every edge, hole and head.

    refinement : [1] divides all element sizes
    """
    import gmsh

    near, far = sizes(assembly, refinement)
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        _draw(gmsh.model, assembly)
        _grade(gmsh.model, assembly, near, far)
        for name, value in (
            ("Algorithm", 8),
            ("RecombineAll", 1),
            ("RecombinationAlgorithm", 1),
            ("SubdivisionAlgorithm", 1),
            ("Smoothing", 10),
            ("RandomSeed", 1),
        ):
            gmsh.option.setNumber(f"Mesh.{name}", value)
        gmsh.model.mesh.generate(2)
        points, cells = _quadrilaterals(gmsh.model)
    finally:
        gmsh.finalize()
    _round(points, assembly)
    centre = points[:, cells].mean(axis=1)
    distance = np.hypot(*(centre[:, None, :] - assembly.bolts.positions.T[:, :, None]))
    return Plan(points, cells, distance.min(axis=0) < 0.5 * assembly.bolts.hole_diameter)


def _round(points: Array, assembly: Assembly) -> None:
    """Move the corners of the holes outward, so that each polygon has the area of its circle."""
    radius = 0.5 * assembly.bolts.hole_diameter
    for at in assembly.bolts.positions:
        away = points - at[:, None]
        rim = np.flatnonzero(np.abs(np.hypot(*away) - radius) < 1e-6 * radius)
        x, y = away[:, rim[np.argsort(np.arctan2(*away[::-1, rim]))]]
        area = 0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))
        points[:, rim] += (radius * np.sqrt(np.pi / area) - 1.0) * away[:, rim]


def _draw(model: object, assembly: Assembly) -> None:
    """Rectangles, holes and heads, cut into faces that meet edge to edge."""
    occ = model.occ  # type: ignore[attr-defined]
    faces = [(2, occ.addRectangle(-x, -y, 0.0, 2 * x, 2 * y)) for x, y in rectangles(assembly)]
    for x, y in assembly.bolts.positions:
        for diameter in (assembly.bolts.hole_diameter, assembly.bolts.head_diameter):
            faces.append((2, occ.addDisk(x, y, 0.0, 0.5 * diameter, 0.5 * diameter)))
    occ.fragment(faces[:1], faces[1:])
    occ.synchronize()


def _grade(model: object, assembly: Assembly, near: float, far: float) -> None:
    """Element sizes growing with the distance from the rims of the holes."""
    field = model.mesh.field  # type: ignore[attr-defined]
    # subdivision halves what is asked for
    circles = []
    hole = 0.5 * assembly.bolts.hole_diameter
    for x, y in assembly.bolts.positions:
        terms = f"(Sqrt((x-({x:.12g}))^2+(y-({y:.12g}))^2))"
        size = f"{2 * near:.12g}+0.35*Abs({terms}-{hole:.12g})"
        rim = field.add("MathEval")
        field.setString(rim, "F", size)
        circles.append(rim)
    flat = field.add("MathEval")
    field.setString(flat, "F", f"{2 * far:.12g}")
    least = field.add("Min")
    field.setNumbers(least, "FieldsList", [*circles, flat])
    field.setAsBackgroundMesh(least)
    import gmsh

    for name in ("MeshSizeExtendFromBoundary", "MeshSizeFromPoints", "MeshSizeFromCurvature"):
        gmsh.option.setNumber(f"Mesh.{name}", 0)


def _quadrilaterals(model: object) -> tuple[Array, Index]:
    mesh = model.mesh  # type: ignore[attr-defined]
    tags, coordinates, _ = mesh.getNodes()
    kinds, _, nodes = mesh.getElements(2)
    if list(kinds) != [3]:
        raise RuntimeError(
            f"the plan has elements of the gmsh types {list(kinds)}, expected quadrilaterals (3)"
        )
    place = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    place[tags.astype(np.int64)] = np.arange(tags.size)
    cells = place[nodes[0].astype(np.int64)].reshape(-1, 4).T
    points = coordinates.reshape(-1, 3)[:, :2].T
    used, cells = np.unique(cells, return_inverse=True)
    cells = cells.reshape(4, -1)
    points = points[:, used]
    a, b, c, d = (points[:, cells[k]] for k in range(4))
    area = np.sum((c - a)[0] * (d - b)[1] - (c - a)[1] * (d - b)[0])
    return points, cells if area > 0 else cells[::-1]


def body_mesh(plan: Plan, assembly: Assembly, side: int, refinement: float = 1.0) -> MeshHex:
    """Extrude the plan into one body: side 1 towards -z, side 2 towards +z.

    Its named boundaries are `contact`, all of its face on z = 0, and `head1`, `head2`, ... under the
    heads of the bolts, or the walls of their threads.
    """
    body = assembly.side1 if side == 1 else assembly.side2
    heights, owner = levels(body, refinement, 2.0 * sizes(assembly, refinement)[1])
    count, layers = plan.points.shape[1], body.layers()
    lower, upper = [], []
    for k, which in enumerate(owner):
        cells = plan.cells[:, plan.solid(layers[which])]
        lower.append(cells + k * count)
        upper.append(cells + (k + 1) * count)
    if side == 1:
        heights, lower, upper = -heights, upper, lower
    corners = _hexahedra(np.concatenate(lower, axis=1), np.concatenate(upper, axis=1))
    used, cells = np.unique(corners, return_inverse=True)
    points = np.concatenate([np.tile(plan.points, heights.size), np.repeat(heights, count)[None]])
    mesh = MeshHex(np.ascontiguousarray(points[:, used]), np.ascontiguousarray(cells.reshape(8, -1)))
    return mesh.with_boundaries(_boundaries(mesh, assembly, side))


def levels(body: Body, refinement: float, tall: float) -> tuple[Array, list[int]]:
    """Distances (k + 1) [m] of the levels from the contact, and the layer of each of the k slabs.

    tall : [m] greatest height of an element outside the layer under the heads
    """
    heights, owner = [0.0], []
    for which, layer in enumerate(body.layers()):
        thick = layer.top - layer.bottom
        least = LAYERS if which == 0 else 1
        slabs = max(round(least * refinement), int(np.ceil(thick / tall - 1e-9)), 1)
        heights += list(layer.bottom + thick * np.arange(1, slabs + 1) / slabs)
        owner += [which] * slabs
    return np.array(heights), owner


def _hexahedra(lower: Index, upper: Index) -> Index:
    """Corners (8, m) in the order of scikit-fem from those (4, m) of the lower and upper faces."""
    (a, b, c, d), (e, f, g, h) = lower, upper
    return np.stack([g, c, f, h, b, d, e, a])


def _boundaries(mesh: MeshHex, assembly: Assembly, side: int) -> dict[str, Index]:
    bolts, body = assembly.bolts, assembly.side1 if side == 1 else assembly.side2
    heads_at = body.clamped if side == 2 else -body.clamped
    x, y, z = mesh.p[:, mesh.facets].mean(axis=1)
    free = np.zeros(z.size, dtype=bool)
    free[mesh.boundary_facets()] = True
    slack = 1e-9 + 1e-6 * abs(heads_at)
    boundaries = {"contact": np.flatnonzero(free & (np.abs(z) < slack))}
    flat = free & (np.abs(mesh.p[2, mesh.facets] - heads_at).max(axis=0) < slack)
    reach = bolts.head_diameter
    if isinstance(body, TappedPlate):
        flat, reach = free & (np.ptp(mesh.p[2, mesh.facets], axis=0) > slack), WALL * bolts.hole_diameter
    for i, at in enumerate(bolts.positions):
        under = np.hypot(x - at[0], y - at[1]) < 0.5 * reach
        boundaries[f"head{i + 1}"] = np.flatnonzero(flat & under)
    return boundaries
