"""Tables of docs/validity_stiffness.md that need no boundary elements: laws and measured joints."""

from dataclasses import replace

import interface_laws as compare
import numpy as np
from band_of_waves import rms_height
from measured_joints import measured
from validity_pictures import GAMMA
from validity_tables import heading, row

from jointfmu.contact.interface import evaluate_at_pressure, solve_largest_spot, stiffness_curve
from jointfmu.contact.roughness import combined_height, predicted_stiffness
from jointfmu.parameters import load_default

CHOICES = [(area, spot) for area in ("continuity", "printed", "yield") for spot in ("family", "hertz")]
JUDGED = np.array([0.5e6, 1e6, 2e6, 8e6])
MEASURED = np.array([0.1e6, 1e6, 2.45e6, 9.8e6])


def sizes():
    """What the laws say of the nominal area, of roughness, and of small spots."""
    heading("k ~ A_0^x at a given pressure", "law", "x at the joint's A_0", "x of waves up to the side, -H/2")
    for name, case in compare.cases().items():
        areas = case.law.A_0 * np.array([0.5, 1.0, 2.0])
        p = case.pressures[3:4]
        k = [stiffness_curve(replace(case.law, A_0=a), p)[0][0] for a in areas]
        row(name, f"{compare.exponent(areas, k):.2f}", f"{-0.5 * (3.0 - case.D):.2f}")
    names = ("law", "p [MPa]", "p/(0.48 k) [um]", "h_rms, waves up to 1 mm", "up to the side")
    heading("roughness height that the law's stiffness stands for", *names)
    for name, case in compare.cases().items():
        H, shortest = 3.0 - case.D, 1e-6
        heights = [rms_height(H, case.G, longest, shortest) * 1e6 for longest in (1e-3, case.sides[-1])]
        for p in case.pressures[[0, 3, 5]]:
            level = p / (GAMMA * stiffness_curve(case.law, np.array([p]))[0][0]) * 1e6
            row(name, f"{p / 1e6:.3g}", f"{level:.2g}", *(f"{h:.2g}" for h in heights))
    zhao = compare.cases()["zhao2018"].law
    s, u = zhao.spots(), solve_largest_spot(zhao, 1e6)
    term = replace(s.regime_terms["normal"][0], upper=np.log(10.0))
    share = float(replace(s, regime_terms={"normal": (term,)}).total("normal", u) / s.total("normal", u))
    print(f"\nzhao2018 at 1 MPa: {share:.0%} of k in spots of one to ten critical areas")


def parameters():
    """K over G, and over D at a given height of the waves up to 1 mm, at each law's fourth pressure."""
    names = ("law", "y of K ~ G^y", "of 1/h_rms, 2 - D", "K at D + 0.1 over K at D - 0.1, same h_rms")
    heading("K over the surface's parameters", *names)
    for name, case in compare.cases().items():
        p = case.pressures[3:4]
        band = (1e-3, 1e-6)
        rms = rms_height(3.0 - case.D, case.G, *band)

        def stiffness(D, G, case=case, p=p):
            return stiffness_curve(compare.rougher(case, D, G), p)[0][0]

        over_g = [stiffness(case.D, factor * case.G) for factor in (0.9, 1.1)]
        over_d = []
        for D in (case.D - 0.1, case.D + 0.1):
            G = (rms / rms_height(3.0 - D, 1.0, *band)) ** (1.0 / (D - 2.0))
            over_d.append(stiffness(D, G))
        y = compare.exponent((0.9, 1.1), over_g)
        row(name, f"{y:.2f}", f"{2.0 - case.D:.2f}", f"{over_d[1] / over_d[0]:.2g}")


