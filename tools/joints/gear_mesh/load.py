"""Gear mesh under load: curves for other solvers, and pressure on the flanks of one tooth pair."""

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from jointfmu.joints.gear_mesh import KIND
from jointfmu.joints.gear_mesh.spring import MeshParameters, tabulate_tooth_pair
from jointfmu.mechanics.curve import Curve, tabulate_approach

from ...common.pressure import FLANK_PRESSURE_MODEL, uniform_pressure
from ...exchange.export.exports import JointExports, LoadCurveExport
from .involute import working_force

if TYPE_CHECKING:
    from ...exchange.export.tables import LoadTable


def _contact_curve(mesh_parameters: MeshParameters) -> tuple[Curve, Sequence[str]]:
    """Contact law of the flanks: pressure [Pa] as a function of the approach [m]."""
    return tabulate_approach(mesh_parameters), (
        "the flanks only; the deflection of the teeth is added to it",
    )


def _load_table(mesh_parameters: MeshParameters, _working_point: None, max_table_error: float) -> "LoadTable":
    """Table of the force [N] of a tooth pair as a function of its deflection [m], for other solvers."""
    from ...exchange.export.tables import LoadTable, tabulate_law

    pair, closing = tabulate_tooth_pair(mesh_parameters)
    i = int(np.argmin(np.abs(pair.displacement - closing)))
    columns = (pair.load, pair.stiffness, pair.stiffness_slope_start, pair.stiffness_slope_end)
    load, stiffness, start, end = (mesh_parameters.contact_ratio * column for column in columns)
    positive = tabulate_law(
        Curve(pair.displacement - pair.displacement[i], load, stiffness, start, end), max_table_error
    )
    rows = np.vstack([positive.table_rows[:0:-1] * [-1.0, -1.0, 1.0], positive.table_rows])
    return LoadTable(rows, positive.linear_interpolation_errors, positive.monotone_cubic_errors)


EXPORTS = JointExports(
    contact=_contact_curve,
    curve=LoadCurveExport(
        curve_meaning="force over deflection of the flanks beyond the backlash, mean over the mesh cycle",
        curve_variables=tuple(KIND.variables[name] for name in ("s_rel", "f", "K")),
        table_name="force",
        compute_table=_load_table,
    ),
)
"""Exports that the gear mesh offers."""


NOMINAL_PRESSURE = replace(
    FLANK_PRESSURE_MODEL,
    stated_load=working_force,
    mean_pressure=lambda mesh, force: uniform_pressure(mesh, force / mesh.contact_ratio),
    peak_pressure=uniform_pressure,
)
"""Nominal contact pressure of the flanks over the normal force of the mesh.

The mean number of pairs shares the force; the greatest pressure is that of one pair with the complete force.
"""
