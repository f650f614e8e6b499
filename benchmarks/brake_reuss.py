"""The Brake-Reuss beam, blind: first frequency and damping over amplitude from geometry and roughness.

`python benchmarks/brake_reuss.py [--images | --meshes | --form]`

Finite elements for both halves and the bolts, the law of the interface on every patch of the lap, friction by
sliders with memory. Nothing is fitted; what had to be chosen is below and was fixed before any comparison.
"""

import sys
from dataclasses import replace

import numpy as np
from brake_reuss_cases import Curves, beam, data, form, laws, published, solid_bar
from jointfmu_tools.common import plots
from lap_beam_loops import Joint, damping, foundation, frequency, masing
from lap_beam_plan import Fineness
from lap_beam_reduction import Structure, reduced, spectrum
from validity_tables import IMAGES, heading, row

from jointfmu.mechanics.curve import tabulate_approach

FRICTION = 0.15
"""Of dry machined metal, what `jointfmu new` takes where nothing is stated (VDI 2230: 0.1 to 0.3) [1]."""
OTHERS = (0.03, 0.1, 0.3, 0.6)
AMPLITUDES = np.geomspace(1e-7, 1e-4, 13)
"""Modal amplitudes q [m kg^0.5] of the linear beam under the loads."""
TURNS = slice(4, None, 2)
"""Of them, those at which a whole cycle is followed."""
STEPS = 8
"""Of the load, from one end of a cycle to the other."""
GLUED = 1e17
"""Stiffness [N/m3] of a lap that is one piece: as soft as 2 um of steel."""


def joints(structure, gap=None):
    """{law: the reduced beam on its sliders}, of plane faces or with a gap [m] at places x, y."""
    preload, found = data()["beam"]["preload"], {}
    for name, law in laws().items():
        curve, shear = tabulate_approach(law), float(law.shear_stiffness_ratio())
        part = reduced(structure, curve, preload, shear, gap)
        found[name] = Joint(part, foundation(curve, shear, FRICTION))
    return found


def rubbing(joint, friction):
    """The same joint with another coefficient of friction [1]."""
    return replace(joint, sliders=replace(joint.sliders, friction_coefficient=friction))


def curves(joint):
    """The mode at AMPLITUDES[TURNS] with the loss of whole cycles, and by Masing's rules."""
    states, simple = by_masing(joint)
    whole = [damping(joint.cycle(state, STEPS)[0], state) for state in states]
    return replace(simple, damping=np.array(whole)), simple


def by_masing(joint, turns=TURNS):
    """States at AMPLITUDES[turns], and the mode there by Masing's rules."""
    states = joint.backbone(AMPLITUDES)
    ratios = [damping(*pair) for pair in zip(masing(states), states, strict=True)]
    columns = [s.q for s in states], [frequency(s) for s in states], ratios
    return states[turns], Curves(*(np.array(values)[turns] for values in columns))


def linear(structure, found):
    """Frequencies of small motions."""
    count = structure.interface.quadrature_area.size
    heading("Linear frequencies [Hz]", "interface", "f1", "f2", "f3")
    row("solid bar (Timoshenko)", f"{solid_bar(structure.beam):.1f}", "", "")
    glued = spectrum(structure, np.full((count, 3), GLUED))[0]
    row("lap in one piece", *(f"{f:.1f}" for f in glued))
    for name, joint in found.items():
        row(name, *(f"{f:.1f}" for f in joint.beam.frequencies))
    return float(glued[0])


def over_amplitude(title, curve, simple, joint):
    """Table of whole cycles, and of Masing's rules beside."""
    heading(title, "q [m kg^0.5]", "tip [um]", "acceleration [m/s2]", "f [Hz]", "zeta [%]", "by Masing [%]")
    for q, f, zeta, other in zip(curve.q, curve.frequency, curve.damping, simple.damping, strict=True):
        tip = q * joint.beam.tip
        peak = f"{tip * (2.0 * np.pi * f) ** 2:.3g}"
        row(f"{q:.2e}", f"{1e6 * tip:.3g}", peak, f"{f:.2f}", f"{100 * zeta:.3f}", f"{100 * other:.3f}")


