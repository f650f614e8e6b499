"""Stiffness and real area: interface laws, boundary elements on the same surfaces, measured joints."""

from dataclasses import dataclass, replace

import numpy as np
from jointfmu_tools.inputs.fractal import areal_fractal_roughness

from jointfmu.contact.interface import evaluate_at_pressure, solve_largest_spot, stiffness_curve
from jointfmu.contact.laws import yu2022
from jointfmu.contact.surface import contact_modulus
from jointfmu.parameters import load_default

from .boundary_element import bonded, press, refined, slope
from .rough_surfaces import periodic

SEEDS = range(4)
POINTS, FINEST = 256, 8
"""Number of grid points along a side; number of spacings in the shortest wave."""


@dataclass(frozen=True)
class Case:
    """Interface law and the surface on which boundary elements check it.

    modulus   : contact modulus E* [Pa]
    D, G      : fractal dimension [1] and roughness [m] of the isotropic surface
    sides     : [m] side lengths of the computed squares
    pressures : [Pa] nominal
    """

    law: object
    modulus: float
    D: float
    G: float
    sides: tuple[float, ...]
    pressures: np.ndarray

    def with_side(self, side):
        """Law with the nominal area of one square."""
        return replace(self.law, A_0=side**2)


def cases():
    """Cases of the three default parameter sets; the longer side is the side of the joint's nominal area."""
    zhao, hu, yu = (load_default(j).values for j in ("bolted_joint", "harmonic_drive", "gear_contact"))
    hu = hu.law
    profile, flank = zhao.surface, yu.surface1
    return {
        "zhao2018": Case(
            zhao,
            contact_modulus(zhao.side1, zhao.side2),
            profile.D + 1.0,
            areal_fractal_roughness(profile.G, 2.0 - profile.D),
            (8e-3, float(np.sqrt(zhao.A_0))),
            np.geomspace(0.5e6, 16e6, 6),
        ),
        "hu2023": Case(
            hu,
            contact_modulus(hu.side1, hu.side2),
            hu.surface.D,
            hu.surface.G,
            (0.5e-3, float(np.sqrt(hu.A_0))),
            np.geomspace(3.125e6, 100e6, 6),
        ),
        "yu2022": Case(
            yu,
            yu2022.effective_modulus(yu),
            flank.D + 1.0,
            areal_fractal_roughness(flank.G, 2.0 - flank.D),
            (1e-3, float(np.sqrt(yu.A_0))),
            np.geomspace(0.3125e6, 10e6, 6),
        ),
    }


def law_of_surface(case, D, G):
    """Law of the case with another isotropic surface, D and G [1, m]."""
    law = case.law
    if hasattr(law.surface, "s_min"):
        return replace(law, surface=replace(law.surface, D=D, G=G))
    profile = {"D": D - 1.0, "G": G / areal_fractal_roughness(1.0, 3.0 - D)}
    if hasattr(law, "surface1"):
        return replace(
            law, surface1=replace(law.surface1, **profile), surface2=replace(law.surface2, **profile)
        )
    return replace(law, surface=replace(law.surface, **profile))


def heights(D, G, side, seed, points=POINTS, finest=FINEST, roll_off=1):
    """Heights over the side of a square with waves from side/roll_off to `finest` spacings."""
    return periodic(side, points, D, G, (side / roll_off, finest * side / points), seed).z / side


def exponent(x, y):
    """Exponent of a power law: slope of ln y over ln x, by least squares."""
    return float(np.polyfit(np.log(x), np.log(y), 1)[0])


def boundary_element_results(case, side, seeds=SEEDS, **grid):
    """Results of boundary elements, elastic up to the hardness: {quantity: (seeds, pressures)}.

    Stiffness of small motions "k" [N/m3], dp/d(approach) "loading" [N/m3], real over nominal area "area" [1],
    plastic share of the real area "plastic" [1], rms height "rms" [m].
    """
    found = {name: [] for name in ("k", "loading", "area", "plastic", "rms")}
    for seed in seeds:
        z = heights(case.D, case.G, side, seed, **grid)
        contacts = press(z, case.pressures / case.modulus, case.law.hardness / case.modulus)
        scale = case.modulus / side
        approach = -np.array([c.separation for c in contacts]) * side
        found["k"].append([c.stiffness * scale for c in contacts])
        found["loading"].append(np.gradient(case.pressures, approach))
        found["area"].append([c.area for c in contacts])
        found["plastic"].append([c.plastic for c in contacts])
        found["rms"].append(np.full(len(contacts), z.std() * side))
    return {name: np.array(rows) for name, rows in found.items()}


