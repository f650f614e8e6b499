within JointStiffness.Functions;
function segment "The row of a table at which the segment of a displacement begins"
  extends Modelica.Icons.Function;
  input Real x "Displacement";
  input Real table[:, 5] "Displacement, load, stiffness, its derivative before and after the node";
  output Integer i "Row, from 1 to the last but one";
algorithm
  i := 1;
  for j in 2:size(table, 1) - 1 loop
    i := if x >= table[j, 1] then j else i;
  end for;
end segment;
