"""What every fit hands back: the parameter file, how well it is determined, and the plotted data."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from jointfmu.contact.roughness import ROUGHEST
from jointfmu.files.timestamp import build_time
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Interval, flat_fields

from .identifiability import combinations, undetermined
from .least_squares import Array, Solution, Unknown

WORST_AREA = 2.0
"""Factor between measured and fitted area of the widest loop beyond which a law is none of these data."""

HEIGHT = "h"
"""Rms height [m] of laws that have one."""

LEAST_GAIN = 0.95
"""Residual of a held-out part over that of a constant [1] from which on a fit says nothing."""


@dataclass(frozen=True, slots=True)
class Picture:
    """Data, fitted curve and misfit over one abscissa, in the units of the labels.

    x, y      : (n) data;  misfit : (n) data minus law
    line      : (m), (m) the law
    marks     : (n) bool, points to stand out
    also      : {name: as line} of further laws
    """

    x: Array
    y: Array
    misfit: Array
    line: tuple[Array, Array]
    labels: tuple[str, str, str]
    marks: NDArray[np.bool_] | None = None
    also: Mapping[str, tuple[Array, Array]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class FitResult:
    """A fit.

    facts : {name: (value, unit, meaning)} beside the parameters
    notes : what the user should know, one line each
    second_picture : drawn beside the first
    more_pictures  : beside these
    intervals : {name: ends of its 95 % interval}, where they are told
    """

    parameters: ParameterFile
    solution: Solution
    facts: Mapping[str, tuple[float, str, str]]
    picture: Picture
    notes: Sequence[str] = ()
    second_picture: Picture | None = None
    more_pictures: Sequence[Picture] = ()
    intervals: Mapping[str, tuple[float, float]] = field(default_factory=dict)

    @property
    def pictures(self) -> list[Picture]:
        """All of them."""
        return [self.picture, *filter(None, (self.second_picture,)), *self.more_pictures]

    def rows(self) -> list[dict[str, Any]]:
        """Every unknown with value, unit, relative standard deviation and whether it is determined."""
        loose, deviations = undetermined(self.solution), self.solution.deviations
        return [
            {
                "name": u.name,
                "value": self.solution.values[u.name],
                "unit": u.unit,
                "relative_deviation": _finite(deviations[u.name]),
                "determined": u.name not in loose,
                **({"interval": list(self.intervals[u.name])} if u.name in self.intervals else {}),
            }
            for u in self.solution.unknowns
        ]

    def doubt(self) -> str | None:
        """Why the fit says nothing of the joint; None if it says something."""
        names = [u.name for u in self.solution.unknowns]
        if names and {*names} == {*self.solution.at_bound}:
            return f"{', '.join(names)} ended on a bound, nothing else was fitted"
        if (height := self.solution.values.get(HEIGHT, 0.0)) > ROUGHEST:
            return (
                f"{HEIGHT} = {1e6 * height:.3g} um is outside (0, {1e6 * ROUGHEST:g}] um: no roughness is as "
                "high; what lies in series with the joint may be missing (--series-stiffness)"
            )
        loose = undetermined(self.solution)
        if names and len(loose) == len(names) and not any(c.determined for c in combinations(self.solution)):
            return f"the data determine none of {', '.join(names)}, nor a combination of them"
        if "loop_area_law" in self.facts:
            measured, law = self.facts["loop_area"][0], self.facts["loop_area_law"][0]
            if not measured / WORST_AREA <= law <= measured * WORST_AREA:
                return (
                    f"the area of the widest loop is {measured:.3g} J, of the fitted law {law:.3g} J; "
                    f"allowed is a factor of {WORST_AREA:g}"
                )
        if "held_out" in self.facts:
            law, constant = self.facts["held_out"][0], self.facts["held_out_constant"][0]
            if law > LEAST_GAIN * constant:
                return (
                    f"it misses the held-out part by {law:.3g} N.m, a constant by {constant:.3g} N.m; "
                    f"allowed is {LEAST_GAIN:g} of that"
                )
        return None

    def warnings(self) -> list[str]:
        """What the data do not determine, by name, and where the fit stopped; one line each."""
        lines = []
        if loose := undetermined(self.solution):
            lines.append(f"the data do not determine {', '.join(loose)}: other values fit as well")
            ranked = combinations(self.solution)
            for combination in ranked:
                if combination.determined:
                    lines.append(
                        f"the combination {combination} is determined within {percent(combination.deviation)}"
                    )
                elif len(combination.exponents) > 1:
                    lines.append(
                        f"the combination {combination} stays open: {percent(combination.deviation)}"
                    )
        lines += [f"{name} ended on its bound" for name in self.solution.at_bound]
        if self.solution.limit:
            lines.append(f"the fit ended where the model refuses: {self.solution.limit}")
        return lines + list(self.notes)

    def document(self) -> dict[str, Any]:
        """Everything as one JSON object."""
        return {
            "joint": self.parameters.joint,
            "unknowns": self.rows(),
            "correlation": [[_finite(x) for x in row] for row in self.solution.correlation.tolist()],
            "combinations": [
                {
                    "exponents": dict(combination.exponents),
                    "relative_deviation": _finite(combination.deviation),
                    "determined": combination.determined,
                }
                for combination in combinations(self.solution)
            ],
            "facts": {name: {"value": _finite(v), "unit": unit} for name, (v, unit, _) in self.facts.items()},
            "warnings": self.warnings(),
            "parameters": dict(self.parameters.flat),
        }


def percent(part: float) -> str:
    """A relative standard deviation as text."""
    if part < 1.0:
        return f"{100.0 * part:.2g} %"
    return f"{np.exp(part):.2g} times more or less" if part < 5.0 else "orders of magnitude"


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def unknowns(
    start: ParameterFile, names: Sequence[str], bounds: Mapping[str, tuple[float, float]]
) -> list[Unknown]:
    """The named parameters with their declared intervals, narrowed by `bounds`.

    Raises ValueError for a name that the joint lacks, that is no number, or that is given twice.
    """
    values, wanted = start.flat, []
    declared = {n: f for n, f in flat_fields(type(start.values)) if isinstance(values.get(n), float)}
    for name in names:
        if name not in declared:
            raise ValueError(f"{name!r} is no parameter to fit; allowed are {', '.join(declared)}")
        if names.count(name) > 1:
            raise ValueError(f"{name!r} is given twice; allowed is once")
        meta = declared[name].metadata
        narrow = meta["interval"].intersection(Interval(*bounds.get(name, ())))
        wanted.append(Unknown(name, meta["unit"], float(values[name]), narrow.low, narrow.high))
    return wanted


def model(start: ParameterFile, predict: Callable[[Any], Array]) -> Callable[[Mapping[str, float]], Array]:
    """`predict` over {name: value} of the unknowns, the other parameters as in `start`."""
    return lambda values: predict(start.with_values(values, "calibration", "fit").values)


def fitted(
    start: ParameterFile, values: Mapping[str, float], origin: str, data: str, span: str
) -> ParameterFile:
    """The file with fitted values; their source says from what, when and over which range."""
    file = start.with_values(values, origin, f"fitted to {data}, {today()}, {span}")
    return replace(file, name=f"fitted to {data}")


def today() -> str:
    """The date, or that of SOURCE_DATE_EPOCH where it is set (for files that repeat).

    Raises ValueError if the variable is no number of seconds.
    """
    return build_time().date().isoformat()
