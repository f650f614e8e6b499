within JointStiffness.Data;
record HarmonicDrive "A harmonic drive"
  extends Modelica.Icons.Record;
  parameter Real ratio "speed ratio of wave generator and output; negative: they turn in opposite senses; not 0";
  parameter Modelica.Units.SI.RotationalDampingConstant d(min=0) "viscous damping at the output";
  parameter Modelica.Units.SI.RotationalSpringConstant K_FTS0(min=0) "stiffness K_FTS of circular spline and flexspline";
  parameter Modelica.Units.SI.Torque friction(min=0) "Friction of its hysteresis; 0: none";
  parameter Modelica.Units.SI.RotationalSpringConstant stick(min=0) "Stiffness of its sliders while all of them stick";
  parameter Modelica.Units.SI.Angle error_1=0 "kinematic error at the output, amplitude, one period per turn of the wave generator";
  parameter Modelica.Units.SI.Angle error_1_phase=0 "phase of error_1 at phi1 = 0";
  parameter Modelica.Units.SI.Angle error_2=0 "the same with two periods per turn";
  parameter Modelica.Units.SI.Angle error_2_phase=0 "phase of error_2 at phi1 = 0";
  parameter Modelica.Units.SI.Angle error_4=0 "the same with four periods per turn";
  parameter Modelica.Units.SI.Angle error_4_phase=0 "phase of error_4 at phi1 = 0";
  parameter Real sliders[:, 2] "Stiffness over stick and friction over friction of each slider";
  parameter Real table[:, 5]
    "Wind-up at the output [rad], torque [N.m], stiffness [N.m/rad], its derivative before and after [N.m/rad2]";
end HarmonicDrive;
