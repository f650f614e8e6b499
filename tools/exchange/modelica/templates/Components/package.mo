within JointStiffness;
package Components "Joints with flanges; no FMU needed"
  extends Modelica.Icons.Package;
  annotation (Documentation(info="<html>
<p>Each component contains the exported curve of its joint as a table.<% for note in notes %> << note >><% endfor %></p>
</html>"));
end Components;
