within JointStiffness.Data;
record HarmonicDrive "A harmonic drive"
  extends Modelica.Icons.Record;
  parameter Real ratio "<< meta.ratio >>";
  parameter Modelica.Units.SI.RotationalDampingConstant d(min=0) "<< meta.d >>";
  parameter Modelica.Units.SI.RotationalSpringConstant K_FTS0(min=0) "<< meta.K_FTS0 >>";
  parameter Modelica.Units.SI.Torque rated_torque(min=0) "<< meta.rated_torque >>";
  parameter Modelica.Units.SI.Torque hysteresis_friction(min=0) "Friction of its hysteresis; 0: none";
  parameter Modelica.Units.SI.RotationalSpringConstant hysteresis_stiffness(min=0) "<< meta.hysteresis_stiffness.split(";")[0] >>";
  parameter Modelica.Units.SI.Torque friction_coulomb(min=0)=0 "<< meta.friction_coulomb >>";
  parameter Modelica.Units.SI.Torque friction_stribeck(min=0)=0 "<< meta.friction_stribeck >>";
  parameter Modelica.Units.SI.AngularVelocity stribeck_speed(min=Modelica.Constants.small)=10 "<< meta.stribeck_speed >>";
  parameter Modelica.Units.SI.RotationalDampingConstant friction_viscous(min=0)=0 "<< meta.friction_viscous >>";
  parameter Real load_loss(min=0, unit="1")=0 "<< meta.load_loss >>";
  parameter Real load_loss_back(unit="1")=-1 "<< meta.load_loss_back >>";
  parameter Modelica.Units.SI.Angle presliding(min=Modelica.Constants.small)=0.01 "<< meta.presliding >>";
  parameter Real temperature_factor(min=0, unit="1")=1 "<< meta.temperature_factor >>";
  parameter Modelica.Units.SI.LinearTemperatureCoefficient viscous_temperature_coefficient=0 "<< meta.viscous_temperature_coefficient.split(";")[0] >>";
  parameter Modelica.Units.SI.LinearTemperatureCoefficient dry_temperature_coefficient=0 "<< meta.dry_temperature_coefficient.split(";")[0] >>";
  parameter Modelica.Units.SI.Angle error_1=0 "<< meta.error_1 >>";
  parameter Modelica.Units.SI.Angle error_1_phase=0 "<< meta.error_1_phase >>";
  parameter Modelica.Units.SI.Angle error_2=0 "<< meta.error_2 >>";
  parameter Modelica.Units.SI.Angle error_2_phase=0 "<< meta.error_2_phase >>";
  parameter Modelica.Units.SI.Angle error_4=0 "<< meta.error_4 >>";
  parameter Modelica.Units.SI.Angle error_4_phase=0 "<< meta.error_4_phase >>";
  parameter Real sliders[:, 2] "Of each slider its stiffness over hysteresis_stiffness and its friction over hysteresis_friction";
  parameter Real table[:, 5]
    "Wind-up at the output [rad], torque [N.m], stiffness [N.m/rad], its derivative before and after [N.m/rad2]";
end HarmonicDrive;
