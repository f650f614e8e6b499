"""Nodal contact results from files: formats, areas from faces, and refusals that name the place in
the file."""

from contextlib import chdir
from pathlib import Path

import meshio
import numpy as np
import pytest
from jointfmu_tools.inputs.fields import nodal_result
from jointfmu_tools.inputs.fields.contact_surface import ContactPlane
from jointfmu_tools.inputs.fields.mesh import (
    SURFACE_CELL_NODE_COUNTS,
    VOLUME_CELLS,
    boundary_faces,
    compute_nodal_areas,
)
from jointfmu_tools.inputs.fields.reading import FieldReader

DATA = Path(__file__).parent
UNITS = {"length_unit": "mm", "pressure_unit": "MPa"}


def grid(nx, ny, quadratic=False):
    """Points (n, 2) of the rectangle 4 by 2, slightly displaced inside, and its quadrilaterals."""
    m = 2 if quadratic else 1
    x, y = np.meshgrid(np.linspace(0, 4, m * nx + 1), np.linspace(0, 2, m * ny + 1), indexing="ij")
    bump = 0.1 * np.sin(np.pi * x / 4) * np.sin(np.pi * y / 2)
    index = np.arange(x.size).reshape(x.shape)
    corner = index[:-1:m, :-1:m], index[m::m, :-1:m], index[m::m, m::m], index[:-1:m, m::m]
    cells = [c.ravel() for c in corner]
    if quadratic:
        middle = index[1::2, :-1:2], index[2::2, 1::2], index[1::2, 2::2], index[:-1:2, 1::2]
        cells += [c.ravel() for c in (*middle, index[1::2, 1::2])]
    return np.column_stack([(x + bump).ravel(), (y - bump).ravel()]), np.column_stack(cells)


def faces(kind, n):
    """Points and faces of the rectangle in faces of one kind, n along its short side."""
    points, quads = grid(2 * n, n, quadratic=kind in ("triangle6", "quad8", "quad9"))
    if kind in ("quad", "quad9"):
        return points, quads
    if kind == "quad8":
        used, cells = np.unique(quads[:, :8], return_inverse=True)
        return points[used], cells.reshape(-1, 8)
    if kind == "triangle":
        return points, np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    return points, np.concatenate([quads[:, [0, 1, 2, 4, 5, 8]], quads[:, [0, 2, 3, 8, 6, 7]]])


@pytest.mark.parametrize("kind", SURFACE_CELL_NODE_COUNTS)
def test_areas_are_positive_and_make_the_whole_surface(kind):
    points, cells = faces(kind, 4)
    areas = compute_nodal_areas(points, [cells])
    assert np.all(areas > 0.0)
    # the boundary is straight, so the faces fill the rectangle; round-off
    assert areas.sum() == pytest.approx(8.0, rel=1e-13)


@pytest.mark.parametrize("kind", SURFACE_CELL_NODE_COUNTS)
def test_sums_of_a_nonlinear_function_converge_with_the_second_order(kind):
    """Sum of k(p) = p^0.9 for a smooth pressure on three meshes; the trapezoidal rule has second order."""

    def total(n):
        points, cells = faces(kind, n)
        p = 1.0 + np.sin(points[:, 0]) * np.cos(points[:, 1])
        return compute_nodal_areas(points, [cells]) @ p**0.9

    coarse, middle, fine = total(4), total(8), total(16)
    assert np.log2((coarse - middle) / (middle - fine)) == pytest.approx(2.0, abs=0.2)


@pytest.mark.parametrize(("kind", "count", "area"), [
    ("tetra", 4, 1.5 + np.sqrt(3.0) / 2.0), ("hexahedron", 6, 6.0), ("wedge", 5, 3.0 + np.sqrt(2.0)),
    ("pyramid", 5, 2.0 + np.sqrt(2.0)),
    ("tetra10", 4, 1.5 + np.sqrt(3.0) / 2.0), ("hexahedron20", 6, 6.0), ("wedge15", 5, 3.0 + np.sqrt(2.0)),
    ("pyramid13", 5, 2.0 + np.sqrt(2.0)),
])  # fmt: skip
def test_boundary_of_one_cell_is_all_its_faces(kind, count, area):
    """Unit cells with a known surface area; a wrong mid-side node would change the areas."""
    corners = np.array(
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1.0]]
    )
    pick = {"tetra": [0, 1, 3, 4], "wedge": [0, 1, 3, 4, 5, 7], "pyramid": [0, 1, 2, 3, 4]}
    points = corners[pick.get(kind.rstrip("0123456789"), range(8))]
    _, _, edges = VOLUME_CELLS[kind]
    points = np.concatenate([points, *[points[list(e)].mean(axis=0)[None] for e in edges]])
    found = boundary_faces({kind: np.arange(len(points))[None, :]})
    assert sum(map(len, found)) == count
    assert sum(_area(points, f) for block in found for f in block) == pytest.approx(area, rel=1e-13)


