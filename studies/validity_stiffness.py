"""Figures of docs/validity_stiffness.md: interface laws against boundary elements and measured joints.

    python studies/validity_stiffness.py [SECTION ...] [--images]

measured-joints : measured stiffness, and the laws at the same pressures
levels          : choices of `zhao2018` and the law `roughness`, the published Ra and measured cast iron
sizes           : the laws over the nominal area, their roughness height, spots of one to ten critical areas
parameters      : the laws over D and G
verification    : boundary elements compared with closed forms
elastic         : dimensionless elastic stiffness and real area
own-surfaces    : each law on the surface that it assumes
grids           : influence of band and grid
roughness       : the law `roughness`, see roughness_law.py
heights         : the law of heights that are not Gaussian, see heights_law.py

`--images` draws the pictures of the sections into docs/images.
"""

from dataclasses import replace

import heights_law
import numpy as np
import roughness_law
from common import IMAGES, format_mean_and_deviation, print_table_head, print_table_row, run_study
from jointfmu_tools.common import plots
from oracles import interface_laws as compare
from oracles.boundary_element import hertz, westergaard
from oracles.measured_joints import measured, measured_range
from oracles.rough_surfaces import rms_height
from roughness_law import CHOICES

from jointfmu.contact.interface import evaluate_at_pressure, solve_largest_spot, stiffness_curve
from jointfmu.contact.roughness import combined_height, predicted_stiffness
from jointfmu.parameters import load_default
from jointfmu.progress import track_progress

GAMMA = 0.48
"""Factor gamma of the estimate k = p/(gamma h_rms): Persson 2007, with the value of Akarapu, Sharp and
Robbins 2011."""
HURST = (0.3, 0.58, 0.8)
COLORS = (plots.BLUE, plots.RED, plots.GREEN)
ROLL_OFF = (1, 4)
LOADS = (0.003, 0.006, 0.012, 0.025, 0.05, 0.1)
"""Pressures of the elastic contacts over E* h'_rms [1]."""
COMPARED_PRESSURES = np.array([0.5e6, 1e6, 2e6, 8e6])
MEASURED_PRESSURES = np.array([0.1e6, 1e6, 2.45e6, 9.8e6])


# laws and measured joints, without boundary elements


def print_sizes():
    """Print laws over the nominal area, the rms height that corresponds to their stiffness, and the share of
    small spots."""
    print_table_head(
        "k ~ A_0^x at a given pressure", "law", "x at the joint's A_0", "x of waves up to the side, -H/2"
    )
    for name, case in compare.cases().items():
        areas = case.law.A_0 * np.array([0.5, 1.0, 2.0])
        p = case.pressures[3:4]
        k = [stiffness_curve(replace(case.law, A_0=a), p)[0][0] for a in areas]
        print_table_row(name, f"{compare.exponent(areas, k):.2f}", f"{-0.5 * (3.0 - case.D):.2f}")
    names = ("law", "p [MPa]", "p/(0.48 k) [um]", "h_rms, waves up to 1 mm", "up to the side")
    print_table_head("roughness height that the law's stiffness stands for", *names)
    for name, case in compare.cases().items():
        H, shortest = 3.0 - case.D, 1e-6
        heights = [rms_height(H, case.G, longest, shortest) * 1e6 for longest in (1e-3, case.sides[-1])]
        for p in case.pressures[[0, 3, 5]]:
            level = p / (GAMMA * stiffness_curve(case.law, np.array([p]))[0][0]) * 1e6
            print_table_row(name, f"{p / 1e6:.3g}", f"{level:.2g}", *(f"{h:.2g}" for h in heights))
    zhao = compare.cases()["zhao2018"].law
    s, u = zhao.spot_distribution(), solve_largest_spot(zhao, 1e6)
    term = replace(s.regime_terms["normal"][0], upper_log_area=np.log(10.0))
    share = float(
        replace(s, regime_terms={"normal": (term,)}).total("normal", u) / s.sum_over_spots("normal", u)
    )
    print(f"\nzhao2018 at 1 MPa: {share:.0%} of k in spots of one to ten critical areas")


