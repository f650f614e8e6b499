"""Export of a drive to plain MJCF of MuJoCo 4: fixed tendons between the hinges of motor and link.

The length of each tendon is the wind-up, link - motor/ratio. One tendon has the elastic torque (linear and
cubic stiffness) and the damping. Parallel yielding springs (Jenkins elements) give the hysteresis. The dry
friction of the motor is that of `bristles`; its viscous friction is the damping of its hinge.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from xml.sax.saxutils import quoteattr

import numpy as np
from jointfmu_fmu_src.xml_parts import format_xml_comment

from jointfmu.quantity import Array
from jointfmu.version import __version__

from .bristles import compute_presliding_angle, format_friction
from .rigid_joints import describe_drive
from .spring_fit import FittedSpring, fit_spring
from .transmission import RAMP_POINT_COUNT, Transmission, loop_area

PRESCRIBED_MOTION_ARMATURE = 1e12
"""Armature [kg.m2] of hinges with prescribed motion, so large that no torque changes their speed."""
LOOP_DURATION = 1e4
"""Duration [s] of a simulated loop: so slow that damping is negligible."""
MUJOCO_DEFAULT_TIME_STEP = 0.002
"""Time step [s] of the written file, MuJoCo's default."""
EXAMPLE_LINK_FREQUENCY = 60.0
"""Natural frequency [Hz] of the link in the written file, with locked motor; its inertia follows from it."""
WIND_UP_TOLERANCE = 0.03
"""Relative tolerance of the wind-up of a drive in MuJoCo [1], at the largest torque of the fit."""
LOOP_AREA_TOLERANCE = 0.05
"""Relative tolerance of the area of the hysteresis loop of a drive in MuJoCo [1]."""


@dataclass(frozen=True, slots=True)
class FitErrors:
    """Relative errors of a drive's spring in MuJoCo compared with the FMU.

    wind_up : error of the wind-up [1] at the largest fit torque, for first loading
    area    : error of the loop area [1], for the loop between plus and minus this torque; None without
              hysteresis
    """

    wind_up: float
    area: float | None

    def format_lines(self, fit_torque: float) -> Iterator[str]:
        """Lines of text that compare the errors of the drive in MuJoCo with their tolerances."""
        yield _compare_with_tolerance(f"wind-up at {fit_torque:g} N.m", self.wind_up, WIND_UP_TOLERANCE)
        if self.area is None:
            yield "loop: none, the drive has no hysteresis"
        else:
            yield _compare_with_tolerance(
                f"area of the loop at {fit_torque:g} N.m", self.area, LOOP_AREA_TOLERANCE
            )


def _compare_with_tolerance(quantity_text: str, relative_error: float, tolerance: float) -> str:
    """Text that compares a relative error [1] with its tolerance [1]."""
    verdict = "within" if abs(relative_error) <= tolerance else "MISSED:"
    return f"{quantity_text}: {100.0 * relative_error:+.2f} % of the FMU's, {verdict} {100.0 * tolerance:g} %"


def format_tendons(
    drive: Transmission,
    fitted_spring: FittedSpring,
    tendon_name: str,
    motor_joint_name: str,
    link_joint_name: str,
) -> str:
    """MJCF of the tendons between the hinges of motor and link, children of `<tendon>`."""
    joints = (
        f'<joint joint={quoteattr(link_joint_name)} coef="1"/>'
        f'<joint joint={quoteattr(motor_joint_name)} coef="{-1.0 / drive.ratio:.17g}"/>'
    )
    stiffness = f"{fitted_spring.linear_stiffness:.9g} 0 {fitted_spring.cubic_stiffness:.9g}"
    elastic = f'stiffness="{stiffness}" damping="{drive.output_damping:.9g}"'
    springs = [(tendon_name, elastic)] + [
        (f"{tendon_name}_slider{i}", f'stiffness="{k:.9g}" springyield="{y:.9g}"')
        for i, (k, y) in enumerate(fitted_spring.yielding_springs, 1)
    ]
    return "\n".join(
        f'    <fixed name={quoteattr(tendon)} springlength="0 0" {numbers}>{joints}</fixed>'
        for tendon, numbers in springs
    )


def _format_model(
    drive: Transmission, fitted_spring: FittedSpring, motor_inertia: float, link_inertia: float
) -> str:
    """MJCF of motor, drive and link."""
    torque = drive.max_torque / abs(drive.ratio)
    friction = (
        format_friction(drive, "motor", motor_inertia, MUJOCO_DEFAULT_TIME_STEP)
        if drive.static_friction
        else ""
    )
    small = '<inertial pos="0 0 0" mass="0.001" diaginertia="1e-9 1e-9 1e-9"/>'
    return f"""<mujoco model={quoteattr(drive.drive_name)}>
  <worldbody>
    <body name="motor">
      <joint name="motor" type="hinge" axis="0 0 1" armature="{motor_inertia:.9g}" \
damping="{drive.viscous_friction:.9g}"/>
      {small}
    </body>
    <body name="link">
      <joint name="link" type="hinge" axis="0 0 1" armature="{link_inertia:.9g}"/>
      {small}
    </body>
  </worldbody>
  <tendon>
{format_tendons(drive, fitted_spring, "drive", "motor", "link")}
  </tendon>
  <actuator>
    <motor name="motor" joint="motor" forcerange="{-torque:.9g} {torque:.9g}"/>
    {friction}
  </actuator>
</mujoco>
"""


