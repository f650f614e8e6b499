"""ANSYS archives (CDWRITE) together with listings of contact pressure."""

from pathlib import Path

import numpy as np
import pytest
from jointfmu_tools.inputs.fields import ansys
from jointfmu_tools.inputs.fields.contact_surface import ContactPlane
from jointfmu_tools.inputs.fields.mesh import compute_nodal_areas
from jointfmu_tools.inputs.fields.reading import FieldReader
from mapdl_archive import examples
from surroundings import missing_package
from test_fields_files import UNITS, blocks, faces, listing


def archive(points, elements, types):
    """Archive as CDWRITE writes it, in the format of the examples of mapdl-archive; `elements` are (type,
    nodes)."""
    lines = ["/COM,ANSYS RELEASE 2021 R1", "/PREP7", "/NOPR"]
    lines += [f"ET,{i},{kind}" for i, kind in types.items()]
    lines += [f"NBLOCK,6,SOLID,{len(points):10d},{len(points):10d}", "(3i9,6e21.13e3)"]
    for i, place in enumerate(points, 11):
        lines.append(f"{i:9d}{0:9d}{0:9d}" + "".join(f"{x:21.13E}" for x in place))
    lines += ["N,R5.3,LOC,       -1,", f"EBLOCK,19,SOLID,{len(elements):10d},{len(elements):10d}", "(19i9)"]
    for i, (kind, nodes) in enumerate(elements, 1):
        head = [1, kind, 1, 1, 0, 0, 0, 0, len(nodes), 0, i]
        numbers = [*head, *(n + 11 if n >= 0 else 0 for n in nodes)]
        lines += ["".join(f"{n:9d}" for n in part) for part in (numbers[:19], numbers[19:]) if part]
    return "\n".join([*lines, "       -1", ""])


def pressures(p, points, cells):
    text = listing(p, points, cells)
    return text[: text.index(" LIST ALL SELECTED NODES")]


def test_contact_elements_of_an_archive(tmp_path):
    """The result is the same as from NLIST and ELIST; elements of another contact, and targets, are
    ignored."""
    points, cells = faces("quad8", 3)
    p = np.round(1.0 + points[:, 0] * points[:, 1], 4)
    path, mesh = tmp_path / "p.lis", tmp_path / "mesh.cdb"
    path.write_text(listing(p, points, cells))
    expected, _ = FieldReader(**UNITS).read_field(path)
    path.write_text(pressures(p, points, cells))
    with pytest.raises(ValueError, match=r"has no nodes, a table with .* \(NLIST\); give further listings"):
        FieldReader(**UNITS).read_field(path)
    n = len(points)
    place = np.vstack(
        [np.column_stack([points, np.full(n, 5.0)]), np.column_stack([points, np.full(n, 5.0)])]
    )
    elements = (
        [(1, cell) for cell in cells] + [(1, cell + n) for cell in cells] + [(2, cell) for cell in cells]
    )
    mesh.write_text(archive(place, elements, {1: 174, 2: 170}))
    field, _ = FieldReader(**UNITS, companion_files=(mesh,)).read_field(path)
    np.testing.assert_allclose(field.nodal_pressure, expected.nodal_pressure, rtol=1e-12)
    np.testing.assert_allclose(field.nodal_area, expected.nodal_area, rtol=1e-5)  # six digits are listed
    triangle = cells[0][[0, 1, 2, 2, 4, 5, 2, 7]]  # K = L = O
    mesh.write_text(archive(place, [(1, triangle), *elements[1 : len(cells)]], {1: 174}))
    half = compute_nodal_areas(points, [triangle[None, [0, 1, 2, 4, 5, 7]]]).sum()
    rest = compute_nodal_areas(points, [cells[1:]]).sum()
    cut, _ = FieldReader(**UNITS, companion_files=(mesh,)).read_field(path)
    assert cut.nodal_area.sum() == pytest.approx((half + rest) * 1e-6, rel=1e-12)


