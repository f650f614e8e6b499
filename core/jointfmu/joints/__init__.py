"""The joints: a law, a footprint and a curve each."""
