"""FMUs driven along ramps and loops of an input."""
