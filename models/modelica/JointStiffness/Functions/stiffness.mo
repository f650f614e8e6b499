within JointStiffness.Functions;
function stiffness "Derivative of the load with respect to the displacement"
  extends Modelica.Icons.Function;
  input Real x "Displacement";
  input Real table[:, 5] "Displacement, load, stiffness, its derivative before and after the node";
  output Real k "Stiffness";
protected
  Integer i "Row at which the segment begins";
  Real inside "Displacement, at most the ends of the table";
  Real h "Length of the segment";
  Real t "Place in the segment, 0 to 1";
  Real b "First coefficient";
  Real c "Second coefficient";
  Real p "What the cubic leaves of the load at the end";
  Real q "Of the stiffness";
  Real r "Of its derivative";
algorithm
  inside := min(max(x, table[1, 1]), table[size(table, 1), 1]);
  i := segment(inside, table);
  h := table[i + 1, 1] - table[i, 1];
  t := (inside - table[i, 1])/h;
  b := table[i, 3]*h;
  c := 0.5*table[i, 5]*h^2;
  p := table[i + 1, 2] - table[i, 2] - b - c;
  q := table[i + 1, 3]*h - b - 2*c;
  r := table[i + 1, 4]*h^2 - 2*c;
  k := (b + t*(2*c + t*(3*(10*p - 4*q + 0.5*r) + t*(4*(-15*p + 7*q - r) + t*5*(6*p - 3*q + 0.5*r)))))/h;
  annotation (derivative(noDerivative=table) = stiffnessDerivative, smoothOrder=1);
end stiffness;