def _area(points, face):
    """Area of a plane face in space."""
    own = points[face] - points[face[0]]
    _, _, axes = np.linalg.svd(own)
    return compute_nodal_areas(own @ axes[:2].T, [np.arange(len(face))[None, :]]).sum()


def test_faces_between_cells_are_not_boundary():
    cells = np.array([[0, 1, 2, 3, 4, 5, 6, 7], [4, 5, 6, 7, 8, 9, 10, 11]])
    assert len(boundary_faces({"hexahedron": cells})[0]) == 10


def write_csv(path, rows, head="x [mm],y [mm],area [mm2],pressure [MPa]"):
    path.write_text("\n".join(["# made by a test", head, *rows, ""]))
    return path


ROWS = ["0,0,10,1", "10,0,10,2", "10,20,10,1.5", "0,20,10,3"]


def test_csv_states_its_units(tmp_path):
    field, tilted = FieldReader().read_field(write_csv(tmp_path / "a.csv", ROWS))
    assert tilted is None
    np.testing.assert_allclose(field.nodal_area, 1e-5, rtol=1e-15)
    np.testing.assert_allclose(field.node_positions[2], [0.01, 0.02], rtol=1e-15)
    np.testing.assert_allclose(field.nodal_pressure, [1e6, 2e6, 1.5e6, 3e6], rtol=1e-15)
    again, _ = FieldReader().read_field(_written(tmp_path / "b.csv", field))
    np.testing.assert_array_equal(again.nodal_pressure, field.nodal_pressure)
    np.testing.assert_array_equal(again.node_positions, field.node_positions)


def _written(path, field):
    path.write_text(nodal_result.format_field_csv(field))
    return path


@pytest.mark.parametrize(("row", "message"), [
    ("10,20,10,nan", r"line 5: pressure = 'nan' is not a finite number"),
    ("10,20,10,-1", r"line 5: pressure = -1e\+06 Pa is outside \[0, inf\)"),
    ("10,20,0,1", r"line 5: area = 0 m2 is outside \(0, inf\)"),
    ("10,0,10,1", r"line 5: is at the same place as line 4"),
    ("10,20,10,0", r"line 5: has no pressure; 1 of the 4 nodes .* State keep \(at these nodes the sides"),
    ("10,20,10", r"line 5 has 3 columns, expected 4"),
])  # fmt: skip
def test_csv_is_refused_with_the_line(tmp_path, row, message):
    path = write_csv(tmp_path / "a.csv", [*ROWS[:2], row, ROWS[3]])
    with pytest.raises(ValueError, match=message) as error:
        FieldReader().read_field(path)
    assert str(error.value).startswith(f"{path}: ")
    assert "\n" not in str(error.value)


def test_missing_column_and_units_are_refused(tmp_path):
    with pytest.raises(ValueError, match=r"has no column 'area'; expected area \[m2 \| mm2 \| um2\]"):
        FieldReader().read_field(write_csv(tmp_path / "a.csv", ["0,0,1"], "x [mm],y [mm],pressure [MPa]"))
    with pytest.raises(ValueError, match=r"column 'pressure' has no unit"):
        FieldReader().read_field(write_csv(tmp_path / "b.csv", ROWS, "x [mm],y [mm],area [mm2],pressure"))
    with pytest.raises(ValueError, match=r"states no unit of length; expected one of m, mm, um"):
        FieldReader().read_field(DATA / "blocks.frd")
    (tmp_path / "rnd.bin").write_bytes(bytes(range(256)))
    with pytest.raises(
        ValueError, match=r"suffix '.bin' belongs to no known format; state the format, one of"
    ):
        FieldReader().read_field(tmp_path / "rnd.bin")
    with pytest.raises(ValueError, match=r"length = 'mm': leave it out, a CSV file states units"):
        FieldReader(length_unit="mm").read_field(write_csv(tmp_path / "c.csv", ROWS))


