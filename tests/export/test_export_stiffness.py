"""Stiffness of a complete joint in each format: read back, the node moves by the 6 x 6 compliance.

The expected displacement of a loaded node does not use the rigid arms of the package: the load of the node is
moved to the centroid, the compliance gives the motion there, and the node follows as a point of a rigid body.
"""

import json
import re
from contextlib import chdir

import numpy as np
import pytest
from clients import needs
from conftest import refused_line
from jointfmu_tools import cli
from jointfmu_tools.exchange.export import ansys, aster, keywords, nastran
from jointfmu_tools.exchange.export.joint_stiffness import JointStiffness
from jointfmu_tools.exchange.export.target_model import AXIS_ORDER, UNIT_SETS, TargetModel
from jointfmu_tools.run.engine import open_joint
from oracles import calculix

from jointfmu.joints import KINDS
from jointfmu.joints.bolted_joint.joint import BoltedJointSpring
from jointfmu.parameters import load_default, load_parameter_file

MM, SI = UNIT_SETS["mm-N-MPa-t"], UNIT_SETS["m-N-Pa-kg"]
FIRST = 501
POSITIONS = np.array([[0.003, -0.002, -0.011], [-0.001, 0.004, 0.017]])
LOAD = np.array([900.0, -700.0, 1500.0, 11e3, -8e3, 6e3])
"""Force [N] and moment [N.mm] on the node of side 2."""
# ten digits of each entry are written, nine for ANSYS; the compliance amplifies their round-off
DIGITS = {"ansys": 1e-6, "calculix": 1e-6}


def coupled(coupling=0.2):
    """Positive definite stiffness matrix with all couplings, of the size of a joint of four M8 bolts."""
    rng = np.random.default_rng(5)
    size = np.sqrt([8e9, 7e9, 2e10, 1.2e7, 1.1e7, 1e7])
    off = rng.uniform(-coupling, coupling, (6, 6))
    return np.outer(size, size) * (np.eye(6) + 0.5 * (off + off.T) * (1.0 - np.eye(6)))


def expected_motion(K, positions, normal):
    """Motion (6) [mm, rad] of node 2 under LOAD with node 1 held, of a joint with K (6, 6) in SI units."""
    axes = list(AXIS_ORDER[normal])
    r2 = 1e3 * positions[1]
    force, moment = LOAD[:3], LOAD[3:] + np.cross(r2, LOAD[:3])
    wrench = np.concatenate([force[axes], 1e-3 * moment[axes]])
    q = np.linalg.solve(K, wrench)
    shift, turn = np.empty(3), np.empty(3)
    shift[axes], turn[axes] = 1e3 * q[:3], q[3:]
    return np.concatenate([shift + np.cross(turn, r2), turn])


def assert_moves(matrix, motion, tolerance=1e-8):
    """Assert that node 2 moves as expected under LOAD with node 1 fixed, and that rigid motions cause no
    force."""
    np.testing.assert_allclose(matrix, matrix.T, rtol=1e-12)
    np.testing.assert_allclose(np.linalg.solve(matrix[6:, 6:], LOAD), motion, rtol=tolerance)
    r = 1e3 * POSITIONS
    for axis in range(3):
        shift, turn = np.eye(3)[axis], np.eye(3)[axis]
        bodies = [np.concatenate([*([shift, 0 * turn])] * 2)]
        bodies.append(np.concatenate([np.cross(turn, r[0]), turn, np.cross(turn, r[1]), turn]))
        for body in bodies:
            forces = matrix * body
            assert np.max(np.abs(forces.sum(axis=1))) < 1e-7 * np.max(np.abs(forces))


def read_ansys(text, tmp_path):
    import mapdl_archive

    (tmp_path / "joint.cdb").write_text(text)
    archive = mapdl_archive.Archive(tmp_path / "joint.cdb", parse_vtk=False)
    assert archive.ekey.tolist() == [[7, 27]]
    assert sorted(map(tuple, archive.key_option[7])) == [(2, 0), (3, 4)]
    assert archive.nnum.tolist() == [FIRST, FIRST + 1]
    np.testing.assert_allclose(archive.nodes[:, :3], 1e3 * POSITIONS, rtol=1e-12)
    assert archive.elem[0].tolist()[10:] == [FIRST, FIRST + 1]
    matrix = np.zeros((12, 12))
    matrix[np.triu_indices(12)] = archive.rlblock[0]  # row by row: C1 to C12 are the first row
    return matrix + np.triu(matrix, 1).T


