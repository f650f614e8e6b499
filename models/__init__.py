"""Default parameter sets and published numbers, as data."""
