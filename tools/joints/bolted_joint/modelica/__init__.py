"""Bolted joint in the Modelica library: one record for each working point (preload, moment, temperature)."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from jointfmu.joints.bolted_joint.joint import BoltedJointSpring
from jointfmu.joints.bolted_joint.law import TIGHTENING_TEMPERATURE
from jointfmu.mechanics.curve import Curve
from jointfmu.mechanics.footprint.reproducible import ROUND_OFF_OVER_LARGEST_NUMBER
from jointfmu.mechanics.sliders import UNIFORM_DISTRIBUTION_DEVIATION, Foundation
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array

from ....exchange.modelica.records import (
    COMPUTED_DIGITS,
    InterpolationTable,
    ModelicaComponent,
    ModelicaRecord,
    WorkingPoint,
    decimate_curve,
    format_computed_values,
    format_double_literal,
    format_matrix,
    format_parameter_values,
    make_identifier,
)

DISSIPATION_FACTOR_TOLERANCE = 1e-3
"""Largest relative error [1] of the linearly interpolated dissipation factor."""
MAX_TABULATED_OVER_TIGHTENING_FORCE = 10.0
"""Total contact force at the end of the table, over the contact force at tightening [1]."""
PRELOADED_SLIDER_PAIR_COUNT, FIRST_SLIDER_OVER_GROSS_SLIP_DISPLACEMENT = 12, 2e-3
"""Number of slider pairs in contact at tightening, and slip displacement of the first pair over displacement
of gross slip [1]. The slip displacements of the pairs form a geometric sequence."""
FULL_CONTACT_OVER_TIGHTENING_FORCES = (2.0, 5.0)
"""Normal forces over that at tightening [1] at which further pairs of sliders come into full contact.

