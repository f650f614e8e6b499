"""Bolted joint in the Modelica library: one record for each working point (preload, moment, temperature)."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from jointfmu.joints.bolted_joint.joint import BoltedJointSpring
from jointfmu.joints.bolted_joint.law import TIGHTENING_TEMPERATURE
from jointfmu.mechanics.curve import Curve
from jointfmu.mechanics.footprint.reproducible import ROUND_OFF_OVER_LARGEST_NUMBER
from jointfmu.mechanics.sliders import UNIFORM_DEVIATION, Foundation
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
    format_matrix,
    format_number,
    format_parameter_values,
    make_identifier,
)

DAMPING_TOLERANCE = 1e-3
"""Largest relative error [1] of the linearly interpolated dissipation factor."""
MAX_CONTACT_OVER_TIGHTENING_FORCE = 10.0
"""Total contact force at the end of the table, over the contact force at tightening [1]."""
PRELOADED_SLIDER_PAIR_COUNT, FIRST_OVER_GROSS_SLIP_DISPLACEMENT = 12, 2e-3
"""Number of slider pairs in contact at tightening, and slip displacement of the first pair over displacement
of gross slip [1]. The slip displacements of the pairs form a geometric sequence."""
FULL_CONTACT_OVER_TIGHTENING_FORCES = (2.0, 5.0)
"""Normal forces over that at tightening [1] at which further pairs of sliders come into full contact.

