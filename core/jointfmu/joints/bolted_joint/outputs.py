"""Outputs of the bolted joint, from sums over points, patches and bolts."""

from collections.abc import Mapping, Sequence

import numpy as np

from ...contact.laws import mindlin
from ...mechanics.footprint.distribution import FrictionPatches, PressureDistribution
from ...mechanics.sliders import Foundation
from ...mechanics.stable_steps import STABLE_STEP_OUTPUTS, largest_stable_steps
from ...quantity import Array, Number, select
from .bolts import BoltSprings
from .compliances import condense_stiffness
from .equilibrium import JointAssembly, TrialState
from .friction import directional_stiffness, unit_displacements
from .law import AnyBoltedJoint

CONTACT_SUM_NAMES = (
    "tightened", "tightened_x", "tightened_y",
    "normal", "normal_x", "normal_y",
    "normal_stiffness", "normal_about_x", "normal_about_y",
    "pressure", "stiffness", "stiffness_x", "stiffness_y", "about_x", "about_y", "about_xy",
    "plastic", "elastic",
    "traction_x", "traction_y", "torsion",
    "shear_stiffness_x", "shear_stiffness_y", "torsional_stiffness",
    "loss", "loop_work", "loop_energy",
    "stretch", "stretch_x", "stretch_y",
)  # fmt: skip
"""Names of the sums over the contact, weighted with the shares in the area.

tightened                  : [Pa] pressure at tightening; _x, _y: times x and y [N/m]
normal                     : [Pa] normal traction, with the term by shear; _x, _y: times x and y [N/m]
normal_stiffness           : [Pa/m] its derivative with respect to the approach; _about_x, _about_y: times y^2
                             and x^2 [N/m]
pressure, stiffness        : [Pa], [Pa/m] of the normal law; _x, _y, about_*: times x, y, y^2, x^2, x y
plastic, elastic           : [J] work of first loading of the whole area
traction_x, _y, torsion    : [Pa] shear traction against the displacement; its moment [N/m] about the normal
shear_stiffness_x, _y      : [Pa/m] derivatives of traction_x and traction_y with respect to s_x and s_y
torsional_stiffness        : [N/m] derivative of torsion with respect to theta_z
loss                       : [J/m2] energy dissipated by friction
loop_work, loop_energy     : [J/m2] loss of a cycle with the present amplitude, and elastic energy at its end
stretch                    : [m] elongation of all bolts by the modes, plus gaps under their heads; _x, _y:
                             times x and y [m2]

Rigid members: normal_stiffness and normal_about_* are without the stiffness of bolts that have lifted off.
Elastic members: they and the shear and torsional stiffness are for the complete joint, without the stiffness
of all bolts between rigid members.
"""
_TRACTION_SUM_NAMES, _SHEAR_STIFFNESS_SUM_NAMES = (
    ("traction_x", "traction_y", "torsion"),
    ("shear_stiffness_x", "shear_stiffness_y", "torsional_stiffness"),
)
_ELONGATION_SUM_NAMES = CONTACT_SUM_NAMES[-3:]
"""Names of the sums over the bolts: elongation by the modes, and its first moments."""


def first_moments(
    contact_points: PressureDistribution, sum_name: str, point_values: Array
) -> dict[str, Number]:
    """Area-weighted sum of the values (n) of the points, and its first moments in x and y."""
    each = contact_points.area_share * point_values
    return {
        sum_name: np.sum(each),
        f"{sum_name}_x": each @ contact_points.position[:, 0],
        f"{sum_name}_y": each @ contact_points.position[:, 1],
    }


def second_moments(
    contact_points: PressureDistribution, sum_name_prefix: str, point_values: Array
) -> dict[str, Number]:
    """Area-weighted second moments of the values (n) of the points, about x (times y^2) and y (times x^2)."""
    each = contact_points.area_share * point_values
    x, y = contact_points.position.T
    return {f"{sum_name_prefix}about_x": each @ y**2, f"{sum_name_prefix}about_y": each @ x**2}


def sum_normal_tractions(
    contact_points: PressureDistribution,
    pressure: Array,
    contact_stiffness: Array,
    shear_induced_pressure: Number = 0.0,
    shear_induced_stiffness: Number = 0.0,
) -> dict[str, Number]:
    """Area-weighted sums and moments of pressure (n) [Pa] and normal stiffness (n) [Pa/m] of the points.

    shear_induced_pressure, shear_induced_stiffness : terms of the pressure and of the stiffness due to shear
    """
    p, k = pressure, contact_stiffness
    x, y = contact_points.position.T
    return {
        **first_moments(contact_points, "normal", p + shear_induced_pressure),
        "normal_stiffness": contact_points.area_share @ (k + shear_induced_stiffness),
        **second_moments(contact_points, "normal_", k + shear_induced_stiffness),
        "pressure": contact_points.area_share @ p,
        **first_moments(contact_points, "stiffness", k),
        **second_moments(contact_points, "", k),
        "about_xy": (contact_points.area_share * k) @ (x * y),
    }


