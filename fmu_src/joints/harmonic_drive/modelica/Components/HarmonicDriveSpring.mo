within JointStiffness.Components;
model HarmonicDriveSpring "Torsional spring and damper of a harmonic drive between two flanges"
  parameter JointStiffness.Data.HarmonicDrive data = JointStiffness.Data.<< record >>() "The drive"
    annotation (choicesAllMatching=true);
  parameter Real ratio = data.ratio "<< meta.ratio >>";
  parameter Modelica.Units.SI.RotationalDampingConstant d(min=0) = data.d "<< meta.d >>";
  parameter Modelica.Units.SI.Torque friction(min=0) = data.friction "Friction of its hysteresis; 0: none";
  parameter Modelica.Units.SI.RotationalSpringConstant stick(min=0) = data.stick "Stiffness of its sliders while all of them stick";
  parameter Modelica.Units.SI.Angle error_1 = data.error_1 "<< meta.error_1 >>"
    annotation (Dialog(tab="Kinematic error"));
  parameter Modelica.Units.SI.Angle error_1_phase = data.error_1_phase "<< meta.error_1_phase >>"
    annotation (Dialog(tab="Kinematic error"));
  parameter Modelica.Units.SI.Angle error_2 = data.error_2 "<< meta.error_2 >>"
    annotation (Dialog(tab="Kinematic error"));
  parameter Modelica.Units.SI.Angle error_2_phase = data.error_2_phase "<< meta.error_2_phase >>"
    annotation (Dialog(tab="Kinematic error"));
  parameter Modelica.Units.SI.Angle error_4 = data.error_4 "<< meta.error_4 >>"
    annotation (Dialog(tab="Kinematic error"));
  parameter Modelica.Units.SI.Angle error_4_phase = data.error_4_phase "<< meta.error_4_phase >>"
    annotation (Dialog(tab="Kinematic error"));
  parameter Boolean use_damping = true "false: the wind-up follows the torque at once, for a drive without inertia and damping"
    annotation (Evaluate=true, Dialog(tab="Advanced"));
  parameter StateSelect stateSelect=StateSelect.prefer "Priority to use phi_rel and w_rel as states"
    annotation (HideResult=true, Dialog(tab="Advanced"));
  Modelica.Mechanics.Rotational.Interfaces.Flange_a flange_a "Wave generator (motor)"
    annotation (Placement(transformation(extent={{-110,-10},{-90,10}})));
  Modelica.Mechanics.Rotational.Interfaces.Flange_b flange_b "Output"
    annotation (Placement(transformation(extent={{90,-10},{110,10}})));
  Modelica.Units.SI.Angle phi_rel(start=0, nominal=1e-3, stateSelect=stateSelect)
    "<< docs.phi_rel >> (= flange_b.phi - flange_a.phi/ratio - phi_error)";
  Modelica.Units.SI.Angle phi_error(nominal=1e-4) "<< docs.phi_error >>";
  Modelica.Units.SI.AngularVelocity w_rel(start=0, nominal=1, stateSelect=stateSelect) "Rate of the wind-up; 0 with use_damping=false";
  Modelica.Units.SI.Torque tau_c(nominal=5) "Torque of the spring";
  Modelica.Units.SI.Torque tau_h(nominal=0.1) "Torque of the hysteresis";
  Modelica.Units.SI.Torque tau(nominal=5) "Torque at the output (= flange_b.tau)";
  Modelica.Units.SI.RotationalSpringConstant K_WTS(nominal=5e3) "<< docs.K_WTS >>";
  Modelica.Units.SI.RotationalSpringConstant K_TS(nominal=5e3) "<< docs.K_TS >>";
  Modelica.Units.SI.Power lossPower "Power dissipated by damper and friction";
protected
  constant Real layer=1e-3 "Width over friction of the layer beyond it in which a slider ceases to stick";
  parameter Integer n=size(data.sliders, 1) "Sliders";
  parameter Real K_h[n]=stick*data.sliders[:, 1] "Their stiffness [N.m/rad]";
  parameter Real M_h[n]=friction*data.sliders[:, 2] "Their friction [N.m]";
  Real q[n](each start=0, each fixed=true, each nominal=0.01) "Their torques [N.m]";
  Real rate[n] "Their rates [N.m/s]";
  Real errorSlope "Derivative of phi_error in flange_a.phi";
  Real windUp "Absolute value of the wind-up";
