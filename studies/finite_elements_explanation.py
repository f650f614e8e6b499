"""Figures of docs/finite_elements_explanation.md: pressure and natural frequencies of the box specimen (Zhao
2018).

    python studies/finite_elements_explanation.py [SECTION ...]

convergence : pressure, time and memory on finer and finer meshes at 9 kN per bolt
lengths     : influence of the lengths on the pressure
preload     : shape of the pressure over the preload
frequencies : the frequencies of Table 3, the choices of the law, a finer mesh, f1 over the preload; --plot
              FILE
identify    : as `frequencies`, with lengths fitted anew to the frequencies at 9 kN (on request)
search      : fits from random lengths by choice of the law; --fits N, --seed S (on request)

Published for 9 kN per bolt (section 3): 7.98 MPa near a hole, 0.62 MPa midway between bolts.
"""

import argparse
import resource
import time
from collections.abc import Iterator
from dataclasses import replace
from importlib.resources import files
from pathlib import Path
from typing import Any

import box_specimen_search
import numpy as np
from common import run_study
from jointfmu_tools.common import plots
from jointfmu_tools.fem import convergence
from jointfmu_tools.fem.assembly import read_assembly
from jointfmu_tools.fem.bolted_contact import SECOND_FIELD_OVER_UNLOADING_MOMENT, BoltedContact, JointSolution
from jointfmu_tools.fem.geometry import Assembly, BoxSection
from jointfmu_tools.studies.published.reference import POINT_ROLES, read_points
from numpy.typing import NDArray
from oracles import box_specimen as box

from jointfmu.mechanics.curve import Curve, tabulate_approach
from jointfmu.parameters import load_default

Array = NDArray[np.float64]

# convergence, lengths, preload

PRELOAD = 9e3
MESH_COUNT = 4
BOX = Path(str(files("jointfmu_models") / "assemblies" / "box_specimen.toml"))


class HardContact:
    """Contact law without roughness: its stiffness [Pa/m] is 300 times the stiffness of the law at 1 MPa."""

    def __init__(self, stiffness: float = 1e14) -> None:
        self.stiffness = stiffness

    def derivatives(self, x: Any, order: int = 1) -> list[Any]:
        return [self.stiffness * np.maximum(x, 0.0), np.where(x > 0.0, self.stiffness, 0.0)]

    def inverse(self, load: Any) -> Any:
        return load / self.stiffness


def interface_law(assembly: Assembly) -> Curve:
    """Interface law of Zhao 2018 with the contact area of an assembly."""
    return tabulate_approach(replace(load_default("bolted_joint").values, A_0=assembly.contact_area))


def print_meshes(assembly: Assembly) -> None:
    """Print time and memory for joints with equal and with different bodies, and results on MESH_COUNT
    meshes."""
    other = replace(assembly, side1=replace(assembly.side1, E=1.01 * assembly.side1.E))
    for name, one in (("two equal bodies", assembly), ("two different bodies", other)):
        start, cpu = time.perf_counter(), time.process_time()
        joint = BoltedContact.from_assembly(one)
        solution = joint.solve_equilibrium(interface_law(one), PRELOAD)
        steps = solution.contact_solution.newton_steps
        seconds, cpu = time.perf_counter() - start, time.process_time() - cpu
        memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
        unknowns = sum(body.unknown_count for body in joint.bodies)
        print(f"{name}, {unknowns} unknowns: {seconds:.1f} s, {cpu:.1f} s of processor time, ", end="")
        print(f"{memory:.2f} GB, {steps} steps of Newton's method", flush=True)
        start = time.process_time()
        steps = solution.solve_load_case(
            PRELOAD, SECOND_FIELD_OVER_UNLOADING_MOMENT * one.max_moment(PRELOAD)
        ).contact_solution.newton_steps
        print(f"with a moment, from there: {time.process_time() - start:.1f} s, {steps} steps", flush=True)
    rows, _ = convergence.run_mesh_study(
        assembly, interface_law(assembly), PRELOAD, 0.0, convergence.refinement_series(MESH_COUNT)
    )
    for row in rows:
        values = "  ".join(f"{name} {row.result_values[name]:.6g}" for name in convergence.RESULT_UNITS)
        print(f"refinement {row.refinement:.2f}, {row.unknown_count} unknowns: {values}")
    for change in convergence.relative_changes(rows):
        print(
            "change [%]:", "  ".join(f"{name} {100 * change[name]:.3f}" for name in convergence.RESULT_UNITS)
        )
    print("order:", {name: round(value, 1) for name, value in convergence.observed_orders(rows).items()})


