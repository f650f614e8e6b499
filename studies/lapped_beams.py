"""Lapped beams of docs/validity_bolted_joint.md: the Brake-Reuss beam, and a beam with unknown properties.

Finite elements for both halves and the bolts, the law of the interface on every patch of the lap, friction by
sliders with history. Nothing is fitted: the assumptions below were fixed before the comparison.
"""

import sys
from dataclasses import replace

import numpy as np
from common import IMAGES, print_table_head, print_table_row
from jointfmu_tools.common import plots
from oracles.lap_beam.brake_reuss import (
    AMPLITUDES,
    FRICTION_COEFFICIENT,
    GLUED_STIFFNESS,
    Curves,
    beam,
    crown,
    data,
    form,
    laws,
    published,
    solid_bar_frequency,
)
from oracles.lap_beam.loops import Joint, damping, foundation, frequency, masing_losses, with_friction
from oracles.lap_beam.plan import Fineness
from oracles.lap_beam.reduction import Structure, reduce_beam, spectrum
from oracles.measured_joints import joint_law, measured
from scipy.stats import qmc

from jointfmu.mechanics.curve import tabulate_approach
from jointfmu.progress import track_progress

OTHER_COEFFICIENTS = (0.03, 0.1, 0.3, 0.6)
CYCLE_AMPLITUDES = slice(4, None, 2)
"""Indices of the AMPLITUDES with a full cycle."""
STEPS = 8
"""Number of load steps from one end of a cycle to the other."""


def reduced_joints(structure, gap=None):
    """Joint {law: joint} of the reduced beam, with plane faces or with a function gap [m] of x, y [m]."""
    preload, found = data()["beam"]["preload"], {}
    for name, law in laws().items():
        curve, shear = tabulate_approach(law), float(law.shear_stiffness_ratio())
        part = reduce_beam(structure, curve, preload, shear, gap)
        found[name] = Joint(part, foundation(curve, shear, FRICTION_COEFFICIENT))
    return found


def curves(joint):
    """Frequency and damping at AMPLITUDES[CYCLE_AMPLITUDES]: by full cycles, and by Masing's rules."""
    states, simple = masing_curves(joint)
    whole = [damping(joint.cycle(state, STEPS)[0], state) for state in states]
    return replace(simple, damping=np.array(whole)), simple


def masing_curves(joint, turns=CYCLE_AMPLITUDES):
    """States at AMPLITUDES[turns], and frequency and damping there by Masing's rules."""
    states = joint.backbone(AMPLITUDES)
    ratios = [damping(*pair) for pair in zip(masing_losses(states), states, strict=True)]
    columns = [s.q for s in states], [frequency(s) for s in states], ratios
    return states[turns], Curves(*(np.array(values)[turns] for values in columns))


def print_linear_frequencies(structure, found):
    """Print the frequencies of small motions; returns the first frequency of the glued lap [Hz]."""
    count = structure.interface.quadrature_area.size
    print_table_head("Linear frequencies [Hz]", "interface", "f1", "f2", "f3")
    print_table_row("solid bar (Timoshenko)", f"{solid_bar_frequency(structure.beam):.1f}", "", "")
    glued = spectrum(structure, np.full((count, 3), GLUED_STIFFNESS))[0]
    print_table_row("lap in one piece", *(f"{f:.1f}" for f in glued))
    for name, joint in found.items():
        print_table_row(name, *(f"{f:.1f}" for f in joint.beam.frequencies))
    return float(glued[0])


def print_over_amplitude(title, curve, simple, joint):
    """Print frequency and damping over the amplitude, by full cycles and by Masing's rules."""
    print_table_head(
        title, "q [m kg^0.5]", "tip [um]", "acceleration [m/s2]", "f [Hz]", "zeta [%]", "by Masing [%]"
    )
    for q, f, zeta, other in zip(curve.q, curve.frequency, curve.damping, simple.damping, strict=True):
        tip = q * joint.beam.tip
        peak = f"{tip * (2.0 * np.pi * f) ** 2:.3g}"
        print_table_row(
            f"{q:.2e}", f"{1e6 * tip:.3g}", peak, f"{f:.2f}", f"{100 * zeta:.3f}", f"{100 * other:.3f}"
        )


def print_beside_published(ours, name, glued):
    """Print predictions next to a published curve, `flat` or `curved`, with the published viscous damping
    added.

    Trivial predictions: a lap in one piece, and the published frequency of small motions.
    """
    viscous, theirs = data()["published"]["viscous"], published(name)
    names = [f"{one}: {what}" for one in ours for what in ("f", "miss [%]", "zeta [%]", "ratio")]
    guesses = ("one piece: miss [%]", "constant: miss [%]", "ratio")
    print_table_head(
        f"Beside the published curve of {name} surfaces", "q", "f [Hz]", "zeta [%]", *names, *guesses
    )
    for q, f, zeta in zip(theirs.q, theirs.frequency, theirs.damping, strict=True):
        cells = []
        for curve in ours.values():
            found, loss = (float(value) for value in curve.at(q))
            whole = loss + viscous
            cells += [f"{found:.1f}", f"{100 * (found / f - 1):+.1f}"]
            cells += [f"{100 * whole:.2f}", f"{whole / zeta:.2f}"]
        cells += [f"{100 * (one / f - 1):+.1f}" for one in (glued, theirs.frequency[0])]
        print_table_row(f"{q:.2g}", f"{f:.1f}", f"{100 * zeta:.2f}", *cells, f"{viscous / zeta:.2f}")


