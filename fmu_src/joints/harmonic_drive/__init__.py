"""Harmonic drive, for the FMU builder."""
