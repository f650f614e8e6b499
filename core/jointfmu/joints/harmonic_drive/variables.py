"""Models of the harmonic drive that are exported as FMUs, with their inputs and outputs."""

from ...mechanics.stable_steps import STABLE_STEP_OUTPUTS
from ...quantity.units import LUBRICANT_TEMPERATURE_RANGE
from ..model import EXTRAPOLATION_WARNING, LoadCycle, LoadRamp, Model, ValidityLimit, Variable, VariableValues
from .drive import FRICTION_HARMONICS, KINEMATIC_ERROR_HARMONICS
from .friction import REFERENCE_TEMPERATURE
from .law import HarmonicDriveParameters
from .spring import HarmonicDriveSpring

_OUTPUTS_OF_BOTH_MODELS = (
    Variable("K_WTS", "N.m/rad", "tangent stiffness dT/dphi of the midline at the present wind-up", 5e3),
    Variable("K_TS", "N.m/rad", "stiffness of the contact pair: 1/K_WTS = 1/K_FTS + 1/K_TS", 5e3),
    Variable("K_FTS", "N.m/rad", "stiffness of circular spline and flexspline", 2e4),
    Variable(
        "K_TS_pair",
        "N.m/rad",
        "K_TS divided by drive_scale (if the law has one): scale of Hu 2023, Fig. 11",
        1e3,
    ),
    Variable("p_max", "Pa", "peak contact pressure, at the major axis and the cup's opening", 1e8),
    Variable("E_loss", "J", "energy dissipated by hysteresis and dry friction since initialization", 1e-3),
)
"""Outputs that both models of the harmonic drive have."""

_ANGLE_INPUTS = ("phi1", "phi2")
"""Names of the inputs with the angles of the flanges."""
_FLANGE_MOTION_INPUTS = ("phi1", "w1", "phi2", "w2")
"""Names of the inputs with the angles and speeds of the flanges."""
_UNEXPOSED_PARAMETER_NAMES = ("max_torque", "shear_traction", "table")
"""Names of parameters that the FMUs do not expose."""
_LOAD_CYCLE_PARAMETER_VALUES = {"hysteresis_loss": 3e-4, "hysteresis_stiffness": 8e3}
"""Parameters of the load cycle: hysteresis of one arcmin; the default drive has no hysteresis."""
_LINEAR_SPEED_FACTORS = {"w2": "parameters"}
"""Inputs on which torques depend linearly, with a factor of the parameters alone, see `Model`."""
_KINEMATIC_ERROR_PARAMETERS = tuple(
    f"error_{n}{what}" for n in KINEMATIC_ERROR_HARMONICS for what in ("", "_phase")
)
"""Names of the parameters of the kinematic error."""
_FRICTION_PARAMETERS = (
    "friction_coulomb",
    "friction_stribeck",
    "stribeck_speed",
    "friction_viscous",
    "load_loss",
    "load_loss_back",
    *(f"friction_{n}{what}" for n in FRICTION_HARMONICS for what in ("", "_phase")),
)
"""Names of the parameters of the friction limit."""
_TEMPERATURE_PARAMETERS = (
    "temperature_factor",
    "viscous_temperature_coefficient",
    "dry_temperature_coefficient",
)
"""Names of the parameters by which friction depends on temperature."""
_SPRING_PARAMETERS = (
    *_FRICTION_PARAMETERS,
    "presliding",
    *_TEMPERATURE_PARAMETERS,
    *_KINEMATIC_ERROR_PARAMETERS,
    "inertia1",
    "inertia2",
)
"""Names of the parameters that only the model with motion as input has."""


def _flange_motion(input_values: VariableValues) -> tuple[float, ...]:
    """Angles and speeds phi1, w1, phi2, w2 of wave generator (1) and output (2), from {input: value}."""
    return tuple(input_values[name] for name in _FLANGE_MOTION_INPUTS)


