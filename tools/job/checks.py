"""The load ramps through the FMUs, and what must hold of them."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from scipy.integrate import simpson

from jointfmu.joints import KINDS, MODELS
from jointfmu.quantity import Array

from ..joint_parts import part
from ..published.computed import published
from ..published.reference import Point, points
from ..published.validation import ValidatedPoint, compare
from ..ramps import ramp
from ..systems.decays import DAMPING_TOLERANCE as LOOP_DAMPING_TOLERANCE
from ..systems.decays import FREQUENCY_TOLERANCE, Decay
from ..systems.ringing import DAMPING_TOLERANCE, RESONANCE_TOLERANCE, Ringing

_COARSE = 10.0
"""Step of a ramp that is repeated, over its own [1]."""
_INTERVALS = 10_000
"""Of an integral [1]."""
ThroughFmu = Callable[[Point, Path], float | None]
"""A published point and the folder of the FMUs -> what they give, None where they do not show it."""
INTEGRATION_TOLERANCE = 1e-6
"""FMU against an independent integration of its stiffness [1]."""
REPEAT_TOLERANCE = 1e-9
"""FMU at ten times larger steps against the same points [1]."""
FLAVOUR_TOLERANCE = 1e-9
"""One flavour against another [1]: both evaluate the same law, to the round-off of its inversion."""


@dataclass(frozen=True, slots=True)
class Check:
    """One check of a ramp: largest relative deviation, what is allowed."""

    fmu: str
    name: str
    deviation: float
    allowed: float

    @property
    def passed(self) -> bool:
        """Whether the deviation is a number and small enough."""
        return bool(self.deviation <= self.allowed)


def default_ramp(name: str, folder: Path, factor: float = 1.0) -> ramp.RampResult:
    """The FMU's own load ramp, steps enlarged by a factor."""
    r = MODELS[name].ramp
    return ramp.run(folder / f"{name}.fmu", r.input, r.end, r.step * factor)


def check(name: str, folder: Path, result: ramp.RampResult) -> list[Check]:
    """All checks of an FMU's ramp: its own, RAMPS[name] in its joint's file, after those of every FMU."""
    worst = _repeated(name, folder, result)
    checks = [
        Check(name, "ten times larger steps, every output at the shared points", worst, REPEAT_TOLERANCE)
    ]
    own = part(KINDS[MODELS[name].joint], "checks")
    if own and name in own.RAMPS:
        compared, largest = own.RAMPS[name](folder, result)
        checks.append(Check(name, compared, largest, INTEGRATION_TOLERANCE))
    return checks


def same(name: str, folder: Path, expected: ramp.RampResult) -> Check:
    """The ramp of another flavour, at ten times larger steps, against that expected at the shared points."""
    worst = _repeated(name, folder, expected)
    return Check(name, f"flavour {folder.name}: every output the same", worst, FLAVOUR_TOLERANCE)


def _repeated(name: str, folder: Path, result: ramp.RampResult) -> float:
    """Largest deviation [1] of the ramp at ten times larger steps, of all columns at the shared points."""
    coarse = default_ramp(name, folder, _COARSE).columns
    return max(deviation(coarse[column], fine[:: int(_COARSE)]) for column, fine in result.columns.items())


def check_ringing(systems: Mapping[str, Sequence[Ringing]]) -> list[Check]:
    """Simulated free motion against stiffness and damping of the joint."""
    checks = []
    for name, rings in systems.items():
        frequency = max(abs(r.frequency / r.expected - 1.0) for r in rings)
        checks.append(Check(name, "resonance against sqrt(K/J)", frequency, RESONANCE_TOLERANCE))
        damping = [abs(r.damping / r.stated - 1.0) for r in rings if r.damped]
        if damping:
            said = "free decay against the stated damping"
            checks.append(Check(name, said, max(damping), DAMPING_TOLERANCE))
    return checks


def check_decays(systems: Mapping[str, Sequence[Decay]]) -> list[Check]:
    """Ring-downs over the falling amplitude against the energy of the joint's loops."""
    checks = []
    for name, found in systems.items():
        frequency = max(float(np.max(np.abs(d.frequency / d.expected - 1.0))) for d in found)
        damping = max(float(np.max(np.abs(d.damping / d.stated - 1.0)[1:])) for d in found)
        checks.append(Check(name, "ring-down, frequency against loops", frequency, FREQUENCY_TOLERANCE))
        checks.append(Check(name, "ring-down, damping against loops", damping, LOOP_DAMPING_TOLERANCE))
    return checks


def integrals(rate: Callable[[Array], Array], ends: Iterable[float]) -> Array:
    """Of a rate (n) at points (n) between neighbouring ends > 0, by scipy's Simpson rule over the logarithm.

    Against an adaptive rule: within 1e-8, also where a law has a kink.
    """
    found = []
    for pair in pairwise(ends):
        points = np.geomspace(*pair, _INTERVALS + 1)
        found.append(simpson(points * rate(points), dx=np.log(pair[1] / pair[0]) / _INTERVALS))
    return np.array(found)


def deviation(value: object, expected: object) -> float:
    """Largest difference over the largest expected value [1]; the value itself where zeros are."""
    a, b = np.asarray(value), np.asarray(expected)
    scale = float(np.max(np.abs(b)))
    return float(np.max(np.abs(a - b))) / scale if scale > 0.0 else float(np.max(np.abs(a)))


def published_through_fmus(folder: Path) -> list[ValidatedPoint]:
    """The published points that an FMU can show, computed by running the FMU: `through_fmu` of its joint."""
    rows = []
    for kind in KINDS.values():
        through: ThroughFmu | None = getattr(part(kind, "checks"), "through_fmu", None)
        if through is None:
            continue
        for point in (p for paper in published(kind).papers for p in points(paper)):
            value = through(point, folder)
            if value is not None:
                rows.append(compare(point, value))
    return rows
