"""Export of a bolted joint to other solvers.

Four forms: springs and dashpots between node pairs at a working point (Zhao 2018, section 2), the stiffness
matrix of the complete joint, the contact law of the interface, and a table of the normal force as a function
of the separation. The springs contain the interface only: the bolts belong to the surrounding structure.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from jointfmu.joints.bolted_joint import KIND
from jointfmu.joints.bolted_joint.compliances import condense_stiffness
from jointfmu.joints.bolted_joint.joint import BoltedJointSpring
from jointfmu.joints.bolted_joint.law import TIGHTENING_TEMPERATURE, AnyBoltedJoint, preload_pressure
from jointfmu.joints.model import Variable
from jointfmu.mechanics.footprint.distribution import PressureDistribution
from jointfmu.quantity import Array, quantity_field

from ...exchange.export.exports import JointExports, LoadCurveExport
from ...exchange.export.target_model import Springs

if TYPE_CHECKING:
    from jointfmu.mechanics.curve import Curve

    from ...exchange.export.mesh import NodePairs
    from ...exchange.export.tables import LoadTable
    from ...exchange.export.target_model import TargetModel

TOTAL_STIFFNESS_AND_DAMPING_NAMES = ("K_xx", "K_yy", "K_zz", "C_xx", "C_yy", "C_zz")
"""Outputs of the joint that the springs and dashpots of all nodes must add up to."""
RELATIVE_FORCE_TOLERANCE = 0.3
"""Relative error [1] of the total force of interpolated pressures that is still corrected by scaling."""
RELATIVE_AREA_TOLERANCE = 0.1
"""Relative difference [1] allowed between the area of a mesh and A_0 of the joint."""
_MAX_NODE_DISTANCE_OVER_CONTACT_DIAGONAL = 0.1
"""Distance of a mesh node from the nearest node of the joint over the diagonal of the contact [1], at
most."""


def make_springs_of_joint(
    joint_spring: BoltedJointSpring, preload: float, bending_moment: float, first_node_label: int = 1
) -> Springs:
    """Make spring elements at the pressure nodes of the joint, for a preload [N] per bolt and a moment [N.m].

    Every node becomes a pair of coincident nodes with consecutive labels: the node of
    side 1, then that of side 2. The first label is `first_node_label`.
    """
    count = joint_spring.points.area_share.size
    labels = first_node_label + np.arange(2 * count, dtype=np.int64).reshape(2, count).T
    return _distribute_to_nodes(joint_spring, labels, preload, bending_moment, None)


def make_springs_on_mesh(
    joint_spring: BoltedJointSpring, node_pairs: "NodePairs", preload: float, bending_moment: float
) -> Springs:
    """Make spring elements at the node pairs of a mesh, for a preload [N] per bolt and a moment [N.m].

    The pressure is interpolated linearly between the nodes of the joint (outside of them: value of the
    nearest node) and scaled to the same total force. Then all stiffnesses are multiplied by one factor,
    so that they add up to the stiffness of the joint.

    Raises ValueError if a pair lies outside the joint, if the areas do not add up to the nominal contact area
    A_0 within RELATIVE_AREA_TOLERANCE, or if the interpolated pressures do not add up to the force of the
    joint within RELATIVE_FORCE_TOLERANCE.
    """
    from scipy.interpolate import LinearNDInterpolator
    from scipy.spatial import KDTree

    _check_total_area(joint_spring, node_pairs)
    shape, position = joint_spring.points, node_pairs.position
    share = node_pairs.contact_area / node_pairs.contact_area.sum()
    distance, nearest = KDTree(shape.position).query(position)
    allowed = _MAX_NODE_DISTANCE_OVER_CONTACT_DIAGONAL * float(np.hypot(*np.ptp(shape.position, axis=0)))
    if np.any(distance > allowed):
        worst = int(np.argmax(distance))
        raise ValueError(
            f"{node_pairs.csv_path}: node {node_pairs.node_labels[worst, 0]} is {distance[worst]:.3g} m "
            f"outside the joint's contact, allowed are {allowed:.3g} m; check units and origin (the "
            "centroid) of x and y"
        )
    values = np.stack([shape.preload_pressure_ratio, shape.moment_pressure_ratio], axis=1)
    linear = LinearNDInterpolator(shape.position, values)(position)
    equal, tilt = np.where(np.isnan(linear), values[nearest], linear).T
    force = float(share @ equal)
    if abs(force - 1.0) > RELATIVE_FORCE_TOLERANCE:
        raise ValueError(
            f"{node_pairs.csv_path}: the pressures at its nodes add up to {force:.3g} times the joint's "
            f"force, allowed is a difference of {RELATIVE_FORCE_TOLERANCE:.0%}; refine the mesh, or add a "
            "column pressure"
        )
    equal /= force
    tilt -= (share @ tilt) * equal
    mapped = joint_spring.with_nodes(PressureDistribution(share, position, equal, tilt))
    return _distribute_to_nodes(
        mapped,
        node_pairs.node_labels,
        preload,
        bending_moment,
        _total_interface_stiffness_and_damping(joint_spring, preload, bending_moment),
    )


def make_springs_under_pressure(joint_spring: BoltedJointSpring, node_pairs: "NodePairs") -> Springs:
    """Make spring elements at the node pairs of a mesh, under the nodal pressures in the file of the mesh.

    Raises ValueError if the file has no pressures, or if the areas do not add up to the nominal contact area
    A_0 within RELATIVE_AREA_TOLERANCE.
    """
    if node_pairs.contact_pressure is None:
        raise ValueError(f"{node_pairs.csv_path}: has no column 'pressure'; expected pressure [Pa]")
    _check_total_area(joint_spring, node_pairs)
    share = node_pairs.contact_area / node_pairs.contact_area.sum()
    mean = float(share @ node_pairs.contact_pressure)
    shape = PressureDistribution(
        share, node_pairs.position, node_pairs.contact_pressure / mean, np.zeros_like(share)
    )
    mapped = joint_spring.with_nodes(shape)
    return _distribute_to_nodes(
        mapped, node_pairs.node_labels, mean * joint_spring.joint.A_0 / joint_spring.joint.n_bolts, 0.0, None
    )


def _check_total_area(joint_spring: BoltedJointSpring, node_pairs: "NodePairs") -> None:
    """Check that areas of node pairs add up to the nominal contact area, within RELATIVE_AREA_TOLERANCE.

    Raises ValueError if they do not.
    """
    area, expected = float(node_pairs.contact_area.sum()), float(joint_spring.joint.A_0)
    if abs(area / expected - 1.0) > RELATIVE_AREA_TOLERANCE:
        raise ValueError(
            f"{node_pairs.csv_path}: the areas add up to {area:.4g} m2, the joint has A_0 = {expected:.4g} "
            f"m2; allowed is a difference of {RELATIVE_AREA_TOLERANCE:.0%}; check the unit of area"
        )


def _total_interface_stiffness_and_damping(
    joint_spring: BoltedJointSpring, preload: float, bending_moment: float
) -> dict[str, float]:
    """Stiffness [N/m] and damping [N.s/m] of the whole interface: {name: value}."""
    rest = (0.0, 0.0, 0.0)
    state = joint_spring.evaluate(preload, bending_moment, rest, rest)
    sums = {name: float(state[name]) for name in TOTAL_STIFFNESS_AND_DAMPING_NAMES}
    tightened = joint_spring.bolts.preload_force(joint_spring.joint, preload, bending_moment)
    bolts = joint_spring.bolts.bolts_per_position * joint_spring.bolts.active_stiffness(
        tightened, np.zeros_like(tightened)
    )
    return sums | {"K_zz": sums["K_zz"] - float(np.sum(bolts))}


def _distribute_to_nodes(
    joint_spring: BoltedJointSpring,
    node_labels: NDArray[np.int64],
    preload: float,
    bending_moment: float,
    stiffness_and_damping_totals: dict[str, float] | None,
) -> Springs:
    """Distribute stiffness and damping to the nodes, in proportion to area share times stiffness per area.

    stiffness_and_damping_totals : {name in TOTAL_STIFFNESS_AND_DAMPING_NAMES: total}; None: the totals of
        `joint_spring`

    Raises ValueError if nothing is in contact or a pressure exceeds the range of the contact law.
    """
    joint, shape = joint_spring.joint, joint_spring.points
    p = preload_pressure(joint, shape, preload, bending_moment)
    highest = joint_spring.curve.end_point[1]
    if not (np.isfinite(preload + bending_moment) and 0.0 < np.max(p) <= highest):
        raise ValueError(
            f"preload = {preload:g} N per bolt with moment = {bending_moment:g} N.m is outside the law: "
            f"expected more than embedding takes, {joint.embedding:g} N, and pressures up to {highest:g} Pa"
        )
    nodal_stiffness = shape.area_share * joint_spring.curve.derivatives(joint_spring.curve.inverse(p), 1)[1]
    closed = nodal_stiffness > 0.0
    fraction = (nodal_stiffness / nodal_stiffness.sum())[closed]
    spring_totals = _total_interface_stiffness_and_damping(joint_spring, preload, bending_moment)
    sums = stiffness_and_damping_totals or spring_totals
    return Springs(
        node_labels[closed],
        shape.position[closed],
        (shape.area_share * joint.A_0)[closed],
        p[closed],
        sums["K_zz"] * fraction,
        sums["K_xx"] * fraction,
        sums["C_zz"] * fraction,
        sums["C_xx"] * fraction,
        sums,
        sums["K_zz"] / spring_totals["K_zz"],
        int(np.sum(~closed)),
    )


MAX_TABULATED_OVER_TIGHTENING_FORCE = 10.0
"""Total contact force at the compressed end of the table, over the contact force at tightening [1]."""
_TABLE_ERROR_SAMPLE_COUNT = 4000
"""Number of sample points on each side of the tightened state [1], at which the error is measured."""
_NODE_EVALUATIONS_PER_BLOCK = 100_000
"""Number of nodes times sample points that are evaluated at once [1], to limit the memory."""


def tabulate_normal_force(
    joint_spring: BoltedJointSpring, preload: float, bending_moment: float, max_table_error: float
) -> "LoadTable":
    """Normal force [N] and stiffness [N/m] of interface and bolts as functions of the separation s_rel_z [m].

    The force is positive when it pulls the sides together. The table starts in compression, at a contact
    force of MAX_TABULATED_OVER_TIGHTENING_FORCE times the contact force at tightening. It ends where the last
    node opens; beyond, only the force of the bolts grows. A bolt adds its stiffness while it pulls.

    max_table_error : largest relative error [1] of the table; where force or stiffness are smaller than at
                      tightening, relative to the value at tightening

    Raises ValueError if nothing is in contact or the pressure reaches the hardness.
    """
    from ...exchange.export.tables import LoadTable, decimate_curve

    start = joint_spring.checked_preloaded_approach(preload, bending_moment)
    low, high = joint_spring.curve.displacement[[0, -1]]
    shape = joint_spring.points.merge_nodes(keeps_moment_pressure=bending_moment != 0.0)
    approach = joint_spring.curve.inverse(
        preload_pressure(joint_spring.joint, shape, preload, bending_moment)
    )
    weight = joint_spring.joint.A_0 * shape.area_share
    springs, held_bolts = (
        joint_spring.bolts,
        joint_spring.bolts.preload_force(joint_spring.joint, preload, bending_moment),
    )
    bolts = float(joint_spring.joint.n_bolts * joint_spring.joint.bolt_stiffness)

    def bolt_compression_correction(separation: Array) -> tuple[Array, Array]:
        """Force [N] and stiffness [N/m] by which bolts, which only pull, deviate from linear springs."""
        elongation = separation[:, None] + np.zeros(len(held_bolts))
        gap = springs.head_gap(held_bolts, elongation)
        lost = springs.stiffness - springs.active_stiffness(held_bolts, elongation)
        return springs.bolts_per_position * springs.stiffness * gap.sum(
            axis=1
        ), springs.bolts_per_position * lost.sum(axis=1)

    def contact_force_and_stiffness(separation: Array) -> Array:
        """Force [N] and stiffness [N/m] of the contact at separations [m]."""
        blocks = np.array_split(
            separation[:, None], max(separation.size * approach.size // _NODE_EVALUATIONS_PER_BLOCK, 1)
        )
        results = [
            [value @ weight for value in joint_spring.curve.derivatives(approach - s, 1)] for s in blocks
        ]
        return np.concatenate(results, axis=1)

    preload_force, preload_stiffness = (float(value[0]) for value in contact_force_and_stiffness(np.zeros(1)))
    compression = np.linspace(0.0, float(high - np.max(start)), 400)
    end = float(
        np.interp(
            MAX_TABULATED_OVER_TIGHTENING_FORCE * preload_force,
            contact_force_and_stiffness(-compression)[0],
            compression,
        )
    )
    opening = float(np.max(start) - low)
    s = np.concatenate(
        [
            np.linspace(-end, 0.0, _TABLE_ERROR_SAMPLE_COUNT),
            np.linspace(0.0, opening, _TABLE_ERROR_SAMPLE_COUNT)[1:],
        ]
    )
    force, stiffness = contact_force_and_stiffness(s)
    pushing, lost = bolt_compression_correction(s)
    normal_force = preload_force - force + bolts * s + pushing
    scale = preload_force, preload_stiffness
    table = decimate_curve(
        s,
        normal_force,
        stiffness + (bolts - lost),
        max_table_error,
        scale,
        required_point_indices=(_TABLE_ERROR_SAMPLE_COUNT - 1,),
    )
    last = [2.0 * opening, preload_force + 2.0 * bolts * opening, bolts]
    return LoadTable(
        np.vstack([table.table_rows, last]), table.linear_interpolation_errors, table.monotone_cubic_errors
    )


@dataclass(frozen=True, slots=True)
class TightenedState:
    """Tightened state of a bolted joint: preload of each bolt, bending moment, and temperature."""

    preload: float = quantity_field("N", "the force of each bolt at tightening")
    moment: float = quantity_field("N.m", "the bending moment", default=0.0)
    temperature: float = quantity_field(
        "K", "the temperature of bolts and members", default=TIGHTENING_TEMPERATURE
    )

    def __str__(self) -> str:
        warm = "" if self.temperature == TIGHTENING_TEMPERATURE else f", temperature {self.temperature:g} K"
        return f"preload {self.preload:g} N per bolt, moment {self.moment:g} N.m{warm}"

    def preload_and_bending_moment(self, joint_spring: BoltedJointSpring) -> tuple[float, float]:
        """Preload [N] of each bolt of a joint at this temperature, and moment [N.m]."""
        return joint_spring.preload_at_temperature(self.preload, self.temperature), self.moment


def _make_springs(
    joint_parameters: AnyBoltedJoint,
    tightened_state: TightenedState | None,
    node_pairs: "NodePairs | None",
    target_model: "TargetModel",
) -> "tuple[Springs, str]":
    """Make spring elements between node pairs, with their stiffness in the tightened state."""
    spring = BoltedJointSpring.from_interface_nodes(joint_parameters)
    if tightened_state is None:
        if node_pairs is None:
            raise ValueError("springs need a preload, or node pairs with their pressure")
        return make_springs_under_pressure(spring, node_pairs), f"pressures of {node_pairs.csv_path.name}"
    if node_pairs is None:
        return make_springs_of_joint(
            spring, *tightened_state.preload_and_bending_moment(spring), target_model.first_free_number
        ), str(tightened_state)
    springs = make_springs_on_mesh(spring, node_pairs, *tightened_state.preload_and_bending_moment(spring))
    return springs, f"{tightened_state}, on the nodes of {node_pairs.csv_path.name}"


def _joint_stiffness(joint_parameters: AnyBoltedJoint, tightened_state: TightenedState) -> Array:
    """Tangent stiffness (6, 6) of the tightened joint about the centroid of the contact, without slip."""
    spring = BoltedJointSpring.from_joint(joint_parameters)
    preload, moment = tightened_state.preload_and_bending_moment(spring)
    spring.checked_preloaded_approach(preload, moment)
    return condense_stiffness(spring.tangent_stiffness(preload, moment))


def _contact_curve(joint_parameters: AnyBoltedJoint) -> "tuple[Curve, Sequence[str]]":
    """Contact law of the interface: pressure [Pa] as a function of the approach [m] of the faces."""
    ratio = float(joint_parameters.shear_stiffness_ratio())
    note = f"tangential stiffness of the law: {ratio:.9g} times the slope of the table"
    return BoltedJointSpring.from_interface_nodes(joint_parameters).curve, [note]


def _normal_force_table(
    joint_parameters: AnyBoltedJoint, tightened_state: TightenedState | None, max_table_error: float
) -> "LoadTable":
    """Table of normal force and stiffness as functions of the separation, in a tightened state."""
    if tightened_state is None:
        raise ValueError("the curve of a bolted_joint needs a preload")
    spring = BoltedJointSpring.from_interface_nodes(joint_parameters)
    return tabulate_normal_force(spring, *tightened_state.preload_and_bending_moment(spring), max_table_error)


_JOINT_VARIABLES = KIND.variables
"""Inputs and outputs of the bolted joint."""
EXPORTS = JointExports(
    working_point_class=TightenedState,
    springs=_make_springs,
    stiffness=_joint_stiffness,
    contact=_contact_curve,
    curve=LoadCurveExport(
        curve_meaning=(
            "force that holds the interface together over its separation from the tightened state, with "
            "the tension of the bolts; without members and damping"
        ),
        curve_variables=(
            _JOINT_VARIABLES["s_rel_z"],
            Variable("pull", "N", "force that holds it together"),
            _JOINT_VARIABLES["K_zz"],
        ),
        table_name="force",
        compute_table=_normal_force_table,
    ),
)
"""Exports that the bolted joint offers."""
