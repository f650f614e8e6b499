"""Nodal contact results: read from files, checked, reduced to what an FMU carries."""
