"""The harmonic drive's contact from thin elastic rings, for the study in benchmarks/ring_model.py."""