def read_abaqus(text, tmp_path):
    block = text.split("*MATRIX, TYPE=STIFFNESS\n")[1].split("*ELEMENT, TYPE=U901, ELSET=JOINT\n")
    assert block[1] == f"{FIRST}, {FIRST}, {FIRST + 1}\n*UEL PROPERTY, ELSET=JOINT\n"
    assert "*USER ELEMENT, TYPE=U901, NODES=2, LINEAR, COORDINATES=3\n1, 2, 3, 4, 5, 6\n" in text
    rows = [[float(cell) for cell in line.split(",")] for line in block[0].splitlines()]
    assert max(map(len, rows)) == 4
    matrix = np.zeros((12, 12))
    for j in range(12):  # each column of the upper triangle begins a new line
        column = []
        while len(column) < j + 1:
            column += rows.pop(0)
        matrix[: j + 1, j] = matrix[j, : j + 1] = column
    assert not rows
    return matrix


def read_aster(text, tmp_path):
    names = {"_F": dict}
    exec(text, names)
    discrete = names["JOINT_DISCRET"]
    assert (discrete["CARA"], discrete["REPERE"], discrete["GROUP_MA"]) == ("K_TR_L", "GLOBAL", "JOINT")
    values = iter(discrete["VALE"])
    matrix = np.zeros((12, 12))
    for j in range(12):  # upper triangle column by column
        for i in range(j + 1):
            matrix[i, j] = matrix[j, i] = next(values)
    assert next(values, None) is None
    return matrix


READERS = {
    "ansys": (ansys.format_joint_stiffness, read_ansys),
    "abaqus": (keywords.format_user_element, read_abaqus),
    "aster": (aster.format_joint_stiffness, read_aster),
}


@pytest.mark.parametrize("normal", list(AXIS_ORDER))
@pytest.mark.parametrize("form", list(READERS))
def test_node_moves_by_the_compliance(form, normal, tmp_path):
    write, read = READERS[form]
    stiffness = JointStiffness.from_tangent_stiffness(coupled(), POSITIONS)
    text = write(stiffness, TargetModel(MM, normal, FIRST, 7), ["about"])
    matrix = read(text, tmp_path)
    assert_moves(matrix, expected_motion(coupled(), POSITIONS, normal), DIGITS.get(form, 1e-8))


def read_bulk_data(text, tmp_path):
    setattr(np, "in1d", np.isin)  # noqa: B010 - pyNastran 1.4 needs the name, which numpy 2.4 no longer has
    from pyNastran.bdf.bdf import BDF

    (tmp_path / "joint.bdf").write_text(text)
    model = BDF(debug=False)
    model.read_bdf(str(tmp_path / "joint.bdf"), punch=True, xref=False)
    return model


@needs("pyNastran")
@pytest.mark.parametrize("normal", list(AXIS_ORDER))
def test_nastran_matrix_is_read_by_pynastran(normal, tmp_path):
    stiffness = JointStiffness.from_tangent_stiffness(coupled(), POSITIONS)
    text = nastran.format_joint_stiffness(stiffness, TargetModel(MM, normal, FIRST), ["about"])
    model = read_bulk_data(text, tmp_path)
    for label, r in zip((FIRST, FIRST + 1), 1e3 * POSITIONS, strict=True):
        np.testing.assert_allclose(model.nodes[label].xyz, r, rtol=1e-9)
    dmig = model.dmig["KJOINT"]
    assert (dmig.matrix_form, dmig.tin) == (6, 2)
    matrix = np.zeros((12, 12))
    ends = ((int(node), int(axis)) for pair in zip(dmig.GCi, dmig.GCj, strict=True) for node, axis in pair)
    places = [6 * (node - FIRST) + axis - 1 for node, axis in ends]
    for i, j, value in zip(places[::2], places[1::2], dmig.Real, strict=True):
        matrix[i, j] = matrix[j, i] = value
    assert_moves(matrix, expected_motion(coupled(), POSITIONS, normal))
    assert "K2GG = KJOINT" in text


