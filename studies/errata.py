"""Figures of docs/errata.md: base radius, pressure and torsional stiffness of Hu 2023 as printed.

    python studies/errata.py [SECTION ...]

printed  : Eq. 28 as printed, P = F_r/S_r
nominal  : the reading P = F_r/A_0
growth   : growth of K_TS with the torque, and the width of the contact zones
scales   : K_WTS for some scales of K_TS
roughness: K_TS from the normal load of the ring model and a roughness

Written from the equations of the paper. The package gives the published numbers, the corrected law for the
reading P = F_r/A_0, and the drives in the last section.
"""

from dataclasses import replace

import numpy as np
from common import run_study
from jointfmu_tools.studies.published.reference import read_points
from scipy.optimize import brentq

from jointfmu.contact.interface import evaluate_at_pressure
from jointfmu.joints.harmonic_drive.law import contact_pair_stiffness, drive_stiffness
from jointfmu.parameters import load_default

HU = {point.id: float(point.value) for point in read_points("hu2023")}
D, G, GAMMA, NU, E_BODY = 2.5304, 2.4248e-7, 1.5, (0.295, 0.3), (2.09e11, 2.19e11)
E = 1.0 / sum((1.0 - nu**2) / e for nu, e in zip(NU, E_BODY, strict=True))
SHEAR = 1.0 / sum(2.0 * (2.0 - nu) * (1.0 + nu) / e for nu, e in zip(NU, E_BODY, strict=True))
SIGMA, HARDNESS_COEFFICIENT = 835e6, 0.454 + 0.41 * NU[0]
PSI = 5.454 * np.exp((1.0 - D) / 0.628) + 1.499
SCAN, NODES, RADIUS, MEAN_OVER_PEAK = 0.5e-3, 1290, 0.017, 0.163
"""Scan length [m] and number of mesh nodes (published); radius [m] and mean over peak pressure (estimated).
"""
STICK = 0.5 ** (1.0 / 3.0)
"""Traction ratio: half of the friction limit, an estimate."""
PEAK, NOMINAL = HU["p_max.5"], HU["K_TS.nominal.5"]


def spot_curvature_radius(r_m):
    """Radius of curvature R [m], Eq. 5."""
    return r_m ** (D - 1) / (2.0 ** (3 - D) * np.pi**2 * G ** (D - 2) * np.sqrt(np.log(GAMMA)))


def critical_spot_area(r_m):
    """Critical spot area s_ec [m2], Eqs. 7 and 10."""
    return (
        np.pi
        * (np.pi * HARDNESS_COEFFICIENT * 2.8 * SIGMA / (2.0 * E)) ** 2
        * spot_curvature_radius(r_m) ** 2
    )


def mean_elastic_pressure(r_m, s_l):
    """Mean pressure F_r/S_r [Pa] of elastic spots up to the area s_l [m2]: Eqs. 18, 23 with upper limit s_l,
    Eq. 28."""
    spot = 2.0 ** (5 - D) * E * np.sqrt(np.pi) * G ** (D - 2) * np.sqrt(np.log(GAMMA)) / (3 * r_m ** (D - 1))
    return spot * (3 - D) / (4 - D) * np.sqrt(s_l)


def island_stiffness(s_l):
    """Normal stiffness K_re [N/m]: magnitude of Eq. 30 with s_l as upper limit."""
    return (D - 1) / (0.5 * D - 1) * E / np.sqrt(np.pi) * PSI ** (1.5 - 0.5 * D) * np.sqrt(s_l)


def stiffness_over_pressure(r_m):
    """Ratio K_re/P [m] of stiffness to pressure: constant, because both are proportional to E."""
    s_l = 1e-12
    return island_stiffness(s_l) / mean_elastic_pressure(r_m, s_l)


def tangential_over_normal_stiffness():
    """Stiffness ratio K_T/K_N [1] of a spot under half of the friction limit, Eqs. 29 and 39."""
    return 4.0 * SHEAR / E * STICK


def torsional_stiffness_as_printed(r_m, peak=PEAK, mean=MEAN_OVER_PEAK):
    """K_TS by Eq. 45 as printed, in N although a torsional stiffness.

    The tangential stiffness of a set of spots at each node, times the diameter. `peak` [Pa], `mean` [1]:
    largest pressure, and mean over largest pressure.
    """
    return (
        NODES * tangential_over_normal_stiffness() * stiffness_over_pressure(r_m) * mean * peak * 2.0 * RADIUS
    )


def torsional_stiffness_from_energy(r_m):
    """K_TS [N.m/rad] from the energy of a unit twist, with the sets of spots of Eq. 45."""
    return torsional_stiffness_as_printed(r_m) * RADIUS / 2.0


