within JointStiffness.Functions;
function limited "Torques of sliders, at most their friction"
  extends Modelica.Icons.Function;
  input Real stuck[:] "Torques if all stuck";
  input Real friction[size(stuck, 1)] "Their friction";
  output Real held[size(stuck, 1)] "What friction holds";
algorithm
  for i in 1:size(stuck, 1) loop
    held[i] := min(max(stuck[i], -friction[i]), friction[i]);
  end for;
end limited;
