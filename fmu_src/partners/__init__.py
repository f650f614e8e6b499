"""The partners' FMUs: inertia, mass and loads that a system model needs beside a joint."""

from .models import PARTNERS, parameters

__all__ = ["PARTNERS", "parameters"]