@needs("pyNastran")
@pytest.mark.parametrize("positions", [np.zeros((2, 3)), np.array([[0, 0, -0.012], [0, 0, 0.02]])])
def test_nastran_spring_is_read_by_pynastran(positions, tmp_path):
    K = np.diag([8e9, 7e9, 2e10, 1.2e7, 1.1e7, 1e7])
    stiffness = JointStiffness.from_tangent_stiffness(K, positions)
    text = nastran.format_joint_stiffness(stiffness, TargetModel(MM, "z", FIRST), ["about"])
    model = read_bulk_data(text, tmp_path)
    assert not model.dmig
    bush, grids = model.elements[FIRST], [model.nodes[label].xyz for label in (FIRST, FIRST + 1)]
    assert (bush.node_ids, bush.cid, bush.ocid) == ([FIRST, FIRST + 1], 0, -1)
    at = grids[0] + bush.s * (grids[1] - grids[0])
    np.testing.assert_allclose(at, 0.0, atol=1e-9)
    assert model.properties[FIRST].Ki == pytest.approx([8e6, 7e6, 2e7, 1.2e10, 1.1e10, 1e10], rel=1e-9)


def test_nastran_spring_only_where_it_is_exact():
    diagonal = np.diag([8e9, 7e9, 2e10, 1.2e7, 1.1e7, 1e7])
    beside = np.array([[0.001, 0, -0.012], [0.001, 0, 0.02]])
    above = np.array([[0, 0, 0.012], [0, 0, 0.02]])
    for K, positions in ((coupled(), np.zeros((2, 3))), (diagonal, beside), (diagonal, above)):
        stiffness = JointStiffness.from_tangent_stiffness(K, positions)
        text = nastran.format_joint_stiffness(stiffness, TargetModel(SI), [])
        assert "CBUSH" not in text
        assert "DMIG*" in text
    assert max(map(len, text.splitlines())) <= 80


DECK = """*INCLUDE, INPUT=joint.inp
*NSET, NSET=ALL
{0}, {1}, {2}, {3}
*BOUNDARY
{0}, 1, 3
{2}, 1, 3
*STEP
*STATIC
*CLOAD
{1}, 1, {4[0]}
{1}, 2, {4[1]}
{1}, 3, {4[2]}
{3}, 1, {4[3]}
{3}, 2, {4[4]}
{3}, 3, {4[5]}
*NODE PRINT, NSET=ALL
U
*END STEP
"""


@needs("CalculiX")
@pytest.mark.parametrize("normal", list(AXIS_ORDER))
def test_calculix_moves_a_node_by_the_compliance(normal, tmp_path):
    stiffness = JointStiffness.from_tangent_stiffness(coupled(), POSITIONS)
    text = keywords.format_coupled_springs(stiffness, TargetModel(MM, normal, FIRST), ["about"])
    (tmp_path / "joint.inp").write_text(text)
    labels = range(FIRST, FIRST + 4)
    (tmp_path / "loaded.inp").write_text(DECK.format(*labels, LOAD))
    moved = calculix.run_deck(tmp_path / "loaded.inp")
    found = np.concatenate([moved[FIRST + 1], moved[FIRST + 3]])
    np.testing.assert_allclose(found, expected_motion(coupled(), POSITIONS, normal), rtol=2e-6)


BODY = """*NODE, NSET=BODY
601, -1., 4., 17.
602, 9., 4., 17.
603, -1., 14., 17.
604, -1., 4., 27.
*NODE, NSET=BASE
611, 3., -2., -11.
612, 13., -2., -11.
613, 3., 8., -11.
614, 3., -2., -1.
*RIGID BODY, NSET=BASE, REF NODE=501, ROT NODE=503
*RIGID BODY, NSET=BODY, REF NODE=502, ROT NODE=504
"""


