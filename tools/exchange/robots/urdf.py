"""Export of a drive to URDF: joint, friction, mimic joint of the motor, transmission of ros2_control."""

from collections.abc import Iterator
from xml.sax.saxutils import quoteattr

from jointfmu_fmu_src.xml_parts import format_xml_comment

from jointfmu.version import __version__

from .transmission import Transmission, loop_area

RATED_MOTOR_SPEED = 209.44
"""Motor speed [rad/s] at which catalogues state the rated torque: 2000 rpm."""
NEGLIGIBLE_INERTIA_ELEMENT = (
    '<inertial><mass value="0.001"/><inertia ixx="1e-6" ixy="0" ixz="0" iyy="1e-6" iyz="0" izz="1e-6"/>'
    "</inertial>"
)
"""URDF element of a negligible inertia, which simulators require of every link."""


def format_urdf(drive: Transmission, fit_torque: float) -> tuple[str, None, list[str]]:
    """Format a drive as URDF: the text, None in place of fit errors, and texts on omitted effects.

    There are no fit errors because URDF has no springs.
    """
    torques, x = drive.compute_loop(fit_torque)
    has_hysteresis = bool(drive.compute_wind_up([fit_torque, 0.0])[1])
    lacks = [
        f"the wind-up, {x[: len(x) // 2].max():.4g} rad at {fit_torque:g} N.m",
        *(
            [f"the hysteresis, {abs(loop_area(x, torques)):.4g} J a loop at {fit_torque:g} N.m"]
            if has_hysteresis
            else []
        ),
        f"the damping of the wind-up, {drive.output_damping:.4g} N.m.s/rad",
        *_list_omitted_friction(drive),
        *drive.omitted_effects,
    ]
    about = [
        f"{drive.drive_name} as URDF, written by jointfmu {__version__}; not run in ROS",
        "friction of the motor is that of the joint, times the ratio and its square",
        "not included, because URDF has no springs:",
        *(f"  {line}" for line in lacks),
        "limits: largest torque of the drive; speed at 2000 rpm of the motor; the inertias are placeholders",
    ]
    return f'<?xml version="1.0"?>\n{format_xml_comment(about)}{_format_robot(drive)}', None, lacks


def _list_omitted_friction(drive: Transmission) -> Iterator[str]:
    """Texts on omitted friction effects: Stribeck effect and presliding."""
    if drive.static_friction > drive.dry_friction:
        difference, speed = drive.static_friction - drive.dry_friction, drive.stribeck_speed
        yield f"{difference:.4g} N.m more dry friction at the motor below {speed:g} rad/s"
    if drive.static_friction:
        yield f"presliding over {drive.presliding_angle:g} rad of the motor"


def _format_robot(drive: Transmission) -> str:
    """URDF element `robot` of a drive."""
    ratio, max_torque = abs(drive.ratio), drive.max_torque
    return f"""<robot name={quoteattr(drive.drive_name)}>
  <link name="base">{NEGLIGIBLE_INERTIA_ELEMENT}</link>
  <link name="output">{NEGLIGIBLE_INERTIA_ELEMENT}</link>
  <link name="rotor">{NEGLIGIBLE_INERTIA_ELEMENT}</link>
  <joint name="link" type="continuous">
    <parent link="base"/>
    <child link="output"/>
    <axis xyz="0 0 1"/>
    <limit effort="{max_torque:.9g}" velocity="{RATED_MOTOR_SPEED / ratio:.9g}"/>
    <dynamics damping="{drive.viscous_friction * ratio**2:.9g}" friction="{drive.dry_friction * ratio:.9g}"/>
  </joint>
  <joint name="motor" type="continuous">
    <parent link="base"/>
    <child link="rotor"/>
    <axis xyz="0 0 1"/>
    <limit effort="{max_torque / ratio:.9g}" velocity="{RATED_MOTOR_SPEED:.9g}"/>
    <mimic joint="link" multiplier="{drive.ratio:.9g}" offset="0"/>
  </joint>
  <ros2_control name="drive" type="actuator">
    <joint name="link">
      <command_interface name="effort"/>
      <state_interface name="position"/>
      <state_interface name="velocity"/>
    </joint>
    <transmission name="drive">
      <plugin>transmission_interface/SimpleTransmission</plugin>
      <actuator name="motor" role="actuator"/>
      <joint name="link" role="link">
        <mechanical_reduction>{drive.ratio:.9g}</mechanical_reduction>
      </joint>
    </transmission>
  </ros2_control>
</robot>
"""
