"""Write the computed contact and natural modes to files: nodal CSV, VTU for ParaView, a plot."""

import tempfile
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from jointfmu.files.outputs import PROGRAM_MARK
from jointfmu.files.writing import write_bytes, write_text
from jointfmu.quantity import Array

from ..common import plots
from ..common.columns import PRESSURE_FIELD_FILE_KIND
from ..inputs.fields import nodal_result
from .bolted_contact import JointSolution
from .elasticity import ElasticBody, IndexArray
from .modes import NaturalModes


def make_vtu_content(
    point_positions: Array, cell_type: str, cell_corners: IndexArray, point_data: Mapping[str, Array]
) -> bytes:
    """Content of a VTU file of a mesh, with values at its points.

    point_positions : (k, 3) [m]
    cell_type       : name of the cell type in meshio
    cell_corners    : (m, corners) indices of points
    point_data      : {name: values (k, ...) at the points}
    """
    import meshio

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "mesh.vtu"
        meshio.Mesh(point_positions, [(cell_type, cell_corners)], point_data=dict(point_data)).write(path)
        content = path.read_bytes()
    return content.replace(b"?>", f"?>\n<!-- {PROGRAM_MARK} -->".encode(), 1)


def check_pressure_field_path(field_path: str | Path) -> None:
    """Raise ValueError if the suffix of the path is no format of a field. Call before a long calculation."""
    if Path(field_path).suffix.lower() not in PRESSURE_FIELD_FILE_KIND.file_name_endings:
        raise ValueError(
            f"{field_path}: suffix {Path(field_path).suffix!r} is not of a pressure field, allowed are "
            f"{', '.join(PRESSURE_FIELD_FILE_KIND.file_name_endings)}"
        )


def write_pressure_field(joint_solution: JointSolution, field_path: str | Path) -> None:
    """Write the pressure field: as .csv the quadrature points with their areas, as .vtu the mesh nodes."""
    check_pressure_field_path(field_path)
    if Path(field_path).suffix.lower() == ".csv":
        write_text(field_path, nodal_result.format_field_csv(joint_solution.contact_field))
    else:
        write_bytes(field_path, make_contact_vtu(joint_solution))


def divide_contact_elements(joint_solution: JointSolution) -> tuple[Array, IndexArray, Array]:
    """Divide each element of the contact into four: points (k, 2) [m], cells (m, 4), approach (k) [m].

    The points are the nodes of the contact and the centres of its elements.
    """
    interface, nodal = (
        joint_solution.bolted_contact.contact_interface,
        joint_solution.contact_solution.nodal_approach,
    )
    dofs = np.asarray(interface.finite_element_basis.element_dofs)
    weight = np.repeat([-0.25, 0.5], 4)  # shape functions of 4 corner and 4 edge nodes at the centre
    centres = interface.node_positions.shape[1] + np.arange(dofs.shape[1])
    (a, b, c, d), (ab, bc, cd, da) = np.split(dofs, 2)
    cells = [(a, ab, centres, da), (ab, b, bc, centres), (centres, bc, c, cd), (da, centres, cd, d)]
    points = np.concatenate(
        [interface.node_positions, np.einsum("i,xin->xn", weight, interface.node_positions[:, dofs])], axis=1
    )
    return points.T, np.concatenate(cells, axis=1).T, np.concatenate([nodal, weight @ nodal[dofs]])


def make_contact_vtu(joint_solution: JointSolution) -> bytes:
    """Content of a VTU file of the contact: quadrilaterals with nodal pressure [Pa] and approach [m]."""
    positions, cells, approach = divide_contact_elements(joint_solution)
    data = {
        "pressure": joint_solution.contact_solution.contact_model.pressure_law.derivatives(approach, 1)[0],
        "approach": approach,
    }
    points = np.column_stack([positions, np.zeros(len(positions))])
    return make_vtu_content(points, "quad", cells, data)


