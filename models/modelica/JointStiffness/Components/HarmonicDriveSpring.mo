within JointStiffness.Components;
model HarmonicDriveSpring "Torsional spring and damper of a harmonic drive between two flanges"
  parameter JointStiffness.Data.HarmonicDrive data = JointStiffness.Data.CD_14_100_of_Hu_2023() "The drive"
    annotation (choicesAllMatching=true);
  parameter Real ratio(min=Modelica.Constants.small) = data.ratio "speed ratio of wave generator and output";
  parameter Modelica.Units.SI.RotationalDampingConstant d(min=0) = data.d "viscous damping at the output";
  parameter StateSelect stateSelect=StateSelect.prefer "Priority to use phi_rel and w_rel as states"
    annotation (HideResult=true, Dialog(tab="Advanced"));
  Modelica.Mechanics.Rotational.Interfaces.Flange_a flange_a "Wave generator (motor)"
    annotation (Placement(transformation(extent={{-110,-10},{-90,10}})));
  Modelica.Mechanics.Rotational.Interfaces.Flange_b flange_b "Output"
    annotation (Placement(transformation(extent={{90,-10},{110,10}})));
  Modelica.Units.SI.Angle phi_rel(start=0, nominal=1e-3, stateSelect=stateSelect)
    "wind-up at the output, phi2 - phi1/ratio (= flange_b.phi - flange_a.phi/ratio)";
  Modelica.Units.SI.AngularVelocity w_rel(start=0, nominal=1, stateSelect=stateSelect) "Rate of the wind-up";
  Modelica.Units.SI.Torque tau_c(nominal=5) "Torque of the spring";
  Modelica.Units.SI.Torque tau(nominal=5) "Torque at the output (= flange_b.tau)";
  Modelica.Units.SI.RotationalSpringConstant K_WTS(nominal=5e3) "tangent stiffness dT/dphi at the present torque";
  Modelica.Units.SI.RotationalSpringConstant K_TS(nominal=5e3) "its part of the contact pair: 1/K_WTS = 1/K_FTS + 1/K_TS";
  Modelica.Units.SI.Power lossPower "Power dissipated by the damper";
protected
  Real windUp "Absolute value of the wind-up";
