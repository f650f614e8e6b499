"""Abaqus listings as nodal contact results.

The layouts are those of the tables in "Getting Started with Abaqus" (the overhead hoist: field reports of
displacements and reactions, node tables of the data file; the connecting lug: a report wider than its page),
with contact variables for displacements. Contact tables of a data file have a status after the node.
"""

import numpy as np
import pytest
from jointfmu_tools.inputs.fields.contact_surface import ContactPlane
from jointfmu_tools.inputs.fields.reading import FieldReader
from test_fields_files import UNITS, blocks, faces, grid

DIGITS = 1e-5  # six of them are printed
REPORT = """
********************************************************************************
Field Output Report, written Fri Apr 27 10:07:54 2012

Source 1
---------

   ODB: C:/temp/joint.odb
   Step: {step}
   Frame: Increment      {increment}: Step Time =    1.000

Loc 1 : Nodal values from source 1

Output sorted by column "Node Label".
"""
AREAS = ["COORD.COOR1", "COORD.COOR2", "COORD.COOR3", "CNAREA"]


def number(x):
    """Format a number as Abaqus/CAE prints it: three digits of exponent, no trailing zeros."""
    if x == 0.0:
        return "0."
    power = 3 * int(np.floor(np.log10(abs(x)) / 3.0 + 1e-9))
    digits = f"{x / 10.0**power:#.6g}".rstrip("0")
    return digits if power == 0 else f"{digits}E{power:+03d}"


def report(columns, table, part="part: PART-1-1", step="Step-1", increment=1, per_line=9, labels=None):
    """Report of a table (n, columns) of the nodes `labels`, with `per_line` columns per line."""
    labels = range(1, len(table) + 1) if labels is None else labels
    lines = [*REPORT.format(step=step, increment=increment).splitlines(), ""]
    lines += [f"Field Output reported at nodes for {part}", "   Averaged at nodes", ""]
    pages = [slice(i, i + per_line) for i in range(0, len(columns), per_line)]
    for i, page in enumerate(pages):
        first = ["            Node", "           Label"] if i == 0 else ["", ""]
        lines.append(first[0] + "".join(f" {name:>15s}" for name in columns[page]))
        lines.append(first[1] + "".join(f"{'@Loc 1':>16s}" for _ in columns[page]))
        lines.append("-" * len(lines[-1]))
    for label, row in zip(labels, table, strict=True):
        for i, page in enumerate(pages):
            lines.append((f"{label:16d}" if i == 0 else "") + "".join(f"{number(x):>16s}" for x in row[page]))
    lines += ["", ""]
    for word, at in (("Minimum", np.argmin), ("Maximum", np.argmax)):
        best = [column[at(column)] for column in table.T]
        lines += [f"  {word}".ljust(16) + "".join(f"{number(x):>16s}" for x in best), ""]
        lines.append("         At Node" + "".join(f"{at(column) + 1:16d}" for column in table.T))
    lines += ["", "           Total" + "".join(f"{number(x):>16s}" for x in table.sum(axis=0)), "", ""]
    return "\n".join(lines)


def listed():
    """Rows of pressure, three coordinates and area of nodes on the rectangle."""
    points, _ = grid(4, 3)
    p = 1.0 + points[:, 0] * points[:, 1]
    return np.column_stack([p, points, np.full(len(p), 5.0), np.full(len(p), 0.4)])


@pytest.mark.parametrize("per_line", [9, 3, 2])
@pytest.mark.parametrize("name", ["CPRESS", "CPRESS   ASSEMBLY_LOWER/ASSEMBLY_UPPER"])
def test_a_report_with_areas(tmp_path, name, per_line):
    """The report contains pressure, coordinates and areas; nodes without area are no contact nodes."""
    table, path = listed(), tmp_path / "a.rpt"
    table[5, [0, 4]] = 0.0
    path.write_text(report([name, *AREAS], table, per_line=per_line))
    field, _ = FieldReader(**UNITS).read_field(path)
    kept = table[table[:, 4] > 0.0]
    np.testing.assert_allclose(field.nodal_pressure, 1e6 * kept[:, 0], rtol=DIGITS)
    np.testing.assert_allclose(field.node_positions, 1e-3 * kept[:, 1:3], rtol=DIGITS, atol=1e-12)
    np.testing.assert_allclose(field.nodal_area, 0.4e-6, rtol=DIGITS)


def test_columns_in_reports_of_their_own(tmp_path):
    """Coordinates of the first frame are used for the last one; pressures of earlier frames are not used."""
    table = listed()
    first, second = tmp_path / "p.rpt", tmp_path / "coord.rpt"
    early = report(["CPRESS"], 0.5 * table[:, :1], increment=0)
    first.write_text(early + report(["CPRESS", "CNAREA"], table[:, [0, 4]], increment=7))
    second.write_text(report(["COORD.Magnitude", *AREAS[:3]], table[:, [0, 1, 2, 3]], increment=0))
    with pytest.raises(ValueError, match=r"p.rpt: has no coordinates, .*; list them too, or give the input"):
        FieldReader(**UNITS).read_field(first)
    field, _ = FieldReader(**UNITS, companion_files=(second,)).read_field(first)
    np.testing.assert_allclose(field.nodal_pressure, 1e6 * table[:, 0], rtol=DIGITS)


