"""The Modelica library JointStiffness, written from the one list of variables and the parameter files."""
