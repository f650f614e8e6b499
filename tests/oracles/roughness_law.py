"""Reference cases for the law `roughness`: boundary elements on generated surfaces, measured joints.

y = p longest_wave/(E* h), x = p A_0/(E* h longest_wave): pressure and load without units. The range where the
law is meant to hold was set with the seeds of development: x >= 0.3 (below, one hill carries, and surfaces
differ by half and more), 0.01 <= y <= 1.5 (below, many hills are stiffer than the law; above, the longest
wave itself is pressed flat), a real area of at most 15 %.
"""

from dataclasses import replace

import numpy as np

from jointfmu.contact.interface import evaluate_at_pressure
from jointfmu.contact.laws.roughness import RoughnessLaw
from jointfmu.contact.surface import ElasticConstants, contact_modulus

from . import interface_laws as compare
from .boundary_element import press, slope
from .measured_joints import FRICTION, GAMMA, joint_law, level, measured

DEVELOPMENT = (*range(8), *range(100, 106), *range(200, 212))
"""Seeds used to choose the constants of the law; the comparison uses none of them."""
SEEDS = {1: range(300, 316), 4: range(300, 306), 16: range(300, 302)}
"""{roll-off: seeds} of surfaces with waves up to side/1, side/4 and side/16."""
POINTS = {1: 256, 4: 256, 16: 512}
"""{roll-off: grid points along a side}."""
HURST = (0.3, 0.55, 0.8)
LOADS = {1: (0.1, 0.3, 0.5, 0.9, 1.5), 4: (0.02, 0.06, 0.18, 0.5, 1.5), 16: (0.001, 0.003, 0.01, 0.03, 0.1)}
"""{roll-off: loads y [1]}."""
MIN_LOAD, MIN_PRESSURE, MAX_PRESSURE, MAX_AREA = 0.3, 0.01, 1.5, 0.15
"""Range of validity of the law [1]: smallest x, smallest and largest y, largest real area share."""
NO_HARDNESS = 1e30
"""Hardness [Pa] of an elastic contact."""
MEASURED_PRESSURES = np.array([0.1e6, 0.5e6, 1e6, 2e6, 8e6])


def dimensionless_law(H, roll_off, h, gradient, hardness=NO_HARDNESS):
    """Law `roughness` on the unit square of boundary_element.py, with contact modulus 1."""
    body = ElasticConstants(E=2.0, nu=0.0)
    return RoughnessLaw(
        h=h,
        gamma=GAMMA,
        longest_wave=1.0 / roll_off,
        hurst=H,
        slope=gradient,
        side1=body,
        side2=body,
        H=hardness,
        mu=FRICTION,
        traction_ratio=0.1,
        A_0=1.0,
    )


def elastic_contacts(H, roll_off, seeds=None, points=None):
    """Elastic results of boundary elements and of the law: {quantity: (seeds, loads)}; k, law, tail [E* over
    side]."""
    found = {name: [] for name in ("p", "k", "law", "tail", "area")}
    y = np.array(LOADS[roll_off])
    for seed in seeds or SEEDS[roll_off]:
        z = compare.heights(
            3.0 - H, 1e-6, 1.0, seed, points=points or POINTS[roll_off], finest=4, roll_off=roll_off
        )
        p = y * z.std() * roll_off
        contacts = press(z, p)
        found["p"].append(p)
        found["k"].append([c.stiffness for c in contacts])
        found["area"].append([c.area for c in contacts])
        law = dimensionless_law(H, roll_off, z.std(), slope(z))
        found["law"].append(level(law, p))
        found["tail"].append(stiffness_with_tail(law, p))
    return {name: np.array(rows) for name, rows in found.items()}


def in_valid_range(roll_off, area):
    """Mask of the range of validity, for real areas (..., loads)."""
    y = np.array(LOADS[roll_off])
    return (y * roll_off**2 >= MIN_LOAD) & (y >= MIN_PRESSURE) & (y <= MAX_PRESSURE) & (area <= MAX_AREA)


def exponents(one, roll_off):
    """Exponents of k over p in the range of validity, (seeds) by boundary elements and by the law."""
    use = in_valid_range(roll_off, one["area"].max(axis=0))
    return tuple(
        np.array([compare.exponent(p[use], k[use]) for p, k in zip(one["p"], one[name], strict=True)])
        for name in ("k", "law")
    )


def plastic(H, roll_off, hardness, load, seeds, points=64):
    """Law over boundary elements for a hardness over E* h'_rms, at a load over the hardness [1].

    Rows of K_loading, K_N and A_r, (seeds,) each.
    """
    rows = []
    for seed in seeds:
        z = compare.heights(3.0 - H, 1e-6, 1.0, seed, points=points, finest=4, roll_off=roll_off)
        gradient = slope(z)
        p = load * hardness * gradient * np.array([0.9, 1.0, 1.1])
        low, one, high = press(z, p, hardness * gradient, iterations=100)
        law = dimensionless_law(H, roll_off, z.std(), gradient, hardness * gradient)
        state = evaluate_at_pressure(law, p[1])
        loading = (p[2] - p[0]) / (low.separation - high.separation)
        rows.append((state["K_loading"] / loading, state["K_N"] / one.stiffness, state["A_r"] / one.area))
    return np.array(rows).T


def joints_with_roughness():
    """Measured joints with a stated roughness."""
    return [joint for joint in measured()["normal"] if "Rq" in joint]


def filtered_wave(sigma):
    """Wavelength [m] whose amplitude a Gaussian filter with standard deviation sigma [m] halves."""
    return float(np.pi * np.sqrt(2.0 / np.log(2.0)) * sigma)


def brake_reuss(**changes):
    """Ratios {name: law over published value} for the contact law of the Brake-Reuss beam, with changes of
    the law."""
    data = measured("brake_reuss")
    law = joint_law(data | {"Rq": data["h"] / np.sqrt(2.0)}, H=data["H"], **changes)
    state = evaluate_at_pressure(law, data["pressure"])
    names = {"normal": "K_N", "loading": "K_loading", "tangential": "K_T"}
    return {name: float(state[q] / law.A_0 / data[name]) for name, q in names.items()}


def two_scale_stiffness(law, p, h, wave):
    """Stiffness per area [N/m3] of the law in series with a second scale: rms height and longest wave [m]."""
    return 1.0 / (1.0 / level(law, p) + 1.0 / level(replace(law, h=h, longest_wave=wave), p))


def normalised_pressure(law, p):
    """Dimensionless pressure y [1] of the law at pressures p [Pa]."""
    return p * law.longest_wave / (contact_modulus(law.side1, law.side2) * law.h)


def stiffness_with_tail(law, p):
    """Stiffness per area [N/m3] of the law with the tail of the height distribution that many hills have.

    1/gamma is replaced by 1/gamma (y/0.2)^-0.08, as in boundary elements of up to 1024 hills, y = 0.001 to 1.
    """
    y = normalised_pressure(law, p)
    return level(law, p) + p / (law.gamma * law.h) * ((y / 0.2) ** -0.08 - 1.0)
