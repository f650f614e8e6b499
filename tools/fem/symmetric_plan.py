"""Plan mesh with the symmetry of the assembly, and with rings of elements around the bolts.

The mesh has the mirror symmetries of bodies and bolts: about x, about y, about the diagonal. gmsh meshes one
sector of the plan, without the rings around the bolts. The rings are polar. Mirror images of the sector make
the whole plan.

A rigid face under a bolt head has singular stresses at its edges. If the faces under the heads are rigid,
rings and layers are therefore graded towards these edges.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from jointfmu.quantity import Array

from .elasticity import IndexArray
from .geometry import LENGTH_TOLERANCE, Assembly, layer_rectangles
from .mesh import (
    ELEMENT_SIZE_GROWTH,
    PlanMesh,
    graded_element_levels,
    match_circle_areas,
    read_quadrilaterals,
    set_element_sizes,
    set_mesh_options,
)

ELEMENTS_AROUND_BOLT = 12
"""Number of elements around a bolt at refinements up to 1; 16 if axes of symmetry cross in the bolt."""
RELATIVE_ELEMENT_SIZE_AT_HEADS = 0.2
"""Size of the elements at the edges of a rigid head over the width of its bearing ring [1]; refinement 1."""
SUCCESSIVE_RING_WIDTH_RATIO = 1.5
"""Ratio of the widths of two successive rings between hole and edge of the head [1]."""
SUCCESSIVE_OUTER_RING_WIDTH_RATIO = 2.0
"""Ratio of the widths of two successive rings outside of the head [1]."""
OUTER_RINGS_WIDTH_OVER_BEARING_RING_WIDTH = 1.4
"""Width of the rings outside of the head over the width of its bearing ring [1]."""
MAX_OUTER_RINGS_WIDTH_OVER_CLEARANCE = 0.5
"""Largest width of the rings outside of the head over the clearance to the next edge or head [1]."""
SIZE_GROWTH_AROUND_RINGS = 0.8
"""Growth of the elements outside of graded rings, see `set_element_sizes` [1]."""
MAX_MERGED_NODE_DISTANCE = 1e-9
"""Distance [m] below which two nodes are one."""


@dataclass(frozen=True, slots=True)
class PlanSymmetry:
    """Mirror symmetries of the plan: in x (x to -x), in y, and in the diagonal (x and y exchanged)."""

    is_symmetric_in_x: bool
    is_symmetric_in_y: bool
    is_symmetric_in_diagonal: bool

    @classmethod
    def from_assembly(cls, assembly: Assembly) -> "PlanSymmetry":
        """Find the symmetries of an assembly. The diagonal is checked only if x and y are symmetries too."""
        bolts = assembly.bolts.bolt_positions

        def maps_bolts(mirrored_positions: Array) -> bool:
            return bool(np.max(cKDTree(bolts).query(mirrored_positions)[0]) < LENGTH_TOLERANCE)

        x, y = (maps_bolts(bolts * sign) for sign in ([-1.0, 1.0], [1.0, -1.0]))
        squares = all(abs(a - b) < LENGTH_TOLERANCE for a, b in layer_rectangles(assembly))
        return cls(x, y, x and y and squares and maps_bolts(bolts[:, ::-1]))


def mesh_symmetric_plan(assembly: Assembly, refinement: float, is_graded_at_heads: bool) -> PlanMesh:
    """Mesh the plan view with the symmetry of the assembly.

    refinement         : [1] divides all element sizes
    is_graded_at_heads : grade the elements towards the edges of the bolt heads

    Raises ValueError if an edge of a body runs under a bolt head.
    """
    radii = _ring_radii(assembly, refinement, is_graded_at_heads)
    symmetry = PlanSymmetry.from_assembly(assembly)
    growth = SIZE_GROWTH_AROUND_RINGS if is_graded_at_heads else ELEMENT_SIZE_GROWTH
    corners = _mesh_sector(assembly, symmetry, refinement, radii[-1], growth)
    rings = _make_rings(corners, assembly.bolts.bolt_positions, radii)
    quadrilaterals = np.concatenate([corners, rings], axis=2)
    for mirrored, matrix in (
        (symmetry.is_symmetric_in_diagonal, [[0, 1], [1, 0]]),
        (symmetry.is_symmetric_in_x, [[-1, 0], [0, 1]]),
        (symmetry.is_symmetric_in_y, [[1, 0], [0, -1]]),
    ):
        if mirrored:
            image = np.einsum("ij,jkm->ikm", np.array(matrix, dtype=np.float64), quadrilaterals[:, ::-1])
            quadrilaterals = np.concatenate([quadrilaterals, image], axis=2)
    points, cells = _merge_nodes(quadrilaterals)
    match_circle_areas(points, assembly.bolts.bolt_positions, radii)
    offset = points[:, cells].mean(axis=1)[:, None, :] - assembly.bolts.bolt_positions.T[:, :, None]
    return PlanMesh(points, cells, np.hypot(*offset).min(axis=0) < radii[0])


def min_size_at_heads(assembly: Assembly, refinement: float) -> float:
    """Size [m] of the smallest elements: those next to the edges of the bolt heads in a graded mesh."""
    ring_width = 0.5 * (assembly.bolts.head_diameter - assembly.bolts.hole_diameter)
    return RELATIVE_ELEMENT_SIZE_AT_HEADS * ring_width / refinement


def _ring_radii(assembly: Assembly, refinement: float, is_graded_at_heads: bool) -> Array:
    """Radii [m] of the circles around each bolt, from the hole outward."""
    hole, head = 0.5 * assembly.bolts.hole_diameter, 0.5 * assembly.bolts.head_diameter
    clearance = _head_clearance(assembly, head)
    if not is_graded_at_heads:
        return np.array([hole, head])
    first = min_size_at_heads(assembly, refinement)
    half = graded_element_levels(0.5 * (head - hole), first, SUCCESSIVE_RING_WIDTH_RATIO)
    inside = np.concatenate([hole + half, head - half[-2::-1]])
    width = min(
        OUTER_RINGS_WIDTH_OVER_BEARING_RING_WIDTH * (head - hole),
        MAX_OUTER_RINGS_WIDTH_OVER_CLEARANCE * clearance,
    )
    outside = (
        graded_element_levels(width, first, SUCCESSIVE_OUTER_RING_WIDTH_RATIO)[1:]
        if width > 0.5 * first
        else np.zeros(0)
    )
    return np.concatenate([inside, head + outside])


def _head_clearance(assembly: Assembly, head_radius: float) -> float:
    """Smallest distance [m] from the edge of a bolt head to an edge of a body, or to another head.

    Raises ValueError if an edge of a body runs under a head.
    """
    bolts = assembly.bolts.bolt_positions
    distances = [np.inf]
    for half in layer_rectangles(assembly):
        outside = np.maximum(np.abs(bolts) - half, 0.0)
        inside = np.min(half - np.abs(bolts), axis=1)
        to_edge = np.where(inside > 0.0, inside, np.hypot(*outside.T))
        distances.append(float(to_edge.min()))
    if min(distances) < head_radius - LENGTH_TOLERANCE:
        raise ValueError(
            f"an edge of a body is {1e3 * min(distances):.4g} mm from the axis of a bolt, expected at least "
            f"{1e3 * head_radius:.4g} mm: the radius of the head"
        )
    if len(bolts) > 1:
        distances.append(0.5 * float(cKDTree(bolts).query(bolts, k=2)[0][:, 1].min()))
    return max(min(distances) - head_radius, 0.0)


def _mesh_sector(
    assembly: Assembly, plan_symmetry: PlanSymmetry, refinement: float, ring_radius: float, size_growth: float
) -> Array:
    """Corner positions (2, 4, m) [m] of m quadrilaterals in one sector of the plan, without bolt rings.

    The rings lie between hole and `ring_radius`.

    size_growth : increase of twice the element size, divided by the distance from the rim of a hole [1]
    """
    import gmsh

    gmsh.initialize(interruptible=False)
    try:
        set_mesh_options()
        occ = gmsh.model.occ
        faces = [(2, occ.addRectangle(-x, -y, 0.0, 2 * x, 2 * y)) for x, y in layer_rectangles(assembly)]
        if len(faces) > 1:
            faces, _ = occ.fragment(faces[:1], faces[1:])
        hole, bolts = 0.5 * assembly.bolts.hole_diameter, assembly.bolts.bolt_positions
        discs = [(2, occ.addDisk(x, y, 0.0, ring_radius, ring_radius)) for x, y in bolts]
        faces, _ = occ.cut(faces, discs)
        holes = [(2, occ.addDisk(x, y, 0.0, hole, hole)) for x, y in bolts]
        pieces, _ = occ.intersect([*faces, *holes], [(2, _add_sector(occ, assembly, plan_symmetry))])
        occ.fragment(pieces, [])
        occ.synchronize()
        _divide_circles(gmsh.model, bolts, (hole, ring_radius), refinement)
        set_element_sizes(gmsh.model, assembly, refinement, size_growth)
        gmsh.model.mesh.generate(2)
        points, cells = read_quadrilaterals(gmsh.model)
    finally:
        gmsh.finalize()
    return points[:, cells]


def _add_sector(geometry_kernel: object, assembly: Assembly, plan_symmetry: PlanSymmetry) -> int:
    """Add the face of one sector of the plan to gmsh; return its tag."""
    x, y = 2.0 * np.max(list(layer_rectangles(assembly)), axis=0)
    low_x, low_y = (
        0.0 if plan_symmetry.is_symmetric_in_x else -x,
        0.0 if plan_symmetry.is_symmetric_in_y else -y,
    )
    if not plan_symmetry.is_symmetric_in_diagonal:
        return int(geometry_kernel.addRectangle(low_x, low_y, 0.0, x - low_x, y - low_y))  # type: ignore[attr-defined]
    corners = [geometry_kernel.addPoint(*p, 0.0) for p in ((0.0, 0.0), (x, 0.0), (x, x))]  # type: ignore[attr-defined]
    lines = [geometry_kernel.addLine(corners[i], corners[(i + 1) % 3]) for i in range(3)]  # type: ignore[attr-defined]
    return int(geometry_kernel.addPlaneSurface([geometry_kernel.addCurveLoop(lines)]))  # type: ignore[attr-defined]


def _divide_circles(
    gmsh_model: object, bolt_positions: Array, circle_radii: tuple[float, float], refinement: float
) -> None:
    """Divide the arcs around the bolts into equal edges, as many on the hole as on the outer circle."""
    for _, curve in gmsh_model.getEntities(1):  # type: ignore[attr-defined]
        if gmsh_model.getType(1, curve) == "Line":  # type: ignore[attr-defined]
            continue
        length = gmsh_model.occ.getMass(1, curve)  # type: ignore[attr-defined]
        low, high = gmsh_model.getParametrizationBounds(1, curve)  # type: ignore[attr-defined]
        point = np.array(gmsh_model.getValue(1, curve, [0.5 * (low[0] + high[0])])[:2])  # type: ignore[attr-defined]
        distance = np.min(np.hypot(*(bolt_positions - point).T))
        radius = circle_radii[int(np.argmin(np.abs(np.array(circle_radii) - distance)))]
        share = length / (2.0 * np.pi * radius)
        # the subdivision of gmsh halves each edge
        count = int(np.ceil(0.5 * ELEMENTS_AROUND_BOLT * max(refinement, 1.0) * share - 1e-6))
        gmsh_model.mesh.setTransfiniteCurve(curve, count + 1)  # type: ignore[attr-defined]


def _make_rings(quadrilateral_corners: Array, bolt_positions: Array, circle_radii: Array) -> Array:
    """Make rings of m quadrilaterals between circles around bolts: corner positions (2, 4, m) [m].

    The rings continue the given mesh inwards: each edge of the mesh on the largest circle becomes a column of
    quadrilaterals.

    circle_radii : (r) [m] of the circles, ascending
    """
    rings = []
    ends = np.stack([quadrilateral_corners, np.roll(quadrilateral_corners, -1, axis=1)], axis=-1).reshape(
        2, -1, 2
    )
    for bolt in bolt_positions:
        offset = ends - bolt[:, None, None]
        on_circle = np.all(np.abs(np.hypot(*offset) - circle_radii[-1]) < 1e-6 * circle_radii[-1], axis=1)
        # the body is on the left of its edges, so these run clockwise around the bolt
        second, first = np.moveaxis(offset[:, on_circle] / circle_radii[-1], 2, 0)
        for low, high in pairwise(circle_radii):
            corners = np.stack([low * first, high * first, high * second, low * second], axis=1)
            rings.append(corners + bolt[:, None, None])
    return np.concatenate(rings, axis=2)


def _merge_nodes(quadrilateral_corners: Array) -> tuple[Array, IndexArray]:
    """Merge the corners (2, 4, m) [m] of m quadrilaterals to n shared points (2, n) [m] and cells (4, m)."""
    count = quadrilateral_corners.shape[2]
    points = quadrilateral_corners.reshape(2, -1)
    pairs = cKDTree(points.T).query_pairs(MAX_MERGED_NODE_DISTANCE, output_type="ndarray")
    graph = coo_matrix((np.ones(len(pairs)), pairs.T), shape=(points.shape[1],) * 2)
    label = connected_components(graph, directed=False)[1]
    _, first = np.unique(label, return_index=True)
    return points[:, first], label.reshape(4, count).astype(np.int64)