They are on the compression side."""
_FORCE_SAMPLE_COUNT, _DISSIPATION_SAMPLE_COUNT = 800, 200
"""Sample points on either side of the tightened state: for the force, before decimation, and for the
damping."""


class CombinedSpring(NamedTuple):
    """Bolted joint at fixed preload and moment, with all nodes combined to one spring.

    force_table            : increase of the force [N] from the tightened state, over the approach from there
                             [m]
    dissipation_factor_table : rows (n, 2) of approach [m] and dissipation factor eta_n [1]
    shear_stiffness_ratio  : K_T/K_N [1]
    preload_contact_force  : normal force of the interface at tightening [N]
    slider_pair_boundaries : rows (n, 3) of approach [m], normal force [N] and stiffness [N/m]; the friction
                             springs between two rows are combined to one pair of sliders
    slider_properties      : rows (2 n - 2, 2) of stiffness [N/m] and friction limit [N] at tightening: first
                             the slider of each pair that slips earlier, then the other slider of each pair
    bolt_forces            : preload force (b) [N] at each bolt position, all bolts of a position together
    """

    force_table: InterpolationTable
    dissipation_factor_table: Array
    shear_stiffness_ratio: float
    preload_contact_force: float
    slider_pair_boundaries: Array
    slider_properties: Array
    bolt_forces: Array


def combine_nodes_to_spring(
    joint_spring: BoltedJointSpring, preload: float, bending_moment: float
) -> CombinedSpring:
    """Combine all nodes of a joint to one spring, at a preload [N] per bolt and a moment [N.m].

    Side 2 is rigid and does not rotate. So all patches have the same tangential displacement and their curves
    add: friction follows, as for one patch, from the total force as a function of the approach.
    """
    start = joint_spring.checked_preloaded_approach(preload, bending_moment)
    low, high = joint_spring.curve.displacement[[0, -1]]
    area, share = joint_spring.joint.A_0, joint_spring.points.area_share

    def total_contact_force(approach_change: Array) -> list[Array]:
        """Total contact force [N] at a change of the approach [m] from the tightened state."""
        approach = start + approach_change[:, None]
        approach[approach - low < ROUND_OFF_OVER_LARGEST_NUMBER * (high - low)] = (
            low  # nodes that just touch have no load
        )
        nodal = joint_spring.curve.derivatives(approach, 2)
        return [area * (value @ share) for value in nodal]

    preload_force = total_contact_force(np.zeros(1))[0][0]
    first, last = float(low - np.max(start)), float(high - np.max(start))
    compression = np.linspace(0.0, last, 200)
    end = float(
        np.interp(
            MAX_TABULATED_OVER_TIGHTENING_FORCE * preload_force,
            total_contact_force(compression)[0],
            compression,
        )
    )
    c = np.unique(
        np.concatenate(
            [np.linspace(first, 0.0, _FORCE_SAMPLE_COUNT), np.linspace(0.0, end, _FORCE_SAMPLE_COUNT)]
        )
    )
    load, stiffness, d2_load = total_contact_force(c)
    curve = Curve(c, load, stiffness, d2_load[:-1], d2_load[1:])
    zero = int(np.searchsorted(c, 0.0))
    coarse = np.concatenate(
        [
            np.linspace(first, 0.0, _DISSIPATION_SAMPLE_COUNT),
            np.linspace(0.0, end, _DISSIPATION_SAMPLE_COUNT)[1:],
        ]
    )
    eta = np.interp(c, coarse, _dissipation_factor(joint_spring, start + coarse[:, None]))

    def is_dissipation_factor_linear(first_table_index: int, last_table_index: int) -> bool:
        """Whether the dissipation factor between two table nodes is linear within the tolerance."""
        line = np.interp(
            c[first_table_index : last_table_index + 1],
            c[[first_table_index, last_table_index]],
            eta[[first_table_index, last_table_index]],
        )
        return bool(
            np.all(
                np.abs(line - eta[first_table_index : last_table_index + 1])
                <= DISSIPATION_FACTOR_TOLERANCE * eta[first_table_index : last_table_index + 1]
            )
        )

    table = decimate_curve(
        curve,
        error_reference_node=zero,
        required_nodes=(zero,),
        is_segment_allowed=is_dissipation_factor_linear,
    )
    damping = np.column_stack([table.table_rows[:, 0], np.interp(table.table_rows[:, 0], c, eta)])
    table.table_rows[:, 1] -= load[zero]
    levels = [np.interp(factor * preload_force, load, c) for factor in FULL_CONTACT_OVER_TIGHTENING_FORCES]
    heights = np.concatenate(
        [
            [first],
            first
            * np.geomspace(1.0, FIRST_SLIDER_OVER_GROSS_SLIP_DISPLACEMENT, PRELOADED_SLIDER_PAIR_COUNT)[1:],
            [0.0],
            levels,
        ]
    )
    force, normal, _ = total_contact_force(heights)
    rows = np.column_stack([heights, force, normal])
    ratio = float(joint_spring.joint.shear_stiffness_ratio())
    carried = Foundation(curve, ratio, joint_spring.joint.mu, heights).slider_properties(0.0)
    sliders = np.column_stack(
        [np.concatenate([x[::2], x[1::2]]) for x in (carried.stiffness, carried.friction_limit)]
    )
    bolts = joint_spring.bolts.bolts_per_position * joint_spring.bolts.preload_force(
        joint_spring.joint, preload, bending_moment
    )
    return CombinedSpring(table, damping, ratio, preload_force, rows, sliders, bolts)


def _dissipation_factor(joint_spring: BoltedJointSpring, nodal_approaches: Array) -> Array:
    """Normal dissipation factor eta_n [1] in m states, from the approaches (m, n) [m] of n contact nodes."""
    plastic, elastic = joint_spring.first_loading_work(joint_spring.curve.derivatives(nodal_approaches, 0)[0])
    return np.asarray((plastic @ joint_spring.points.area_share) / (elastic @ joint_spring.points.area_share))


DEFAULT_WORKING_POINTS = tuple(
    (*load, TIGHTENING_TEMPERATURE) for load in ((9e3, 0.0), (15e3, 0.0), (15e3, 4500.0))
)
"""Working points of the default records: preload [N] per bolt and moment [N.m] from Zhao 2018, Table 3, and
temperature [K]."""


def _make_records(
    parameter_file: ParameterFile, working_points: Sequence[WorkingPoint]
) -> list[ModelicaRecord]:
    """Make the Modelica records of a parameter file, one for each working point."""
    spring = BoltedJointSpring.from_interface_nodes(parameter_file.values)
    return [_make_record(parameter_file.name, spring, *point) for point in working_points]


def _make_record(
    record_name: str,
    joint_spring: BoltedJointSpring,
    preload: float,
    bending_moment: float,
    temperature: float,
) -> ModelicaRecord:
    """Make the Modelica record of a bolted joint at one working point."""
    tight = combine_nodes_to_spring(
        joint_spring, joint_spring.preload_at_temperature(preload, temperature), bending_moment
    )
    rest = joint_spring.evaluate(
        preload, bending_moment, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), temperature=temperature
    )
    values = format_parameter_values(
        {
            "preload": preload,
            "moment": bending_moment,
            "temperature": temperature,
            "mass": joint_spring.joint.mass,
            "bolts": float(joint_spring.joint.n_bolts * joint_spring.joint.bolt_stiffness),
            "plastic_damping": joint_spring.joint.plastic_damping,
            "memory": joint_spring.joint.memory,
            "damping": joint_spring.joint.damping,
            "mu": joint_spring.joint.mu,
        }
    ) | format_computed_values(
        {
            "tight": tight.preload_contact_force,
            "shear": tight.shear_stiffness_ratio,
            "eta_t": float(rest["eta_t"]),
        }
    )
    force = f"{preload / 1e3:g} kN"
    warm = "" if temperature == TIGHTENING_TEMPERATURE else f" {temperature:g} K"
    return ModelicaRecord(
        record_name=make_identifier(
            f"{record_name} {force}" + (f" {bending_moment:g} Nm" if bending_moment else "") + warm
        ),
        record_title=f"{record_name}, {force} per bolt"
        + (f" and {bending_moment:g} N m" if bending_moment else "")
        + (f" at{warm}" if warm else ""),
        interpolation_table=tight.force_table,
        value_expressions=values
        | {
            "heights": format_matrix(tight.slider_pair_boundaries),
            "sliders": format_matrix(_round_columns(tight.slider_properties)),
            "eta_n": format_matrix(tight.dissipation_factor_table),
            "bolt_forces": "{"
            + ", ".join(format_double_literal(F, COMPUTED_DIGITS) for F in tight.bolt_forces)
            + "}",
        },
        error_note="; where the force is below the one at tightening, relative to that",
    )


def _round_columns(slider_columns: Array) -> Array:
    """Round each column to COMPUTED_DIGITS digits of its largest number.

    Stiffnesses and friction limits of sliders are differences: the last digits of small ones are round-off.
    """
    decimals = COMPUTED_DIGITS - 1 - np.floor(np.log10(slider_columns.max(axis=0))).astype(int)
    return np.column_stack(
        [np.round(column, n) for column, n in zip(slider_columns.T, decimals, strict=True)]
    )


MODELICA_COMPONENT = ModelicaComponent(
    component_name="BoltedJoint",
    base_record="BoltedJoint",
    default_working_points=DEFAULT_WORKING_POINTS,
    make_records=_make_records,
    flange_names=("flange_x", "flange_y", "flange_z"),
    make_template_texts=lambda joint: {
        "damping_tolerance": f"{DISSIPATION_FACTOR_TOLERANCE:g}",
        "strongest": f"{MAX_TABULATED_OVER_TIGHTENING_FORCE:g}",
        "spread": f"{UNIFORM_DISTRIBUTION_DEVIATION:.15g}",
        "sliders": f"{2 * (PRELOADED_SLIDER_PAIR_COUNT + len(FULL_CONTACT_OVER_TIGHTENING_FORCES))}",
    },
)
"""Modelica component of the bolted joint."""
