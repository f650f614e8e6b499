"""Meshes, matrices and assembly files of the finite elements."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from clients import needs
from jointfmu_tools.fem.assembly import read_assembly
from jointfmu_tools.fem.elasticity import ElasticBody
from jointfmu_tools.fem.geometry import Assembly, BoltGrid, BoltList, BoxSection, Plate
from jointfmu_tools.fem.mesh import extrude_body_mesh, find_contact_cells, make_contact_mesh, mesh_plan_view
from skfem import Basis, BilinearForm, ElementHexS2, ElementVector, LinearForm, MeshHex, condense, solve
from skfem.models.elasticity import lame_parameters, linear_elasticity

pytestmark = pytest.mark.slow

MATERIAL = {"E": 1.5e11, "nu": 0.28, "density": 7800.0}
BOX = BoxSection(
    length=0.24,
    width=0.34,
    height=0.2,
    wall=0.02,
    flange_width=0.06,
    flange_thickness=0.02,
    floor=0.03,
    wall_inset=0.04,
    **MATERIAL,
)
PLATE = Plate(length=0.3, width=0.4, thickness=0.03, **MATERIAL)
FRAME = BoltGrid(
    rows=3.0, columns=3.0, row_spacing=0.3, column_spacing=0.2, hole_diameter=0.0175, head_diameter=0.024
)
SHIPPED = Path(__file__).parents[2] / "models/assemblies/box_specimen.toml"


def volume(mesh: MeshHex) -> float:
    return float(Basis(mesh, ElementHexS2(), intorder=2).dx.sum())


# meshes


@pytest.fixture(scope="module")
def box_on_plate():
    assembly = Assembly("box on plate", PLATE, BOX, FRAME)
    return assembly, mesh_plan_view(assembly, 0.6)


@needs("gmsh")
def test_the_mesh_has_the_bodies_volumes(box_on_plate):
    assembly, plan = box_on_plate
    plate, box = (extrude_body_mesh(plan, assembly, side, 0.6) for side in (1, 2))
    hole = np.pi * 0.00875**2
    flange = 0.24 * 0.34 - 0.12 * 0.22 - 8.0 * hole
    walls, floor = 0.16 * 0.26 - 0.12 * 0.22, 0.16 * 0.26
    assert volume(plate) == pytest.approx((0.3 * 0.4 - 8.0 * hole) * 0.03, rel=1e-12)
    assert volume(box) == pytest.approx(flange * 0.02 + walls * 0.15 + floor * 0.03, rel=1e-12)
    assert assembly.contact_area == pytest.approx(flange, rel=1e-12)
    assert plate.p[2].max() == box.p[2].min() == 0.0


@needs("gmsh")
def test_the_contact_has_the_nodes_of_both_bodies(box_on_plate):
    assembly, plan = box_on_plate
    contact = make_contact_mesh(plan, find_contact_cells(plan, assembly))
    wanted = {tuple(p) for p in contact.p.T.tolist()}
    for side in (1, 2):
        mesh = extrude_body_mesh(plan, assembly, side, 0.6)
        assert wanted <= {tuple(p) for p in mesh.p[:2, mesh.p[2] == 0.0].T.tolist()}


@needs("gmsh")
def test_heads_are_annuli(box_on_plate):
    assembly, plan = box_on_plate
    body = ElasticBody(extrude_body_mesh(plan, assembly, 2, 0.6), 1.5e11, 0.28, 7800.0)
    for i, at in enumerate(assembly.bolts.bolt_positions):
        push = body.distribute_unit_force(body.mesh.boundaries[f"head{i + 1}"])[2::3]
        nodes = body.node_positions[:, push != 0.0]
        assert push.sum() == pytest.approx(1.0, rel=1e-12)
        assert body.node_positions @ push == pytest.approx(
            [*at, 0.02], abs=2e-5
        )  # the polygon is not quite symmetric
        radius = np.hypot(*(nodes[:2].T - at).T)
        assert radius.min() == pytest.approx(0.00875, rel=0.03)  # a polygon of the same area
        assert radius.max() == pytest.approx(0.012, rel=1e-6)


@needs("gmsh")
def test_refinement_divides_the_sizes():
    assembly = Assembly("boxes", BOX, BOX, FRAME)
    counts = [mesh_plan_view(assembly, refinement).cell_corners.shape[1] for refinement in (0.5, 1.0, 2.0)]
    assert counts[0] < counts[1] < counts[2] / 2


# matrices


def distorted(n: int, by: float) -> MeshHex:
    """Cube of n elements per side, inner nodes displaced in the plan."""
    lines = np.linspace(0.0, 1.0, n + 1)
    mesh = MeshHex.init_tensor(lines, lines, lines)
    x, y, z = mesh.p
    bulge = by / n * np.sin(np.pi * x) * np.sin(np.pi * y) * np.sign(np.sin(7.0 * x * n + 3.0 * y * n))
    return MeshHex(np.ascontiguousarray(np.stack([x + bulge, y - 0.5 * bulge, z])), mesh.t)


def test_the_stiffness_is_that_of_scikit_fem():
    mesh = distorted(2, 0.2)
    ours = ElasticBody(mesh, 1.5e11, 0.28, 7800.0)
    basis = Basis(mesh, ElementVector(ElementHexS2()), intorder=4)
    theirs = BilinearForm(linear_elasticity(*lame_parameters(1.5e11, 0.28))).assemble(basis)
    assert np.array_equal(np.repeat(ours.node_positions, 3, axis=1), basis.doflocs)  # the same numbering
    assert abs(ours.stiffness_matrix - theirs).max() < 1e-13 * abs(theirs).max()


def test_rigid_motions_cost_nothing_and_carry_the_mass():
    body = ElasticBody(distorted(3, 0.2), 1.5e11, 0.28, 7800.0)
    motions = body.rigid_body_motions()
    assert np.abs(body.stiffness_matrix @ motions).max() < 1e-12 * abs(body.stiffness_matrix).max()
    inertia = motions.T @ body.mass_matrix @ motions
    assert np.diag(inertia)[:3] == pytest.approx([7800.0] * 3, rel=1e-12)
    assert np.diag(inertia)[3:] == pytest.approx(
        [7800.0 * 2.0 / 3.0] * 3, rel=1e-12
    )  # about an edge of the cube


@pytest.mark.parametrize(("by", "order"), [(0.0, 2.9), (0.2, 1.9)])
def test_elasticity_converges_to_a_smooth_solution(by: float, order: float):
    """L2 error of u = (s, s, s), s = sin pi x sin pi y sin pi z: third order on bricks, second order on
    distorted elements, on which serendipity shape functions are less accurate."""
    lame, shear = lame_parameters(1.0, 0.3)
    errors = []
    for n in (2, 4, 8) if by == 0.0 else (4, 8):
        body = ElasticBody(distorted(n, by), 1.0, 0.3, 1.0)
        x = np.asarray(body.finite_element_basis.global_coordinates())
        s, c = np.sin(np.pi * x), np.cos(np.pi * x)
        exact = s[0] * s[1] * s[2]
        mixed = [c[0] * c[1] * s[2], c[0] * s[1] * c[2], s[0] * c[1] * c[2]]
        force = [
            np.pi**2 * (3.0 * shear * exact + (lame + shear) * (exact - sum(pair)))
            for pair in ((mixed[0], mixed[1]), (mixed[0], mixed[2]), (mixed[1], mixed[2]))
        ]
        load = np.zeros(body.unknown_count)
        for k in range(3):
            load[k::3] = LinearForm(lambda v, w, f=force[k]: f * v).assemble(body.finite_element_basis)
        edge = np.any(
            (np.abs(body.node_positions) < 1e-9) | (np.abs(body.node_positions - 1.0) < 1e-9), axis=0
        )
        held = (3 * np.flatnonzero(edge)[:, None] + np.arange(3)).ravel()
        u = solve(*condense(body.stiffness_matrix, load, D=held))
        miss = np.asarray(body.finite_element_basis.interpolate(u[::3])) - exact
        errors.append(float(np.sqrt(np.sum(body.finite_element_basis.dx * miss**2))))
    assert np.log2(errors[-2] / errors[-1]) > order


# assembly files


def test_the_shipped_assembly():
    assembly = read_assembly(SHIPPED)
    assert assembly.side1 == assembly.side2
    x, y = assembly.bolts.bolt_positions.T
    assert x.tolist() == pytest.approx([-0.1, 0.0, 0.1, -0.1, 0.1, -0.1, 0.0, 0.1])
    assert y.tolist() == pytest.approx([-0.15, -0.15, -0.15, 0.0, 0.0, 0.15, 0.15, 0.15])
    force = assembly.bolt_forces(15e3, 4500.0)
    assert force == pytest.approx(np.select([y > 0.0, y < 0.0], [20e3, 10e3], 15e3))  # Zhao 2018, section 3


def test_bolts_at_given_places(tmp_path):
    text = SHIPPED.read_text()
    head, _, tail = text.partition("[bolts]")
    keep = [line for line in tail.splitlines() if line.startswith(("hole", "head"))]
    lists = [f'{k} = {{ value = {v}, unit = "m", kind = "user", source = "test" }}' for k, v in
             (("x", [0.0, 0.1]), ("y", [0.15, 0.15]))]  # fmt: skip
    path = tmp_path / "a.toml"
    path.write_text("\n".join([head, "[bolts]", 'layout = "list"', *lists, *keep]))
    assert read_assembly(path).bolts.bolt_positions.tolist() == [[0.0, 0.15], [0.1, 0.15]]


def entry(name: str, value: str) -> str:
    return f"{name} = {{ value = {value}"


REFUSED = [
    ('body = "box"', 'body = "tube"', r"side1\.body = 'tube', allowed are plate, box"),
    ('layout = "grid"', 'layout = "ring"', r"bolts\.layout = 'ring', allowed are grid, list"),
    ('assembly = "bolted"', 'assembly = "welded"', "assembly = 'welded', allowed is 'bolted'"),
    ('assembly = "bolted"', 'joint = "gear_mesh"', "is the parameter file of a gear_mesh, not an assembly"),
    (entry("height", "0.2"), entry("height", "-0.2"), r"\[side1\] height = -0\.2 m is outside \(0, inf\)"),
    (entry("height", "0.2"), entry("height", "0.01"), r"flange_thickness = 0\.02 m is outside \(0, 0\.01\)"),
    (entry("wall", "0.02"), entry("wall", "0.03"), r"flange_width = 0\.06 m is outside \[0\.07, 0\.12\)"),
    ("height = ", "tallness = ", r"\[side1\] unknown name 'tallness'"),
    ('0.2, unit = "m"', '0.2, unit = "mm"', r"height: unit 'mm', expected 'm'"),
    (
        entry("head_diameter", "0.024"),
        entry("head_diameter", "0.05"),
        r"bolt 1 at \(-100, -150\) mm with a head of 50 mm reaches beyond the flange of side1",
    ),
    (entry("wall_inset", "0.04"), entry("wall_inset", "0.02"), r"bolt 1 at .* runs into a wall of side1"),
    (entry("column_spacing", "0.2"), entry("column_spacing", "0.04"), r"bolts 1 and 2 overlap"),
    (entry("hole_diameter", "0.0175"), entry("hole_diameter", "0.03"), r"0\.03 m is outside \(0, 0\.024\)"),
]


@pytest.mark.parametrize(("old", "new", "text"), REFUSED)
def test_refused_assemblies(tmp_path, old, new, text):
    path = tmp_path / "a.toml"
    source = SHIPPED.read_text()
    assert old in source
    path.write_text(source.replace(old, new, 1))
    with pytest.raises(ValueError, match=text) as caught:
        read_assembly(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_refused_loads():
    assembly = Assembly("boxes", BOX, BOX, FRAME)
    for preload in (0.0, -1.0, np.nan):
        with pytest.raises(ValueError, match=r"preload = .* N is outside \(0, inf\)"):
            assembly.bolt_forces(preload)
    for moment in (13.5e3, np.nan):
        with pytest.raises(
            ValueError, match=r"outside \(-13500, 13500\): a row of bolts would lose its force"
        ):
            assembly.bolt_forces(15e3, moment)
    one = Assembly("one", BOX, BOX, BoltList(x=(0.0,), y=(0.15,), hole_diameter=0.01, head_diameter=0.02))
    with pytest.raises(ValueError, match="two outer rows"):
        one.bolt_forces(1e3, 1.0)
    with pytest.raises(ValueError, match="y has 2 values, x has 1"):
        BoltList(x=(0.0,), y=(0.15, 0.0), hole_diameter=0.01, head_diameter=0.02)
    with pytest.raises(ValueError, match="row_spacing = 0 m"):
        replace(FRAME, row_spacing=0.0)
