"""Comparison of published with computed numbers, and calibration of parameters to published numbers."""
