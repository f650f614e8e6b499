"""Surface heights: combined rms height of two surfaces, and the contact stiffness that it predicts.

A parameter file states heights in its section [roughness] or [comparison]: `Ra1`, `Ra2` (arithmetic mean
height of each surface), `Rq1`, `Rq2` (rms height), or `h`, the combined rms height of both. They include
wavelengths up to the longest wave that machining leaves. A surface without a height counts as smooth.
"""

from collections.abc import Mapping
from dataclasses import Field
from math import pi
from typing import Any

import numpy as np

from ..quantity import Number, find_problems, quantity_field

PERSSON_GAMMA = 0.45
"""Approach over which the pressure grows e-fold, over the rms height h [1]: p ~ exp(approach/(gamma h)) in
elastic contact of many spots. Boundary elements give 0.40 to 0.48 (docs/validity.md)."""
RQ_OVER_RA = (pi / 2.0) ** 0.5
"""R_q/R_a [1] of a Gaussian surface, 1.25."""


MAX_ROUGHNESS_HEIGHT = 1e-4
"""Largest accepted height of a surface [m]: cast and flame-cut faces have 50 um."""


def _declare_height(doc: str) -> Any:
    """Declare a roughness height of a surface [m]: dataclass field with interval and meaning."""
    return quantity_field(
        "m",
        f"{doc}, measured over the longest wavelength that machining leaves",
        gt=0.0,
        le=MAX_ROUGHNESS_HEIGHT,
    )


HEIGHT_FIELDS: dict[str, Field[Any]] = {
    "Ra1": _declare_height("arithmetic mean height of the first surface"),
    "Ra2": _declare_height("arithmetic mean height of the second surface"),
    "Rq1": _declare_height("rms height of the first surface"),
    "Rq2": _declare_height("rms height of the second surface"),
    "h": _declare_height("combined rms height of both surfaces"),
}
"""{name: field} of the heights that a parameter file may state."""


def rms_height(Ra: Number) -> Number:
    """Rms height R_q [m] of a Gaussian surface with the arithmetic mean height Ra [m]: sqrt(pi/2) Ra."""
    return RQ_OVER_RA * Ra


def combine_heights(first_rms_height: Number, second_rms_height: Number) -> Number:
    """Combine rms heights [m] of two statistically independent surfaces: rms height h [m] of their gap."""
    return np.sqrt(first_rms_height**2 + second_rms_height**2)


def predicted_stiffness(pressure: Number, h: Number) -> Number:
    """Normal stiffness per area k [N/m3] at a nominal pressure p [Pa]: k = p/(PERSSON_GAMMA h).

    Elastic contact of many spots (Persson 2007; Akarapu, Sharp and Robbins 2011). h [m] is the combined rms
    height of both surfaces.
    """
    return pressure / (PERSSON_GAMMA * h)


def find_conflicting_height_names(roughness_height_name: str) -> tuple[str, ...]:
    """Find the names of the roughness heights that a file must not state together with one of them.

    These are the other height of the same surface, and the combined height `h` of both surfaces.

    roughness_height_name : Ra1, Rq1, Ra2 or Rq2 (mean or rms height of a surface), or h
    """
    if roughness_height_name == "h":
        return tuple(other for other in HEIGHT_FIELDS if other != "h")
    return ({"a": "Rq", "q": "Ra"}[roughness_height_name[1]] + roughness_height_name[2], "h")


def check_heights(surface_heights: Mapping[str, Any], name_prefix: str = "") -> dict[str, Number]:
    """Check roughness heights {name: height [m]}, numbers or arrays; return them with numbers as floats.

    name_prefix : precedes the names in errors

    Raises ValueError, one line, for an unknown name, a value that is not a number or outside its interval, or
    two heights of one surface.
    """
    declared = {name_prefix + name: item for name, item in HEIGHT_FIELDS.items()}
    texts = find_problems({name_prefix + name: value for name, value in surface_heights.items()}, declared)
    for name in (name for name in surface_heights if name in HEIGHT_FIELDS):
        conflicts = [other for other in find_conflicting_height_names(name) if other in surface_heights]
        if conflicts:
            others = ", ".join(name_prefix + other for other in conflicts)
            texts.append(f"{name_prefix}{name} with {others}: state one height for each side, or only h")
            break
    if texts:
        raise ValueError("; ".join(texts))
    return {name: value if np.ndim(value) else float(value) for name, value in surface_heights.items()}


def combined_height(surface_heights: Mapping[str, Number]) -> Number | None:
    """Combined rms height h [m] of both surfaces; None if no height is stated."""
    if not surface_heights:
        return None
    if "h" in surface_heights:
        return surface_heights["h"]
    sides = (
        surface_heights.get(f"Rq{side}", rms_height(surface_heights.get(f"Ra{side}", 0.0))) for side in (1, 2)
    )
    h = combine_heights(*sides)
    return h if np.ndim(h) else float(h)
