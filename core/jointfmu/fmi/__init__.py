"""Running FMUs: the host."""
