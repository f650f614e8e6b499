"""Processor time of a sample of `jointfmu uncertainty`, on a ramp of POINTS loads, for each joint.

One process, one core: set OPENBLAS_NUM_THREADS=1.
"""

from time import process_time

from jointfmu_tools.studies.uncertainty import propagate
from jointfmu_tools.studies.uncertainty.problem import define_joint_study

from jointfmu.parameters import load_default

SAMPLES, POINTS = 1024, 200
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


def main():
    """Print the table of times."""
    print(f"{SAMPLES} samples, {POINTS} points")
    print(f"{'joint':16} {'processor time of a sample [ms]':>32}")
    for joint, given in STUDIES.items():
        task = define_joint_study(load_default(joint), given, None, POINTS)
        runs = task.list_run_settings(propagate.draw_independent_point_sets(task, SAMPLES, 0)[0])
        task.run_evaluator.execute_run(0, runs[0])  # opens the joint
        start = process_time()
        for i, settings in enumerate(runs):
            task.run_evaluator.execute_run(i, settings)
        print(f"{joint:16} {1e3 * (process_time() - start) / SAMPLES:32.2f}")


if __name__ == "__main__":
    main()
