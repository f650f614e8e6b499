"""Friction of a drive's motor as MuJoCo 4's passive `dcmotor`: bristles, LuGre, Canudas de Wit et al. (1995).

    friction = k z + c dz/dt,  dz/dt = w - k |w| z / g(w),  g(w) = dry + (static - dry) exp(-(w/w_s)^2)

w is the motor's speed. From rest it is static (1 - exp(-angle/presliding)), as the FMU's, and so is every
steady sliding; after a reversal it is Dahl's branch where the FMU has Masing's. Unlike `frictionloss` it is
no constraint: nothing is solved. MuJoCo moves z by an explicit step, which an undamped bristle does not
bear: c and the viscous friction damp it critically on the motor's inertia, and k is at most what one step of
that inertia bears. What is beyond the static friction is cut off, or damped bristles would hold a turning
motor; so at speed friction is there at once, presliding or not. The integrator RK4 does not bear them at all.
"""

from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np

from .transmission import Transmission

PASSIVE = 16
"""mjINPUT_NONE, a `dcmotor` that has no control."""


def numbers(drive: Transmission, inertia: float, step: float) -> tuple[float, float, float, float, float]:
    """The attribute `lugre` for a motor's inertia [kg.m2] and a time step [s]: stiffness [N.m/rad], damping
    [N.m.s/rad], dry and static friction [N.m] and Stribeck's speed [rad/s].
    """
    stiffness = min(drive.static / drive.presliding, inertia / step**2)
    damping = max(2.0 * float(np.sqrt(stiffness * inertia)) - drive.viscous, 0.0)
    return stiffness, damping, drive.dry, drive.static, drive.stribeck_speed


def presliding(drive: Transmission, inertia: float, step: float) -> float:
    """Angle [rad] of the motor over which its friction builds up to 1 - 1/e: the drive's, or more."""
    return drive.static / numbers(drive, inertia, step)[0]


def borne(option: Any) -> bool:
    """Whether the integrator of MuJoCo's options bears them."""
    import mujoco

    return bool(option.integrator != mujoco.mjtIntegrator.mjINT_RK4)


def element(drive: Transmission, joint: str, inertia: float, step: float) -> str:
    """The same as MJCF, a child of `<actuator>`."""
    lugre = " ".join(f"{number:.9g}" for number in numbers(drive, inertia, step))
    return (
        f'<dcmotor name="friction" joint={quoteattr(joint)} input="none" resistance="1" motorconst="0 0" '
        f'saturation="{drive.static:.9g} 0 0" lugre="{lugre}"/>'
    )


def add(spec: Any, drive: Transmission, joint: str, inertia: float, step: float) -> None:
    """Let the joint of a motor in MuJoCo's MjSpec have the dry friction of its drive."""
    import mujoco

    actuator = spec.add_actuator(name=f"{joint}_friction", target=joint, trntype=mujoco.mjtTrn.mjTRN_JOINT)
    actuator.set_to_dcmotor(
        motorconst=[0.0, 0.0],
        resistance=1.0,
        saturation=[drive.static, 0.0, 0.0],
        lugre=numbers(drive, inertia, step),
        ctrlspec=PASSIVE,
    )
