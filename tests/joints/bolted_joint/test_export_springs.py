"""Exported springs between node pairs: their totals, on the joint's nodes and on meshes, in every format."""

import csv
import io
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from jointfmu_tools.exchange.export import ansys, keywords, tables
from jointfmu_tools.exchange.export.mesh import NodePairs, read_node_pairs
from jointfmu_tools.exchange.export.target_model import AXIS_ORDER, SI_UNIT_SET, UNIT_SETS, TargetModel
from jointfmu_tools.joints.bolted_joint.export import (
    TOTAL_STIFFNESS_AND_DAMPING_NAMES,
    make_springs_of_joint,
    make_springs_on_mesh,
    make_springs_under_pressure,
)

from jointfmu.joints.bolted_joint.joint import BoltedJointSpring
from jointfmu.joints.bolted_joint.law import preload_pressure
from jointfmu.parameters import load_default

MM = UNIT_SETS["mm-N-MPa-t"]
REST = (0.0, 0.0, 0.0)
DIGITS = 1e-8  # the formats carry nine digits


@pytest.fixture(scope="module")
def joint():
    return BoltedJointSpring.from_interface_nodes(load_default("bolted_joint").values)


@pytest.fixture(scope="module")
def found(joint):
    return make_springs_of_joint(joint, 15e3, 4500.0)


def grid(size, nodes):
    """Mesh of a frame like that of the joint: node pairs, positions, areas (smaller at edges and corners)."""
    ticks = [np.linspace(-half, half, n) for half, n in zip(size, nodes, strict=True)]
    width = [np.convolve(np.diff(t), [0.5, 0.5]) for t in ticks]
    x, y = (v.ravel() for v in np.meshgrid(*ticks, indexing="ij"))
    area = np.outer(*width).ravel()
    frame = (np.abs(x) > 0.08) | (np.abs(y) > 0.13)  # half the spacings of bolts less half the flange
    labels = np.arange(1, 2 * frame.sum() + 1).reshape(2, -1).T
    return labels, np.stack([x, y], axis=1)[frame], area[frame]


# ---- sums ----


@pytest.mark.parametrize(("preload", "moment"), [(9e3, 0.0), (15e3, 4500.0), (20e3, -3000.0)])
def test_pairs_add_up_to_the_joint(joint, preload, moment):
    springs = make_springs_of_joint(joint, preload, moment)
    state = joint.evaluate(preload, moment, REST, REST)
    # sums of a thousand terms: round-off
    for name, column in zip(
        TOTAL_STIFFNESS_AND_DAMPING_NAMES,
        (springs.K_t, springs.K_t, springs.K_n, springs.C_t, springs.C_t, springs.C_n),
        strict=True,
    ):
        assert column.sum() == pytest.approx(state[name], rel=1e-12), name
    x, y = springs.position.T
    about = (springs.K_n @ y**2, springs.K_n @ x**2, springs.K_t @ (x**2 + y**2))
    assert about == pytest.approx([state[n] for n in ("K_rx", "K_ry", "K_rz")], rel=1e-12)
    assert springs.area @ springs.pressure == pytest.approx(8.0 * preload, rel=1e-12)
    assert springs.stiffness_correction_factor == 1.0


def test_stiffness_of_a_pair_is_the_law_at_its_pressure(joint, found):
    from jointfmu.contact.interface import evaluate_at_pressure

    law = joint.joint
    state = evaluate_at_pressure(law, found.pressure)  # of the whole A_0; the curve is within 1e-8 of it
    np.testing.assert_allclose(found.K_n, found.area / law.A_0 * state["K_N"], rtol=1e-7)
    np.testing.assert_allclose(found.K_t, found.area / law.A_0 * state["K_T"], rtol=1e-7)


def test_open_pairs_are_left_out(joint):
    moment = 0.9 * 15e3 * 3 * joint.joint.row_distance * 1.5  # one row gives way
    springs = make_springs_of_joint(joint, 15e3, moment)
    p = preload_pressure(joint.joint, joint.points, 15e3, moment)
    assert springs.open_pair_count == np.sum(p == 0.0) > 0
    assert len(springs.node_labels) == np.sum(p > 0.0)
    assert springs.K_n.sum() == pytest.approx(joint.evaluate(15e3, moment, REST, REST)["K_zz"], rel=1e-12)


