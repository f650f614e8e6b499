"""Gear mesh, for the FMU builder."""