def format_pressures(solution: JointSolution) -> str:
    """Format the peak pressure and the pressures midway between the bolts of a row and of a side [MPa]."""
    places, between = solution.pressure_between_bolts
    row = between[np.abs(places[:, 1]) > 0.14].mean() / 1e6
    side = between[np.abs(places[:, 1]) < 0.14].mean() / 1e6
    return f"peak {solution.peak_pressure / 1e6:6.2f}  row {row:6.3f}  side {side:6.3f}"


def changed_boxes(assembly: Assembly) -> Iterator[tuple[str, Assembly]]:
    """Assemblies with one changed length each, and names of the changes."""
    yield "default", assembly
    changes: list[dict[str, float]] = [
        *({"flange_thickness": t} for t in (0.015, 0.018, 0.022, 0.025, 0.03)),
        *({"flange_width": w} for w in (0.07, 0.08)),
        *({"wall": w, "flange_width": 0.04 + w} for w in (0.01, 0.015)),
        *({"height": h} for h in (0.1, 0.3)),
        {"floor": 0.02},
        *({"length": 0.24 + 2 * e, "width": 0.34 + 2 * e, "wall_inset": 0.04 + e, "flange_width": 0.06 + e}
          for e in (0.005, 0.01)),
        {"length": 0.28, "width": 0.38, "wall_inset": 0.0},
    ]  # fmt: skip
    box = assembly.side2
    assert isinstance(box, BoxSection)
    for change in changes:
        one = replace(box, **change)
        yield ", ".join(f"{k} {v:g}" for k, v in change.items()), replace(assembly, side1=one, side2=one)
    for head in (0.022, 0.03):
        yield f"head_diameter {head:g}", replace(assembly, bolts=replace(assembly.bolts, head_diameter=head))


def print_lengths(assembly: Assembly) -> None:
    """Print the influence of the lengths on the peak pressure and on the pressure between bolts."""
    print("published: peak 7.98, between 0.62 MPa")
    hard = BoltedContact.from_assembly(assembly).solve_equilibrium(HardContact(), PRELOAD)
    print(f"{format_pressures(hard)}  default, hard contact", flush=True)
    for name, changed in changed_boxes(assembly):
        solution = BoltedContact.from_assembly(changed).solve_equilibrium(interface_law(changed), PRELOAD)
        print(f"{format_pressures(solution)}  {name}", flush=True)


def print_preloads(assembly: Assembly) -> None:
    """Print the shape p/p_mean of the pressure for several preloads."""
    joint, curve = BoltedContact.from_assembly(assembly), interface_law(assembly)
    first: Any = None
    for force in (9e3, 15e3, 24e3):
        solution = joint.solve_equilibrium(curve, force)
        field = solution.contact_field
        shape = field.nodal_pressure / (field.normal_force / field.nodal_area.sum())
        first = shape if first is None else first
        change = np.sqrt(field.nodal_area @ (shape - first) ** 2 / (field.nodal_area @ first**2))
        mean = field.normal_force / field.nodal_area.sum()
        print(
            f"{force / 1e3:g} kN: peak/mean {solution.peak_pressure / mean:.3f}, "
            f"{format_pressures(solution)} MPa, shape differs from 9 kN by {100 * change:.2f} % rms"
        )


# frequencies