@pytest.mark.parametrize("state", [(0.0, 0.0), (-1.0, 0.0), (np.nan, 0.0), (1e9, 0.0)])
def test_state_outside_the_law_is_refused(joint, state):
    with pytest.raises(ValueError, match=r"preload = .* N per bolt with moment = .* outside the law"):
        make_springs_of_joint(joint, *state)


# ---- meshes ----


def test_the_joints_own_nodes_as_a_mesh_give_the_same(joint, found):
    area = joint.points.area_share * joint.joint.A_0
    mesh = NodePairs("own.csv", found.node_labels, joint.points.position, area, None)
    same = make_springs_on_mesh(joint, mesh, 15e3, 4500.0)
    np.testing.assert_allclose(same.K_n, found.K_n, rtol=1e-9)  # the triangulation's round-off
    assert same.stiffness_correction_factor == pytest.approx(1.0, rel=1e-9)


@pytest.mark.parametrize("nodes", [(25, 35), (49, 69), (97, 137)])
def test_a_mesh_has_the_joints_sums(joint, nodes):
    labels, place, area = grid((0.12, 0.17), nodes)
    area *= joint.joint.A_0 / area.sum()
    springs = make_springs_on_mesh(joint, NodePairs("mesh.csv", labels, place, area, None), 15e3, 4500.0)
    state = joint.evaluate(15e3, 4500.0, REST, REST)
    assert springs.K_n.sum() == pytest.approx(state["K_zz"], rel=1e-12)
    assert springs.C_t.sum() == pytest.approx(state["C_xx"], rel=1e-12)
    # 10 to 2.5 mm of mesh on the joint's cells of 6 mm: the moment arms agree within a few per cent
    x, y = springs.position.T
    assert springs.K_n @ y**2 == pytest.approx(state["K_rx"], rel=0.05)
    assert springs.K_n @ x**2 == pytest.approx(state["K_ry"], rel=0.05)
    assert springs.stiffness_correction_factor == pytest.approx(1.0, abs=0.05)


def test_stated_pressures_give_the_law_at_them(joint):
    labels, place, area = grid((0.12, 0.17), (25, 35))
    area *= joint.joint.A_0 / area.sum()
    p = 1e6 * (1.0 + 5.0 * place[:, 1] ** 2 / 0.17**2)
    p[:7] = 0.0
    springs = make_springs_under_pressure(joint, NodePairs("mesh.csv", labels, place, area, p))
    assert springs.open_pair_count == 7
    np.testing.assert_allclose(springs.pressure, p[7:], rtol=1e-12)
    k = joint.curve.derivatives(joint.curve.inverse(p[7:]), 1)[1]
    np.testing.assert_allclose(springs.K_n, area[7:] * k, rtol=1e-12)
    assert not np.any(springs.C_n)  # plastic work of first loading
    joint = replace(joint, joint=replace(joint.joint, plastic_damping=True))
    springs = make_springs_under_pressure(joint, NodePairs("mesh.csv", labels, place, area, p))
    plastic, elastic = joint.first_loading_work(p)  # open nodes count with the closing's end, as in the joint
    eta = (plastic @ area) / (elastic @ area)
    expected = eta * np.sqrt(joint.joint.mass * springs.K_n.sum())
    assert springs.C_n.sum() == pytest.approx(expected, rel=1e-9)


def test_meshes_that_do_not_fit_are_refused(joint):
    labels, place, area = grid((0.12, 0.17), (25, 35))
    area *= joint.joint.A_0 / area.sum()
    with pytest.raises(ValueError, match=r"m.csv: the areas add up to 0.0764 m2, the joint has A_0 = 0.0382"):
        make_springs_on_mesh(joint, NodePairs("m.csv", labels, place, 2.0 * area, None), 9e3, 0.0)
    with pytest.raises(ValueError, match=r"m.csv: node \d+ is .* m outside the joint's contact"):
        make_springs_on_mesh(joint, NodePairs("m.csv", labels, 1.5 * place, area, None), 9e3, 0.0)
    peaks = np.argsort(joint.points.preload_pressure_ratio)[-3:]  # beside bolts only
    coarse = NodePairs("m.csv", labels[:3], joint.points.position[peaks], np.full(3, 0.0382 / 3), None)
    with pytest.raises(
        ValueError, match=r"m.csv: the pressures at its nodes add up to .* times the joint's force"
    ):
        make_springs_on_mesh(joint, coarse, 15e3, 4500.0)
    with pytest.raises(ValueError, match="has no column 'pressure'"):
        make_springs_under_pressure(joint, NodePairs("m.csv", labels, place, area, None))


