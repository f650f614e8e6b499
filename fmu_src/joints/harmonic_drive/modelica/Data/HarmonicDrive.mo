within JointStiffness.Data;
record HarmonicDrive "A harmonic drive"
  extends Modelica.Icons.Record;
  parameter Real ratio "<< meta.ratio >>";
  parameter Modelica.Units.SI.RotationalDampingConstant d(min=0) "<< meta.d >>";
  parameter Modelica.Units.SI.RotationalSpringConstant K_FTS0(min=0) "<< meta.K_FTS0 >>";
  parameter Modelica.Units.SI.Torque friction(min=0) "Friction of its hysteresis; 0: none";
  parameter Modelica.Units.SI.RotationalSpringConstant stick(min=0) "Stiffness of its sliders while all of them stick";
  parameter Modelica.Units.SI.Angle error_1=0 "<< meta.error_1 >>";
  parameter Modelica.Units.SI.Angle error_1_phase=0 "<< meta.error_1_phase >>";
  parameter Modelica.Units.SI.Angle error_2=0 "<< meta.error_2 >>";
  parameter Modelica.Units.SI.Angle error_2_phase=0 "<< meta.error_2_phase >>";
  parameter Modelica.Units.SI.Angle error_4=0 "<< meta.error_4 >>";
  parameter Modelica.Units.SI.Angle error_4_phase=0 "<< meta.error_4_phase >>";
  parameter Real sliders[:, 2] "Stiffness over stick and friction over friction of each slider";
  parameter Real table[:, 5]
    "Wind-up at the output [rad], torque [N.m], stiffness [N.m/rad], its derivative before and after [N.m/rad2]";
end HarmonicDrive;
