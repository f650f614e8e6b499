within JointStiffness.Components;
model AngleProfile "A turn from rest to rest, as a motor makes it that follows its command exactly"
  parameter Modelica.Units.SI.Time start=0 "Begin of the turn";
  parameter Modelica.Units.SI.Time duration(min=Modelica.Constants.small)=1 "From its begin to its end";
  parameter Modelica.Units.SI.Angle height=0 "Angle of the turn";
  Modelica.Mechanics.Rotational.Interfaces.Flange_b flange "The motor's shaft"
    annotation (Placement(transformation(extent={{90,-10},{110,10}})));
  Modelica.Units.SI.Angle phi(start=0, fixed=true, nominal=0.1) "Angle";
  Modelica.Units.SI.AngularVelocity w "Speed";
protected
  Real x "Time over the duration, between 0 and 1";
equation
  x = if time < start then 0 elseif time < start + duration then (time - start)/duration else 1;
  w = 30*height/duration*(x*(1 - x))^2;
  der(phi) = w;
  flange.phi = phi;
  annotation (
    Icon(graphics={
      Line(points={{-80,68},{-80,-80}}, color={192,192,192}),
      Line(points={{-90,-70},{82,-70}}, color={192,192,192}),
      Line(points={{-80,-70},{-50,-70},{-30,-60},{-10,-20},{10,20},{30,50},{50,60},{80,60}}, color={31,95,168}, thickness=0.5)}),
    Documentation(info="<html>
<p>The motion of the FMU <code>AngleProfile</code>: a quintic from rest to rest. The angle is the integral of the speed, so that the flange has a state, as on an inertia. Start and end are time events.</p>
</html>"));
end AngleProfile;
