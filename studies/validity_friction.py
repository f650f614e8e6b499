"""Figures of docs/validity_friction.md: partial slip by boundary elements against the prediction from the
normal curve.

    python studies/validity_friction.py [--images]

The tables have the deviations in percent. `--images` draws the picture into docs/images.
"""

from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from itertools import product

import numpy as np
from common import IMAGES, print_table_head, print_table_row, run_study
from jointfmu_tools.common import plots
from oracles import partial_slip_cases as cases
from oracles.boundary_element import press, refined

from jointfmu.progress import track_progress

NU = 0.3
MEAN_SEPARATIONS = {500: 1.0, 501: 1.5, 700: 1.0, 701: 1.5}
"""Distance of the mean planes {seed: distance [rms heights]}: two loads."""
HURST = (0.3, 0.55, 0.8)
SEEDS = {1: (700, 701), 4: (700, 701), 8: (700,)}
"""{roll-off: seeds} of surfaces with waves up to side/1, side/4 and side/8."""
STRETCH = 4
"""Textured surfaces: factor by which their waves are shorter along x."""
SPHERES = tuple(product((0.0, NU), (24, 48, 96)))
"""Poisson's ratios and numbers of grid points along a side, for spheres."""
GRIDS = (1, 2, 4)
"""Refinement factors for one surface with COARSE grid points along a side."""
COARSE = 64


@dataclass(frozen=True)
class Surface:
    """Generated rough surface, and the comparison of its contact with the prediction under shear.

    hurst    : Hurst exponent
    roll_off : side of the surface over the longest wave
    nu       : Poisson's ratio
    stretch  : factor by which waves are shorter along x than along y
    """

    hurst: float
    roll_off: int
    seed: int = 700
    nu: float = NU
    stretch: int = 1

    def contact(self):
        z = cases.heights(self.hurst, self.roll_off, self.seed, stretch=self.stretch)
        return cases.rough_contact(z, self.nu, MEAN_SEPARATIONS[self.seed])

    def compare(self):
        contact = self.contact()
        prediction = cases.predict(contact)
        return [cases.compare(contact, prediction, axis) for axis in (0, 1)]


ISOTROPIC = [Surface(H, r, seed) for r, seeds in SEEDS.items() for H in HURST for seed in seeds]
OTHER_SURFACES = {
    "one hill, other seeds": [Surface(H, 1, seed) for H in HURST for seed in (500, 501)],
    "nu = 0": [Surface(0.3, 4, nu=0.0), Surface(0.8, 1, nu=0.0)],
    "nu = 0.49": [Surface(0.3, 4, nu=0.49), Surface(0.8, 4, nu=0.49)],
    "textured": [Surface(0.3, 1, stretch=STRETCH), Surface(0.8, 1, stretch=STRETCH)],
}


def grid(factor):
    """One rough surface on a finer grid."""
    contact = cases.rough_contact(refined(cases.heights(0.8, 4, 700, points=COARSE), factor), NU)
    return cases.compare(contact, cases.predict(contact, amplitudes=(0.5, 0.9)))


def deviation_from_tamaas():
    """Largest deviation of the pressure from tamaas [mean pressures], and of the approach [rms heights]."""
    z = cases.heights(0.8, 4, 700, points=COARSE)
    contact = cases.rough_contact(z, NU)
    other = press(z, [contact.load])[0]
    pressure = np.max(np.abs(other.pressure - contact.pressure)) / contact.load
    return pressure, abs(other.separation + contact.approach) / z.std()


# tables

DISPLACEMENT_COLUMNS = [f"u at {force:g}" for force in cases.FORCES]
LOOP_COLUMNS = [f"loop at {amplitude:g}" for amplitude in cases.AMPLITUDES]


def print_solver(pressure, approach):
    """Print the deviation of the normal contact from tamaas."""
    print(f"\nbeside tamaas: pressure {pressure:.1e} mean pressures at most, approach {approach:.1e} heights")


def print_spheres(which, found):
    """Print the errors for spheres against closed forms."""
    print_table_head("sphere over Cattaneo and Mindlin", "nu", "points", "load", "u, worst", *LOOP_COLUMNS)
    for (nu, points), (load, shifts, areas) in zip(which, found, strict=True):
        worst = shifts[np.argmax(np.abs(shifts))]
        print_table_row(nu, points, *(f"{100.0 * x:+.2f}" for x in (load, worst, *areas)))


def print_grids(points, found):
    """Print the results for one surface on finer grids."""
    print_table_head(
        "one surface, theory over boundary elements",
        "points",
        "real area",
        *DISPLACEMENT_COLUMNS,
        *LOOP_COLUMNS[2:],
    )
    for count, one in zip(points, found, strict=True):
        ratios = (*one.theory, *one.loop_theory)
        print_table_row(count, f"{one.area:.3f}", *(f"{100.0 * (ratio - 1.0):+.1f}" for ratio in ratios))