equation
  assert(ratio < 0 or ratio > 0, "ratio = 0: it may be negative, not zero");
  phi_error = error_1*sin(flange_a.phi + error_1_phase) + error_2*sin(2*flange_a.phi + error_2_phase) + error_4*sin(4*flange_a.phi + error_4_phase);
  errorSlope = error_1*cos(flange_a.phi + error_1_phase) + 2*error_2*cos(2*flange_a.phi + error_2_phase) + 4*error_4*cos(4*flange_a.phi + error_4_phase);
  phi_rel = flange_b.phi - flange_a.phi/ratio - phi_error;
  if use_damping then
    w_rel = der(phi_rel);
    tau = tau_c + tau_h + d*w_rel;
  else
    w_rel = 0;
    tau = tau_c + tau_h;
  end if;
  for i in 1:n loop
    // a spring each, that follows the wind-up until its friction holds no more
    rate[i] = noEvent(if abs(q[i]) > M_h[i] and q[i]*w_rel > 0 then K_h[i]*w_rel*max(1 - (abs(q[i]) - M_h[i])/(layer*M_h[i] + 1e-12), 0) else K_h[i]*w_rel);
    der(q[i]) = rate[i];
  end for;
  tau_h = sum(noEvent(min(max(q[i], -M_h[i]), M_h[i])) for i in 1:n);
  windUp = noEvent(if phi_rel < 0 then -phi_rel else phi_rel);
  tau_c = noEvent(if phi_rel < 0 then -1 else 1)*JointStiffness.Functions.load(windUp, data.table);
  K_WTS = JointStiffness.Functions.stiffness(windUp, data.table);
  K_TS = 1/(1/K_WTS - 1/data.K_FTS0);
  flange_b.tau = tau;
  flange_a.tau = -(tau/ratio + errorSlope*tau);
  lossPower = d*w_rel^2 + sum(q[i]*(w_rel - rate[i]/max(K_h[i], Modelica.Constants.small)) for i in 1:n);
  annotation (
    defaultComponentName="harmonicDrive",
    Icon(graphics={
      Rectangle(extent={{-100,10},{-64,-10}}, lineColor={64,64,64}, fillColor={192,192,192}, fillPattern=FillPattern.HorizontalCylinder),
      Rectangle(extent={{64,10},{100,-10}}, lineColor={64,64,64}, fillColor={192,192,192}, fillPattern=FillPattern.HorizontalCylinder),
      Ellipse(extent={{-70,70},{70,-70}}, lineColor={43,58,74}, fillColor={174,189,203}, fillPattern=FillPattern.Solid),
      Ellipse(extent={{-56,48},{56,-48}}, lineColor={31,95,168}, fillColor={255,255,255}, fillPattern=FillPattern.Solid, lineThickness=1.0),
      Ellipse(extent={{-42,32},{42,-32}}, lineColor={43,58,74}, fillColor={211,222,230}, fillPattern=FillPattern.Solid),
      Line(points={{-30,0},{-20,0},{-16,12},{-8,-12},{0,12},{8,-12},{16,12},{20,0},{30,0}}, color={209,67,43}, thickness=0.5),
      Text(extent={{-150,115},{150,75}}, textColor={0,0,255}, textString="%name"),
      Text(extent={{-150,-80},{150,-110}}, textString="ratio=%ratio")}),
    Documentation(info="<html>
<< html.what >>
<h4>Flanges</h4>
<p>Positive wind-up is the output ahead of the motor. The housing is ground: it takes the difference of the two torques. Inertias are not inside; put one on each flange. With a flange held, the other at a given torque and no inertia, the damper decides the speed, which is a division by zero if <code>d</code> is 0: set <code>use_damping=false</code> then, and the wind-up follows the torque at once.</p>
<h4>Law</h4>
<< html.law >>
<h4>Not in this table</h4>
<p>Friction at the wave generator (<code>tau_friction</code> of the FMU): take <code>Modelica.Mechanics.Rotational.Components.BearingFriction</code> on <code>flange_a</code>, which knows no load. The parameters of the law and the lost motion are those of the record <code>data</code>, fixed. The hysteresis is the FMU's: the same sliders, whose torques are states. The FMU states it by <code>hysteresis_loss</code>; the component by its friction and its stiffness at tiny motion, see the example. With <code>use_damping=false</code> the drive has none. The table is odd in the wind-up and ends at << end >>; beyond, the last tangent continues without a warning.</p>
<h4>How far to trust it</h4>
<< html.trust >>
<< html.paper >>
</html>"));
end HarmonicDriveSpring;
