"""Contact of two elastic bodies against closed forms, and equilibrium of bolted joints."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from clients import needs
from jointfmu_tools.fem import require_fem_packages
from jointfmu_tools.fem.bolted_contact import BoltedContact, bolt_midpoints, make_elastic_body
from jointfmu_tools.fem.contact import ContactInterface, ContactModel, ContactSolution
from jointfmu_tools.fem.elasticity import ElasticBody
from jointfmu_tools.fem.geometry import Assembly, BoltList, Plate, TappedPlate
from skfem import MeshHex, MeshQuad
from threadpoolctl import threadpool_info, threadpool_limits

from jointfmu.mechanics.curve import tabulate_approach
from jointfmu.parameters import load_default

pytestmark = pytest.mark.slow

ROUND_OFF = 1e-9  # of a solution by factorisation: condition number (1e6 here) times 1e-16, and to spare
STEEL = {"E": 2.1e11, "nu": 0.3, "density": 7850.0}
PLATE = Plate(length=0.12, width=0.06, thickness=0.012, **STEEL)
BOLTS = BoltList(x=(0.0, 0.0), y=(-0.015, 0.015), hole_diameter=0.0066, head_diameter=0.011)


class Linear:
    """Linear contact law p = k delta."""

    def __init__(self, k: float) -> None:
        self.k = k

    def derivatives(self, x, order=1):
        return [self.k * np.maximum(x, 0.0), np.where(x > 0.0, self.k, 0.0)]

    def inverse(self, load):
        return load / self.k


@pytest.fixture(scope="module")
def law():
    return tabulate_approach(replace(load_default("bolted_joint").values, A_0=PLATE.length * PLATE.width))


# two blocks pressed uniformly: p is the load over the area, each block shortens by p h / E


def imbalance(solution):
    """Unbalanced forces (n) [N] on each body: reactions of the supports, and round-off."""
    model = solution.contact_model
    nodal = (
        model.contact_interface.interpolation_matrix.T
        @ (model.contact_interface.quadrature_area * solution.pressure)
        * (0.5 if model.is_mirrored else 1.0)
    )
    parts = zip(
        model.bodies,
        solution.nodal_loads,
        model.approach_matrices(),
        solution.nodal_displacements,
        strict=True,
    )
    return [load - body.stiffness_matrix @ u - trace.T @ nodal for body, load, trace, u in parts]


def test_two_blocks_pressed_uniformly(law):
    lines, depths, moduli, p = np.linspace(0.0, 0.05, 4), (0.03, 0.05), (1.1e11, 2.1e11), 2e6
    bodies = []
    for sign, depth, modulus in zip((-1, 1), depths, moduli, strict=True):
        z = np.linspace(0.0, depth, 4)
        mesh = MeshHex.init_tensor(lines, lines, np.sort(sign * z))
        far = {"far": lambda x, end=sign * depth: np.isclose(x[2], end)}
        bodies.append(ElasticBody(mesh.with_boundaries(far), modulus, 0.3, 7800.0))
    interface = ContactInterface.from_mesh(MeshQuad.init_tensor(lines, lines))
    area = 0.05**2
    loads = [
        -sign * p * area * body.distribute_unit_force(body.mesh.boundaries["far"])
        for sign, body in zip((-1, 1), bodies, strict=True)
    ]
    solution = ContactModel(tuple(bodies), interface, law).solve_equilibrium(loads, 0.3 * p)
    assert solution.pressure == pytest.approx(np.full(interface.quadrature_area.size, p), rel=ROUND_OFF)
    assert solution.nodal_approach == pytest.approx(
        np.full(interface.node_positions.shape[1], law.inverse(p)), rel=ROUND_OFF
    )
    ends = [
        u[2::3][np.isclose(body.node_positions[2], sign * depth)].mean()
        for sign, depth, body, u in zip((-1, 1), depths, bodies, solution.nodal_displacements, strict=True)
    ]
    shortening = p * depths[0] / moduli[0] + p * depths[1] / moduli[1]
    assert ends[0] - ends[1] == pytest.approx(
        float(law.inverse(p)) - solution.approach_offset + shortening, rel=1e-7
    )
    for out, load in zip(imbalance(solution), loads, strict=True):
        assert np.abs(out).max() < ROUND_OFF * np.abs(load).sum()  # the supports carry nothing


# two wavy half-spaces, one wave long: closed forms for full contact on springs and for Westergaard's


def wavy(n: int, mean: float, k: float, amplitude: float) -> ContactSolution:
    """Contact of half a sinusoidal wave in n plane-strain elements, symmetric at both ends, 1.5 waves deep.

    At that depth exp(-2 kappa h) = 7e-9 of the wave is left.
    """
    x, y, depth = np.linspace(0.0, 0.5, n + 1), np.array([0.0, 0.5 / n]), 1.5
    steps = np.cumsum(0.5 / n * 1.15 ** np.arange(200))
    z = np.concatenate([[0.0], steps[: np.searchsorted(steps, depth) + 1]])
    z *= depth / z[-1]
    mesh = MeshHex.init_tensor(x, y, z).with_boundaries({"far": lambda p: np.isclose(p[2], depth)})
    body = ElasticBody(mesh, 1.0, 0.3, 1.0)
    ends = np.isclose(body.node_positions[0], 0.0) | np.isclose(body.node_positions[0], 0.5)
    held = np.concatenate([3 * np.flatnonzero(ends), 3 * np.arange(ends.size) + 1])
    interface = ContactInterface.from_mesh(MeshQuad.init_tensor(x, y))
    model = ContactModel(
        (body,), interface, Linear(k), lambda x, y: amplitude * (1.0 - np.cos(2.0 * np.pi * x)), (held,)
    )
    return model.solve_equilibrium(
        [-mean * interface.quadrature_area.sum() * body.distribute_unit_force(mesh.boundaries["far"])], mean
    )


MODULUS = 0.5 / (1.0 - 0.3**2)  # 1/E* is the sum of (1 - nu^2)/E of both bodies


def observed(errors: list[float]) -> list[float]:
    return [float(np.log2(a / b)) for a, b in pairwise(errors)]


def test_full_contact_on_springs_converges_with_order_three():
    k, amplitude = 2.0, 1e-3
    wave = k * amplitude / (1.0 + 2.0 * k / (MODULUS * 2.0 * np.pi))
    errors = []
    for n in (4, 8, 16):
        solution = wavy(n, 2.0 * wave, k, amplitude)
        x = solution.contact_model.contact_interface.quadrature_position[:, 0]
        weight = solution.contact_model.contact_interface.quadrature_area
        exact = 2.0 * wave + wave * np.cos(2.0 * np.pi * x)
        errors.append(float(np.sqrt(weight @ (solution.pressure - exact) ** 2 / (weight @ exact**2))))
    assert errors[-1] < 3e-5  # 1.4e-5 measured
    assert min(observed(errors)) > 2.9  # quadratic elements: 3


def test_partial_contact_converges_to_westergaard():
    amplitude, half = 1e-3, 0.25
    sine = np.sin(np.pi * half)
    mean = np.pi * MODULUS * amplitude * sine**2
    errors, peaks = [], []
    for n in (8, 16, 32):
        solution = wavy(n, mean, 20.0 * n * np.pi * MODULUS, amplitude)
        x = solution.contact_model.contact_interface.quadrature_position[:, 0]
        weight = solution.contact_model.contact_interface.quadrature_area
        root = np.sqrt(np.maximum(sine**2 - np.sin(np.pi * x) ** 2, 0.0))
        exact = 2.0 * mean * np.cos(np.pi * x) / sine**2 * root
        errors.append(float(weight @ np.abs(solution.pressure - exact) / (weight @ exact)))
        peaks.append(abs(solution.nodal_pressure.max() * sine / (2.0 * mean) - 1.0))
        assert solution.pressure.min() == 0.0
    assert min(observed(errors)) > 1.4  # the pressure falls like a root at the edge: 1.5
    assert peaks[-1] < 2e-3  # 1.0e-3 measured, with the stiffness of the springs growing like n


# bolted plates


@pytest.fixture(scope="module")
def plates():
    return BoltedContact.from_assembly(Assembly("plates", PLATE, PLATE, BOLTS), 0.5)


@needs("gmsh")
def test_contact_carries_the_bolts(plates, law):
    solution = plates.solve_equilibrium(law, 4e3)
    field = solution.contact_field
    assert field.normal_force == pytest.approx(8e3, rel=ROUND_OFF)
    assert (
        np.abs((field.nodal_area * field.nodal_pressure) @ field.node_positions).max()
        < ROUND_OFF * 8e3 * 0.06
    )
    assert np.all(field.nodal_area > 0.0)
    assert solution.peak_pressure >= field.nodal_pressure.max()
    for out in imbalance(solution.contact_solution):
        assert np.abs(out).max() < ROUND_OFF * 8e3


@needs("gmsh")
def test_pressures_balance_the_moment(plates, law):
    field = plates.solve_equilibrium(law, 4e3, 30.0).contact_field
    assert (field.nodal_area * field.nodal_pressure) @ field.node_positions[:, 1] == pytest.approx(
        30.0, rel=ROUND_OFF
    )
    assert field.normal_force == pytest.approx(8e3, rel=ROUND_OFF)


@needs("gmsh")
def test_another_load_is_found_from_the_first(plates, law):
    """The result is the same as from scratch, in fewer steps."""
    expected = plates.solve_equilibrium(law, 4e3, 30.0)
    first = plates.solve_equilibrium(law, 4e3)
    found = first.solve_load_case(4e3, 30.0)
    # both end at TOLERANCE of the load, 1e-11, which may lie on a part of the nodes
    np.testing.assert_allclose(found.contact_solution.pressure, expected.contact_solution.pressure, rtol=1e-7)
    np.testing.assert_array_equal(found.bolt_force, expected.bolt_force)
    assert found.contact_solution.newton_steps < expected.contact_solution.newton_steps


@needs("gmsh")
def test_a_mirror_image_equals_two_bodies(plates, law):
    assembly = plates.assembly
    sides = [make_elastic_body(plates.plan_mesh, assembly, side, 0.5) for side in (1, 2)]
    heads = [
        np.stack([body.distribute_unit_force(body.mesh.boundaries[f"head{i}"]) for i in (1, 2)], axis=1)
        for body in sides
    ]
    whole = replace(plates, bodies=tuple(sides), bolt_head_loads=tuple(heads))
    one, two = (joint.solve_equilibrium(law, 4e3, 30.0).contact_solution for joint in (plates, whole))
    assert two.pressure == pytest.approx(one.pressure, rel=1e-7)  # round-off over the approach's spread
    assert two.nodal_pressure == pytest.approx(one.nodal_pressure, rel=1e-7)


@needs("gmsh")
def test_bodies_of_different_kind(law):
    thick = replace(PLATE, thickness=0.02, length=0.16, E=7e10)
    joint = BoltedContact.from_assembly(Assembly("plates", PLATE, thick, BOLTS), 0.5)
    solution = joint.solve_equilibrium(law, 4e3, -30.0)
    area = PLATE.length * PLATE.width
    assert joint.assembly.contact_area == pytest.approx(area - 2.0 * np.pi * 0.0033**2, rel=1e-12)
    assert solution.contact_field.nodal_area.sum() == pytest.approx(joint.assembly.contact_area, rel=1e-12)
    assert solution.contact_field.normal_force == pytest.approx(8e3, rel=ROUND_OFF)
    moment = (
        solution.contact_field.nodal_area * solution.contact_field.nodal_pressure
    ) @ solution.contact_field.node_positions[:, 1]
    assert moment == pytest.approx(-30.0, rel=1e-8)


# what has no equilibrium


def pulled(plates, law, *forces, held=None):
    """Solution with both bolt heads loaded by forces [N] along +z, away from the contact."""
    model = ContactModel(plates.bodies, plates.contact_interface, law, fixed_unknowns=held)
    return model, [plates.bolt_head_loads[0] @ np.array(forces)]


@needs("gmsh")
def test_without_a_load_to_close_it_the_contact_is_refused(plates, law):
    model, loads = pulled(plates, law, 1.0, 1.0)
    with pytest.raises(RuntimeError, match=r"a fraction of 0\.\d+ is left over, allowed is 1e-06;"):
        model.solve_equilibrium(loads, 1e5)


@needs("gmsh")
def test_contact_forces_are_checked_by_their_sums(plates, law):
    model, loads = pulled(plates, law, -4e3, -4e3)
    solution, balance = model.solve_equilibrium(loads, 1e6), model.rigid_body_balance(loads)
    force = (
        0.5 * model.contact_interface.quadrature_area * solution.pressure
    )  # the mirror image takes the other half
    balance.check_contact_forces(force * (1.0 + 1e-8))
    with pytest.raises(RuntimeError, match=r"leaves \S+ times the loads unbalanced, allowed is 1e-06;"):
        balance.check_contact_forces(force * (1.0 + 1e-5))
    with pytest.raises(RuntimeError, match="stays closed at 1 of 2412 points"):
        balance.check_contact_forces(np.where(np.arange(force.size) == 7, force, 0.0))
    with pytest.raises(RuntimeError, match="not in equilibrium: it leaves nan"):
        balance.check_contact_forces(np.where(np.arange(force.size) == 7, np.nan, force))


@needs("gmsh")
def test_the_resultant_must_meet_the_contact(plates, law):
    """Forces whose resultant lies outside the contact are refused.

    The bolts are at y = +-15 mm, the faces end at 30 mm: the resultant of f1 and f2 lies at
    15 mm (f1 - f2)/(f1 + f2).
    """
    model, inside = pulled(plates, law, 0.3e3, -1e3)  # at 27.9 mm
    pressure = model.solve_equilibrium(inside, 1e6).pressure
    assert 0.0 < np.mean(pressure > 0.0) < 0.5
    for outside in (0.34e3, 0.5e3, 1e3):  # at 30.5 mm, at 45 mm, nowhere
        model, loads = pulled(plates, law, outside, -1e3)
        with pytest.raises(RuntimeError, match="cannot balance the loads"):
            model.solve_equilibrium(loads, 1e6)


@needs("gmsh")
def test_a_side_load_is_refused(plates, law):
    """Without friction only the supports could carry a lateral load, which must not remain unnoticed."""
    model, loads = pulled(plates, law, -4e3, -4e3)
    loads[0][::3] += 10.0 * plates.bolt_head_loads[0][2::3, 0]
    with pytest.raises(RuntimeError, match="cannot balance the loads"):
        model.solve_equilibrium(loads, 1e6)


@needs("gmsh")
def test_bodies_without_supports_are_refused(plates, law):
    model, loads = pulled(plates, law, -4e3, -4e3, held=(np.zeros(0, dtype=np.int64),))
    with pytest.raises(RuntimeError, match="a body can move rigidly"):
        model.solve_equilibrium(loads, 1e6)


@needs("gmsh")
def test_loads_within_a_body_close_no_contact(plates, law):
    model, loads = pulled(plates, law, 0.0, 0.0)
    with pytest.raises(RuntimeError, match="all loads are 0 N"):
        model.solve_equilibrium(loads, 1e6)
    x, y, z = plates.bodies[0].node_positions
    ends = [int(np.argmin(side * x + 1e-3 * (y + z))) for side in (1.0, -1.0)]  # of one edge, drawn out
    loads[0][[3 * end for end in ends]] = -5.0, 5.0
    with pytest.raises(RuntimeError, match=r"its force is \S+ of the loads, needed is more than 1e-06$"):
        model.solve_equilibrium(loads, 1e6)


def test_neighbours_of_bolts():
    frame = np.array([[x, y] for x in (-0.1, 0.0, 0.1) for y in (-0.15, 0.0, 0.15) if (x, y) != (0.0, 0.0)])
    middles = {
        tuple(np.round(m, 9)) for m in bolt_midpoints(frame) if max(abs(m[0]) / 0.1, abs(m[1]) / 0.15) > 0.9
    }
    assert len(middles) == 8
    assert (0.05, 0.15) in middles
    assert (0.1, -0.075) in middles


# Threads in side 2: its body is held by their walls


@needs("gmsh")
def test_a_stiff_side_does_not_tell_how_a_bolt_holds_it(law):
    """Head and nut, or head and thread, give the same pressure on a stiff body, also off the centre."""
    stiff = STEEL | {"E": 1e5 * STEEL["E"]}
    sizes = {"length": 0.08, "width": 0.06, "thickness": 0.012}
    bolts = BoltList(x=(-0.011, 0.015), y=(-0.004, 0.007), hole_diameter=0.009, head_diameter=0.016)
    fields = [
        BoltedContact.from_assembly(Assembly("stiff", Plate(**sizes, **STEEL), side, bolts), 0.5)
        .solve_equilibrium(law, 15e3)
        .contact_field
        for side in (Plate(**sizes, **stiff), TappedPlate(**sizes, **stiff, depth=0.008))
    ]
    nut, thread = fields
    assert thread.normal_force == pytest.approx(30e3, rel=1e-6)
    np.testing.assert_allclose(
        thread.nodal_pressure, nut.nodal_pressure, atol=1e-3 * nut.nodal_pressure.max()
    )


@needs("gmsh")
def test_a_thread_pulls_beside_its_hole(law):
    """Two halves whose bolts pull at the hole wall have the pressure nearer to the hole than halves with
    heads, mirror images included. The wall carries the whole bolt force along the axis of the bolt."""
    sizes = {"length": 0.06, "width": 0.06, "thickness": 0.015}
    bolt = BoltList(x=(0.004,), y=(0.0,), hole_diameter=0.009, head_diameter=0.016)
    reach = []
    for tapped in (False, True):
        side = TappedPlate(**sizes, **STEEL, depth=0.008) if tapped else Plate(**sizes, **STEEL)
        joint = BoltedContact.from_assembly(Assembly("thread", Plate(**sizes, **STEEL), side, bolt), 0.5)
        field, head = (
            joint.solve_equilibrium(law, 15e3).contact_field,
            joint.bolt_head_loads[-1][:, 0].reshape(-1, 3),
        )
        assert head.sum(axis=0) == pytest.approx([0.0, 0.0, 1.0], abs=1e-12)
        at = joint.bodies[-1].node_positions[:, np.abs(head[:, 2]) > 1e-9]
        if tapped:
            np.testing.assert_allclose(np.hypot(at[0] - 0.004, at[1]), 0.0045, rtol=0.05)
            assert (at[2].min(), at[2].max()) == pytest.approx((0.0, 0.008), abs=1e-12)
        force = field.nodal_area * field.nodal_pressure
        assert force @ field.node_positions / force.sum() == pytest.approx([0.004, 0.0], abs=1e-5)
        reach.append(np.sqrt(force @ ((field.node_positions - [0.004, 0.0]) ** 2).sum(axis=1) / force.sum()))
    assert 0.7 < reach[1] / reach[0] < 1.0


def test_solutions_have_one_thread():
    def threads():
        return max(pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas")

    with threadpool_limits(2, "blas"):
        with require_fem_packages("a solution"):
            assert threads() == 1
        assert threads() == 2
