within JointStiffness.Components;
model GearMesh "Mesh of two gear wheels with rough flanks, bending teeth and backlash"
  parameter JointStiffness.Data.GearMesh data = JointStiffness.Data.Gear_pair_of_Yu_2022_as_spur_wheels() "The wheels"
    annotation (choicesAllMatching=true);
  parameter Modelica.Units.SI.Length r_b1(min=Modelica.Constants.small) = data.r_b1 "base radius of wheel 1";
  parameter Modelica.Units.SI.Length r_b2(min=Modelica.Constants.small) = data.r_b2 "base radius of wheel 2";
  parameter Real teeth1(min=1) = data.teeth1 "number of teeth of wheel 1";
  parameter Modelica.Units.SI.Length backlash(min=0) = data.backlash "backlash along the line of action";
  parameter Real contact_ratio(min=1) = data.contact_ratio "mean number of tooth pairs in contact";
  parameter Real engagement(min=Modelica.Constants.small, max=1) = data.engagement "time over which a pair takes up its load, divided by the shorter of the times with and without the pair";
  parameter Modelica.Units.SI.TranslationalDampingConstant d(min=0) = data.d "damping along the line of action while the flanks touch";
  parameter Real overlap_ratio(min=0) = data.overlap_ratio "overlap ratio: face width divided by axial pitch; 0: spur gears";
  Modelica.Mechanics.Rotational.Interfaces.Flange_a flange_a "Wheel 1"
    annotation (Placement(transformation(extent={{-110,-10},{-90,10}})));
  Modelica.Mechanics.Rotational.Interfaces.Flange_b flange_b "Wheel 2"
    annotation (Placement(transformation(extent={{90,-10},{110,10}})));
  Modelica.Units.SI.Position along(nominal=1e-4) "Displacement along the line of action, sum of both base circles";
  Modelica.Units.SI.Velocity v(nominal=0.1) "Rate of along";
  Modelica.Units.SI.Position s_rel(nominal=1e-5) "deflection r_b1 phi1 + r_b2 phi2 beyond half the backlash, 0 within it";
  Modelica.Units.SI.Position transmission_error(nominal=1e-5) "lag of wheel 2 along the line of action, with the teeth deflected; 0 without load";
  Real phase "Phase of the mesh cycle";
  Real pairs "tooth pairs in contact at the present phase, if the flanks touch";
  Modelica.Units.SI.Force f(nominal=1e3) "normal force of the mesh, positive on the driving flanks";
  Modelica.Units.SI.TranslationalSpringConstant K(nominal=1e8) "stiffness df/ds_rel at the present phase of the mesh cycle";
  Modelica.Units.SI.Energy E(nominal=1e-2) "elastic energy of the mesh";
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
<p>The mesh of two gear wheels: rough tooth flanks in contact, teeth that bend, backlash, and a number of tooth pairs in contact that changes while the wheels turn. The inertias are not included: connect one to each wheel. For the contact of two flanks only, use <code>GearContact</code>.</p>
<h4>Flanges</h4>
<p>The signs of the angles are such that external wheels roll with <code>r_b1*flange_a.phi + r_b2*flange_b.phi = 0</code>; with both zero the teeth are in the middle of the backlash. For internal wheels, or angles as in <code>Modelica.Mechanics.Rotational.Components.IdealGear</code>, put an <code>IdealGear</code> of ratio -1 on one flange. The housing is fixed and carries the difference of the torques. Inertias are not included: connect one to each wheel.</p>
<h4>Law</h4>
<p>x = r<sub>b1</sub> φ<sub>1</sub> + r<sub>b2</sub> φ<sub>2</sub>, &emsp; s<sub>rel</sub> = x − backlash/2 above backlash/2, x + backlash/2 below −backlash/2, 0 between</p>
<p>ξ = (r<sub>b1</sub> φ<sub>1</sub> − r<sub>b2</sub> φ<sub>2</sub>) / (2 p<sub>b</sub>), &emsp; p<sub>b</sub> = 2π r<sub>b1</sub> / teeth1</p>
<p>Flanks and teeth of a pair are in series; δ(F) is the law of the flanks:</p>
<p>s = δ(F) + F / K<sub>tooth</sub>, &emsp; V(s) = ∫<sub>0</sub><sup>s</sup> F(s′) ds′</p>
<p>δ(F) = ∫<sub>0</sub><sup>F</sup> dF′ / k(F′)</p>
<p>F = ∫ F(a) n da, &emsp; k = ∫ k(a) n da (Yu 2022, Eqs. 42-79, corrected)</p>
<p>N(ξ) pairs have this deflection. The integer part of <code>contact_ratio</code> is the number of pairs always in contact; one more pair is in contact during the remaining fraction of each cycle. It enters and leaves with a smooth step of duration <code>engagement</code>. In a helical mesh the number is the mean over a length of <code>overlap_ratio</code> in ξ, over the transverse sections. The torques are the gradient of a potential, so no cycle creates or destroys energy:</p>
<p>U = N(ξ) V(|s<sub>rel</sub>|), &emsp; τ<sub>1</sub> = −∂U/∂φ<sub>1</sub> − r<sub>b1</sub> f<sub>d</sub>, &emsp; τ<sub>2</sub> = −∂U/∂φ<sub>2</sub> − r<sub>b2</sub> f<sub>d</sub> (after Oh, Grosh, Barber 2005)</p>
<p>f = N F(|s<sub>rel</sub>|) sign(s<sub>rel</sub>) + f<sub>d</sub>, &emsp; f<sub>d</sub> = d g(|s<sub>rel</sub>|) (r<sub>b1</sub> w<sub>1</sub> + r<sub>b2</sub> w<sub>2</sub>), &emsp; K = N dF/ds</p>
<p>g is a smooth step from 0 at first touch to 1 at the end of the closing range. The force is continuous when the flanks meet, and zero inside the backlash.</p>
<h4>Not in this table</h4>
<p>The flanks and <code>K_tooth</code> are those of the record <code>data</code>, fixed; radii, backlash, contact ratio, engagement and damping can be changed. The table ends at 65.8 kN per pair; beyond, the last tangent continues without a warning.</p>
<h4>How far to trust it</h4>
<ul>
<li><b>Not validated as a stiffness.</b> No stiffness of this mesh is published, and the paper prints no numbers of its curves. Only the paper's claims on the flanks are compared, with <code>GearContact</code>.</li>
<li><b>Estimates.</b> <code>A_0</code>, <code>K_tooth</code>, <code>backlash</code>, <code>contact_ratio</code>, <code>engagement</code> and <code>d</code> are not published; the wheels are taken as spur wheels without profile shift.</li>
<li><b>Formula of the teeth.</b> At usual loads <code>K_tooth</code> determines the stiffness; the flanks determine the first contact. Published formulas of the mean mesh stiffness differ: for two spur wheels of module 2 mm with 62 teeth, an open rotor-dynamics code has 13 % less than ISO 6336-1.</li>
<li><b>One stiffness of the teeth.</b> In reality the stiffness of a pair varies along the line of action by about ten per cent; in this model only the number of pairs varies. All pairs share the load equally.</li>
<li><b>One phase for both flanks.</b> When the load changes its side, the real cycle of the back flanks is shifted.</li>
<li><b>Closing contact.</b> Below 21 kPa on the flanks (2 N per pair with the default parameters) the law gives almost no stiffness; the curve continues smoothly to zero and departs from the law.</li>
<li><b>Range.</b> The table ends where the mean pressure on a pair reaches the hardness, far above the strength of a tooth.</li>
<li><b>Not included:</b> friction of the flanks, lubrication, pitch and profile errors and so no static transmission error of an unloaded mesh, profile corrections, dynamics of the wheel bodies.</li>
</ul>
<p>G. Yu, H. Mao, L. Jiang, W. Liu, T. Valerii: <em>Fractal Contact Mechanics Model for the Rough Surface of a Beveloid Gear with Elliptical Asperities.</em> Applied Sciences 12, 4071, 2022. <a href=\"https://doi.org/10.3390/app12084071\">doi:10.3390/app12084071</a></p>
<p>S. Oh, K. Grosh, J. R. Barber: <em>Energy Conserving Equations of Motion for Gear Systems.</em> Journal of Vibration and Acoustics 127, 208-212, 2005. <a href=\"https://doi.org/10.1115/1.1891815\">doi:10.1115/1.1891815</a></p>
</html>"));
end GearMesh;
