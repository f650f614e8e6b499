"""Stiffness, damping, approach and slip of the bolted joint over its preload, for `jointfmu uncertainty`."""

from dataclasses import replace

import numpy as np

from jointfmu.joints.bolted_joint import KIND
from jointfmu.joints.bolted_joint.joint import BoltedJointSpring
from jointfmu.joints.bolted_joint.law import TIGHTENING_TEMPERATURE, slip_force
from jointfmu.joints.model import Variable
from jointfmu.quantity import Array

from ...studies.uncertainty.curves import DerivedOutput, JointSample, LoadCurves, spline_weights

INTERFACE_ONLY_PARAMETERS = {"sides": "rigid", "bolt_stiffness": 0.0, "memory": True}
"""Parameters of the interface alone: rigid members, no bolts in parallel, friction with slip."""
INTEGRATED_LOG_FORCE_RANGE, INTEGRATION_POINT_COUNT = 30.0, 41
"""Range of ln(force) below the end of the ramp, and number of points [1] of the integral of dF/K."""
LOOP_SHEAR_OVER_BOLT_FORCE = 0.05
"""Shear force of the loop over the force of all bolts [1]: half of mu = 0.1."""
MAX_SHEAR_OVER_SLIP_FORCE = 0.8
"""Largest shear force of the loop over the slip force [1]."""
LOOP_PRELOADS_OVER_RAMP_END_PRELOAD = np.geomspace(0.02, 1.0, 5)
"""Preloads at which loops are computed, over the end of the load ramp [1].

The loss factor is interpolated between them."""
AMPLITUDE_SEARCH_PRESSURE_EXPONENT = 12.0
"""Exponent N of the pressure p ~ approach^N [1] from which the search of the amplitude of a loop starts."""
MAX_NEWTON_ITERATIONS, RELATIVE_AMPLITUDE_TOLERANCE = 12, 1e-5
"""Limits of Newton's method for the amplitude of the loop [1]."""


def interface_approach(joint_sample: JointSample, preload: Array) -> Array:
    """Approach (m) [m] of the interface at m preloads [N] per bolt.

    The approach is the integral of dF/K_zz over the force F of all bolts; K_zz is the normal stiffness. Below
    the first preload, F/K_zz is taken as a power of F.
    """
    end = preload[-1]
    x = np.linspace(-INTEGRATED_LOG_FORCE_RANGE, 0.0, INTEGRATION_POINT_COUNT)
    force = joint_sample.parameter_set.n_bolts * end * np.exp(x)
    rate = (
        force / joint_sample.evaluate_outputs({"preload": end * np.exp(x)}, INTERFACE_ONLY_PARAMETERS)["K_zz"]
    )
    (exponent,) = spline_weights(x, x[:1], 1) @ np.log(rate)
    return np.asarray(rate[0] / exponent + spline_weights(x, np.log(preload / end), -1) @ rate)


def opening_load(joint_sample: JointSample, preload: Array) -> Array:
    """Force along z [N], at m preloads, that opens the interface at the most loaded bolt, by linear theory.

    The load factor (bolt load over external load) is that at the last preload: it hardly changes.
    """
    spring = BoltedJointSpring.from_joint(replace(joint_sample.parameter_set, embedding=0.0))
    return np.asarray(preload * spring.compliances(float(preload[-1])).opening_load(1.0))


def loss_factor(joint_sample: JointSample, preload: Array) -> Array:
    """Loss factor (m) [1] of shear loops of the interface at m preloads [N] per bolt.

    The amplitude of the shear force is LOOP_SHEAR_OVER_BOLT_FORCE of the force of all bolts.

    The FMU gives the loss factor of a loop with the present displacement as its amplitude. Newton's method
    finds the displacement at the shear force. It starts on a virgin curve with the same initial stiffness and
    friction limit, for a pressure p ~ approach^AMPLITUDE_SEARCH_PRESSURE_EXPONENT.
    """
    loads, parameters = preload[-1] * LOOP_PRELOADS_OVER_RAMP_END_PRELOAD, joint_sample.parameter_set
    limit = parameters.mu * parameters.n_bolts * loads
    shear = np.minimum(
        LOOP_SHEAR_OVER_BOLT_FORCE * parameters.n_bolts * loads, MAX_SHEAR_OVER_SLIP_FORCE * limit
    )
    stiffness = joint_sample.evaluate_outputs(
        {"preload": loads, "s_rel_x": np.zeros_like(loads)}, INTERFACE_ONLY_PARAMETERS
    )["K_xx"]
    start_ratio = AMPLITUDE_SEARCH_PRESSURE_EXPONENT * (
        1.0 - (1.0 - shear / limit) ** (1.0 / AMPLITUDE_SEARCH_PRESSURE_EXPONENT)
    )
    amplitude = start_ratio * limit / stiffness
    for _ in range(MAX_NEWTON_ITERATIONS):
        state = joint_sample.evaluate_outputs(
            {"preload": loads, "s_rel_x": amplitude}, INTERFACE_ONLY_PARAMETERS
        )
        step = (shear + state["f_x"]) / state["K_xx"]
        amplitude = amplitude + step
        if np.all(np.abs(step) <= RELATIVE_AMPLITUDE_TOLERANCE * amplitude):
            break
    relative = np.maximum(preload / preload[-1], LOOP_PRELOADS_OVER_RAMP_END_PRELOAD[0])
    return np.asarray(
        spline_weights(np.log(LOOP_PRELOADS_OVER_RAMP_END_PRELOAD), np.log(relative)) @ state["eta_loop"]
    )


UNCERTAINTY_CURVES = LoadCurves(
    fmu_name="BoltedJoint",
    ramped_input=replace(
        KIND.variables["preload"], doc="force of each bolt after embedding, at its temperature"
    ),
    outputs=tuple(
        KIND.variables[name] for name in ("K_zz", "K_xx", "K_yy", "K_rx", "K_ry", "K_rz", "C_zz", "C_xx")
    ),
    knot_count=17,
    derived_outputs=(
        DerivedOutput(
            Variable("approach", "m", "approach of the two sides by tightening, from zero preload", 1e-6),
            interface_approach,
        ),
        DerivedOutput(
            Variable("slip_force", "N", "shear force at which the whole interface slips", 1e4),
            lambda sample, preload: np.asarray(slip_force(sample.parameter_set, preload)),
        ),
        DerivedOutput(
            Variable("opening_load", "N", "force along z that opens the interface, by linear theory", 1e4),
            opening_load,
        ),
        DerivedOutput(
            Variable(
                "loss_factor",
                "1",
                f"of a loop under a shear of {LOOP_SHEAR_OVER_BOLT_FORCE:g} times the force of all bolts; "
                "jointfmu new prints it at another shear force",
                0.1,
            ),
            loss_factor,
        ),
    ),
    default_ramp_end=lambda joint: 30e3,
    max_load=lambda joint: joint.max_pressure * joint.A_0 / joint.n_bolts,
    lost_load=lambda joint: joint.embedding,
    fixed_inputs=lambda joint: {"temperature": TIGHTENING_TEMPERATURE},
    fixed_parameters={"embedding": 0.0},
)
"""Quantities of the bolted joint along its load ramp."""