def test_open_nodes_are_kept_or_left_out(tmp_path):
    path = write_csv(tmp_path / "a.csv", [*ROWS, "5,10,10,0"])
    assert FieldReader(open_node_treatment="keep").read_field(path)[0].nodal_area.size == 5
    assert FieldReader(open_node_treatment="drop").read_field(path)[0].nodal_area.size == 4


@pytest.mark.parametrize(("name", "nodes"), [("blocks.frd", 35), ("blocks_quadratic.frd", 21)])
def test_calculix_result(name, nodes):
    """The file was written by CalculiX 2.20 from the deck next to it: 8 kN on 40 x 30 mm.

    The area is the blocks' own. CalculiX extrapolates the pressure to the nodes, which costs half a per
    cent of the force on these coarse meshes; 1 % is what the import lets pass.
    """
    field, _ = FieldReader(**UNITS).read_field(DATA / name)
    assert field.nodal_area.size == nodes
    assert field.nodal_area.sum() == pytest.approx(1.2e-3, rel=1e-5)  # five digits of the coordinates
    assert field.normal_force == pytest.approx(8e3, rel=0.01)
    assert field.nodal_pressure.min() > 1e6


def test_nodes_that_calculix_leaves_out_are_open(tmp_path):
    """NODE TO SURFACE contact by CalculiX 2.20: at the open end the file lists only the nearer nodes."""
    path = DATA / "blocks_open.frd"
    listed = path.read_text().split(" -4  CONTACT")[1].split(" -3")[0].count("\n -1")
    assert listed < 35
    with pytest.raises(ValueError, match=r"node \d+: has no pressure; 17 of the 35 nodes"):
        FieldReader(**UNITS).read_field(path)
    kept, _ = FieldReader(**UNITS, open_node_treatment="keep").read_field(path)
    assert kept.nodal_area.size == 35
    assert kept.nodal_area.sum() == pytest.approx(1.2e-3, rel=1e-5)  # five digits of the coordinates
    dropped, _ = FieldReader(**UNITS, open_node_treatment="drop").read_field(path)
    assert dropped.nodal_area.size == 18
    for field in (kept, dropped):
        assert field.normal_force == pytest.approx(160e3, rel=1e-3)  # what presses less what draws
    broken = tmp_path / "a.frd"
    head, contact = path.read_text().split(" -4  CONTACT")
    broken.write_text(head + " -4  CONTACT" + contact.replace(" 0.00000E+00", "         NaN", 1))
    with pytest.raises(ValueError, match=r"line \d+: .* is not a line with a node number and 6 numbers"):
        FieldReader(**UNITS, open_node_treatment="keep").read_field(broken)


def test_middles_of_upright_edges_are_where_calculix_has_them():
    """Every mid-side node of every boundary face lies between its corners, on the vertical faces too."""
    from jointfmu_tools.inputs.fields import frd

    found = frd.read_frd(DATA / "blocks_quadratic.frd", 1e-3, 1e6)
    for block in found.boundary_faces:
        corners, middles = found.node_positions[block[:, :4]], found.node_positions[block[:, 4:]]
        expected = 0.5 * (corners + np.roll(corners, -1, axis=1))
        np.testing.assert_allclose(middles, expected, atol=1e-7)  # five digits of 0.02 m


def test_broken_frd_is_refused_with_the_line(tmp_path):
    text = (DATA / "blocks.frd").read_text()
    path = tmp_path / "a.frd"
    path.write_text(text.replace("CONTACT", "DISPLAY"))
    with pytest.raises(ValueError, match=r"has no result CONTACT .*; there are DISP, DISPLAY"):
        FieldReader(**UNITS).read_field(path)
    path.write_text(text.replace(" -1         1-2.00000E+01", " -1         1-2.0x000E+01", 1))
    with pytest.raises(ValueError, match=r"line \d+: .* is not a line with a node number and 3 numbers"):
        FieldReader(**UNITS).read_field(path)
    path.write_text("hello")
    with pytest.raises(ValueError, match="is not a CalculiX result"):
        FieldReader(**UNITS).read_field(path)


def blocks(quadratic=False):
    """Two blocks of bricks in contact at z = 0, without common nodes, and pressures on both faces."""
    points, cells = grid(4, 3)
    n = len(points)
    levels = [np.column_stack([points, np.full(n, z)]) for z in (-1.0, 0.0, 0.0, 1.0)]
    bricks = [np.hstack([cells + i * n, cells + (i + 1) * n]) for i in (0, 2)]
    p = 1.0 + points[:, 0] + 0.5 * points[:, 1]
    return np.concatenate(levels), np.concatenate(bricks), p, n