MODELS = (
    Model(
        name="HarmonicDriveSpring",
        joint="harmonic_drive",
        doc="Torsional spring and damper of a harmonic drive: motion in, torque out",
        parameter_class=HarmonicDriveParameters,
        tabulate=HarmonicDriveSpring.tabulate,
        inputs=(
            Variable("phi1", "rad", "angle of the wave-generator (motor) flange"),
            Variable("w1", "rad/s", "speed of the wave-generator (motor) flange"),
            Variable("phi2", "rad", "angle of the output flange"),
            Variable("w2", "rad/s", "speed of the output flange"),
            Variable(
                "temperature",
                "K",
                "temperature of the lubricant",
                REFERENCE_TEMPERATURE,
                minimum=0.0,
                start=REFERENCE_TEMPERATURE,
            ),
        ),
        outputs=(
            Variable(
                "tau1", "N.m", "torque on flange 1, tau (1/ratio + dphi_error/dphi1) - tau_friction", 0.1
            ),
            Variable("tau2", "N.m", "torque on flange 2, -tau", 5.0),
            Variable("phi_rel", "rad", "wind-up at the output, phi2 - phi1/ratio - phi_error", 1e-3),
            Variable(
                "tau",
                "N.m",
                "output torque: midline T(phi_rel) + hysteresis friction T_h + d der(phi_rel)",
                5.0,
            ),
            *_OUTPUTS_OF_BOTH_MODELS,
            Variable(
                "tau_friction",
                "N.m",
                "friction torque at the wave generator, positive if it opposes positive rotation",
                0.01,
            ),
            Variable("phi_error", "rad", "kinematic error at the output, a function of phi1", 1e-4),
            *(
                Variable(name, "s", f"{doc}: with inertia1, inertia2, K_WTS, d", 1e-3)
                for name, doc in STABLE_STEP_OUTPUTS
            ),
        ),
        evaluate=lambda s, v: s.evaluate_motion(*_flange_motion(v), v["temperature"]),
        initial_history=lambda s: s.initial_history(),
        advance=lambda s, v, memory: s.advance_motion(_flange_motion(v), memory, v["temperature"]),
        validity_limits=(
            ValidityLimit("phi_rel", lambda j, end, v: (-end[0], end[0]), EXTRAPOLATION_WARNING),
            ValidityLimit(
                "temperature",
                lambda j, end, v: LUBRICANT_TEMPERATURE_RANGE,
                "outside the range of lubricants; the unit is kelvin",
            ),
        ),
        ramp=LoadRamp(
            "phi2", 1.5e-3, 3e-6, find_load_range=lambda s, v: (0.0, s.curve.inverse(s.joint.ramp_torque))
        ),
        load_cycle=LoadCycle("phi2", 1e-3, _LOAD_CYCLE_PARAMETER_VALUES),
        dependencies={
            "tau2": _FLANGE_MOTION_INPUTS,
            "phi_rel": _ANGLE_INPUTS,
            "tau": _FLANGE_MOTION_INPUTS,
            "K_WTS": _ANGLE_INPUTS,
            "K_TS": _ANGLE_INPUTS,
            "K_FTS": (),
            "K_TS_pair": _ANGLE_INPUTS,
            "p_max": _ANGLE_INPUTS,
            **{name: _ANGLE_INPUTS for name, _ in STABLE_STEP_OUTPUTS},
            "phi_error": ("phi1",),
        },
        linear_factors={
            "phi_rel": {"phi2": "constant"},
            "tau2": _LINEAR_SPEED_FACTORS,
            "tau": _LINEAR_SPEED_FACTORS,
        },
        fixed_parameters=_UNEXPOSED_PARAMETER_NAMES,
    ),
    Model(
        name="HarmonicDriveCompliance",
        joint="harmonic_drive",
        doc="Wind-up of a harmonic drive with the wave generator locked: torque in, motion out",
        parameter_class=HarmonicDriveParameters,
        tabulate=HarmonicDriveSpring.tabulate,
        inputs=(Variable("tau", "N.m", "torque at the output flange", 5.0),),
        outputs=(
            Variable("phi_rel", "rad", "wind-up at the output, phi(tau - T_h)", 1e-3),
            *_OUTPUTS_OF_BOTH_MODELS,
        ),
        evaluate=lambda s, v: s.evaluate_torque(v["tau"]),
        initial_history=lambda s: s.initial_history(),
        advance=lambda s, v, memory: s.advance_torque(v["tau"], memory),
        validity_limits=(ValidityLimit("tau", lambda j, end, v: (-end[1], end[1]), EXTRAPOLATION_WARNING),),
        ramp=LoadRamp("tau", 5.0, 0.01, find_load_range=lambda s, v: (0.0, s.joint.ramp_torque)),
        load_cycle=LoadCycle("tau", 5.0, _LOAD_CYCLE_PARAMETER_VALUES),
        dependencies={"K_FTS": ()},
        fixed_parameters=(*_UNEXPOSED_PARAMETER_NAMES, *_SPRING_PARAMETERS),
    ),
)
