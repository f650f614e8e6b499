within JointStiffness.Components;
model HarmonicDriveSpring "Torsional spring and damper of a harmonic drive between two flanges"
  parameter JointStiffness.Data.HarmonicDrive data = JointStiffness.Data.<< record >>() "The drive"
    annotation (choicesAllMatching=true);
  parameter Real ratio = data.ratio "<< meta.ratio >>";
  parameter Modelica.Units.SI.RotationalDampingConstant d(min=0) = data.d "<< meta.d >>";
  parameter Modelica.Units.SI.Torque hysteresis_friction(min=0) = data.hysteresis_friction "Friction torque of the hysteresis; 0: none"
    annotation (Dialog(tab="Friction"));
  parameter Modelica.Units.SI.RotationalSpringConstant hysteresis_stiffness(min=0) = data.hysteresis_stiffness "<< meta.hysteresis_stiffness.split(";")[0] >>"
    annotation (Dialog(tab="Friction"));
  parameter Modelica.Units.SI.Torque friction_coulomb(min=0) = data.friction_coulomb "<< meta.friction_coulomb >>"
    annotation (Dialog(tab="Friction"));
  parameter Modelica.Units.SI.Torque friction_stribeck(min=0) = data.friction_stribeck "<< meta.friction_stribeck >>"
    annotation (Dialog(tab="Friction"));
  parameter Modelica.Units.SI.AngularVelocity stribeck_speed(min=Modelica.Constants.small) = data.stribeck_speed "<< meta.stribeck_speed >>"
    annotation (Dialog(tab="Friction"));
  parameter Modelica.Units.SI.RotationalDampingConstant friction_viscous(min=0) = data.friction_viscous "<< meta.friction_viscous >>"
    annotation (Dialog(tab="Friction"));
  parameter Real load_loss(min=0, unit="1") = data.load_loss "<< meta.load_loss >>"
    annotation (Dialog(tab="Friction"));
  parameter Real load_loss_back(unit="1") = data.load_loss_back "<< meta.load_loss_back >>"
    annotation (Dialog(tab="Friction"));
  parameter Modelica.Units.SI.Torque friction_1(min=0) = data.friction_1 "<< meta.friction_1 >>"
    annotation (Dialog(tab="Friction"));
  parameter Modelica.Units.SI.Angle friction_1_phase = data.friction_1_phase "<< meta.friction_1_phase >>"
    annotation (Dialog(tab="Friction"));
  parameter Modelica.Units.SI.Torque friction_2(min=0) = data.friction_2 "<< meta.friction_2 >>"
    annotation (Dialog(tab="Friction"));
  parameter Modelica.Units.SI.Angle friction_2_phase = data.friction_2_phase "<< meta.friction_2_phase >>"
    annotation (Dialog(tab="Friction"));
  parameter Modelica.Units.SI.Angle presliding(min=Modelica.Constants.small) = data.presliding "<< meta.presliding >>"
    annotation (Dialog(tab="Friction"));
  parameter Real temperature_factor(min=0, unit="1") = data.temperature_factor "<< meta.temperature_factor >>"
    annotation (Dialog(tab="Friction"));
  parameter Modelica.Units.SI.LinearTemperatureCoefficient viscous_temperature_coefficient = data.viscous_temperature_coefficient "<< meta.viscous_temperature_coefficient.split(";")[0] >>"
    annotation (Dialog(tab="Friction"));
  parameter Modelica.Units.SI.LinearTemperatureCoefficient dry_temperature_coefficient = data.dry_temperature_coefficient "<< meta.dry_temperature_coefficient.split(";")[0] >>"
    annotation (Dialog(tab="Friction"));
  parameter Boolean useHeatPort = false "= true, if heatPort is enabled: it sets the temperature and receives lossPower"
    annotation (Evaluate=true, HideResult=true, choices(checkBox=true), Dialog(tab="Friction"));
  parameter Modelica.Units.SI.Temperature T = data.T "Temperature of the lubricant, if useHeatPort = false"
    annotation (Dialog(tab="Friction", enable=not useHeatPort));
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
  parameter Boolean use_damping = true "false: the wind-up follows the torque without delay; no damping, hysteresis or friction"
    annotation (Evaluate=true, Dialog(tab="Advanced"));
  parameter StateSelect stateSelect=StateSelect.default "Priority to use phi_rel and w_rel as states"
    annotation (HideResult=true, Dialog(tab="Advanced"));
  Modelica.Mechanics.Rotational.Interfaces.Flange_a flange_a "Wave generator (motor)"
    annotation (Placement(transformation(extent={{-110,-10},{-90,10}})));
  Modelica.Mechanics.Rotational.Interfaces.Flange_b flange_b "Output"
    annotation (Placement(transformation(extent={{90,-10},{110,10}})));
  Modelica.Thermal.HeatTransfer.Interfaces.HeatPort_a heatPort(T=temperature, Q_flow=-lossPower) if useHeatPort "Lubricant"
    annotation (Placement(transformation(extent={{-10,-110},{10,-90}})));
  Modelica.Units.SI.Temperature temperature "<< docs.temperature >>";
  Modelica.Units.SI.Angle phi_rel(start=0, nominal=1e-3, stateSelect=stateSelect)
    "<< docs.phi_rel >> (= flange_b.phi - flange_a.phi/ratio - phi_error)";
  Modelica.Units.SI.Angle phi_error(nominal=1e-4) "<< docs.phi_error >>";
  Modelica.Units.SI.AngularVelocity w_rel(start=0, nominal=1, stateSelect=stateSelect) "Rate of the wind-up; 0 with use_damping=false";
  Modelica.Units.SI.Torque tau_c(nominal=5) "Torque of the spring";
  Modelica.Units.SI.Torque tau_h(nominal=0.1) "Torque of the hysteresis";
  Modelica.Units.SI.Torque tau(nominal=5) "Torque at the output (= flange_b.tau)";
  Modelica.Units.SI.AngularVelocity w1 "Speed of the wave generator; 0 with use_damping=false";
  Modelica.Units.SI.Torque tau_friction(nominal=0.01) "<< docs.tau_friction >>";
  Modelica.Units.SI.RotationalSpringConstant K_WTS(nominal=5e3) "<< docs.K_WTS >>";
  Modelica.Units.SI.RotationalSpringConstant K_TS(nominal=5e3) "<< docs.K_TS >>";
  Modelica.Units.SI.Power lossPower "Power dissipated by damper and friction";
