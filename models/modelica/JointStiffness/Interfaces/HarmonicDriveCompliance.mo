within JointStiffness.Interfaces;
partial block HarmonicDriveCompliance "Wind-up of a harmonic drive with the wave generator locked: torque in, motion out"
  extends Modelica.Blocks.Icons.Block;
  Modelica.Blocks.Interfaces.RealInput tau(unit="N.m") "torque at the output flange"
    annotation (Placement(transformation(extent={{-140,-20},{-100,20}})));
  Modelica.Blocks.Interfaces.RealOutput phi_rel(unit="rad") "wind-up at the output, phi(tau - T_h)"
    annotation (Placement(transformation(extent={{100,67},{120,87}})));
  Modelica.Blocks.Interfaces.RealOutput K_WTS(unit="N.m/rad") "tangent stiffness dT/dphi of the midline at the present wind-up"
    annotation (Placement(transformation(extent={{100,41},{120,61}})));
  Modelica.Blocks.Interfaces.RealOutput K_TS(unit="N.m/rad") "stiffness of the contact pair: 1/K_WTS = 1/K_FTS + 1/K_TS"
    annotation (Placement(transformation(extent={{100,16},{120,36}})));
  Modelica.Blocks.Interfaces.RealOutput K_FTS(unit="N.m/rad") "stiffness of circular spline and flexspline"
    annotation (Placement(transformation(extent={{100,-10},{120,10}})));
  Modelica.Blocks.Interfaces.RealOutput K_TS_pair(unit="N.m/rad") "K_TS divided by drive_scale (if the law has one): scale of Hu 2023, Fig. 11"
    annotation (Placement(transformation(extent={{100,-36},{120,-16}})));
  Modelica.Blocks.Interfaces.RealOutput p_max(unit="Pa") "peak contact pressure, at the major axis and the cup's opening"
    annotation (Placement(transformation(extent={{100,-61},{120,-41}})));
  Modelica.Blocks.Interfaces.RealOutput E_loss(unit="J") "energy dissipated by hysteresis and dry friction since initialization"
    annotation (Placement(transformation(extent={{100,-87},{120,-67}})));
  annotation (
    Icon(graphics={Text(extent={{-90,30},{90,-30}}, textColor={43,58,74}, textString="FMU")}),
    Documentation(info="<html>
<p>Inputs and outputs of the FMU HarmonicDriveCompliance: Wind-up of a harmonic drive with the wave generator locked: torque in, motion out.</p>
</html>"));
end HarmonicDriveCompliance;
