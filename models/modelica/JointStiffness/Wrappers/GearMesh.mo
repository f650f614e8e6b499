within JointStiffness.Wrappers;
model GearMesh "GearMesh as an imported FMU, between flanges"
  replaceable JointStiffness.Interfaces.GearMesh fmu "Redeclare as the imported FMU"
    annotation (Placement(transformation(extent={{-20,-20},{20,20}})));
  Modelica.Mechanics.Rotational.Interfaces.Flange_a flange1 "wheel 1"
    annotation (Placement(transformation(extent={{-110,-10},{-90,10}})));
  Modelica.Mechanics.Rotational.Components.GeneralTorqueToAngleAdaptor adaptor_flange1(use_pder=true, use_pder2=false)
    annotation (Placement(transformation(extent={{-90,-10},{-70,10}})));
  Modelica.Blocks.Math.Gain reaction_flange1(k=-1) "The FMU's force is on the neighbour, the adaptor's on the joint"
    annotation (Placement(transformation(extent={{-40,-30},{-50,-20}})));
  Modelica.Mechanics.Rotational.Interfaces.Flange_b flange2 "wheel 2"
    annotation (Placement(transformation(extent={{90,-10},{110,10}})));
  Modelica.Mechanics.Rotational.Components.GeneralTorqueToAngleAdaptor adaptor_flange2(use_pder=true, use_pder2=false)
    annotation (Placement(transformation(extent={{90,-10},{70,10}})));
  Modelica.Blocks.Math.Gain reaction_flange2(k=-1) "The FMU's force is on the neighbour, the adaptor's on the joint"
    annotation (Placement(transformation(extent={{40,-30},{50,-20}})));
equation
  connect(flange1, adaptor_flange1.flange)
    annotation (Line(points={{-100,0},{-82,0}}, color={0,0,0}));
  connect(adaptor_flange1.p, fmu.phi1)
    annotation (Line(points={{-77,8},{-50.5,8},{-50.5,13.6},{-24,13.6}}, color={0,0,127}));
  connect(adaptor_flange1.pder, fmu.w1)
    annotation (Line(points={{-77,5},{-50.5,5},{-50.5,4.4},{-24,4.4}}, color={0,0,127}));
  connect(fmu.tau1, reaction_flange1.u)
    annotation (Line(points={{22,16.2},{-8.5,16.2},{-8.5,-25},{-39,-25}}, color={0,0,127}));
  connect(reaction_flange1.y, adaptor_flange1.f)
    annotation (Line(points={{-50.5,-25},{-63.75,-25},{-63.75,-8},{-77,-8}}, color={0,0,127}));
  connect(flange2, adaptor_flange2.flange)
    annotation (Line(points={{100,0},{82,0}}, color={0,0,0}));
  connect(adaptor_flange2.p, fmu.phi2)
    annotation (Line(points={{77,8},{26.5,8},{26.5,-4.4},{-24,-4.4}}, color={0,0,127}));
  connect(adaptor_flange2.pder, fmu.w2)
    annotation (Line(points={{77,5},{26.5,5},{26.5,-13.6},{-24,-13.6}}, color={0,0,127}));
  connect(fmu.tau2, reaction_flange2.u)
    annotation (Line(points={{22,12.6},{30.5,12.6},{30.5,-25},{39,-25}}, color={0,0,127}));
  connect(reaction_flange2.y, adaptor_flange2.f)
    annotation (Line(points={{50.5,-25},{63.75,-25},{63.75,-8},{77,-8}}, color={0,0,127}));
  annotation (
    Icon(graphics={
      Rectangle(extent={{-90,80},{90,-80}}, lineColor={43,58,74}, fillColor={255,255,255}, fillPattern=FillPattern.Solid, radius=10),
      Text(extent={{-80,40},{80,-10}}, textColor={31,95,168}, textString="FMU"),
      Text(extent={{-85,-20},{85,-50}}, textColor={43,58,74}, textString="GearMesh"),
      Text(extent={{-150,125},{150,85}}, textColor={0,0,255}, textString="%name")}),
    Documentation(info="<html>
<p>The FMU GearMesh between flanges. It takes motion and gives force, so it belongs between inertias.</p>
<p>Redeclare <code>fmu</code> as the class that your tool created from the FMU; set the FMU's parameters there.</p>
</html>"));
end GearMesh;
