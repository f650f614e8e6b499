"""Tables of benchmarks/partial_slip.py; deviations in percent."""

import numpy as np
import slip_cases as cases
from validity_tables import heading, row

SHIFTS = [f"u at {force:g}" for force in cases.FORCES]
LOOPS = [f"loop at {amplitude:g}" for amplitude in cases.AMPLITUDES]


def solver(pressure, approach):
    """The normal pressure beside another solver's."""
    print(f"\nbeside tamaas: pressure {pressure:.1e} mean pressures at most, approach {approach:.1e} heights")


def spheres(which, found):
    """Spheres over closed forms."""
    heading("sphere over Cattaneo and Mindlin", "nu", "points", "load", "u, worst", *LOOPS)
    for (nu, points), (load, shifts, areas) in zip(which, found, strict=True):
        worst = shifts[np.argmax(np.abs(shifts))]
        row(nu, points, *(f"{100.0 * x:+.2f}" for x in (load, worst, *areas)))


def grids(points, found):
    """One surface on finer grids."""
    heading("one surface, theory over boundary elements", "points", "real area", *SHIFTS, *LOOPS[2:])
    for count, one in zip(points, found, strict=True):
        ratios = (*one.theory, *one.loop_theory)
        row(count, f"{one.area:.3f}", *(f"{100.0 * (ratio - 1.0):+.1f}" for ratio in ratios))


def displacements(kinds):
    """Theory over boundary elements at each force, by Hurst exponent and longest wave."""
    title = "displacement, theory over boundary elements: mean (least to largest)"
    heading(title, "longest wave", "H", "real area", *cases.FORCES)
    for (H, roll_off), found in kinds.items():
        area = [one.area for one in found]
        row(wave(roll_off), H, f"{min(area):.3f} to {max(area):.3f}", *extents(found, "theory"))


def loops(kinds):
    """The same of the area of loops."""
    title = "area of a loop, theory over boundary elements: mean (least to largest)"
    heading(title, "longest wave", "H", *cases.AMPLITUDES)
    for (H, roll_off), found in kinds.items():
        row(wave(roll_off), H, *extents(found, "loop_theory"))


def summary(groups):
    """Mean and largest deviation of groups, and how many are beyond 5 and 10 percent."""
    names = ("theory, u", "beyond 5", "theory, loop", "beyond 10", "sliders, loop", "beyond 10")
    heading(
        "deviation, mean and largest", "surfaces", *names, "sphere, u", "sphere, loop", "across", "loops end"
    )
    for name, found in groups.items():
        cells = []
        for quantity, bound in (("theory", 5.0), ("loop_theory", 10.0), ("loop_sliders", 10.0)):
            values = deviations(found, quantity)
            cells += [both(values), f"{np.sum(values > bound)} of {values.size}"]
        cells += [both(deviations(found, quantity)) for quantity in ("sphere", "loop_sphere")]
        across = max(np.max(np.abs(one.across / one.force)) for one in found)
        row(name, *cells, f"{100.0 * across:.1f}", f"{100.0 * max(one.open for one in found):.2f}")


def exponents(groups):
    """Exponent of the loss over the amplitude of the displacement, of the two smallest amplitudes."""
    heading("exponent of the loss, 0.1 to 0.2", "surfaces", "boundary elements", "theory", "sphere")
    for name, found in groups.items():
        shares = {"boundary elements": None, "theory": "loop_theory", "sphere": "loop_sphere"}
        values = [[exponent(one, share) for one in found] for share in shares.values()]
        row(name, *(f"{np.mean(one):.2f} ± {np.std(one, ddof=1):.2f}" for one in values))


def exponent(one, share=None):
    """d ln(loss)/d ln(displacement) between the two smallest amplitudes; of a share of the loss."""
    loss = one.loss * (1.0 if share is None else getattr(one, share))
    first, second = (one.shift[cases.FORCES.index(a)] for a in cases.AMPLITUDES[:2])
    return np.log(loss[1] / loss[0]) / np.log(second / first)


def wave(roll_off):
    """The longest wave in words."""
    return "side" if roll_off == 1 else f"side/{roll_off}"


def deviations(found, name):
    """Sizes of all deviations of found ratios."""
    return 100.0 * np.abs(np.concatenate([getattr(one, name) for one in found]) - 1.0)


def both(values):
    """Mean and largest as text."""
    return f"{values.mean():.1f}, {values.max():.1f}"


def extents(found, name):
    """Mean and range of found ratios as cells."""
    values = 100.0 * (np.array([getattr(one, name) for one in found]) - 1.0)
    ends = zip(values.mean(axis=0), values.min(axis=0), values.max(axis=0), strict=True)
    return (f"{mean:+.1f} ({low:+.1f} to {high:+.1f})" for mean, low, high in ends)