def print_meshes():
    """Print the first frequency of small motions on other meshes, with the law `roughness`."""
    law, preload = laws()["roughness"], data()["beam"]["preload"]
    print_table_head("Meshes", "near holes [mm]", "far [mm]", "layers", "patches", "f1 [Hz]")
    for near, far, layers in ((4e-3, 6e-3, 2), (2.6e-3, 3.6e-3, 2), (2.6e-3, 3.6e-3, 3), (2.6e-3, 3.6e-3, 4)):
        structure = Structure.of(beam(), Fineness(near=near, far=far, layers=layers))
        normal = structure.solve_preload(tabulate_approach(law), preload).stiffness
        springs = np.outer(normal, [law.shear_stiffness_ratio(), law.shear_stiffness_ratio(), 1.0])
        found = spectrum(structure, springs, 1)[0][0]
        print_table_row(f"{1e3 * near:g}", f"{1e3 * far:g}", layers, normal.size, f"{found:.2f}")


def print_scanned_form():
    """Print results with the scanned form of the lap and published friction, next to the published curve."""
    found = reduced_joints(Structure.of(beam(), Fineness()), form())
    friction, small = data()["published"]["friction"], published("curved").frequency[0]
    print_table_head(
        "With the scanned form", "interface", "f1", "miss [%]", "share of the lap that carries 90 %"
    )
    for name, joint in found.items():
        pressure = joint.sliders.pressure_curve.derivatives(joint.beam.approach, 0)[0]
        order = np.argsort(-pressure)
        force, area = (np.cumsum(each[order]) for each in (joint.beam.area * pressure, joint.beam.area))
        carries = area[np.searchsorted(force, 0.9 * force[-1])] / area[-1]
        f = joint.beam.frequency
        print_table_row(name, f"{f:.1f}", f"{100 * (f / small - 1):+.2f}", f"{carries:.2f}")
    curves_ = {
        name: masing_curves(with_friction(joint, friction), slice(None))[1] for name, joint in found.items()
    }
    print_beside_published(curves_, "curved", small)


def print_plane_faces(images=False):
    """Print predictions with plane faces, next to the published curves."""
    structure = Structure.of(beam(), Fineness())
    mass = sum(body.mass_matrix.sum() for body in structure.bodies) * 2.0 / 3.0
    nodes = sum(body.unknown_count for body in structure.bodies) // 3
    print(
        f"{mass:.3f} kg, {nodes} nodes and {structure.interface.quadrature_area.size} patches in half "
        "the width"
    )
    found = reduced_joints(structure)
    glued = print_linear_frequencies(structure, found)
    ours, theirs = found["roughness"], with_friction(found["published"], data()["published"]["friction"])
    prediction, simple = curves(ours)
    print_over_amplitude(
        f"Predicted: law roughness, friction {FRICTION_COEFFICIENT}", prediction, simple, ours
    )
    same, simple = curves(theirs)
    print_over_amplitude("With the published contact law and friction", same, simple, theirs)
    others = {friction: masing_curves(with_friction(ours, friction))[1] for friction in OTHER_COEFFICIENTS}
    print_table_head("Other friction, law roughness, by Masing's rules: f [Hz], zeta [%]", "q", *others)
    for q in AMPLITUDES[CYCLE_AMPLITUDES]:
        pairs = (curve.at(q) for curve in others.values())
        print_table_row(f"{q:.2e}", *(f"{f:.2f}, {100 * zeta:.3f}" for f, zeta in pairs))
    both = {"predicted": prediction, "published law and friction": same}
    for name in ("flat", "curved"):
        print_beside_published(both, name, glued)
    if images:
        draw_curves(both)


def draw_curves(both):
    """Draw frequency and damping over amplitude into docs/images."""
    viscous = data()["published"]["viscous"]
    with plots.open_figure(IMAGES / "brake_reuss.svg", (9.6, 3.8)) as figure:
        left, right = figure.subplots(1, 2)
        for (name, curve), color in zip(both.items(), (plots.BLUE, plots.RED), strict=True):
            left.plot(curve.q, curve.frequency, "o-", color=color, ms=3, label=name)
            right.plot(curve.q, 100.0 * (curve.damping + viscous), "o-", color=color, ms=3, label=name)
        for name, style in (("flat", "k-"), ("curved", "k--")):
            curve = published(name)
            left.plot(curve.q, curve.frequency, style, lw=1, label=f"published, {name}")
            right.plot(curve.q, 100.0 * curve.damping, style, lw=1, label=f"published, {name}")
        left.set(xscale="log", xlabel="modal amplitude [m kg$^{1/2}$]", ylabel="first frequency [Hz]")
        right.set(
            xscale="log", yscale="log", xlabel="modal amplitude [m kg$^{1/2}$]", ylabel="damping ratio [%]"
        )
        left.legend(fontsize=8)


