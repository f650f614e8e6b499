"""Pressures per second through each interface law, over scipy's `brentq` for each pressure.

    python benchmarks/interface_laws.py [--quick]

One process on one core. The columns are the solution for the largest spot alone, all quantities, `brentq`,
and the ratio of the first to the last.
"""

import numpy as np
from harness import read_options, time_fastest_call
from jointfmu_tools.inputs.laws import LAWS, build_law_parameters
from scipy.optimize import brentq

from jointfmu.contact.interface import evaluate_at_pressure, solve_largest_spot

POINTS, ROOTS, REPEATS = 1_000_000, 300, 5
QUICK = 100, 3, 1
"""Values of POINTS, ROOTS and REPEATS with --quick."""


def solve_by_brentq(law, pressures):
    """Log-area of the largest spot for each pressure, by a scalar root search."""
    spots = law.spot_distribution()

    def residual(u, target):
        return float(spots.log_sum_over_spots("load", u)[0]) - target

    return np.array(
        [brentq(residual, -60.0, 60.0, args=(np.log(p * law.A_0),), xtol=1e-12) for p in pressures]
    )


def main():
    """Print the table of times."""
    points, roots, repeats = QUICK if read_options(__doc__).quick else (POINTS, ROOTS, REPEATS)
    pressures = 10.0 ** np.random.default_rng(1).uniform(5.0, 8.0, points)
    few = pressures[:roots]
    print("pressures per second")
    print(f"{'law':10} {'inversion':>14} {'all quantities':>16} {'brentq':>12} {'ratio':>8}")
    for name in LAWS:
        law = build_law_parameters(name, None, {})
        fast, seconds = time_fastest_call(lambda law=law: solve_largest_spot(law, pressures), repeats)
        _, seconds_of_all = time_fastest_call(
            lambda law=law: evaluate_at_pressure(law, pressures), min(repeats, 2)
        )
        slow, seconds_of_roots = time_fastest_call(lambda law=law: solve_by_brentq(law, few), min(repeats, 2))
        np.testing.assert_allclose(fast[:roots], slow, atol=1e-9)
        rates = points / seconds, points / seconds_of_all, roots / seconds_of_roots
        cells = "{:14.3g} {:16.3g} {:12.3g}".format(*rates)
        print(f"{name:10} {cells} {rates[0] / rates[2]:8.0f}")


if __name__ == "__main__":
    main()