They are on the compression side."""
_FORCE_SAMPLE_COUNT, _DAMPING_SAMPLE_COUNT = 800, 200
"""Sample points on either side of the tightened state: for the force, before decimation, and for the
damping."""


class CombinedSpring(NamedTuple):
    """Bolted joint at fixed preload and moment, with all nodes combined to one spring.

    force_table            : increase of the force [N] from the tightened state, over the approach from there
                             [m]
    damping_table          : rows (n, 2) of approach [m] and dissipation factor eta_n [1]
    shear_stiffness_ratio  : K_T/K_N [1]
    preload_contact_force  : normal force of the interface at tightening [N]
    slider_pair_boundaries : rows (n, 3) of approach [m], normal force [N] and stiffness [N/m]; the friction
                             springs between two rows are combined to one pair of sliders
    slider_properties      : rows (2 n - 2, 2) of stiffness [N/m] and friction limit [N] at tightening: first
                             the slider of each pair that slips earlier, then the other slider of each pair
    bolt_forces            : preload force (b) [N] at each bolt position, all bolts of a position together
    """

    force_table: InterpolationTable
    damping_table: Array
    shear_stiffness_ratio: float
    preload_contact_force: float
    slider_pair_boundaries: Array
    slider_properties: Array
    bolt_forces: Array


def combine_nodes(spring: BoltedJointSpring, preload: float, moment: float) -> CombinedSpring:
    """Combine all nodes of a joint to one spring, at a preload [N] per bolt and a moment [N.m].

    Side 2 is rigid and does not rotate. So all patches have the same tangential displacement and their curves
    add: friction follows, as for one patch, from the total force g(c) at the approach c = -s_z.
    """
    start = spring.checked_preloaded_approach(preload, moment)
    low, high = spring.curve.displacement[[0, -1]]
    area, share = spring.joint.A_0, spring.points.area_share

    def total_force(approach_change: Array) -> list[Array]:
        """Total contact force [N] at a change of the approach [m] from the tightened state."""
        approach = start + approach_change[:, None]
        approach[approach - low < ROUND_OFF_OVER_LARGEST_NUMBER * (high - low)] = (
            low  # nodes that just touch have no load
        )
        nodal = spring.curve.derivatives(approach, 2)
        return [area * (value @ share) for value in nodal]

    preload_force = total_force(np.zeros(1))[0][0]
    first, last = float(low - np.max(start)), float(high - np.max(start))
    compression = np.linspace(0.0, last, 200)
    end = float(
        np.interp(MAX_CONTACT_OVER_TIGHTENING_FORCE * preload_force, total_force(compression)[0], compression)
    )
    c = np.unique(
        np.concatenate(
            [np.linspace(first, 0.0, _FORCE_SAMPLE_COUNT), np.linspace(0.0, end, _FORCE_SAMPLE_COUNT)]
        )
    )
    load, stiffness, d2_load = total_force(c)
    curve = Curve(c, load, stiffness, d2_load[:-1], d2_load[1:])
    zero = int(np.searchsorted(c, 0.0))
    coarse = np.concatenate(
        [np.linspace(first, 0.0, _DAMPING_SAMPLE_COUNT), np.linspace(0.0, end, _DAMPING_SAMPLE_COUNT)[1:]]
    )
    eta = np.interp(c, coarse, _dissipation_factor(spring, start + coarse[:, None]))

    def is_dissipation_factor_linear(first_node: int, last_node: int) -> bool:
        """Whether eta_n between two nodes of the table is linear within DAMPING_TOLERANCE."""
        line = np.interp(
            c[first_node : last_node + 1], c[[first_node, last_node]], eta[[first_node, last_node]]
        )
        return bool(
            np.all(
                np.abs(line - eta[first_node : last_node + 1])
                <= DAMPING_TOLERANCE * eta[first_node : last_node + 1]
            )
        )

    table = decimate_curve(
        curve, reference_node=zero, fixed_nodes=(zero,), segment_fits=is_dissipation_factor_linear
    )
    damping = np.column_stack([table.rows[:, 0], np.interp(table.rows[:, 0], c, eta)])
    table.rows[:, 1] -= load[zero]
    levels = [np.interp(factor * preload_force, load, c) for factor in FULL_CONTACT_OVER_TIGHTENING_FORCES]
    heights = np.concatenate(
        [
            [first],
            first * np.geomspace(1.0, FIRST_OVER_GROSS_SLIP_DISPLACEMENT, PRELOADED_SLIDER_PAIR_COUNT)[1:],
            [0.0],
            levels,
        ]
    )
    force, normal, _ = total_force(heights)
    rows = np.column_stack([heights, force, normal])
    ratio = float(spring.joint.shear_stiffness_ratio())
    carried = Foundation(curve, ratio, spring.joint.mu, heights).slider_properties(0.0)
    sliders = np.column_stack(
        [np.concatenate([x[::2], x[1::2]]) for x in (carried.stiffness, carried.friction_limit)]
    )
    bolts = spring.bolts.bolts_per_position * spring.bolts.preload_force(spring.joint, preload, moment)
    return CombinedSpring(table, damping, ratio, preload_force, rows, sliders, bolts)


def _dissipation_factor(spring: BoltedJointSpring, approach: Array) -> Array:
    """Normal dissipation factor eta_n (m) [1], at nodal approaches (m, n) [m]."""
    plastic, elastic = spring.first_loading_work(spring.curve.derivatives(approach, 0)[0])
    return np.asarray((plastic @ spring.points.area_share) / (elastic @ spring.points.area_share))


WORKING_POINTS = tuple((*load, TIGHTENING_TEMPERATURE) for load in ((9e3, 0.0), (15e3, 0.0), (15e3, 4500.0)))
"""Working points of the default records: preload [N] per bolt and moment [N.m] from Zhao 2018, Table 3, and
temperature [K]."""


def _make_records(
    parameter_file: ParameterFile, working_points: Sequence[WorkingPoint]
) -> list[ModelicaRecord]:
    """Make the Modelica records of a parameter file, one for each working point."""
    spring = BoltedJointSpring.for_interface_nodes(parameter_file.values)
    return [_make_record(parameter_file.name, spring, *point) for point in working_points]


def _make_record(
    record_name: str, spring: BoltedJointSpring, preload: float, moment: float, temperature: float
) -> ModelicaRecord:
    """Make the Modelica record of a bolted joint at one working point."""
    tight = combine_nodes(spring, spring.preload_at_temperature(preload, temperature), moment)
    rest = spring.evaluate(preload, moment, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), temperature=temperature)
    values = format_parameter_values(
        {
            "preload": preload,
            "moment": moment,
            "temperature": temperature,
            "mass": spring.joint.mass,
            "bolts": float(spring.joint.n_bolts * spring.joint.bolt_stiffness),
            "plastic_damping": spring.joint.plastic_damping,
            "memory": spring.joint.memory,
            "damping": spring.joint.damping,
            "mu": spring.joint.mu,
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
        name=make_identifier(f"{record_name} {force}" + (f" {moment:g} Nm" if moment else "") + warm),
        title=f"{record_name}, {force} per bolt"
        + (f" and {moment:g} N m" if moment else "")
        + (f" at{warm}" if warm else ""),
        table=tight.force_table,
        values=values
        | {
            "heights": format_matrix(tight.slider_pair_boundaries),
            "sliders": format_matrix(_round_columns(tight.slider_properties)),
            "eta_n": format_matrix(tight.damping_table),
            "bolt_forces": "{"
            + ", ".join(format_number(F, COMPUTED_DIGITS) for F in tight.bolt_forces)
            + "}",
        },
        error_note="; where the force is below the one at tightening, relative to that",
    )


def _round_columns(sliders: Array) -> Array:
    """Round each column to COMPUTED_DIGITS digits of its largest number.

    Stiffnesses and friction limits of sliders are differences: the last digits of small ones are round-off.
    """
    decimals = COMPUTED_DIGITS - 1 - np.floor(np.log10(sliders.max(axis=0))).astype(int)
    return np.column_stack([np.round(column, n) for column, n in zip(sliders.T, decimals, strict=True)])


MODELICA_COMPONENT = ModelicaComponent(
    name="BoltedJoint",
    base_record="BoltedJoint",
    working_points=WORKING_POINTS,
    make_records=_make_records,
    flanges=("flange_x", "flange_y", "flange_z"),
    make_template_texts=lambda joint: {
        "damping_tolerance": f"{DAMPING_TOLERANCE:g}",
        "strongest": f"{MAX_CONTACT_OVER_TIGHTENING_FORCE:g}",
        "spread": f"{UNIFORM_DEVIATION:.15g}",
        "sliders": f"{2 * (PRELOADED_SLIDER_PAIR_COUNT + len(FULL_CONTACT_OVER_TIGHTENING_FORCES))}",
    },
)
"""Modelica component of the bolted joint."""
