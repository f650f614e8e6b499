"""A measured lapped beam whose faces, bolts and friction nobody stated: what that leaves of a prediction.

First frequency, its fall and the damping by friction over amplitude, as of benchmarks/brake_reuss.py, for
SAMPLES draws of what is unknown, each from an interval that was chosen before any comparison. Prints the
median and the 90 % band beside the measurement and beside a trivial guess: a solid bar, no loss.

Run: python benchmarks/measured_beam.py
"""

import argparse
import sys
from dataclasses import replace

import numpy as np
from brake_reuss_cases import beam, data, solid_bar
from lap_beam_loops import Joint, damping, foundation, frequency, masing
from lap_beam_plan import Fineness
from lap_beam_reduction import Structure, reduced
from measured_joints import joint_law, measured
from scipy.stats import qmc

from jointfmu.mechanics.curve import tabulate_approach
from jointfmu.progress import track_progress

UNKNOWN = {
    "preload [N]": (3e3, 13e3, False),
    "friction [1]": (0.1, 0.3, False),
    "Ra of each face [m]": (0.4e-6, 3.2e-6, True),
    "Young's modulus [Pa]": (190e9, 210e9, False),
    "crown of both faces together [m]": (-25e-6, 25e-6, False),
}
"""Least, largest, and whether the logarithm is even. Bolts of 5/16 inch at 5 to 20 N.m with a nut factor of
0.2; friction as `jointfmu new` has it where nothing is stated (VDI 2230); machined faces; stainless to
carbon steel; flat to the width of a hair. A crown touches in the middle first, a hollow (< 0) at the ends."""
SAMPLES, SEED = 20, 1
MESH = Fineness(near=4e-3, far=6e-3, layers=2)
DENSITY = 7850.0
AMPLITUDES = np.geomspace(1e-6, 4e-4, 12)
"""Modal amplitudes q [m kg^0.5] of the linear beam under the loads."""
BAND = (0.05, 0.5, 0.95)


def samples():
    """(SAMPLES, unknowns) draws by a Latin hypercube."""
    low, high, log = (np.array(column) for column in zip(*UNKNOWN.values(), strict=True))
    even = qmc.LatinHypercube(len(UNKNOWN), rng=SEED).random(SAMPLES)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(log, low * np.abs(high / low) ** even, low + even * (high - low))


def crown(height, lap):
    """Gap [m] over places x, y [m] of faces that are a parabola along the lap, 0 where they touch first."""
    return lambda x, y: height * (2.0 * x / lap) ** 2 + max(-height, 0.0)


def predicted(one, preload, friction, Ra, modulus, height):
    """Frequency [Hz] of small motions, damping ratios at the accelerations, fall of the frequency."""
    known, entries = measured("measured_beam"), data()
    one = replace(one, E=modulus)
    law = joint_law({"E": modulus, "nu": one.nu, "A_0": entries["A_0"], "Rq": 1.25 * Ra}, H=entries["H"])
    curve, shear = tabulate_approach(law), float(law.shear_stiffness_ratio())
    part = reduced(Structure.of(one, MESH), curve, preload, shear, crown(height, one.lap))
    joint = Joint(part, foundation(curve, shear, friction))
    states = joint.backbone(AMPLITUDES)
    f = np.array([frequency(state) for state in states])
    ratios = [damping(*pair) for pair in zip(masing(states), states, strict=True)]
    peaks = np.array([state.q for state in states]) * part.tip * (2.0 * np.pi * f) ** 2
    at = np.log(known["acceleration"])
    zeta = np.exp(np.interp(at, np.log(peaks), np.log(ratios)))
    first, last = np.interp(at[[0, -1]], np.log(peaks), f)
    return [part.frequency, *zeta, 1.0 - last / first]


def main(arguments=None):
    """Print the table."""
    argparse.ArgumentParser(description=__doc__).parse_args(arguments)
    known = measured("measured_beam")
    one = replace(beam(), side=known["thickness"], width=known["width"], density=DENSITY)
    rows = []
    for draw in track_progress(samples(), "samples"):
        rows.append(predicted(one, *draw))
        print("  ".join(f"{value:.4g}" for value in (*draw, *rows[-1])), file=sys.stderr, flush=True)
    low, middle, high = np.quantile(np.array(rows), BAND, axis=0)
    names = ["f [Hz]", *(f"zeta at {a:g} m/s2 [%]" for a in known["acceleration"]), "fall of f [%]"]
    facts = [known["frequency"], *known["damping"], known["fall"]]
    guesses = [solid_bar(one), 0.0, 0.0, 0.0, 0.0]
    print("| | measured | 5 % | median | 95 % | measured inside | width of the band | solid bar, no loss |")
    print("|---|---|---|---|---|---|---|---|")
    for name, fact, *band, guess in zip(names, facts, low, middle, high, guesses, strict=True):
        scale = 100.0 if "%" in name else 1.0
        cells = [f"{scale * value:.4g}" for value in (fact, *band)]
        width = f"{band[2] / band[0] - 1.0:.1%}" if "Hz" in name else f"a factor of {band[2] / band[0]:.1f}"
        inside = "yes" if band[0] <= fact <= band[2] else "no"
        print(f"| {name} | " + " | ".join([*cells, inside, width, f"{scale * guess:.4g}"]) + " |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
