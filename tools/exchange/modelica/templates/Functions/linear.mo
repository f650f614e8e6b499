within JointStiffness.Functions;
function linear "Linear interpolation; beyond its ends the last value"
  extends Modelica.Icons.Function;
  input Real x "Argument";
  input Real table[:, 2] "Argument, value";
  output Real y "Value";
protected
  Integer i "Row at which the segment begins";
  Real inside "Argument, at most the ends of the table";
algorithm
  inside := min(max(x, table[1, 1]), table[size(table, 1), 1]);
  i := 1;
  for j in 2:size(table, 1) - 1 loop
    i := if inside >= table[j, 1] then j else i;
  end for;
  y := table[i, 2] + (inside - table[i, 1])/(table[i + 1, 1] - table[i, 1])*(table[i + 1, 2] - table[i, 2]);
end linear;
