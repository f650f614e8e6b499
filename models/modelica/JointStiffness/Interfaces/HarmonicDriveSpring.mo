within JointStiffness.Interfaces;
partial block HarmonicDriveSpring "Torsional spring and damper of a harmonic drive: motion in, torque out"
  extends Modelica.Blocks.Icons.Block;
  Modelica.Blocks.Interfaces.RealInput phi1(unit="rad") "angle of the wave-generator (motor) flange"
    annotation (Placement(transformation(extent={{-140,52},{-100,92}})));
  Modelica.Blocks.Interfaces.RealInput w1(unit="rad/s") "speed of the wave-generator (motor) flange"
    annotation (Placement(transformation(extent={{-140,16},{-100,56}})));
  Modelica.Blocks.Interfaces.RealInput phi2(unit="rad") "angle of the output flange"
    annotation (Placement(transformation(extent={{-140,-20},{-100,20}})));
  Modelica.Blocks.Interfaces.RealInput w2(unit="rad/s") "speed of the output flange"
    annotation (Placement(transformation(extent={{-140,-56},{-100,-16}})));
  Modelica.Blocks.Interfaces.RealInput temperature(unit="K", min=0) "of the lubricant"
    annotation (Placement(transformation(extent={{-140,-92},{-100,-52}})));
  Modelica.Blocks.Interfaces.RealOutput tau1(unit="N.m") "torque on flange 1, tau (1/ratio + dphi_error/dphi1) - tau_friction"
    annotation (Placement(transformation(extent={{100,72},{120,92}})));
  Modelica.Blocks.Interfaces.RealOutput tau2(unit="N.m") "torque of the element on flange 2, -tau"
    annotation (Placement(transformation(extent={{100,58},{120,78}})));
  Modelica.Blocks.Interfaces.RealOutput phi_rel(unit="rad") "wind-up at the output, phi2 - phi1/ratio - phi_error"
    annotation (Placement(transformation(extent={{100,42},{120,62}})));
  Modelica.Blocks.Interfaces.RealOutput tau(unit="N.m") "T(phi_rel) + T_h + d der(phi_rel), T_h the friction of the hysteresis"
    annotation (Placement(transformation(extent={{100,28},{120,48}})));
  Modelica.Blocks.Interfaces.RealOutput K_WTS(unit="N.m/rad") "tangent stiffness dT/dphi of the midline at the present wind-up"
    annotation (Placement(transformation(extent={{100,12},{120,32}})));
  Modelica.Blocks.Interfaces.RealOutput K_TS(unit="N.m/rad") "its part of the contact pair: 1/K_WTS = 1/K_FTS + 1/K_TS"
    annotation (Placement(transformation(extent={{100,-2},{120,18}})));
  Modelica.Blocks.Interfaces.RealOutput K_FTS(unit="N.m/rad") "its part of circular spline and flexspline"
    annotation (Placement(transformation(extent={{100,-18},{120,2}})));
  Modelica.Blocks.Interfaces.RealOutput K_TS_pair(unit="N.m/rad") "K_TS over drive_scale, if any: scale of Hu 2023, Fig. 11"
    annotation (Placement(transformation(extent={{100,-32},{120,-12}})));
  Modelica.Blocks.Interfaces.RealOutput p_max(unit="Pa") "peak contact pressure, at the major axis and the cup's opening"
    annotation (Placement(transformation(extent={{100,-48},{120,-28}})));
  Modelica.Blocks.Interfaces.RealOutput E_loss(unit="J") "work turned into heat by hysteresis and dry friction since initialization"
    annotation (Placement(transformation(extent={{100,-62},{120,-42}})));
  Modelica.Blocks.Interfaces.RealOutput tau_friction(unit="N.m") "friction of the wave generator, positive where it turns so"
    annotation (Placement(transformation(extent={{100,-78},{120,-58}})));
  Modelica.Blocks.Interfaces.RealOutput phi_error(unit="rad") "kinematic error at the output, a function of phi1"
    annotation (Placement(transformation(extent={{100,-92},{120,-72}})));
  annotation (
    Icon(graphics={Text(extent={{-90,30},{90,-30}}, textColor={43,58,74}, textString="FMU")}),
    Documentation(info="<html>
<p>Inputs and outputs of the FMU HarmonicDriveSpring: Torsional spring and damper of a harmonic drive: motion in, torque out.</p>
</html>"));
end HarmonicDriveSpring;