def sum_friction_tractions(
    patches: FrictionPatches,
    friction_traction: Array,
    friction_tangent: Sequence[Number],
    friction_loss: Number,
) -> dict[str, Number]:
    """Area-weighted sums {name: value} of the friction of the patches: tractions (m, 3) [Pa], tangent, loss.

    friction_tangent, friction_loss : (3) [Pa/m] and [J/m2] sums over the patches
    """
    sums = [
        patches.area_share @ np.sum(friction_traction * unit, axis=1) for unit in unit_displacements(patches)
    ]
    named = [
        *zip(_TRACTION_SUM_NAMES, sums, strict=True),
        *zip(_SHEAR_STIFFNESS_SUM_NAMES, friction_tangent, strict=True),
    ]
    return {**dict(named), "loss": friction_loss}


def sum_tangential_stiffness(patches: FrictionPatches, friction_tangent: Array) -> list[Number]:
    """Tangential stiffness per area for s_x, s_y [Pa/m] and theta_z [Pa.m], from tangents (m, 6) [Pa/m]."""
    return [
        patches.area_share @ directional_stiffness(friction_tangent, unit)
        for unit in unit_displacements(patches)
    ]


def sum_cycle_energies(
    slider_foundation: Foundation, area_share: Array, patch_approach: Array, displacement_amplitude: Array
) -> dict[str, Number]:
    """Energy loss and elastic energy per area [J/m2] of friction cycles, summed over the patches.

    patch_approach, displacement_amplitude : (m) [m] of the patches, see `Foundation.cycle_energies`
    """
    loss, stored = slider_foundation.cycle_energies(patch_approach, displacement_amplitude)
    return {"loop_work": area_share @ loss, "loop_energy": area_share @ stored}


def correct_sums_for_lifted_heads(
    bolt_springs: BoltSprings,
    nominal_area: float,
    bolt_elongation: Array,
    bolt_force: Array,
    contact_sums: Mapping[str, Number],
) -> dict[str, Number]:
    """Correct sums over contact and bolts of a joint with rigid members for bolt heads that lift off.

    Returns the corrected sums: gaps under the heads for the bolt elongation, and the normal stiffness without
    the bolts that have lifted off.

    bolt_elongation : (b) [m] since tightening
    bolt_force : (b) [N] at tightening
    """
    gap = bolt_springs.bolts_per_position * bolt_springs.head_gap(bolt_force, bolt_elongation)
    inactive_stiffness = bolt_springs.bolts_per_position * (
        bolt_springs.stiffness - bolt_springs.active_stiffness(bolt_force, bolt_elongation)
    )
    x, y = bolt_springs.position.T
    return {
        **dict(zip(_ELONGATION_SUM_NAMES, [np.sum(gap), gap @ x, gap @ y], strict=True)),
        "normal_stiffness": contact_sums["normal_stiffness"] - np.sum(inactive_stiffness) / nominal_area,
        "normal_about_x": contact_sums["normal_about_x"] - (inactive_stiffness @ y**2) / nominal_area,
        "normal_about_y": contact_sums["normal_about_y"] - (inactive_stiffness @ x**2) / nominal_area,
    }


