within JointStiffness.Data;
record HarmonicDrive "A harmonic drive"
  extends Modelica.Icons.Record;
  parameter Real ratio(min=Modelica.Constants.small) "speed ratio of wave generator and output";
  parameter Modelica.Units.SI.RotationalDampingConstant d(min=0) "viscous damping at the output";
  parameter Modelica.Units.SI.RotationalSpringConstant K_FTS0(min=0) "stiffness K_FTS of circular spline and flexspline";
  parameter Modelica.Units.SI.Torque friction(min=0) "Friction of its hysteresis; 0: none";
  parameter Modelica.Units.SI.RotationalSpringConstant stick(min=0) "Stiffness of its sliders while all of them stick";
  parameter Real sliders[:, 2] "Stiffness over stick and friction over friction of each slider";
  parameter Real table[:, 5]
    "Wind-up at the output [rad], torque [N.m], stiffness [N.m/rad], its derivative before and after [N.m/rad2]";
end HarmonicDrive;