def print_printed_equation():
    """Print K_TS for some base radii by Eq. 28 as printed: all spots elastic, K proportional to P."""
    print(
        f"K_T/K_N = {tangential_over_normal_stiffness():.3f}, psi = {PSI:.3f}, least F_r/S_r above s_ec ",
        end="",
    )
    print(f"{mean_elastic_pressure(1e-6, critical_spot_area(1e-6)) / 1e6:.0f} MPa")
    part = (PEAK / mean_elastic_pressure(1e-6, critical_spot_area(1e-6))) ** 2
    print(f"{PEAK / 1e6:.2f} MPa: s_l/s_ec = {part:.3f}, whatever r_m and (at fixed s_l) sigma_s")
    exponent = np.log(critical_spot_area(2e-6) / critical_spot_area(1e-6)) / np.log(2.0)
    print(
        f"s_ec ~ r_m^{exponent:.2f}: "
        f"{np.log10(critical_spot_area(2.5e-4) / critical_spot_area(0.25e-6)):.1f}",
        end="",
    )
    print(" decades from 250 um to 0.25 um")
    print("r_m [um]   s_ec [m2]    K/P [um]   K_TS(5) [N], nothing fitted")
    for count in (512, 768, 1024):
        for name, r_m in (("half a step", SCAN / count / 2), ("a step", SCAN / count)):
            print(
                f"{r_m * 1e6:8.3f} {critical_spot_area(r_m):11.3g} "
                f"{stiffness_over_pressure(r_m) * 1e6:10.3f}",
                end="",
            )
            print(f" {torsional_stiffness_as_printed(r_m):10.0f}   {name} of {count} points on 0.5 mm")
    for name, law, target in (
        ("printed", torsional_stiffness_as_printed, NOMINAL),
        ("energy", torsional_stiffness_from_energy, NOMINAL),
        ("energy, drive's scale", torsional_stiffness_from_energy, 4.0 * NOMINAL),
    ):
        r_m = brentq(lambda r, law=law, target=target: law(r) - target, 1e-9, 1e-2, rtol=1e-12)
        print(f"{name}: {target:.0f} at r_m = {r_m * 1e6:.3f} um")


def print_nominal_pressure_reading():
    """Print exponents and stiffness for the reading P = F_r/A_0."""
    powers = f"s_l^{0.5 * (D - 1):.3f} s_min^{1 - 0.5 * D:.3f}"
    print(f"P = F_r/A_0, all elastic: F ~ s_l^1.5, K ~ {powers}, so K ~ P^{(D - 1) / 3:.3f}")
    drive = load_default("harmonic_drive").values
    print("r_m [um]   K_N [N/m] of the pair at the mean pressure of 5 N.m")
    for r_m in (250e-6, 10e-6, 2e-6, 1e-6, 0.95e-6, 0.9e-6):
        law = replace(drive.law, surface=replace(drive.surface, r_m=r_m))
        print(f"{r_m * 1e6:8.2f} {evaluate_at_pressure(law, MEAN_OVER_PEAK * PEAK)['K_N']:11.3g}")


def stiffness_growth_error(exponent):
    """Ratio of K_TS at 3 N.m to the published value, less 1, if K^(2/exponent) is linear in the torque."""
    ends = np.array([HU["K_TS.max.1"], HU["K_TS.max.5"]]) ** (2.0 / exponent)
    return float(np.mean(ends) ** (0.5 * exponent) / HU["K_TS.max.3"] - 1.0)


def print_stiffness_growth():
    """Print the growth of K_TS with the torque, for contact zones of constant and of growing width."""
    print("K_TS ~ peak^q, peak^2 linear in the torque: K_TS(3 N.m) over the published one - 1")
    for name, q in (("fixed lobes", 1.0), ("lobes that widen", 1.5), ("Hertz", 2.0)):
        print(f"  q = {q:g} ({name}): {100 * stiffness_growth_error(q):+.2f} %")


def print_scale_factors():
    """Print K_WTS at 0.5 N.m by Eq. 46 for scale factors of K_TS, with K_FTS from 5294 N.m/rad at 5 N.m."""
    top, drop = HU["K_TS.max.5"], HU["K_TS.max.5"] - NOMINAL
    rise = (top**2 - HU["K_TS.max.1"] ** 2) / 4.0
    low = np.sqrt(top**2 - 4.5 * rise) - drop
    print(f"K_TS at 0.5 N.m by the fixed lobes {low:.1f}, through the maxima at 1 and 5 N.m")
    print("scale   K_FTS   K_WTS(0.5)   of theory   of measured")
    for scale in (3.71, 4.0, 4.23, 5.0):
        series = 1.0 / HU["K_WTS.measured.5"] - 1.0 / (scale * NOMINAL)
        at_low = 1.0 / (series + 1.0 / (scale * low))
        print(f"{scale:5.2f} {1 / series:8.0f} {at_low:10.0f}", end="")
        print(f" {100 * (at_low / HU['K_WTS.theory.0.5'] - 1):+10.1f} %", end="")
        print(f" {100 * (at_low / HU['K_WTS.measured.0.5'] - 1):+10.1f} %")


def print_roughness_law():
    """Print K_TS from the energy of a twist, with K_N = N/(0.48 h): load N of the ring model, roughness h."""
    print("ring model's normal load 268 N at 5 N.m, K_N = N/(0.48 h), K_T/K_N = 4 G'/E without slip")
    for h in (6.4e-6, 8.8e-6):
        K = 268.0 / (0.48 * h)
        twist = K * 4 * SHEAR / E * RADIUS**2
        print(f"  h = {h * 1e6:.1f} um: K_N = {K:.3g} N/m, K_TS = {twist:.3g} N.m/rad")
    rough, torque = load_default("harmonic_drive", "roughness").values, np.array([0.5, 5.0])
    pair, whole = contact_pair_stiffness(rough, torque)[0], drive_stiffness(rough, torque)[0]
    print("law roughness at 0.5 and 5 N.m: K_TS {:.0f}, {:.0f}; K_WTS {:.0f}, {:.0f}".format(*pair, *whole))
    drive, torque = load_default("harmonic_drive").values, np.array([0.5, 5.0, 6.9, 10.0, 15.0, 30.0])
    print("default at 0.5, 5, 6.9, 10, 15, 30 N.m: K_WTS", np.round(drive_stiffness(drive, torque)[0]))


if __name__ == "__main__":
    run_study(
        __doc__,
        {
            "printed": print_printed_equation,
            "nominal": print_nominal_pressure_reading,
            "growth": print_stiffness_growth,
            "scales": print_scale_factors,
            "roughness": print_roughness_law,
        },
    )
