within JointStiffness.Functions;
function loadDerivative "Time derivative of the load"
  extends Modelica.Icons.Function;
  input Real x "Displacement";
  input Real table[:, 5] "Displacement, load, stiffness, its derivative before and after the node";
  input Real x_t "Time derivative of the displacement";
  output Real y_t "Time derivative of the load";
algorithm
  y_t := stiffness(x, table)*x_t;
  annotation (smoothOrder=1);
end loadDerivative;
