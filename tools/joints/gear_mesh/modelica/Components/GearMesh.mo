within JointStiffness.Components;
model GearMesh "Mesh of two gear wheels with rough flanks, bending teeth and backlash"
  parameter JointStiffness.Data.GearMesh data = JointStiffness.Data.<< record >>() "The wheels"
    annotation (choicesAllMatching=true);
  parameter Modelica.Units.SI.Length r_b1(min=Modelica.Constants.small) = data.r_b1 "<< meta.r_b1 >>";
  parameter Modelica.Units.SI.Length r_b2(min=Modelica.Constants.small) = data.r_b2 "<< meta.r_b2 >>";
  parameter Real teeth1(min=1) = data.teeth1 "<< meta.teeth1 >>";
  parameter Modelica.Units.SI.Length backlash(min=0) = data.backlash "<< meta.backlash >>";
  parameter Real contact_ratio(min=1) = data.contact_ratio "<< meta.contact_ratio >>";
  parameter Real engagement(min=Modelica.Constants.small, max=1) = data.engagement "<< meta.engagement >>";
  parameter Modelica.Units.SI.TranslationalDampingConstant d(min=0) = data.d "<< meta.d >>";
  parameter Real overlap_ratio(min=0) = data.overlap_ratio "<< meta.overlap_ratio >>";
  Modelica.Mechanics.Rotational.Interfaces.Flange_a flange_a "Wheel 1"
    annotation (Placement(transformation(extent={{-110,-10},{-90,10}})));
  Modelica.Mechanics.Rotational.Interfaces.Flange_b flange_b "Wheel 2"
    annotation (Placement(transformation(extent={{90,-10},{110,10}})));
  Modelica.Units.SI.Position along(nominal=1e-4) "Displacement along the line of action, sum of both base circles";
  Modelica.Units.SI.Velocity v(nominal=0.1) "Rate of along";
  Modelica.Units.SI.Position s_rel(nominal=1e-5) "<< docs.s_rel >>";
  Modelica.Units.SI.Position transmission_error(nominal=1e-5) "<< docs.transmission_error >>";
  Real phase "Phase of the mesh cycle";
  Real pairs "<< docs.pairs >>";
  Modelica.Units.SI.Force f(nominal=1e3) "<< docs.f >>";
  Modelica.Units.SI.TranslationalSpringConstant K(nominal=1e8) "<< docs.K >>";
  Modelica.Units.SI.Energy E(nominal=1e-2) "<< docs.E >>";
  Modelica.Units.SI.Power lossPower "Power dissipated by the damper";
