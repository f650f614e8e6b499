"""Measured stiffness of joints (models/reference), and the law `roughness` with their surfaces."""

import tomllib
from dataclasses import replace
from importlib.resources import files

import numpy as np

from jointfmu.contact.interface import evaluate_at_pressure
from jointfmu.contact.laws.roughness import RoughnessLaw
from jointfmu.contact.surface import ElasticConstants

HARDNESS, SLOPE, FRICTION = 2e9, 0.15, 0.15
"""Assumed hardness [Pa], rms slope [1] and friction coefficient [1]. The stiffness of small motions does not
depend on them, the stiffness of first loading depends on hardness and slope."""
GAMMA = 0.45
"""Constant gamma of the law `roughness` [1]."""
LONGEST, MACHINED = 1e-3, 0.8
"""Estimated longest wave [m] and Hurst exponent [1] of the machined surfaces."""


def measured(name="measured_joints"):
    """Read the measured joints, or another file of models/reference."""
    text = (files("jointfmu_models") / "reference" / f"{name}.toml").read_text(encoding="utf-8")
    return tomllib.loads(text)


def joint_law(joint, **changes):
    """Law `roughness` for a measured joint with the stated roughness `Rq` of each side."""
    body = ElasticConstants(E=joint["E"], nu=joint["nu"])
    law = RoughnessLaw(
        h=np.sqrt(2.0) * joint["Rq"],
        gamma=GAMMA,
        longest_wave=LONGEST,
        hurst=MACHINED,
        slope=SLOPE,
        side1=body,
        side2=body,
        H=HARDNESS,
        mu=FRICTION,
        traction_ratio=0.1,
        A_0=joint["A_0"],
    )
    return replace(law, **changes)


def level(law, p, quantity="K_N"):
    """Stiffness per area [N/m3] of a law at pressures [Pa].

    quantity : K_N for small motions, K_loading for first loading
    """
    return evaluate_at_pressure(law, p)[quantity] / law.A_0


def measured_range(joint, p):
    """Mask (...) of the pressures [Pa] up to the largest one at which a joint was measured."""
    return p <= joint["to"] * joint["pressure_unit"]
