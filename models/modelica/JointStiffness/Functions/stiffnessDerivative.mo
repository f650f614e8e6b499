within JointStiffness.Functions;
function stiffnessDerivative "Time derivative of the stiffness"
  extends Modelica.Icons.Function;
  input Real x "Displacement";
  input Real table[:, 5] "Displacement, load, stiffness, its derivative before and after the node";
  input Real x_t "Time derivative of the displacement";
  output Real k_t "Time derivative of the stiffness";
algorithm
  k_t := bend(x, table)*x_t;
end stiffnessDerivative;
