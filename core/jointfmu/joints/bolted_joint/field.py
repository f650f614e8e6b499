"""How a bolted joint carries its bolts' forces under a pressure that comes as a field."""

from ..clamped import Clamping
from .law import pressures, shear_ratio

FIELD = Clamping(pressures=pressures, shear_ratio=shear_ratio)
