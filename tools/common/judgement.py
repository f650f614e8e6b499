"""Plausibility of a stiffness: comparison with the estimate from roughness, validity of the interface law.

Every command that reports a stiffness also reports its plausibility. `assess_law_stiffness` assesses a law at
nominal pressures. For a joint under loads, `jointfmu_tools.common.pressure` computes these pressures.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from jointfmu.contact.interface import InterfaceLaw, find_validity_violations, stiffness_curve
from jointfmu.contact.roughness import (
    MAX_ROUGHNESS_HEIGHT,
    PERSSON_GAMMA,
    combined_height,
    predicted_stiffness,
)
from jointfmu.joints import KINDS
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array, Number

MAX_STIFFNESS_OVER_ESTIMATE = 3.0
"""Factor [1] above or below the estimate from roughness that makes a stiffness doubtful."""


@dataclass(frozen=True, slots=True)
class StiffnessComparison:
    """Stiffness of an interface law, compared with Persson's estimate p/(gamma h) from the roughness.

    The symbols are pressure p, rms height h and the constant gamma = PERSSON_GAMMA.

    rms_height       : [m] rms height h of both surfaces combined
    nominal_pressure : (n) p [Pa] > 0
    normal_stiffness : (n) [N/m3] stiffness per area of the law, times the ratio of joint to law stiffness
    """

    rms_height: float
    nominal_pressure: Array
    normal_stiffness: Array

    @property
    def stiffness_over_estimate(self) -> Array:
        """Ratio (n) [1] of the stiffness to Persson's estimate from pressure and rms height."""
        return np.asarray(self.normal_stiffness / predicted_stiffness(self.nominal_pressure, self.rms_height))

    @property
    def is_doubtful(self) -> bool:
        """Whether the ratio of stiffness to estimate, or its inverse, exceeds its limit at any pressure."""
        return bool(
            np.any(
                (self.stiffness_over_estimate > MAX_STIFFNESS_OVER_ESTIMATE)
                | (self.stiffness_over_estimate < 1.0 / MAX_STIFFNESS_OVER_ESTIMATE)
            )
        )

    def __str__(self) -> str:
        at = f"at {_format_range(self.nominal_pressure / 1e6)} MPa, h = {1e6 * self.rms_height:.3g} um"
        return (
            f"stiffness by the law: {_format_range(self.stiffness_over_estimate)} times the roughness "
            f"estimate p/({PERSSON_GAMMA:g} h) {at}"
        )

    def to_json(self) -> dict[str, Any]:
        """JSON object of the comparison: rms height; pressure, stiffness, estimate, ratio of each point."""
        columns = (
            self.nominal_pressure,
            self.normal_stiffness,
            predicted_stiffness(self.nominal_pressure, self.rms_height),
            self.stiffness_over_estimate,
        )
        names = ("pressure", "stiffness", "expected", "ratio")
        points = [dict(zip(names, map(float, row), strict=True)) for row in zip(*columns, strict=True)]
        return {"h": self.rms_height, "gamma": PERSSON_GAMMA, "points": points}


@dataclass(frozen=True, slots=True)
class Plausibility:
    """Plausibility of a stiffness: comparison with the roughness, and warnings.

    stiffness_comparison : None if the roughness is unknown
    """

    stiffness_comparison: StiffnessComparison | None
    warnings: tuple[str, ...]

    def format_lines(self) -> Iterator[str]:
        """Format the stiffness comparison as lines of text. The warnings are not included."""
        if self.stiffness_comparison is not None:
            yield str(self.stiffness_comparison)

    def prepend_warnings(self, extra_warnings: Sequence[str]) -> "Plausibility":
        """Return a copy whose warnings are the extra ones, then those of this object."""
        return Plausibility(self.stiffness_comparison, (*extra_warnings, *self.warnings))

    def to_json(self) -> dict[str, Any]:
        """JSON object {"level": stiffness comparison or null, "warnings": [...]}."""
        return {
            "level": self.stiffness_comparison and self.stiffness_comparison.to_json(),
            "warnings": list(self.warnings),
        }


def find_rms_height(parameter_file: ParameterFile) -> float | None:
    """Combined rms height h [m] of both surfaces, from the law or else from the surface data of the file.

    None if the file has neither.
    """
    h = law_rms_height(KINDS[parameter_file.joint].extract_law(parameter_file.values))
    return combined_height(parameter_file.roughness) if h is None else h


def assess_law_stiffness(
    interface_law: InterfaceLaw,
    nominal_pressures: Sequence[float],
    rms_height: float | None,
    peak_pressure: float = 0.0,
    joint_to_law_stiffness_ratio: Sequence[float] | float = 1.0,
    warn_outside_validity: bool = True,
) -> Plausibility:
    """Assess the stiffness of an interface law at nominal pressures [Pa].

    nominal_pressures            : (n) [Pa]; pressures of zero or infinity are ignored
    rms_height                   : [m] combined rms height of both surfaces; None: unknown
    peak_pressure                : [Pa] largest pressure, if `nominal_pressures` are mean values
    joint_to_law_stiffness_ratio : stiffness of the joint over stiffness of the law [1], one value or one per
                                   pressure
    warn_outside_validity        : also warn about pressures outside the range of validity
    """
    nominal = np.asarray(nominal_pressures, dtype=np.float64)
    in_contact = (nominal > 0.0) & (nominal < np.inf)
    p, factor = nominal[in_contact], np.broadcast_to(joint_to_law_stiffness_ratio, nominal.shape)[in_contact]
    comparison = None
    if rms_height is not None and p.size:
        comparison = StiffnessComparison(rms_height, p, factor * stiffness_curve(interface_law, p)[0])
    highest = float(np.max(p, initial=peak_pressure))
    lowest = float(np.min(p, initial=highest))
    warnings = (
        find_validity_violations(interface_law, highest, lowest)
        if warn_outside_validity and highest > 0.0
        else []
    )
    if rms_height is not None and rms_height > 2.0 * MAX_ROUGHNESS_HEIGHT:
        warnings.insert(
            0,
            f"h = {rms_height:.3g} m is too large for a roughness: faces that are joined have up to "
            f"{MAX_ROUGHNESS_HEIGHT:g} m each; check its unit",
        )
    if comparison is not None and comparison.is_doubtful:
        warnings.append(
            f"stiffness by the law: {_format_range(comparison.stiffness_over_estimate)} times the roughness "
            f"estimate K/A_0 = p/({PERSSON_GAMMA:g} h) with h = {1e6 * comparison.rms_height:.3g} um, "
            f"allowed is a factor of {MAX_STIFFNESS_OVER_ESTIMATE:g}: measure the joint, or use the "
            "roughness estimate (docs/validity.md)"
        )
    return Plausibility(comparison, tuple(warnings))


def law_rms_height(interface_law: InterfaceLaw) -> Number | None:
    """Combined rms height h [m] of an interface law; None if the law has no such parameter."""
    return getattr(interface_law, "h", None)


def _format_range(range_values: Array) -> str:
    """Format numbers as one value, or as their smallest and largest."""
    low, high = float(np.min(range_values)), float(np.max(range_values))
    return f"{low:.3g}" if f"{low:.3g}" == f"{high:.3g}" else f"{low:.3g} to {high:.3g}"
