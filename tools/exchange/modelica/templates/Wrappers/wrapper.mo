within JointStiffness.Wrappers;
model << name >> "<< doc >>"
<%- for p in parameters %>
  parameter << p.type >> << p.name >><< p.modifier >> "<< p.doc >>";
<%- endfor %>
  replaceable JointStiffness.Interfaces.<< name >> fmu "Redeclare as the imported FMU"
    annotation (Placement(transformation(extent={{-20,-20},{20,20}})));
<%- for t in terminals %>
  << t.connector >> << t.name >> "<< t.doc >>"
    annotation (Placement(transformation(extent={{<< t.x - 10 >>,<< t.y - 10 >>},{<< t.x + 10 >>,<< t.y + 10 >>}})));
  << t.adaptor >> adaptor_<< t.name >>(use_pder=<< t.use_rate >>, use_pder2=false)
    annotation (Placement(transformation(extent={{<< t.flip * -90 >>,<< t.y - 10 >>},{<< t.flip * -70 >>,<< t.y + 10 >>}})));
  Modelica.Blocks.Math.Gain reaction_<< t.name >>(k=-1) "The FMU's force is on the neighbour, the adaptor's on the joint"
    annotation (Placement(transformation(extent={{<< t.flip * t.from >>,<< t.y - 30 >>},{<< t.flip * t.to >>,<< t.y - 20 >>}})));
<%- endfor %>
equation
<%- for t in terminals %>
<%- for a, b, line in t.connections %>
  connect(<< a >>, << b >>)
    annotation (<< line >>);
<%- endfor %>
<%- endfor %>
<%- for p in parameters %>
  fmu.<< p.name >> = << p.name >>;
<%- endfor %>
  annotation (
    Icon(graphics={
      Rectangle(extent={{-90,80},{90,-80}}, lineColor={43,58,74}, fillColor={255,255,255}, fillPattern=FillPattern.Solid, radius=10),
      Text(extent={{-80,40},{80,-10}}, textColor={31,95,168}, textString="FMU"),
      Text(extent={{-85,-20},{85,-50}}, textColor={43,58,74}, textString="<< name >>"),
      Text(extent={{-150,125},{150,85}}, textColor={0,0,255}, textString="%name")}),
    Documentation(info="<html>
<p>The FMU << name >> between flanges. << note >></p>
<p>Redeclare <code>fmu</code> as the class that your tool created from the FMU; set the FMU's parameters there.</p>
</html>"));
end << name >>;
