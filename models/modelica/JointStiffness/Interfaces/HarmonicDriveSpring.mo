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
  Modelica.Blocks.Interfaces.RealInput temperature(unit="K", min=0) "temperature of the lubricant"
    annotation (Placement(transformation(extent={{-140,-92},{-100,-52}})));
  Modelica.Blocks.Interfaces.RealOutput tau1(unit="N.m") "torque on flange 1, tau (1/ratio + dphi_error/dphi1) - tau_friction"
    annotation (Placement(transformation(extent={{100,74},{120,94}})));
  Modelica.Blocks.Interfaces.RealOutput tau2(unit="N.m") "torque on flange 2, -tau"
    annotation (Placement(transformation(extent={{100,61},{120,81}})));
  Modelica.Blocks.Interfaces.RealOutput phi_rel(unit="rad") "wind-up at the output, phi2 - phi1/ratio - phi_error"
    annotation (Placement(transformation(extent={{100,48},{120,68}})));
  Modelica.Blocks.Interfaces.RealOutput tau(unit="N.m") "output torque: midline T(phi_rel) + hysteresis friction T_h + d der(phi_rel)"
    annotation (Placement(transformation(extent={{100,35},{120,55}})));
  Modelica.Blocks.Interfaces.RealOutput K_WTS(unit="N.m/rad") "tangent stiffness dT/dphi of the midline at the present wind-up"
    annotation (Placement(transformation(extent={{100,22},{120,42}})));
  Modelica.Blocks.Interfaces.RealOutput K_TS(unit="N.m/rad") "stiffness of the contact pair: 1/K_WTS = 1/K_FTS + 1/K_TS"
    annotation (Placement(transformation(extent={{100,9},{120,29}})));
  Modelica.Blocks.Interfaces.RealOutput K_FTS(unit="N.m/rad") "stiffness of circular spline and flexspline"
    annotation (Placement(transformation(extent={{100,-4},{120,16}})));
  Modelica.Blocks.Interfaces.RealOutput K_TS_pair(unit="N.m/rad") "K_TS divided by drive_scale (if the law has one): scale of Hu 2023, Fig. 11"
    annotation (Placement(transformation(extent={{100,-16},{120,4}})));
  Modelica.Blocks.Interfaces.RealOutput p_max(unit="Pa") "peak contact pressure, at the major axis and the cup's opening"
    annotation (Placement(transformation(extent={{100,-29},{120,-9}})));
  Modelica.Blocks.Interfaces.RealOutput E_loss(unit="J") "energy dissipated by hysteresis and dry friction since initialization"
    annotation (Placement(transformation(extent={{100,-42},{120,-22}})));
  Modelica.Blocks.Interfaces.RealOutput tau_friction(unit="N.m") "friction torque at the wave generator, positive if it opposes positive rotation"
    annotation (Placement(transformation(extent={{100,-55},{120,-35}})));
  Modelica.Blocks.Interfaces.RealOutput phi_error(unit="rad") "kinematic error at the output, a function of phi1"
    annotation (Placement(transformation(extent={{100,-68},{120,-48}})));
  Modelica.Blocks.Interfaces.RealOutput step_at_once(unit="s") "largest stable step for a sequential (Gauss-Seidel) master, which passes the new force on before the body steps: with inertia1, inertia2, K_WTS, d"
    annotation (Placement(transformation(extent={{100,-81},{120,-61}})));
  Modelica.Blocks.Interfaces.RealOutput step_side_by_side(unit="s") "largest stable step for a parallel (Jacobi) master with lag_b = 1; 0: unstable at any step: with inertia1, inertia2, K_WTS, d"
    annotation (Placement(transformation(extent={{100,-94},{120,-74}})));
  annotation (
    Icon(graphics={Text(extent={{-90,30},{90,-30}}, textColor={43,58,74}, textString="FMU")}),
    Documentation(info="<html>
<p>Inputs and outputs of the FMU HarmonicDriveSpring: Torsional spring and damper of a harmonic drive: motion in, torque out.</p>
</html>"));
end HarmonicDriveSpring;
