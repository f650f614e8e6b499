"""Finite elements for the plates of a drawing: contact pressure, and stiffness of the complete joint."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from jointfmu.joints.bolted_joint.compliances import COMPLIANCE_COMPONENTS, Compliances
from jointfmu.joints.bolted_joint.joint import BoltedJointSpring
from jointfmu.joints.bolted_joint.law import ElasticBodies, preload_pressure, working_preload
from jointfmu.mechanics.curve import tabulate_approach
from jointfmu.mechanics.footprint.bolts import pressure_distribution
from jointfmu.mechanics.footprint.distribution import PressureDistribution
from jointfmu.mechanics.footprint.plate import BoltedPlate
from jointfmu.parameters import ParameterFile
from jointfmu.progress import set_status_text
from jointfmu.quantity import Array, flatten_parameters

from ....fem import require_fem_packages
from ....inputs.drawing.part import NewJoint
from ....inputs.drawing.vdi2230 import ClampedPart
from . import ATTACHMENT_SURFACES

if TYPE_CHECKING:
    from ....fem.geometry import Assembly
    from ....fem.whole_joint import JointFiniteElements


@dataclass(frozen=True, slots=True)
class BoltedPlates:
    """Two bolted plates of a drawing, from which finite elements are made.

    bolted_plate      : contact plane with the bolt positions
    clamped_parts     : thickness and modulus of side 1 and side 2
    bearing_diameter  : [m] of the surface under head and nut
    densities         : [kg/m3] of side 1 and side 2
    preload           : [N] of each bolt at tightening
    remaining_preload : [N] preload that remains after embedding
    thread_depth      : [m] depth of the thread in side 2; 0: through bolt with nut
    """

    bolted_plate: BoltedPlate
    clamped_parts: tuple[ClampedPart, ...]
    bearing_diameter: float
    densities: tuple[float, ...]
    preload: float
    remaining_preload: float
    thread_depth: float = 0.0

    def make_assembly(self, parameter_file: ParameterFile) -> "Assembly":
        """Build the bodies of the finite-element model.

        Raises ValueError for bolt heads that overlap or extend beyond the plate.
        """
        from ....fem.geometry import Assembly, BoltList, Plate, TappedPlate

        sides = [
            Plate(
                length=self.bolted_plate.length,
                width=self.bolted_plate.width,
                thickness=layer.thickness,
                E=layer.E,
                nu=parameter_file.values_by_name[f"side{i + 1}.nu"],
                density=self.densities[i],
            )
            for i, layer in enumerate(self.clamped_parts)
        ]
        if self.thread_depth:
            sides[1] = TappedPlate(**flatten_parameters(sides[1]), depth=self.thread_depth)
        plate = self.bolted_plate
        bolts = BoltList(
            x=plate.x, y=plate.y, hole_diameter=plate.hole_diameter, head_diameter=self.bearing_diameter
        )
        return Assembly(parameter_file.name, sides[0], sides[1], bolts)


def compute_pressure_field(
    parameter_file: ParameterFile, bolted_plates: BoltedPlates
) -> tuple[ParameterFile, PressureDistribution]:
    """Replace the pressure cones of the bolts by the computed contact pressure of the elastic plates.

    Returns the parameters, whose pressure field has few nodes, and the pressure over mean pressure [1] at all
    nodes of the finite elements.

    Raises ValueError for bolt heads that overlap or extend beyond the plate, and if a package is missing.
    """

    with require_fem_packages("--field computed"):
        from ....fem.bolted_contact import BoltedContact, insert_contact_pressure

        set_status_text("contact of the plates by finite elements")
        solution = BoltedContact.from_assembly(bolted_plates.make_assembly(parameter_file)).solve_equilibrium(
            tabulate_approach(parameter_file.values), bolted_plates.remaining_preload
        )
    return insert_contact_pressure(parameter_file, solution, bolted_plates.remaining_preload)


COARSE_MESH_REFINEMENT = 0.5
"""Refinement of the second mesh, for the estimate of the error of the finite elements [1]."""


@dataclass(frozen=True, slots=True)
class ComputedJoint:
    """Complete joint between its attachments, by finite elements.

    joint_compliances      : compliances of the linear finite-element model
    parameter_file         : parameters of the joint with elastic sides
    changes_between_meshes : relative changes [1] of K_xx, ..., K_rz and the load factor, by name, from a mesh
        of twice the element size to this mesh
    """

    joint_compliances: Compliances
    parameter_file: ParameterFile
    changes_between_meshes: dict[str, float]


def compute_joint(
    parameter_file: ParameterFile,
    bolted_plates: BoltedPlates,
    attachment_kind: str,
    normalised_pressure: PressureDistribution | None = None,
) -> ComputedJoint:
    """Compute interface, bodies and bolts of a drawing at its preload by finite elements."""
    return compute_joint_of_assembly(
        parameter_file,
        lambda: bolted_plates.make_assembly(parameter_file),
        bolted_plates.preload,
        attachment_kind,
        normalised_pressure,
    )


def compute_joint_of_assembly(
    parameter_file: ParameterFile,
    make_assembly: "Callable[[], Assembly]",
    preload: float,
    attachment_kind: str,
    normalised_pressure: PressureDistribution | None = None,
) -> ComputedJoint:
    """Compute the complete joint by finite elements and reduce its bodies to modes.

    make_assembly       : returns the geometry of bodies and bolts
    preload             : [N] of each bolt at tightening
    attachment_kind     : surfaces that move rigidly with the connected bodies, a key of ATTACHMENT_SURFACES
    normalised_pressure : computed pressure over mean pressure [1] at all nodes of the finite elements; None:
        use the distribution of the parameter file

    Raises ValueError for bolt heads that overlap or extend beyond the plate, and if a package is missing.
    """

    with require_fem_packages("the complete joint"):
        from ....fem.geometry import check_thickness
        from ....fem.reduction.elastic_bodies import reduce_bodies
        from ....fem.whole_joint import JointFiniteElements, LinearJoint

        set_status_text("members by finite elements")
        clamped = make_assembly()
        check_thickness(clamped)
        joint = JointFiniteElements.from_assembly(clamped, attachment_kind)

        def linearise_joint(finite_element_model: JointFiniteElements) -> tuple[LinearJoint, Array]:
            springs = _interface_stiffness(parameter_file, preload, finite_element_model, normalised_pressure)
            return finite_element_model.linearise_joint(
                springs, parameter_file.values.bolt_stiffness
            ), springs

        linear, springs = linearise_joint(joint)
        bodies = replace(
            reduce_bodies(
                linear, BoltedJointSpring.from_joint(parameter_file.values), springs[:, 2], preload
            ),
            thickness=(clamped.side1.clamped_thickness, clamped.side2.clamped_thickness),
            outline=_contact_outline(clamped, joint.contact_interface.centroid),
            hole_diameter=clamped.bolts.hole_diameter,
            head_diameter=clamped.bolts.head_diameter,
            thread_depth=getattr(clamped.side2, "depth", 0.0),
        )
        compliances = linear.compliances()
        coarse, _ = linearise_joint(
            JointFiniteElements.from_assembly(clamped, attachment_kind, refinement=COARSE_MESH_REFINEMENT)
        )
        changes = _compare_meshes(compliances, coarse.compliances())
    file = set_elastic_bodies(parameter_file, bodies, attachment_kind)
    name = "bodies.stiffness"
    sources = {**file.sources, name: f"{file.sources[name]}; {_describe_mesh_changes(changes)}"}
    return ComputedJoint(compliances, replace(file, sources=sources), changes)


def _compare_meshes(
    fine_mesh_compliances: Compliances, coarse_mesh_compliances: Compliances
) -> dict[str, float]:
    """Relative changes [1] of the stiffnesses and of the load factor from a coarse to a fine mesh."""
    stiffness = coarse_mesh_compliances.total_compliance / fine_mesh_compliances.total_compliance - 1.0
    changes = {
        row[0]: float(change)
        for row, change in zip(fine_mesh_compliances.compliance_table_rows(), stiffness, strict=True)
    }
    factor = fine_mesh_compliances.joint_load_factor
    return changes | (
        {"load factor": 1.0 - coarse_mesh_compliances.joint_load_factor / factor} if factor else {}
    )


def _describe_mesh_changes(changes_between_meshes: dict[str, float]) -> str:
    """Write the relative changes from a coarser mesh as a sentence: they estimate the error of the mesh."""
    changes = ", ".join(f"{name} {change:+.1%}" for name, change in changes_between_meshes.items())
    return f"change from a mesh with elements of twice the size, an estimate of the error: {changes}"


def _contact_outline(assembly: "Assembly", centroid: Array) -> tuple[float, ...]:
    """Bounding box of the contact relative to its centroid: x_min, y_min, x_max, y_max [m]."""
    half = np.min(
        [side.list_rectangular_layers()[0].outline_half_lengths for side in (assembly.side1, assembly.side2)],
        axis=0,
    )
    return tuple(np.concatenate([-half - centroid, half - centroid]).tolist())


def set_elastic_bodies(
    parameter_file: ParameterFile, elastic_bodies: ElasticBodies, attachment_kind: str
) -> ParameterFile:
    """Copy of a parameter file with elastic sides: bodies reduced to modes, and their attached surfaces."""
    values = replace(
        parameter_file.values, sides="elastic", bodies=replace(elastic_bodies, attached=attachment_kind)
    )
    source = f"finite elements of the bodies between {ATTACHMENT_SURFACES[attachment_kind]}, reduced to modes"
    names = [f"bodies.{name}" for name, value in flatten_parameters(elastic_bodies).items() if value != ()]
    stated = "elastic: interface, members and bolts; rigid: interface and bolts between rigid members"
    return replace(
        parameter_file,
        values=values,
        origins={**parameter_file.origins, **dict.fromkeys(names, "derived"), "sides": "user"},
        sources={**parameter_file.sources, **dict.fromkeys(names, source), "sides": stated},
    )


def _interface_stiffness(
    parameter_file: ParameterFile,
    preload: float,
    joint_model: "JointFiniteElements",
    normalised_pressure: PressureDistribution | None,
) -> Array:
    """Stiffness per area (points, 3) [N/m3] along x, y, z of the tightened interface, at integration points.

    The pressure of a plate with pressure cones is computed at each point. In another pressure distribution,
    each point takes the value of the nearest node. Then all values are multiplied by one factor, so that the
    total normal stiffness is that of the interface.

    normalised_pressure : computed pressure over mean pressure [1] at nodes; None: that of the parameter file
    """
    from scipy.spatial import cKDTree

    values, interface = parameter_file.values, joint_model.contact_interface
    nodes = normalised_pressure or pressure_distribution(values.pattern)
    curve = tabulate_approach(values)

    def stiffness(pressure: PressureDistribution) -> Array:
        p = preload_pressure(values, pressure, preload, 0.0)
        return curve.derivatives(curve.inverse(p), 1)[1]

    nodal = stiffness(nodes)
    if normalised_pressure is None and isinstance(values.pattern, BoltedPlate):
        normal = stiffness(
            values.pattern.pressure_distribution((interface.quadrature_area, interface.quadrature_position))
        )
    else:
        normal = nodal[cKDTree(nodes.position).query(interface.centred_position)[1]]
    normal = normal * (values.A_0 * (nodes.area_share @ nodal) / (interface.quadrature_area @ normal))
    ratio = float(values.shear_stiffness_ratio())
    return np.stack([ratio * normal, ratio * normal, normal], axis=1)


DerivedResults = dict[str, tuple[float, str, str]]
"""Results of a joint: {name: (value, unit, explanation)}."""


def compute_complete_joint(
    parameter_file: ParameterFile,
    bolted_plates: BoltedPlates,
    attachment_kind: str,
    normalised_pressure: PressureDistribution | None = None,
) -> NewJoint:
    """Compute the complete joint of a drawing by finite elements: parameters with elastic sides, results.

    normalised_pressure : computed pressure over mean pressure [1] at nodes; None: that of the parameter file

    Raises ValueError if the complete joint cannot be computed; the message advises to model the interface
    alone.
    """
    try:
        computed = compute_joint(parameter_file, bolted_plates, attachment_kind, normalised_pressure)
    except ValueError as error:
        raise ValueError(f"{error}; or state --sides rigid for rigid plates") from None
    changes = computed.changes_between_meshes
    mesh_error = max(map(abs, changes.values())), "1", _describe_mesh_changes(changes)
    facts = compute_elastic_joint_results(computed.parameter_file, bolted_plates.preload)
    return NewJoint(computed.parameter_file, facts | {"mesh_error": mesh_error})


def compute_elastic_joint_results(parameter_file: ParameterFile, preload: float) -> DerivedResults:
    """Compute stiffness and load results of a joint with elastic sides, at a preload [N] of each bolt."""
    compliances = BoltedJointSpring.from_joint(parameter_file.values).compliances(preload)
    remaining_preload = float(working_preload(parameter_file.values, preload))
    attachment = parameter_file.values.bodies.attached
    return (
        _compute_stiffness_results(compliances, attachment, preload)
        | _compute_load_results(compliances, remaining_preload, attachment)
        | _compute_interface_share(compliances)
    )


def _compute_stiffness_results(
    joint_compliances: Compliances, attachment_kind: str, preload: float
) -> DerivedResults:
    """Stiffnesses in all directions at a preload [N], first of the complete joint, then of its members."""
    rows, members = {}, {}
    for name, unit, (joint, interface, alone, _), parts in joint_compliances.compliance_table_rows():
        shares = ", ".join(
            f"{share:.0%} {part}" for share, part in zip(parts, COMPLIANCE_COMPONENTS, strict=True)
        )
        rows[f"joint_{name}"] = (
            joint,
            unit,
            f"complete joint between {ATTACHMENT_SURFACES[attachment_kind]}, other motions fixed: output "
            f"{name} of the FMU at preload = {preload:.5g} N; compliance by stored energy: {shares}; between "
            f"rigid plates, which load it evenly, the interface is {interface / joint:.3g} times as stiff",
        )
        members[f"members_{name}"] = (
            alone,
            unit,
            "stiffness of the members, in series with interface and bolts",
        )
    return rows | members


def _compute_interface_share(joint_compliances: Compliances) -> DerivedResults:
    """Share of the interface in the compliance of the complete joint, as a result for the user."""
    share = joint_compliances.compliance_shares[0]
    rest = max(part for i, part in enumerate(share) if i != 2)
    text = (
        f"share of the interface in the compliance along z, at most {rest:.3g} in other directions; the FMU "
        "is the complete joint (sides = elastic)"
    )
    return {"interface_share": (float(share[2]), "1", text)}


def _compute_load_results(
    joint_compliances: Compliances, remaining_preload: float, attachment_kind: str
) -> DerivedResults:
    """Load factor, bolt share and opening load for an external force along z without bending."""
    where = f"force along z at {ATTACHMENT_SURFACES[attachment_kind]}"
    opens = joint_compliances.opening_load(remaining_preload)
    free = f"{where}, other motions free"
    return {
        "joint_load_factor": (
            joint_compliances.joint_load_factor,
            "1",
            f"n Phi_K: share that all bolts carry of a {free}",
        ),
        "bolt_load_share": (
            float(joint_compliances.bolt_force[:, 2].max()),
            "1",
            f"share that the most loaded bolt carries of a {free}",
        ),
        "opening_load": (
            opens,
            "N",
            f"{where} at which the interface opens around the most loaded bolt, by linear theory; a joint "
            "that peels opens at a lower load, see the report",
        ),
    }
