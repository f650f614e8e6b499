"""Contact of flexspline and bearing ring of a harmonic drive, from thin elastic rings."""
