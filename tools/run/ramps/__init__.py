"""Runs of FMUs along a ramp or load cycles of an input."""
