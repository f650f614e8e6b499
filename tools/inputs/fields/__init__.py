"""Nodal contact results: reading from files, checks, reduction to few points for an FMU."""