def print_parameters():
    """Print K for several G, and for several D at a given height of the waves up to 1 mm, at each law's
    fourth pressure."""
    names = ("law", "y of K ~ G^y", "of 1/h_rms, 2 - D", "K at D + 0.1 over K at D - 0.1, same h_rms")
    print_table_head("K over the surface's parameters", *names)
    for name, case in compare.cases().items():
        p = case.pressures[3:4]
        band = (1e-3, 1e-6)
        rms = rms_height(3.0 - case.D, case.G, *band)

        def stiffness(D, G, case=case, p=p):
            return stiffness_curve(compare.law_of_surface(case, D, G), p)[0][0]

        over_g = [stiffness(case.D, factor * case.G) for factor in (0.9, 1.1)]
        over_d = []
        for D in (case.D - 0.1, case.D + 0.1):
            G = (rms / rms_height(3.0 - D, 1.0, *band)) ** (1.0 / (D - 2.0))
            over_d.append(stiffness(D, G))
        y = compare.exponent((0.9, 1.1), over_g)
        print_table_row(name, f"{y:.2f}", f"{2.0 - case.D:.2f}", f"{over_d[1] / over_d[0]:.2g}")


def print_levels():
    """Print choices of `zhao2018` and the law `roughness`, with the published Ra, K_T/K_N, and measured cast
    iron."""
    file = load_default("bolted_joint")
    h = combined_height(file.roughness)
    names = [f"{p / 1e6:g} MPa" for p in COMPARED_PRESSURES]
    print_table_head(
        f"K over p/(0.45 h), h = {1e6 * h:.3g} um",
        "law",
        *names,
        "K_T/K_N",
        "measured joints within 2",
        "by K_loading",
    )
    laws = {f"{a} {s}": replace(file.values, critical_area=a, spot_stiffness=s) for a, s in CHOICES}
    for name, law in {**laws, "roughness": load_default("bolted_joint", "roughness").values}.items():
        state = evaluate_at_pressure(law, COMPARED_PRESSURES)
        k = state["K_N"] / law.A_0
        print_table_row(
            name,
            *(f"{ratio:.2g}" for ratio in k / predicted_stiffness(COMPARED_PRESSURES, h)),
            f"{state['K_T'][-1] / state['K_N'][-1]:.3f}",
            joints_within_factor_2(k),
            joints_within_factor_2(state["K_loading"] / law.A_0) if "K_loading" in state else "-",
        )
    nu = file.values.side1.nu
    print(f"\nMindlin: K_T/K_N = {2.0 * (1.0 - nu) / (2.0 - nu):.3f} without slip")


def joints_within_factor_2(k):
    """Share of the joints measured at each pressure whose stiffness is within a factor of 2 of k: text."""
    joints = measured()["normal"]
    middle = np.array([compare.mean_measured_stiffness(one, COMPARED_PRESSURES) for one in joints])
    within = (k >= 0.5 * middle) & (k <= 2.0 * middle)
    known = np.array([measured_range(one, COMPARED_PRESSURES) for one in joints])
    counts = zip(np.sum(within & known, axis=0), np.sum(known, axis=0), strict=True)
    return ", ".join(f"{count} of {total}" for count, total in counts)


