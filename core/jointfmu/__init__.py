"""Joint stiffness from fractal surface roughness, as laws, curves and FMUs."""

__version__ = "0.1.0"