protected
  constant Real layer=1e-3 "Width of the transition from stick to slip of a slider at the wave generator, relative to its friction limit";
  constant Modelica.Units.SI.Time turned=<< turned >> "Duration of the motion before initialization of a drive that turns then";
  constant Modelica.Units.SI.Time forgets=1e-4 "Time constant with which a slider above its friction limit returns to it at rest";
  constant Modelica.Units.SI.Temperature reference=<< reference >> "Reference temperature of the friction parameters";
  constant Real width=<< width >> "Torque, relative to rated torque, within which |tau| is smoothed";
  constant Real brakes[:, 2]=<< brakes >> "Stiffness and friction of the sliders at the wave generator, relative to their sums";
  parameter Integer n=size(data.sliders, 1) "Number of sliders of the hysteresis";
  parameter Modelica.Units.SI.RotationalSpringConstant K_h[n]=(if hysteresis_friction > 0 then hysteresis_stiffness else 0)*data.sliders[:, 1] "Stiffness of the hysteresis sliders";
  parameter Modelica.Units.SI.Torque M_h[n]=hysteresis_friction*data.sliders[:, 2] "Friction limits of the hysteresis sliders";
  constant Modelica.Units.SI.AngularVelocity still=1e-7 "Rate of the wind-up beyond which it counts as reversed";
  discrete Modelica.Units.SI.Torque q_h[n](each start=0, each fixed=true, each nominal=0.01) "Torques of the hysteresis sliders at the last reversal of the wind-up";
  discrete Modelica.Units.SI.Angle phi_h(start=0, fixed=true, nominal=1e-3) "Wind-up at the last reversal";
  Boolean ahead(start=false, fixed=true) "The wind-up increases";
  Boolean behind(start=false, fixed=true) "The wind-up decreases";
  Modelica.Units.SI.Torque stuck_h[n] "Torques of the hysteresis sliders if they stick since the last reversal";
  Modelica.Units.SI.Torque held_h[n] "Torques of the hysteresis sliders, within their friction limits";
  Modelica.Units.SI.Torque begun_h[n] "Torques of the hysteresis sliders after a straight path from rest to the present wind-up";
  Modelica.Units.SI.Power heat_h[n] "Power dissipated by the hysteresis sliders";
  parameter Integer m=size(brakes, 1) "Number of sliders of the friction at the wave generator";
  parameter Real loss_back(unit="1")=if load_loss_back < 0 then load_loss else load_loss_back "Value of load_loss when the load drives the motor";
  parameter Modelica.Units.SI.Torque M_rated=temperature_factor*(friction_coulomb + friction_stribeck + max(load_loss, loss_back)*data.rated_torque/abs(ratio)) "Limit of dry friction at rest and rated torque";
  parameter Modelica.Units.SI.RotationalSpringConstant K_w[m]=M_rated/presliding*brakes[:, 1] "Stiffness of the sliders at the wave generator";
  Real f_dry(unit="1") "Temperature factor of the dry friction";
  Real f_viscous(unit="1") "Temperature factor of the viscous friction";
  Modelica.Units.SI.Torque unloaded "Limit of dry friction without load, at the reference temperature";
  Modelica.Units.SI.Torque tau_begun "Torque at the output with hysteresis from rest";
  Modelica.Units.SI.Torque M_p "Limit of positive dry friction at the wave generator";
  Modelica.Units.SI.Torque M_n "Limit of negative dry friction at the wave generator";
  Modelica.Units.SI.Torque q_w[m](each start=0, each nominal=0.01) "Torques of the sliders at the wave generator, at most one transition width above their limits";
  Modelica.Units.SI.Torque held_w[m] "Torques of the sliders at the wave generator, within their friction limits";
  Real rate_w[m](each unit="N.m/s") "Rates of q_w";
  Modelica.Units.SI.Power heat_w[m] "Power dissipated by the sliders at the wave generator";
  Real errorSlope "Derivative of phi_error with respect to flange_a.phi";
  Modelica.Units.SI.Angle windUp "Absolute value of the wind-up";