# measured-beam

UNKNOWN = {
    "preload [N]": (3e3, 13e3, False),
    "friction [1]": (0.1, 0.3, False),
    "Ra of each face [m]": (0.4e-6, 3.2e-6, True),
    "Young's modulus [Pa]": (190e9, 210e9, False),
    "crown of both faces together [m]": (-25e-6, 25e-6, False),
}
"""Uncertain properties: (smallest value, largest value, whether uniform in the logarithm). Bolts of 5/16 inch
at 5 to 20 N.m with a nut factor of 0.2; friction as the default of `jointfmu new` (VDI 2230); machined faces;
stainless to carbon steel; an assumed flatness: a crown touches in the middle first, a hollow (< 0) at the
ends."""
SAMPLES, SEED = 20, 1
MESH = Fineness(near=4e-3, far=6e-3, layers=2)
DENSITY = 7850.0
MEASURED_AMPLITUDES = np.geomspace(1e-6, 4e-4, 12)
"""Modal amplitudes q [m kg^0.5] of the linear beam under the loads."""
BAND = (0.05, 0.5, 0.95)


def draw_samples():
    """Latin hypercube samples (SAMPLES, unknowns) of the uncertain properties."""
    low, high, log = (np.array(column) for column in zip(*UNKNOWN.values(), strict=True))
    even = qmc.LatinHypercube(len(UNKNOWN), rng=SEED).random(SAMPLES)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(log, low * np.abs(high / low) ** even, low + even * (high - low))


def predict_measured_beam(one, preload, friction, Ra, modulus, height):
    """Frequency [Hz] of small motions, damping ratios at the measured accelerations, decrease of the
    frequency [1]."""
    known, entries = measured("measured_beam"), data()
    one = replace(one, E=modulus)
    law = joint_law({"E": modulus, "nu": one.nu, "A_0": entries["A_0"], "Rq": 1.25 * Ra}, H=entries["H"])
    curve, shear = tabulate_approach(law), float(law.shear_stiffness_ratio())
    part = reduce_beam(Structure.of(one, MESH), curve, preload, shear, crown(height, one.lap))
    joint = Joint(part, foundation(curve, shear, friction))
    states = joint.backbone(MEASURED_AMPLITUDES)
    f = np.array([frequency(state) for state in states])
    ratios = [damping(*pair) for pair in zip(masing_losses(states), states, strict=True)]
    peaks = np.array([state.q for state in states]) * part.tip * (2.0 * np.pi * f) ** 2
    at = np.log(known["acceleration"])
    zeta = np.exp(np.interp(at, np.log(peaks), np.log(ratios)))
    first, last = np.interp(at[[0, -1]], np.log(peaks), f)
    return [part.frequency, *zeta, 1.0 - last / first]


def print_measured_beam():
    """Print median and 90 % band of the prediction, the measurement, and a solid bar without loss."""
    known = measured("measured_beam")
    one = replace(beam(), side=known["thickness"], width=known["width"], density=DENSITY)
    rows = []
    for draw in track_progress(draw_samples(), "samples"):
        rows.append(predict_measured_beam(one, *draw))
        print("  ".join(f"{value:.4g}" for value in (*draw, *rows[-1])), file=sys.stderr, flush=True)
    low, middle, high = np.quantile(np.array(rows), BAND, axis=0)
    names = ["f [Hz]", *(f"zeta at {a:g} m/s2 [%]" for a in known["acceleration"]), "fall of f [%]"]
    facts = [known["frequency"], *known["damping"], known["fall"]]
    guesses = [solid_bar_frequency(one), 0.0, 0.0, 0.0, 0.0]
    columns = (
        "measured",
        "5 %",
        "median",
        "95 %",
        "measured inside",
        "width of the band",
        "solid bar, no loss",
    )
    print_table_head("", "", *columns)
    for name, fact, *band, guess in zip(names, facts, low, middle, high, guesses, strict=True):
        scale = 100.0 if "%" in name else 1.0
        cells = [f"{scale * value:.4g}" for value in (fact, *band)]
        width = f"{band[2] / band[0] - 1.0:.1%}" if "Hz" in name else f"a factor of {band[2] / band[0]:.1f}"
        inside = "yes" if band[0] <= fact <= band[2] else "no"
        print_table_row(name, *cells, inside, width, f"{scale * guess:.4g}")