equation
  phi_rel = flange_b.phi - flange_a.phi/ratio;
  w_rel = der(phi_rel);
  windUp = noEvent(if phi_rel < 0 then -phi_rel else phi_rel);
  tau_c = noEvent(if phi_rel < 0 then -1 else 1)*JointStiffness.Functions.load(windUp, data.table);
  tau = tau_c + d*w_rel;
  K_WTS = JointStiffness.Functions.stiffness(windUp, data.table);
  K_TS = 1/(1/K_WTS - 1/data.K_FTS0);
  flange_b.tau = tau;
  flange_a.tau = -tau/ratio;
  lossPower = d*w_rel^2;
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
<p>The torsional spring and damper between the wave generator (motor, flange 1) and the output (flange 2) of a harmonic drive. Inertias are not inside: put one on each flange.</p>
<p>The stiffness comes from the rough contact of flexspline and flexible bearing: a larger torque presses more of the surface together, so the drive is soft at first and becomes stiffer. Circular spline and flexspline are a constant stiffness in series.</p>
<h4>Flanges</h4>
<p>Positive wind-up is the output ahead of the motor. The housing is ground: it takes the difference of the two torques. Inertias are not inside; put one on each flange.</p>
<h4>Law</h4>
<p>τ = T(φ<sub>rel</sub>) + d (w<sub>2</sub> − w<sub>1</sub>/ratio), &emsp; T the inverse of φ(T)</p>
<p>φ(T) = ∫<sub>0</sub><sup>T</sup> dT′ / K<sub>WTS</sub>(T′), &emsp; odd in T</p>
<p>1/K<sub>WTS</sub> = 1/K<sub>FTS</sub> + 1/K<sub>TS</sub>, &emsp; K<sub>TS</sub> = drive_scale · K<sub>pair</sub> (Hu 2023, Eq. 46)</p>
<p>K<sub>pair</sub> = pair_scale · Σ share [ K<sub>N</sub> (u·n)<sup>2</sup> + K<sub>T</sub> (|u|<sup>2</sup> − (u·n)<sup>2</sup>) ], &emsp; u = axis × position (Eq. 45, corrected)</p>
<p>The sum runs over the contact of flexspline and bearing ring: two lobes of pressure, at the angle θ from the major axis and the distance z from the cup's opening,</p>
<p>p(θ, z) = P(T) (1 − z/cup_length) − mismatch_pressure · sin<sup>2</sup>θ, &emsp; where positive</p>
<p>P(T) = [ p<sub>0</sub><sup>2</sup> + (p<sub>r</sub><sup>2</sup> − p<sub>0</sub><sup>2</sup>) g(T)/g(T<sub>r</sub>) ]<sup>1/2</sup> − deformation_loss (w − w<sub>opt</sub>)<sup>2</sup> − eccentricity_loss · e</p>
<p>g(T) = (T<sup>2</sup> + T<sub>s</sub><sup>2</sup>)<sup>1/2</sup> − T<sub>s</sub></p>
<p>with p<sub>0</sub> <code>zero_torque_pressure</code>, p<sub>r</sub> <code>rated_pressure</code> at the <code>rated_torque</code> T<sub>r</sub>, T<sub>s</sub> <code>torque_smoothing</code>, w <code>radial_deformation</code>, w<sub>opt</sub> <code>optimum_deformation</code> and e <code>eccentricity</code>. At each pressure, K<sub>N</sub> and K<sub>T</sub> are sums over contact spots up to the largest one, s<sub>l</sub>, whose load is p A<sub>0</sub>:</p>
<p>n(s) = ½ (D−1) ψ<sup>(3−D)/2</sup> s<sub>l</sub><sup>(D−1)/2</sup> s<sup>−(D+1)/2</sup> (Eq. 17)</p>
<p>F = ∫ f n ds, &emsp; K<sub>N</sub> = ∫ k<sub>n</sub> n ds, &emsp; K<sub>T</sub> = ∫ 8 G′ r (1 − x)<sup>1/3</sup> n ds, &emsp; s &gt; s<sub>min</sub> in K (Eqs. 27, 35, 44)</p>
<p>A spot is elastic, in the first or second elastic-plastic stage of Kogut and Etsion, or plastic, as its area grows (Eqs. 7-16).</p>
<h4>Not in this table</h4>
<p>The parameters of the law are those of the record <code>data</code>, fixed. Damping is the viscous <code>d</code> alone. The table is odd in the wind-up and ends at 30 N m; beyond, the last tangent continues without a warning.</p>
<h4>How far to trust it</h4>
<ul>
<li><b>Validated</b> with the default parameters (CD-14-100): K_TS of the paper at 3 and 5 N m within 2.5 %, its change by eccentricity within 0.4 percentage points, K_WTS measured at 0.5 N m within the paper's own 7.3 %. The other published points fixed the calibration parameters.</li>
<li><b>Scale.</b> The paper's own equation gives a contact stiffness four orders of magnitude above the one it publishes, and that one contradicts its drive stiffness by a factor of about 3.7. Both factors are calibration parameters, <code>pair_scale</code> and <code>drive_scale</code>. The shape over torque is the law's, the level is fitted. <code>K_TS_pair</code> is on the paper's scale.</li>
<li><b>Estimates.</b> Base radius and smallest spot, yield strengths, cup length, width of the lobes and damping are not published.</li>
<li><b>Range.</b> The table ends at <code>max_torque</code>. Parameters for which the pair loses contact without torque are refused.</li>
<li><b>Not inside:</b> hysteresis, backlash, friction, kinematic error, temperature. Dissipation is the viscous <code>d</code> alone.</li>
<li><b>Trend.</b> An elastic boundary-element solution of rough surfaces finds a stiffness close to proportional to the pressure and hardly dependent on D. The fractal law has lower powers of the pressure, which depend on D.</li>
</ul>
<p>Q. Hu, H. Li, G. Wang, L. Li: <em>Research on torsional stiffness of flexspline-flexible bearing contact pair in harmonic drive based on macro-micro scale modeling.</em> Frontiers in Materials 10, 2023. <a href=\"https://doi.org/10.3389/fmats.2023.1211019\">doi:10.3389/fmats.2023.1211019</a></p>
</html>"));
end HarmonicDriveSpring;