@needs("CalculiX")
def test_calculix_turns_a_rigid_body(tmp_path):
    """The rotation nodes are those of rigid bodies: a force at a distance from the reference node rotates the
    body."""
    stiffness = JointStiffness.from_tangent_stiffness(coupled(), POSITIONS)
    text = keywords.format_coupled_springs(stiffness, TargetModel(MM, "z", FIRST), ["about"])
    (tmp_path / "joint.inp").write_text(text)
    load = "*INCLUDE, INPUT=joint.inp\n" + BODY
    load += DECK.format(*range(FIRST, FIRST + 4), LOAD).partition("\n")[2].split("*CLOAD")[0]
    load += "*CLOAD\n602, 3, 1500.\n*NODE PRINT, NSET=ALL\nU\n*END STEP\n"
    (tmp_path / "body.inp").write_text(load)
    moved = calculix.run_deck(tmp_path / "body.inp")
    force, at = np.array([0.0, 0.0, 1500.0]), np.array([9.0, 4.0, 17.0])
    wrench = np.concatenate([force, 1e-3 * np.cross(at, force)])
    q = np.linalg.solve(coupled(), wrench)
    np.testing.assert_allclose(moved[FIRST + 3], q[3:], rtol=2e-6)
    shift = 1e3 * q[:3] + np.cross(q[3:], 1e3 * POSITIONS[1])
    np.testing.assert_allclose(moved[FIRST + 1], shift, rtol=2e-6)


def test_comment_states_frame_point_and_state(tmp_path, capsys, enter):
    enter(chdir(tmp_path))
    words = "export nastran springs --preload 9e3 --units mm-N-MPa-t --normal x --first 70 --out j.bdf"
    assert cli.main([*words.split(), "--node-1", "-10", "0", "0", "--node-2", "12", "0", "0", "--json"]) == 0
    facts = json.loads(capsys.readouterr().out)
    spring = BoltedJointSpring.from_joint(load_default("bolted_joint").values)
    K = spring.tangent_stiffness(9e3)  # rigid sides: without modes
    np.testing.assert_allclose(
        [facts[f"K_{name}"] for name in ("xx", "yy", "zz", "rx", "ry", "rz")], np.diag(K), rtol=1e-9
    )
    head = "".join(line for line in (tmp_path / "j.bdf").read_text().splitlines(True) if line[0] == "$")
    assert "working point: preload 9000 N per bolt, moment 0 N.m" in head
    assert "are the model's y, z, x; origin: centroid of the contact" in head
    assert "node 70 moves with the attachment of side 1 as a rigid body; from the centroid: -10, 0, 0" in head
    assert "node 71 moves with the attachment of side 2 as a rigid body; from the centroid: 12, 0, 0" in head


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (
            "nastran springs --nodes n.csv --first 5",
            "--nodes has no effect for nastran; it is for ansys, cal",
        ),
        ("aster springs --interface", "--interface has no effect for aster; it is for ansys, calculix, aba"),
        ("abaqus contact --interface", "--interface has no effect for a contact; it is for springs"),
        (
            "abaqus springs --preload 9e3 --node-1 0 0 1",
            "--node-1 has no effect for springs of the interface",
        ),
        ("nastran springs --preload 9e3 --node-2 0 0", "argument --node-2: expected 3 arguments"),
        ("nastran springs --node-2 0 nan 0", "--node-2 = [0.0, nan, 0.0]: expected three finite numbers"),
        ("nastran springs --preload -5", "preload = -5 N per bolt with moment = 0 N.m is outside the law"),
        ("nastran springs --preload 9e3 --error 0.1", "--error has no effect for springs"),
        ("nastran contact", "nastran contact cannot be written; nastran has springs"),
        ("nastran springs --joint gear_contact", "springs of a gear_contact cannot be written"),
    ],
)
def test_refusals(words, says, tmp_path, capsys, enter):
    enter(chdir(tmp_path))
    assert says in refused_line(capsys, "export", *words.split(), "--out", "j.txt")
    assert not (tmp_path / "j.txt").exists()


