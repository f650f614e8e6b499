"""Pressure over the contact area of a bolted joint, and its reduction to few points and patches."""
