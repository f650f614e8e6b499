"""Motor friction of a drive as a passive `dcmotor` of MuJoCo 4: LuGre model, Canudas de Wit et al. (1995).

    friction = k z + c dz/dt,  dz/dt = w - k |w| z / g(w),  g(w) = dry + (static - dry) exp(-(w/w_s)^2)

w is the speed of the motor [rad/s], z the bristle deflection [rad]. From rest the friction torque is
static (1 - exp(-angle/presliding)). This and steady sliding are as in the FMU. After a reversal the torque
follows Dahl's branch, in the FMU Masing's. Unlike `frictionloss` it is a passive force without a constraint.

MuJoCo takes friction and w from the start of a step h. So the bristle is unstable without damping, and with
too much of it. c and the viscous friction damp it critically with the inertia J of the motor, up to J/(f h).
Here f = 1 + static/dry is the largest dz/dt over w, after a reversal: the torque of the damping never
reverses w in one step. k is at most half of this damping over h. So friction at speed acts almost at once,
without presliding. With the integrator RK4 the bristles are unstable.
"""

from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np

from .transmission import Transmission

NO_CONTROL_INPUT_TYPE = 16
"""mjINPUT_NONE of MuJoCo: a `dcmotor` without control input."""


def compute_lugre_parameters(
    drive: Transmission, motor_inertia: float, time_step: float
) -> tuple[float, float, float, float, float]:
    """LuGre parameters of the motor friction in MuJoCo, for a motor inertia [kg.m2] and a time step [s].

    Returns stiffness [N.m/rad] and damping [N.m.s/rad] of the bristles, Coulomb and static friction [N.m],
    Stribeck speed [rad/s].
    """
    max_damping = motor_inertia / (_max_bristle_speed_ratio(drive) * time_step)
    stiffness = min(drive.static_friction / drive.presliding_angle, max_damping / (2.0 * time_step))
    damping = min(2.0 * float(np.sqrt(stiffness * motor_inertia)), max_damping)
    damping = max(damping - drive.viscous_friction, 0.0)
    return stiffness, damping, drive.dry_friction, drive.static_friction, drive.stribeck_speed


def _max_bristle_speed_ratio(drive: Transmission) -> float:
    """Largest ratio [1] of the bristle speed dz/dt to the motor speed w, after a reversal of w.

    Without Coulomb friction there is no bound; the result is then that without Stribeck effect.
    """
    return 1.0 + (drive.static_friction / drive.dry_friction if drive.dry_friction else 1.0)


def compute_max_damping(drive: Transmission, motor_inertia: float, time_step: float) -> float:
    """Largest ratio [N.m.s/rad] of the velocity-dependent friction torque to the motor speed, in MuJoCo."""
    _, damping, *_ = compute_lugre_parameters(drive, motor_inertia, time_step)
    return _max_bristle_speed_ratio(drive) * damping + drive.viscous_friction


def compute_presliding_angle(drive: Transmission, motor_inertia: float, time_step: float) -> float:
    """Motor angle [rad] at which the LuGre friction in MuJoCo reaches 1 - 1/e of its limit.

    The angle is at least that of the drive: a stable time step limits the stiffness of the bristles.
    """
    return drive.static_friction / compute_lugre_parameters(drive, motor_inertia, time_step)[0]


def is_integrator_stable(simulation_options: Any) -> bool:
    """Whether the integrator in MuJoCo's options is stable with the LuGre friction (bristles) of a motor."""
    import mujoco

    return bool(simulation_options.integrator != mujoco.mjtIntegrator.mjINT_RK4)


def format_friction(
    drive: Transmission, motor_joint_name: str, motor_inertia: float, time_step: float
) -> str:
    """MJCF element of the motor friction, a child of `<actuator>`."""
    lugre = " ".join(f"{number:.9g}" for number in compute_lugre_parameters(drive, motor_inertia, time_step))
    return (
        f'<dcmotor name="friction" joint={quoteattr(motor_joint_name)} input="none" resistance="1" '
        f'motorconst="0 0" saturation="{drive.static_friction:.9g} 0 0" lugre="{lugre}"/>'
    )


def add_friction(
    robot_spec: Any, drive: Transmission, motor_joint_name: str, motor_inertia: float, time_step: float
) -> None:
    """Add the dry friction of a drive to the motor joint of an MjSpec."""
    import mujoco

    actuator = robot_spec.add_actuator(
        name=f"{motor_joint_name}_friction", target=motor_joint_name, trntype=mujoco.mjtTrn.mjTRN_JOINT
    )
    actuator.set_to_dcmotor(
        motorconst=[0.0, 0.0],
        resistance=1.0,
        saturation=[drive.static_friction, 0.0, 0.0],
        lugre=compute_lugre_parameters(drive, motor_inertia, time_step),
        ctrlspec=NO_CONTROL_INPUT_TYPE,
    )