def draw_contact_pressure(joint_solution: JointSolution, picture_path: str | Path) -> None:
    """Plot the contact pressure, with its peak and the values midway between neighbouring bolts."""
    from matplotlib.tri import Triangulation

    contact = joint_solution.contact_solution
    points, cells, approach = divide_contact_elements(joint_solution)
    width, height = np.ptp(points, axis=0)
    scale = 6.4 / max(width, height)
    with plots.open_figure(picture_path, (scale * width + 2.4, scale * height + 1.2)) as figure:
        axes = figure.subplots()
        axes.grid(False)
        triangles = np.concatenate([cells[:, [0, 1, 2]], cells[:, [0, 2, 3]]])
        pressure = contact.contact_model.pressure_law.derivatives(approach, 1)[0] / 1e6
        triangulation = Triangulation(points[:, 0], points[:, 1], triangles)
        colours = axes.tripcolor(triangulation, pressure, shading="gouraud", cmap="viridis")
        figure.colorbar(colours, label="contact pressure in MPa", shrink=0.8)
        peak = int(np.argmax(contact.nodal_pressure))
        x, y = joint_solution.bolted_contact.contact_interface.node_positions[:, peak]
        axes.plot(x, y, "o", color=plots.RED, fillstyle="none")
        axes.annotate(
            f"{joint_solution.peak_pressure / 1e6:.2f}",
            (x, y),
            (8, -12),
            textcoords="offset points",
            color=plots.RED,
        )
        for position, value in zip(*joint_solution.pressure_between_bolts, strict=True):
            axes.annotate(f"{value / 1e6:.2f}", position, ha="center", va="center", color="white", size=8)
        axes.set(xlabel="x in m", ylabel="y in m", aspect="equal")
        force = joint_solution.bolt_force / 1e3
        bolts = f"{force.min():g}" if np.ptp(force) == 0.0 else f"{force.min():g} to {force.max():g}"
        axes.set_title(f"{joint_solution.bolted_contact.assembly.name}, {bolts} kN per bolt", size=10)


def make_modes_vtu(bodies: tuple[ElasticBody, ...], natural_modes: NaturalModes) -> bytes:
    """Content of a VTU file of mode shapes: hexahedra of both bodies, nodal displacement [m] of each mode.

    Each mode is scaled to a largest displacement of 1 m.

    bodies : side 1 and side 2, or side 2 alone if side 1 is its mirror image; the mirror image is added
    """
    from skfem.io.meshio import to_meshio

    meshes = [(body.mesh.p.T, to_meshio(body.mesh).cells[0].data) for body in bodies]
    if len(meshes) == 1:
        points, cells = meshes[0]
        meshes.insert(0, (points * np.array([1.0, 1.0, -1.0]), cells))
    n_points_1 = len(meshes[0][0])
    data = {}
    for i, (frequency, shape) in enumerate(
        zip(natural_modes.natural_frequencies, natural_modes.mode_shapes, strict=True), 1
    ):
        displacement = np.concatenate([u[rows] for u, rows in zip(shape, _corner_nodes(bodies), strict=True)])
        data[f"mode {i}, {frequency:.1f} Hz"] = displacement / np.linalg.norm(displacement, axis=1).max()
    points = np.concatenate([points for points, _ in meshes])
    cells = _orient_hexahedra(points, np.concatenate([meshes[0][1], meshes[1][1] + n_points_1]))
    return make_vtu_content(points, "hexahedron", cells, data)


def _corner_nodes(bodies: tuple[ElasticBody, ...]) -> tuple[IndexArray, IndexArray]:
    """Indices of the element corners among the nodes, for side 1 and side 2."""
    corners = [body.finite_element_basis.nodal_dofs[0] for body in bodies]
    return corners[0], corners[-1]


def _orient_hexahedra(point_positions: Array, cell_corners: IndexArray) -> IndexArray:
    """Hexahedra (m, 8) with the node order of VTK: the normal of the first face points to the second face."""
    a, b, d, e = (point_positions[cell_corners[:, k]] for k in (0, 1, 3, 4))
    inverted = np.einsum("ij,ij->i", np.cross(b - a, d - a), e - a) < 0.0
    return np.where(inverted[:, None], np.roll(cell_corners, 4, axis=1), cell_corners)
