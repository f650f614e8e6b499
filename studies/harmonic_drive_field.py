"""Figures of docs/harmonic_drive_field.md: pressure between flexspline and bearing from thin elastic rings.

    python studies/harmonic_drive_field.py [SECTION ...] [--plot FILE]

checks    : closed forms and convergence
fields    : the pressure over the torque, and the default parameters of the drive
forces    : forces that the published peak pressure would need
published : torsional stiffness compared with the published numbers
variants  : the estimates, varied one by one
picture   : the field over the angle, into --plot FILE (on request)
"""

from dataclasses import replace

import numpy as np
from common import run_study
from jointfmu_tools.common import plots
from jointfmu_tools.studies.published.reference import read_points
from oracles.elastic_ring.data import SIZE_14, contact_length, tooth_traction
from oracles.elastic_ring.drive import field, section, torsional_stiffness
from oracles.elastic_ring.drive import ring_model_stiffness as stiffness
from oracles.elastic_ring.forms import (
    on_oval,
    on_oval_in_elements,
    opposite_forces,
    opposite_forces_in_elements,
)
from oracles.elastic_ring.ring import Ring

from jointfmu.joints.harmonic_drive.law import contact_pair_stiffness, peak_pressure
from jointfmu.parameters import load_default
from jointfmu.progress import track_progress

DRIVE = load_default("harmonic_drive").values
HU = {point.id: float(point.value) for point in read_points("hu2023")}
TORQUES = (1.0, 3.0, 5.0)
MIN_DEFORMATION, BEST_DEFORMATION, MAX_DEFORMATION = 0.195e-3, 0.21e-3, 0.215e-3
"""Smallest, best and largest radial deformation [m] of Hu 2023, section 3.4."""
MAXIMA = [HU[f"K_TS.max.{T:.0f}"] for T in TORQUES]
MINIMA = [HU[f"K_TS.min.{T:.0f}"] for T in TORQUES]
CHANGES = [HU[f"K_TS.eccentricity.{T:.0f}"] for T in TORQUES]
NOMINAL, PEAK = HU["K_TS.nominal.5"], HU["p_max.5"]
DEG = np.radians(1.0)


def checks():
    """Print closed forms and convergence for a ring of the default radius and 0.5 mm thickness."""
    ring, r, w = Ring.of(2.09e11, 0.295, 0.5e-3), DRIVE.radius, 2e-4
    exact = opposite_forces(ring, r, 1e3)
    counts = (16, 32, 64, 128)
    errors = np.array([abs(opposite_forces_in_elements(ring, r, 1e3, n) / exact - 1.0) for n in counts])
    print("two opposite forces, relative error with 16, 32, 64, 128 elements")
    print("  " + "  ".join(f"{x:.1e}" for x in errors), end="")
    print(f", mean order {np.log2(errors[:-1] / errors[1:]).mean():.1f}")
    form = on_oval(ring, r, w)
    print(f"rigid oval: edge {form.edge / DEG:.2f} deg, peak {form.peak / 1e3:.2f} kPa", end="")
    print(f", line force {form.edge_force:.1f} N/m at each edge, lobe {form.lobe_force:.1f} N/m")
    for modulus in (1e12, 1e13, 1e14):
        circle, p = on_oval_in_elements(ring, r, w, modulus, 1024)
        lobe = 0.5 * float(circle.weight @ (p * np.abs(np.cos(circle.theta))))
        print(f"  foundation {modulus:.0e} Pa/m: peak {100 * (p[0] / form.peak - 1):+.3f} %", end="")
        print(f", lobe {100 * (lobe / form.lobe_force - 1):+.3f} %")
    peaks = np.array([on_oval_in_elements(ring, r, w, 1e12, n)[1][0] for n in (32, 64, 128, 256, 1024)])
    errors = np.abs(peaks[:-1] / peaks[-1] - 1.0)
    print("  1e+12: peak with 32, 64, 128, 256 elements against 1024: ", end="")
    print(
        "  ".join(f"{x:.1e}" for x in errors), f", mean order {np.log2(errors[:-1] / errors[1:]).mean():.1f}"
    )
    print("drive at 5 N.m, opening; elements from ball to ball, peak [MPa], force of the balls [N/mm]")
    for n in (3, 6, 12, 24, 48):
        one = opening(DRIVE, replace(SIZE_14, elements_per_ball=n), 5.0)
        print(f"  {n:3d}  {one.pressure.max() / 1e6:.5f}  {one.push / 1e3:.6f}")


def opening(drive, rings, torque):
    """Equilibrium of the section at the opening of the cup."""
    return section(drive, rings, 0.0, tooth_traction(drive, rings, torque))