protected
  parameter Modelica.Units.SI.Length pitch = 2*Modelica.Constants.pi*r_b1/teeth1 "Base pitch";
  Modelica.Units.SI.Length size "Absolute value of the deflection";
  Modelica.Units.SI.Energy pairEnergy "Energy of a tooth pair";
  Real damping "Active fraction of the damping, 0 to 1";
  Modelica.Units.SI.Force rolling "Force from the change of the number of pairs, per displacement of one base circle";

  function energy "Energy of a tooth pair at a deflection"
    extends Modelica.Icons.Function;
    input Real x "Deflection, not negative";
    input Real table[:, 5] "Deflection, force, stiffness, its derivative before and after the node";
    input Real nodes[:] "Energy at each node";
    output Real y "Energy";
  protected
    Integer i "Row at which the segment begins";
    Real inside "Deflection, at most the end of the table";
    Real h "Length of the segment";
    Real t "Relative position in the segment, 0 to 1";
    Real b "First coefficient";
    Real c "Second coefficient";
    Real p "Error of the cubic in the force at the end";
    Real q "Error of the cubic in the stiffness at the end";
    Real r "Error of the cubic in the derivative of the stiffness at the end";
  algorithm
    inside := min(x, table[size(table, 1), 1]);
    i := JointStiffness.Functions.segment(inside, table);
    h := table[i + 1, 1] - table[i, 1];
    t := (inside - table[i, 1])/h;
    b := table[i, 3]*h;
    c := 0.5*table[i, 5]*h^2;
    p := table[i + 1, 2] - table[i, 2] - b - c;
    q := table[i + 1, 3]*h - b - 2*c;
    r := table[i + 1, 4]*h^2 - 2*c;
    y := nodes[i] + h*t*(table[i, 2] + t*(b/2 + t*(c/3 + t*((10*p - 4*q + 0.5*r)/4
      + t*((-15*p + 7*q - r)/5 + t*(6*p - 3*q + 0.5*r)/6)))))
      + (x - inside)*0.5*(JointStiffness.Functions.load(inside, table) + JointStiffness.Functions.load(x, table));
    annotation (derivative(noDerivative=table, noDerivative=nodes) = power, smoothOrder=3);
  end energy;

  function power "Time derivative of the energy of a tooth pair"
    extends Modelica.Icons.Function;
    input Real x "Deflection, not negative";
    input Real table[:, 5] "Deflection, force, stiffness, its derivative before and after the node";
    input Real nodes[:] "Energy at each node";
    input Real x_t "Time derivative of the deflection";
    output Real y_t "Time derivative of the energy";
  algorithm
    y_t := JointStiffness.Functions.load(x, table)*x_t;
    annotation (smoothOrder=2);
  end power;

  function extraPair "Fraction of the additional pair in contact: 0 to 1, symmetric in the phase"
    extends Modelica.Icons.Function;
    input Real phase "Phase of the mesh cycle";
    input Real part "Fraction of the cycle with the additional pair";
    input Real width "Fraction of the cycle in which the pair takes up its load";
    output Real one "Fraction of the pair in contact";
  protected
    Real away "Phase from the middle of the contact of the additional pair, -0.5 to 0.5";
  algorithm
    away := phase - floor(phase + 0.5);
    one := if width <= 0 then 0 else JointStiffness.Functions.smoothStep(0.5 + (0.5*part - abs(away))/width);
    annotation (smoothOrder=2);
  end extraPair;

  function extraPairSlope "Derivative of extraPair with respect to the phase"
    extends Modelica.Icons.Function;
    input Real phase "Phase of the mesh cycle";
    input Real part "Fraction of the cycle with the additional pair";
    input Real width "Fraction of the cycle in which the pair takes up its load";
    output Real slope "Derivative";
  protected
    Real away "Phase from the middle of the contact of the additional pair, -0.5 to 0.5";
    Real r "Relative position in the smooth step, 0 to 1";
  algorithm
    away := phase - floor(phase + 0.5);
    r := if width <= 0 then 0 else min(max(0.5 + (0.5*part - abs(away))/width, 0), 1);
    slope := if width <= 0 then 0 else (if away < 0 then 30 else -30)*(r*(1 - r))^2/width;
    annotation (smoothOrder=1);
  end extraPairSlope;

  function extraPairIntegral "Integral of extraPair minus its mean, from the middle of the contact of the pair; antisymmetric in the phase"
    extends Modelica.Icons.Function;
    input Real phase "Phase of the mesh cycle";
    input Real part "Fraction of the cycle with the additional pair";
    input Real width "Fraction of the cycle in which the pair takes up its load";
    output Real passed "Integral";
  protected
    Real away "Phase from the middle of the contact of the additional pair, -0.5 to 0.5";
    Real first "Relative position in the smooth step at the middle, at least 1";
    Real x "Relative position in the smooth step";
    Real r "x limited to 0 to 1";
  algorithm
    away := phase - floor(phase + 0.5);
    first := if width <= 0 then 1 else 0.5 + 0.5*part/width;
    x := if width <= 0 then 1 else first - abs(away)/width;
    r := min(max(x, 0), 1);
    passed := if width <= 0 then 0 else (if away < 0 then -1 else 1)*(width*(first - 0.5 - r^4*(2.5 + r*(r - 3))
      - max(x - 1, 0)) - part*abs(away));
    annotation (smoothOrder=2);
  end extraPairIntegral;

  parameter Real least = floor(contact_ratio) "Number of pairs that are always in contact";
  parameter Real part = contact_ratio - least "Fraction of the cycle with an additional pair";
  parameter Real width = engagement*min(part, 1 - part) "Fraction of the cycle in which the pair takes up its load";
  parameter Boolean helical = overlap_ratio > 1e-6 "true: the phase varies over the face width";
  parameter Real spread = if helical then overlap_ratio else 1 "Range of the phase over the face width";
  Real slope "Derivative of pairs with respect to the phase";
