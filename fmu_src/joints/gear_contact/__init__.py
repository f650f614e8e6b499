"""Gear contact, for the FMU builder."""