def print_joints():
    """Print the stiffness of measured joints and of the laws."""
    pressures = [f"{p / 1e6:g} MPa" for p in MEASURED_PRESSURES]
    data = measured()
    for kind in ("normal", "tangential"):
        print_table_head(f"measured {kind} stiffness [N/m3]", "joint", *pressures, "exponent")
        for joint in data[kind]:
            low, high = compare.measured_stiffness(joint, MEASURED_PRESSURES)
            powers = sorted(1.0 - m for m in joint["m"]) if "m" in joint else joint["S"]
            cells = [f"{a:.2g} to {b:.2g}" for a, b in zip(low, high, strict=True)]
            print_table_row(joint["id"], *cells, f"{powers[0]:.2f} to {powers[-1]:.2f}")
    print_table_head("tangential over normal", "joint", *pressures)
    normal = {joint["id"]: joint for joint in data["normal"]}
    for joint in data["tangential"]:
        low, high = compare.measured_stiffness(joint, MEASURED_PRESSURES)
        least, most = compare.measured_stiffness(normal[joint["id"]], MEASURED_PRESSURES)
        print_table_row(
            joint["id"], *(f"{a:.2f} to {b:.2f}" for a, b in zip(low / most, high / least, strict=True))
        )
    names = ("exponent", "K_T/K_N", "eta_n at 1 MPa", "eta_t", "k at 1 MPa on (8 mm)2")
    print_table_head("laws: k [N/m3]", "law", *pressures, *names)
    zhao, hu, yu = (case.law for case in compare.cases().values())
    choices = {f"zhao2018 {a} {s}": replace(zhao, critical_area=a, spot_stiffness=s) for a, s in CHOICES}
    for name, law in {**choices, "hu2023": hu, "yu2022": yu}.items():
        state = evaluate_at_pressure(law, MEASURED_PRESSURES)
        ratio = f"{state['K_T'][-1] / state['K_N'][-1]:.3f}" if "K_T" in state else "-"
        eta = [f"{state[q][1]:.2g}" if q in state else "-" for q in ("eta_n", "eta_t")]
        k = state["K_N"] / law.A_0
        power = f"{compare.exponent(MEASURED_PRESSURES, k):.2f}" if np.all(k > 0.0) else "-"
        small = stiffness_curve(replace(law, A_0=64e-6), MEASURED_PRESSURES[1:2])[0][0]
        print_table_row(name, *(f"{one:.2g}" for one in k), power, ratio, *eta, f"{small:.2g}")
    losses = [d / np.pi for one in data["statement"] for d in one.get("decrement", [])]
    print(f"\nloss factor of whole bolted structures: {min(losses):.3f} to {max(losses):.3f}")
    print_table_head("k = p/(0.48 h_rms) at 1 MPa", "h_rms [µm]", "k [N/m3]")
    for rms in (0.3, 1.0, 3.0, 10.0):
        print_table_row(rms, f"{1e12 / (GAMMA * rms):.2g}")


# boundary elements


def print_verification():
    """Print boundary elements against closed forms, refinement, and the stiffness ratio K_T/K_N."""
    print_table_head(
        "Hertz, Westergaard: relative errors", "points", "a²", "p_0", "approach", "k", "width", "gap", "k"
    )
    for points in (32, 64, 128, 256):
        print_table_row(
            points, *(f"{e:+.1e}" for e in hertz(points)), *(f"{e:.1e}" for e in westergaard(points))
        )
    print_table_head(
        "One surface on finer grids",
        "spacings in the shortest wave",
        "alpha at p/(E* h'_rms) = 0.01, 0.03, 0.1",
        "kappa",
    )
    for factor, alpha, kappa in zip((2, 4, 8), *compare.resolution(), strict=True):
        print_table_row(factor, *(", ".join(f"{x:.2f}" for x in one) for one in (alpha, kappa)))
    print_table_head("K_T/K_N of bonded contacts", "nu", "boundary elements", "2(1 - nu)/(2 - nu)")
    for nu in (0.0, 0.28, 0.45):
        print_table_row(
            nu,
            format_mean_and_deviation(compare.tangential_ratio(nu), "{:.3f}"),
            f"{2 * (1 - nu) / (2 - nu):.3f}",
        )


def print_elastic():
    """Print dimensionless elastic stiffness and real area; returns {(H, roll-off): results}."""
    found = {(H, r): compare.elastic(H, r, loads=LOADS) for H in HURST for r in ROLL_OFF}
    for name, title in (
        ("alpha", "alpha = k h_rms/p"),
        ("kappa", "kappa = (A_r/A_0) E* h'_rms/p"),
        ("isolated", "stiffness of the spots, each on its own, over k"),
    ):
        print_table_head(f"{title}, at p/(E* h'_rms)", "H", "longest wave", *LOADS)
        for (H, r), one in found.items():
            print_table_row(
                H,
                "side" if r == 1 else f"side/{r}",
                *(format_mean_and_deviation(column) for column in one[name].T),
            )
    print_table_head(
        "exponent of k over p, first and last three loads", "H", "longest wave", "low", "high", "1/(1+H)"
    )
    for (H, r), one in found.items():
        k = one["alpha"] * np.array(LOADS)
        ends = [[compare.exponent(LOADS[s], x[s]) for x in k] for s in (slice(3), slice(3, 6))]
        print_table_row(
            H,
            "side" if r == 1 else f"side/{r}",
            *(format_mean_and_deviation(e) for e in ends),
            f"{1 / (1 + H):.2f}",
        )
    loads = (0.0003, 0.001, 0.003, 0.01)
    print_table_head("alpha of many spots at light load, H = 0.58", "longest wave", *loads)
    for part, finest in ((8, 8), (16, 4)):
        alpha = compare.elastic(0.58, part, loads, finest=finest)["alpha"]
        print_table_row(f"side/{part}", *(format_mean_and_deviation(column) for column in alpha.T))
    return found


