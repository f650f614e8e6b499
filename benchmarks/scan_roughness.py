"""h and slope of scans over a longest wave against the spectrum's (docs/surfaces_explanation.md).

Gaussian self-affine surfaces that go on beyond the scan, read as `jointfmu surface` reads them.
"""

import band_of_waves
import numpy as np
from jointfmu_tools.inputs import fractal
from jointfmu_tools.inputs.surfaces import form
from jointfmu_tools.inputs.surfaces.form import remove_form
from surface_round_trip import FRESH, gaussian

SHARES = (1.0, 0.5, 0.25)
"""Longest wave over the side of the scan."""


def ratios(heights, D, G):
    """(2 x 3) h and slope over the spectrum's, at every longest wave."""
    flat, H = remove_form(heights), 2.0 - D
    rows = []
    for share in SHARES:
        longest = share * heights.lengths[0]
        found = form.scan_roughness(flat, flat, longest)
        h = band_of_waves.rms_height(H, G, longest, 2.0 * heights.dx)
        slope = band_of_waves.rms_slope(H, G, longest, found.shortest_wave)
        rows.append((found.h / h, found.slope / slope))
    return np.transpose(rows)


def main(points=128, draws=100):
    """Print the table, and h of the specimen of Zhao 2018."""
    print(f"Gaussian map, {points} x {points} points, {draws} each: mean and standard deviation")
    print("| D | h: " + " | ".join(f"{share:g} L" for share in SHARES) + " | slope: L |")
    for D in (1.2, 1.5, 1.8):
        rng = np.random.default_rng(FRESH)
        found = np.array([ratios(gaussian(points, D, 1e-9, rng, True), D, 1e-9) for _ in range(draws)])
        mean, scatter = found.mean(axis=0), found.std(axis=0)
        cells = [f"{m:.2f} ± {s:.2f}" for m, s in zip(mean[0], scatter[0], strict=True)]
        print(f"| {D} | " + " | ".join([*cells, f"{mean[1, 0]:.2f} ± {scatter[1, 0]:.2f}"]) + " |")
    h, own = (fractal.rms_height(1.42, 1.21e-8, 1e-3, gamma=gamma) for gamma in (None, 1.5))
    print(f"specimen of Zhao 2018, waves up to 1 mm: h = {h:.3g} m, of a function with that wave {own:.3g} m")


if __name__ == "__main__":
    main()