def elastic_member_sums(
    joint_parameters: AnyBoltedJoint,
    assembly: JointAssembly,
    trial_state: TrialState,
    bolt_force: Array,
    loop_energy: Number,
) -> dict[str, Number]:
    """Sums of the complete joint, which replace sums of the interface if the members are elastic.

    The sums are the stiffness, the bolt elongation and the elastic energy.

    bolt_force  : (b) [N] at tightening
    loop_energy : [J/m2] of the friction patches
    """
    area, modes, bolts, elongation = (
        joint_parameters.A_0,
        assembly.modes,
        assembly.bolts,
        trial_state.elongation,
    )
    bolt_stiffness = joint_parameters.n_bolts * joint_parameters.bolt_stiffness
    _, _, x2, y2, _ = joint_parameters.pattern.bolt_position_means
    gap, active_bolt_stiffness = (
        bolts.head_gap(bolt_force, elongation),
        bolts.active_stiffness(bolt_force, elongation),
    )
    H = assembly.tangent_stiffness(
        trial_state.normal_state.stiffness,
        trial_state.friction_update.slider_update.tangent,
        active_bolt_stiffness,
    )
    K = np.maximum(np.diag(condense_stiffness(H)), 0.0)
    elongation_with_gap = modes.bolt_elongation @ trial_state.modal_coordinates + gap
    elastic = joint_parameters.bolt_stiffness * (
        elongation @ elongation
    ) - joint_parameters.bolt_stiffness * (gap @ gap)
    energy = 0.5 * (modes.modal_stiffness @ trial_state.modal_coordinates**2 + elastic)
    return {
        **dict(
            zip(
                _ELONGATION_SUM_NAMES,
                [np.sum(elongation_with_gap), *(elongation_with_gap @ bolts.position)],
                strict=True,
            )
        ),
        "shear_stiffness_x": K[0] / area,
        "shear_stiffness_y": K[1] / area,
        "normal_stiffness": (K[2] - bolt_stiffness) / area,
        "normal_about_x": (K[3] - bolt_stiffness * y2) / area,
        "normal_about_y": (K[4] - bolt_stiffness * x2) / area,
        "torsional_stiffness": K[5] / area,
        "loop_energy": loop_energy + energy / area,
    }


def bolt_force_name(bolt_index: int) -> str:
    """Name of the output for the force of a bolt; `bolt_index` counts from 0."""
    return f"F_bolt[{bolt_index + 1}]"


def joint_outputs(
    joint_parameters: AnyBoltedJoint,
    contact_sums: Mapping[str, Number],
    relative_displacement: Sequence[Number],
    relative_rotation: Sequence[Number],
    motion_rates: Sequence[Number],
    p_max: Number,
) -> dict[str, Number]:
    """Outputs {name: value} of the joint, from the sums over the contact named in CONTACT_SUM_NAMES.

    relative_displacement, relative_rotation : s_rel (3) [m] and theta (3) [rad] of side 2
    motion_rates           : v_rel and omega (6) [m/s, rad/s]
    p_max                  : largest pressure [Pa]

    A rotation about an in-plane axis moves a point along the normal, a rotation about the normal moves it in
    the plane: Hu 2023, Eq. 45, corrected. The bolts act in parallel with the interface and only pull, see
    `BoltSprings`.
    """
    area, rho = joint_parameters.A_0, joint_parameters.shear_stiffness_ratio()
    bolts = joint_parameters.n_bolts * joint_parameters.bolt_stiffness
    _, _, bolt_x2, bolt_y2, _ = joint_parameters.pattern.bolt_position_means
    K_n = area * contact_sums["stiffness"]
    eta_n, eta_t = contact_sums["plastic"] / contact_sums["elastic"], joint_parameters.loss_factor()
    first_loading = mindlin.equivalent_damping(eta_n, joint_parameters.mass, K_n)
    C_n = select(joint_parameters.plastic_damping, first_loading, 0.0 * K_n)
    C_t = mindlin.equivalent_damping(eta_t, joint_parameters.mass, rho * K_n)
    viscous = [
        select(joint_parameters.damping, part, 0.0 * part)
        for part in _damping_forces(area, contact_sums, C_t, C_n, motion_rates)
    ]
    tension = _bolt_forces_and_moments(
        bolts, joint_parameters.pattern.bolt_position_means, relative_displacement[2], relative_rotation
    )
    stretch_force = [joint_parameters.bolt_stiffness * contact_sums[name] for name in _ELONGATION_SUM_NAMES]
    f_x, f_y, m_z = (-area * contact_sums[name] for name in ("traction_x", "traction_y", "torsion"))
    eta_loop = _ratio_or_zero(contact_sums["loop_work"], 2.0 * np.pi * contact_sums["loop_energy"])
    K_zz = np.maximum(area * contact_sums["normal_stiffness"] + bolts, 0.0)  # not below by round-off
    K = [area * contact_sums["shear_stiffness_x"], area * contact_sums["shear_stiffness_y"], K_zz]
    damped = [select(joint_parameters.damping, part, 0.0 * part) for part in (C_t, C_t, C_n)]
    steps = [largest_stable_steps(k, c, 1.0 / joint_parameters.mass) for k, c in zip(K, damped, strict=True)]
    shortest = {
        name: np.minimum(np.minimum(x, y), z)
        for (name, _), x, y, z in zip(STABLE_STEP_OUTPUTS, *steps, strict=True)
    }
    return {
        "f_x": f_x + viscous[0],
        "f_y": f_y + viscous[1],
        "f_z": area * (contact_sums["normal"] - contact_sums["tightened"])
        + tension[0]
        + viscous[2]
        - stretch_force[0],
        "m_x": area * (contact_sums["normal_y"] - contact_sums["tightened_y"])
        + tension[1]
        + viscous[3]
        - stretch_force[2],
        "m_y": -area * (contact_sums["normal_x"] - contact_sums["tightened_x"])
        + tension[2]
        + viscous[4]
        + stretch_force[1],
        "m_z": m_z + viscous[5],
        "K_xx": K[0],
        "K_yy": K[1],
        "K_zz": K[2],
        "C_xx": C_t,
        "C_yy": C_t,
        "C_zz": C_n,
        "eta_t": eta_t,
        "eta_n": eta_n,
        "K_rx": np.maximum(area * contact_sums["normal_about_x"] + bolts * bolt_y2, 0.0),
        "K_ry": np.maximum(area * contact_sums["normal_about_y"] + bolts * bolt_x2, 0.0),
        "K_rz": area * contact_sums["torsional_stiffness"],
        "p_mean": contact_sums["pressure"],
        "p_max": p_max,
        "slip": _friction_utilization(contact_sums, joint_parameters.mu),
        "E_loss": area * contact_sums["loss"],
        "eta_loop": eta_loop,
        "C_loop": mindlin.equivalent_damping(
            eta_loop, joint_parameters.mass, K[0] if joint_parameters.has_elastic_members else rho * K_n
        ),
        **shortest,
    }


