"""Contact pressure of a bolted assembly under preload by finite elements, and its use in a bolted joint."""

from dataclasses import dataclass, replace

import numpy as np

from jointfmu.mechanics.footprint.distribution import PressureDistribution
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array

from ..inputs.fields.nodal_result import ContactPressureField
from .contact import ContactInterface, ContactModel, ContactSolution, PressureLaw
from .elasticity import ElasticBody
from .geometry import Assembly, BodyGeometry
from .mesh import PlanMesh, extrude_body_mesh, find_contact_cells, make_contact_mesh, mesh_plan_view


@dataclass(frozen=True)
class BoltedContact:
    """Finite-element model of a bolted assembly: meshed bodies and interface, ready for any preload.

    bodies          : side 1 and side 2, or side 2 alone if side 1 is its mirror image
    bolt_head_loads : nodal loads of each body (n, bolts) [N/N] of a unit force of each bolt along +z
    """

    assembly: Assembly
    plan_mesh: PlanMesh
    bodies: tuple[ElasticBody, ...]
    contact_interface: ContactInterface
    bolt_head_loads: tuple[Array, ...]

    @classmethod
    def from_assembly(cls, assembly: Assembly, refinement: float = 1.0) -> "BoltedContact":
        """Mesh an assembly and compute the nodal loads of unit bolt forces.

        refinement : [1] divides the sizes of all elements

        If both bodies are equal, only side 2 is meshed: side 1 is its mirror image.
        """
        plan = mesh_plan_view(assembly, refinement)
        sides = (2,) if assembly.side1 == assembly.side2 else (1, 2)
        bodies, heads = [], []
        for side in sides:
            body = make_elastic_body(plan, assembly, side, refinement)
            bodies.append(body)
            heads.append(compute_bolt_head_loads(body, assembly))
        interface = ContactInterface.from_mesh(make_contact_mesh(plan, find_contact_cells(plan, assembly)))
        return cls(assembly, plan, tuple(bodies), interface, tuple(heads))

    def solve_equilibrium(
        self, pressure_law: PressureLaw, preload: float, moment: float = 0.0
    ) -> "JointSolution":
        """Equilibrium under a preload [N] per bolt and a moment [N.m] about x."""
        return self._solve_contact_model(
            ContactModel(self.bodies, self.contact_interface, pressure_law), preload, moment
        )

    def _solve_contact_model(
        self,
        contact_model: ContactModel,
        preload: float,
        moment: float,
        initial_solution: ContactSolution | None = None,
    ) -> "JointSolution":
        """Solve a contact model for the equilibrium under a preload [N] per bolt and a moment [N.m] about x.

        initial_solution : equilibrium from which Newton's method starts; None: start at uniform pressure
        """
        force = self.assembly.bolt_forces(preload, moment)
        signs = (-1.0,) if len(self.bodies) == 1 else (1.0, -1.0)
        loads = [sign * head @ force for sign, head in zip(signs, self.bolt_head_loads, strict=True)]
        mean = float(force.sum() / self.contact_interface.quadrature_area.sum())
        return JointSolution(self, force, contact_model.solve_equilibrium(loads, mean, initial_solution))


def make_elastic_body(
    plan_mesh: PlanMesh,
    assembly: Assembly,
    side_number: int,
    refinement: float = 1.0,
    first_element_height: float | None = None,
) -> ElasticBody:
    """Elastic body on side 1 or 2 of an assembly, extruded along z from the mesh of the plan view."""
    body: BodyGeometry = assembly.side1 if side_number == 1 else assembly.side2
    mesh = extrude_body_mesh(plan_mesh, assembly, side_number, refinement, first_element_height)
    return ElasticBody(mesh, body.E, body.nu, body.density)


def compute_bolt_head_loads(body: ElasticBody, assembly: Assembly) -> Array:
    """Nodal load (n, bolts) [N/N] on a body for a unit force of each bolt along +z."""
    boundaries, count = body.mesh.boundaries, len(assembly.bolts.bolt_positions)
    return np.stack([body.distribute_unit_force(boundaries[f"head{i + 1}"]) for i in range(count)], axis=1)