initial equation
  for i in 1:m loop
    q_w[i] = min(max(turned*K_w[i]*w1,
      -f_dry*JointStiffness.Functions.frictionLimit(unloaded, load_loss, loss_back, tau_begun, width*data.rated_torque, -ratio)*brakes[i, 2]),
      f_dry*JointStiffness.Functions.frictionLimit(unloaded, load_loss, loss_back, tau_begun, width*data.rated_torque, ratio)*brakes[i, 2]);
  end for;
equation
  assert(ratio < 0 or ratio > 0, "ratio = 0 is outside (-inf, 0) and (0, inf)");
  assert(friction_1 + friction_2 <= friction_coulomb, "friction_1 + friction_2 must not exceed friction_coulomb");
  phi_error = error_1*sin(flange_a.phi + error_1_phase) + error_2*sin(2*flange_a.phi + error_2_phase) + error_4*sin(4*flange_a.phi + error_4_phase);
  errorSlope = error_1*cos(flange_a.phi + error_1_phase) + 2*error_2*cos(2*flange_a.phi + error_2_phase) + 4*error_4*cos(4*flange_a.phi + error_4_phase);
  phi_rel = flange_b.phi - flange_a.phi/ratio - phi_error;
  if use_damping then
    w_rel = der(phi_rel);
    w1 = der(flange_a.phi);
    tau = tau_c + tau_h + d*w_rel;
  else
    w_rel = 0;
    w1 = 0;
    tau = tau_c + tau_h;
  end if;
  // sliders of the hysteresis: a spring each, from the last turn on, that friction holds no further
  for i in 1:n loop
    stuck_h[i] = q_h[i] + K_h[i]*(phi_rel - phi_h);
    held_h[i] = noEvent(min(max(stuck_h[i], -M_h[i]), M_h[i]));
    begun_h[i] = noEvent(min(max(K_h[i]*phi_rel, -M_h[i]), M_h[i]));
    heat_h[i] = noEvent(if abs(stuck_h[i]) > M_h[i] then M_h[i]*abs(w_rel) else 0);
  end for;
  ahead = (if hysteresis_friction > 0 then w_rel else 0) > still;
  behind = (if hysteresis_friction > 0 then w_rel else 0) < -still;
  when {initial(), pre(ahead), pre(behind)} then
    q_h = JointStiffness.Functions.limited(pre(q_h) + K_h*(phi_rel - pre(phi_h)), M_h);
    phi_h = phi_rel;
  end when;
  tau_h = if use_damping then sum(held_h) else 0;
  tau_begun = tau_c + d*w_rel + sum(begun_h);
  if not useHeatPort then
    temperature = T;
  end if;
  f_dry = temperature_factor*exp(-dry_temperature_coefficient*(temperature - reference));
  f_viscous = temperature_factor*exp(-viscous_temperature_coefficient*(temperature - reference));
  unloaded = friction_coulomb + friction_stribeck*exp(-(w1/stribeck_speed)^2) + friction_1*sin(flange_a.phi + friction_1_phase) + friction_2*sin(2*flange_a.phi + friction_2_phase);
  M_p = f_dry*JointStiffness.Functions.frictionLimit(unloaded, load_loss, loss_back, tau, width*data.rated_torque, ratio);
  M_n = f_dry*JointStiffness.Functions.frictionLimit(unloaded, load_loss, loss_back, tau, width*data.rated_torque, -ratio);
  // sliders of the friction: a spring each, that follows the motion until its friction holds no more
  for i in 1:m loop
    held_w[i] = noEvent(min(max(q_w[i], -M_n*brakes[i, 2]), M_p*brakes[i, 2]));
    rate_w[i] = K_w[i]*(w1 - noEvent(abs(w1))*(q_w[i] - held_w[i])/(layer*M_rated*brakes[i, 2] + Modelica.Constants.small)) - (q_w[i] - held_w[i])/forgets;
    der(q_w[i]) = rate_w[i];
    heat_w[i] = held_w[i]*w1 - q_w[i]*rate_w[i]/max(K_w[i], Modelica.Constants.small);
  end for;
  tau_friction = sum(held_w) + f_viscous*friction_viscous*w1;
  windUp = noEvent(if phi_rel < 0 then -phi_rel else phi_rel);
  tau_c = noEvent(if phi_rel < 0 then -1 else 1)*JointStiffness.Functions.load(windUp, data.table);
  K_WTS = JointStiffness.Functions.stiffness(windUp, data.table);
  K_TS = 1/(1/K_WTS - 1/data.K_FTS0);
  flange_b.tau = tau;
  flange_a.tau = -(tau/ratio + errorSlope*tau) + tau_friction;
  lossPower = d*w_rel^2 + f_viscous*friction_viscous*w1^2 + sum(heat_h) + sum(heat_w);
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
<p>The wind-up is positive if the output is ahead of the motor. The housing is fixed and carries the difference of the two torques. Inertias are not included: connect one to each flange. If one flange is fixed and the other has a given torque but no inertia, the damper determines the speed; with <code>d</code> = 0 this is a division by zero. Then set <code>use_damping=false</code>: the wind-up follows the torque without delay.</p>
<h4>Law</h4>
<< html.law >>
<p>T<sub>h</sub> is the hysteresis of the FMU: the same sliders, computed from the last reversal of the wind-up (an event). The parameter of the FMU is <code>hysteresis_loss</code>; the parameters of the component are the friction torque and the stiffness for small motions, see the example. The sliders of the friction at the wave generator are those of the FMU too. Their torques are states, and their limit M depends on speed and load. The transition from stick to slip has a width of a thousandth of the friction limit. No torque above the limit acts, so a drive at rest holds its position. If friction needs too many solver steps, use the FMU in its wrapper.</p>
<h4>Not in this table</h4>
<p>The parameters of the law and the lost motion are those of the record <code>data</code>, fixed. With <code>use_damping=false</code> the drive has neither hysteresis nor friction. The table is antisymmetric in the wind-up and ends at << end >>; beyond, the last tangent continues without a warning.</p>
<h4>How far to trust it</h4>
<< html.trust >>
<< html.paper >>
</html>"));
end HarmonicDriveSpring;
