"""Figures of docs/surfaces_explanation.md: generated surfaces identified again, and scans of long waves.

    python studies/surfaces_explanation.py [SECTION ...] [--draws N]

identification : errors of D and G of Weierstrass-Mandelbrot and of Gaussian self-affine surfaces, coverage of
                 the intervals, time
scans          : h and slope of Gaussian scans up to a longest wave, over h and slope of the spectrum

All surfaces are read as `jointfmu surface` reads them.
"""

from time import perf_counter

import numpy as np
from common import run_study
from jointfmu_tools.inputs import fractal
from jointfmu_tools.inputs.surfaces import form, synthesis
from jointfmu_tools.inputs.surfaces.form import remove_form
from jointfmu_tools.inputs.surfaces.heights import ArealMap, Profile
from jointfmu_tools.inputs.surfaces.identify import identify_surface
from oracles import rough_surfaces

DIMENSIONS = (1.2, 1.3, 1.4, 1.5, 1.6, 1.7, 1.8)
ROUGHNESSES = (1e-12, 1e-9, 1e-7)
SEEDS = range(9)
FIRST_SEED = 770000
"""First seed; surfaces with these seeds were not used to choose the method and its constants."""
SHAPES = {"isotropic": 1000, "textured": 2048, "profile": 4096}


def weierstrass_mandelbrot(shape, points, D, G, seed):
    """Heights of a Weierstrass-Mandelbrot surface whose profiles (textured: along x) have the dimension D."""
    waves = synthesis.FractalWaves(size=1e-3, points=points, gamma=1.5)
    if shape == "isotropic":
        return synthesis.synthesize_isotropic(waves, D + 1.0, G, 20, seed)
    if shape == "textured":
        square = synthesis.synthesize_textured(waves, (D, 3.0 - D), (G, G), seed)
        return ArealMap(z=square.z[:64], dx=square.dx, dy=square.dy, scan_name=square.scan_name)
    return synthesis.synthesize_profile(waves, D, G, seed)


def gaussian(points, D, G, rng, areal):
    """Heights of a Gaussian self-affine surface, a part of a periodic one four times as long."""
    dx, n, H = 1e-6, 4 * points, 2.0 - D
    f = np.fft.rfftfreq(n, dx)
    shape = (n, n) if areal else (n,)
    if areal:
        f = np.hypot(f, np.fft.fftfreq(n, dx)[:, None])
    f.flat[0] = np.inf
    share = 1.0 / (np.pi * f**2 * (n * dx) ** 2) if areal else 1.0 / (f * n * dx)
    noise = np.fft.rfftn(rng.standard_normal(shape))
    z = np.fft.irfftn(
        noise * np.sqrt(0.5 * fractal.height_variance_density(f, H, G) * share * n**f.ndim),
        s=shape,
        axes=range(f.ndim),
    )
    if areal:
        return ArealMap(z=z[:points, :points].copy(), dx=dx, dy=dx, scan_name="Gaussian")
    return Profile(z=z[:points].copy(), dx=dx, scan_name="Gaussian")


def errors(heights, direction, D, G):
    """{method or "best": (error of D, D inside its interval, error of ln G, G inside)}; maps: G_s."""
    found = identify_surface([heights])
    results = {m: found.select_best_result(direction, m) for m in ("structure", "psd")} | {
        "best": found.select_best_result(direction)
    }
    row = {}
    for name, one in results.items():
        d, g = one.profile_fractal.D, one.areal_fractal.G_s if direction == "areal" else one.profile_fractal.G
        row[name] = (
            d.estimated_value - D,
            d.confidence_interval_low <= D <= d.confidence_interval_high,
            np.log(g.estimated_value / G),
            g.confidence_interval_low <= G <= g.confidence_interval_high,
        )
    return row


