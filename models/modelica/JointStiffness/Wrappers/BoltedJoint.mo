within JointStiffness.Wrappers;
model BoltedJoint "BoltedJoint as an imported FMU, between flanges"
  parameter Modelica.Units.SI.Force preload(min=0, start=0) "preload of each bolt (bolt force at tightening)";
  parameter Modelica.Units.SI.Torque moment=0 "bending moment on the joint";
  parameter Modelica.Units.SI.ThermodynamicTemperature temperature=293.15 "temperature of bolts and members; tightened at 293.15 K";
  replaceable JointStiffness.Interfaces.BoltedJoint fmu "Redeclare as the imported FMU"
    annotation (Placement(transformation(extent={{-20,-20},{20,20}})));
  Modelica.Mechanics.Translational.Interfaces.Flange_b flange_x "side 2 along x, side 1 fixed"
    annotation (Placement(transformation(extent={{90,65},{110,85}})));
  Modelica.Mechanics.Translational.Components.GeneralForceToPositionAdaptor adaptor_flange_x(use_pder=true, use_pder2=false)
    annotation (Placement(transformation(extent={{90,65},{70,85}})));
  Modelica.Blocks.Math.Gain reaction_flange_x(k=-1) "The FMU's force is on the neighbour, the adaptor's on the joint"
    annotation (Placement(transformation(extent={{40,45},{50,55}})));
  Modelica.Mechanics.Translational.Interfaces.Flange_b flange_y "side 2 along y, side 1 fixed"
    annotation (Placement(transformation(extent={{90,35},{110,55}})));
  Modelica.Mechanics.Translational.Components.GeneralForceToPositionAdaptor adaptor_flange_y(use_pder=true, use_pder2=false)
    annotation (Placement(transformation(extent={{90,35},{70,55}})));
  Modelica.Blocks.Math.Gain reaction_flange_y(k=-1) "The FMU's force is on the neighbour, the adaptor's on the joint"
    annotation (Placement(transformation(extent={{40,15},{50,25}})));
  Modelica.Mechanics.Translational.Interfaces.Flange_b flange_z "side 2 along z, side 1 fixed"
    annotation (Placement(transformation(extent={{90,5},{110,25}})));
  Modelica.Mechanics.Translational.Components.GeneralForceToPositionAdaptor adaptor_flange_z(use_pder=true, use_pder2=false)
    annotation (Placement(transformation(extent={{90,5},{70,25}})));
  Modelica.Blocks.Math.Gain reaction_flange_z(k=-1) "The FMU's force is on the neighbour, the adaptor's on the joint"
    annotation (Placement(transformation(extent={{40,-15},{50,-5}})));
  Modelica.Mechanics.Rotational.Interfaces.Flange_b flange_turn_x "side 2 about x, side 1 fixed"
    annotation (Placement(transformation(extent={{90,-25},{110,-5}})));
  Modelica.Mechanics.Rotational.Components.GeneralTorqueToAngleAdaptor adaptor_flange_turn_x(use_pder=true, use_pder2=false)
    annotation (Placement(transformation(extent={{90,-25},{70,-5}})));
  Modelica.Blocks.Math.Gain reaction_flange_turn_x(k=-1) "The FMU's force is on the neighbour, the adaptor's on the joint"
    annotation (Placement(transformation(extent={{40,-45},{50,-35}})));
  Modelica.Mechanics.Rotational.Interfaces.Flange_b flange_turn_y "side 2 about y, side 1 fixed"
    annotation (Placement(transformation(extent={{90,-55},{110,-35}})));
  Modelica.Mechanics.Rotational.Components.GeneralTorqueToAngleAdaptor adaptor_flange_turn_y(use_pder=true, use_pder2=false)
    annotation (Placement(transformation(extent={{90,-55},{70,-35}})));
  Modelica.Blocks.Math.Gain reaction_flange_turn_y(k=-1) "The FMU's force is on the neighbour, the adaptor's on the joint"
    annotation (Placement(transformation(extent={{40,-75},{50,-65}})));
  Modelica.Mechanics.Rotational.Interfaces.Flange_b flange_turn_z "side 2 about z, side 1 fixed"
    annotation (Placement(transformation(extent={{90,-85},{110,-65}})));
  Modelica.Mechanics.Rotational.Components.GeneralTorqueToAngleAdaptor adaptor_flange_turn_z(use_pder=true, use_pder2=false)
    annotation (Placement(transformation(extent={{90,-85},{70,-65}})));
  Modelica.Blocks.Math.Gain reaction_flange_turn_z(k=-1) "The FMU's force is on the neighbour, the adaptor's on the joint"
    annotation (Placement(transformation(extent={{40,-105},{50,-95}})));
