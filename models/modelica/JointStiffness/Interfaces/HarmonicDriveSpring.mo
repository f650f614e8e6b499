within JointStiffness.Interfaces;
partial block HarmonicDriveSpring "Torsional spring and damper of a harmonic drive: motion in, torque out (Hu 2023)"
  extends Modelica.Blocks.Icons.Block;
  Modelica.Blocks.Interfaces.RealInput phi1(unit="rad") "angle of the wave-generator (motor) flange"
    annotation (Placement(transformation(extent={{-140,48},{-100,88}})));
  Modelica.Blocks.Interfaces.RealInput w1(unit="rad/s") "speed of the wave-generator (motor) flange"
    annotation (Placement(transformation(extent={{-140,2},{-100,42}})));
  Modelica.Blocks.Interfaces.RealInput phi2(unit="rad") "angle of the output flange"
    annotation (Placement(transformation(extent={{-140,-42},{-100,-2}})));
  Modelica.Blocks.Interfaces.RealInput w2(unit="rad/s") "speed of the output flange"
    annotation (Placement(transformation(extent={{-140,-88},{-100,-48}})));
  Modelica.Blocks.Interfaces.RealOutput tau1(unit="N.m") "torque of the element on flange 1, tau/ratio"
    annotation (Placement(transformation(extent={{100,70},{120,90}})));
  Modelica.Blocks.Interfaces.RealOutput tau2(unit="N.m") "torque of the element on flange 2, -tau"
    annotation (Placement(transformation(extent={{100,50},{120,70}})));
  Modelica.Blocks.Interfaces.RealOutput phi_rel(unit="rad") "wind-up at the output, phi2 - phi1/ratio"
    annotation (Placement(transformation(extent={{100,30},{120,50}})));
  Modelica.Blocks.Interfaces.RealOutput tau(unit="N.m") "T(phi_rel) + d der(phi_rel)"
    annotation (Placement(transformation(extent={{100,10},{120,30}})));
  Modelica.Blocks.Interfaces.RealOutput K_WTS(unit="N.m/rad") "tangent stiffness dT/dphi at the present torque"
    annotation (Placement(transformation(extent={{100,-10},{120,10}})));
  Modelica.Blocks.Interfaces.RealOutput K_TS(unit="N.m/rad") "its part of the contact pair: 1/K_WTS = 1/K_FTS + 1/K_TS"
    annotation (Placement(transformation(extent={{100,-30},{120,-10}})));
  Modelica.Blocks.Interfaces.RealOutput K_FTS(unit="N.m/rad") "its part of circular spline and flexspline"
    annotation (Placement(transformation(extent={{100,-50},{120,-30}})));
  Modelica.Blocks.Interfaces.RealOutput K_TS_pair(unit="N.m/rad") "K_TS over drive_scale: the scale of Hu 2023, Fig. 11"
    annotation (Placement(transformation(extent={{100,-70},{120,-50}})));
  Modelica.Blocks.Interfaces.RealOutput p_max(unit="Pa") "peak contact pressure, at the major axis and the cup's opening"
    annotation (Placement(transformation(extent={{100,-90},{120,-70}})));
  annotation (
    Icon(graphics={Text(extent={{-90,30},{90,-30}}, textColor={43,58,74}, textString="FMU")}),
    Documentation(info="<html>
<p>Inputs and outputs of the FMU HarmonicDriveSpring: Torsional spring and damper of a harmonic drive: motion in, torque out (Hu 2023).</p>
</html>"));
end HarmonicDriveSpring;
