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
from ..systems.decays import FREQUENCY_TOLERANCE, Decay
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
FLAVOUR_TOLERANCE = 1e-9
"""Allowed deviation [1] between two builds of an FMU (FMI 2.0, FMI 3.0, Python): round-off in the inversion
of the same law."""


@dataclass(frozen=True, slots=True)
class Check:
    """Result of one numerical check of an FMU.

    compared_quantity : what is compared
    deviation         : largest relative deviation [1]
    tolerance         : allowed deviation [1]
    """

    fmu: str
    compared_quantity: str
    deviation: float
    tolerance: float

    @property
    def is_passed(self) -> bool:
        """Whether the deviation of the check is within its tolerance; False for NaN."""
        return bool(self.deviation <= self.tolerance)


def run_default_ramp(fmu_name: str, fmu_folder: Path, step_factor: float = 1.0) -> ramp.RampResult:
    """Run the default load ramp of an FMU, with its step times a factor."""
    r = MODELS[fmu_name].ramp
    return ramp.run_ramp(
        fmu_folder / f"{fmu_name}.fmu", r.input_name, r.end_value, r.value_step * step_factor
    )


def check_ramp(fmu_name: str, fmu_folder: Path, ramp_result: ramp.RampResult) -> list[Check]:
    """Check the ramp of an FMU: repeat it with larger steps, then run the check that its joint defines."""
    worst = _coarse_ramp_deviation(fmu_name, fmu_folder, ramp_result)
    checks = [
        Check(
            fmu_name,
            "ten times larger steps, every output at the shared points",
            worst,
            COARSE_STEP_TOLERANCE,
        )
    ]
    module = load_tool_module(KINDS[MODELS[fmu_name].joint], "checks")
    if module and fmu_name in module.RAMP_CHECKS:
        compared, largest = module.RAMP_CHECKS[fmu_name](fmu_folder, ramp_result)
        checks.append(Check(fmu_name, compared, largest, INTEGRATION_TOLERANCE))
    return checks


def compare_flavour(fmu_name: str, fmu_folder: Path, expected_ramp: ramp.RampResult) -> Check:
    """Compare `expected_ramp` with the ramp of the same FMU in another folder (FMI 3.0 or Python).

    The ramp in the other folder has ten times larger steps.
    """
    worst = _coarse_ramp_deviation(fmu_name, fmu_folder, expected_ramp)
    return Check(fmu_name, f"flavour {fmu_folder.name}: every output the same", worst, FLAVOUR_TOLERANCE)


def _coarse_ramp_deviation(fmu_name: str, fmu_folder: Path, ramp_result: ramp.RampResult) -> float:
    """Largest deviation [1] of any output if the load ramp has ten times larger steps.

    ramp_result : load ramp with the default steps
    """
    coarse = run_default_ramp(fmu_name, fmu_folder, _COARSE_STEP_FACTOR).columns
    return max(
        relative_deviation(coarse[column], fine[:: int(_COARSE_STEP_FACTOR)])
        for column, fine in ramp_result.columns.items()
    )


def check_free_vibrations(vibrations: Mapping[str, Sequence[FreeVibration]]) -> list[Check]:
    """Compare simulated free vibrations with stiffness and damping of the joint."""
    checks = []
    for name, rings in vibrations.items():
        frequency = max(abs(r.frequency / r.expected_frequency - 1.0) for r in rings)
        checks.append(Check(name, "resonance against sqrt(K/J)", frequency, RESONANCE_TOLERANCE))
        damping = [abs(r.damping / r.expected_damping - 1.0) for r in rings if r.is_damped]
        if damping:
            text = "free decay against the stated damping"
            checks.append(Check(name, text, max(damping), DAMPING_TOLERANCE))
    return checks


def check_decays(decays: Mapping[str, Sequence[Decay]]) -> list[Check]:
    """Compare frequency and damping of ring-downs with stiffness and loss of the loops."""
    checks = []
    for name, simulated in decays.items():
        frequency = max(float(np.max(np.abs(d.frequency / d.expected_frequency - 1.0))) for d in simulated)
        damping = max(float(np.max(np.abs(d.damping / d.expected_damping - 1.0)[1:])) for d in simulated)
        checks.append(Check(name, "ring-down, frequency against loops", frequency, FREQUENCY_TOLERANCE))
        checks.append(Check(name, "ring-down, damping against loops", damping, LOOP_DAMPING_TOLERANCE))
    return checks


def integrate_logarithmically(integrand: Callable[[Array], Array], interval_ends: Iterable[float]) -> Array:
    """Integrals of `integrand` between neighbouring ends > 0, by Simpson's rule over the logarithm.

    The results are within 1e-8 of an adaptive rule, also for a law with a kink.
    """
    values = []
    for pair in pairwise(interval_ends):
        points = np.geomspace(*pair, _SIMPSON_INTERVALS + 1)
        values.append(simpson(points * integrand(points), dx=np.log(pair[1] / pair[0]) / _SIMPSON_INTERVALS))
    return np.array(values)


def relative_deviation(value: object, expected_value: object) -> float:
    """Largest difference of values from expected values, over the largest expected value [1].

    If all expected values are zero: the largest |value|.
    """
    a, b = np.asarray(value), np.asarray(expected_value)
    scale = float(np.max(np.abs(b)))
    return float(np.max(np.abs(a - b))) / scale if scale > 0.0 else float(np.max(np.abs(a)))


def compute_published_points(fmu_folder: Path) -> list[ValidatedPoint]:
    """Compute published points by running FMUs, with `compute_through_fmu` of the joints that define it."""
    rows = []
    for kind in KINDS.values():
        compute: FmuEvaluation | None = getattr(load_tool_module(kind, "checks"), "compute_through_fmu", None)
        if compute is None:
            continue
        for point in (p for paper in load_published_numbers(kind).papers for p in read_points(paper)):
            value = compute(point, fmu_folder)
            if value is not None:
                rows.append(compare_point(point, value))
    return rows
