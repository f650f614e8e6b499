"""Rough surfaces: reading, repair, roughness, fractal parameters, synthesis (docs/surfaces.md)."""
