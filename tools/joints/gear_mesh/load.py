"""Gear mesh under load: curves for other solvers, and pressure on the flanks of one tooth pair."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from jointfmu.joints.gear_mesh import KIND
from jointfmu.joints.gear_mesh.spring import Mesh, pair_curve
from jointfmu.mechanics.curve import Curve, approach_curve

from ...export.exports import Exports, LoadCurve
from ...pressure import FLANKS

if TYPE_CHECKING:
    from ...export.tables import LoadTable


def _contact(mesh: Mesh) -> tuple[Curve, Sequence[str]]:
    return approach_curve(mesh), ("the flanks alone; what the teeth give way comes on top",)


def _load(mesh: Mesh, _: None, error: float) -> "LoadTable":
    from ...export.tables import LoadTable, law_table

    pair, closing = pair_curve(mesh)
    i = int(np.argmin(np.abs(pair.displacement - closing)))
    columns = (pair.load, pair.stiffness, pair.bend_start, pair.bend_end)
    load, stiffness, start, end = (mesh.contact_ratio * column for column in columns)
    positive = law_table(Curve(pair.displacement - pair.displacement[i], load, stiffness, start, end), error)
    rows = np.vstack([positive.rows[:0:-1] * [-1.0, -1.0, 1.0], positive.rows])
    return LoadTable(rows, positive.straight, positive.monotone)


EXPORTS = Exports(
    contact=_contact,
    curve=LoadCurve(
        meaning="force over deflection of the flanks beyond the backlash, mean over the mesh cycle",
        columns=tuple(KIND.variables[name] for name in ("s_rel", "f", "K")),
        name="force",
        table=_load,
    ),
)


PRESSURE = FLANKS
