"""Export of joints to other solvers: finite elements, Modelica tables, CSV."""
