"""What the bolted joint exports, from sums over its contact."""

from collections.abc import Mapping, Sequence

import numpy as np

from ...contact.laws import mindlin
from ...mechanics.steps import STABLE_STEP_OUTPUTS, largest_stable_steps
from ...quantity import Number, select
from .law import Bolted

SUMS = (
    "tightened", "tightened_x", "tightened_y",
    "normal", "normal_x", "normal_y",
    "normal_stiffness", "normal_about_x", "normal_about_y",
    "pressure", "stiffness", "stiffness_x", "stiffness_y", "about_x", "about_y", "about_xy",
    "plastic", "elastic",
    "traction_x", "traction_y", "torsion",
    "tangent_x", "tangent_y", "tangent_z",
    "loss", "loop_work", "loop_energy",
    "stretch", "stretch_x", "stretch_y",
)  # fmt: skip
"""Sums over the contact, times shares of the area.

tightened                  : [Pa] pressure at tightening; _x, _y: times x and y [N/m]
normal                     : [Pa] normal traction now, with what shear adds; _x, _y: times x and y
normal_stiffness           : [Pa/m] its derivative in the approach; _about_x, _about_y: times y^2 and x^2
pressure, stiffness        : [Pa, Pa/m] of the normal law; _x, _y, about_*: times x, y, y^2, x^2, x y
plastic, elastic           : [J] works of first loading of the whole area
traction_x, _y, torsion    : [Pa] shear traction against the shift, and its moment [N/m] about the normal
tangent_x, _y, _z          : [Pa/m] derivatives of these in the shift along x, along y and the turn
loss                       : [J/m2] turned into heat by friction so far
loop_work, loop_energy     : [J/m2] loss of a cycle at the present amplitude, and elastic energy at its end
stretch                    : [m] elongation of all bolts by the modes of elastic sides, and the gaps under
                             their heads; _x, _y: times x and y

normal_stiffness and normal_about_* lack what bolts that lifted off have between rigid sides. With elastic
sides they and tangent_* are those of the complete joint, less what all bolts have between rigid sides.
"""
STRETCHES = SUMS[-3:]


def bolt_force_name(bolt: int) -> str:
    """Name of the force of a bolt, counted from 0."""
    return f"F_bolt[{bolt + 1}]"


def joint_outputs(
    joint: Bolted,
    sums: Mapping[str, Number],
    displacement: Sequence[Number],
    rotation: Sequence[Number],
    rates: Sequence[Number],
    p_max: Number,
) -> dict[str, Number]:
    """Outputs from the SUMS at a shift s_rel [m] and small turn theta [rad] with rates v_rel and omega.

    A unit rotation about an in-plane axis moves a node along its normal, about the normal along the
    plane: Hu 2023, Eq. 45, corrected. The bolts act beside the interface, each at its place, and only pull:
    see `BoltSprings`.
    """
    area, rho = joint.A_0, joint.shear_ratio()
    bolts, (_, _, bolt_x2, bolt_y2, _) = joint.n_bolts * joint.bolt_stiffness, joint.pattern.bolt_means
    K_n = area * sums["stiffness"]
    eta_n, eta_t = sums["plastic"] / sums["elastic"], joint.loss_factor()
    first_loading = mindlin.equivalent_damping(eta_n, joint.mass, K_n)
    C_n = select(joint.plastic_damping, first_loading, 0.0 * K_n)
    C_t = mindlin.equivalent_damping(eta_t, joint.mass, rho * K_n)
    viscous = [select(joint.damping, part, 0.0 * part) for part in _viscous(area, sums, C_t, C_n, rates)]
    tension = _tension(bolts, joint.pattern.bolt_means, displacement[2], rotation)
    pulled = [joint.bolt_stiffness * sums[name] for name in STRETCHES]
    f_x, f_y, m_z = (-area * sums[name] for name in ("traction_x", "traction_y", "torsion"))
    eta_loop = _ratio(sums["loop_work"], 2.0 * np.pi * sums["loop_energy"])
    K_zz = np.maximum(area * sums["normal_stiffness"] + bolts, 0.0)  # not below by round-off
    K = [area * sums["tangent_x"], area * sums["tangent_y"], K_zz]
    damped = [select(joint.damping, part, 0.0 * part) for part in (C_t, C_t, C_n)]
    steps = [largest_stable_steps(k, c, 1.0 / joint.mass) for k, c in zip(K, damped, strict=True)]
    shortest = {
        name: np.minimum(np.minimum(x, y), z)
        for (name, _), x, y, z in zip(STABLE_STEP_OUTPUTS, *steps, strict=True)
    }
    return {
        "f_x": f_x + viscous[0],
        "f_y": f_y + viscous[1],
        "f_z": area * (sums["normal"] - sums["tightened"]) + tension[0] + viscous[2] - pulled[0],
        "m_x": area * (sums["normal_y"] - sums["tightened_y"]) + tension[1] + viscous[3] - pulled[2],
        "m_y": -area * (sums["normal_x"] - sums["tightened_x"]) + tension[2] + viscous[4] + pulled[1],
        "m_z": m_z + viscous[5],
        "K_xx": K[0],
        "K_yy": K[1],
        "K_zz": K[2],
        "C_xx": C_t,
        "C_yy": C_t,
        "C_zz": C_n,
        "eta_t": eta_t,
        "eta_n": eta_n,
        "K_rx": np.maximum(area * sums["normal_about_x"] + bolts * bolt_y2, 0.0),
        "K_ry": np.maximum(area * sums["normal_about_y"] + bolts * bolt_x2, 0.0),
        "K_rz": area * sums["tangent_z"],
        "p_mean": sums["pressure"],
        "p_max": p_max,
        "slip": _slip(sums, joint.mu),
        "E_loss": area * sums["loss"],
        "eta_loop": eta_loop,
        "C_loop": mindlin.equivalent_damping(eta_loop, joint.mass, K[0] if joint.elastic else rho * K_n),
        **shortest,
    }