HEAD = "node_1 [1],node_2 [1],x [mm],y [mm],area [mm2],pressure [MPa]\n"
ROWS = "1,11,0,0,2,1\n2,12,4,0,2,0\n3,13,0,6,4,2.5\n"


def test_pairs_are_read_in_their_units(tmp_path):
    path = tmp_path / "pairs.csv"
    path.write_text(HEAD + ROWS)
    mesh = read_node_pairs(path)
    assert mesh.node_labels.tolist() == [[1, 11], [2, 12], [3, 13]]
    np.testing.assert_allclose(mesh.contact_area, [2e-6, 2e-6, 4e-6])
    np.testing.assert_allclose(mesh.contact_pressure, [1e6, 0.0, 2.5e6])
    np.testing.assert_allclose(mesh.position, [[-1e-3, -3e-3], [3e-3, -3e-3], [-1e-3, 3e-3]])
    path.write_text(HEAD.replace(",pressure [MPa]", "") + "\n".join(r[: r.rfind(",")] for r in ROWS.split()))
    assert read_node_pairs(path).contact_pressure is None


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("3,13", "1,13", "node 1 is given twice"),
        ("3,13", "3,3", "node 3 is given twice"),
        ("2,12", "2.5,12", "node_1 = 2.5 is not a node"),
        ("2,12", "-2,12", "node_1 = -2 is not a node"),
        ("4,2.5", "0,2.5", "area = 0 .SI. at node 3: it must be positive"),
        ("4,2.5", "4,-1", "pressure = -1e.06 .SI. at node 3: a contact does not pull"),
        ("4,2.5", "4,nan", "line 4: pressure = 'nan' is not a finite number"),
        ("area [mm2]", "area", "column 'area' has no unit"),
        ("area [mm2]", "area [in2]", "column 'area' has unit 'in2', allowed are m2, mm2"),
        ("node_2 [1]", "other [1]", "has no column 'node_2'"),
        ("3,13,0,6,4,2.5\n", "", "has 2 rows of numbers, at least 3"),
    ],
)
def test_bad_pairs_are_refused_with_their_place(tmp_path, old, new, said):
    path = tmp_path / "pairs.csv"
    path.write_text((HEAD + ROWS).replace(old, new))
    with pytest.raises(ValueError, match=said) as raised:
        read_node_pairs(path)
    assert str(raised.value).startswith(f"{path}: ")


# ---- formats, read back by others ----


def test_units():
    # 1 N/mm = 1e3 N/m, 1 MPa = 1 N/mm2, 1 t = 1 N s2/mm
    assert MM.convert_from_si(2e3, "N/m") == pytest.approx(2.0)
    assert MM.convert_from_si(3e6, "Pa") == pytest.approx(3.0)
    assert MM.convert_from_si(1.0, "m2") == pytest.approx(1e6)
    assert MM.convert_from_si(5.0, "N.m") == pytest.approx(5e3)
    assert MM.convert_from_si(1e9, "N/m3") == pytest.approx(1.0)
    assert [MM.unit_symbol(u) for u in ("Pa", "N", "N.s/m")] == ["MPa", "N", "N.s/mm"]
    assert SI_UNIT_SET.convert_from_si(7.0, "Pa") == 7.0


