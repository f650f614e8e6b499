"""Tables of docs/validity_stiffness.md on the law of heights; part of validity_stiffness.py.

The constants were fixed on surfaces with odd seeds. The tables have even seeds; `print_fit` has the odd ones.
"""

from functools import cache

import numpy as np
from common import format_mean_and_deviation, print_table_head, print_table_row
from jointfmu_tools.inputs.drawing.tables import find_table_row
from jointfmu_tools.inputs.surfaces import bearing_curve
from jointfmu_tools.inputs.surfaces.bearing_curve import BearingCurve, HeightSample
from oracles.boundary_element import press, slope
from oracles.interface_laws import mean_measured_stiffness
from oracles.machined_surfaces import FEW_HILLS, KINDS, sample_periodic, standard
from oracles.measured_joints import SLOPE
from oracles.roughness_law import MEASURED_PRESSURES, joints_with_roughness

from jointfmu.contact.roughness import predicted_stiffness
from jointfmu.contact.surface import ElasticConstants, contact_modulus
from jointfmu.progress import track_progress

POINTS, LOADS = 128, (0.003, 0.01, 0.03, 0.1)
"""Points along a side, and pressures of the boundary elements [E* h']."""
LIGHT_POINTS, LIGHT_LOADS, LIGHT_SCALE = 512, (0.0003, 0.001, 0.003), 4
"""Points and pressures for light load, and factor by which its waves are shorter: 16 times as many hills."""
FITTED, PROVED = (1, 3), (0, 2)
"""Seeds of the fit, and of the proof."""
FACTORS = (2.0, 3.0, 4.0, 5.0, 6.0)
SAMPLES = 16
"""Samples of random heights of a joint: a section at light load has few points, so single samples scatter."""
LIMITS = (0.45, 0.48, 0.5, 0.55)
"""Constants tried on the odd seeds: SECTION_AREA_FACTOR, GAUSSIAN_DECAY_LENGTH_OVER_RMS_HEIGHT."""


@cache
def solved(kind, seed, points, scale=1):
    """Bearing curve, skewness, pressures [E*], stiffness [E* over side] of a surface by boundary elements."""
    kinds = KINDS | FEW_HILLS
    number = 1000 * list(kinds).index(kind)
    z = kinds[kind](seed + number, points, *([scale] if scale > 1 else []))
    contacts = press(z, slope(z) * np.array(LOADS if scale == 1 else LIGHT_LOADS))
    sample = sample_periodic(z)
    p, k = np.array([[c.p, c.stiffness] for c in contacts]).T
    return BearingCurve.from_height_sample(sample), sample.standardized_moment(3), p, k


def ratios(kind, seeds, points=POINTS, scale=1, gaussian=False):
    """Stiffness (seeds, loads) [1] of the law over boundary elements; `gaussian`: of the law p/(0.45 h)."""
    rows = []
    for seed in seeds:
        curve, _, p, k = solved(kind, seed, points, scale)
        rows.append((predicted_stiffness(p, 1.0) if gaussian else curve.normal_stiffness(p, 1.0)) / k)
    return np.array(rows)


def print_table(title, kinds, seeds, points=POINTS, scale=1):
    """Print the law of heights, and p/(0.45 h), over boundary elements; return the ratios of the law."""
    loads = LOADS if scale == 1 else LIGHT_LOADS
    names = ("surface", "skewness", *(f"{load:g}" for load in loads), *(f"p/(0.45 h): {x:g}" for x in loads))
    print_table_head(f"{title}: law over boundary elements at p/(E* h')", *names)
    found = []
    for kind in track_progress(kinds, "surfaces"):
        law = ratios(kind, seeds, points, scale)
        plain = ratios(kind, seeds, points, scale, gaussian=True).mean(axis=0)
        skewness = np.mean([solved(kind, seed, points, scale)[1] for seed in seeds])
        cells = [f"{r.mean():.2f} ({r.min():.2f} to {r.max():.2f})" for r in law.T]
        print_table_row(kind, f"{skewness:.1f}", *cells, *(f"{one:.2f}" for one in plain))
        found.append(law)
    law = np.array(found)
    if len(kinds) > 2:
        log, mean = np.log(law), law.mean(axis=1)
        print(
            f"\nrms of ln(law over boundary elements) {np.sqrt(np.mean(log**2)):.3f}; single cases beyond a "
            f"factor of 1.5: {np.sum(np.abs(log) > np.log(1.5))} of {law.size}; means beyond 30 %: "
            f"{np.sum(np.abs(mean - 1.0) > 0.3)} of {mean.size}"
        )
    return law