def test_nodes_of_two_parts_are_two(tmp_path):
    """Both parts number their nodes from 1; Abaqus prints areas of one side only."""
    table, path = listed(), tmp_path / "a.rpt"
    other = table.copy()
    other[:, 4] = 0.0
    columns = ["CPRESS", *AREAS]
    upper = report(columns, other, "region: UPPER-1.Region_2")
    path.write_text(report(columns, table, "region: LOWER-1.Region_1") + upper)
    assert FieldReader(**UNITS).read_field(path)[0].nodal_area.size == len(table)


def deck(points, cells, kind, labels):
    """An input deck without parts, with two nodes per line of an element."""
    lines = ["*HEADING", "made by a test", "** a comment", "*NODE, NSET=ALL"]
    lines += [f"{n}, {', '.join(map(repr, place))}" for n, place in zip(labels, points.tolist(), strict=True)]
    lines.append(f"*Element, type={kind}, elset=E")
    for i, cell in enumerate(cells, 1):
        nodes = [str(labels[node]) for node in cell]
        pairs = [", ".join(nodes[k : k + 4]) for k in range(0, len(nodes), 4)]
        lines.append(f"{i}, " + ",\n".join(pairs))
    lines += ["*ELEMENT, TYPE=SPRING1", f"9999, {labels[0]}", "*STEP", "1, 2, 3"]
    return "\n".join([*lines, ""])


def test_a_report_on_the_faces_of_a_deck(tmp_path):
    """Abaqus lists the contact nodes only, on both sides of the contact of two blocks."""
    points, bricks, p, n = blocks()
    labels = [7 * i + 3 for i in range(4 * n)]
    mesh, path = tmp_path / "joint.inp", tmp_path / "a.rpt"
    mesh.write_text(deck(points, bricks, "C3D8R", labels))
    path.write_text(report(["CPRESS"], np.concatenate([p, 1.1 * p])[:, None], labels=labels[n : 3 * n]))
    with pytest.raises(ValueError, match=r"has no coordinates, .*give the input deck \(.inp\)"):
        FieldReader(**UNITS).read_field(path)
    for side, factor in (("below", 1.0), ("above", 1.1)):
        field, _ = FieldReader(
            **UNITS, companion_files=(mesh,), contact_plane=ContactPlane(body_side=side)
        ).read_field(path)
        assert field.nodal_area.sum() == pytest.approx(8e-6, rel=1e-13)
        np.testing.assert_allclose(field.nodal_pressure, factor * p * 1e6, rtol=DIGITS)
    part = 10  # of the nodes are listed: the others are no contact
    path.write_text(report(["CPRESS"], p[:part, None], labels=labels[n : n + part]))
    some, _ = FieldReader(**UNITS, companion_files=(mesh,)).read_field(path)
    assert 0 < some.nodal_area.size <= part


STEP = """
1

   Abaqus 2021                  Date 06-Nov-2021   Time 10:22:33

                        S T E P       1     S T A T I C   A N A L Y S I S


"""
INCREMENT = """
                                INCREMENT     {} SUMMARY


 TIME INCREMENT COMPLETED  1.00    ,  FRACTION OF STEP COMPLETED   1.00
"""


def printed(columns, table, labels, status=""):
    """Node table of a data file, without rows of zeros."""
    lines = ["", "", "   THE FOLLOWING TABLE IS PRINTED FOR NODES BELONGING TO NODE SET CONTACT", ""]
    lines += ["       NODE FOOT-   " + "".join(f"{name:<12s}" for name in columns), "            NOTE", ""]
    for label, row in zip(labels, table, strict=True):
        if np.any(row):
            values = "".join(f"{x:12.4E}" if x else "   0.000    " for x in row)
            lines.append(f"{label:11d}  {status:3s}{values}")
    best = "".join(f"{x:12.4E}" for x in table.max(axis=0))
    at = "".join(f"{labels[i]:12d}" for i in table.argmax(axis=0))
    return "\n".join([*lines, "", f" MAXIMUM        {best}", f" AT NODE        {at}", "", ""])


