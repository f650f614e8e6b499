"""The gear mesh for many samples at once: K and f along a turn of wheel 1 from first touch.

Wheel 2 is held where the flanks touch at phi1 = 0, so that s_rel = r_b1 phi1 and no load lies in the
backlash. The pair's curve is that of `spring.pair_curve` over the nodes of `batch.approach`.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from jointfmu.joints.gear_mesh import KIND
from jointfmu.joints.gear_mesh.spring import GearMeshSpring, Mesh, in_series, pairs, phase
from jointfmu.quantity import Array

from ...batch.approach import Rows, columns, tabulate
from ...uncertainty.problem import Reduced

RAMP_END = 0.05
"""Default end of the ramp: part of the angle at which the teeth alone carry the end of the table [1]."""


def evaluate(
    parameters: type[Mesh], values: Mapping[str, object], loads: Array, factor: Array
) -> dict[str, Array]:
    """K [N/m] and f [N] (n, m) at the angles factor (n, 1) times loads (m) [rad], ascending.

    values : by structured name, numbers or samples (n)
    """
    mesh = columns(parameters, values, 1)
    angle = factor * loads
    cycle = phase(mesh, (angle, 0.0, held(mesh), 0.0))
    count, _ = pairs(mesh.contact_ratio, mesh.engagement, mesh.overlap_ratio, cycle)
    turned = loads > 0.0
    way = mesh.r_b1 * factor
    most = mesh.K_tooth * way * loads[-1] / mesh.A_0  # more than the pressure there
    pair = _pair(mesh, most)(np.log(loads[turned]), np.log(way))
    K, f = np.zeros((2, *angle.shape))
    K[:, turned], f[:, turned] = np.exp(pair["K"]), np.exp(pair["f"])
    return {"K": count * K, "f": count * f}


def _pair(mesh: Mesh, most: Array) -> Rows:
    """Logs of K and f of one pair over the log of its deflection, up to a pressure (n, 1) [Pa]."""
    rows, _ = tabulate(mesh, np.zeros_like(most), most)
    p, (k, growth), approach = rows.pressure, rows.values["k"], rows.values["s"][0]
    pressure, stiffness = np.exp(p), np.exp(k)
    bend = growth * stiffness**2 / pressure
    s, f, K, slope = in_series(mesh, np.exp(approach), pressure, stiffness, bend)
    return Rows(np.log(s), {"K": (np.log(K), slope * s / K), "f": (np.log(f), K * s / f)})


def held(mesh: Mesh) -> Any:
    """Angle of wheel 2 [rad] at which the driving flanks touch at phi1 = 0."""
    return 0.5 * mesh.backlash / mesh.r_b2


def table_end(mesh: Mesh) -> Any:
    """Angle [rad] at which the teeth alone carry the end of the table, the hardness on A_0; the flanks'
    approach comes on top.
    """
    return mesh.hardness * mesh.A_0 / (mesh.K_tooth * mesh.r_b1)


def exact(joint: Mesh, loads: Array) -> dict[str, Array]:
    """K and f (m) of the exported spring at angles (m) [rad]."""
    state = GearMeshSpring.of(joint).motion(loads, 0.0, held(joint), 0.0)
    return {name: state[name] for name in REDUCED.units}


REDUCED = Reduced(
    load=KIND.variables["phi1"],
    outputs=tuple(KIND.variables[name] for name in ("K", "f")),
    to=lambda mesh: RAMP_END * float(table_end(mesh)),
    most=table_end,
    evaluate=evaluate,
    exact=exact,
)