def fields():
    """Print the pressure field over the torque, and the corresponding parameters of the default drive."""
    print("rings    T  peak MPa  centre deg  load kN  mean/peak  within 35 deg  open part  K_TS unscaled")
    for T in (0.0, *TORQUES):
        nodes = field(DRIVE, SIZE_14, tooth_traction(DRIVE, SIZE_14, T))[0]
        one = opening(DRIVE, SIZE_14, T)
        turned = np.sum(one.weight * one.pressure * np.exp(2j * one.theta))
        row(f"     {T:5.1f}", one.pressure.max(), 0.5 * np.angle(turned), nodes)
    print("default  T  peak MPa  load kN  K_TS of the paper's figures")
    for T in (0.0, *TORQUES):
        peak, pair = peak_pressure(DRIVE, T)[0], contact_pair_stiffness(DRIVE, T)[0] / DRIVE.drive_scale
        load = DRIVE.mean_over_peak * peak * DRIVE.A_0
        print(f"     {T:5.1f} {peak / 1e6:9.2f} {load / 1e3:8.3f} {pair:9.1f}")


def row(name, peak, centre, nodes):
    """Print one row of the table of fields."""
    load = nodes.share * nodes.pressure
    near = np.abs(nodes.position[..., 0]) > DRIVE.radius * np.cos(35 * DEG)
    closed = np.sum(nodes.share[nodes.pressure > 0.0])
    print(f"{name} {peak / 1e6:8.3f} {centre / DEG:11.1f} {np.sum(load) * DRIVE.A_0 / 1e3:8.3f}", end="")
    print(f" {np.sum(load) / peak:10.3f}", end="")
    print(f" {np.sum(load[near]) / np.sum(load):14.2f} {abs(1 - closed):10.2f}", end="")
    print(f" {torsional_stiffness(DRIVE, nodes):14.3g}")


def forces():
    """Print the forces that the published peak pressure would require, and the power balance of the tooth
    load."""
    area, strength = SIZE_14.wall * contact_length(DRIVE), DRIVE.flexspline.sigma_y
    for T in (0.0, 5.0):
        lobe = 0.5 * DRIVE.mean_over_peak * peak_pressure(DRIVE, T)[0] * DRIVE.A_0
        print(f"default at {T:g} N.m: one lobe pushes with {lobe / 1e3:.2f} kN", end="")
        print(f", hoop stress {lobe / 2 / area / 1e6:.0f} MPa (yield strength {strength / 1e6:.0f} MPa)")
    T, r, w, length = 5.0, DRIVE.radius, DRIVE.radial_deformation, contact_length(DRIVE)
    print(f"teeth at 5 N.m: {T / r:.0f} N along, {T / r * np.tan(SIZE_14.pressure_angle):.0f} N radial")
    print(f"5 N.m by friction {DRIVE.mu:g} alone: normal load {T / DRIVE.mu / r / 1e3:.2f} kN")
    print(f"5 N.m by the oval's slope alone: {T / (4.0 * w * r * length) / 1e6:.1f} MPa on two quarters")
    even = replace(SIZE_14, cup_length=1e3 * SIZE_14.cup_length)
    for centre in (-15.0, 0.0, 15.0):
        rings = replace(even, zone_centre=centre * DEG)
        part = -opening(DRIVE, rings, T).torque * length * DRIVE.ratio / T
        print(
            f"torque at the wave generator over that of the speed ratio, zone at {centre:+g} deg: {part:.2f}"
        )
    print(f"cup without stretching over its rings, stiffness against ovalling: {cup():.2f}")
    one = uniform(5.0)
    print(f"5 N.m spread evenly and carried by friction: peak {one.pressure.max() / 1e6:.3f} MPa")


def cup():
    """Print the stiffness of the cup against ovalling, over the stiffness of the rings in its contact.

    Rayleigh's deformation without stretching, w (1 - z/L) cos(2 theta): bending by 3 w/r^2 around and
    twist by 3/2 w/(r L), energy D/2 (bending^2 + 2 (1 - nu) twist^2), one wall throughout.
    """
    r, L, part = DRIVE.radius, SIZE_14.cup_length, contact_length(DRIVE) / SIZE_14.cup_length
    bending, twist = 9.0 / r**4 * L / 3.0, 2.0 * (1.0 - DRIVE.flexspline.nu) * (1.5 / (r * L)) ** 2 * L
    return (bending + twist) / (bending * (1.0 - (1.0 - part) ** 3))


def uniform(torque):
    """Section at the opening with uniformly distributed torque, friction in proportion to the pressure."""
    free = opening(DRIVE, SIZE_14, 0.0)
    area = 2.0 * np.pi * DRIVE.radius**2 * contact_length(DRIVE)
    shape = free.pressure / np.average(free.pressure, weights=free.weight)
    return section(DRIVE, SIZE_14, 0.0, lambda theta: (0.0 * theta, torque / area * (1.0 - shape)))


