within JointStiffness.Components;
model GearContact "Contact of two rough tooth flanks along their normal"
  extends Modelica.Mechanics.Translational.Interfaces.PartialCompliant;
  parameter JointStiffness.Data.GearContact data = JointStiffness.Data.<< record >>() "The contact"
    annotation (choicesAllMatching=true);
  parameter Modelica.Units.SI.Distance s_rel0=0 "Distance of the flanges at first touch";
  Modelica.Units.SI.Position approach(nominal=1e-6) "<< docs.s_rel >>, negative while separated";
  Modelica.Units.SI.TranslationalSpringConstant K_N(nominal=1e9) "Tangent stiffness";
equation
  approach = s_rel0 - s_rel;
  f = -JointStiffness.Functions.load(approach, data.table);
  K_N = JointStiffness.Functions.stiffness(approach, data.table);
  annotation (
    defaultComponentName="gearContact",
    Icon(graphics={
      Polygon(points={{-90,-60},{-90,60},{-30,60},{-6,20},{-6,-20},{-30,-60},{-90,-60}}, lineColor={43,58,74}, fillColor={174,189,203}, fillPattern=FillPattern.Solid),
      Polygon(points={{90,60},{90,-60},{30,-60},{6,-20},{6,20},{30,60},{90,60}}, lineColor={43,58,74}, fillColor={211,222,230}, fillPattern=FillPattern.Solid),
      Line(points={{0,24},{-4,16},{4,8},{-4,0},{4,-8},{-4,-16},{0,-24}}, color={209,67,43}, thickness=0.75),
      Text(extent={{-150,110},{150,70}}, textColor={0,0,255}, textString="%name")}),
    Documentation(info="<html>
<< html.what >>
<h4>Flanges</h4>
<p>The flanks touch when flange_b is <code>s_rel0</code> from flange_a and a compressive force acts when they come closer; separated flanks have no force. The law has no damping.</p>
<h4>Law</h4>
<< html.law >>
<h4>Not in this table</h4>
<p>Real area and its elastic part are outputs of the FMU only. The table ends where the mean pressure reaches the hardness, << end >>; beyond, the last tangent continues without a warning.</p>
<h4>How far to trust it</h4>
<< html.trust >>
<< html.paper >>
</html>"));
end GearContact;
