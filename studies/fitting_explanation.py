"""Figures of docs/fitting_explanation.md: how often fits recover the parameters of synthetic measurements.

    python studies/fitting_explanation.py [SECTION ...] [--seeds N]

round-trips : seeds with every fitted parameter within three of its standard deviations, median relative
              errors
logs        : median errors of the friction from a robot's log, and how often the 95 % interval holds the
              truth
systems     : the same for parameters of systems from time series
"""

import sys
import tempfile
from pathlib import Path

import numpy as np
from common import print_table_head, print_table_row, run_study
from oracles import curve_measurements, drive_measurements, joint_measurements, robot_log, system_records
from oracles.curve_measurements import errors

from jointfmu.progress import track_progress

WITHOUT_INERTIA = "the same, inertia of the rotor not stated"
"""Case without the motor inertia: a third of the total inertia is the rotor's."""
FEWER_SEEDS = 6
"""Divisor of the number of seeds for the log without the inertia, whose fit takes three times as long."""


def print_round_trips(options):
    """Print how many fits are within three standard deviations of the truth, and median errors."""
    print(f"{'measurement':36} within three deviations   median error of each parameter")
    cases = curve_measurements.CASES | joint_measurements.CASES | drive_measurements.CASES
    with tempfile.TemporaryDirectory() as folder:
        for name, case in cases.items():
            found = [errors(case, seed, folder) for seed in track_progress(range(options.seeds), name)]
            hits = sum(all(abs(z) <= 3.0 for _, z in fit.values()) for fit in found)
            medians = {p: np.median([abs(fit[p][0]) for fit in found]) for p in found[0]}
            listed = ", ".join(f"{p} {100.0 * e:.2g} %" for p, e in medians.items())
            print(f"{name:36} {hits:6d} of {options.seeds}              {listed}", flush=True)


def fit_logs(make, options, seeds):
    """Fit logs: {parameter: (relative errors, whether the interval holds the truth)}, and the last fit."""
    found = {}
    for seed in range(seeds):
        fit = robot_log.fit_log(make, options, seed)
        for label in fit.solution.values:
            truth = robot_log.TRUE_VALUES[label]
            relative_errors, held = found.setdefault(label, ([], []))
            relative_errors.append(fit.parameters.values_by_name[label] / truth - 1.0)
            if label in fit.confidence_intervals:
                low, high = fit.confidence_intervals[label]
                held.append(low <= truth <= high)
    return found, fit


def print_logs(options):
    """Print median errors and coverage of the intervals."""
    print_table_head("", "log", "parameter", "median error", "95 % interval holds it")
    cases = {name: (*case, options.seeds) for name, case in robot_log.CASES.items()}
    torque_constant = {"torque_constant": robot_log.CONSTANT}
    cases[WITHOUT_INERTIA] = robot_log.write_swing, torque_constant, -(-options.seeds // FEWER_SEEDS)
    for name, case in cases.items():
        found, fit = fit_logs(*case)
        for label, (relative_errors, held) in found.items():
            median = f"{100.0 * np.median(np.abs(relative_errors)):.2g} %"
            print_table_row(name, f"`{label}`", median, f"{sum(held)} of {len(held)}")
        print(f"<!-- {fit.facts} {fit.notes} -->", file=sys.stderr)


def print_systems(options):
    """Print median errors and coverage of the intervals of system fits."""
    print_table_head("", "record", "parameter", "median error", "95 % interval holds it")
    with tempfile.TemporaryDirectory() as folder:
        for name, (_, truth) in system_records.CASES.items():
            fits = [system_records.fit_case(name, seed, Path(folder)) for seed in range(options.seeds)]
            for label, value in truth.items():
                median = np.median([abs(fit.solution.values[label] / value - 1.0) for fit in fits])
                held = sum(system_records.count_held(fit, truth)[label] for fit in fits)
                print_table_row(name, f"`{label}`", f"{100.0 * median:.2g} %", f"{held} of {len(fits)}")


if __name__ == "__main__":
    run_study(
        __doc__,
        {"round-trips": print_round_trips, "logs": print_logs, "systems": print_systems},
        options={
            "--seeds": {
                "type": int,
                "default": 100,
                "metavar": "N",
                "help": "number of random measurements of each case (default: 100)",
            }
        },
    )
