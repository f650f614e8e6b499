"""Natural frequencies of Zhao's box specimen: lengths from those at 9 kN, the others predicted.

    python benchmarks/box_specimen.py [--identify] [--plot FILE]

Prints the frequencies of Table 3 by the shipped lengths, with the computed and with a uniform pressure,
the choices of the law, finer meshes, and f1 over the preload (Fig. 12). --identify fits
the lengths anew (three minutes), from START.
"""

import argparse
from dataclasses import replace
from pathlib import Path

import box_specimen_lengths as box
import numpy as np
from jointfmu_tools.common import plots
from jointfmu_tools.studies.published.reference import read_points
from numpy.typing import NDArray
from published_marks import published_mark

from jointfmu.parameters import load_default

Array = NDArray[np.float64]
STATES = [(9e3, 0.0), (15e3, 0.0), (15e3, 4500.0)]
NAMES = ("9 kN", "15 kN", "15 kN, 4500 N m")
PAPER = {
    "non-uniform": [
        [531.74, 640.83, 834.67, 863.05, 1299.8, 1408.7],
        [555.26, 641.8, 854.63, 872.8, 1319.8, 1407.5],
        [551.81, 637.53, 836.72, 878.42, 1308.1, 1416.8],
    ],
    "uniform": [
        [556.5, 613.21, 840.12, 830.64, 1250.63, 1441.49],
        [588.61, 619.16, 835.20, 838.19, 1263.35, 1467.82],
        [588.61, 619.16, 835.20, 838.19, 1263.35, 1467.82],
    ],
}
"""Frequencies [Hz] of the paper's own models (Table 3)."""
CHOICES = [("continuity", "family"), ("continuity", "hertz"), ("printed", "family"), ("printed", "hertz")]
PRELOADS = np.array([3e3, 6e3, 9e3, 12e3, 15e3, 18e3, 21e3, 24e3, 27e3, 30e3, 36e3])
START = (0.327, 0.257, 0.0192, 0.052, 0.036)
"""Lengths [m] where the fit begins: near the best that box_specimen_search.py finds with the default law."""


def measured() -> Array:
    """Table 3 (states, modes) [Hz]."""
    at = {
        (p.where["preload"], p.where["moment"], p.where["mode"]): p.value
        for p in read_points("zhao2018_modes")
    }
    return np.array([[at[(*state, mode)] for mode in range(1, 7)] for state in STATES])


def row(name: str, values: Array, form: str = "8.2f") -> None:
    """Print a line of six numbers."""
    print(f"{name:42s}" + " ".join(f"{value:{form}}" for value in values))


def table(found: Array, even: Array) -> None:
    """Errors against the measurement [%], ours and the paper's."""
    target = measured()
    for i, name in enumerate(NAMES):
        row(f"{name}: measured [Hz]", target[i])
        row("  computed field [Hz]", found[i])
        row("  error [%]", 100 * (found[i] / target[i] - 1), "8.1f")
        row("  uniform pressure, error [%]", 100 * (even[i] / target[i] - 1), "8.1f")
        for kind, values in PAPER.items():
            row(f"  the paper, {kind}, error [%]", 100 * (np.array(values[i]) / target[i] - 1), "8.1f")
    for name, values in (
        ("computed field", found),
        ("uniform pressure", even),
        ("9 kN measured, taken for both others", np.tile(target[0], (3, 1))),
        *((f"the paper, {kind}", np.array(values)) for kind, values in PAPER.items()),
    ):
        error = np.abs(values[1:] / target[1:] - 1)
        within = int(np.sum(error <= 0.051))
        print(f"predicted rows, {name}: largest error {100 * error.max():.1f} %, {within} of 12 within 5.1 %")
    rise = [100 * (values[1] / values[0] - 1) for values in (target, found)]
    row("rise from 9 to 15 kN, measured [%]", rise[0], "8.1f")
    row("  computed [%]", rise[1], "8.1f")


def choices(assembly: box.Assembly) -> None:
    """Rise from 9 to 15 kN with every choice of the law, at the same lengths."""
    joint = load_default("bolted_joint").values
    for area, spot in CHOICES:
        one = replace(joint, critical_area=area, spot_stiffness=spot)
        found = box.frequencies(assembly, one, STATES[:2])
        row(f"{area}, {spot}: 9 kN [Hz]", found[0])
        row("  rise to 15 kN [%]", 100 * (found[1] / found[0] - 1), "8.1f")


def levelling(assembly: box.Assembly, plot: Path | None) -> None:
    """f1 over the preload (Fig. 12)."""
    joint = load_default("bolted_joint").values
    states = [(float(p), 0.0) for p in PRELOADS]
    found, even = (
        box.frequencies(assembly, joint, states, mode_count=1, uniform_pressure=e) for e in (False, True)
    )
    for preload, f, g in zip(PRELOADS, found[:, 0], even[:, 0], strict=True):
        print(f"{preload / 1e3:5.0f} kN: f1 {f:8.2f} Hz, with uniform pressure {g:8.2f} Hz")
    slopes = np.diff(found[:, 0]) / np.diff(PRELOADS) * 1e3
    print(f"slope of f1: {slopes[1]:.2f} Hz/kN at 7.5 kN, {slopes[-1]:.2f} Hz/kN at 33 kN")
    if plot:
        target = measured()
        with plots.open_figure(plot) as figure:
            axes = figure.subplots()
            axes.plot(PRELOADS / 1e3, found[:, 0], color=plots.BLUE, label="computed field")
            axes.plot(PRELOADS / 1e3, even[:, 0], "--", color=plots.GREY, label="uniform pressure")
            for x, f, role in ((9, target[0, 0], "calibration"), (15, target[1, 0], "prediction")):
                axes.plot(x, f, **published_mark(role, plots.RED))
            axes.set(xlabel="preload per bolt in kN", ylabel="f1 in Hz")
            axes.legend()


def identify(assembly: box.Assembly) -> box.Assembly:
    """Fit the lengths anew."""
    start = box.specimen(assembly, START)
    found = box.identify(start, load_default("bolted_joint").values, STATES[0][0], measured()[0])
    for name, value in found.lengths.items():
        print(f"{name:17s} {1e3 * value:7.1f} mm, +- {100 * found.deviation[name]:.0f} %")
    row("error of the fit [%]", 100 * found.error, "8.1f")
    row("singular values of the slopes", np.linalg.svd(found.slope)[1], "8.3f")
    return box.specimen(assembly, list(found.lengths.values()))


def main() -> None:
    """Print what the docs quote."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--identify", action="store_true", help="fit the lengths anew")
    parser.add_argument("--plot", type=Path, help="draw f1 over the preload")
    args = parser.parse_args()
    assembly = box.shipped()
    if args.identify:
        assembly = identify(assembly)
    joint = load_default("bolted_joint").values
    found, even = (box.frequencies(assembly, joint, STATES, uniform_pressure=e) for e in (False, True))
    table(found, even)
    fine = box.frequencies(assembly, joint, STATES[:1], refinement=1.0)
    row("9 kN on elements half as long, change [%]", 100 * (fine[0] / found[0] - 1), "8.2f")
    choices(assembly)
    levelling(assembly, args.plot)


if __name__ == "__main__":
    main()
