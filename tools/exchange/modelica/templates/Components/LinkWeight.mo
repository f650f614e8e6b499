within JointStiffness.Components;
model LinkWeight "Weight of a link that turns about a horizontal axis"
  parameter Modelica.Units.SI.Mass m(min=0, start=1) "Mass of the link";
  parameter Modelica.Units.SI.Length l(min=0, start=0.2) "From the axis to the centre of mass";
  Modelica.Mechanics.Rotational.Interfaces.Flange_a flange "The link; zero hangs down"
    annotation (Placement(transformation(extent={{-110,-10},{-90,10}})));
equation
  flange.tau = m*Modelica.Constants.g_n*l*sin(flange.phi);
  annotation (
    Icon(graphics={
      Line(points={{-90,0},{20,50}}, color={43,58,74}, thickness=1.0),
      Ellipse(extent={{4,66},{36,34}}, lineColor={43,58,74}, fillColor={174,189,203}, fillPattern=FillPattern.Solid),
      Line(points={{20,34},{20,-60}}, color={209,67,43}, thickness=0.5, arrow={Arrow.None,Arrow.Filled}),
      Text(extent={{-150,110},{150,70}}, textColor={0,0,255}, textString="%name")}),
    Documentation(info="<html>
<p>The torque of gravity on a link, m g l sin &phi;, with &phi; = 0 when the link hangs down. The inertia of the link is not included.</p>
</html>"));
end LinkWeight;
