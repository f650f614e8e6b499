"""Published claims of Yu 2022: how to check each of them for a gear contact."""

from dataclasses import replace
from typing import Any

import numpy as np

from jointfmu.contact.interface import evaluate_at_largest_spot
from jointfmu.contact.laws.yu2022 import Yu2022
from jointfmu.joints.gear_contact.spring import GearContactParameters

from ...studies.published.computed import PublishedNumbers


def is_claim_met(contact: GearContactParameters, of: str, over: str) -> bool:
    """Check whether a claim of Yu 2022, section 5, holds for the parameter values in that section.

    of   : quantity that changes: load, stiffness, real area `A_r` or `elastic_fraction`
    over : parameter that is varied; "MB": the claim compares with the model of Majumdar and Bhushan

    Loads and stiffnesses are compared at equal real areas, real areas at an equal largest spot.
    """
    if over == "MB":
        return _is_below_majumdar_bhushan(contact)
    if of == "elastic_fraction" and over == "e":
        shares = [
            _state_at_real_area(_replace_parameters(contact, D1=1.56, D2=1.56, e=e), 0.01)[of]
            for e in (0.1, 0.3, 0.5, 0.7)
        ]
        return bool(max(shares) - min(shares) < 0.05)
    if of == "elastic_fraction":
        share = [
            _state_at_real_area(_replace_parameters(contact, D1=1.56, D2=D), 0.01)[of]
            for D in (1.45, 1.55, 1.65)
        ]
        return bool(share[0] < share[1] and abs(share[2] - share[1]) < 0.2 * (share[1] - share[0]))
    fine = {"G1": 1e-11, "G2": 1e-11}
    studies: dict[str, list[Yu2022]] = {
        "D": [_replace_parameters(contact, D1=1.36, D2=D, **fine) for D in (1.36, 1.46, 1.56, 1.66, 1.76)],
        "G": [_replace_parameters(contact, G2=G) for G in (9e-10, 7e-10, 5e-10, 3e-10, 1e-10)],
        "e": [_replace_parameters(contact, e=e, **fine) for e in (0.7, 0.5, 0.3, 0.1)],
        "lambda": [_replace_parameters(contact, lambda_=v, **fine) for v in (0.3, 0.5, 0.7, 0.9)],
    }
    if of == "A_r":
        rows = [[float(evaluate_at_largest_spot(law, 1e-6)[of]) for law in studies[over]]]
    else:
        fractions = np.geomspace(1e-3, 1e-1, 9)
        rows = [[_state_at_real_area(law, fraction)[of] for law in studies[over]] for fraction in fractions]
    return bool(np.all(np.diff(rows, axis=1) > 0.0))


def _replace_parameters(contact: GearContactParameters, **new_values: Any) -> GearContactParameters:
    """Copy of the gear contact with other values of some parameters."""
    for key in ("D1", "D2", "G1", "G2"):
        if key in new_values:
            name = f"surface{key[1]}"
            surface = replace(getattr(contact, name), **{key[0]: new_values.pop(key)})
            contact = replace(contact, **{name: surface})
    return replace(contact, **new_values)


def _state_at_real_area(law: Yu2022, area_fraction: float) -> dict[str, float]:
    """Contact quantities of the law at a real contact area of `area_fraction` times A_0.

    The largest spot follows from Eq. 54.
    """
    spots = law.spot_distribution()
    largest = (
        area_fraction * law.A_0 * (1.0 - spots.size_exponent) / (spots.size_exponent * spots.size_prefactor)
    )
    state: dict[str, Any] = law.contact_quantities(np.log(largest / spots.reference_area))
    return {name: float(value) for name, value in state.items()}


def _is_below_majumdar_bhushan(contact: GearContactParameters) -> bool:
    """Whether the load is below the load of Majumdar and Bhushan (1991) at real areas from 1 to 10 % of A_0.

    Both models have the same D (fractal dimension of the profile) and G. In the model of Majumdar and Bhushan
    spots are elastic above the area a_c = G^2 (2 E/H)^(2/(D-1)) and plastic below.
    """
    D, G = contact.surface1.D, contact.surface1.G
    E, H = contact.side1.E / (1.0 - contact.side1.nu**2), contact.hardness
    critical = G**2 * (2.0 * E / H) ** (2.0 / (D - 1.0))
    for fraction in np.geomspace(1e-2, 1e-1, 9):
        largest = fraction * contact.A_0 * (2.0 - D) / D
        scale = 4.0 * np.sqrt(np.pi) / 3.0 * E * G ** (D - 1.0) * D / (3.0 - 2.0 * D)
        elastic = scale * largest ** (0.5 * D) * (largest ** (1.5 - D) - critical ** (1.5 - D))
        plastic = H * D / (2.0 - D) * largest ** (0.5 * D) * critical ** (1.0 - 0.5 * D)
        if _state_at_real_area(contact, fraction)["F"] >= elastic + plastic:
            return False
    return True


PUBLISHED_NUMBERS = PublishedNumbers(
    papers=("yu2022",),
    observable_functions={
        "claim": is_claim_met,
    },
)
"""{quantity of a reference file: function that computes it}."""