equation
  along = r_b1*flange_a.phi + r_b2*flange_b.phi;
  v = der(along);
  s_rel = noEvent(if along > 0.5*backlash then along - 0.5*backlash elseif along < -0.5*backlash then along + 0.5*backlash else 0);
  transmission_error = s_rel;
  size = noEvent(if s_rel < 0 then -s_rel else s_rel);
  phase = 0.5*(r_b1*flange_a.phi - r_b2*flange_b.phi)/pitch;
  pairs = least + (if helical then part + (extraPairIntegral(phase + 0.5*spread, part, width)
    - extraPairIntegral(phase - 0.5*spread, part, width))/spread else extraPair(phase, part, width));
  slope = if helical then (extraPair(phase + 0.5*spread, part, width) - extraPair(phase - 0.5*spread, part, width))/spread
    else extraPairSlope(phase, part, width);
  pairEnergy = energy(size, data.table, data.energy);
  damping = JointStiffness.Functions.smoothStep(size/data.closing);
  f = pairs*noEvent(if s_rel < 0 then -1 else 1)*JointStiffness.Functions.load(size, data.table) + d*damping*v;
  rolling = 0.5*slope*pairEnergy/pitch;
  K = pairs*JointStiffness.Functions.stiffness(size, data.table);
  E = pairs*pairEnergy;
  flange_a.tau = r_b1*(f + rolling);
  flange_b.tau = r_b2*(f - rolling);
  lossPower = d*damping*v^2;
  annotation (
    defaultComponentName="gearMesh",
    Icon(graphics={
      Rectangle(extent={{-100,8},{-46,-8}}, lineColor={64,64,64}, fillColor={192,192,192}, fillPattern=FillPattern.HorizontalCylinder),
      Rectangle(extent={{46,8},{100,-8}}, lineColor={64,64,64}, fillColor={192,192,192}, fillPattern=FillPattern.HorizontalCylinder),
      Polygon(points={{-70,-66},{-70,-34},{-40,-34},{-26,40},{-8,40},{6,-34},{70,-34},{70,-66},{-70,-66}}, lineColor={43,58,74}, fillColor={174,189,203}, fillPattern=FillPattern.Solid),
      Polygon(points={{-70,66},{-70,44},{12,44},{16,-22},{36,-22},{54,44},{70,44},{70,66},{-70,66}}, lineColor={43,58,74}, fillColor={211,222,230}, fillPattern=FillPattern.Solid),
      Line(points={{-34,-34},{-14,40},{6,40},{18,-34}}, color={209,67,43}, pattern=LinePattern.Dash, thickness=0.5),
      Text(extent={{-150,115},{150,75}}, textColor={0,0,255}, textString="%name"),
      Text(extent={{-150,-80},{150,-110}}, textString="r_b2/r_b1=%r_b2/%r_b1")}),
    Documentation(info="<html>
<< html.what >>
<h4>Flanges</h4>
<p>The signs of the angles are such that external wheels roll with <code>r_b1*flange_a.phi + r_b2*flange_b.phi = 0</code>; with both zero the teeth are in the middle of the backlash. For internal wheels, or angles as in <code>Modelica.Mechanics.Rotational.Components.IdealGear</code>, put an <code>IdealGear</code> of ratio -1 on one flange. The housing is fixed and carries the difference of the torques. Inertias are not included: connect one to each wheel.</p>
<h4>Law</h4>
<< html.law >>
<h4>Not in this table</h4>
<p>The flanks and <code>K_tooth</code> are those of the record <code>data</code>, fixed; radii, backlash, contact ratio, engagement and damping can be changed. The table ends at << end >> per pair; beyond, the last tangent continues without a warning.</p>
<h4>How far to trust it</h4>
<< html.trust >>
<< html.paper >>
</html>"));
end GearMesh;
