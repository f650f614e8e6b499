"""Numerical checks of the FMUs: load ramps, resonances, decays, and published values."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from scipy.integrate import simpson

from jointfmu.joints import KINDS, MODELS
from jointfmu.quantity import Array

from ..common.joint_parts import load_tool_module
from ..run.ramps import ramp
from ..systems.decays import DAMPING_TOLERANCE as LOOP_DAMPING_TOLERANCE
from ..systems.decays import FREQUENCY_TOLERANCE, FreeDecay
from ..systems.ringing import DAMPING_TOLERANCE, RESONANCE_TOLERANCE, FreeVibration
from .published.computed import load_published_numbers
from .published.reference import PublishedPoint, read_points
from .published.validation import ValidatedPoint, compare_point

_COARSE_STEP_FACTOR = 10.0
"""Step of the repeated load ramp over the step of the default ramp [1]."""
_SIMPSON_INTERVALS = 10_000
"""Number of intervals of the Simpson rule between two ends of an integral [1]."""
FmuEvaluation = Callable[[PublishedPoint, Path], float | None]
"""(published point, folder of the FMUs) -> value computed by an FMU; None if no FMU has this quantity."""
INTEGRATION_TOLERANCE = 1e-6
"""Allowed deviation [1] of an FMU from an independent integration of its stiffness."""
COARSE_STEP_TOLERANCE = 1e-9
"""Allowed deviation [1] of an FMU between ten times larger steps and the default ones, at the same loads."""
BUILD_VARIANT_TOLERANCE = 1e-9
"""Allowed deviation [1] between two builds of an FMU (FMI 2.0, FMI 3.0, Python): round-off in the inversion
of the same law."""


@dataclass(frozen=True, slots=True)
class FmuCheck:
    """Result of one numerical check of an FMU.

    compared_quantity : what is compared
    deviation         : largest relative deviation [1]
    tolerance         : allowed deviation [1]
    """

    fmu_name: str
    compared_quantity: str
    deviation: float
    tolerance: float

    @property
    def is_passed(self) -> bool:
        """Whether the deviation of the check is within its tolerance; False for NaN."""
        return bool(self.deviation <= self.tolerance)


def run_default_ramp(fmu_name: str, fmu_folder: Path, step_factor: float = 1.0) -> ramp.RampResult:
    """Run the default load ramp of an FMU, with its load step multiplied by a factor."""
    r = MODELS[fmu_name].ramp
    return ramp.run_ramp(
        fmu_folder / f"{fmu_name}.fmu", r.input_name, r.end_value, r.value_step * step_factor
    )


def check_ramp(fmu_name: str, fmu_folder: Path, ramp_result: ramp.RampResult) -> list[FmuCheck]:
    """Check a load ramp of an FMU: with ten times larger steps, the outputs must be equal.

    Then run the check that the joint defines for its FMU.
    """
    worst = _compute_coarse_ramp_deviation(fmu_name, fmu_folder, ramp_result)
    checks = [
        FmuCheck(
            fmu_name,
            "ten times larger steps, every output at the shared points",
            worst,
            COARSE_STEP_TOLERANCE,
        )
    ]
    module = load_tool_module(KINDS[MODELS[fmu_name].joint], "checks")
    if module and fmu_name in module.RAMP_CHECKS:
        compared, largest = module.RAMP_CHECKS[fmu_name](fmu_folder, ramp_result)
        checks.append(FmuCheck(fmu_name, compared, largest, INTEGRATION_TOLERANCE))
    return checks


def compare_build_variant(fmu_name: str, fmu_folder: Path, expected_ramp: ramp.RampResult) -> FmuCheck:
    """Compare the load ramps of two builds of an FMU; the second ramp has ten times larger steps.

    fmu_folder    : folder of the second build (FMI 3.0 or Python)
    expected_ramp : load ramp of the first build (FMI 2.0)
    """
    worst = _compute_coarse_ramp_deviation(fmu_name, fmu_folder, expected_ramp)
    return FmuCheck(
        fmu_name, f"flavour {fmu_folder.name}: every output the same", worst, BUILD_VARIANT_TOLERANCE
    )


def _compute_coarse_ramp_deviation(fmu_name: str, fmu_folder: Path, ramp_result: ramp.RampResult) -> float:
    """Largest deviation [1] of any output if the load ramp has ten times larger steps.

    ramp_result : load ramp with the default steps
    """
    coarse = run_default_ramp(fmu_name, fmu_folder, _COARSE_STEP_FACTOR).variable_columns
    return max(
        relative_deviation(coarse[column], fine[:: int(_COARSE_STEP_FACTOR)])
        for column, fine in ramp_result.variable_columns.items()
    )


def check_free_vibrations(free_vibrations: Mapping[str, Sequence[FreeVibration]]) -> list[FmuCheck]:
    """Compare frequency and damping of free vibrations with sqrt(K/J) and the damping of the joint."""
    checks = []
    for name, rings in free_vibrations.items():
        frequency = max(abs(r.frequency / r.expected_frequency - 1.0) for r in rings)
        checks.append(FmuCheck(name, "resonance against sqrt(K/J)", frequency, RESONANCE_TOLERANCE))
        damping = [abs(r.damping / r.expected_damping - 1.0) for r in rings if r.is_damped]
        if damping:
            text = "free decay against the stated damping"
            checks.append(FmuCheck(name, text, max(damping), DAMPING_TOLERANCE))
    return checks


def check_decays(free_decays: Mapping[str, Sequence[FreeDecay]]) -> list[FmuCheck]:
    """Compare frequency and damping of free decays with stiffness and loss of the hysteresis loops."""
    checks = []
    for name, simulated in free_decays.items():
        frequency = max(float(np.max(np.abs(d.frequency / d.expected_frequency - 1.0))) for d in simulated)
        damping = max(float(np.max(np.abs(d.damping / d.expected_damping - 1.0)[1:])) for d in simulated)
        checks.append(FmuCheck(name, "ring-down, frequency against loops", frequency, FREQUENCY_TOLERANCE))
        checks.append(FmuCheck(name, "ring-down, damping against loops", damping, LOOP_DAMPING_TOLERANCE))
    return checks


def integrate_logarithmically(integrand: Callable[[Array], Array], interval_ends: Iterable[float]) -> Array:
    """Integrate a function over successive intervals, by Simpson's rule in the logarithm of its argument.

    interval_ends : n + 1 ends > 0 of the n intervals

    The n integrals are within 1e-8 of an adaptive rule, also for an integrand with a kink.
    """
    values = []
    for pair in pairwise(interval_ends):
        points = np.geomspace(*pair, _SIMPSON_INTERVALS + 1)
        values.append(simpson(points * integrand(points), dx=np.log(pair[1] / pair[0]) / _SIMPSON_INTERVALS))
    return np.array(values)


def relative_deviation(computed_values: object, expected_values: object) -> float:
    """Largest |computed - expected value| over the largest |expected value| [1].

    If all expected values are zero: the largest |computed value|.
    """
    a, b = np.asarray(computed_values), np.asarray(expected_values)
    scale = float(np.max(np.abs(b)))
    return float(np.max(np.abs(a - b))) / scale if scale > 0.0 else float(np.max(np.abs(a)))


def compute_published_numbers(fmu_folder: Path) -> list[ValidatedPoint]:
    """Compute published numbers by running FMUs, for the joints that define `compute_through_fmu`."""
    rows = []
    for kind in KINDS.values():
        compute: FmuEvaluation | None = getattr(load_tool_module(kind, "checks"), "compute_through_fmu", None)
        if compute is None:
            continue
        for point in (p for paper in load_published_numbers(kind).paper_names for p in read_points(paper)):
            value = compute(point, fmu_folder)
            if value is not None:
                rows.append(compare_point(point, value))
    return rows
