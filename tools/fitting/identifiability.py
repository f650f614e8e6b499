"""Which parameters, and which combinations of them, the data determine.

The singular values of the Jacobian in the logarithms, over the noise, are the reciprocal standard
deviations of independent combinations `prod name^exponent`. A parameter or combination counts as
determined if its standard deviation is at most its limit: LOOSEST, or a tenth of the parameter's
interval where that is narrower (both in logarithms).
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .least_squares import Solution, Unknown

Array = NDArray[np.float64]

LOOSEST = 0.2
"""Standard deviation of a logarithm [1] up to which a parameter counts as determined: about 20 %."""
PART_OF_INTERVAL = 0.1
SIGNIFICANT = 0.01
"""Least exponent of a combination, over its largest, that is named [1]."""
NUMERICAL = 1e-5
"""Least singular value over the largest that is told from zero [1]: the accuracy of the differences."""


@dataclass(frozen=True, slots=True)
class Combination:
    """An independent combination of parameters, prod name^exponent, largest exponent 1.

    deviation : relative standard deviation [1]; infinite if the data say nothing about it
    """

    exponents: Mapping[str, float]
    deviation: float
    determined: bool

    def __str__(self) -> str:
        return " ".join(
            name if power == 1.0 else f"{name}^{power:.2g}" for name, power in self.exponents.items()
        )


def limit(unknown: Unknown) -> float:
    """Standard deviation of the logarithm [1] up to which a parameter counts as determined."""
    if unknown.low <= 0.0 or not np.isfinite(unknown.high):
        return LOOSEST
    return min(LOOSEST, PART_OF_INTERVAL * float(np.log(unknown.high / unknown.low)))


def combinations(solution: Solution) -> list[Combination]:
    """The independent combinations, best determined first."""
    limits = np.array([limit(u) for u in solution.unknowns])
    _, s, rows = np.linalg.svd(solution.jacobian * limits, full_matrices=False)
    independent = []
    for value, row in zip(s, rows, strict=True):
        powers = row / limits  # ln of the combination is row . (ln x / limits)
        top = powers[np.argmax(np.abs(row))]
        named = np.abs(row) >= SIGNIFICANT * np.max(np.abs(row))
        exponents = {
            u.name: float(p / top)
            for u, p, keep in zip(solution.unknowns, powers, named, strict=True)
            if keep
        }
        blind = value <= NUMERICAL * s[0]
        deviation = np.inf if blind else solution.noise / value
        independent.append(Combination(exponents, float(deviation / abs(top)), bool(deviation <= 1.0)))
    return independent


def undetermined(solution: Solution) -> list[str]:
    """Names of the parameters that the data do not determine, or that sit on a bound."""
    blind = {name for c in combinations(solution) if not np.isfinite(c.deviation) for name in c.exponents}
    return [
        u.name
        for u in solution.unknowns
        if solution.deviations[u.name] > limit(u) or u.name in solution.at_bound or u.name in blind
    ]
