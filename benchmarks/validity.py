"""Print the tables of docs/validity_stiffness.md, a quarter of an hour; `--images` draws its pictures too.

`python benchmarks/validity.py [--images]`
"""

import sys
from dataclasses import replace

import interface_laws as compare
import numpy as np
import validity_laws
import validity_pictures as pictures
from boundary_element import hertz, westergaard
from validity_pictures import GAMMA, HURST
from validity_tables import heading, row, spread

from jointfmu.progress import track_progress

ROLL_OFF = (1, 4)
LOADS = (0.003, 0.006, 0.012, 0.025, 0.05, 0.1)
"""Pressures of the elastic contacts [E* h'_rms]."""


def verification():
    """Closed forms, refinement, tangential ratio."""
    heading(
        "Hertz, Westergaard: relative errors", "points", "a²", "p_0", "approach", "k", "width", "gap", "k"
    )
    for points in (32, 64, 128, 256):
        row(points, *(f"{e:+.1e}" for e in hertz(points)), *(f"{e:.1e}" for e in westergaard(points)))
    heading(
        "One surface on finer grids",
        "spacings in the shortest wave",
        "alpha at p/(E* h'_rms) = 0.01, 0.03, 0.1",
        "kappa",
    )
    for factor, alpha, kappa in zip((2, 4, 8), *compare.resolution(), strict=True):
        row(factor, *(", ".join(f"{x:.2f}" for x in one) for one in (alpha, kappa)))
    heading("K_T/K_N of bonded contacts", "nu", "boundary elements", "2(1 - nu)/(2 - nu)")
    for nu in (0.0, 0.28, 0.45):
        row(nu, spread(compare.tangential_ratio(nu), "{:.3f}"), f"{2 * (1 - nu) / (2 - nu):.3f}")


def elastic():
    """Elastic stiffness and area without units; returns {(H, roll-off): results}."""
    found = {(H, r): compare.elastic(H, r, loads=LOADS) for H in HURST for r in ROLL_OFF}
    for name, title in (
        ("alpha", "alpha = k h_rms/p"),
        ("kappa", "kappa = (A_r/A_0) E* h'_rms/p"),
        ("isolated", "stiffness of the spots, each on its own, over k"),
    ):
        heading(f"{title}, at p/(E* h'_rms)", "H", "longest wave", *LOADS)
        for (H, r), one in found.items():
            row(H, "side" if r == 1 else f"side/{r}", *(spread(column) for column in one[name].T))
    heading("exponent of k over p, first and last three loads", "H", "longest wave", "low", "high", "1/(1+H)")
    for (H, r), one in found.items():
        k = one["alpha"] * np.array(LOADS)
        ends = [[compare.exponent(LOADS[s], x[s]) for x in k] for s in (slice(3), slice(3, 6))]
        row(H, "side" if r == 1 else f"side/{r}", *(spread(e) for e in ends), f"{1 / (1 + H):.2f}")
    loads = (0.0003, 0.001, 0.003, 0.01)
    heading("alpha of many spots at light load, H = 0.58", "longest wave", *loads)
    for part, finest in ((8, 8), (16, 4)):
        alpha = compare.elastic(0.58, part, loads, finest=finest)["alpha"]
        row(f"side/{part}", *(spread(column) for column in alpha.T))
    return found


def laws():
    """The three laws on their own surfaces; returns {(law, side): (case, boundary elements, law)}."""
    results = {}
    for name, case in compare.cases().items():
        for side in track_progress(case.sides, name):
            b, law = compare.against(case, side), compare.law_state(case, side)
            results[name, side] = case, b, law
            title = f"{name}, side {side * 1e3:.3g} mm, h_rms {b['rms'].mean() * 1e6:.2g} µm"
            names = (
                "k",
                "loading",
                "law k",
                "law/k",
                "A_r/A_0",
                "law",
                "at H",
                "law not elastic",
                "p/(0.48 h_rms)",
            )
            heading(title, "p [MPa]", *names)
            for i, p in enumerate(case.pressures):
                row(
                    f"{p / 1e6:.3g}",
                    *(spread(b[q][:, i]) for q in ("k", "loading")),
                    f"{law['k'][i]:.2g}",
                    f"{law['k'][i] / b['k'][:, i].mean():.2g}",
                    spread(b["area"][:, i]),
                    f"{law['area'][i]:.2g}",
                    spread(b["plastic"][:, i]),
                    f"{law['plastic'][i]:.2g}",
                    f"{p / (GAMMA * b['rms'].mean()):.2g}",
                )
            slopes = [compare.exponent(case.pressures, k) for k in b["k"]]
            areas = [compare.exponent(case.pressures, a) for a in b["area"]]
            own = [compare.exponent(case.pressures, np.maximum(law[q], 1e-300)) for q in ("k", "area")]
            print(
                f"exponent of k {spread(slopes)}, law {own[0]:.2f}; of A_r {spread(areas)}, law {own[1]:.2f}"
            )
    return results


def grids():
    """How much the answer depends on band and grid: Zhao's surface, two seeds."""
    case = compare.cases()["zhao2018"]
    case = replace(case, pressures=case.pressures[[0, -1]])
    names = ("side [mm]", "points", "spacings in the shortest wave", "0.5 MPa", "16 MPa", "A_r/A_0 at 16 MPa")
    heading("k [N/m3] and real area, zhao2018", *names)
    for side in case.sides:
        for points, finest in ((128, 8), (128, 4), (256, 16), (256, 8), (256, 4)):
            found = compare.against(case, side, range(2), points=points, finest=finest)
            k, area = found["k"].mean(axis=0), found["area"].mean(axis=0)
            row(f"{side * 1e3:.3g}", points, finest, f"{k[0]:.2g}", f"{k[-1]:.2g}", f"{area[-1]:.2g}")
    case = replace(case, pressures=np.array([1e6, 4e6, 16e6]))
    found, law = compare.against(case, 1e-3, points=128)["k"], compare.law_state(case, 1e-3)["k"]
    print("\nzhao2018 on 1 mm2 at 1, 4, 16 MPa: boundary elements", *(spread(k) for k in found.T), end="")
    print(", law", *(f"{k:.2g}" for k in law))


def main(images=False):
    """Print the tables; draw the pictures."""
    validity_laws.joints()
    validity_laws.levels()
    validity_laws.sizes()
    validity_laws.parameters()
    if images:
        pictures.joints()
    verification()
    found = elastic()
    results = laws()
    grids()
    if images:
        pictures.elastic(found, LOADS)
        pictures.laws(results)


if __name__ == "__main__":
    main("--images" in sys.argv[1:])