def law_state(case, side):
    """Law on the nominal area of one square: k [N/m3], area and plastic share of the real area [1]."""
    law = case.with_side(side)
    u = solve_largest_spot(law, case.pressures)
    s, state = law.spot_distribution(), evaluate_at_pressure(law, case.pressures)
    if "elastic_fraction" in state:
        elastic = state["elastic_fraction"]
    elif "elastic_area" in s.regime_terms:
        elastic = s.sum_over_spots("elastic_area", u) / s.sum_over_spots("area", u)
    else:  # Zhao: the second term of the area is that of the elastic spots
        elastic = replace(s, regime_terms={"area": s.regime_terms["area"][1:]}).sum_over_spots(
            "area", u
        ) / s.sum_over_spots("area", u)
    return {
        "k": stiffness_curve(law, case.pressures)[0],
        "area": state["A_r"] / law.A_0,
        "plastic": 1.0 - elastic,
    }


def elastic(H, roll_off, loads, seeds=SEEDS, **grid):
    """Dimensionless results of elastic contact: {quantity: (seeds, loads)}; loads over E* h'_rms.

    "alpha" is k h_rms/p, "kappa" (A_r/A_0) E* h'_rms/p, "isolated" the stiffness of all spots without their
    interaction over k.
    """
    found = {"alpha": [], "kappa": [], "isolated": []}
    for seed in seeds:
        z = heights(3.0 - H, 1e-6, 1.0, seed, roll_off=roll_off, **grid)
        gradient, rms = slope(z), z.std()
        contacts = press(z, np.array(loads) * gradient)
        found["alpha"].append([c.stiffness * rms / c.p for c in contacts])
        found["kappa"].append([c.area * gradient / c.p for c in contacts])
        found["isolated"].append([c.isolated / c.stiffness for c in contacts])
    return {name: np.array(rows) for name, rows in found.items()}


def tangential_ratio(nu, load=0.02, seeds=SEEDS, points=128):
    """Ratio K_T/K_N of elastic contacts without slip, both directions of every seed (2 seeds,) [1]."""
    ratios = []
    for seed in seeds:
        z = heights(2.5, 1e-6, 1.0, seed, points=points)
        touching = press(z, [load * slope(z)])[0].pressure > 0.0
        normal = bonded(touching, nu)
        ratios += [bonded(touching, nu, axis) / normal for axis in (0, 1)]
    return np.array(ratios)


def resolution(factors=(1, 2, 4), loads=(0.01, 0.03, 0.1)):
    """Results for one elastic surface (64 points, shortest wave two spacings) on refined grids: alpha, kappa
    (factors, loads)."""
    coarse = heights(2.42, 1e-6, 1.0, 3, points=64, finest=2)
    rows = []
    for factor in factors:
        z = refined(coarse, factor)
        contacts = press(z, np.array(loads) * slope(z))
        rows.append([(c.stiffness * z.std() / c.p, c.area * slope(z) / c.p) for c in contacts])
    return np.moveaxis(np.array(rows), 2, 0)


def measured_stiffness(joint, pressure):
    """Smallest and largest stiffness [N/m3] of a measured joint at pressures [Pa], by the printed ranges."""
    p = pressure / joint["pressure_unit"]
    if "C" in joint:
        values = [p ** (1.0 - m) / (C * m) for C in joint["C"] for m in joint["m"]]
    else:
        values = [p**S / R for R in joint["R"] for S in joint["S"]]
    scale = joint["pressure_unit"] / 1e-6
    return np.min(values, axis=0) * scale, np.max(values, axis=0) * scale


def mean_measured_stiffness(joint, pressure):
    """Stiffness [N/m3] of a measured joint at the middle of the printed ranges."""
    middle = {name: [float(np.mean(joint[name]))] for name in ("C", "m")}
    return measured_stiffness(joint | middle, pressure)[0]
