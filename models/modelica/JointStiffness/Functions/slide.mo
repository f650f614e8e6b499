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
  Real first "Stiffness before a part";
  Real last "Stiffness after it";
  Real carries "What a shift adds";
  Real x "Force along x";
  Real y "Force along y";
  Real holds "Part of it that springs, then friction hold";
algorithm
  for j in 1:size(before, 2) loop
    x := before[1, j];
    y := before[2, j];
    last := K_before[j];
    for i in 1:parts loop
      first := last;
      last := K_before[j] + (K[j] - K_before[j])*i/parts;
      carries := if last < first then last else 0.5*(first + last);
      holds := if last < first then last/first else 1;
      x := holds*x + carries*shift[1]/parts;
      y := holds*y + carries*shift[2]/parts;
      holds := min(1, (Q_before[j] + (Q[j] - Q_before[j])*i/parts)/max(sqrt(x^2 + y^2), Modelica.Constants.small));
      x := holds*x;
      y := holds*y;
    end for;
    q[1, j] := x;
    q[2, j] := y;
  end for;
end slide;