MARKERS = {
    "calibration": {"marker": "o", "mfc": "white"},
    "circular": {"marker": "x"},
    "interpolation": {"marker": "D", "mfc": "white"},
    "prediction": {"marker": "o"},
}
"""{role of a published number: marker}; filled markers are predictions."""
STATES = [(9e3, 0.0), (15e3, 0.0), (15e3, 4500.0)]
NAMES = ("9 kN", "15 kN", "15 kN, 4500 N m")
PAPER = {
    "non-uniform": [
        [531.74, 640.83, 834.67, 863.05, 1299.8, 1408.7],
        [555.26, 641.8, 854.63, 872.8, 1319.8, 1407.5],
        [551.81, 637.53, 836.72, 878.42, 1308.1, 1416.8],
    ],
    "uniform": [
        [556.5, 613.21, 840.12, 830.64, 1250.63, 1441.49],
        [588.61, 619.16, 835.20, 838.19, 1263.35, 1467.82],
        [588.61, 619.16, 835.20, 838.19, 1263.35, 1467.82],
    ],
}
"""Frequencies [Hz] of the paper's own models (Table 3)."""
CHOICES = [("continuity", "family"), ("continuity", "hertz"), ("printed", "family"), ("printed", "hertz")]
PRELOADS = np.array([3e3, 6e3, 9e3, 12e3, 15e3, 18e3, 21e3, 24e3, 27e3, 30e3, 36e3])
START = (0.327, 0.257, 0.0192, 0.052, 0.036)
"""Start lengths of the fit [m], near the best ones of `search` with the default law."""


def published_mark(role: str, colour: str = "black") -> dict[str, object]:
    """Style and legend of a published number with a role."""
    shape = MARKERS.get(role, {"marker": "+"})
    return {"linestyle": "none", "color": colour, "ms": 5, "label": f"published, {POINT_ROLES[role]}"} | shape


def measured_frequencies() -> Array:
    """Measured frequencies (states, modes) [Hz] of Table 3."""
    at = {
        (p.where["preload"], p.where["moment"], p.where["mode"]): p.value
        for p in read_points("zhao2018_modes")
    }
    return np.array([[at[(*state, mode)] for mode in range(1, 7)] for state in STATES])


def print_numbers(name: str, values: Array, form: str = "8.2f") -> None:
    """Print a name and six numbers."""
    print(f"{name:42s}" + " ".join(f"{value:{form}}" for value in values))


def print_errors(found: Array, even: Array) -> None:
    """Print the errors [%] of the package and of the paper against the measurement."""
    target = measured_frequencies()
    for i, name in enumerate(NAMES):
        print_numbers(f"{name}: measured [Hz]", target[i])
        print_numbers("  computed field [Hz]", found[i])
        print_numbers("  error [%]", 100 * (found[i] / target[i] - 1), "8.1f")
        print_numbers("  uniform pressure, error [%]", 100 * (even[i] / target[i] - 1), "8.1f")
        for kind, values in PAPER.items():
            print_numbers(
                f"  the paper, {kind}, error [%]", 100 * (np.array(values[i]) / target[i] - 1), "8.1f"
            )
    for name, values in (
        ("computed field", found),
        ("uniform pressure", even),
        ("9 kN measured, taken for both others", np.tile(target[0], (3, 1))),
        *((f"the paper, {kind}", np.array(values)) for kind, values in PAPER.items()),
    ):
        error = np.abs(values[1:] / target[1:] - 1)
        within = int(np.sum(error <= 0.051))
        print(f"predicted rows, {name}: largest error {100 * error.max():.1f} %, {within} of 12 within 5.1 %")
    rise = [100 * (values[1] / values[0] - 1) for values in (target, found)]
    print_numbers("rise from 9 to 15 kN, measured [%]", rise[0], "8.1f")
    print_numbers("  computed [%]", rise[1], "8.1f")


def print_law_choices(assembly: Assembly) -> None:
    """Print the increase of the frequencies from 9 to 15 kN for each choice of the law, at equal lengths."""
    joint = load_default("bolted_joint").values
    for area, spot in CHOICES:
        one = replace(joint, critical_area=area, spot_stiffness=spot)
        found = box.frequencies(assembly, one, STATES[:2])
        print_numbers(f"{area}, {spot}: 9 kN [Hz]", found[0])
        print_numbers("  rise to 15 kN [%]", 100 * (found[1] / found[0] - 1), "8.1f")


