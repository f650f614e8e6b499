"""The computed contact and the modes as files: nodal CSV, VTU for ParaView, a picture."""

import tempfile
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from jointfmu.files.outputs import MARK
from jointfmu.files.writing import write_bytes, write_text
from jointfmu.quantity import Array

from .. import plots
from ..columns import FIELD
from ..fields import nodal_result
from .bolted_contact import JointSolution
from .elasticity import ElasticBody, Index
from .modes import NaturalModes


def packed(points: Array, cell_type: str, cells: Index, data: Mapping[str, Array]) -> bytes:
    """A VTU file: points (k, 3) [m], cells (m, corners) of meshio's `cell_type`, values (k, ...) by name."""
    import meshio

    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder) / "mesh.vtu"
        meshio.Mesh(points, [(cell_type, cells)], point_data=dict(data)).write(place)
        written = place.read_bytes()
    return written.replace(b"?>", f"?>\n<!-- {MARK} -->".encode(), 1)


def check(path: str | Path) -> None:
    """Raise ValueError if no field is written under this name. For use before long work."""
    if Path(path).suffix.lower() not in FIELD.endings:
        raise ValueError(
            f"{path}: suffix {Path(path).suffix!r} is no field, allowed are {', '.join(FIELD.endings)}"
        )


def write(solution: JointSolution, path: str | Path) -> None:
    """Write the field: quadrature points and their areas as .csv, the nodes of the mesh as .vtu."""
    check(path)
    if Path(path).suffix.lower() == ".csv":
        write_text(path, nodal_result.csv_text(solution.field))
    else:
        write_bytes(path, vtu(solution))


def quarters(solution: JointSolution) -> tuple[Array, Index, Array]:
    """Every element of the contact cut in four: points (k, 2) [m], cells (m, 4), approach (k) [m].

    The points are the nodes of the contact and the middles of its elements.
    """
    interface, nodal = solution.joint.interface, solution.contact.at_nodes
    dofs = np.asarray(interface.basis.element_dofs)
    weight = np.repeat([-0.25, 0.5], 4)  # of the corners and edges in the middle of 8 nodes
    middles = interface.nodes.shape[1] + np.arange(dofs.shape[1])
    (a, b, c, d), (ab, bc, cd, da) = np.split(dofs, 2)
    cells = [(a, ab, middles, da), (ab, b, bc, middles), (middles, bc, c, cd), (da, middles, cd, d)]
    points = np.concatenate(
        [interface.nodes, np.einsum("i,xin->xn", weight, interface.nodes[:, dofs])], axis=1
    )
    return points.T, np.concatenate(cells, axis=1).T, np.concatenate([nodal, weight @ nodal[dofs]])


def vtu(solution: JointSolution) -> bytes:
    """Quadrilaterals of the contact with pressure [Pa] and approach [m] at their corners."""
    places, cells, approach = quarters(solution)
    data = {"pressure": solution.contact.model.law.derivatives(approach, 1)[0], "approach": approach}
    points = np.column_stack([places, np.zeros(len(places))])
    return packed(points, "quad", cells, data)


def draw(solution: JointSolution, path: str | Path) -> None:
    """A picture of the pressure over the contact, with the peak and the values midway between bolts."""
    from matplotlib.tri import Triangulation

    contact = solution.contact
    points, cells, approach = quarters(solution)
    wide, high = np.ptp(points, axis=0)
    scale = 6.4 / max(wide, high)
    with plots.drawing(path, (scale * wide + 2.4, scale * high + 1.2)) as figure:
        axes = figure.subplots()
        axes.grid(False)
        triangles = np.concatenate([cells[:, [0, 1, 2]], cells[:, [0, 2, 3]]])
        pressure = contact.model.law.derivatives(approach, 1)[0] / 1e6
        shape = Triangulation(points[:, 0], points[:, 1], triangles)
        colours = axes.tripcolor(shape, pressure, shading="gouraud", cmap="viridis")
        figure.colorbar(colours, label="contact pressure in MPa", shrink=0.8)
        top = int(np.argmax(contact.node_pressure))
        x, y = solution.joint.interface.nodes[:, top]
        axes.plot(x, y, "o", color=plots.RED, fillstyle="none")
        axes.annotate(
            f"{solution.peak / 1e6:.2f}", (x, y), (8, -12), textcoords="offset points", color=plots.RED
        )
        for place, value in zip(*solution.between, strict=True):
            axes.annotate(f"{value / 1e6:.2f}", place, ha="center", va="center", color="white", size=8)
        axes.set(xlabel="x in m", ylabel="y in m", aspect="equal")
        force = solution.force / 1e3
        bolts = f"{force.min():g}" if np.ptp(force) == 0.0 else f"{force.min():g} to {force.max():g}"
        axes.set_title(f"{solution.joint.assembly.name}, {bolts} kN per bolt", size=10)


def modes_vtu(bodies: tuple[ElasticBody, ...], modes: NaturalModes) -> bytes:
    """Hexahedra of both bodies; at their corners one displacement [m] per mode, of 1 m at most.

    bodies : as in jointfmu_tools.fem.modes; a mirror image is drawn too
    """
    from skfem.io.meshio import to_meshio

    parts = [(body.mesh.p.T, to_meshio(body.mesh).cells[0].data) for body in bodies]
    if len(parts) == 1:
        points, cells = parts[0]
        parts.insert(0, (points * np.array([1.0, 1.0, -1.0]), cells))
    counts = [len(points) for points, _ in parts]
    data = {}
    for i, (frequency, shape) in enumerate(zip(modes.frequency, modes.shape, strict=True), 1):
        moved = np.concatenate([u[rows] for u, rows in zip(shape, _corners(bodies), strict=True)])
        data[f"mode {i}, {frequency:.1f} Hz"] = moved / np.linalg.norm(moved, axis=1).max()
    points = np.concatenate([points for points, _ in parts])
    cells = _outward(points, np.concatenate([parts[0][1], parts[1][1] + counts[0]]))
    return packed(points, "hexahedron", cells, data)


def _corners(bodies: tuple[ElasticBody, ...]) -> tuple[Index, Index]:
    """Rows of a shape that belong to the corners of the elements, of side 1 and side 2."""
    corners = [body.basis.nodal_dofs[0] for body in bodies]
    return corners[0], corners[-1]


def _outward(points: Array, cells: Index) -> Index:
    """Hexahedra whose first face sees the second one on its positive side, as VTK wants them."""
    a, b, d, e = (points[cells[:, k]] for k in (0, 1, 3, 4))
    wrong = np.einsum("ij,ij->i", np.cross(b - a, d - a), e - a) < 0.0
    return np.where(wrong[:, None], np.roll(cells, 4, axis=1), cells)
