within JointStiffness.Interfaces;
partial block BoltedJoint "Bolted joint under uneven pressure: motion in, force out (Zhao 2018)"
  extends Modelica.Blocks.Icons.Block;
  Modelica.Blocks.Interfaces.RealInput preload(unit="N", min=0) "pre-tightening force of each bolt"
    annotation (Placement(transformation(extent={{-140,59},{-100,99}})));
  Modelica.Blocks.Interfaces.RealInput moment(unit="N.m") "bending moment on the joint"
    annotation (Placement(transformation(extent={{-140,36},{-100,76}})));
  Modelica.Blocks.Interfaces.RealInput s_rel_x(unit="m") "displacement from the tightened state, along the rows"
    annotation (Placement(transformation(extent={{-140,14},{-100,54}})));
  Modelica.Blocks.Interfaces.RealInput s_rel_y(unit="m") "displacement from the tightened state, across the rows"
    annotation (Placement(transformation(extent={{-140,-9},{-100,31}})));
  Modelica.Blocks.Interfaces.RealInput s_rel_z(unit="m") "displacement from the tightened state, positive apart"
    annotation (Placement(transformation(extent={{-140,-31},{-100,9}})));
  Modelica.Blocks.Interfaces.RealInput v_rel_x(unit="m/s") "rate of s_rel_x"
    annotation (Placement(transformation(extent={{-140,-54},{-100,-14}})));
  Modelica.Blocks.Interfaces.RealInput v_rel_y(unit="m/s") "rate of s_rel_y"
    annotation (Placement(transformation(extent={{-140,-76},{-100,-36}})));
  Modelica.Blocks.Interfaces.RealInput v_rel_z(unit="m/s") "rate of s_rel_z"
    annotation (Placement(transformation(extent={{-140,-99},{-100,-59}})));
  Modelica.Blocks.Interfaces.RealOutput f_x(unit="N") "force on side 2 along x, restoring"
    annotation (Placement(transformation(extent={{100,74},{120,94}})));
  Modelica.Blocks.Interfaces.RealOutput f_y(unit="N") "force on side 2 along y, restoring"
    annotation (Placement(transformation(extent={{100,63},{120,83}})));
  Modelica.Blocks.Interfaces.RealOutput f_z(unit="N") "force on side 2 along the normal, negative when pulled apart"
    annotation (Placement(transformation(extent={{100,52},{120,72}})));
  Modelica.Blocks.Interfaces.RealOutput K_xx(unit="N/m") "tangential stiffness -df_x/ds_rel_x"
    annotation (Placement(transformation(extent={{100,41},{120,61}})));
  Modelica.Blocks.Interfaces.RealOutput K_yy(unit="N/m") "tangential stiffness -df_y/ds_rel_y"
    annotation (Placement(transformation(extent={{100,29},{120,49}})));
  Modelica.Blocks.Interfaces.RealOutput K_zz(unit="N/m") "normal stiffness -df_z/ds_rel_z"
    annotation (Placement(transformation(extent={{100,18},{120,38}})));
  Modelica.Blocks.Interfaces.RealOutput C_xx(unit="N.s/m") "viscous-equivalent damping along x"
    annotation (Placement(transformation(extent={{100,7},{120,27}})));
  Modelica.Blocks.Interfaces.RealOutput C_yy(unit="N.s/m") "viscous-equivalent damping along y"
    annotation (Placement(transformation(extent={{100,-4},{120,16}})));
  Modelica.Blocks.Interfaces.RealOutput C_zz(unit="N.s/m") "viscous-equivalent damping along the normal"
    annotation (Placement(transformation(extent={{100,-16},{120,4}})));
  Modelica.Blocks.Interfaces.RealOutput eta_t(unit="1") "tangential dissipation factor"
    annotation (Placement(transformation(extent={{100,-27},{120,-7}})));
  Modelica.Blocks.Interfaces.RealOutput eta_n(unit="1") "normal dissipation factor"
    annotation (Placement(transformation(extent={{100,-38},{120,-18}})));
  Modelica.Blocks.Interfaces.RealOutput K_rx(unit="N.m/rad") "rotational stiffness about x through the centroid"
    annotation (Placement(transformation(extent={{100,-49},{120,-29}})));
  Modelica.Blocks.Interfaces.RealOutput K_ry(unit="N.m/rad") "rotational stiffness about y through the centroid"
    annotation (Placement(transformation(extent={{100,-61},{120,-41}})));
  Modelica.Blocks.Interfaces.RealOutput K_rz(unit="N.m/rad") "rotational stiffness about the normal, same point"
    annotation (Placement(transformation(extent={{100,-72},{120,-52}})));
  Modelica.Blocks.Interfaces.RealOutput p_mean(unit="Pa") "mean contact pressure"
    annotation (Placement(transformation(extent={{100,-83},{120,-63}})));
  Modelica.Blocks.Interfaces.RealOutput p_max(unit="Pa") "largest contact pressure"
    annotation (Placement(transformation(extent={{100,-94},{120,-74}})));
  annotation (
    Icon(graphics={Text(extent={{-90,30},{90,-30}}, textColor={43,58,74}, textString="FMU")}),
    Documentation(info="<html>
<p>Inputs and outputs of the FMU BoltedJoint: Bolted joint under uneven pressure: motion in, force out (Zhao 2018).</p>
</html>"));
end BoltedJoint;
