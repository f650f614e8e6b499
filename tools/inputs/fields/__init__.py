"""Pressure fields: nodal contact results, read from files, checked, and reduced to few points for an FMU."""
