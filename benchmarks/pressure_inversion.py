"""Pressures per second through an interface law, beside the obvious way (scipy's brentq per point).

One process, one core: numpy's element-wise functions use one thread. Prints for each law the
inversion alone, the inversion with all quantities, brentq, and the ratio of the first to the last.
"""

from time import perf_counter

import numpy as np
from jointfmu_tools.inputs.laws import LAWS, build_law_parameters
from scipy.optimize import brentq

from jointfmu.contact.interface import evaluate_at_pressure, solve_largest_spot

POINTS, OBVIOUS, REPEATS = 1_000_000, 300, 5


def best(run, repeats=REPEATS):
    """Shortest of several runs [s]."""
    times = []
    for _ in range(repeats):
        start = perf_counter()
        run()
        times.append(perf_counter() - start)
    return min(times)


def by_brentq(law, pressures):
    """One scalar root per pressure, on the same integral."""
    spots = law.spots()

    def miss(u, target):
        return float(spots.log_total("load", u)[0]) - target

    return np.array([brentq(miss, -60.0, 60.0, args=(np.log(p * law.A_0),), xtol=1e-12) for p in pressures])


def main():
    """Print the table."""
    rng = np.random.default_rng(1)
    pressures = 10.0 ** rng.uniform(5.0, 8.0, POINTS)
    print("pressures per second")
    print(f"{'law':10} {'inversion':>14} {'all quantities':>16} {'brentq':>12} {'ratio':>8}")
    for name in LAWS:
        law = build_law_parameters(name, None, {})
        few = pressures[:OBVIOUS]
        np.testing.assert_allclose(solve_largest_spot(law, few), by_brentq(law, few), atol=1e-9)
        fast = POINTS / best(lambda law=law: solve_largest_spot(law, pressures))
        full = POINTS / best(lambda law=law: evaluate_at_pressure(law, pressures), 2)
        slow = OBVIOUS / best(lambda law=law, few=few: by_brentq(law, few), 2)
        print(f"{name:10} {fast:14.3g} {full:16.3g} {slow:12.3g} {fast / slow:8.0f}")


if __name__ == "__main__":
    main()
