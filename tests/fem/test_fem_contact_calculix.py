"""Two plates that open at their ends, by CalculiX with its own elements and contact."""

import subprocess
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from clients import needs
from jointfmu_tools.fem.bolted_contact import BoltedContact
from jointfmu_tools.fem.contact import ContactModel
from jointfmu_tools.fem.geometry import Assembly
from oracles.calculix import body_lines, displacements
from scipy.spatial import cKDTree
from test_fem_contact import BOLTS, PLATE, Linear

pytestmark = pytest.mark.slow

STIFFNESS = 3e11  # Pa/m


def deck(model: ContactModel, loads: list[np.ndarray], overclosure: float) -> Iterator[str]:
    firsts = (0, model.bodies[0].finite_element_basis.N)
    for k, body in enumerate(model.bodies):
        yield from body_lines(body, k + 1, firsts[k], k * model.bodies[0].mesh.nelements, k * overclosure)
    yield "*SURFACE INTERACTION, NAME=LAW\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR"
    yield f"{STIFFNESS * 1e-9:g}"
    yield "*CONTACT PAIR, INTERACTION=LAW, TYPE=SURFACE TO SURFACE\nFACE2, FACE1\n*BOUNDARY"
    for first, held in zip(firsts, model.supported_unknowns(), strict=True):
        yield from (f"{first + i // 3 + 1}, {i % 3 + 1}, {i % 3 + 1}" for i in held)
    yield "*STEP, INC=100\n*STATIC\n1., 1.\n*CLOAD"
    for first, load in zip(firsts, loads, strict=True):
        strong = np.flatnonzero(np.abs(load[2::3]) > 1e-9)
        yield from (f"{first + i + 1}, 3, {load[3 * i + 2]:.12g}" for i in strong)
    yield "*NODE PRINT, NSET=N1\nU\n*NODE PRINT, NSET=N2\nU\n*END STEP"


@needs("CalculiX", "gmsh")
def test_calculix_finds_the_same_contact(tmp_path):
    other = replace(PLATE, thickness=0.02, E=7e10)
    joint = BoltedContact.from_assembly(Assembly("plates", PLATE, other, BOLTS), 0.5)
    law, model = Linear(STIFFNESS), ContactModel(joint.bodies, joint.contact_interface, Linear(STIFFNESS))
    force = np.array([4.8e3, 3.2e3])
    loads = [sign * head @ force for sign, head in zip((1.0, -1.0), joint.bolt_head_loads, strict=True)]
    mean = force.sum() / joint.contact_interface.quadrature_area.sum()
    ours = model.solve_equilibrium(loads, mean)
    (tmp_path / "plates.inp").write_text("\n".join(deck(model, loads, mean / STIFFNESS)) + "\n")
    run = subprocess.run(["ccx", "plates"], cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert run.returncode == 0, run.stdout[-500:]
    moved = displacements(tmp_path / "plates.dat")
    first = joint.bodies[0].finite_element_basis.N
    flat = np.column_stack(
        [*joint.contact_interface.node_positions, np.zeros(joint.contact_interface.node_positions.shape[1])]
    )
    lower, upper = (cKDTree(body.node_positions.T).query(flat)[1] for body in joint.bodies)
    approach = ours.approach_offset + moved[lower, 2] - moved[first + upper, 2]
    pressure, peak = law.derivatives(approach)[0], ours.nodal_pressure.max()
    assert ours.pressure.min() == 0.0  # it opens
    assert pressure.max() == pytest.approx(peak, rel=1e-3)  # 4e-5 measured
    assert (
        np.abs(pressure - ours.nodal_pressure).max() < 2e-3 * peak
    )  # 7.6e-4: both integrate over cut elements