def levels():
    """The choices of `zhao2018`, and the law `roughness`, beside the published R_a, boundary elements of the
    ratio K_T/K_N, and measured cast iron."""
    file = load_default("bolted_joint")
    h = combined_height(file.roughness)
    names = [f"{p / 1e6:g} MPa" for p in JUDGED]
    heading(f"K over p/(0.45 h), h = {1e6 * h:.3g} um", "law", *names, "K_T/K_N", "measured rows within 2")
    laws = {f"{a} {s}": replace(file.values, critical_area=a, spot_stiffness=s) for a, s in CHOICES}
    for name, law in {**laws, "roughness": load_default("bolted_joint", "roughness").values}.items():
        state = evaluate_at_pressure(law, JUDGED)
        k = state["K_N"] / law.A_0
        row(
            name,
            *(f"{ratio:.2g}" for ratio in k / predicted_stiffness(JUDGED, h)),
            f"{state['K_T'][-1] / state['K_N'][-1]:.3f}",
            _near(k),
        )
    nu = file.values.side1.nu
    print(f"\nMindlin: K_T/K_N = {2.0 * (1.0 - nu) / (2.0 - nu):.3f} without slip")


def _near(k):
    """At how many of the measured rows k is within a factor of 2 of the middle of the printed range."""
    ends = [compare.measured_stiffness(one, JUDGED) for one in measured()["normal"]]
    middle = [np.sqrt(low * high) for low, high in ends]
    off = [(k >= 0.5 * one) & (k <= 2.0 * one) for one in middle]
    return "/".join(str(count) for count in np.sum(off, axis=0)) + f" of {len(off)}"


def joints():
    """Measured joints beside the laws."""
    pressures = [f"{p / 1e6:g} MPa" for p in MEASURED]
    data = measured()
    for kind in ("normal", "tangential"):
        heading(f"measured {kind} stiffness [N/m3]", "joint", *pressures, "exponent")
        for joint in data[kind]:
            low, high = compare.measured_stiffness(joint, MEASURED)
            powers = sorted(1.0 - m for m in joint["m"]) if "m" in joint else joint["S"]
            cells = [f"{a:.2g} to {b:.2g}" for a, b in zip(low, high, strict=True)]
            row(joint["id"], *cells, f"{powers[0]:.2f} to {powers[-1]:.2f}")
    heading("tangential over normal", "joint", *pressures)
    normal = {joint["id"]: joint for joint in data["normal"]}
    for joint in data["tangential"]:
        low, high = compare.measured_stiffness(joint, MEASURED)
        least, most = compare.measured_stiffness(normal[joint["id"]], MEASURED)
        row(joint["id"], *(f"{a:.2f} to {b:.2f}" for a, b in zip(low / most, high / least, strict=True)))
    names = ("exponent", "K_T/K_N", "eta_n at 1 MPa", "eta_t", "k at 1 MPa on (8 mm)2")
    heading("laws: k [N/m3]", "law", *pressures, *names)
    zhao, hu, yu = (case.law for case in compare.cases().values())
    choices = {f"zhao2018 {a} {s}": replace(zhao, critical_area=a, spot_stiffness=s) for a, s in CHOICES}
    for name, law in {**choices, "hu2023": hu, "yu2022": yu}.items():
        state = evaluate_at_pressure(law, MEASURED)
        ratio = f"{state['K_T'][-1] / state['K_N'][-1]:.3f}" if "K_T" in state else "-"
        eta = [f"{state[q][1]:.2g}" if q in state else "-" for q in ("eta_n", "eta_t")]
        k = state["K_N"] / law.A_0
        power = f"{compare.exponent(MEASURED, k):.2f}" if np.all(k > 0.0) else "-"
        small = stiffness_curve(replace(law, A_0=64e-6), MEASURED[1:2])[0][0]
        row(name, *(f"{one:.2g}" for one in k), power, ratio, *eta, f"{small:.2g}")
    losses = [d / np.pi for one in data["statement"] for d in one.get("decrement", [])]
    print(f"\nloss factor of whole bolted structures: {min(losses):.3f} to {max(losses):.3f}")
    heading("k = p/(0.48 h_rms) at 1 MPa", "h_rms [µm]", "k [N/m3]")
    for rms in (0.3, 1.0, 3.0, 10.0):
        row(rms, f"{1e12 / (GAMMA * rms):.2g}")
