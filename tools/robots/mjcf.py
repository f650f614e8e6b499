"""Export of a drive to plain MJCF of MuJoCo 4: fixed tendons between the hinges of motor and link.

The length of each tendon is the wind-up, link - motor/ratio. One tendon has the elastic torque (linear and
cubic stiffness) and the damping. Parallel yielding springs (Jenkins elements) give the hysteresis. The dry
friction of the motor is that of `lugre_friction`; its viscous friction is the damping of its hinge.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from xml.sax.saxutils import quoteattr

import numpy as np
from jointfmu_fmu_src.xml_parts import comment

from jointfmu import __version__
from jointfmu.quantity import Array

from .bristles import element, presliding
from .fitted import FittedTendons, fit
from .transmission import RAMP, Transmission, area

LOCKED = 1e12
"""Armature [kg.m2] of hinges with prescribed motion, so large that no torque changes their speed."""
LEAD = 1e4
"""Duration [s] of a simulated loop: so slow that damping is negligible."""
STEP = 0.002
"""Time step [s] of the written file, MuJoCo's default."""
FREQUENCY = 60.0
"""Natural frequency [Hz] of the link in the written file, with locked motor; defines its inertia."""
WIND_UP = 0.03
"""Relative tolerance [1] of the wind-up at the largest fit torque."""
AREA = 0.05
"""Relative tolerance [1] of the area of the hysteresis loop."""


@dataclass(frozen=True, slots=True)
class Miss:
    """Relative errors of MuJoCo's drive against the FMU.

    wind_up : error of the wind-up [1] at the largest fit torque, for first loading
    area    : error of the area of the loop [1] between both signs of this torque; None without hysteresis
    """

    wind_up: float
    area: float | None

    def lines(self, torque: float) -> Iterator[str]:
        """Texts that compare the errors with their tolerances."""
        yield _verdict(f"wind-up at {torque:g} N.m", self.wind_up, WIND_UP)
        if self.area is None:
            yield "loop: none, the drive has no hysteresis"
        else:
            yield _verdict(f"area of the loop at {torque:g} N.m", self.area, AREA)


def _verdict(quantity: str, miss: float, tolerance: float) -> str:
    """Text that compares a relative error [1] with its tolerance [1]."""
    verdict = "within" if abs(miss) <= tolerance else "MISSED:"
    return f"{quantity}: {100.0 * miss:+.2f} % of the FMU's, {verdict} {100.0 * tolerance:g} %"


def tendons(drive: Transmission, spring: FittedTendons, name: str, motor: str, link: str) -> str:
    """MJCF of the tendons between the hinges of motor and link, children of `<tendon>`."""
    joints = (
        f'<joint joint={quoteattr(link)} coef="1"/>'
        f'<joint joint={quoteattr(motor)} coef="{-1.0 / drive.ratio:.17g}"/>'
    )
    elastic = f'stiffness="{spring.linear:.9g} 0 {spring.cubic:.9g}" damping="{drive.damping:.9g}"'
    springs = [(name, elastic)] + [
        (f"{name}_slider{i}", f'stiffness="{k:.9g}" springyield="{y:.9g}"')
        for i, (k, y) in enumerate(spring.sliders, 1)
    ]
    return "\n".join(
        f'    <fixed name={quoteattr(tendon)} springlength="0 0" {numbers}>{joints}</fixed>'
        for tendon, numbers in springs
    )


def _model(drive: Transmission, spring: FittedTendons, motor_inertia: float, link_inertia: float) -> str:
    """MJCF of motor, drive and link."""
    torque = drive.max_torque / abs(drive.ratio)
    friction = element(drive, "motor", motor_inertia, STEP) if drive.static else ""
    small = '<inertial pos="0 0 0" mass="0.001" diaginertia="1e-9 1e-9 1e-9"/>'
    return f"""<mujoco model={quoteattr(drive.name)}>
  <worldbody>
    <body name="motor">
      <joint name="motor" type="hinge" axis="0 0 1" armature="{motor_inertia:.9g}" \
damping="{drive.viscous:.9g}"/>
      {small}
    </body>
    <body name="link">
      <joint name="link" type="hinge" axis="0 0 1" armature="{link_inertia:.9g}"/>
      {small}
    </body>
  </worldbody>
  <tendon>
{tendons(drive, spring, "drive", "motor", "link")}
  </tendon>
  <actuator>
    <motor name="motor" joint="motor" forcerange="{-torque:.9g} {torque:.9g}"/>
    {friction}
  </actuator>
</mujoco>
"""


