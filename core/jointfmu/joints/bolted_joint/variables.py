"""Inputs and outputs of the bolted joint's model."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ...contact.laws import mindlin
from ...mechanics.stable_steps import STABLE_STEP_OUTPUTS
from ...quantity import Array, Number, select
from ..model import EXTRAPOLATION_WARNING, LoadCycle, LoadRamp, Model, ValidityLimit, Variable, VariableValues
from .joint import BoltedJointSpring, JointInputs
from .law import (
    TIGHTENING_TEMPERATURE,
    AnyBoltedJoint,
    BoltedJointParameters,
    preload_at_temperature,
    working_preload,
)
from .outputs import bolt_force_name

MAX_FRICTION_UTILIZATION_WITHOUT_HISTORY = 0.5**0.5
"""Shear force over friction limit [1] at which, without history, a linear force would reach the limit."""
PERMISSIBLE_TEMPERATURES = 223.15, 423.15
"""Temperature range [K] without a warning, -50 to 150 degrees C: at 150 degrees C, Young's modulus is 7 %
lower for aluminium (EN 1999-1-2), and less for steel."""
_DEFAULT_RAMP_END_PRELOAD = 30e3
"""Preload at the end of the load ramp [N] if none is stated; larger if embedding takes over half of it."""
_DEFAULT_LOOP_PRELOAD = 9e3
"""Preload of the load cycle [N] if none is stated: preload of the published pressures. It is larger if
embedding takes more than half of it."""
_CONTACT_PRESSURE_INPUT_NAMES = ("preload", "moment", "temperature", "s_rel_z", "theta_x", "theta_y")
"""Names of the inputs that change the contact pressure."""
_INTERFACE_ONLY_OUTPUT_NAMES = ("C_xx", "C_yy", "C_zz", "eta_t", "eta_n")
"""Names of the outputs of the interface alone: damping and loss factors."""
_UNDAMPED_STEP_ADVICE = (
    "; 0 at the defaults, because C_zz = 0: then use model exchange, a sequential master or one FMU of the "
    "system (jointfmu system), or damp the body along z by a part of your own"
)
"""What to do where no step is stable for a parallel master."""
_INPUT_NAMES_WITHOUT_RATES = (*_CONTACT_PRESSURE_INPUT_NAMES, "s_rel_x", "s_rel_y", "theta_z")
"""Names of all inputs except the rates."""


def _read_vector(input_values: VariableValues, vector_name: str) -> tuple[float, float, float]:
    """Vector (3) of the inputs NAME_x, NAME_y and NAME_z."""
    return (
        input_values[f"{vector_name}_x"],
        input_values[f"{vector_name}_y"],
        input_values[f"{vector_name}_z"],
    )


def _advance_spring(
    joint_spring: BoltedJointSpring, input_values: VariableValues, history: Any
) -> tuple[Mapping[str, float], Any]:
    """Compute outputs and new history variables after a straight path to the inputs {name: value}."""
    q = np.array([*_read_vector(input_values, "s_rel"), *_read_vector(input_values, "theta")])
    rates = (*_read_vector(input_values, "v_rel"), *_read_vector(input_values, "omega"))
    return joint_spring.advance(
        JointInputs(input_values["preload"], input_values["moment"], q, rates, input_values["temperature"]),
        history,
    )


def _find_ramp_range(joint_spring: BoltedJointSpring, start_values: VariableValues) -> tuple[float, float]:
    """Start and end of the ramp of the preload [N]; it ends at the stated preload.

    Raises ValueError if the stated preload is not larger than its loss by embedding and temperature.
    """
    preload, joint, temperature = start_values["preload"], joint_spring.joint, start_values["temperature"]
    loss = joint.embedding - preload_at_temperature(joint, 0.0, temperature)
    if 0.0 < preload <= loss:
        warm = "" if temperature == TIGHTENING_TEMPERATURE else f" and temperature = {temperature:g} K"
        raise ValueError(
            f"preload = {preload:g} N is outside ({loss:g}, inf) N: embedding{warm} reduces it by {loss:g} "
            "N; increase preload or reduce embedding"
        )
    return 0.0, preload or max(_DEFAULT_RAMP_END_PRELOAD, 2.0 * loss)


def _max_row_moment(joint_parameters: Any, input_values: VariableValues) -> Number:
    """Largest moment [N.m] at which no bolt force of the two rows is negative."""
    preload = preload_at_temperature(joint_parameters, input_values["preload"], input_values["temperature"])
    return (
        working_preload(joint_parameters, preload)
        * joint_parameters.row_distance
        * joint_parameters.row_bolts
    )


def _loop_damping_scale(joint_parameters: Any, cycle: Mapping[str, Array]) -> dict[str, float]:
    """Scale of the round-off of C_loop = eta_loop sqrt(mass K): its value at stick.

    With elastic sides, K is K_xx. In gross slip, K_xx falls to the round-off of its value at stick, 2e-16 of
    it. The square root of this fraction is 1.5e-8.
    """
    return {
        "C_loop": float(
            mindlin.equivalent_damping(
                np.max(cycle["eta_loop"]), joint_parameters.mass, np.max(cycle["K_xx"])
            )
        )
    }


def _make_model_variant(fmu_model: Model, joint_parameters: AnyBoltedJoint) -> Model:
    """Model for a parameter set: it has a force output for each bolt, if the members are elastic.

    The preload of its load cycle is at least twice the preload that is lost by embedding.
    """
    assert fmu_model.load_cycle
    loop = replace(
        fmu_model.load_cycle,
        variable_values={"preload": max(_DEFAULT_LOOP_PRELOAD, 2.0 * joint_parameters.embedding)},
    )
    return _add_bolt_force_outputs(replace(fmu_model, load_cycle=loop), joint_parameters)


def _add_bolt_force_outputs(fmu_model: Model, joint_parameters: AnyBoltedJoint) -> Model:
    """Add the bolt forces to the outputs of a model, if the members are elastic.

    Then all outputs depend on all motions, except the viscous damping of the interface.
    """
    if not joint_parameters.has_elastic_members:
        return fmu_model
    meaning = (
        "force of bolt {}: preload at this temperature minus embedding, plus its shares of moment and load; "
        "0 after its head lifts off"
    )
    forces = [
        Variable(bolt_force_name(j), "N", meaning.format(j + 1), 1e4)
        for j in range(round(joint_parameters.n_bolts))
    ]
    inputs = _INPUT_NAMES_WITHOUT_RATES
    known = {
        name: (*inputs, *(v for v in given if v not in inputs))
        for name, given in fmu_model.dependencies.items()
    }
    dependencies = {**known, "eta_t": (), **{force.name: inputs for force in forces}}
    outputs = [
        replace(
            o, doc=f"{o.doc}{'; of the interface alone' if o.name in _INTERFACE_ONLY_OUTPUT_NAMES else ''}"
        )
        for o in fmu_model.outputs
    ]
    return replace(fmu_model, outputs=(*outputs, *forces), dependencies=dependencies)


MODELS = (
    Model(
        name="BoltedJoint",
        joint="bolted_joint",
        doc="Bolted joint under uneven pressure: motion in, force out",
        parameter_class=BoltedJointParameters,
        tabulate=BoltedJointSpring.from_joint,
        inputs=(
            Variable("preload", "N", "preload of each bolt (bolt force at tightening)", 1e4, minimum=0.0),
            Variable("moment", "N.m", "bending moment on the joint", 1e3),
            Variable(
                "s_rel_x", "m", "displacement of side 2 from the tightened state, along the bolt rows", 1e-6
            ),
            Variable(
                "s_rel_y", "m", "displacement of side 2 from the tightened state, across the bolt rows", 1e-6
            ),
            Variable(
                "s_rel_z",
                "m",
                "displacement of side 2 from the tightened state, along the normal, positive: sides separate",
                1e-6,
            ),
            Variable("v_rel_x", "m/s", "rate of s_rel_x", 1e-3),
            Variable("v_rel_y", "m/s", "rate of s_rel_y", 1e-3),
            Variable("v_rel_z", "m/s", "rate of s_rel_z", 1e-3),
            *(
                Variable(
                    f"theta_{a}",
                    "rad",
                    f"small rotation of side 2 about {a} through the joint's centre",
                    1e-5,
                )
                for a in "xyz"
            ),
            *(Variable(f"omega_{a}", "rad/s", f"rate of theta_{a}", 1e-2) for a in "xyz"),
            Variable(
                "temperature",
                "K",
                "temperature of bolts and members; tightened at 293.15 K",
                TIGHTENING_TEMPERATURE,
                minimum=0.0,
                start=TIGHTENING_TEMPERATURE,
            ),
        ),
        outputs=(
            Variable("f_x", "N", "restoring force on side 2 along x", 1e4),
            Variable("f_y", "N", "restoring force on side 2 along y", 1e4),
            Variable(
                "f_z",
                "N",
                "restoring force on side 2 along the normal, negative when the sides are pulled apart",
                1e4,
            ),
            Variable("m_x", "N.m", "restoring moment on side 2 about x through the joint's centre", 1e3),
            Variable("m_y", "N.m", "restoring moment on side 2 about y through the joint's centre", 1e3),
            Variable(
                "m_z", "N.m", "restoring moment on side 2 about the normal through the joint's centre", 1e3
            ),
            Variable("K_xx", "N/m", "tangential stiffness -df_x/ds_rel_x", 1e10),
            Variable("K_yy", "N/m", "tangential stiffness -df_y/ds_rel_y", 1e10),
            Variable("K_zz", "N/m", "normal stiffness -df_z/ds_rel_z", 1e10),
            Variable("C_xx", "N.s/m", "equivalent viscous damping along x", 1e4),
            Variable("C_yy", "N.s/m", "equivalent viscous damping along y", 1e4),
            Variable(
                "C_zz",
                "N.s/m",
                "equivalent viscous damping along the normal, zero without plastic_damping",
                1e4,
            ),
            Variable("eta_t", "1", "tangential dissipation factor"),
            Variable(
                "eta_n",
                "1",
                "ratio of plastic to elastic work in first loading; it causes damping only if "
                "plastic_damping = true",
            ),
            Variable("K_rx", "N.m/rad", "rotational stiffness -dm_x/dtheta_x", 1e8),
            Variable("K_ry", "N.m/rad", "rotational stiffness -dm_y/dtheta_y", 1e8),
            Variable("K_rz", "N.m/rad", "rotational stiffness -dm_z/dtheta_z", 1e8),
            Variable("p_mean", "Pa", "mean contact pressure", 1e6),
            Variable("p_max", "Pa", "largest contact pressure", 1e6),
            Variable("slip", "1", "friction utilization: shear force divided by (mu times normal force)"),
            Variable("E_loss", "J", "energy dissipated by friction since initialization", 1e-3),
            Variable(
                "eta_loop", "1", "loss factor of a load cycle whose amplitude is the present displacement"
            ),
            # nominal as of eta_loop = 1, whose round-off it has: sqrt(mass K)
            Variable("C_loop", "N.s/m", "equivalent viscous damping for eta_loop, as C_xx for eta_t", 1e6),
            *(
                Variable(name, "s", f"{doc}: smallest of x, y and z, with `mass` on the joint{advice}", 1e-4)
                for (name, doc), advice in zip(STABLE_STEP_OUTPUTS, ("", _UNDAMPED_STEP_ADVICE), strict=True)
            ),
        ),
        evaluate=lambda s, v: _advance_spring(s, v, s.initial_history())[0],
        initial_history=BoltedJointSpring.initial_history,
        advance=_advance_spring,
        validity_limits=(
            ValidityLimit(
                "moment",
                lambda j, end, v: (-_max_row_moment(j, v), _max_row_moment(j, v)),
                "a bolt force would be negative; the contact is open where its pressure would be negative",
            ),
            ValidityLimit("p_max", lambda j, end, v: (-math.inf, end[1]), EXTRAPOLATION_WARNING),
            ValidityLimit(
                "slip",
                lambda j, end, v: (
                    -math.inf,
                    select(j.memory, 2.0, MAX_FRICTION_UTILIZATION_WITHOUT_HISTORY),
                ),
                "the shear force exceeds the friction limit (zero if the joint is open); with memory = false "
                "the joint does not slip",
            ),
            ValidityLimit(
                "temperature",
                lambda j, end, v: PERMISSIBLE_TEMPERATURES,
                "Young's moduli and expansion coefficients are those at 20 degrees C; the unit is kelvin",
            ),
        ),
        ramp=LoadRamp("preload", _DEFAULT_RAMP_END_PRELOAD, 100.0, find_load_range=_find_ramp_range),
        load_cycle=LoadCycle("s_rel_x", 5e-6, {"preload": _DEFAULT_LOOP_PRELOAD}, _loop_damping_scale),
        dependencies={
            "f_x": (*_INPUT_NAMES_WITHOUT_RATES, "v_rel_x", "omega_z"),
            "f_y": (*_INPUT_NAMES_WITHOUT_RATES, "v_rel_y", "omega_z"),
            "m_z": (*_INPUT_NAMES_WITHOUT_RATES, "v_rel_x", "v_rel_y", "omega_z"),
            **dict.fromkeys(
                ("f_z", "m_x", "m_y"), (*_INPUT_NAMES_WITHOUT_RATES, "v_rel_z", "omega_x", "omega_y")
            ),
            **dict.fromkeys(
                ("K_xx", "K_yy", "K_rz", "slip", "E_loss", "eta_loop", "C_loop"), _INPUT_NAMES_WITHOUT_RATES
            ),
            **{name: _INPUT_NAMES_WITHOUT_RATES for name, _ in STABLE_STEP_OUTPUTS},
            **dict.fromkeys(("K_zz", "K_rx", "K_ry"), _INPUT_NAMES_WITHOUT_RATES),
            "eta_t": (),
            **dict.fromkeys(
                ("C_xx", "C_yy", "C_zz", "eta_n", "p_mean", "p_max"), _CONTACT_PRESSURE_INPUT_NAMES
            ),
        },
        fixed_parameters=("pattern", "plate", "field", "bodies"),
        make_variant=_make_model_variant,
    ),
)