def published():
    """Print the ring model with its own pressures and one scale factor, and the published numbers."""
    scale = NOMINAL / stiffness(DRIVE, SIZE_14, 5.0)
    print(f"published over computed K_TS at 5 N.m: {scale:.3g}")
    for T, most, least, change in zip(TORQUES, MAXIMA, MINIMA, CHANGES, strict=True):
        low, best, high = (
            scale * stiffness(replace(DRIVE, radial_deformation=w), SIZE_14, T)
            for w in (MIN_DEFORMATION, BEST_DEFORMATION, MAX_DEFORMATION)
        )
        print(
            f"T = {T:g}: K_TS at 0.21 mm {best:.0f} (published {most:.0f}: {100 * (best / most - 1):+.1f} %)"
        )
        print(
            f"  0.195 to 0.21 mm {100 * (best / low - 1):+.2f} %, to 0.215 {100 * (high / low - 1):+.2f} %",
            end="",
        )
        print(f" (published: largest at 0.21 mm, {100 * (most / least - 1):+.2f} % over the least)")
        changes = []
        for k, angle in ((3e5, 0.0), (3e5, 90.0), (7e7, 0.0), (7e7, 90.0)):
            rings = replace(SIZE_14, lateral_stiffness=k, eccentric_angle=angle * DEG)
            moved = stiffness(replace(DRIVE, eccentricity=1e-5), rings, T)
            changes.append(f"{100.0 * (moved / stiffness(DRIVE, rings, T) - 1.0):+.2f}")
        print(
            "  10 um along the major, minor axis: 3e5 N/m {}, {} %; 7e7 N/m {}, {} %".format(*changes), end=""
        )
        print(f" (published {change:+.2f} %)")


VARIANTS = {
    "as estimated": {},
    "wall x 2/3": {"wall": SIZE_14.wall / 1.5},
    "wall x 1.5": {"wall": SIZE_14.wall * 1.5},
    "wall x 2": {"wall": SIZE_14.wall * 2.0},
    "race 0.7 mm": {"race": 0.7e-3},
    "race 1.4 mm": {"race": 1.4e-3},
    "zone 30 deg": {"zone": 30.0 * DEG},
    "zone 60 deg": {"zone": 60.0 * DEG},
    "centre -15 deg": {"zone_centre": -15.0 * DEG},
    "centre +15 deg": {"zone_centre": 15.0 * DEG},
    "tooth angle 10 deg": {"pressure_angle": 10.0 * DEG},
    "tooth angle 30 deg": {"pressure_angle": 30.0 * DEG},
    "interference +5 um": {"interference": 5e-6},
    "interference -5 um": {"interference": -5e-6},
    "92 balls": {"balls": 92, "elements_per_ball": 3},
    "balls turned": {"first_ball": 0.5 * np.pi / SIZE_14.balls},
}


def variants():
    """Print the results with the estimated data varied one at a time."""
    print("estimate             peak MPa at 5   K 1/5   K 3/5   0.195 to 0.215 mm at 1 %   10 um at 1 %")
    print(
        f"{'published':20} {PEAK / 1e6:13.2f} {MAXIMA[0] / MAXIMA[2]:7.3f} {MAXIMA[1] / MAXIMA[2]:7.3f}",
        end="",
    )
    print(f" {100 * (MAXIMA[0] / MINIMA[0] - 1):26.2f} {CHANGES[0]:14.2f}")
    best = replace(DRIVE, radial_deformation=BEST_DEFORMATION)
    for name, changes in track_progress(list(VARIANTS.items()), "estimates"):
        rings = replace(SIZE_14, **changes)
        K = [stiffness(best, rings, T) for T in TORQUES]
        low, high = (
            stiffness(replace(DRIVE, radial_deformation=w), rings, 1.0)
            for w in (MIN_DEFORMATION, MAX_DEFORMATION)
        )
        moved = stiffness(replace(best, eccentricity=1e-5), rings, 1.0)
        peak = opening(DRIVE, rings, 5.0).pressure.max()
        print(f"{name:20} {peak / 1e6:13.3f} {K[0] / K[2]:7.3f} {K[1] / K[2]:7.3f}", end="")
        print(f" {100 * (high / low - 1):26.2f} {100 * (moved / K[0] - 1):14.2f}", flush=True)


def draw(path):
    """Draw the pressure at the opening over the angle."""
    with plots.open_figure(path, (7.2, 3.4)) as figure:
        axes = figure.subplots()
        for T, colour in zip((0.0, 1.0, 5.0), (plots.GREY, plots.BLUE, plots.RED), strict=True):
            one = opening(DRIVE, SIZE_14, T)
            degrees = (one.theta / DEG + 90.0) % 360.0 - 90.0
            order = np.argsort(degrees)
            axes.plot(degrees[order], one.pressure[order] / 1e6, color=colour, label=f"{T:g} N m")
        axes.set(xlabel="angle from the major axis [deg]", ylabel="pressure [MPa]")
        axes.set_xticks(range(-90, 271, 45))
        axes.legend()


def draw_field(options):
    """Draw the pressure at the opening of the cup into --plot FILE."""
    if not options.plot:
        raise SystemExit("picture: name a file with --plot FILE")
    plots.check_picture_path(options.plot)
    draw(options.plot)


if __name__ == "__main__":
    run_study(
        __doc__,
        {
            "checks": lambda _: checks(),
            "fields": lambda _: fields(),
            "forces": lambda _: forces(),
            "published": lambda _: published(),
            "variants": lambda _: variants(),
            "picture": draw_field,
        },
        on_request=("picture",),
        options={"--plot": {"metavar": "FILE", "help": "picture to write of the field (.png, .svg)"}},
    )