def print_proof():
    """Print the law of heights on surfaces with even seeds, on surfaces of few hills, and at light load."""
    print_table("surfaces of the proof", list(KINDS), PROVED)
    print_table("fewer than 16 hills", list(FEW_HILLS), (0, 2, 4, 6))
    print_table("light load, 16 times as many hills", list(KINDS), PROVED[:1], LIGHT_POINTS, LIGHT_SCALE)


def print_fit():
    """Print the rms of ln(law over boundary elements) on the odd seeds, for values of both constants."""
    print_table_head("rms of ln(law over boundary elements), odd seeds", "SECTION_AREA_FACTOR", *LIMITS)
    kept = bearing_curve.SECTION_AREA_FACTOR, bearing_curve.GAUSSIAN_DECAY_LENGTH_OVER_RMS_HEIGHT
    for factor in FACTORS:
        cells = []
        for limit in LIMITS:
            bearing_curve.SECTION_AREA_FACTOR, bearing_curve.GAUSSIAN_DECAY_LENGTH_OVER_RMS_HEIGHT = (
                factor,
                limit,
            )
            log = np.log(np.concatenate([ratios(kind, FITTED) for kind in KINDS]))
            cells.append(f"{np.sqrt(np.mean(log**2)):.3f}")
        print_table_row(factor, *cells)
    bearing_curve.SECTION_AREA_FACTOR, bearing_curve.GAUSSIAN_DECAY_LENGTH_OVER_RMS_HEIGHT = kept


def skewed_heights(Rq, skewness, seed):
    """Sample of lognormal heights [m] with an rms height and a skewness, slope as assumed of the joints."""
    normal = np.random.default_rng(seed).standard_normal(2**20)
    spread = np.geomspace(1e-3, 1.2, 400)
    moments = (np.exp(spread**2) + 2.0) * np.sqrt(np.expm1(spread**2))
    s = np.sign(skewness or 1.0) * np.interp(abs(skewness), moments, spread)
    return HeightSample(Rq * standard(np.sign(s) * np.exp(s * normal)), np.full(normal.size, 0.5 * SLOPE**2))


def print_joints():
    """Print the law of heights over measured joints, with the skewness of their finish: mean and standard
    deviation of samples of the heights."""
    pressures = [f"{p / 1e6:g} MPa" for p in MEASURED_PRESSURES]
    print_table_head("law of heights over measured stiffness", "joint", "skewness of each side", *pressures)
    for joint in joints_with_roughness():
        finish = next(name for name in ("ground", "scraped", "lapped") if name in joint["id"])
        numbers = find_table_row("finishes", finish).sourced_numbers
        body = ElasticConstants(E=joint["E"], nu=joint["nu"])
        middle = mean_measured_stiffness(joint, MEASURED_PRESSURES)
        skews = dict.fromkeys([0.0, *(numbers[f"skewness{end}"].si_value for end in ("_high", "", "_low"))])
        for skewness in skews:
            k = np.array([sampled_stiffness(joint, body, skewness, sample) for sample in range(SAMPLES)])
            print_table_row(
                joint["id"],
                f"{skewness:g}",
                *(format_mean_and_deviation(one, "{:.2f}") for one in (k / middle).T),
            )


def sampled_stiffness(joint, body, skewness, sample):
    """Stiffness per area [N/m3] of a measured joint by the law of heights, from one sample of its heights."""
    sides = [skewed_heights(joint["Rq"], skewness, 2 * sample + side) for side in (1, 2)]
    curve = BearingCurve.from_height_sample(bearing_curve.add_independent_surfaces(*sides))
    return curve.normal_stiffness(MEASURED_PRESSURES, contact_modulus(body, body))


def print_heights():
    """Print fit and proof of the law of heights, and the law over measured joints."""
    print_fit()
    print_proof()
    print_joints()