def drive_torque(drive: Transmission, spring: FittedTendons, wind_up: Array) -> Array:
    """Simulate the torques (n) [N.m] of the drive in MuJoCo along prescribed wind-ups (n) [rad] from rest.

    Raises ImportError without mujoco, ValueError if MuJoCo has no yielding springs.
    """
    import mujoco

    time_step = LEAD / len(wind_up)
    text = _model(drive, spring, LOCKED, LOCKED)
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


def compare_with_fmu(drive: Transmission, spring: FittedTendons) -> Miss:
    """Compare MuJoCo's drive with the FMU's law, along first loading to the largest fit torque and a loop."""
    torques, x = drive.loop(spring.torque)
    simulated = drive_torque(drive, spring, x)
    fmu_area, mujoco_area = area(x, torques), area(x, simulated)
    ramp = 1.2 * x[: RAMP + 1]
    wind_up = np.interp(spring.torque, drive_torque(drive, spring, ramp), ramp)
    return Miss(float(wind_up / x[RAMP] - 1.0), mujoco_area / fmu_area - 1.0 if spring.sliders else None)


def check_version() -> None:
    """Raise ValueError if MuJoCo has no yielding springs, ImportError if it is missing."""
    import mujoco

    if not hasattr(mujoco.MjModel, "tendon_springyield"):
        raise ValueError(f"mujoco {mujoco.__version__} has no springs that yield; expected 4.0 or newer")


def _about_friction(drive: Transmission, motor: float) -> Iterator[str]:
    """Comment lines on the motor friction of the written file."""
    angle = presliding(drive, motor, STEP)
    yield f"dry friction builds up over {angle:.3g} rad of the motor, {drive.presliding:g} rad in the FMU"
    yield "  and after a reversal it follows Dahl's model, not Masing's; the values are for this motor"
    yield f"  and steps up to {STEP:g} s, not for the integrator RK4"


def text(drive: Transmission, torque: float) -> tuple[str, Miss, list[str]]:
    """MJCF text of a drive fitted up to a torque [N.m], its errors in MuJoCo, and texts on omitted effects.

    Raises ImportError without mujoco.
    """
    import mujoco

    check_version()
    fitted = fit(drive, torque)
    miss = compare_with_fmu(drive, fitted)
    stiffness = fitted.linear + sum(k for k, _ in fitted.sliders)
    link = stiffness / (2.0 * np.pi * FREQUENCY) ** 2
    motor = link / drive.ratio**2
    about = [
        f"{drive.name} as plain MJCF, written by jointfmu {__version__}; MuJoCo 4.0 or newer, no plugin",
        f"torque = k x + k3 x^3 and {len(fitted.sliders)} springs that yield, x = link - motor/ratio, "
        f"by least squares up to {torque:g} N.m",
        f"measured in MuJoCo {mujoco.__version__} beside the FMU, motor locked:",
        *(f"  {line}" for line in miss.lines(torque)),
        f"beyond {torque:g} N.m the cubic continues; the table of the FMU ends at {drive.max_torque:g} N.m",
        f"the inertias are placeholders: the link has {FREQUENCY:g} Hz with locked "
        f"motor, the motor is as large",
        *(_about_friction(drive, motor) if drive.static else ()),
        "not included:" if drive.lacks else "all effects of the drive are included",
        *(f"  {line}" for line in drive.lacks),
    ]
    return f"{comment(about)}{_model(drive, fitted, motor, link)}", miss, [*drive.lacks]
