within JointStiffness.Components;
block TorqueCurve "A torque over time as a Bernstein polynomial, held before and after it"
  extends Modelica.Blocks.Interfaces.SO;
  parameter Modelica.Units.SI.Time start=0 "Begin of the curve";
  parameter Modelica.Units.SI.Time duration(min=Modelica.Constants.small)=1 "From its begin to its end";
  parameter Modelica.Units.SI.Torque p[17]=zeros(17) "Points of the polynomial";
protected
  Real x "Time over the duration, between 0 and 1";
equation
  x = if time < start then 0 elseif time < start + duration then (time - start)/duration else 1;
  y = (1 - x)^16*p[1]
    + 16*x^1*(1 - x)^15*p[2]
    + 120*x^2*(1 - x)^14*p[3]
    + 560*x^3*(1 - x)^13*p[4]
    + 1820*x^4*(1 - x)^12*p[5]
    + 4368*x^5*(1 - x)^11*p[6]
    + 8008*x^6*(1 - x)^10*p[7]
    + 11440*x^7*(1 - x)^9*p[8]
    + 12870*x^8*(1 - x)^8*p[9]
    + 11440*x^9*(1 - x)^7*p[10]
    + 8008*x^10*(1 - x)^6*p[11]
    + 4368*x^11*(1 - x)^5*p[12]
    + 1820*x^12*(1 - x)^4*p[13]
    + 560*x^13*(1 - x)^3*p[14]
    + 120*x^14*(1 - x)^2*p[15]
    + 16*x^15*(1 - x)^1*p[16]
    + x^16*p[17];
  annotation (
    Icon(graphics={
      Line(points={{-80,68},{-80,-80}}, color={192,192,192}),
      Line(points={{-90,-70},{82,-70}}, color={192,192,192}),
      Line(points={{-80,-70},{-50,-70},{-30,-20},{0,50},{20,40},{40,-10},{60,-30},{80,-30}}, color={31,95,168}, thickness=0.5)}),
    Documentation(info="<html>
<p>The torque of the FMU <code>TorqueCurve</code>. Start and end are time events.</p>
</html>"));
end TorqueCurve;
