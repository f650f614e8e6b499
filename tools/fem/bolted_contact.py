"""The bolted joint as a contact problem: from an assembly and a preload to the field, and a joint with it."""

from dataclasses import dataclass, replace

import numpy as np

from jointfmu.mechanics.footprint.shape import PressureShape
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array

from ..fields.joint_parameters import with_field
from ..fields.nodal_result import ContactField
from .contact import ContactModel, ContactSolution, Interface, PressureLaw
from .elasticity import ElasticBody
from .geometry import Assembly, Body
from .mesh import Plan, body_mesh, contact_cells, contact_mesh, plan_of


@dataclass(frozen=True)
class BoltedContact:
    """An assembly, meshed; loads differ from solve to solve.

    heads : for each body, load (n, bolts) [N per N] of each bolt along +z
    """

    assembly: Assembly
    plan: Plan
    bodies: tuple[ElasticBody, ...]
    interface: Interface
    heads: tuple[Array, ...]

    @classmethod
    def of(cls, assembly: Assembly, refinement: float = 1.0) -> "BoltedContact":
        """Mesh an assembly; refinement [1] divides the sizes of all elements.

        Of two equal bodies only side 2 is meshed: side 1 is its mirror image.
        """
        plan = plan_of(assembly, refinement)
        sides = (2,) if assembly.side1 == assembly.side2 else (1, 2)
        bodies, heads = [], []
        for side in sides:
            body = elastic_body(plan, assembly, side, refinement)
            bodies.append(body)
            heads.append(head_loads(body, assembly))
        interface = Interface.of(contact_mesh(plan, contact_cells(plan, assembly)))
        return cls(assembly, plan, tuple(bodies), interface, tuple(heads))

    def solve(self, law: PressureLaw, preload: float, moment: float = 0.0) -> "JointSolution":
        """Equilibrium under a preload [N] per bolt and a moment [N.m] about x."""
        return self._solve(ContactModel(self.bodies, self.interface, law), preload, moment)

    def _solve(
        self, model: ContactModel, preload: float, moment: float, near: ContactSolution | None = None
    ) -> "JointSolution":
        force = self.assembly.bolt_forces(preload, moment)
        signs = (-1.0,) if len(self.bodies) == 1 else (1.0, -1.0)
        loads = [sign * head @ force for sign, head in zip(signs, self.heads, strict=True)]
        mean = float(force.sum() / self.interface.area.sum())
        return JointSolution(self, force, model.solve(loads, mean, near))


def elastic_body(plan: Plan, assembly: Assembly, side: int, refinement: float = 1.0) -> ElasticBody:
    """One body of an assembly on a plan."""
    body: Body = assembly.side1 if side == 1 else assembly.side2
    return ElasticBody(body_mesh(plan, assembly, side, refinement), body.E, body.nu, body.density)


def head_loads(body: ElasticBody, assembly: Assembly) -> Array:
    """Load (n, bolts) [N per N] of each bolt along +z on a body of an assembly."""
    marked, count = body.mesh.boundaries, len(assembly.bolts.positions)
    return np.stack([body.uniform_load(marked[f"head{i + 1}"]) for i in range(count)], axis=1)


@dataclass(frozen=True)
class JointSolution:
    """Pressure of a bolted joint: `force` (bolts) [N] of each bolt, `contact` the equilibrium."""

    joint: BoltedContact
    force: Array
    contact: ContactSolution

    def under(self, preload: float, moment: float = 0.0) -> "JointSolution":
        """The same joint and law under another preload [N] per bolt and moment [N.m], found from here."""
        return self.joint._solve(self.contact.model, preload, moment, self.contact)

    @property
    def field(self) -> ContactField:
        """The contact at the quadrature points: areas and total force are those of the finite elements."""
        at = self.joint.interface
        return ContactField(area=at.area, position=at.position, pressure=self.contact.pressure)

    @property
    def peak(self) -> float:
        """Greatest pressure [Pa], at a node: usually on the edge of a hole."""
        return float(self.contact.node_pressure.max())

    @property
    def between(self) -> tuple[Array, Array]:
        """Places (k, 2) [m] of the contact midway between neighbouring bolts, their pressure (k) [Pa]."""
        places = midway(self.joint.assembly.bolts.positions)
        sides = (self.joint.assembly.side1, self.joint.assembly.side2)
        solid = [side.layers()[0].solid(*places.T) for side in sides]
        places = places[solid[0] & solid[1]]
        return places, self.contact.pressure_at(places) if len(places) else np.zeros(0)

    @property
    def stiffness(self) -> dict[str, float]:
        """Normal stiffness [N/m] of the interface, and [N.m/rad] about x and y through its centroid."""
        field = self.field
        k = field.area * self.contact.stiffness
        x, y = (field.position - field.centroid).T
        return {"K_N": float(k.sum()), "K_rx": float(k @ y**2), "K_ry": float(k @ x**2)}


def midway(bolts: Array) -> Array:
    """Middles (k, 2) [m] of neighbouring bolts: no third one lies in the circle on their connection."""
    middles = []
    for i in range(len(bolts)):
        for j in range(i):
            middle = 0.5 * (bolts[i] + bolts[j])
            apart = np.hypot(*(bolts - middle).T)
            if np.sum(apart < 0.5 * np.hypot(*(bolts[i] - bolts[j])) * (1.0 + 1e-9)) == 2:
                middles.append(middle)
    return np.array(middles).reshape(-1, 2)


TILT = 1.0 / 3.0
"""Moment of the second field, over the one that unloads a row of bolts [1]: that of Zhao 2018."""


def with_solution(
    file: ParameterFile, solution: JointSolution, preload: float, moment: float = 0.0
) -> tuple[ParameterFile, PressureShape]:
    """The joint with the field at a preload [N] per bolt, what a moment adds from a second one; all nodes.

    solution : at that preload and moment [N.m]; what is missing is solved from there
    """
    joint = solution.joint
    tilting = moment or TILT * joint.assembly.most_moment(preload)
    equal = solution.under(preload).field if moment else solution.field
    tilted = solution.field if moment else solution.under(preload, tilting).field if tilting else None
    source = f"finite elements of the assembly {joint.assembly.name}"
    bolts = joint.assembly.bolts.positions
    second = tilting or None
    file, reduction = with_field(file, equal, preload, source, tilted=tilted, moment=second, bolts=bolts)
    return replace(file, name=f"{file.name}, computed field"), reduction.field
