within JointStiffness.Interfaces;
partial block BoltedJoint "Bolted joint under uneven pressure: motion in, force out"
  extends Modelica.Blocks.Icons.Block;
  Modelica.Blocks.Interfaces.RealInput preload(unit="N", min=0) "preload of each bolt (bolt force at tightening)"
    annotation (Placement(transformation(extent={{-140,64},{-100,104}})));
  Modelica.Blocks.Interfaces.RealInput moment(unit="N.m") "bending moment on the joint"
    annotation (Placement(transformation(extent={{-140,52},{-100,92}})));
  Modelica.Blocks.Interfaces.RealInput s_rel_x(unit="m") "displacement of side 2 from the tightened state, along the bolt rows"
    annotation (Placement(transformation(extent={{-140,40},{-100,80}})));
  Modelica.Blocks.Interfaces.RealInput s_rel_y(unit="m") "displacement of side 2 from the tightened state, across the bolt rows"
    annotation (Placement(transformation(extent={{-140,28},{-100,68}})));
  Modelica.Blocks.Interfaces.RealInput s_rel_z(unit="m") "displacement of side 2 from the tightened state, along the normal, positive: sides separate"
    annotation (Placement(transformation(extent={{-140,16},{-100,56}})));
  Modelica.Blocks.Interfaces.RealInput v_rel_x(unit="m/s") "rate of s_rel_x"
    annotation (Placement(transformation(extent={{-140,4},{-100,44}})));
  Modelica.Blocks.Interfaces.RealInput v_rel_y(unit="m/s") "rate of s_rel_y"
    annotation (Placement(transformation(extent={{-140,-8},{-100,32}})));
  Modelica.Blocks.Interfaces.RealInput v_rel_z(unit="m/s") "rate of s_rel_z"
    annotation (Placement(transformation(extent={{-140,-20},{-100,20}})));
  Modelica.Blocks.Interfaces.RealInput theta_x(unit="rad") "small rotation of side 2 about x through the joint's centre"
    annotation (Placement(transformation(extent={{-140,-32},{-100,8}})));
  Modelica.Blocks.Interfaces.RealInput theta_y(unit="rad") "small rotation of side 2 about y through the joint's centre"
    annotation (Placement(transformation(extent={{-140,-44},{-100,-4}})));
  Modelica.Blocks.Interfaces.RealInput theta_z(unit="rad") "small rotation of side 2 about z through the joint's centre"
    annotation (Placement(transformation(extent={{-140,-56},{-100,-16}})));
  Modelica.Blocks.Interfaces.RealInput omega_x(unit="rad/s") "rate of theta_x"
    annotation (Placement(transformation(extent={{-140,-68},{-100,-28}})));
  Modelica.Blocks.Interfaces.RealInput omega_y(unit="rad/s") "rate of theta_y"
    annotation (Placement(transformation(extent={{-140,-80},{-100,-40}})));
  Modelica.Blocks.Interfaces.RealInput omega_z(unit="rad/s") "rate of theta_z"
    annotation (Placement(transformation(extent={{-140,-92},{-100,-52}})));
  Modelica.Blocks.Interfaces.RealInput temperature(unit="K", min=0) "temperature of bolts and members; tightened at 293.15 K"
    annotation (Placement(transformation(extent={{-140,-104},{-100,-64}})));
  Modelica.Blocks.Interfaces.RealOutput f_x(unit="N") "restoring force on side 2 along x"
    annotation (Placement(transformation(extent={{100,76},{120,96}})));
  Modelica.Blocks.Interfaces.RealOutput f_y(unit="N") "restoring force on side 2 along y"
    annotation (Placement(transformation(extent={{100,69},{120,89}})));
  Modelica.Blocks.Interfaces.RealOutput f_z(unit="N") "restoring force on side 2 along the normal, negative when the sides are pulled apart"
    annotation (Placement(transformation(extent={{100,62},{120,82}})));
  Modelica.Blocks.Interfaces.RealOutput m_x(unit="N.m") "restoring moment on side 2 about x through the joint's centre"
    annotation (Placement(transformation(extent={{100,55},{120,75}})));
  Modelica.Blocks.Interfaces.RealOutput m_y(unit="N.m") "restoring moment on side 2 about y through the joint's centre"
    annotation (Placement(transformation(extent={{100,48},{120,68}})));
  Modelica.Blocks.Interfaces.RealOutput m_z(unit="N.m") "restoring moment on side 2 about the normal through the joint's centre"
    annotation (Placement(transformation(extent={{100,40},{120,60}})));
  Modelica.Blocks.Interfaces.RealOutput K_xx(unit="N/m") "tangential stiffness -df_x/ds_rel_x"
    annotation (Placement(transformation(extent={{100,33},{120,53}})));
  Modelica.Blocks.Interfaces.RealOutput K_yy(unit="N/m") "tangential stiffness -df_y/ds_rel_y"
    annotation (Placement(transformation(extent={{100,26},{120,46}})));
  Modelica.Blocks.Interfaces.RealOutput K_zz(unit="N/m") "normal stiffness -df_z/ds_rel_z"
    annotation (Placement(transformation(extent={{100,19},{120,39}})));
  Modelica.Blocks.Interfaces.RealOutput C_xx(unit="N.s/m") "equivalent viscous damping along x"
    annotation (Placement(transformation(extent={{100,12},{120,32}})));
  Modelica.Blocks.Interfaces.RealOutput C_yy(unit="N.s/m") "equivalent viscous damping along y"
    annotation (Placement(transformation(extent={{100,4},{120,24}})));
  Modelica.Blocks.Interfaces.RealOutput C_zz(unit="N.s/m") "equivalent viscous damping along the normal, zero without plastic_damping"
    annotation (Placement(transformation(extent={{100,-3},{120,17}})));
  Modelica.Blocks.Interfaces.RealOutput eta_t(unit="1") "tangential dissipation factor"
    annotation (Placement(transformation(extent={{100,-10},{120,10}})));
  Modelica.Blocks.Interfaces.RealOutput eta_n(unit="1") "ratio of plastic to elastic work in first loading; it causes damping only if plastic_damping = true"
    annotation (Placement(transformation(extent={{100,-17},{120,3}})));
  Modelica.Blocks.Interfaces.RealOutput K_rx(unit="N.m/rad") "rotational stiffness -dm_x/dtheta_x"
    annotation (Placement(transformation(extent={{100,-24},{120,-4}})));
  Modelica.Blocks.Interfaces.RealOutput K_ry(unit="N.m/rad") "rotational stiffness -dm_y/dtheta_y"
    annotation (Placement(transformation(extent={{100,-32},{120,-12}})));
  Modelica.Blocks.Interfaces.RealOutput K_rz(unit="N.m/rad") "rotational stiffness -dm_z/dtheta_z"
    annotation (Placement(transformation(extent={{100,-39},{120,-19}})));
  Modelica.Blocks.Interfaces.RealOutput p_mean(unit="Pa") "mean contact pressure"
    annotation (Placement(transformation(extent={{100,-46},{120,-26}})));
  Modelica.Blocks.Interfaces.RealOutput p_max(unit="Pa") "largest contact pressure"
    annotation (Placement(transformation(extent={{100,-53},{120,-33}})));
  Modelica.Blocks.Interfaces.RealOutput slip(unit="1") "friction utilization: shear force divided by (mu times normal force)"
    annotation (Placement(transformation(extent={{100,-60},{120,-40}})));
  Modelica.Blocks.Interfaces.RealOutput E_loss(unit="J") "energy dissipated by friction since initialization"
    annotation (Placement(transformation(extent={{100,-68},{120,-48}})));
  Modelica.Blocks.Interfaces.RealOutput eta_loop(unit="1") "loss factor of a load cycle whose amplitude is the present displacement"
    annotation (Placement(transformation(extent={{100,-75},{120,-55}})));
  Modelica.Blocks.Interfaces.RealOutput C_loop(unit="N.s/m") "equivalent viscous damping for eta_loop, as C_xx for eta_t"
    annotation (Placement(transformation(extent={{100,-82},{120,-62}})));
  Modelica.Blocks.Interfaces.RealOutput step_at_once(unit="s") "largest stable step for a sequential (Gauss-Seidel) master, which passes the new force on before the body steps: smallest of x, y and z, with `mass` on the joint"
    annotation (Placement(transformation(extent={{100,-89},{120,-69}})));
  Modelica.Blocks.Interfaces.RealOutput step_side_by_side(unit="s") "largest stable step for a parallel (Jacobi) master with lag_b = 1; 0: unstable at any step: smallest of x, y and z, with `mass` on the joint; 0 at the defaults, because C_zz = 0: then use model exchange, a sequential master or one FMU of the system (jointfmu system), or damp the body along z by a part of your own"
    annotation (Placement(transformation(extent={{100,-96},{120,-76}})));
  annotation (
    Icon(graphics={Text(extent={{-90,30},{90,-30}}, textColor={43,58,74}, textString="FMU")}),
    Documentation(info="<html>
<p>Inputs and outputs of the FMU BoltedJoint: Bolted joint under uneven pressure: motion in, force out.</p>
</html>"));
end BoltedJoint;