def test_solids_of_an_archive(tmp_path):
    """The lower body has bricks; the upper one has wedges, which are bricks with K = L and O = P."""
    points, bricks, p, _ = blocks()
    half = len(bricks) // 2
    wedges = [
        brick[part]
        for brick in bricks[half:]
        for part in ([0, 1, 2, 2, 4, 5, 6, 6], [0, 2, 3, 3, 4, 6, 7, 7])
    ]
    path, mesh = tmp_path / "p.lis", tmp_path / "mesh.cdb"
    mesh.write_text(archive(points, [(1, e) for e in (*bricks[:half], *wedges)], {1: 185}))
    text = pressures(np.concatenate([0 * p, p, 1.1 * p, 0 * p]), points[:, :2], bricks)
    path.write_text(text)
    for side, factor in (("below", 1.0), ("above", 1.1)):
        field, _ = FieldReader(
            **UNITS, companion_files=(mesh,), contact_plane=ContactPlane(body_side=side)
        ).read_field(path)
        assert field.nodal_area.sum() == pytest.approx(8e-6, rel=1e-12)
        np.testing.assert_allclose(
            field.nodal_pressure, factor * p * 1e6, rtol=1e-5
        )  # five digits are printed


@pytest.mark.parametrize(("example", "area"), [
    # of the closed surfaces of the files, from the places of their nodes; the beams' are their boxes'
    (examples.hexarchivefile, 2 * 1.0 * 1.0 + 4 * 1.0 * 5.0),
    (examples.tetarchivefile, 2 * 1.0 * 1.0 + 4 * 1.0 * 10.0),
])  # fmt: skip
def test_files_of_ansys(example, area):
    mesh = ansys.read_ansys_archive(Path(example))
    found = 0.0
    for axis in range(3):
        for block in mesh.surface_faces():
            flat = np.ptp(mesh.node_positions[block][:, :, axis], axis=1) < 1e-9
            found += compute_nodal_areas(np.delete(mesh.node_positions, axis, axis=1), [block[flat]]).sum()
    assert found == pytest.approx(area, rel=1e-9)


@pytest.mark.parametrize(("elements", "types", "message"), [
    ([(1, [0, 1])], {1: 14}, r"mesh.cdb: has no contact elements \(CONTA173, CONTA174\) and no solids"),
    ([(1, [0, 1, 2, 3, 900])], {1: 174}, r"mesh.cdb: element 1 has 5 different nodes, as no supported"),
    ([(1, [0, 1, 2, 900])], {1: 174}, r"mesh.cdb: node 911 of an element has no coordinates; expected"),
    ([(1, [0, 1, 5, 4])], {1: 174}, r"p.lis: node 13: has a pressure, but is on no element face"),
])  # fmt: skip
def test_broken_archives_are_refused(tmp_path, elements, types, message):
    points, cells = faces("quad", 3)
    path, mesh = tmp_path / "p.lis", tmp_path / "mesh.cdb"
    path.write_text(pressures(1.0 + points[:, 0], points, cells))
    mesh.write_text(archive(np.column_stack([points, np.zeros(len(points))]), elements, types))
    with pytest.raises(ValueError, match=message) as error:
        FieldReader(**UNITS, companion_files=(mesh,)).read_field(path)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(("text", "message"), [
    ("no archive", r"mapdl-archive cannot read it \(.*\); expected NBLOCK and EBLOCK \(CDWRITE\)"),
    (None, r"cannot be read \(no such file\); expected an ANSYS archive"),
])  # fmt: skip
def test_what_is_no_archive_is_one_line(tmp_path, text, message):
    points, cells = faces("quad", 3)
    path, mesh = tmp_path / "p.lis", tmp_path / "mesh.cdb"
    path.write_text(pressures(1.0 + points[:, 0], points, cells))
    if text:
        mesh.write_text(text)
    with pytest.raises(ValueError, match=message) as error:
        FieldReader(**UNITS, companion_files=(mesh,)).read_field(path)
    assert str(error.value).startswith(f"{mesh}: ")
    assert "\n" not in str(error.value)


def test_without_the_package_it_says_what_to_install(tmp_path, enter):
    enter(missing_package("mapdl_archive"))
    with pytest.raises(ValueError, match=r"mapdl_archive is missing, .*: pip install 'jointfmu\[field\]'"):
        ansys.read_ansys_archive(tmp_path / "mesh.cdb")


def test_a_node_that_the_archive_has_not(tmp_path):
    points, cells = faces("quad", 3)
    path, mesh = tmp_path / "p.lis", tmp_path / "mesh.cdb"
    path.write_text(pressures(1.0 + points[:, 0], points, cells).replace(f"\n{11:8d}", f"\n{911:8d}", 1))
    flat = np.column_stack([points, np.zeros(len(points))])
    mesh.write_text(archive(flat, [(1, cell) for cell in cells], {1: 173}))
    with pytest.raises(ValueError, match=r"p.lis: node 911 has a pressure, but is not in .*mesh.cdb"):
        FieldReader(**UNITS, companion_files=(mesh,)).read_field(path)