def _bolt_forces_and_moments(
    bolt_stiffness: Number, position_means: Sequence[Number], s_z: Number, relative_rotation: Sequence[Number]
) -> tuple[Number, Number, Number]:
    """Forces f_z, m_x, m_y [N, N.m] of bolts without gaps, each elongated by s_z + theta_x y - theta_y x.

    bolt_stiffness : [N/m] of all bolts
    position_means : means of their x, y [m], x^2, y^2, x y [m2]
    """
    x, y, x2, y2, xy = position_means
    return (
        -bolt_stiffness * (s_z + y * relative_rotation[0] - x * relative_rotation[1]),
        -bolt_stiffness * (y * s_z + y2 * relative_rotation[0] - xy * relative_rotation[1]),
        bolt_stiffness * (x * s_z + xy * relative_rotation[0] - x2 * relative_rotation[1]),
    )


def _ratio_or_zero(numerator: Number, denominator: Number) -> Number:
    """Ratio of numerator and denominator; 0 if the denominator is not positive."""
    some = denominator > 0.0
    return select(some, numerator / select(some, denominator, 1.0), 0.0 * numerator)


def _friction_utilization(contact_sums: Mapping[str, Number], mu: Number) -> Number:
    """Friction utilization [1]: shear force over the friction limit."""
    square = contact_sums["traction_x"] ** 2 + contact_sums["traction_y"] ** 2
    shears = square > 0.0
    return _ratio_or_zero(
        select(shears, np.sqrt(select(shears, square, 1.0)), 0.0 * square), mu * contact_sums["pressure"]
    )


def _damping_forces(
    nominal_area: Number,
    contact_sums: Mapping[str, Number],
    tangential_damping: Number,
    normal_damping: Number,
    motion_rates: Sequence[Number],
) -> list[Number]:
    """Forces and moments (6) [N, N.m] of dashpots, distributed over the contact like its stiffness.

    tangential_damping, normal_damping : C_t, C_n [N.s/m] of the complete contact
    motion_rates                       : (6) velocities [m/s] and angular velocities [rad/s] of side 2
    """
    v_x, v_y, v_z, w_x, w_y, w_z = motion_rates
    K, K_x, K_y = (contact_sums[name] for name in ("stiffness", "stiffness_x", "stiffness_y"))
    K_yy, K_xx, K_xy = (contact_sums[name] for name in ("about_x", "about_y", "about_xy"))
    t, n = -_ratio_or_zero(tangential_damping, K), -_ratio_or_zero(normal_damping, K)
    return [
        t * (K * v_x - K_y * w_z),
        t * (K * v_y + K_x * w_z),
        n * (K * v_z + K_y * w_x - K_x * w_y),
        n * (K_y * v_z + K_yy * w_x - K_xy * w_y),
        -n * (K_x * v_z + K_xy * w_x - K_xx * w_y),
        t * (K_x * v_y - K_y * v_x + (K_xx + K_yy) * w_z),
    ]