@pytest.mark.slow
@needs("gmsh")
class TestElasticJoint:
    """Exports of a joint with elastic sides: complete joint by default, the interface if requested."""

    def test_stiffness_is_the_slope_of_the_compiled_joint(self, elastic_joint, tmp_path, capsys):
        file = load_parameter_file(elastic_joint / "joint.toml")
        words = ["export", "aster", "springs", "--params", str(elastic_joint / "joint.toml")]
        assert cli.main([*words, "--out", str(tmp_path / "j.comm"), "--json"]) == 0
        facts = json.loads(capsys.readouterr().out)
        assert facts["warnings"] == []
        matrix = read_aster((tmp_path / "j.comm").read_text(), tmp_path)[6:, 6:]  # both nodes at the centroid
        motions = ["s_rel_x", "s_rel_y", "s_rel_z", "theta_x", "theta_y", "theta_z"]
        forces = ["f_x", "f_y", "f_z", "m_x", "m_y", "m_z"]
        joint = open_joint(KINDS["bolted_joint"].models[0], file)
        step = np.array([1e-10] * 3 + [1e-8] * 3)
        moves = np.vstack([np.diag(step), -np.diag(step)])
        found = joint.evaluate_path(
            dict(zip(motions, moves.T, strict=True)), restart_at_each_point=True
        ).variable_columns
        F = np.column_stack([found[name] for name in forces])
        slope = -(F[:6] - F[6:]).T / (2.0 * step)
        size = np.sqrt(np.diag(matrix))
        # microslip: the secant of a step of 0.1 nm is a share of less than 1e-4 below the stick stiffness
        np.testing.assert_allclose(slope / np.outer(size, size), matrix / np.outer(size, size), atol=2e-4)

    @needs("CalculiX")
    def test_calculix_moves_by_the_compliance_of_the_joint(self, elastic_joint, tmp_path):
        positions = np.array([[0.0, 0.0, -0.01], [0.0, 0.0, 0.01]])  # on the outer faces of the plates
        words = ["export", "calculix", "springs", "--params", str(elastic_joint / "joint.toml")]
        words += ["--node-1", "0", "0", "-10", "--node-2", "0", "0", "10", "--units", "mm-N-MPa-t"]
        out = tmp_path / "joint.inp"
        assert cli.main([*words, "--first", str(FIRST), "--out", str(out)]) == 0
        (tmp_path / "loaded.inp").write_text(DECK.format(*range(FIRST, FIRST + 4), LOAD))
        moved = calculix.run_deck(tmp_path / "loaded.inp")
        file = load_parameter_file(elastic_joint / "joint.toml")
        H = BoltedJointSpring.from_joint(file.values).tangent_stiffness(15e3)
        compliance = np.linalg.inv(H)[:6, :6]  # of the motion, with the modes in equilibrium
        expected = expected_motion(np.linalg.inv(compliance), positions, "z")
        found = np.concatenate([moved[FIRST + 1], moved[FIRST + 3]])
        np.testing.assert_allclose(found, expected, rtol=5e-6)

    def test_interface_only_on_request(self, elastic_joint, tmp_path, capsys):
        words = ["export", "abaqus", "springs", "--params", str(elastic_joint / "joint.toml")]
        out = tmp_path / "j.inp"
        assert cli.main([*words, "--out", str(out)]) == 0
        assert "*USER ELEMENT" in out.read_text()
        assert re.search(r"^  K_rx +\S+ N\.m/rad$", capsys.readouterr().out, flags=re.MULTILINE)
        line = refused_line(capsys, *words, "--nodes", "n.csv", "--first", "9", "--out", str(out))
        assert "--nodes has no effect for the stiffness matrix of a complete joint; --interface exp" in line
        assert cli.main([*words, "--interface", "--preload", "15e3", "--out", str(out), "--json"]) == 0
        facts = json.loads(capsys.readouterr().out)
        assert "SPRING2" in out.read_text()
        assert facts["pairs"] > 100
        assert facts["warnings"] == []
