"""Bolted joint, for the FMU builder."""
