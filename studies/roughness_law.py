"""Tables of docs/validity_stiffness.md on the law `roughness`; part of validity_stiffness.py."""

from dataclasses import replace

import numpy as np
from common import format_mean_and_deviation, print_table_head, print_table_row
from oracles import interface_laws as compare
from oracles import roughness_law as cases
from oracles.measured_joints import LONGEST, joint_law, level, measured
from scipy.optimize import least_squares

from jointfmu.contact.interface import stiffness_curve
from jointfmu.progress import track_progress

CHOICES = [(area, spot) for area in ("continuity", "printed", "yield") for spot in ("family", "hertz")]
"""Choices of the law `zhao2018`: of the critical area and of the spot stiffness."""
WAVES = (5e-3, 40e-3)
"""Longest waves [m] in addition to the default; the second one is the side of the joints."""
HEIGHTS = (0.3e-6, 1e-6, 3e-6)
"""Rms heights [m] of a second roughness scale."""
HARDNESSES, SLOPES = (1e9, 2e9, 4e9), (0.05, 0.15, 0.3)
"""Hardnesses [Pa] and rms slopes [1] of the measured joints, which the sources do not state."""
FITTED_PRESSURES = slice(0, 4)
"""Pressures of `cases.MEASURED_PRESSURES` to which a second scale is fitted: 0.1 to 2 MPa."""


def wave_name(roll_off):
    """Text that describes the longest wave."""
    return "side" if roll_off == 1 else f"side/{roll_off}"


def two_digits(values):
    """Format numbers with two decimals."""
    return (f"{value:.2f}" for value in values)


def print_elastic():
    """Print the law over boundary elements, elastic, on surfaces not used to choose its constants."""
    print(f"\nseeds of development {list(cases.DEVELOPMENT)}, here {cases.SEEDS}")
    kinds = [(H, roll_off) for H in cases.HURST for roll_off in cases.LOADS]
    found = {kind: cases.elastic_contacts(*kind) for kind in track_progress(kinds, "surfaces")}
    beyond = all_cases = 0
    for roll_off, loads in cases.LOADS.items():
        band = f"waves up to {wave_name(roll_off)}, at y (x)"
        title = f"law over boundary elements, mean (least to largest), {band}"
        print_table_head(title, "H", *(f"{y:g} ({y * roll_off**2:.2g})" for y in loads), "beyond 30 %")
        for H in cases.HURST:
            one = found[H, roll_off]
            ratio, use = one["law"] / one["k"], cases.in_valid_range(roll_off, one["area"])
            mean = one["law"].mean(axis=0) / one["k"].mean(axis=0)
            cells = [f"{m:.2f} ({r.min():.2f} to {r.max():.2f})" for m, r in zip(mean, ratio.T, strict=True)]
            missed = int((np.abs(ratio - 1.0) > 0.3)[use].sum())
            print_table_row(H, *cells, f"{missed} of {use.sum()}")
            beyond, all_cases = beyond + missed, all_cases + int(use.sum())
    print(f"\nbeyond 30 %: {beyond} of {all_cases} single cases with x >= {cases.MIN_LOAD:g}")
    print_table_head(
        "the same with the tail of the heights, mean, waves up to side/16", "H", *cases.LOADS[16]
    )
    for H in cases.HURST:
        one = found[H, 16]
        print_table_row(H, *two_digits(one["tail"].mean(axis=0) / one["k"].mean(axis=0)))
    print_table_head(
        "exponent d ln k/d ln p", "H", "longest wave", "boundary elements", "law", "difference of means"
    )
    for (H, roll_off), one in found.items():
        k, law = cases.exponents(one, roll_off)
        print_table_row(
            H,
            wave_name(roll_off),
            format_mean_and_deviation(k),
            f"{law.mean():.2f}",
            f"{(law - k).mean():+.2f}",
        )


def print_plastic():
    """Print the law over boundary elements with a hardness."""
    names = ("longest wave", "H over E* h'", "p/H", "K_loading", "K_N", "A_r")
    print_table_head("law over boundary elements with a hardness, H = 0.3 and 0.8", *names)
    for roll_off in track_progress((1, 4), "hardness"):
        for hardness, load in ((0.5, 0.03), (0.5, 0.1), (0.15, 0.03), (0.15, 0.1), (0.05, 0.1), (0.05, 0.3)):
            both = [cases.plastic(H, roll_off, hardness, load, seeds=cases.SEEDS[16]) for H in (0.3, 0.8)]
            print_table_row(
                wave_name(roll_off),
                hardness,
                load,
                *(format_mean_and_deviation(one) for one in np.concatenate(both, axis=1)),
            )