def print_laws():
    """Print three laws on the surfaces they assume; returns {(law, side): (case, boundary elements, law)}."""
    results = {}
    for name, case in compare.cases().items():
        for side in track_progress(case.sides, name):
            b, law = compare.boundary_element_results(case, side), compare.law_state(case, side)
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
            print_table_head(title, "p [MPa]", *names)
            for i, p in enumerate(case.pressures):
                print_table_row(
                    f"{p / 1e6:.3g}",
                    *(format_mean_and_deviation(b[q][:, i]) for q in ("k", "loading")),
                    f"{law['k'][i]:.2g}",
                    f"{law['k'][i] / b['k'][:, i].mean():.2g}",
                    format_mean_and_deviation(b["area"][:, i]),
                    f"{law['area'][i]:.2g}",
                    format_mean_and_deviation(b["plastic"][:, i]),
                    f"{law['plastic'][i]:.2g}",
                    f"{p / (GAMMA * b['rms'].mean()):.2g}",
                )
            slopes = [compare.exponent(case.pressures, k) for k in b["k"]]
            areas = [compare.exponent(case.pressures, a) for a in b["area"]]
            own = [compare.exponent(case.pressures, np.maximum(law[q], 1e-300)) for q in ("k", "area")]
            print(
                f"exponent of k {format_mean_and_deviation(slopes)}, law {own[0]:.2f}; "
                f"of A_r {format_mean_and_deviation(areas)}, law {own[1]:.2f}"
            )
    return results


def print_grids():
    """Print the influence of wave band and grid on the surface of `zhao2018`, with two seeds."""
    case = compare.cases()["zhao2018"]
    case = replace(case, pressures=case.pressures[[0, -1]])
    names = ("side [mm]", "points", "spacings in the shortest wave", "0.5 MPa", "16 MPa", "A_r/A_0 at 16 MPa")
    print_table_head("k [N/m3] and real area, zhao2018", *names)
    for side in case.sides:
        for points, finest in ((128, 8), (128, 4), (256, 16), (256, 8), (256, 4)):
            found = compare.boundary_element_results(case, side, range(2), points=points, finest=finest)
            k, area = found["k"].mean(axis=0), found["area"].mean(axis=0)
            print_table_row(
                f"{side * 1e3:.3g}", points, finest, f"{k[0]:.2g}", f"{k[-1]:.2g}", f"{area[-1]:.2g}"
            )
    case = replace(case, pressures=np.array([1e6, 4e6, 16e6]))
    found, law = (
        compare.boundary_element_results(case, 1e-3, points=128)["k"],
        compare.law_state(case, 1e-3)["k"],
    )
    print(
        "\nzhao2018 on 1 mm2 at 1, 4, 16 MPa: boundary elements",
        *(format_mean_and_deviation(k) for k in found.T),
        end="",
    )
    print(", law", *(f"{k:.2g}" for k in law))


# pictures


def draw_elastic(found, loads):
    """Draw alpha = k h_rms/p over the load."""
    with plots.open_figure(IMAGES / "validity_elastic.svg", (6.4, 4.0)) as figure:
        axes = figure.subplots()
        for (H, r), one in found.items():
            alpha, color = one["alpha"], COLORS[HURST.index(H)]
            label = f"H = {H}, waves up to the side" + ("" if r == 1 else f"/{r}")
            style = {"fmt": "o-" if r == 1 else "s--", "color": color, "ms": 4, "capsize": 2, "lw": 1}
            axes.errorbar(loads, alpha.mean(0), alpha.std(0, ddof=1), label=label, **style)
        axes.axhline(1.0 / GAMMA, color="black", lw=1, label="Persson, 1/0.48")
        axes.set(xscale="log", ylim=(0, 9), xlabel="p/(E* h'_rms)", ylabel="k h_rms/p")
        axes.legend(fontsize=8)


