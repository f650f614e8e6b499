<% if within %>within << within >>;
<% endif %>model << name >> "<< title >>"
  extends Modelica.Icons.Example;
<% for record in records %>
  record << record.name >> "<< record.title >>"
    extends JointStiffness.Data.<< record.base >>(
<%- for key, value in record["values"].items() %>
      final << key >>=<< value >><< "," if not loop.last else ");" >>
<%- endfor %>
  end << record.name >>;
<% endfor %>
<%- for part in parts %>
  << part.component_type >> << part.component_name >><% if part.modifications %>(<< part.modifications >>)<% endif %>
    annotation (Placement(transformation(extent={{<< part.diagram_x - 10 >>,<< part.diagram_y - 10 >>},{<< part.diagram_x + 10 >>,<< part.diagram_y + 10 >>}})));
<%- endfor %>
equation
<%- for one, other, line in lines %>
  connect(<< one >>, << other >>)
    annotation (Line(points={<< line >>}));
<%- endfor %>
  annotation (
    experiment(StopTime=<< stop >>, Interval=<< interval >>, Tolerance=1e-8),
    Documentation(info="<html>
<p><< about >></p>
<< sources >>
</html>"));
end << name >>;
