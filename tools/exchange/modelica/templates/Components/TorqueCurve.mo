within JointStiffness.Components;
block TorqueCurve "A torque over time as a Bernstein polynomial, held before and after it"
  extends Modelica.Blocks.Interfaces.SO;
  parameter Modelica.Units.SI.Time start=0 "Begin of the curve";
  parameter Modelica.Units.SI.Time duration(min=Modelica.Constants.small)=1 "From its begin to its end";
  parameter Modelica.Units.SI.Torque p[<< points >>]=zeros(<< points >>) "Points of the polynomial";
protected
  Real x "Time over the duration, between 0 and 1";
equation
  x = if time < start then 0 elseif time < start + duration then (time - start)/duration else 1;
  y = (1 - x)^<< points - 1 >>*p[1]
<%- for k in range(1, points - 1) %>
    + << comb(points - 1, k) >>*x^<< k >>*(1 - x)^<< points - 1 - k >>*p[<< k + 1 >>]
<%- endfor %>
    + x^<< points - 1 >>*p[<< points >>];
  annotation (
    Icon(graphics={
      Line(points={{-80,68},{-80,-80}}, color={192,192,192}),
      Line(points={{-90,-70},{82,-70}}, color={192,192,192}),
      Line(points={{-80,-70},{-50,-70},{-30,-20},{0,50},{20,40},{40,-10},{60,-30},{80,-30}}, color={31,95,168}, thickness=0.5)}),
    Documentation(info="<html>
<p>The torque of the FMU <code>TorqueCurve</code>. Start and end are time events.</p>
</html>"));
end TorqueCurve;
