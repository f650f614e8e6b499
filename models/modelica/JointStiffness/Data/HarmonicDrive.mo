within JointStiffness.Data;
record HarmonicDrive "A harmonic drive"
  extends Modelica.Icons.Record;
  parameter Real ratio "speed ratio of wave generator and output; negative: they turn in opposite senses; not 0";
  parameter Modelica.Units.SI.RotationalDampingConstant d(min=0) "viscous damping at the output";
  parameter Modelica.Units.SI.RotationalSpringConstant K_FTS0(min=0) "stiffness K_FTS of circular spline and flexspline";
  parameter Modelica.Units.SI.Torque rated_torque(min=0) "rated torque";
  parameter Modelica.Units.SI.Torque hysteresis_friction(min=0) "Friction of its hysteresis; 0: none";
  parameter Modelica.Units.SI.RotationalSpringConstant hysteresis_stiffness(min=0) "extra stiffness of tiny motions, before friction slips";
  parameter Modelica.Units.SI.Torque friction_coulomb(min=0)=0 "dry friction at the wave generator";
  parameter Modelica.Units.SI.Torque friction_stribeck(min=0)=0 "further dry friction at rest, which speed takes away";
  parameter Modelica.Units.SI.AngularVelocity stribeck_speed(min=Modelica.Constants.small)=10 "speed of the wave generator that leaves 1/e of friction_stribeck";
  parameter Modelica.Units.SI.RotationalDampingConstant friction_viscous(min=0)=0 "friction at the wave generator over its speed";
  parameter Real load_loss(min=0, unit="1")=0 "dry friction at the wave generator over the torque transmitted to it";
  parameter Real load_loss_back(unit="1")=-1 "the same where the load drives the motor; negative: as load_loss";
  parameter Modelica.Units.SI.Angle presliding(min=Modelica.Constants.small)=0.01 "angle of the wave generator over which dry friction builds up to 1 - 1/e";
  parameter Real temperature_factor(min=0, unit="1")=1 "factor of all friction";
  parameter Modelica.Units.SI.LinearTemperatureCoefficient viscous_temperature_coefficient=0 "fall of friction_viscous per kelvin above 293.15 K, over its value";
  parameter Modelica.Units.SI.LinearTemperatureCoefficient dry_temperature_coefficient=0 "fall of dry friction per kelvin above 293.15 K, over its value";
  parameter Modelica.Units.SI.Angle error_1=0 "kinematic error at the output, amplitude, one period per turn of the wave generator";
  parameter Modelica.Units.SI.Angle error_1_phase=0 "phase of error_1 at phi1 = 0";
  parameter Modelica.Units.SI.Angle error_2=0 "the same with two periods per turn";
  parameter Modelica.Units.SI.Angle error_2_phase=0 "phase of error_2 at phi1 = 0";
  parameter Modelica.Units.SI.Angle error_4=0 "the same with four periods per turn";
  parameter Modelica.Units.SI.Angle error_4_phase=0 "phase of error_4 at phi1 = 0";
  parameter Real sliders[:, 2] "Of each slider its stiffness over hysteresis_stiffness and its friction over hysteresis_friction";
  parameter Real table[:, 5]
    "Wind-up at the output [rad], torque [N.m], stiffness [N.m/rad], its derivative before and after [N.m/rad2]";
end HarmonicDrive;
