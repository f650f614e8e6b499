within JointStiffness.Components;
block Load "A ramp that stays and a pulse, without corners"
  extends Modelica.Blocks.Interfaces.SO;
  parameter Real ramp_height=0 "Height of the ramp";
  parameter Modelica.Units.SI.Time ramp_start=0 "Begin of the ramp";
  parameter Modelica.Units.SI.Time ramp_duration(min=Modelica.Constants.small)=1 "From the ramp's begin to its end";
  parameter Real pulse_height=0 "Height of the pulse";
  parameter Modelica.Units.SI.Time pulse_start=0 "Begin of the pulse";
  parameter Modelica.Units.SI.Time pulse_rise(min=Modelica.Constants.small)=1e-3 "Rise time of the pulse, and of its fall";
  parameter Modelica.Units.SI.Time pulse_hold(min=0)=1e-3 "Time at the pulse's height";
protected
  parameter Modelica.Units.SI.Time fall=pulse_start + pulse_rise + pulse_hold "Begin of the pulse's fall";
equation
  y = (if time < ramp_start then 0 else ramp_height*JointStiffness.Functions.smoothStep((time - ramp_start)/ramp_duration))
    + (if time < pulse_start then 0 else pulse_height*JointStiffness.Functions.smoothStep((time - pulse_start)/pulse_rise))
    - (if time < fall then 0 else pulse_height*JointStiffness.Functions.smoothStep((time - fall)/pulse_rise));
  annotation (
    Icon(graphics={
      Line(points={{-80,68},{-80,-80}}, color={192,192,192}),
      Line(points={{-90,-70},{82,-70}}, color={192,192,192}),
      Line(points={{-80,-70},{-60,-70},{-40,-60},{-20,-30},{0,-20},{20,-20},{30,0},{34,60},{52,60},{56,0},{66,-20},{80,-20}}, color={31,95,168}, thickness=0.5)}),
    Documentation(info="<html>
<p>The load of the FMUs <code>TorqueProfile</code> and <code>ForceProfile</code>, with the same parameters: edges are quintics with continuous first and second derivative. The start of each edge is a time event, so that a solver with a large step does not miss a short pulse.</p>
</html>"));
end Load;
