within JointStiffness.Data;
record HarmonicDrive "A harmonic drive"
  extends Modelica.Icons.Record;
  parameter Real ratio(min=Modelica.Constants.small) "<< meta.ratio >>";
  parameter Modelica.Units.SI.RotationalDampingConstant d(min=0) "<< meta.d >>";
  parameter Modelica.Units.SI.RotationalSpringConstant K_FTS0(min=0) "<< meta.K_FTS0 >>";
  parameter Real table[:, 5]
    "Wind-up at the output [rad], torque [N.m], stiffness [N.m/rad], its derivative before and after [N.m/rad2]";
end HarmonicDrive;