def print_errors(title, direction, cases):
    """Print the errors of D and G identified from synthesized surfaces: a row for each D and method.

    cases : function of the dimension D that yields (heights [m], G [m]) of each surface
    """
    print(f"\n{title}\n| D | method | bias of D | largest error of D | D inside | bias of ln G | G inside |")
    print("|---|---|---|---|---|---|---|")
    worst, inside = 0.0, []
    for D in DIMENSIONS:
        rows = [errors(heights, direction, D, G) for heights, G in cases(D)]
        for method in rows[0]:
            e = np.array([row[method] for row in rows], dtype=float)
            print(
                f"| {D} | {method} | {e[:, 0].mean():+.3f} | {np.abs(e[:, 0]).max():.3f} "
                f"| {e[:, 1].mean():.2f} | {np.nanmean(e[:, 2]):+.2f} | {e[:, 3].mean():.2f} |",
                flush=True,
            )
            if method == "best":
                worst, inside = max(worst, np.abs(e[:, 0]).max()), inside + list(e[:, 3])
    print(f"best: largest error of D {worst:.3f}, G inside its interval in {100 * np.mean(inside):.1f} %")
    return worst, float(np.mean(inside))


def print_identification(options):
    """Print errors of identified D and G, coverage of their intervals, and the time for a million points."""
    for shape, points in SHAPES.items():
        direction = {"isotropic": "areal", "textured": "x"}.get(shape, "profile")

        def cases(D, shape=shape, points=points):
            """Yield (heights [m], G [m]) of surfaces with random phases, one for each seed."""
            for seed in SEEDS:
                G = ROUGHNESSES[seed % len(ROUGHNESSES)]
                yield weierstrass_mandelbrot(shape, points, D, G, FIRST_SEED + 1000 * round(10 * D) + seed), G

        print_errors(f"Weierstrass-Mandelbrot, {shape}, {points} points along x", direction, cases)
    for areal, points in ((False, 2048), (True, 128)):
        rng = np.random.default_rng(FIRST_SEED + points)

        def random(D, areal=areal, points=points, rng=rng):
            return ((gaussian(points, D, 1e-9, rng, areal), 1e-9) for _ in range(options.draws))

        kind = "map" if areal else "profile"
        print_errors(
            f"Gaussian {kind}, {points} points, {options.draws} each", "areal" if areal else "profile", random
        )
    start = perf_counter()
    heights = weierstrass_mandelbrot("isotropic", 1000, 1.5, 1e-9, 1)
    middle = perf_counter()
    identify_surface([heights])
    print(
        f"\na million points: made in {middle - start:.2f} s, identified in {perf_counter() - middle:.2f} s"
    )


# scans

SHARES = (1.0, 0.5, 0.25)
"""Longest waves over the side of the scan [1]."""


def scan_ratios(heights, D, G):
    """Ratios (2, 3) of h and slope of scans to h and slope of the spectrum, for three longest waves."""
    flat, H = remove_form(heights), 2.0 - D
    rows = []
    for share in SHARES:
        longest = share * heights.side_lengths[0]
        found = form.compute_scan_roughness(flat, flat, longest)
        h = rough_surfaces.rms_height(H, G, longest, 2.0 * heights.dx)
        slope = rough_surfaces.rms_slope(H, G, longest, found.shortest_wave)
        rows.append((found.long_wave_rms_height / h, found.rms_slope / slope))
    return np.transpose(rows)


def print_scans(options, points=128):
    """Print h and slope of scans over h and slope of the spectrum, and h of the specimen of Zhao 2018."""
    print(f"Gaussian map, {points} x {points} points, {options.draws} each: mean and standard deviation")
    print("| D | h: " + " | ".join(f"{share:g} L" for share in SHARES) + " | slope: L |")
    for D in (1.2, 1.5, 1.8):
        rng = np.random.default_rng(FIRST_SEED)
        found = np.array(
            [scan_ratios(gaussian(points, D, 1e-9, rng, True), D, 1e-9) for _ in range(options.draws)]
        )
        mean, scatter = found.mean(axis=0), found.std(axis=0)
        cells = [f"{m:.2f} ± {s:.2f}" for m, s in zip(mean[0], scatter[0], strict=True)]
        print(f"| {D} | " + " | ".join([*cells, f"{mean[1, 0]:.2f} ± {scatter[1, 0]:.2f}"]) + " |")
    h, own = (fractal.rms_height(1.42, 1.21e-8, 1e-3, gamma=gamma) for gamma in (None, 1.5))
    print(f"specimen of Zhao 2018, waves up to 1 mm: h = {h:.3g} m, of a function with that wave {own:.3g} m")


if __name__ == "__main__":
    run_study(
        __doc__,
        {"identification": print_identification, "scans": print_scans},
        options={
            "--draws": {
                "type": int,
                "default": 100,
                "help": "number of Gaussian surfaces of each kind (default: 100)",
            }
        },
    )
