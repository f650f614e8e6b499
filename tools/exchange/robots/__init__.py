"""Drives for robot simulators without a plugin: MuJoCo's own springs and sliders, and URDF."""