def test_volume_mesh_of_two_bodies(tmp_path):
    """With pressure on both sides of the contact, a side must be stated; the surface is then that side."""
    points, bricks, p, n = blocks()
    both = np.concatenate([0 * p, p, 1.1 * p, 0 * p])
    path = tmp_path / "a.vtu"
    meshio.Mesh(points, {"hexahedron": bricks}, {"CPRESS": both, "U": np.zeros((4 * n, 3))}).write(path)
    with pytest.raises(
        ValueError, match=r"state which point data .*; the file has CPRESS, U \(3 components\)"
    ):
        FieldReader(**UNITS).read_field(path)
    with pytest.raises(ValueError, match=r"has no point data 'PRES'; there are CPRESS"):
        FieldReader(**UNITS, point_data_name="PRES").read_field(path)
    with pytest.raises(ValueError, match=r"'U' is not a component of U; expected U:1 to U:3"):
        FieldReader(**UNITS, point_data_name="U").read_field(path)
    with pytest.raises(ValueError, match=r"node \d+: is at the same place as node \d+"):
        FieldReader(**UNITS, point_data_name="CPRESS").read_field(path)
    for side, factor in (("below", 1.0), ("above", 1.1)):
        field, _ = FieldReader(
            **UNITS, point_data_name="CPRESS", contact_plane=ContactPlane(body_side=side)
        ).read_field(path)
        assert field.nodal_area.sum() == pytest.approx(8e-6, rel=1e-13)
        np.testing.assert_allclose(np.sort(field.nodal_pressure), np.sort(factor * p) * 1e6, rtol=1e-14)


@pytest.mark.parametrize("suffix", [".vtk", ".vtu", ".xdmf"])
def test_surface_mesh_in_another_plane(tmp_path, suffix, enter):
    """The contact lies in the y-z plane: the normal is x, so y is along the rows unless stated otherwise."""
    enter(chdir(tmp_path))
    points, cells = grid(4, 3)
    place = np.column_stack([np.full(len(points), 7.0), points])
    p = 1.0 + points[:, 0]
    path = tmp_path / f"a{suffix}"
    meshio.write(path, meshio.Mesh(place, {"quad": cells}, {"p": p}))
    field, _ = FieldReader(
        **UNITS, point_data_name="p", contact_plane=ContactPlane("x"), file_format="mesh"
    ).read_field(path)
    np.testing.assert_allclose(1e3 * field.node_positions, points, rtol=1e-12, atol=1e-15)
    turned, _ = FieldReader(
        **UNITS, point_data_name="p", contact_plane=ContactPlane("x", "z"), file_format="mesh"
    ).read_field(path)
    np.testing.assert_allclose(turned.node_positions[:, 0], field.node_positions[:, 1])
    np.testing.assert_allclose(turned.node_positions[:, 1], -field.node_positions[:, 0])
    with pytest.raises(ValueError, match=r"node \d+: lies .* away from the plane z = "):
        FieldReader(**UNITS, point_data_name="p", file_format="mesh").read_field(path)


@pytest.mark.parametrize("normal", ["y", "z"])
def test_a_result_of_two_dimensions_is_refused_by_a_line_that_says_so(tmp_path, normal):
    points, quads = grid(8, 4)
    place = np.column_stack([points, np.zeros(len(points))])
    p = np.where(points[:, 1] == 0.0, 5.0, np.nan)
    path = tmp_path / "plane.vtu"
    meshio.write(path, meshio.Mesh(place, {"quad": quads}, {"p": p}))
    reading = FieldReader(
        length_unit="mm", pressure_unit="MPa", point_data_name="p", contact_plane=ContactPlane(normal)
    )
    with pytest.raises(ValueError, match="lie on one line, as in a two-dimensional or axisymmetric model"):
        reading.read_field(path)


def test_unreadable_mesh_is_one_line(tmp_path):
    path = tmp_path / "a.vtu"
    path.write_text("no mesh\nat all")
    with pytest.raises(ValueError, match="meshio cannot read it") as error:
        FieldReader(**UNITS, point_data_name="p").read_field(path)
    assert "\n" not in str(error.value)


HEADER = """
 ***** ANSYS - ENGINEERING ANALYSIS SYSTEM  RELEASE 2023 R1          23.1     *****
 ANSYS Mechanical Enterprise
 00000000  VERSION=LINUX x64     11:11:11  JAN 01, 2023 CP=      1.000
"""


