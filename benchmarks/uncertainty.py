"""Samples per second through `jointfmu uncertainty`, beside the obvious way (the exported spring per sample).

One process, one core: set OPENBLAS_NUM_THREADS=1. Per joint: processor time for the bands of SAMPLES samples
on a ramp of POINTS points, time with the spring tabulated and evaluated for every sample (from OBVIOUS of
them), their ratio, and the largest relative difference of both over those samples.
"""

from time import process_time

import numpy as np
from jointfmu_tools.studies.uncertainty import propagate
from jointfmu_tools.studies.uncertainty.problem import state_problem

from jointfmu.joints import KINDS
from jointfmu.parameters import load_default
from jointfmu.quantity import build_parameter_set

SAMPLES, POINTS, OBVIOUS = 131_072, 200, 8
STUDIES = {
    "harmonic_drive": {
        "surface.D": "2.45..2.6",
        "surface.G": "lognormal(20%)",
        "eccentricity": "0..1e-5",
        "flexspline.E": "+-5%",
    },
    "bolted_joint": {
        "surface.D": "1.38..1.46",
        "surface.G": "lognormal(20%)",
        "H": "+-5%",
        "A_0": "+-3%",
    },
    "gear_contact": {
        "surface1.D": "1.4..1.5",
        "surface1.G": "loguniform(5e-11, 2e-10)",
        "lambda": "0.8..1",
        "A_0": "+-10%",
    },
}


def difference(task, outcome, exact):
    """Largest relative difference of the outputs of the first samples, where there is load."""
    worst = 0.0
    for i, one in enumerate(exact):
        for name, value in one.items():
            worst = max(worst, float(np.max(np.abs(outcome.outputs[name][1:, i] / value[1:] - 1.0))))
    return worst


def main():
    """Print the table."""
    print(f"{SAMPLES} samples, {POINTS} points; processor seconds")
    print(f"{'joint':16} {'bands':>8} {'obvious':>10} {'ratio':>8} {'difference':>12}")
    for joint, given in STUDIES.items():
        task = state_problem(load_default(joint), given, None, POINTS)
        points = propagate.sample_designs(task, SAMPLES, 0)[0]
        start = process_time()
        propagate.compute_bands(task, points)
        fast = process_time() - start
        outcome = propagate.evaluate_samples(task, points[:OBVIOUS], task.loads, "")
        parameters = [
            build_parameter_set(KINDS[joint].parameters, propagate.select_sample(task, points, i)[0])
            for i in range(OBVIOUS)
        ]
        start = process_time()
        exact = [task.curves.exact(one, task.loads) for one in parameters]
        slow = (process_time() - start) * SAMPLES / OBVIOUS
        worst = difference(task, outcome, exact)
        print(f"{joint:16} {fast:8.1f} {slow:10.0f} {slow / fast:8.0f} {worst:12.1e}")


if __name__ == "__main__":
    main()
