within JointStiffness.Wrappers;
model GearContact "GearContact as an imported FMU, between flanges"
  replaceable JointStiffness.Interfaces.GearContact fmu "Redeclare as the imported FMU"
    annotation (Placement(transformation(extent={{-20,-20},{20,20}})));
  Modelica.Mechanics.Translational.Interfaces.Flange_a flange "one flank pressed on the other, along the normal"
    annotation (Placement(transformation(extent={{-110,-10},{-90,10}})));
  Modelica.Mechanics.Translational.Components.GeneralPositionToForceAdaptor adaptor_flange(use_pder=false, use_pder2=false)
    annotation (Placement(transformation(extent={{-90,-10},{-70,10}})));
  Modelica.Blocks.Math.Gain reaction_flange(k=-1) "The FMU's force is on the neighbour, the adaptor's on the joint"
    annotation (Placement(transformation(extent={{-50,-30},{-40,-20}})));
equation
  connect(flange, adaptor_flange.flange)
    annotation (Line(points={{-100,0},{-82,0}}, color={0,127,0}));
  connect(adaptor_flange.f, reaction_flange.y)
    annotation (Line(points={{-77,-8},{-58.25,-8},{-58.25,-25},{-39.5,-25}}, color={0,0,127}));
  connect(reaction_flange.u, fmu.f)
    annotation (Line(points={{-51,-25},{-37.5,-25},{-37.5,0},{-24,0}}, color={0,0,127}));
  connect(fmu.s_rel, adaptor_flange.p)
    annotation (Line(points={{22,13.6},{-27.5,13.6},{-27.5,8},{-77,8}}, color={0,0,127}));
  annotation (
    Icon(graphics={
      Rectangle(extent={{-90,80},{90,-80}}, lineColor={43,58,74}, fillColor={255,255,255}, fillPattern=FillPattern.Solid, radius=10),
      Text(extent={{-80,40},{80,-10}}, textColor={31,95,168}, textString="FMU"),
      Text(extent={{-85,-20},{85,-50}}, textColor={43,58,74}, textString="GearContact"),
      Text(extent={{-150,125},{150,85}}, textColor={0,0,255}, textString="%name")}),
    Documentation(info="<html>
<p>The FMU GearContact between flanges. The flange follows the FMU's displacement, so give it a force that does not depend on an inertia right at the flange: an inertia there would need the inverse of the FMU. Between inertias take a component of <a href=\"modelica://JointStiffness.Components\">Components</a>.</p>
<p>Redeclare <code>fmu</code> as the class that your tool created from the FMU; set the FMU's parameters there.</p>
</html>"));
end GearContact;
