within JointStiffness.Functions;
function load "Load at a displacement"
  extends Modelica.Icons.Function;
  input Real x "Displacement";
  input Real table[:, 5] "Displacement, load, stiffness, its derivative before and after the node";
  output Real y "Load";
protected
  Integer i "Row at which the segment begins";
  Real inside "Displacement, at most the ends of the table";
  Real h "Length of the segment";
  Real t "Place in the segment, 0 to 1";
  Real a "Load at the beginning";
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
  a := table[i, 2];
  b := table[i, 3]*h;
  c := 0.5*table[i, 5]*h^2;
  p := table[i + 1, 2] - a - b - c;
  q := table[i + 1, 3]*h - b - 2*c;
  r := table[i + 1, 4]*h^2 - 2*c;
  y := a + t*(b + t*(c + t*(10*p - 4*q + 0.5*r + t*(-15*p + 7*q - r + t*(6*p - 3*q + 0.5*r)))))
    + (if x < inside or x > inside then (x - inside)*stiffness(inside, table) else 0);
  annotation (derivative(noDerivative=table) = loadDerivative, smoothOrder=2);
end load;