def print_displacements(kinds):
    """Print displacements, theory over boundary elements, by Hurst exponent and longest wave."""
    title = "displacement, theory over boundary elements: mean (least to largest)"
    print_table_head(title, "longest wave", "H", "real area", *cases.FORCES)
    for (H, roll_off), found in kinds.items():
        area = [one.area for one in found]
        print_table_row(
            wave_name(roll_off), H, f"{min(area):.3f} to {max(area):.3f}", *extents(found, "theory")
        )


def print_loops(kinds):
    """Print loop areas, theory over boundary elements, by Hurst exponent and longest wave."""
    title = "area of a loop, theory over boundary elements: mean (least to largest)"
    print_table_head(title, "longest wave", "H", *cases.AMPLITUDES)
    for (H, roll_off), found in kinds.items():
        print_table_row(wave_name(roll_off), H, *extents(found, "loop_theory"))


def print_summary(groups):
    """Print mean and largest deviation of groups of surfaces, and the number of deviations above 5 and 10
    percent."""
    names = ("theory, u", "beyond 5", "theory, loop", "beyond 10", "sliders, loop", "beyond 10")
    print_table_head(
        "deviation, mean and largest", "surfaces", *names, "sphere, u", "sphere, loop", "across", "loops end"
    )
    for name, found in groups.items():
        cells = []
        for quantity, bound in (("theory", 5.0), ("loop_theory", 10.0), ("loop_sliders", 10.0)):
            values = deviations(found, quantity)
            cells += [mean_and_largest(values), f"{np.sum(values > bound)} of {values.size}"]
        cells += [mean_and_largest(deviations(found, quantity)) for quantity in ("sphere", "loop_sphere")]
        across = max(np.max(np.abs(one.across / one.force)) for one in found)
        print_table_row(
            name, *cells, f"{100.0 * across:.1f}", f"{100.0 * max(one.open for one in found):.2f}"
        )


def print_exponents(groups):
    """Print the exponent of the loss over the displacement amplitude, at the two smallest amplitudes."""
    print_table_head("exponent of the loss, 0.1 to 0.2", "surfaces", "boundary elements", "theory", "sphere")
    for name, found in groups.items():
        shares = {"boundary elements": None, "theory": "loop_theory", "sphere": "loop_sphere"}
        values = [[loss_exponent(one, share) for one in found] for share in shares.values()]
        print_table_row(name, *(f"{np.mean(one):.2f} ± {np.std(one, ddof=1):.2f}" for one in values))


def loss_exponent(one, share=None):
    """Exponent of the loss, d ln(loss)/d ln(displacement), between the two smallest amplitudes.

    share : name of the ratio of the predicted loss to the loss by boundary elements
    """
    loss = one.loss * (1.0 if share is None else getattr(one, share))
    first, second = (one.shift[cases.FORCES.index(a)] for a in cases.AMPLITUDES[:2])
    return np.log(loss[1] / loss[0]) / np.log(second / first)


def wave_name(roll_off):
    """Text that describes the longest wave."""
    return "side" if roll_off == 1 else f"side/{roll_off}"


def deviations(found, name):
    """Magnitudes of all deviations [%] of ratios."""
    return 100.0 * np.abs(np.concatenate([getattr(one, name) for one in found]) - 1.0)


def mean_and_largest(values):
    """Format mean and largest value."""
    return f"{values.mean():.1f}, {values.max():.1f}"


def extents(found, name):
    """Format mean and range of deviations [%] of ratios."""
    values = 100.0 * (np.array([getattr(one, name) for one in found]) - 1.0)
    ends = zip(values.mean(axis=0), values.min(axis=0), values.max(axis=0), strict=True)
    return (f"{mean:+.1f} ({low:+.1f} to {high:+.1f})" for mean, low, high in ends)


# picture

PLOT_STATIONS = np.polynomial.legendre.leggauss(12)
"""Number of Gauss points on the branches of the drawn loops."""


def draw(contact, found):
    """Draw loops of one contact, and the loss of all contacts over the amplitude."""
    with plots.open_figure(IMAGES / "validity_partial_slip.svg", (9.6, 4.0)) as figure:
        left, right = figure.subplots(1, 2)
        draw_loops(left, contact)
        draw_losses(right, found)


