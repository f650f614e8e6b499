"""Pressure over the contact, and its integration into the stiffness of a joint."""
