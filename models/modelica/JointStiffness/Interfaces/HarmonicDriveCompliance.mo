within JointStiffness.Interfaces;
partial block HarmonicDriveCompliance "Wind-up of a harmonic drive with the wave generator locked: torque in, motion out (Hu 2023)"
  extends Modelica.Blocks.Icons.Block;
  Modelica.Blocks.Interfaces.RealInput tau(unit="N.m") "torque at the output flange"
    annotation (Placement(transformation(extent={{-140,-20},{-100,20}})));
  Modelica.Blocks.Interfaces.RealOutput phi_rel(unit="rad") "wind-up at the output, phi(tau)"
    annotation (Placement(transformation(extent={{100,65},{120,85}})));
  Modelica.Blocks.Interfaces.RealOutput K_WTS(unit="N.m/rad") "tangent stiffness dT/dphi at the present torque"
    annotation (Placement(transformation(extent={{100,35},{120,55}})));
  Modelica.Blocks.Interfaces.RealOutput K_TS(unit="N.m/rad") "its part of the contact pair: 1/K_WTS = 1/K_FTS + 1/K_TS"
    annotation (Placement(transformation(extent={{100,5},{120,25}})));
  Modelica.Blocks.Interfaces.RealOutput K_FTS(unit="N.m/rad") "its part of circular spline and flexspline"
    annotation (Placement(transformation(extent={{100,-25},{120,-5}})));
  Modelica.Blocks.Interfaces.RealOutput K_TS_pair(unit="N.m/rad") "K_TS over drive_scale: the scale of Hu 2023, Fig. 11"
    annotation (Placement(transformation(extent={{100,-55},{120,-35}})));
  Modelica.Blocks.Interfaces.RealOutput p_max(unit="Pa") "peak contact pressure, at the major axis and the cup's opening"
    annotation (Placement(transformation(extent={{100,-85},{120,-65}})));
  annotation (
    Icon(graphics={Text(extent={{-90,30},{90,-30}}, textColor={43,58,74}, textString="FMU")}),
    Documentation(info="<html>
<p>Inputs and outputs of the FMU HarmonicDriveCompliance: Wind-up of a harmonic drive with the wave generator locked: torque in, motion out (Hu 2023).</p>
</html>"));
end HarmonicDriveCompliance;
