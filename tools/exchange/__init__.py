"""Joints for other programs: tables for finite elements, Modelica, MuJoCo, robot descriptions."""
