within JointStiffness.Components;
model BoltedJoint "Bolted joint at a fixed preload: three axes, side 1 fixed"
  parameter JointStiffness.Data.BoltedJoint data = JointStiffness.Data.<< record >>() "The tightened joint"
    annotation (choicesAllMatching=true);
  parameter Modelica.Units.SI.Mass mass(min=0) = data.mass "<< meta.mass >>";
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
  Modelica.Units.SI.TranslationalSpringConstant K_t(nominal=1e10) "<< docs.K_xx >>";
  Modelica.Units.SI.TranslationalDampingConstant C_n(nominal=1e4) "<< docs.C_zz >>";
  Modelica.Units.SI.TranslationalDampingConstant C_t(nominal=1e4) "Viscous-equivalent damping along x and y";
  Real eta_n "<< docs.eta_n >>";
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
<< html.what >>
<h4>Flanges</h4>
<p>The three flanges are side 2 along x, y and z, from the tightened state; z is the normal, positive apart. Side 1 is fixed. Hold a flange that does not move with <code>Modelica.Mechanics.Translational.Components.Fixed</code>.</p>
<h4>Law</h4>
<< html.law >>
<p>All nodes of the joint at its preload and moment add up to one curve g(c) of the total force over the approach c = -s<sub>z</sub>, so force and stiffness of all three axes follow from this one table, the reaction of shear on the normal force included:</p>
<p>f<sub>x</sub> = -&rho; g'(c) s<sub>x</sub>, &emsp; f<sub>y</sub> = -&rho; g'(c) s<sub>y</sub>, &emsp; f<sub>z</sub> = g(c) - g(0) + &frac12; &rho; g''(c) (s<sub>x</sub><sup>2</sup> + s<sub>y</sub><sup>2</sup>)</p>
<h4>Not in this table</h4>
<ul>
<li>Preload and moment are those of the record <code>data</code> and cannot change during a simulation. The FMU takes both as inputs.</li>
<li>Rotational stiffness and contact pressures are not given; the FMU gives them.</li>
<li>The normal dissipation factor is interpolated linearly, within << damping_tolerance >>.</li>
<li>The table ends at << strongest >> times the total preload; beyond, the last tangent continues without a warning. With side 2 lifted off, force and stiffness are zero.</li>
</ul>
<h4>How far to trust it</h4>
<< html.trust >>
<< html.paper >>
</html>"));
end BoltedJoint;
