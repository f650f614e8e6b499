within JointStiffness.Functions;
function smoothStep "From 0 at x <= 0 to 1 at x >= 1, twice continuously differentiable"
  extends Modelica.Icons.Function;
  input Real x "Argument";
  output Real y "Value";
protected
  Real r "Argument, between 0 and 1";
algorithm
  r := min(max(x, 0), 1);
  y := r^3*(<< step[0] >> + r*(<< step[2] >>*r - << -step[1] >>));
  annotation (smoothOrder=2);
end smoothStep;
