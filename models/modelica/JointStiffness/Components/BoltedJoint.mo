within JointStiffness.Components;
model BoltedJoint "Bolted joint at a fixed preload: three axes, side 1 fixed"
  parameter JointStiffness.Data.BoltedJoint data = JointStiffness.Data.Box_specimen_of_Zhao_2018_9_kN() "The tightened joint"
    annotation (choicesAllMatching=true);
  parameter Modelica.Units.SI.Mass mass(min=0) = data.mass "mass of the structure, for the viscous equivalent";
  parameter StateSelect stateSelect=StateSelect.default "Priority to use s_rel and v_rel as states"
    annotation (HideResult=true, Dialog(tab="Advanced"));
  Modelica.Mechanics.Translational.Interfaces.Flange_b flange_x "Side 2 along x, along the rows of bolts"
    annotation (Placement(transformation(extent={{90,50},{110,70}})));
  Modelica.Mechanics.Translational.Interfaces.Flange_b flange_y "Side 2 along y, across the rows"
    annotation (Placement(transformation(extent={{90,-10},{110,10}})));
  Modelica.Mechanics.Translational.Interfaces.Flange_b flange_z "Side 2 along the normal, positive apart"
    annotation (Placement(transformation(extent={{90,-70},{110,-50}})));
  Modelica.Units.SI.Position s_rel[3](each start=0, each nominal=1e-6, each stateSelect=stateSelect)
    "Displacement x, y, z of side 2 from the tightened state";
  Modelica.Units.SI.Velocity v_rel[3](each start=0, each nominal=1e-3, each stateSelect=stateSelect) "Its rate";
  Modelica.Units.SI.Force f[3](each nominal=1e4) "Force x, y, z on side 2, restoring";
  Modelica.Units.SI.TranslationalSpringConstant K_n(nominal=1e10) "Normal stiffness without shear";
  Modelica.Units.SI.TranslationalSpringConstant K_t(nominal=1e10) "tangential stiffness -df_x/ds_rel_x";
  Modelica.Units.SI.TranslationalDampingConstant C_n(nominal=1e4) "viscous-equivalent damping along the normal";
  Modelica.Units.SI.TranslationalDampingConstant C_t(nominal=1e4) "Viscous-equivalent damping along x and y";
  Real eta_n "normal dissipation factor";