equation
  connect(flange_x, adaptor_flange_x.flange)
    annotation (Line(points={{100,75},{82,75}}, color={0,127,0}));
  connect(adaptor_flange_x.p, fmu.s_rel_x)
    annotation (Line(points={{77,83},{26.5,83},{26.5,12},{-24,12}}, color={0,0,127}));
  connect(adaptor_flange_x.pder, fmu.v_rel_x)
    annotation (Line(points={{77,80},{26.5,80},{26.5,4.8},{-24,4.8}}, color={0,0,127}));
  connect(fmu.f_x, reaction_flange_x.u)
    annotation (Line(points={{22,17.2},{30.5,17.2},{30.5,50},{39,50}}, color={0,0,127}));
  connect(reaction_flange_x.y, adaptor_flange_x.f)
    annotation (Line(points={{50.5,50},{63.75,50},{63.75,67},{77,67}}, color={0,0,127}));
  connect(flange_y, adaptor_flange_y.flange)
    annotation (Line(points={{100,45},{82,45}}, color={0,127,0}));
  connect(adaptor_flange_y.p, fmu.s_rel_y)
    annotation (Line(points={{77,53},{26.5,53},{26.5,9.6},{-24,9.6}}, color={0,0,127}));
  connect(adaptor_flange_y.pder, fmu.v_rel_y)
    annotation (Line(points={{77,50},{26.5,50},{26.5,2.4},{-24,2.4}}, color={0,0,127}));
  connect(fmu.f_y, reaction_flange_y.u)
    annotation (Line(points={{22,15.8},{30.5,15.8},{30.5,20},{39,20}}, color={0,0,127}));
  connect(reaction_flange_y.y, adaptor_flange_y.f)
    annotation (Line(points={{50.5,20},{63.75,20},{63.75,37},{77,37}}, color={0,0,127}));
  connect(flange_z, adaptor_flange_z.flange)
    annotation (Line(points={{100,15},{82,15}}, color={0,127,0}));
  connect(adaptor_flange_z.p, fmu.s_rel_z)
    annotation (Line(points={{77,23},{26.5,23},{26.5,7.2},{-24,7.2}}, color={0,0,127}));
  connect(adaptor_flange_z.pder, fmu.v_rel_z)
    annotation (Line(points={{77,20},{26.5,20},{26.5,0},{-24,0}}, color={0,0,127}));
  connect(fmu.f_z, reaction_flange_z.u)
    annotation (Line(points={{22,14.4},{30.5,14.4},{30.5,-10},{39,-10}}, color={0,0,127}));
  connect(reaction_flange_z.y, adaptor_flange_z.f)
    annotation (Line(points={{50.5,-10},{63.75,-10},{63.75,7},{77,7}}, color={0,0,127}));
  connect(flange_turn_x, adaptor_flange_turn_x.flange)
    annotation (Line(points={{100,-15},{82,-15}}, color={0,0,0}));
  connect(adaptor_flange_turn_x.p, fmu.theta_x)
    annotation (Line(points={{77,-7},{26.5,-7},{26.5,-2.4},{-24,-2.4}}, color={0,0,127}));
  connect(adaptor_flange_turn_x.pder, fmu.omega_x)
    annotation (Line(points={{77,-10},{26.5,-10},{26.5,-9.6},{-24,-9.6}}, color={0,0,127}));
  connect(fmu.m_x, reaction_flange_turn_x.u)
    annotation (Line(points={{22,13},{30.5,13},{30.5,-40},{39,-40}}, color={0,0,127}));
  connect(reaction_flange_turn_x.y, adaptor_flange_turn_x.f)
    annotation (Line(points={{50.5,-40},{63.75,-40},{63.75,-23},{77,-23}}, color={0,0,127}));
  connect(flange_turn_y, adaptor_flange_turn_y.flange)
    annotation (Line(points={{100,-45},{82,-45}}, color={0,0,0}));
  connect(adaptor_flange_turn_y.p, fmu.theta_y)
    annotation (Line(points={{77,-37},{26.5,-37},{26.5,-4.8},{-24,-4.8}}, color={0,0,127}));
  connect(adaptor_flange_turn_y.pder, fmu.omega_y)
    annotation (Line(points={{77,-40},{26.5,-40},{26.5,-12},{-24,-12}}, color={0,0,127}));
  connect(fmu.m_y, reaction_flange_turn_y.u)
    annotation (Line(points={{22,11.6},{30.5,11.6},{30.5,-70},{39,-70}}, color={0,0,127}));
  connect(reaction_flange_turn_y.y, adaptor_flange_turn_y.f)
    annotation (Line(points={{50.5,-70},{63.75,-70},{63.75,-53},{77,-53}}, color={0,0,127}));
  connect(flange_turn_z, adaptor_flange_turn_z.flange)
    annotation (Line(points={{100,-75},{82,-75}}, color={0,0,0}));
  connect(adaptor_flange_turn_z.p, fmu.theta_z)
    annotation (Line(points={{77,-67},{26.5,-67},{26.5,-7.2},{-24,-7.2}}, color={0,0,127}));
  connect(adaptor_flange_turn_z.pder, fmu.omega_z)
    annotation (Line(points={{77,-70},{26.5,-70},{26.5,-14.4},{-24,-14.4}}, color={0,0,127}));
  connect(fmu.m_z, reaction_flange_turn_z.u)
    annotation (Line(points={{22,10},{30.5,10},{30.5,-100},{39,-100}}, color={0,0,127}));
  connect(reaction_flange_turn_z.y, adaptor_flange_turn_z.f)
    annotation (Line(points={{50.5,-100},{63.75,-100},{63.75,-83},{77,-83}}, color={0,0,127}));
  fmu.preload = preload;
  fmu.moment = moment;
  fmu.temperature = temperature;
  annotation (
    Icon(graphics={
      Rectangle(extent={{-90,80},{90,-80}}, lineColor={43,58,74}, fillColor={255,255,255}, fillPattern=FillPattern.Solid, radius=10),
      Text(extent={{-80,40},{80,-10}}, textColor={31,95,168}, textString="FMU"),
      Text(extent={{-85,-20},{85,-50}}, textColor={43,58,74}, textString="BoltedJoint"),
      Text(extent={{-150,125},{150,85}}, textColor={0,0,255}, textString="%name")}),
    Documentation(info="<html>
<p>The FMU BoltedJoint between flanges. It takes motion and gives force, so it belongs between inertias.</p>
<p>Redeclare <code>fmu</code> as the class that your tool created from the FMU; set the FMU's parameters there.</p>
</html>"));
end BoltedJoint;
