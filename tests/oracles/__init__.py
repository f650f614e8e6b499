"""Independent solutions, readers of reference data and synthetic measurements, for tests and studies."""