def simulate_drive_torque(drive: Transmission, fitted_spring: FittedSpring, wind_up: Array) -> Array:
    """Simulate the torques (n) [N.m] of the drive in MuJoCo along prescribed wind-ups (n) [rad] from rest.

    Raises ImportError without mujoco, ValueError if MuJoCo has no attribute `springyield` of tendons.
    """
    import mujoco

    time_step = LOOP_DURATION / len(wind_up)
    text = _format_model(drive, fitted_spring, PRESCRIBED_MOTION_ARMATURE, PRESCRIBED_MOTION_ARMATURE)
    model = mujoco.MjModel.from_xml_string(text)
    model.opt.timestep, model.opt.gravity[:] = time_step, 0.0
    data, link = mujoco.MjData(model), model.joint("link").dofadr[0]
    torques = []
    for x, next_x in zip(wind_up, [*wind_up[1:], wind_up[-1]], strict=True):
        data.qpos[link], data.qvel[:] = x, 0.0
        data.qvel[link] = (next_x - x) / time_step
        mujoco.mj_forward(model, data)
        torques.append(-data.qfrc_passive[link])
        mujoco.mj_step(model, data)
    return np.array(torques)


def compare_with_fmu(drive: Transmission, fitted_spring: FittedSpring) -> FitErrors:
    """Compare MuJoCo's drive with the FMU's law, along first loading to the largest fit torque and a loop."""
    torques, x = drive.compute_loop(fitted_spring.max_torque)
    simulated = simulate_drive_torque(drive, fitted_spring, x)
    fmu_area, mujoco_area = loop_area(x, torques), loop_area(x, simulated)
    ramp = 1.2 * x[: RAMP_POINT_COUNT + 1]
    wind_up = np.interp(fitted_spring.max_torque, simulate_drive_torque(drive, fitted_spring, ramp), ramp)
    return FitErrors(
        float(wind_up / x[RAMP_POINT_COUNT] - 1.0),
        mujoco_area / fmu_area - 1.0 if fitted_spring.yielding_springs else None,
    )


def check_mujoco_version() -> None:
    """Raise ValueError if MuJoCo has no attribute `springyield` of tendons, ImportError if it is missing."""
    import mujoco

    if not hasattr(mujoco.MjModel, "tendon_springyield"):
        raise ValueError(
            f"mujoco {mujoco.__version__} has no springs that yield (springyield); expected 4.0 or newer"
        )


def _friction_comments(drive: Transmission, motor_inertia: float) -> Iterator[str]:
    """Comment lines on the motor friction of the written file."""
    angle = compute_presliding_angle(drive, motor_inertia, MUJOCO_DEFAULT_TIME_STEP)
    yield (
        f"dry friction builds up over {angle:.3g} rad of the motor, {drive.presliding_angle:g} rad in the FMU"
    )
    yield "  and after a reversal it follows Dahl's model, not Masing's; the values are for this motor"
    yield f"  and steps up to {MUJOCO_DEFAULT_TIME_STEP:g} s, not for the integrator RK4"


def format_mjcf(drive: Transmission, fit_torque: float) -> tuple[str, FitErrors, list[str]]:
    """MJCF text of a drive fitted up to a torque [N.m], its errors in MuJoCo, and texts on omitted effects.

    Raises ImportError without mujoco.
    """
    import mujoco

    check_mujoco_version()
    fitted = fit_spring(drive, fit_torque)
    miss = compare_with_fmu(drive, fitted)
    stiffness = fitted.linear_stiffness + sum(k for k, _ in fitted.yielding_springs)
    link = stiffness / (2.0 * np.pi * EXAMPLE_LINK_FREQUENCY) ** 2
    motor = link / drive.ratio**2
    about = [
        f"{drive.drive_name} as plain MJCF, written by jointfmu {__version__}; MuJoCo 4.0 or newer, "
        "no plugin",
        f"torque = k x + k3 x^3 and {len(fitted.yielding_springs)} springs that yield, x = link - "
        f"motor/ratio, by least squares up to {fit_torque:g} N.m",
        f"measured in MuJoCo {mujoco.__version__} beside the FMU, motor locked:",
        *(f"  {line}" for line in miss.format_lines(fit_torque)),
        f"beyond {fit_torque:g} N.m the cubic continues; the table of the FMU ends at "
        f"{drive.max_torque:g} N.m",
        f"the inertias are placeholders: the link has {EXAMPLE_LINK_FREQUENCY:g} Hz with locked motor, "
        "the motor is "
        "as large",
        *describe_drive(drive),
        *(_friction_comments(drive, motor) if drive.static_friction else ()),
        "not included:" if drive.omitted_effects else "all effects of the drive are included",
        *(f"  {line}" for line in drive.omitted_effects),
    ]
    return (
        f"{format_xml_comment(about)}{_format_model(drive, fitted, motor, link)}",
        miss,
        [*drive.omitted_effects],
    )
