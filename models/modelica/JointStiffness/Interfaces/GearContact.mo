within JointStiffness.Interfaces;
partial block GearContact "Tooth contact of a gear: force in, motion out"
  extends Modelica.Blocks.Icons.Block;
  Modelica.Blocks.Interfaces.RealInput f(unit="N") "normal load of the tooth contact"
    annotation (Placement(transformation(extent={{-140,-20},{-100,20}})));
  Modelica.Blocks.Interfaces.RealOutput s_rel(unit="m") "approach of the two flanks, counted from first touch"
    annotation (Placement(transformation(extent={{100,58},{120,78}})));
  Modelica.Blocks.Interfaces.RealOutput K_N(unit="N/m") "tangent stiffness df/ds"
    annotation (Placement(transformation(extent={{100,12},{120,32}})));
  Modelica.Blocks.Interfaces.RealOutput A_r(unit="m2") "real contact area"
    annotation (Placement(transformation(extent={{100,-32},{120,-12}})));
  Modelica.Blocks.Interfaces.RealOutput elastic_fraction(unit="1") "elastic part of the real contact area"
    annotation (Placement(transformation(extent={{100,-78},{120,-58}})));
  annotation (
    Icon(graphics={Text(extent={{-90,30},{90,-30}}, textColor={43,58,74}, textString="FMU")}),
    Documentation(info="<html>
<p>Inputs and outputs of the FMU GearContact: Tooth contact of a gear: force in, motion out.</p>
</html>"));
end GearContact;
