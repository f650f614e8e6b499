"""Published claims of Yu 2022: how to check each of them for a gear contact."""

from dataclasses import replace
from typing import Any

import numpy as np

from jointfmu.contact.interface import evaluate_at_largest_spot
from jointfmu.contact.laws.yu2022 import Yu2022
from jointfmu.joints.gear_contact.spring import GearContactParameters

from ...studies.published.computed import PublishedNumbers


def is_yu2022_claim_met(contact_parameters: GearContactParameters, of: str, over: str) -> bool:
    """Check whether a claim of Yu 2022, section 5, holds for the parameter values in that section.

    of   : quantity that changes: load, stiffness, real area `A_r` or `elastic_fraction`
    over : parameter that is varied; "MB": the claim compares with the model of Majumdar and Bhushan

    Loads and stiffnesses are compared at equal real areas, real areas at an equal largest spot.
    """
    if over == "MB":
        return _is_below_majumdar_bhushan(contact_parameters)
    if of == "elastic_fraction" and over == "e":
        shares = [
            _contact_quantities_at_real_area(
                _replace_parameters(contact_parameters, D1=1.56, D2=1.56, e=e), 0.01
            )[of]
            for e in (0.1, 0.3, 0.5, 0.7)
        ]
        return bool(max(shares) - min(shares) < 0.05)
    if of == "elastic_fraction":
        share = [
            _contact_quantities_at_real_area(_replace_parameters(contact_parameters, D1=1.56, D2=D), 0.01)[of]
            for D in (1.45, 1.55, 1.65)
        ]
        return bool(share[0] < share[1] and abs(share[2] - share[1]) < 0.2 * (share[1] - share[0]))
    fine = {"G1": 1e-11, "G2": 1e-11}
    studies: dict[str, list[Yu2022]] = {
        "D": [
            _replace_parameters(contact_parameters, D1=1.36, D2=D, **fine)
            for D in (1.36, 1.46, 1.56, 1.66, 1.76)
        ],
        "G": [_replace_parameters(contact_parameters, G2=G) for G in (9e-10, 7e-10, 5e-10, 3e-10, 1e-10)],
        "e": [_replace_parameters(contact_parameters, e=e, **fine) for e in (0.7, 0.5, 0.3, 0.1)],
        "lambda": [_replace_parameters(contact_parameters, lambda_=v, **fine) for v in (0.3, 0.5, 0.7, 0.9)],
    }
    if of == "A_r":
        rows = [[float(evaluate_at_largest_spot(law, 1e-6)[of]) for law in studies[over]]]
    else:
        fractions = np.geomspace(1e-3, 1e-1, 9)
        rows = [
            [_contact_quantities_at_real_area(law, fraction)[of] for law in studies[over]]
            for fraction in fractions
        ]
    return bool(np.all(np.diff(rows, axis=1) > 0.0))


def _replace_parameters(
    contact_parameters: GearContactParameters, **new_values: Any
) -> GearContactParameters:
    """Copy of the gear contact with other values of some parameters."""
    for key in ("D1", "D2", "G1", "G2"):
        if key in new_values:
            name = f"surface{key[1]}"
            surface = replace(getattr(contact_parameters, name), **{key[0]: new_values.pop(key)})
            contact_parameters = replace(contact_parameters, **{name: surface})
    return replace(contact_parameters, **new_values)


def _contact_quantities_at_real_area(interface_law: Yu2022, area_fraction: float) -> dict[str, float]:
    """Contact quantities of the law at a real contact area of `area_fraction` times the nominal area.

    The area of the largest contact spot follows from Eq. 54 of Yu 2022.
    """
    spots = interface_law.spot_distribution()
    largest = (
        area_fraction
        * interface_law.A_0
        * (1.0 - spots.size_exponent)
        / (spots.size_exponent * spots.size_prefactor)
    )
    state: dict[str, Any] = interface_law.contact_quantities(np.log(largest / spots.reference_area))
    return {name: float(value) for name, value in state.items()}


def _is_below_majumdar_bhushan(contact_parameters: GearContactParameters) -> bool:
    """Whether the law gives a smaller load than Majumdar and Bhushan (1991) for the same real contact area.

    The compared areas are 1 to 10 % of the nominal area. Both models have the same fractal dimension D of the
    profile and fractal roughness G. In the model of Majumdar and Bhushan spots are elastic above the area a_c
    = G^2 (2 E/H)^(2/(D-1)) and plastic below: E effective modulus, H hardness.
    """
    D, G = contact_parameters.surface1.D, contact_parameters.surface1.G
    E, H = contact_parameters.side1.E / (1.0 - contact_parameters.side1.nu**2), contact_parameters.hardness
    critical = G**2 * (2.0 * E / H) ** (2.0 / (D - 1.0))
    for fraction in np.geomspace(1e-2, 1e-1, 9):
        largest = fraction * contact_parameters.A_0 * (2.0 - D) / D
        scale = 4.0 * np.sqrt(np.pi) / 3.0 * E * G ** (D - 1.0) * D / (3.0 - 2.0 * D)
        elastic = scale * largest ** (0.5 * D) * (largest ** (1.5 - D) - critical ** (1.5 - D))
        plastic = H * D / (2.0 - D) * largest ** (0.5 * D) * critical ** (1.0 - 0.5 * D)
        if _contact_quantities_at_real_area(contact_parameters, fraction)["F"] >= elastic + plastic:
            return False
    return True


PUBLISHED_NUMBERS = PublishedNumbers(
    paper_names=("yu2022",),
    observable_functions={
        "claim": is_yu2022_claim_met,
    },
)
"""{quantity of a reference file: function that computes it}."""