@pytest.mark.parametrize("normal", list(AXIS_ORDER))
def test_ansys_is_read_by_mapdl_archive(found, tmp_path, normal):
    import mapdl_archive

    path = tmp_path / "springs.cdb"
    path.write_text(
        ansys.format_springs(
            found,
            TargetModel(MM, normal, first_free_number=1, first_free_set_number=1),
            ["first line\nand second"],
        )
    )
    archive = mapdl_archive.Archive(path, parse_vtk=False)
    assert archive.ekey.tolist() == [[1, 27], [2, 27]]
    assert {k: sorted(map(tuple, v)) for k, v in archive.key_option.items()} == {
        1: [(2, 0), (3, 4)],
        2: [(2, 0), (3, 5)],
    }
    axes = list(AXIS_ORDER[normal])
    place = dict(zip(archive.nnum.tolist(), archive.nodes, strict=True))
    for side in (0, 1):
        labels = archive.node_components[f"JOINT_SIDE_{side + 1}"]
        assert labels.tolist() == sorted(found.node_labels[:, side])
        read = np.array([place[n] for n in found.node_labels[:, side]])
        np.testing.assert_allclose(read[:, axes[:2]], 1e3 * found.position, rtol=1e-12, atol=1e-12)
        assert not read[:, axes[2]].any()
    constants = dict(zip(archive.rlblock_num.tolist(), archive.rlblock, strict=True))
    elements = np.array(archive.elem)  # material, type, real constants, five more, element, one more, I, J
    assert elements[:, 8].tolist() == list(range(1, 2 * len(found.node_labels) + 1))
    for kind, tangential, normals in ((1, found.K_t, found.K_n), (2, found.C_t, found.C_n)):
        mine = elements[elements[:, 1] == kind]
        assert mine[:, 10:].tolist() == found.node_labels.tolist()
        matrices = np.array([symmetric(constants[r]) for r in mine[:, 2]])
        diagonal = np.diagonal(matrices, axis1=1, axis2=2)
        np.testing.assert_allclose(diagonal[:, axes[0]], tangential / 1e3, rtol=DIGITS)
        np.testing.assert_allclose(diagonal[:, axes[1]], tangential / 1e3, rtol=DIGITS)
        np.testing.assert_allclose(diagonal[:, axes[2]], normals / 1e3, rtol=DIGITS)
        rigid = np.tile(np.eye(6), 2)  # no force where both nodes move alike, nor from rotations
        assert not (matrices @ rigid.T).any()
        assert not matrices[:, [3, 4, 5, 9, 10, 11]].any()


def symmetric(upper):
    """Symmetric 12 x 12 matrix of the constants C1 to C78, in rows from the diagonal on."""
    matrix = np.zeros((12, 12))
    values = iter(upper)
    for i in range(12):
        for j in range(i, 12):
            matrix[i, j] = matrix[j, i] = next(values)
    assert next(values, None) is None
    return matrix


def test_the_order_of_the_constants_is_the_references():
    # "if a simple spring of stiffness K in the nodal x direction is desired, the input constants would be
    # C1=C58=K and C7=-K" (ANSYS element reference, MATRIX27)
    constants = ansys.compute_matrix27_constants(np.array([3.0, 0.0, 0.0]))
    assert {i + 1: v for i, v in enumerate(constants) if v} == {1: 3.0, 58: 3.0, 7: -3.0}


@pytest.mark.slow
def test_abaqus_is_read_by_abq2ccx(found, tmp_path):
    deck = tmp_path / "springs.inp"
    step = "*STEP\n*STATIC\n*END STEP\n"
    text = keywords.format_springs(
        found, TargetModel(MM, "z", first_free_number=1), ["about"], writes_dashpots=True
    )
    deck.write_text(text + step)
    done = subprocess.run(
        [sys.executable, "-m", "abq2ccx", deck, "-o", tmp_path / "out.inp", "--strict"],
        capture_output=True,
        text=True,
        timeout=100,
    )
    assert done.returncode == 0, done.stderr  # strict: not one warning
    elements, values = deck_cards((tmp_path / "out.inp").read_text())
    sums = {"SPRING": [0.0] * 3, "DASHPOT": [0.0] * 3}
    for name, (keyword, dofs, value) in values.items():
        axis = "XYZ".index(name.split("_")[1][1])
        assert dofs in (None, (axis + 1, axis + 1))  # a converted dashpot has an axis of its own
        sums[keyword][axis] += value * len(elements[name])
    whole = [found.total_stiffness_and_damping[n] / 1e3 for n in TOTAL_STIFFNESS_AND_DAMPING_NAMES]
    np.testing.assert_allclose(sums["SPRING"] + sums["DASHPOT"], whole, rtol=DIGITS)


