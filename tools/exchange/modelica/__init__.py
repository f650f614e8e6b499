"""The Modelica library JointStiffness, generated from the models' variables and the parameter files."""