def _tension(
    stiffness: Number, means: Sequence[Number], s_z: Number, rotation: Sequence[Number]
) -> tuple[Number, Number, Number]:
    """f_z, m_x, m_y [N, N.m] of bolts without gaps, each elongated by s_z + theta_x y - theta_y x.

    stiffness is the sum of theirs, means those of their x, y, x^2, y^2, x y.
    """
    x, y, x2, y2, xy = means
    return (
        -stiffness * (s_z + y * rotation[0] - x * rotation[1]),
        -stiffness * (y * s_z + y2 * rotation[0] - xy * rotation[1]),
        stiffness * (x * s_z + xy * rotation[0] - x2 * rotation[1]),
    )


def _ratio(numerator: Number, denominator: Number) -> Number:
    """part/whole [1], 0 of nothing."""
    some = denominator > 0.0
    return select(some, numerator / select(some, denominator, 1.0), 0.0 * numerator)


def _slip(sums: Mapping[str, Number], mu: Number) -> Number:
    """Shear force over its limit [1]."""
    square = sums["traction_x"] ** 2 + sums["traction_y"] ** 2
    shears = square > 0.0
    return _ratio(select(shears, np.sqrt(select(shears, square, 1.0)), 0.0 * square), mu * sums["pressure"])


def _viscous(
    area: Number, sums: Mapping[str, Number], C_t: Number, C_n: Number, rates: Sequence[Number]
) -> list[Number]:
    """Forces and moments [N, N.m] of dashpots that are shared out over the contact as the stiffness is."""
    v_x, v_y, v_z, w_x, w_y, w_z = rates
    K, K_x, K_y = (sums[name] for name in ("stiffness", "stiffness_x", "stiffness_y"))
    K_yy, K_xx, K_xy = (sums[name] for name in ("about_x", "about_y", "about_xy"))
    t, n = -_ratio(C_t, K), -_ratio(C_n, K)
    return [
        t * (K * v_x - K_y * w_z),
        t * (K * v_y + K_x * w_z),
        n * (K * v_z + K_y * w_x - K_x * w_y),
        n * (K_y * v_z + K_yy * w_x - K_xy * w_y),
        -n * (K_x * v_z + K_xy * w_x - K_xx * w_y),
        t * (K_x * v_y - K_y * v_x + (K_xx + K_yy) * w_z),
    ]