@pytest.mark.parametrize("dashpots", [False, True], ids=["calculix", "abaqus"])
def test_meshio_has_no_name_for_the_elements(found, tmp_path, capsys, dashpots):
    """If meshio supports these elements, the sentence in docs/export_reference.md must be removed."""
    import meshio

    deck = tmp_path / "springs.inp"
    text = keywords.format_springs(
        found, TargetModel(MM, "z", first_free_number=1), ["about"], writes_dashpots=dashpots
    )
    names = set(re.findall(r"^\*ELEMENT, TYPE=(\w+)", text, re.MULTILINE))
    assert names == ({"SPRING2", "DASHPOT2"} if dashpots else {"SPRING2"})
    page = (Path(__file__).parents[3] / "docs" / "export_reference.md").read_text()
    for name in sorted(names):
        assert f"`{name}`" in page
        blocks = re.findall(rf"^\*ELEMENT, TYPE={name},.*\n(?:\d.*\n)+", text, re.MULTILINE)
        nodes = text[text.index("*NODE") : text.index("*ELEMENT")]
        deck.write_text(nodes + blocks[0])
        with pytest.raises((SystemExit, meshio.ReadError)):
            meshio.read(deck)
        assert f"Element type not available: {name}" in "".join(capsys.readouterr())


def deck_cards(text):
    """Elements of each set of a CalculiX deck, and (SPRING or DASHPOT, degrees of freedom, value) of each
    set."""
    elements, values, name, card = {}, {}, "", ""
    for line in text.splitlines():
        if line.startswith("**") or not line.strip():
            continue
        if line.startswith("*"):
            card, generated = line.split(",")[0].strip("* ").upper(), "GENERATE" in line.upper()
            found = [
                p.split("=")[1].strip() for p in line.split(",") if p.strip().upper().startswith("ELSET=")
            ]
            name = found[0] if found else ""
            rows = []
        elif card == "ELEMENT" and name:
            elements.setdefault(name, []).append(line)
        elif card == "ELSET":
            labels = [int(v) for v in line.split(",") if v.strip()]
            if generated:
                first, last, step = labels
                labels = list(range(first, last + 1, step))
            elements.setdefault(name, []).extend(labels)
        elif card in ("SPRING", "DASHPOT"):
            rows.append([float(v) for v in line.split(",")])
            dofs = tuple(int(v) for v in rows[0]) if len(rows) > 1 else None
            values[name] = card, dofs, rows[-1][0]
    return elements, values


def test_calculix_text_has_the_same_springs_and_no_dashpots(found):
    text = keywords.format_springs(
        found, TargetModel(MM, "x", first_free_number=5000, defines_nodes=False), [], writes_dashpots=False
    )
    elements, values = deck_cards(text)
    assert "*NODE" not in text
    assert {kind for kind, _, _ in values.values()} == {"SPRING"}
    rows = [[int(v) for v in row.split(",")] for rows in elements.values() for row in rows]
    assert sorted(row[0] for row in rows) == list(range(5000, 5000 + 3 * len(found.node_labels)))
    assert sorted(row[1:] for row in rows) == sorted(found.node_labels.tolist() * 3)
    sums = [0.0] * 3
    for name, (_, dofs, value) in values.items():
        assert dofs[0] == dofs[1]
        sums[dofs[0] - 1] += value * len(elements[name])
    # the joint's normal along the model's x
    np.testing.assert_allclose(
        sums, [found.total_stiffness_and_damping[n] / 1e3 for n in ("K_zz", "K_xx", "K_yy")], rtol=DIGITS
    )


def test_csv_is_read_by_the_standard_library(found):
    text = tables.format_springs_csv(found, TargetModel(MM), ["about"])
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    rows = list(csv.DictReader(io.StringIO("\n".join(lines))))
    read = {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}
    assert list(read)[:4] == ["node_1 [1]", "node_2 [1]", "x [mm]", "y [mm]"]
    np.testing.assert_allclose(read["pressure [MPa]"], found.pressure / 1e6, rtol=1e-11)  # twelve digits
    np.testing.assert_allclose(read["K_z [N/mm]"], found.K_n / 1e3, rtol=1e-11)
    np.testing.assert_allclose(read["C_x [N.s/mm]"], found.C_t / 1e3, rtol=1e-11)
    assert read["area [mm2]"].sum() == pytest.approx(0.0382e6, rel=1e-9)


def test_what_is_written_as_csv_is_a_mesh_again(joint, found, tmp_path):
    path = tmp_path / "springs.csv"
    path.write_text(tables.format_springs_csv(found, TargetModel(MM), []))
    again = make_springs_under_pressure(joint, read_node_pairs(path))
    np.testing.assert_allclose(again.K_n, found.K_n, rtol=1e-9)  # pressures of twelve digits, power 0.9
