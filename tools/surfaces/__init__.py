"""Measured and made surfaces: reading, repair, fractal parameters, synthesis (docs/surfaces.md)."""