def listing(p, points, cells, per_page=7):
    """Listing of PRNSOL,CONT, NLIST and ELIST for CONTA174: pages with headers, negative numbers without
    blanks."""
    lines = [" PRINT CONT NODAL SOLUTION PER NODE", HEADER, "  ***** POST1 NODAL CONTACT LISTING *****",
             "  LOAD STEP=     1  SUBSTEP=     3", "   TIME=    1.0000      LOAD CASE=   0", ""]  # fmt: skip
    head = "    NODE    STAT        PENE        PRES        SFRI        STOT"
    for i, value in enumerate(p):
        if i % per_page == 0:
            lines += [HEADER, head]
        lines.append(f"{i + 11:8d}{3:12.4f}{-1e-6 * i:12.5E}{value:12.5E}{0:12.5E}{value:12.5E}")
    lines += ["", " MINIMUM VALUES", " NODE         11        11        11        11        11",
              " VALUE   3.0000      0.0000      0.0000      0.0000      0.0000", " MAXIMUM VALUES",
              " NODE         12        12        12        12        12"]  # fmt: skip
    lines += [" LIST ALL SELECTED NODES.   DSYS=      0", " SORT TABLE ON  NODE  NODE  NODE"]
    for i, (x, y) in enumerate(points):
        if i % per_page == 0:
            lines += ["", "    NODE        X             Y             Z           THXY     THYZ     THZX"]
        lines.append(f"{i + 11:8d}{x:14.6f}{y:14.6f}{5:14.6f}{0:9.2f}{0:9.2f}{0:9.2f}")
    lines += ["", " LIST ALL SELECTED ELEMENTS.  (LIST NODES)", ""]
    for i, cell in enumerate(cells):
        if i % per_page == 0:
            lines += [HEADER, "    ELEM MAT TYP REL ESY SEC        NODES", ""]
        lines.append(f"{i + 1:8d}{1:4d}{2:4d}{3:4d}{0:4d}{1:4d} " + "".join(f"{n + 11:7d}" for n in cell))
    return "\n".join([*lines, ""])


def test_ansys_listing(tmp_path):
    points, cells = faces("quad8", 3)
    p = np.round(1.0 + points[:, 0] * points[:, 1], 4)
    path = tmp_path / "contact.lis"
    path.write_text(listing(p, points, cells))
    field, _ = FieldReader(**UNITS).read_field(path)
    np.testing.assert_allclose(field.nodal_pressure, 1e6 * p, rtol=1e-5)  # five digits are printed
    assert field.nodal_area.sum() == pytest.approx(8e-6, rel=1e-6)
    corners = np.isin(np.arange(len(p)), cells[:, :4])
    text = listing(p, points, cells).splitlines()
    gone = {f"{i + 11:8d}{3:12.4f}{-1e-6 * i:12.5E}" for i in np.flatnonzero(~corners)}
    path.write_text("\n".join(line for line in text if line[:32] not in gone))
    linear, _ = FieldReader(**UNITS).read_field(path)  # corners alone are listed
    assert linear.nodal_area.size == corners.sum()
    assert linear.nodal_area.sum() == pytest.approx(8e-6, rel=1e-6)


def test_ansys_listings_in_parts(tmp_path):
    points, cells = faces("quad", 3)
    triangles = np.column_stack([cells[:, :3], cells[:, 2]])[:1]  # K = L: a triangle
    text = listing(1.0 + points[:, 0], points, np.vstack([cells[1:], triangles]))
    first, second = tmp_path / "p.lis", tmp_path / "mesh.lis"
    cut = text.index(" LIST ALL SELECTED NODES")
    first.write_text(text[:cut])
    second.write_text(text[cut:])
    with pytest.raises(ValueError, match=r"has no nodes, a table with .* \(NLIST\); give further listings"):
        FieldReader(**UNITS).read_field(first)
    field, _ = FieldReader(**UNITS, companion_files=(second,)).read_field(first)
    half = compute_nodal_areas(points, [cells[:1, :3]]).sum()
    rest = compute_nodal_areas(points, [cells[1:]]).sum()
    assert field.nodal_area.sum() == pytest.approx((half + rest) * 1e-6, rel=1e-5)
    first.write_text(text[:cut].replace(f"{15:8d}{3:12.4f}", f"{14:8d}{3:12.4f}"))
    with pytest.raises(ValueError, match=r"p.lis: line \d+: node 14 has a second pressure"):
        FieldReader(**UNITS, companion_files=(second,)).read_field(first)
