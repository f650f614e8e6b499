"""The spring, for the FMU builder."""
