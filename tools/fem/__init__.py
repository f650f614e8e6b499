"""Finite elements: the contact of two bolted bodies and the modes of the assembly."""