def print_over_preload(assembly: Assembly, plot: Path | None) -> None:
    """Print the first frequency over the preload (Fig. 12), and draw it if asked for."""
    joint = load_default("bolted_joint").values
    states = [(float(p), 0.0) for p in PRELOADS]
    found, even = (
        box.frequencies(assembly, joint, states, mode_count=1, is_pressure_uniform=e) for e in (False, True)
    )
    for preload, f, g in zip(PRELOADS, found[:, 0], even[:, 0], strict=True):
        print(f"{preload / 1e3:5.0f} kN: f1 {f:8.2f} Hz, with uniform pressure {g:8.2f} Hz")
    slopes = np.diff(found[:, 0]) / np.diff(PRELOADS) * 1e3
    print(f"slope of f1: {slopes[1]:.2f} Hz/kN at 7.5 kN, {slopes[-1]:.2f} Hz/kN at 33 kN")
    if plot:
        target = measured_frequencies()
        with plots.open_figure(plot) as figure:
            axes = figure.subplots()
            axes.plot(PRELOADS / 1e3, found[:, 0], color=plots.BLUE, label="computed field")
            axes.plot(PRELOADS / 1e3, even[:, 0], "--", color=plots.GREY, label="uniform pressure")
            for x, f, role in ((9, target[0, 0], "calibration"), (15, target[1, 0], "prediction")):
                axes.plot(x, f, **published_mark(role, plots.RED))
            axes.set(xlabel="preload per bolt in kN", ylabel="f1 in Hz")
            axes.legend()


def identify_lengths(assembly: Assembly) -> Assembly:
    """Fit the lengths to the measured frequencies at 9 kN."""
    start = box.specimen(assembly, START)
    found = box.identify(start, load_default("bolted_joint").values, STATES[0][0], measured_frequencies()[0])
    for name, value in found.lengths.items():
        print(f"{name:17s} {1e3 * value:7.1f} mm, +- {100 * found.deviation[name]:.0f} %")
    print_numbers("error of the fit [%]", 100 * found.error, "8.1f")
    print_numbers("singular values of the slopes", np.linalg.svd(found.slope)[1], "8.3f")
    return box.specimen(assembly, list(found.lengths.values()))


def print_frequencies(assembly: Assembly, plot: Path | None) -> None:
    """Print the frequencies of an assembly and the measured ones."""
    joint = load_default("bolted_joint").values
    found, even = (box.frequencies(assembly, joint, STATES, is_pressure_uniform=e) for e in (False, True))
    print_errors(found, even)
    fine = box.frequencies(assembly, joint, STATES[:1], refinement=1.0)
    print_numbers("9 kN on elements half as long, change [%]", 100 * (fine[0] / found[0] - 1), "8.2f")
    print_law_choices(assembly)
    print_over_preload(assembly, plot)


def search(options: argparse.Namespace) -> None:
    """Print fits from random start lengths."""
    box_specimen_search.print_fits(measured_frequencies(), STATES, options.fits, options.seed)


if __name__ == "__main__":
    run_study(
        __doc__,
        {
            "convergence": lambda _: print_meshes(read_assembly(BOX)),
            "lengths": lambda _: print_lengths(read_assembly(BOX)),
            "preload": lambda _: print_preloads(read_assembly(BOX)),
            "frequencies": lambda options: print_frequencies(box.shipped(), options.plot),
            "identify": lambda options: print_frequencies(identify_lengths(box.shipped()), options.plot),
            "search": search,
        },
        on_request=("identify", "search"),
        options={
            "--plot": {
                "type": Path,
                "metavar": "FILE",
                "help": "picture to write of f1 over the preload (.png, .svg)",
            },
            "--fits": {"type": int, "default": 5, "help": "search: number of fits of each case (default: 5)"},
            "--seed": {"type": int, "default": 1, "help": "search: seed of the random lengths (default: 1)"},
        },
    )
