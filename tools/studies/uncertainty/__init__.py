"""Uncertainty propagation: bands of stiffness, damping and displacement; sweeps of FMUs over parameters."""
