within JointStiffness.Interfaces;
partial block << name >> "<< doc >>"
  extends Modelica.Blocks.Icons.Block;
<%- for v in inputs %>
  Modelica.Blocks.Interfaces.RealInput << v.name >>(unit="<< v.unit >>"<< v.low >>) "<< v.doc >>"
    annotation (Placement(transformation(extent={{-140,<< v.y - 20 >>},{-100,<< v.y + 20 >>}})));
<%- endfor %>
<%- for v in outputs %>
  Modelica.Blocks.Interfaces.RealOutput << v.name >>(unit="<< v.unit >>") "<< v.doc >>"
    annotation (Placement(transformation(extent={{100,<< v.y - 10 >>},{120,<< v.y + 10 >>}})));
<%- endfor %>
  annotation (
    Icon(graphics={Text(extent={{-90,30},{90,-30}}, textColor={43,58,74}, textString="FMU")}),
    Documentation(info="<html>
<p>Inputs and outputs of the FMU << name >>: << doc >>.</p>
</html>"));
end << name >>;
