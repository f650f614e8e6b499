"""The partners' FMUs: inertia, mass and loads that a system model needs beside a joint."""

from pathlib import Path

from ..joint_parts import Parts, equations
from .models import PARTNERS, parameters
from .terminals import TERMINALS

PARTS = Parts(folder=Path(__file__).parent, native=equations, terminals=TERMINALS)

__all__ = ["PARTNERS", "PARTS", "parameters"]