def draw_loops(axes, contact):
    """Draw loops of two amplitudes: boundary elements as points, theory and sphere as lines."""
    prediction = cases.predict(contact, amplitudes=())
    load, end = prediction.load, prediction.shift[-1]
    states = cases.backbone(contact, prediction.shift, 0)
    guess = cases.sphere_backbone(load, prediction.initial_stiffness)
    for amplitude in (0.5, 0.9):
        state = states[cases.FORCES.index(amplitude)]
        one, far = cases.follow_loop(contact, state, 0, PLOT_STATIONS), float(state.shift[0])
        x = np.concatenate([-PLOT_STATIONS[0], PLOT_STATIONS[0]]) * far / end
        axes.plot(x, np.concatenate([one.back, one.again]) / load, "o", color=plots.BLUE, ms=4)
        u = np.linspace(0.0, 2.0 * far, 81)
        true = load - contact.loads_unloaded(0.5 * prediction.ratio * u)
        for branch, style in (
            (true, {"color": plots.RED}),
            (guess(0.5 * u), {"color": plots.GREY, "ls": "--"}),
        ):
            top = branch[-1] / load  # half the way: the backbone at the amplitude
            for sign in (1.0, -1.0):
                axes.plot(sign * (far - u) / end, sign * (top - 2.0 * branch / load), lw=1, **style)
    shift = np.append(0.0, prediction.shift)
    axes.plot(
        shift / end, [0.0, *(s.force[0] / load for s in states)], "s", color=plots.BLUE, ms=4, mfc="white"
    )
    u = np.linspace(0.0, end, 41)
    axes.plot(u / end, 1.0 - contact.loads_unloaded(prediction.ratio * u) / load, color=plots.RED, lw=1)
    axes.plot(u / end, guess(u) / load, color=plots.GREY, ls="--", lw=1)
    axes.set(
        xlabel="displacement over that at 0.9 μP", ylabel="force over μP", xticks=(-1.0, -0.5, 0.0, 0.5, 1.0)
    )


def draw_losses(axes, found):
    """Draw the loss of a cycle over pi times force and displacement, over the amplitude."""
    index = [cases.FORCES.index(a) for a in cases.AMPLITUDES]
    names = {
        "boundary elements": None,
        "from the normal curve": "loop_theory",
        "Mindlin's sphere": "loop_sphere",
    }
    styles = (("o", plots.BLUE), ("_", plots.RED), ("x", plots.GREY))
    for (label, name), (mark, color) in zip(names.items(), styles, strict=True):
        for i, one in enumerate(found):
            loss = one.loss * (getattr(one, name) if name else 1.0)
            work = np.pi * one.load * one.force[index] * one.shift[index]
            style = {"color": color, "ms": 3 if mark == "o" else 6, "label": label if i == 0 else None}
            axes.loglog(one.force[index], loss / work, mark, **style)
    axes.set(xlabel="amplitude of the force over μP", ylabel="loss over π times force and displacement")
    axes.set_xticks(cases.AMPLITUDES, [f"{amplitude:g}" for amplitude in cases.AMPLITUDES], minor=False)
    axes.set_xticks([], minor=True)
    axes.legend(fontsize=8)


def compare_all(options):
    """Compare theory and boundary elements for spheres, grids and rough surfaces; print all tables."""
    surfaces = [*ISOTROPIC, *(s for some in OTHER_SURFACES.values() for s in some)]
    with ProcessPoolExecutor() as pool:
        spheres = [pool.submit(cases.sphere_errors, points, nu) for nu, points in SPHERES]
        grids = pool.map(grid, GRIDS)
        rough = track_progress(pool.map(Surface.compare, surfaces), "surfaces", len(surfaces))
        found = dict(zip(surfaces, rough, strict=True))
        print_solver(*deviation_from_tamaas())
        print_spheres(SPHERES, [one.result() for one in spheres])
        print_grids([COARSE * factor for factor in GRIDS], list(grids))
    kinds = {}
    for s in ISOTROPIC:
        kinds.setdefault((s.hurst, s.roll_off), []).extend(found[s])
    print_displacements(kinds)
    print_loops(kinds)
    groups = {
        "waves up to the side": [one for s in ISOTROPIC if s.roll_off == 1 for one in found[s]],
        "waves up to side/4, side/8": [one for s in ISOTROPIC if s.roll_off > 1 for one in found[s]],
        **{name: [one for s in some for one in found[s]] for name, some in OTHER_SURFACES.items()},
        "textured, across the ridges": [found[s][0] for s in OTHER_SURFACES["textured"]],
        "textured, along the ridges": [found[s][1] for s in OTHER_SURFACES["textured"]],
    }
    print_summary(groups)
    print_exponents(groups)
    if options.images:
        draw(ISOTROPIC[-1].contact(), [one for s in ISOTROPIC for one in found[s]])


if __name__ == "__main__":
    run_study(
        __doc__,
        {"partial-slip": compare_all},
        options={"--images": {"action": "store_true", "help": "draw the picture into docs/images"}},
    )