def test_a_data_file_on_the_faces_of_a_deck(tmp_path):
    """The last increment is used; nodes without pressure are missing in the file, as with CalculiX."""
    points, cells = faces("quad8", 3)
    place = np.column_stack([points, np.full(len(points), 5.0)])
    labels = list(range(1, len(points) + 1))
    p = np.round(np.maximum(points[:, 0] - 1.0, 0.0), 3)
    mesh, path = tmp_path / "joint.inp", tmp_path / "joint.dat"
    mesh.write_text(deck(place, cells, "S8R", labels))
    shear = np.column_stack([p, 0.1 * p, -0.1 * p])
    columns = ["CPRESS", "CSHEAR1", "CSHEAR2"]
    tables = [INCREMENT.format(i) + printed(columns, i * shear, labels, "CL") for i in (1, 2)]
    path.write_text(STEP + "".join(tables) + printed(["U1", "U2"], points, labels))
    with pytest.raises(ValueError, match=r"joint.dat: node \d+: has no pressure"):
        FieldReader(**UNITS, companion_files=(mesh,)).read_field(path)
    field, _ = FieldReader(**UNITS, companion_files=(mesh,), open_node_treatment="keep").read_field(path)
    np.testing.assert_allclose(field.nodal_pressure, 2e6 * p, rtol=5e-5)  # five digits are printed
    assert field.nodal_area.sum() == pytest.approx(8e-6, rel=1e-13)
    again = printed(["CPRESS", "COOR1", "COOR2", "COOR3", "CNAREA"], listed(), labels[: len(listed())])
    path.write_text(STEP + INCREMENT.format(1) + again)
    alone, _ = FieldReader(**UNITS).read_field(path)
    np.testing.assert_allclose(alone.nodal_pressure, 1e6 * listed()[:, 0], rtol=5e-5)


def changed(old, new, **options):
    return report(["CPRESS", *AREAS], listed(), **options).replace(old, new, 1)


@pytest.mark.parametrize(("text", "message"), [
    ("nothing here", r"has no contact pressure; expected a column CPRESS .* \(Unique Nodal\)"),
    (report(["U.U1"], listed()[:, :1]), "has no contact pressure"),
    (changed("reported at nodes", "reported at element nodes"), r"has no contact pressure; .* \(Unique"),
    (changed("CNAREA", " EVOL "), r"has no nodal areas, a column CNAREA; list them too, or give"),
    (changed("          @Loc 1", ""), r"line \d+: has 4 columns, but its headings cannot be .*: CPRESS"),
    (changed("COORD.COOR1", "CPRESS X/Y "), r"line \d+: has 2 columns CPRESS, expected one contact pair"),
    (changed("\n              20  ", "\n               1  "), r"line \d+: node 1 has a second CPRESS, exp"),
    (changed("\n               2  ", "\n               2 x"), r"line \d+: '2 x.*' is not a row with a"),
])  # fmt: skip
def test_broken_reports_are_refused_with_the_line(tmp_path, text, message):
    path = tmp_path / "a.rpt"
    path.write_text(text)
    with pytest.raises(ValueError, match=message) as error:
        FieldReader(**UNITS).read_field(path)
    assert str(error.value).startswith(f"{path}: ")
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(("old", "new", "message"), [
    ("*NODE, NSET=ALL", "*INSTANCE, NAME=A", r"line 4: has \*INSTANCE, expected a deck whose nodes and elem"),
    ("*NODE, NSET=ALL", "*NGEN", r"line 4: has \*NGEN, expected a deck"),
    ("*NODE, NSET=ALL", "*NSET, NSET=ALL", r"has no nodes and elements"),
    ("\n1, 0.0", "\n1, 0.x", r"line 5: '1, 0.x, .*' is not a line of \*NODE"),
    ("\n5, ", "\n500, ", r"node 5 of an element has no coordinates; expected the coordinates of all"),
    ("type=S4", "type=S3", r"line \d+: '1, 1, 5, 6, 2' is not .* \*ELEMENT; .* and 3 nodes"),
    ("type=S4", "type=S8R", r"line \d+: '1, 1, 5, 6, 2' is not .* \*ELEMENT; .* and 8 nodes"),
])  # fmt: skip
def test_broken_decks_are_refused(tmp_path, old, new, message):
    points, cells = grid(4, 3)
    labels = list(range(1, len(points) + 1))
    mesh, path = tmp_path / "joint.inp", tmp_path / "a.rpt"
    text = deck(np.column_stack([points, 0.0 * points[:, 0]]), cells, "S4", labels)
    assert old in text
    mesh.write_text(text.replace(old, new, 1))
    path.write_text(report(["CPRESS"], listed()[:, :1]))
    with pytest.raises(ValueError, match=message) as error:
        FieldReader(**UNITS, companion_files=(mesh,)).read_field(path)
    assert str(error.value).startswith(f"{mesh}: ")
    assert "\n" not in str(error.value)


def test_a_deck_has_one_numbering(tmp_path):
    points, cells = grid(4, 3)
    labels = list(range(1, len(points) + 1))
    mesh, path = tmp_path / "joint.inp", tmp_path / "a.rpt"
    mesh.write_text(deck(np.column_stack([points, 0.0 * points[:, 0]]), cells, "S4", labels))
    two = [report(["CPRESS"], listed()[:, :1], f"part: {name}") for name in ("LOWER-1", "UPPER-1")]
    path.write_text("".join(two))
    with pytest.raises(
        ValueError, match=r"lists nodes of 2 parts \(LOWER-1, UPPER-1\), but an input deck has one"
    ):
        FieldReader(**UNITS, companion_files=(mesh,)).read_field(path)
    path.write_text(report(["CPRESS"], listed()[:, :1], labels=[n + 1 for n in labels]))
    with pytest.raises(ValueError, match=r"node 21 has a pressure, but is not in .*joint.inp"):
        FieldReader(**UNITS, companion_files=(mesh,)).read_field(path)