def beside(ours, name, glued):
    """Predictions beside a published curve, `flat` or `curved`; all with the published viscous damping.

    The trivial guesses: a lap in one piece, and the published frequency of small motions.
    """
    viscous, theirs = data()["published"]["viscous"], published(name)
    names = [f"{one}: {what}" for one in ours for what in ("f", "miss [%]", "zeta [%]", "ratio")]
    guesses = ("one piece: miss [%]", "constant: miss [%]", "ratio")
    heading(f"Beside the published curve of {name} surfaces", "q", "f [Hz]", "zeta [%]", *names, *guesses)
    for q, f, zeta in zip(theirs.q, theirs.frequency, theirs.damping, strict=True):
        cells = []
        for curve in ours.values():
            found, loss = (float(value) for value in curve.at(q))
            whole = loss + viscous
            cells += [f"{found:.1f}", f"{100 * (found / f - 1):+.1f}"]
            cells += [f"{100 * whole:.2f}", f"{whole / zeta:.2f}"]
        cells += [f"{100 * (one / f - 1):+.1f}" for one in (glued, theirs.frequency[0])]
        row(f"{q:.2g}", f"{f:.1f}", f"{100 * zeta:.2f}", *cells, f"{viscous / zeta:.2f}")


def meshes():
    """First frequency of small motions on other meshes, law `roughness`."""
    law, preload = laws()["roughness"], data()["beam"]["preload"]
    heading("Meshes", "near holes [mm]", "far [mm]", "layers", "patches", "f1 [Hz]")
    for near, far, layers in ((4e-3, 6e-3, 2), (2.6e-3, 3.6e-3, 2), (2.6e-3, 3.6e-3, 3), (2.6e-3, 3.6e-3, 4)):
        structure = Structure.of(beam(), Fineness(near=near, far=far, layers=layers))
        normal = structure.tightened(tabulate_approach(law), preload).stiffness
        springs = np.outer(normal, [law.shear_stiffness_ratio(), law.shear_stiffness_ratio(), 1.0])
        found = spectrum(structure, springs, 1)[0][0]
        row(f"{1e3 * near:g}", f"{1e3 * far:g}", layers, normal.size, f"{found:.2f}")


def with_form():
    """The beam with its scanned form, both laws at the published friction, beside the published curve."""
    found = joints(Structure.of(beam(), Fineness()), form())
    friction, small = data()["published"]["friction"], published("curved").frequency[0]
    heading("With the scanned form", "interface", "f1", "miss [%]", "share of the lap that carries 90 %")
    for name, joint in found.items():
        pressure = joint.sliders.curve.derivatives(joint.beam.approach, 0)[0]
        order = np.argsort(-pressure)
        force, area = (np.cumsum(each[order]) for each in (joint.beam.area * pressure, joint.beam.area))
        carries = area[np.searchsorted(force, 0.9 * force[-1])] / area[-1]
        f = joint.beam.frequency
        row(name, f"{f:.1f}", f"{100 * (f / small - 1):+.2f}", f"{carries:.2f}")
    curves_ = {name: by_masing(rubbing(joint, friction), slice(None))[1] for name, joint in found.items()}
    beside(curves_, "curved", small)


def main():
    """Print everything; `--images` draws the picture."""
    structure = Structure.of(beam(), Fineness())
    mass = sum(body.mass.sum() for body in structure.bodies) * 2.0 / 3.0
    nodes = sum(body.unknown_count for body in structure.bodies) // 3
    print(
        f"{mass:.3f} kg, {nodes} nodes and {structure.interface.quadrature_area.size} patches in half "
        "the width"
    )
    found = joints(structure)
    glued = linear(structure, found)
    ours, theirs = found["roughness"], rubbing(found["published"], data()["published"]["friction"])
    prediction, simple = curves(ours)
    over_amplitude(f"Predicted: law roughness, friction {FRICTION}", prediction, simple, ours)
    same, simple = curves(theirs)
    over_amplitude("With the published contact law and friction", same, simple, theirs)
    others = {friction: by_masing(rubbing(ours, friction))[1] for friction in OTHERS}
    heading("Other friction, law roughness, by Masing's rules: f [Hz], zeta [%]", "q", *others)
    for q in AMPLITUDES[TURNS]:
        pairs = (curve.at(q) for curve in others.values())
        row(f"{q:.2e}", *(f"{f:.2f}, {100 * zeta:.3f}" for f, zeta in pairs))
    both = {"predicted": prediction, "published law and friction": same}
    for name in ("flat", "curved"):
        beside(both, name, glued)
    if "--images" in sys.argv:
        picture(both)


def picture(both):
    """Frequency and damping over amplitude, into docs/images."""
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


if __name__ == "__main__":
    {"--meshes": meshes, "--form": with_form}.get(sys.argv[-1], main)()
