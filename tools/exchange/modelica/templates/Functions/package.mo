within JointStiffness;
package Functions "A force law as a table, its exact derivatives, and a smooth step"
  extends Modelica.Icons.FunctionsPackage;
  annotation (Documentation(info="<html>
<p>A table has one row per node: displacement, load, stiffness, and the derivative of the stiffness before and after the node. Between two nodes the load is the quintic with these values at both ends, so it is twice continuously differentiable where the law is, and the stiffness is its exact derivative. Beyond the table the last tangent continues.</p>
<p>Derivatives are declared, so a tool can differentiate the law exactly.</p>
</html>"));
end Functions;
