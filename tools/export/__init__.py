"""The joint for other solvers."""