def print_joints():
    """Print the law over measured joints, and the other three laws over measured joints."""
    pressures = [f"{p / 1e6:g} MPa" for p in cases.MEASURED_PRESSURES]
    print_table_head("law over measured tangent of the approach", "joint", "h [µm]", "law", *pressures)
    for joint in cases.joints_with_roughness():
        law = joint_law(joint)
        middle = compare.mean_measured_stiffness(joint, cases.MEASURED_PRESSURES)
        rows = {name: level(law, cases.MEASURED_PRESSURES, name) for name in ("K_loading", "K_N")}
        rows["p/(0.45 h)"] = cases.MEASURED_PRESSURES / (law.gamma * law.h)
        for name, k in rows.items():
            print_table_row(joint["id"], f"{law.h * 1e6:.2f}", name, *two_digits(k / middle))
    print_loading_stiffness(pressures)
    print_table_head("exponent of the stiffness, 0.1 to 2 MPa", "joint", "measured", "K_loading", "K_N")
    for joint in cases.joints_with_roughness():
        p, law = cases.MEASURED_PRESSURES[FITTED_PRESSURES], joint_law(joint)
        k = compare.mean_measured_stiffness(joint, p), level(law, p, "K_loading"), level(law, p)
        print_table_row(joint["id"], *two_digits(compare.exponent(p, one) for one in k))
    zhao, hu, yu = (case.law for case in compare.cases().values())
    others = {
        f"zhao2018 {area} {spot}": replace(zhao, critical_area=area, spot_stiffness=spot)
        for area, spot in CHOICES
        if spot == "hertz" or area == "continuity"
    }
    print_table_head("the same of the other laws, whatever the finish", "joint", "law", *pressures)
    for joint in measured()["normal"]:
        middle = compare.mean_measured_stiffness(joint, cases.MEASURED_PRESSURES)
        for text, law in {**others, "hu2023": hu, "yu2022": yu}.items():
            k = stiffness_curve(law, cases.MEASURED_PRESSURES)[0]
            print_table_row(joint["id"], text, *(f"{one:.2g}" for one in k / middle))


def print_loading_stiffness(pressures):
    """Print K_loading over K_N for assumed hardnesses and slopes, and the dimensionless pressure of the
    joints."""
    print_table_head("K_loading over K_N for hardness and slope, least to largest", "joint", *pressures)
    for joint in cases.joints_with_roughness():
        p = cases.MEASURED_PRESSURES
        ratios = [
            level(joint_law(joint, H=H, slope=slope), p, "K_loading") / level(joint_law(joint), p)
            for H in HARDNESSES
            for slope in SLOPES
        ]
        ends = zip(np.min(ratios, axis=0), np.max(ratios, axis=0), strict=True)
        print_table_row(joint["id"], *(f"{low:.2f} to {high:.2f}" for low, high in ends))
    print_table_head("y = p longest_wave/(E* h)", "joint", *pressures)
    for joint in cases.joints_with_roughness():
        y = cases.normalised_pressure(joint_law(joint), cases.MEASURED_PRESSURES)
        print_table_row(joint["id"], *(f"{one:.2g}" for one in y))


def print_second_scale():
    """Print the law with longer waves, and with a second scale in series, over measured joints."""
    pressures = [f"{p / 1e6:g} MPa" for p in cases.MEASURED_PRESSURES]
    print_table_head(
        "law over measured stiffness, longer waves and a second scale", "joint", "law", *pressures
    )
    for joint in cases.joints_with_roughness():
        law = joint_law(joint)
        middle = compare.mean_measured_stiffness(joint, cases.MEASURED_PRESSURES)
        for wave in WAVES:
            k = level(replace(law, longest_wave=wave), cases.MEASURED_PRESSURES)
            print_table_row(joint["id"], f"longest wave {wave * 1e3:g} mm", *two_digits(k / middle))
        print_table_row(
            joint["id"],
            "with the tail of the heights",
            *two_digits(cases.stiffness_with_tail(law, cases.MEASURED_PRESSURES) / middle),
        )
        for h in HEIGHTS:
            k = cases.two_scale_stiffness(law, cases.MEASURED_PRESSURES, h, WAVES[-1])
            print_table_row(joint["id"], f"in series {h * 1e6:g} µm over 40 mm", *two_digits(k / middle))
    print_table_head(
        "best two scales in series, 0.1 to 2 MPa", "joint", "h [µm]", "h_w [µm]", *pressures, "exponent"
    )
    for joint in cases.joints_with_roughness():
        middle = compare.mean_measured_stiffness(joint, cases.MEASURED_PRESSURES)
        h, k = fit_second_scale(joint, middle)
        power = compare.exponent(cases.MEASURED_PRESSURES[FITTED_PRESSURES], k[FITTED_PRESSURES])
        print_table_row(
            joint["id"], *(f"{one * 1e6:.3g}" for one in h), *two_digits(k / middle), f"{power:.2f}"
        )


def fit_second_scale(joint, middle):
    """Fit the rms heights (2) [m] of two scales to a measured joint; also returns the stiffness [N/m3]."""

    def stiffness(logs):
        h, second = np.exp(logs)
        return cases.two_scale_stiffness(joint_law(joint, h=h), cases.MEASURED_PRESSURES, second, WAVES[-1])

    def miss(logs):
        return np.log(stiffness(logs) / middle)[FITTED_PRESSURES]

    fit = least_squares(miss, np.log([1e-6, 1e-6]), bounds=np.log([1e-9, 1e-4]))
    return np.exp(fit.x), stiffness(fit.x)


def print_brake_reuss():
    """Print the law over the published contact law of the Brake-Reuss beam, for two longest waves."""
    published = measured("brake_reuss")
    print_table_head("law over published, Brake-Reuss beam", "longest wave [mm]", *cases.brake_reuss())
    for wave in (LONGEST, cases.filtered_wave(published["filter_sigma"])):
        print_table_row(f"{wave * 1e3:.3g}", *two_digits(cases.brake_reuss(longest_wave=wave).values()))
