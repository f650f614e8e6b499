within JointStiffness.Functions;
function slide "Forces of sliders after a straight path, at most their friction"
  extends Modelica.Icons.Function;
  input Real before[2, :] "Their forces before, along x and y";
  input Real shift[2] "Path along the surface";
  input Real K_before[size(before, 2)] "Their stiffness before";
  input Real K[size(before, 2)] "Their stiffness after the path";
  input Real Q_before[size(before, 2)] "Their friction before";
  input Real Q[size(before, 2)] "Their friction after the path";
  output Real q[2, size(before, 2)] "Their forces after the path";
protected
  constant Integer parts=4 "Parts of the path, after each of which friction holds what it can";
  Real K_begin "Stiffness before the path";
  Real K_change "Its change along the path";
  Real Q_begin "Friction before the path";
  Real Q_change "Its change along the path";
  Real x_part "Part of the path, along x";
  Real y_part "Part of the path, along y";
  Real first "Stiffness before a part";
  Real last "Stiffness after it";
  Real carries "What a shift adds";
  Real x "Force along x";
  Real y "Force along y";
  Real holds "Part of it that springs, then friction hold";
algorithm
  x_part := shift[1]/parts;
  y_part := shift[2]/parts;
  for j in 1:size(before, 2) loop
    // each entry of an array is read once: tools copy arrays or check their bounds at each access
    x := before[1, j];
    y := before[2, j];
    K_begin := K_before[j];
    K_change := K[j] - K_begin;
    Q_begin := Q_before[j];
    Q_change := Q[j] - Q_begin;
    last := K_begin;
    for i in 1:parts loop
      first := last;
      last := K_begin + K_change*i/parts;
      carries := if last < first then last else 0.5*(first + last);
      holds := if last < first then last/first else 1;
      x := holds*x + carries*x_part;
      y := holds*y + carries*y_part;
      holds := min(1, (Q_begin + Q_change*i/parts)/max(sqrt(x^2 + y^2), Modelica.Constants.small));
      x := holds*x;
      y := holds*y;
    end for;
    q[1, j] := x;
    q[2, j] := y;
  end for;
end slide;
