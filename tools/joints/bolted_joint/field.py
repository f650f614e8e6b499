"""How a bolted joint carries its bolts' forces under a pressure that comes as a field."""

from jointfmu.joints.bolted_joint.law import pressures, shear_ratio

from ...fields.clamped import Clamping

FIELD = Clamping(pressures=pressures, shear_ratio=shear_ratio)
