"""Pressure distribution over the contact of a bolted joint, and its reduction to few points and patches."""
