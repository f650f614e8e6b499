"""What the tools know of the harmonic drive."""
