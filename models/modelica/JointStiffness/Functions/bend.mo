within JointStiffness.Functions;
function bend "Derivative of the stiffness with respect to the displacement; zero beyond the table"
  extends Modelica.Icons.Function;
  input Real x "Displacement";
  input Real table[:, 5] "Displacement, load, stiffness, its derivative before and after the node";
  output Real k_x "Derivative of the stiffness";
protected
  Integer i "Row at which the segment begins";
  Real h "Length of the segment";
  Real t "Place in the segment, 0 to 1";
  Real b "First coefficient";
  Real c "Second coefficient";
  Real p "What the cubic leaves of the load at the end";
  Real q "Of the stiffness";
  Real r "Of its derivative";
algorithm
  i := segment(x, table);
  h := table[i + 1, 1] - table[i, 1];
  t := (x - table[i, 1])/h;
  b := table[i, 3]*h;
  c := 0.5*table[i, 5]*h^2;
  p := table[i + 1, 2] - table[i, 2] - b - c;
  q := table[i + 1, 3]*h - b - 2*c;
  r := table[i + 1, 4]*h^2 - 2*c;
  k_x := if x < table[1, 1] or x > table[size(table, 1), 1] then 0.0 else
    (2*c + t*(6*(10*p - 4*q + 0.5*r) + t*(12*(-15*p + 7*q - r) + t*20*(6*p - 3*q + 0.5*r))))/h^2;
end bend;
