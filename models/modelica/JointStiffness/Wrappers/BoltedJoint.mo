within JointStiffness.Wrappers;
model BoltedJoint "BoltedJoint as an imported FMU, between flanges"
  parameter Modelica.Units.SI.Force preload(min=0, start=0) "pre-tightening force of each bolt";
  parameter Modelica.Units.SI.Torque moment=0 "bending moment on the joint";
  replaceable JointStiffness.Interfaces.BoltedJoint fmu "Redeclare as the imported FMU"
    annotation (Placement(transformation(extent={{-20,-20},{20,20}})));
  Modelica.Mechanics.Translational.Interfaces.Flange_b flange_x "side 2 along x, side 1 fixed"
    annotation (Placement(transformation(extent={{90,50},{110,70}})));
  Modelica.Mechanics.Translational.Components.GeneralForceToPositionAdaptor adaptor_flange_x(use_pder=true, use_pder2=false)
    annotation (Placement(transformation(extent={{90,50},{70,70}})));
  Modelica.Blocks.Math.Gain reaction_flange_x(k=-1) "The FMU's force is on the neighbour, the adaptor's on the joint"
    annotation (Placement(transformation(extent={{40,30},{50,40}})));
  Modelica.Mechanics.Translational.Interfaces.Flange_b flange_y "side 2 along y, side 1 fixed"
    annotation (Placement(transformation(extent={{90,-10},{110,10}})));
  Modelica.Mechanics.Translational.Components.GeneralForceToPositionAdaptor adaptor_flange_y(use_pder=true, use_pder2=false)
    annotation (Placement(transformation(extent={{90,-10},{70,10}})));
  Modelica.Blocks.Math.Gain reaction_flange_y(k=-1) "The FMU's force is on the neighbour, the adaptor's on the joint"
    annotation (Placement(transformation(extent={{40,-30},{50,-20}})));
  Modelica.Mechanics.Translational.Interfaces.Flange_b flange_z "side 2 along z, side 1 fixed"
    annotation (Placement(transformation(extent={{90,-70},{110,-50}})));
  Modelica.Mechanics.Translational.Components.GeneralForceToPositionAdaptor adaptor_flange_z(use_pder=true, use_pder2=false)
    annotation (Placement(transformation(extent={{90,-70},{70,-50}})));
  Modelica.Blocks.Math.Gain reaction_flange_z(k=-1) "The FMU's force is on the neighbour, the adaptor's on the joint"
    annotation (Placement(transformation(extent={{40,-90},{50,-80}})));
equation
  connect(flange_x, adaptor_flange_x.flange)
    annotation (Line(points={{100,60},{82,60}}, color={0,127,0}));
  connect(adaptor_flange_x.p, fmu.s_rel_x)
    annotation (Line(points={{77,68},{26.5,68},{26.5,6.8},{-24,6.8}}, color={0,0,127}));
  connect(adaptor_flange_x.pder, fmu.v_rel_x)
    annotation (Line(points={{77,65},{26.5,65},{26.5,-6.8},{-24,-6.8}}, color={0,0,127}));
  connect(fmu.f_x, reaction_flange_x.u)
    annotation (Line(points={{22,16.8},{30.5,16.8},{30.5,35},{39,35}}, color={0,0,127}));
  connect(reaction_flange_x.y, adaptor_flange_x.f)
    annotation (Line(points={{50.5,35},{63.75,35},{63.75,52},{77,52}}, color={0,0,127}));
  connect(flange_y, adaptor_flange_y.flange)
    annotation (Line(points={{100,0},{82,0}}, color={0,127,0}));
  connect(adaptor_flange_y.p, fmu.s_rel_y)
    annotation (Line(points={{77,8},{26.5,8},{26.5,2.2},{-24,2.2}}, color={0,0,127}));
  connect(adaptor_flange_y.pder, fmu.v_rel_y)
    annotation (Line(points={{77,5},{26.5,5},{26.5,-11.2},{-24,-11.2}}, color={0,0,127}));
  connect(fmu.f_y, reaction_flange_y.u)
    annotation (Line(points={{22,14.6},{30.5,14.6},{30.5,-25},{39,-25}}, color={0,0,127}));
  connect(reaction_flange_y.y, adaptor_flange_y.f)
    annotation (Line(points={{50.5,-25},{63.75,-25},{63.75,-8},{77,-8}}, color={0,0,127}));
  connect(flange_z, adaptor_flange_z.flange)
    annotation (Line(points={{100,-60},{82,-60}}, color={0,127,0}));
  connect(adaptor_flange_z.p, fmu.s_rel_z)
    annotation (Line(points={{77,-52},{26.5,-52},{26.5,-2.2},{-24,-2.2}}, color={0,0,127}));
  connect(adaptor_flange_z.pder, fmu.v_rel_z)
    annotation (Line(points={{77,-55},{26.5,-55},{26.5,-15.8},{-24,-15.8}}, color={0,0,127}));
  connect(fmu.f_z, reaction_flange_z.u)
    annotation (Line(points={{22,12.4},{30.5,12.4},{30.5,-85},{39,-85}}, color={0,0,127}));
  connect(reaction_flange_z.y, adaptor_flange_z.f)
    annotation (Line(points={{50.5,-85},{63.75,-85},{63.75,-68},{77,-68}}, color={0,0,127}));
  fmu.preload = preload;
  fmu.moment = moment;
  annotation (
    Icon(graphics={
      Rectangle(extent={{-90,80},{90,-80}}, lineColor={43,58,74}, fillColor={255,255,255}, fillPattern=FillPattern.Solid, radius=10),
      Text(extent={{-80,40},{80,-10}}, textColor={31,95,168}, textString="FMU"),
      Text(extent={{-85,-20},{85,-50}}, textColor={43,58,74}, textString="BoltedJoint"),
      Text(extent={{-150,125},{150,85}}, textColor={0,0,255}, textString="%name")}),
    Documentation(info="<html>
<p>The FMU BoltedJoint between flanges. It takes motion and gives force, so it belongs between inertias.</p>
<p>Redeclare <code>fmu</code> as the class that your tool made of the FMU; set the FMU's parameters there.</p>
</html>"));
end BoltedJoint;
