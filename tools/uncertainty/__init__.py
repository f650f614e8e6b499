"""From uncertain parameters to bands of stiffness, damping and displacement; sweeps of FMUs."""