def draw_laws(results):
    """Draw the laws and boundary elements on the same surfaces."""
    with plots.open_figure(IMAGES / "validity_laws.svg", (10.5, 4.0)) as figure:
        panels = dict(zip(("zhao2018", "hu2023", "yu2022"), figure.subplots(1, 3), strict=True))
        for (name, side), (case, b, law) in results.items():
            axes, p = panels[name], case.pressures / 1e6
            color = plots.RED if side == case.sides[0] else plots.BLUE
            label = f"A_0 = ({side * 1e3:.3g} mm)²"
            axes.loglog(p, np.where(law["k"] > 0.0, law["k"], np.nan), color=color, label=f"law, {label}")
            bars = {"fmt": "o", "color": color, "ms": 4, "capsize": 2}
            axes.errorbar(p, b["k"].mean(0), b["k"].std(0, ddof=1), label="boundary elements", **bars)
            persson = case.pressures / (GAMMA * b["rms"].mean())
            axes.loglog(p, persson, ":", color=color, label="p/(0.48 h_rms)")
            axes.set(title=name, xlabel="p [MPa]")
            axes.legend(fontsize=7, loc="upper left")
        for axes in panels.values():
            low, high = axes.get_ylim()
            axes.set_ylim(low, high * (high / low) ** 0.45)
        panels["zhao2018"].set_ylabel("k [N/m³]")


def draw_joints():
    """Draw the measured joints and the laws."""
    with plots.open_figure(IMAGES / "validity_measured.svg", (7.6, 5.0)) as figure:
        axes = figure.subplots()
        for i, joint in enumerate(measured()["normal"]):
            p = np.geomspace(0.1, joint["to"] * joint["pressure_unit"] / 1e6)
            low, high = compare.measured_stiffness(joint, p * 1e6)
            material = joint["id"].replace(".", ", ").replace("_", " ")
            band = {"facecolor": f"C{i}", "edgecolor": f"C{i}", "alpha": 0.35, "lw": 3}
            axes.fill_between(p, low, high, **band, label=f"measured: {material}")
        p = np.geomspace(0.1, 100.0)
        zhao, hu, yu = (case.law for case in compare.cases().values())
        for choice, style in zip(("continuity", "printed", "yield"), ("-", "--", ":"), strict=True):
            k = stiffness_curve(replace(zhao, critical_area=choice), p * 1e6)[0]
            axes.plot(p, np.where(k > 0, k, np.nan), style, color=plots.BLUE, label=f"zhao2018, {choice}")
        axes.plot(p, stiffness_curve(hu, p * 1e6)[0], color=plots.RED, label="hu2023")
        axes.plot(p, stiffness_curve(yu, p * 1e6)[0], color=plots.GREEN, label="yu2022")
        for rms, style in ((0.3e-6, "-."), (10e-6, (0, (1, 3)))):
            label = f"p/(0.48 h_rms), h_rms = {rms * 1e6:g} µm"
            axes.plot(p, p * 1e6 / (GAMMA * rms), color="black", ls=style, lw=1, label=label)
        axes.set(xscale="log", yscale="log", ylim=(1e9, 1e16), xlabel="p [MPa]", ylabel="k [N/m³]")
        axes.legend(fontsize=7, ncols=2)


def measured_joints_section(options):
    """Print and draw measured joints and laws."""
    print_joints()
    if options.images:
        draw_joints()


def elastic_section(options):
    """Print and draw elastic contacts."""
    found = print_elastic()
    if options.images:
        draw_elastic(found, LOADS)


def own_surfaces_section(options):
    """Print and draw the laws on their own surfaces."""
    results = print_laws()
    if options.images:
        draw_laws(results)


def roughness_section(_):
    """Print the results of the law `roughness`."""
    roughness_law.print_brake_reuss()
    roughness_law.print_joints()
    roughness_law.print_second_scale()
    roughness_law.print_elastic()
    roughness_law.print_plastic()


if __name__ == "__main__":
    run_study(
        __doc__,
        {
            "measured-joints": measured_joints_section,
            "levels": lambda _: print_levels(),
            "sizes": lambda _: print_sizes(),
            "parameters": lambda _: print_parameters(),
            "verification": lambda _: print_verification(),
            "elastic": elastic_section,
            "own-surfaces": own_surfaces_section,
            "grids": lambda _: print_grids(),
            "roughness": roughness_section,
            "heights": lambda _: heights_law.print_heights(),
        },
        options={"--images": {"action": "store_true", "help": "draw the pictures into docs/images"}},
    )
