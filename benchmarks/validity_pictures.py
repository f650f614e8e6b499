"""Pictures of benchmarks/validity.py, into docs/images."""

from dataclasses import replace

import interface_laws as compare
import numpy as np
from jointfmu_tools.common import plots
from measured_joints import measured
from validity_tables import IMAGES

from jointfmu.contact.interface import stiffness_curve

GAMMA = 0.48
"""k = p/(GAMMA h_rms): Persson 2007, with the number of Akarapu, Sharp and Robbins 2011."""
HURST = (0.3, 0.58, 0.8)
COLORS = (plots.BLUE, plots.RED, plots.GREEN)


def elastic(found, loads):
    """Picture of alpha over the load."""
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


def laws(results):
    """Picture of the laws and of boundary elements on the same surfaces."""
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


def joints():
    """Picture of the measured joints and of the laws."""
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