@dataclass(frozen=True)
class JointSolution:
    """Equilibrium of a bolted joint under bolt forces.

    bolt_force       : (bolts) [N]
    contact_solution : pressure and displacement
    """

    bolted_contact: BoltedContact
    bolt_force: Array
    contact_solution: ContactSolution

    def solve_load_case(self, preload: float, moment: float = 0.0) -> "JointSolution":
        """Equilibrium under another preload [N] per bolt and moment [N.m] about x.

        Newton's method starts from the present solution.
        """
        return self.bolted_contact._solve_contact_model(
            self.contact_solution.contact_model, preload, moment, self.contact_solution
        )

    @property
    def contact_field(self) -> ContactPressureField:
        """Contact pressure [Pa], area [m2] and position [m] at the quadrature points of the contact."""
        interface = self.bolted_contact.contact_interface
        return ContactPressureField(
            nodal_area=interface.quadrature_area,
            node_positions=interface.quadrature_position,
            nodal_pressure=self.contact_solution.pressure,
        )

    @property
    def peak_pressure(self) -> float:
        """Largest nodal pressure [Pa], usually on the edge of a hole."""
        return float(self.contact_solution.nodal_pressure.max())

    @property
    def pressure_between_bolts(self) -> tuple[Array, Array]:
        """Positions (k, 2) [m] midway between neighbouring bolts, and contact pressure (k) [Pa] there."""
        positions = bolt_midpoints(self.bolted_contact.assembly.bolts.bolt_positions)
        sides = (self.bolted_contact.assembly.side1, self.bolted_contact.assembly.side2)
        solid = [side.list_rectangular_layers()[0].is_in_material(*positions.T) for side in sides]
        positions = positions[solid[0] & solid[1]]
        return positions, self.contact_solution.pressure_at(positions) if len(positions) else np.zeros(0)

    @property
    def interface_stiffness(self) -> dict[str, float]:
        """Normal stiffness K_N [N/m] of the interface, bending stiffness K_rx, K_ry [N.m/rad] about x and y
        through its centroid."""
        field = self.contact_field
        k = field.nodal_area * self.contact_solution.contact_stiffness
        x, y = (field.node_positions - field.contact_centroid).T
        return {"K_N": float(k.sum()), "K_rx": float(k @ y**2), "K_ry": float(k @ x**2)}


def bolt_midpoints(bolt_positions: Array) -> Array:
    """Points (k, 2) [m] midway between neighbouring bolts, from the bolt positions (n, 2) [m].

    Two bolts are neighbours if no third bolt lies in the circle whose diameter is the line between them.
    """
    midpoints = []
    for i in range(len(bolt_positions)):
        for j in range(i):
            midpoint = 0.5 * (bolt_positions[i] + bolt_positions[j])
            distance = np.hypot(*(bolt_positions - midpoint).T)
            if (
                np.sum(distance < 0.5 * np.hypot(*(bolt_positions[i] - bolt_positions[j])) * (1.0 + 1e-9))
                == 2
            ):
                midpoints.append(midpoint)
    return np.array(midpoints).reshape(-1, 2)


SECOND_FIELD_OVER_UNLOADING_MOMENT = 1.0 / 3.0
"""Moment of the second pressure field over the moment that unloads a row of bolts [1], as in Zhao 2018."""


def insert_contact_pressure(
    parameter_file: ParameterFile, joint_solution: JointSolution, preload: float, moment: float = 0.0
) -> tuple[ParameterFile, PressureDistribution]:
    """Insert the computed pressure field into the parameters of a joint.

    A second field, solved under another moment, gives the change of pressure with a moment about x.

    Returns the parameters, and the normalised pressure distribution at all nodes.

    joint_solution : equilibrium at this preload [N] per bolt and moment [N.m], from which Newton's method
                     starts for the other field
    """
    from ..inputs.fields.joint_parameters import (
        insert_pressure_field,  # slow to import, and a linear joint has no field
    )

    joint = joint_solution.bolted_contact
    tilting = moment or SECOND_FIELD_OVER_UNLOADING_MOMENT * joint.assembly.max_moment(preload)
    equal = joint_solution.solve_load_case(preload).contact_field if moment else joint_solution.contact_field
    tilted = (
        joint_solution.contact_field
        if moment
        else joint_solution.solve_load_case(preload, tilting).contact_field
        if tilting
        else None
    )
    source = f"finite elements of the assembly {joint.assembly.name}"
    bolts = joint.assembly.bolts.bolt_positions
    second = tilting or None
    parameter_file, reduction = insert_pressure_field(
        parameter_file,
        equal,
        preload,
        source,
        moment_field=tilted,
        bending_moment=second,
        bolt_positions=bolts,
    )
    return replace(parameter_file, name=f"{parameter_file.name}, computed field"), reduction.full_distribution
