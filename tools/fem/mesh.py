"""Hexahedral meshes of two bolted bodies, extruded layer by layer from one plan mesh (gmsh).

Both bodies share the plan mesh of quadrilaterals, so their nodes coincide on the contact. Edges are straight:
a hole is a polygon with the area of the circle.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from skfem import MeshHex, MeshQuad

from jointfmu.quantity import Array

from .elasticity import IndexArray
from .geometry import Assembly, BodyGeometry, Layer, TappedPlate, layer_rectangles

RELATIVE_ELEMENT_SIZE_AT_HOLES = 1.0 / 10.0
"""Edge length of an element at a hole over the circumference of the hole [1], at refinement 1."""
ELEMENTS_ACROSS_NARROWEST_STRIP = 4
"""Number of elements across the narrowest strip of the contact [1], at refinement 1."""
HOLE_WALL_OVER_HOLE_DIAMETER = 1.02
"""Diameter within which a facet counts as wall of a hole, over the diameter of the hole [1]."""
ELEMENT_SIZE_GROWTH = 0.35
"""Increase of twice the element size over the distance from the hole [1]."""
ELEMENTS_THROUGH_THICKNESS = 2
"""Number of elements through the thickness of the layer at the contact, at refinement 1."""
MAX_RELATIVE_ELEMENT_COUNT_REDUCTION = 0.3
"""Largest fraction by which the number of graded elements is rounded down [1]."""
SUCCESSIVE_ELEMENT_HEIGHT_RATIO = 2.5
"""Ratio of the heights of two successive elements below a rigid bolt head [1]."""


@dataclass(frozen=True, slots=True)
class PlanMesh:
    """Quadrilateral mesh of the plan view of both bodies.

    node_positions  : (2, n) [m]
    cell_corners    : (4, m) indices of the corners of each cell
    is_in_bolt_hole : (m) whether a cell lies in a bolt hole
    """

    node_positions: Array
    cell_corners: IndexArray
    is_in_bolt_hole: NDArray[np.bool_]

    def is_in_material(self, body_layer: Layer) -> NDArray[np.bool_]:
        """Whether each cell (m) of the plan mesh lies in the material of a layer."""
        x, y = self.node_positions[:, self.cell_corners].mean(axis=1)
        return body_layer.is_in_material(x, y) & ~(self.is_in_bolt_hole & body_layer.has_bolt_holes)


def find_contact_cells(plan_mesh: PlanMesh, assembly: Assembly) -> NDArray[np.bool_]:
    """Whether the two bodies touch in each cell (m) of the plan."""
    cells1, cells2 = (
        plan_mesh.is_in_material(body.list_rectangular_layers()[0])
        for body in (assembly.side1, assembly.side2)
    )
    return cells1 & cells2


def make_contact_mesh(plan_mesh: PlanMesh, contact_cell_mask: NDArray[np.bool_]) -> MeshQuad:
    """Plane mesh of the contact area: the cells of the plan that are in contact."""
    used, cells = np.unique(plan_mesh.cell_corners[:, contact_cell_mask], return_inverse=True)
    return MeshQuad(
        np.ascontiguousarray(plan_mesh.node_positions[:, used]), np.ascontiguousarray(cells.reshape(4, -1))
    )


def element_sizes(assembly: Assembly, refinement: float) -> tuple[float, float]:
    """Edge lengths [m] of elements at the holes, and far from them."""
    strips = [_width_of_narrowest_strip(body) for body in (assembly.side1, assembly.side2)]
    at_holes = np.pi * assembly.bolts.hole_diameter * RELATIVE_ELEMENT_SIZE_AT_HOLES
    return at_holes / refinement, max(min(strips) / ELEMENTS_ACROSS_NARROWEST_STRIP, at_holes) / refinement


def _width_of_narrowest_strip(body: BodyGeometry) -> float:
    """Width [m] of the narrowest strip of the contact face of a body."""
    contact = body.list_rectangular_layers()[0]
    widths = [o - i for o, i in zip(contact.outline_half_lengths, contact.opening_half_lengths, strict=True)]
    return float(min(widths))


def mesh_plan_view(assembly: Assembly, refinement: float = 1.0) -> PlanMesh:
    """Mesh the plan view with quadrilaterals whose edges follow all body edges, holes and bolt heads.

    refinement : [1] divides all element sizes
    """
    import gmsh

    gmsh.initialize(interruptible=False)
    try:
        set_mesh_options()
        _draw_plan_view(gmsh.model, assembly)
        set_element_sizes(gmsh.model, assembly, refinement)
        gmsh.model.mesh.generate(2)
        points, cells = read_quadrilaterals(gmsh.model)
    finally:
        gmsh.finalize()
    match_circle_areas(points, assembly.bolts.bolt_positions, [0.5 * assembly.bolts.hole_diameter])
    centre = points[:, cells].mean(axis=1)
    distance = np.hypot(*(centre[:, None, :] - assembly.bolts.bolt_positions.T[:, :, None]))
    return PlanMesh(points, cells, distance.min(axis=0) < 0.5 * assembly.bolts.hole_diameter)


def set_mesh_options() -> None:
    """Set the options of gmsh for a plane mesh of quadrilaterals."""
    import gmsh

    gmsh.option.setNumber("General.Terminal", 0)
    for name, value in (
        ("Algorithm", 8),
        ("RecombineAll", 1),
        ("RecombinationAlgorithm", 1),
        ("SubdivisionAlgorithm", 1),
        ("Smoothing", 10),
        ("RandomSeed", 1),
    ):
        gmsh.option.setNumber(f"Mesh.{name}", value)


def match_circle_areas(
    node_positions: Array, bolt_positions: Array, circle_radii: Sequence[float] | Array
) -> None:
    """Move the nodes on circles around the bolts outward, in place: each polygon gets the area of its circle.

    node_positions : (2, n) [m]
    bolt_positions : (b, 2) [m]
    circle_radii   : [m] of the circles around each bolt
    """
    for centre in bolt_positions:
        distance = np.hypot(*(node_positions - centre[:, None]))
        for radius in circle_radii:
            rim = np.flatnonzero(np.abs(distance - radius) < 1e-6 * radius)
            offset = node_positions[:, rim] - centre[:, None]
            x, y = offset[:, np.argsort(np.arctan2(*offset[::-1]))]
            area = 0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))
            node_positions[:, rim] += (radius * np.sqrt(np.pi / area) - 1.0) * offset


def _draw_plan_view(gmsh_model: object, assembly: Assembly) -> None:
    """Draw rectangles, holes and heads in gmsh, and split them into faces with common edges."""
    occ = gmsh_model.occ  # type: ignore[attr-defined]
    faces = [(2, occ.addRectangle(-x, -y, 0.0, 2 * x, 2 * y)) for x, y in layer_rectangles(assembly)]
    for x, y in assembly.bolts.bolt_positions:
        for diameter in (assembly.bolts.hole_diameter, assembly.bolts.head_diameter):
            faces.append((2, occ.addDisk(x, y, 0.0, 0.5 * diameter, 0.5 * diameter)))
    occ.fragment(faces[:1], faces[1:])
    occ.synchronize()


def set_element_sizes(
    gmsh_model: object, assembly: Assembly, refinement: float, size_growth: float = ELEMENT_SIZE_GROWTH
) -> None:
    """Set the element size in gmsh: smallest at the rims of the holes, growing with the distance to them.

    size_growth : increase of twice the element size, divided by the distance from the rim [1]
    """
    size_at_holes, max_size = element_sizes(assembly, refinement)
    field = gmsh_model.mesh.field  # type: ignore[attr-defined]
    # the subdivision of gmsh halves the element size, so twice the size is set
    circles = []
    hole = 0.5 * assembly.bolts.hole_diameter
    for x, y in assembly.bolts.bolt_positions:
        terms = f"(Sqrt((x-({x:.12g}))^2+(y-({y:.12g}))^2))"
        size = f"{2 * size_at_holes:.12g}+{size_growth:g}*Abs({terms}-{hole:.12g})"
        rim = field.add("MathEval")
        field.setString(rim, "F", size)
        circles.append(rim)
    uniform = field.add("MathEval")
    field.setString(uniform, "F", f"{2 * max_size:.12g}")
    smallest = field.add("Min")
    field.setNumbers(smallest, "FieldsList", [*circles, uniform])
    field.setAsBackgroundMesh(smallest)
    import gmsh

    for name in ("MeshSizeExtendFromBoundary", "MeshSizeFromPoints", "MeshSizeFromCurvature"):
        gmsh.option.setNumber(f"Mesh.{name}", 0)


def read_quadrilaterals(gmsh_model: object) -> tuple[Array, IndexArray]:
    """Read points (2, n) [m] and counter-clockwise cells (4, m) of the mesh from gmsh."""
    mesh = gmsh_model.mesh  # type: ignore[attr-defined]
    tags, coordinates, _ = mesh.getNodes()
    kinds, _, nodes = mesh.getElements(2)
    if list(kinds) != [3]:
        raise RuntimeError(
            f"the plan has elements of the gmsh types {list(kinds)}, expected quadrilaterals (3); try "
            "another --refinement"
        )
    index = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    index[tags.astype(np.int64)] = np.arange(tags.size)
    cells = index[nodes[0].astype(np.int64)].reshape(-1, 4).T
    points = coordinates.reshape(-1, 3)[:, :2].T
    used, cells = np.unique(cells, return_inverse=True)
    cells = cells.reshape(4, -1)
    points = points[:, used]
    a, b, c, d = (points[:, cells[k]] for k in range(4))
    area = np.sum((c - a)[0] * (d - b)[1] - (c - a)[1] * (d - b)[0])
    return points, cells if area > 0 else cells[::-1]


def extrude_body_mesh(
    plan_mesh: PlanMesh,
    assembly: Assembly,
    side_number: int,
    refinement: float = 1.0,
    first_element_height: float | None = None,
) -> MeshHex:
    """Extrude the plan mesh to the mesh of one body: side 1 towards -z, side 2 towards +z.

    first_element_height : [m] of the elements under the bolt heads; None: all elements of a layer have the
                           same height

    Named boundaries: `contact` is the whole face at z = 0; head1, head2, ... are the faces under the bolt
    heads or, in a tapped plate, the walls of the threaded holes.
    """
    body = assembly.side1 if side_number == 1 else assembly.side2
    max_height = 2.0 * element_sizes(assembly, refinement)[1]
    heights, owner = extruded_element_levels(body, refinement, max_height, first_element_height)
    count, layers = plan_mesh.node_positions.shape[1], body.list_rectangular_layers()
    lower, upper = [], []
    for k, layer_index in enumerate(owner):
        cells = plan_mesh.cell_corners[:, plan_mesh.is_in_material(layers[layer_index])]
        lower.append(cells + k * count)
        upper.append(cells + (k + 1) * count)
    if side_number == 1:
        heights, lower, upper = -heights, upper, lower
    corners = _make_hexahedra(np.concatenate(lower, axis=1), np.concatenate(upper, axis=1))
    used, cells = np.unique(corners, return_inverse=True)
    points = np.concatenate(
        [np.tile(plan_mesh.node_positions, heights.size), np.repeat(heights, count)[None]]
    )
    mesh = MeshHex(np.ascontiguousarray(points[:, used]), np.ascontiguousarray(cells.reshape(8, -1)))
    return mesh.with_boundaries(_find_named_boundaries(mesh, assembly, side_number))


def graded_element_levels(divided_length: float, first_size: float, successive_size_ratio: float) -> Array:
    """Division of a length into sizes that grow in geometric progression.

    Returns the levels (k + 1) [m] from 0 to `divided_length`; the first size is near `first_size` [m].
    """
    exact_count = float(
        np.log1p((successive_size_ratio - 1.0) * divided_length / first_size) / np.log(successive_size_ratio)
    )
    count = max(int(np.ceil(exact_count - MAX_RELATIVE_ELEMENT_COUNT_REDUCTION)), 1)
    levels = np.cumsum(np.append(0.0, successive_size_ratio ** np.arange(count)))
    return np.asarray(divided_length * levels / levels[-1])


def extruded_element_levels(
    body: BodyGeometry,
    refinement: float,
    max_element_height: float,
    first_element_height: float | None = None,
) -> tuple[Array, list[int]]:
    """Subdivision of a body along z: k rows of elements between k + 1 levels.

    Returns the distances (k + 1) [m] of the levels from the contact, and for each row the index of its layer.

    max_element_height   : [m] largest height of an element
    first_element_height : [m] height of the elements under the bolt heads; None: equal heights in a layer
    """
    heights, owner = [0.0], []
    for layer_index, layer in enumerate(body.list_rectangular_layers()):
        thickness = layer.top_distance - layer.bottom_distance
        min_rows = ELEMENTS_THROUGH_THICKNESS if layer_index == 0 else 1
        rows = max(round(min_rows * refinement), int(np.ceil(thickness / max_element_height - 1e-9)), 1)
        levels = thickness * np.arange(rows + 1) / rows
        if layer_index == 0 and first_element_height is not None:
            levels = (
                thickness
                - graded_element_levels(thickness, first_element_height, SUCCESSIVE_ELEMENT_HEIGHT_RATIO)[
                    ::-1
                ]
            )
        heights += list(layer.bottom_distance + levels[1:])
        owner += [layer_index] * (len(levels) - 1)
    return np.array(heights), owner


def _make_hexahedra(lower_corners: IndexArray, upper_corners: IndexArray) -> IndexArray:
    """Corner indices (8, m) in the order of scikit-fem, from the corners (4, m) of lower and upper faces."""
    (a, b, c, d), (e, f, g, h) = lower_corners, upper_corners
    return np.stack([g, c, f, h, b, d, e, a])


def _find_named_boundaries(body_mesh: MeshHex, assembly: Assembly, side_number: int) -> dict[str, IndexArray]:
    """Facet indices of the named boundaries of a body mesh: contact face, and face under each bolt head."""
    bolts, body = assembly.bolts, assembly.side1 if side_number == 1 else assembly.side2
    head_level = body.clamped_thickness if side_number == 2 else -body.clamped_thickness
    x, y, z = body_mesh.p[:, body_mesh.facets].mean(axis=1)
    outer = np.zeros(z.size, dtype=bool)
    outer[body_mesh.boundary_facets()] = True
    tolerance = 1e-9 + 1e-6 * abs(head_level)
    boundaries = {"contact": np.flatnonzero(outer & (np.abs(z) < tolerance))}
    if isinstance(body, TappedPlate):
        candidates = outer & (np.ptp(body_mesh.p[2, body_mesh.facets], axis=0) > tolerance)
        diameter = HOLE_WALL_OVER_HOLE_DIAMETER * bolts.hole_diameter
    else:
        candidates = outer & (np.abs(body_mesh.p[2, body_mesh.facets] - head_level).max(axis=0) < tolerance)
        diameter = bolts.head_diameter
    for i, (x_bolt, y_bolt) in enumerate(bolts.bolt_positions):
        near_bolt = np.hypot(x - x_bolt, y - y_bolt) < 0.5 * diameter
        boundaries[f"head{i + 1}"] = np.flatnonzero(candidates & near_bolt)
    return boundaries
