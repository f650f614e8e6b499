within JointStiffness.Interfaces;
partial block GearMesh "Mesh of two gear wheels with rough flanks and backlash: motion in, torque out"
  extends Modelica.Blocks.Icons.Block;
  Modelica.Blocks.Interfaces.RealInput phi1(unit="rad") "angle of wheel 1; wheels roll with r_b1 phi1 + r_b2 phi2 = 0"
    annotation (Placement(transformation(extent={{-140,48},{-100,88}})));
  Modelica.Blocks.Interfaces.RealInput w1(unit="rad/s") "speed of wheel 1"
    annotation (Placement(transformation(extent={{-140,2},{-100,42}})));
  Modelica.Blocks.Interfaces.RealInput phi2(unit="rad") "angle of wheel 2; wheels roll with r_b1 phi1 + r_b2 phi2 = 0"
    annotation (Placement(transformation(extent={{-140,-42},{-100,-2}})));
  Modelica.Blocks.Interfaces.RealInput w2(unit="rad/s") "speed of wheel 2"
    annotation (Placement(transformation(extent={{-140,-88},{-100,-48}})));
  Modelica.Blocks.Interfaces.RealOutput tau1(unit="N.m") "torque of the mesh on wheel 1"
    annotation (Placement(transformation(extent={{100,71},{120,91}})));
  Modelica.Blocks.Interfaces.RealOutput tau2(unit="N.m") "torque of the mesh on wheel 2"
    annotation (Placement(transformation(extent={{100,53},{120,73}})));
  Modelica.Blocks.Interfaces.RealOutput s_rel(unit="m") "deflection r_b1 phi1 + r_b2 phi2 beyond half the backlash, 0 within it"
    annotation (Placement(transformation(extent={{100,35},{120,55}})));
  Modelica.Blocks.Interfaces.RealOutput transmission_error(unit="m") "lag of wheel 2 along the line of action, with the teeth deflected; 0 without load"
    annotation (Placement(transformation(extent={{100,17},{120,37}})));
  Modelica.Blocks.Interfaces.RealOutput f(unit="N") "normal force of the mesh, positive on the driving flanks"
    annotation (Placement(transformation(extent={{100,-1},{120,19}})));
  Modelica.Blocks.Interfaces.RealOutput K(unit="N/m") "stiffness df/ds_rel at the present phase of the mesh cycle"
    annotation (Placement(transformation(extent={{100,-19},{120,1}})));
  Modelica.Blocks.Interfaces.RealOutput pairs(unit="1") "tooth pairs in contact at the present phase, if the flanks touch"
    annotation (Placement(transformation(extent={{100,-37},{120,-17}})));
  Modelica.Blocks.Interfaces.RealOutput E(unit="J") "elastic energy of the mesh"
    annotation (Placement(transformation(extent={{100,-55},{120,-35}})));
  Modelica.Blocks.Interfaces.RealOutput step_at_once(unit="s") "largest stable step for a sequential (Gauss-Seidel) master, which passes the new force on before the body steps: with inertia1, inertia2, K, d"
    annotation (Placement(transformation(extent={{100,-73},{120,-53}})));
  Modelica.Blocks.Interfaces.RealOutput step_side_by_side(unit="s") "largest stable step for a parallel (Jacobi) master with lag_b = 1; 0: unstable at any step: with inertia1, inertia2, K, d"
    annotation (Placement(transformation(extent={{100,-91},{120,-71}})));
  annotation (
    Icon(graphics={Text(extent={{-90,30},{90,-30}}, textColor={43,58,74}, textString="FMU")}),
    Documentation(info="<html>
<p>Inputs and outputs of the FMU GearMesh: Mesh of two gear wheels with rough flanks and backlash: motion in, torque out.</p>
</html>"));
end GearMesh;