equation
  s_rel[1] = flange_x.s;
  s_rel[2] = flange_y.s;
  s_rel[3] = flange_z.s;
  v_rel = der(s_rel);
  K_n = JointStiffness.Functions.stiffness(-s_rel[3], data.table);
  K_t = data.shear*K_n;
  eta_n = JointStiffness.Functions.linear(-s_rel[3], data.damping);
  // repeats mindlin.viscous_equivalent and spring.motion of the package; tests hold both together
  C_n = eta_n*sqrt(mass*max(K_n, 0));
  C_t = data.eta_t*sqrt(mass*max(K_t, 0));
  f[1] = -K_t*s_rel[1] - C_t*v_rel[1];
  f[2] = -K_t*s_rel[2] - C_t*v_rel[2];
  f[3] = JointStiffness.Functions.load(-s_rel[3], data.table)
    + 0.5*data.shear*JointStiffness.Functions.bend(-s_rel[3], data.table)*(s_rel[1]^2 + s_rel[2]^2) - C_n*v_rel[3];
  flange_x.f = -f[1];
  flange_y.f = -f[2];
  flange_z.f = -f[3];
  annotation (
    defaultComponentName="boltedJoint",
    Icon(graphics={
      Rectangle(extent={{-90,44},{90,4}}, lineColor={43,58,74}, fillColor={174,189,203}, fillPattern=FillPattern.Solid),
      Rectangle(extent={{-90,-4},{90,-44}}, lineColor={43,58,74}, fillColor={211,222,230}, fillPattern=FillPattern.Solid),
      Line(points={{-90,0},{-70,6},{-50,-6},{-30,6},{-10,-6},{10,6},{30,-6},{50,6},{70,-6},{90,0}}, color={209,67,43}, thickness=0.75),
      Rectangle(extent={{-14,44},{14,-84}}, lineColor={43,58,74}, fillColor={31,95,168}, fillPattern=FillPattern.Solid),
      Rectangle(extent={{-28,72},{28,44}}, lineColor={43,58,74}, fillColor={31,95,168}, fillPattern=FillPattern.Solid),
      Rectangle(extent={{-28,-44},{28,-68}}, lineColor={43,58,74}, fillColor={31,95,168}, fillPattern=FillPattern.Solid),
      Text(extent={{-150,120},{150,80}}, textColor={0,0,255}, textString="%name")}),
    Documentation(info="<html>
<p>The interface of a bolted joint: a frame pressed together by bolts, whose pressure is high around each bolt and low between them. Bolts count as soft springs: their own stiffness is not part of the joint.</p>
<h4>Flanges</h4>
<p>The three flanges are side 2 along x, y and z, from the tightened state; z is the normal, positive apart. Side 1 is fixed. Hold a flange that does not move with <code>Modelica.Mechanics.Translational.Components.Fixed</code>.</p>
<h4>Law</h4>
<p>All nodes i of the frame, with shares A<sub>i</sub> of the nominal area, follow one curve p(δ) of pressure over approach, from their own pressure at tightening. Force and stiffness derive from one potential:</p>
<p>U(s) = Σ A<sub>i</sub> [ V(δ<sub>i</sub> − s<sub>z</sub>) + ½ ρ p′(δ<sub>i</sub> − s<sub>z</sub>) (s<sub>x</sub><sup>2</sup> + s<sub>y</sub><sup>2</sup>) ] + P<sub>0</sub> s<sub>z</sub>, &emsp; V′ = p, &emsp; ρ = K<sub>T</sub>/K<sub>N</sub></p>
<p>f = −∂U/∂s − C v, &emsp; K<sub>zz</sub> = ∂<sup>2</sup>U/∂s<sub>z</sub><sup>2</sup>, &emsp; K<sub>xx</sub> = K<sub>yy</sub> = ∂<sup>2</sup>U/∂s<sub>x</sub><sup>2</sup></p>
<p>so a closed path returns its energy, the tangential stiffness follows the normal approach, and shear reacts on the normal force. <code>K_rx</code>, <code>K_ry</code> and <code>K_rz</code> project the stiffness of the nodes on rotations about their centroid. The pressure at tightening spreads each bolt force by 1/(1 + (r/decay_length)<sup>2</sup>)<sup>decay_exponent</sup>; the moment M changes the bolt forces of its two rows by ±M/(L<sub>a</sub> N<sub>b</sub>) (Zhao 2018, section 3). The curve comes from sums over contact spots of truncated area a′ up to the largest one, a′<sub>L</sub>, whose load is p A<sub>0</sub>:</p>
<p>n(a′) = ½ D ψ<sup>1−D/2</sup> a′<sub>L</sub><sup>D/2</sup> a′<sup>−(D+2)/2</sup> (Zhao 2018, Eq. 2)</p>
<p>F = ∫ f n da′, &emsp; f = H a′ below a′<sub>c</sub>, &emsp; f = (4/3) E* R<sup>1/2</sup> δ<sup>3/2</sup> above (Eqs. 4-10, 4 and 9 corrected)</p>
<p>K<sub>N</sub> = ∫ k<sub>n</sub> n da′, &emsp; K<sub>T</sub> = ∫ 8 G′ r (1 − x)<sup>1/3</sup> n da′, &emsp; dp/dδ = K<sub>N</sub>/A<sub>0</sub> (Eqs. 14, 22)</p>
<p>C<sub>n</sub> = η<sub>n</sub> (m K<sub>N</sub>)<sup>1/2</sup>, &emsp; η<sub>n</sub> = Σ W<sub>plastic</sub> / Σ W<sub>elastic</sub> (Eqs. 16-20, corrected)</p>
<p>C<sub>t</sub> = η<sub>t</sub> (m K<sub>T</sub>)<sup>1/2</sup>, &emsp; 1/η<sub>t</sub> = (5π/12) H<sub>2</sub>/H<sub>1</sub> − 1, &emsp; of Mindlin's loop at x = traction_ratio (Eq. 29, corrected)</p>
<p>All nodes of the joint at its preload and moment add up to one curve g(c) of the total force over the approach c = -s<sub>z</sub>, so force and stiffness of all three axes follow from this one table, the reaction of shear on the normal force included:</p>
<p>f<sub>x</sub> = -&rho; g'(c) s<sub>x</sub>, &emsp; f<sub>y</sub> = -&rho; g'(c) s<sub>y</sub>, &emsp; f<sub>z</sub> = g(c) - g(0) + &frac12; &rho; g''(c) (s<sub>x</sub><sup>2</sup> + s<sub>y</sub><sup>2</sup>)</p>
<h4>Not in this table</h4>
<ul>
<li>Preload and moment are those of the record <code>data</code> and cannot change during a simulation. The FMU takes both as inputs.</li>
<li>Rotational stiffness and contact pressures are not given; the FMU gives them.</li>
<li>The normal dissipation factor is interpolated linearly, within 0.001.</li>
<li>The table ends at 10 times the total preload; beyond, the last tangent continues without a warning. With side 2 lifted off, force and stiffness are zero.</li>
</ul>
<h4>How far to trust it</h4>
<ul>
<li><b>Not validated as a stiffness.</b> The paper publishes no stiffness of the joint. What agrees are the contact pressures at the bolt and between two bolts (which calibrate the pressure field), the bolt forces under the moment, and the paper's own intermediate numbers.</li>
<li><b>Estimates.</b> Size of the frame, nominal area <code>A_0</code>, mass, friction and traction ratio are not published. The stiffness depends on <code>A_0</code>: 72 kN over the published pressures bounds it to 0.009 to 0.116 m².</li>
<li><b>Critical area.</b> The printed Eq. 4 makes the force of a spot jump. The default is the area without a jump; the printed one gives a stiffness 6 times lower, the onset of yield one 37 times lower.</li>
<li><b>Closing contact.</b> Below 4 kPa (default parameters) the law has hardly a stiff spot; the curve is continued smoothly to zero and leaves the law.</li>
<li><b>Range.</b> Stiffness is zero once the joint is separated. Beyond the hardness on the whole area the last tangent is continued. A moment that would need a negative bolt force opens the contact there, with a warning.</li>
<li><b>Not inside:</b> slip (the tangential force is not limited to μP), hysteresis in the force, the bolts' own stiffness, the flanges' bending. Damping is the viscous equivalent at the resonance of <code>mass</code>.</li>
<li><b>Trend.</b> An elastic boundary-element solution of rough surfaces finds a stiffness close to proportional to the pressure and hardly dependent on D. The fractal law has lower powers of the pressure, which depend on D.</li>
</ul>
<p>Y. Zhao, C. Yang, L. Cai, W. Shi, Y. Hong: <em>Stiffness and Damping Model of Bolted Joints with Uneven Surface Contact Pressure Distribution.</em> 2018.</p>
</html>"));
end BoltedJoint;
