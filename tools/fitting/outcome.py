"""What every fit hands back: the parameter file, how well it is determined, and the plotted data.

The singular values of the Jacobian in the logarithms, over the noise, are the reciprocal standard deviations
of independent combinations `prod name^exponent`. A parameter or combination counts as determined if its
standard deviation is at most its limit: LOOSEST, or a tenth of the parameter's interval where that is
narrower (both in logarithms).
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from jointfmu.contact.roughness import ROUGHEST
from jointfmu.files.timestamp import build_time
from jointfmu.parameters import ParameterFile
from jointfmu.quantity import Array, Interval, flat_fields

from .. import plots
from .least_squares import Solution, Unknown

if TYPE_CHECKING:
    from matplotlib.figure import Figure


LOOSEST = 0.2
"""Standard deviation of a logarithm [1] up to which a parameter counts as determined: about 20 %."""
PART_OF_INTERVAL = 0.1
SIGNIFICANT = 0.01
"""Least exponent of a combination, over its largest, that is named [1]."""
NUMERICAL = 1e-5
"""Least singular value over the largest that is told from zero [1]: the accuracy of the differences."""


@dataclass(frozen=True, slots=True)
class Combination:
    """An independent combination of parameters, prod name^exponent, largest exponent 1.

    deviation : relative standard deviation [1]; infinite if the data say nothing about it
    """

    exponents: Mapping[str, float]
    deviation: float
    determined: bool

    def __str__(self) -> str:
        return " ".join(
            name if power == 1.0 else f"{name}^{power:.2g}" for name, power in self.exponents.items()
        )


def limit(unknown: Unknown) -> float:
    """Standard deviation of the logarithm [1] up to which a parameter counts as determined."""
    if unknown.low <= 0.0 or not np.isfinite(unknown.high):
        return LOOSEST
    return min(LOOSEST, PART_OF_INTERVAL * float(np.log(unknown.high / unknown.low)))


def combinations(solution: Solution) -> list[Combination]:
    """The independent combinations, best determined first."""
    limits = np.array([limit(u) for u in solution.unknowns])
    _, s, rows = np.linalg.svd(solution.jacobian * limits, full_matrices=False)
    independent = []
    for value, row in zip(s, rows, strict=True):
        powers = row / limits  # ln of the combination is row . (ln x / limits)
        top = powers[np.argmax(np.abs(row))]
        named = np.abs(row) >= SIGNIFICANT * np.max(np.abs(row))
        exponents = {
            u.name: float(p / top)
            for u, p, keep in zip(solution.unknowns, powers, named, strict=True)
            if keep
        }
        blind = value <= NUMERICAL * s[0]
        deviation = np.inf if blind else solution.noise / value
        independent.append(Combination(exponents, float(deviation / abs(top)), bool(deviation <= 1.0)))
    return independent


def undetermined(solution: Solution) -> list[str]:
    """Names of the parameters that the data do not determine, or that sit on a bound."""
    blind = {name for c in combinations(solution) if not np.isfinite(c.deviation) for name in c.exponents}
    return [
        u.name
        for u in solution.unknowns
        if solution.deviations[u.name] > limit(u) or u.name in solution.at_bound or u.name in blind
    ]


ALIKE = 0.5
"""Correlation of neighbouring residuals [1] above which the law itself misses the data."""

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


Facts = dict[str, tuple[float, str, str]]
"""{name: (value, unit, meaning)}."""


@dataclass(frozen=True, slots=True)
class FitResult:
    """A fit.

    facts : {name: (value, unit, meaning)} beside the parameters
    notes : what the user should know, one line each
    pictures : drawn beside each other
    intervals : {name: ends of its 95 % interval}, where they are told
    """

    parameters: ParameterFile
    solution: Solution
    facts: Facts
    pictures: Sequence[Picture]
    notes: Sequence[str] = ()
    intervals: Mapping[str, tuple[float, float]] = field(default_factory=dict)

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


def systematic(rest: Array, what: str, same: NDArray[np.bool_] | slice = slice(None)) -> list[str]:
    """The note where residuals (n) of `what` show that the law itself misses it, by neighbours `same`."""
    alike = float(np.sum((rest[1:] * rest[:-1])[same]) / np.sum(rest**2)) if np.any(rest) else 0.0
    if alike <= ALIKE:
        return []
    return [
        f"neighbouring residuals are alike (correlation {alike:.2f}): the law misses the {what} "
        "systematically, the standard deviations are too small"
    ]


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
    """The file with fitted values; their source says from what, over which range and when: today, or at
    SOURCE_DATE_EPOCH where that is set, for files that repeat.

    Raises ValueError if that variable is no number of seconds.
    """
    today = build_time().date().isoformat()
    file = start.with_values(values, origin, f"fitted to {data}, {today}, {span}")
    return replace(file, name=f"fitted to {data}")


def size(outcome: FitResult) -> tuple[float, float]:
    """Of the figure [inch]."""
    return 3.6 * (1 + len(outcome.pictures)), 5.6


def draw(figure: "Figure", outcome: FitResult) -> None:
    """Data and law above, residuals below; pictures side by side."""
    pictures = outcome.pictures
    every = figure.subplots(2, len(pictures), sharex="col", height_ratios=(2.4, 1.0), squeeze=False)
    for (above, below), picture in zip(every.T, pictures, strict=True):
        x, y = picture.x, picture.y
        above.plot(*picture.line, color=plots.BLUE, label="fitted law")
        for (name, line), color in zip(picture.also.items(), (plots.GREEN, plots.GREY), strict=False):
            above.plot(*line, "--", color=color, lw=1.0, label=name)
        above.plot(x, y, ".", color=plots.RED, ms=4, label="data")
        below.axhline(0.0, color=plots.BLUE, lw=1.0)
        below.plot(x, picture.misfit, ".", color=plots.RED, ms=4)
        if picture.marks is not None:
            for axes, values in ((above, y), (below, picture.misfit)):
                axes.plot(x[picture.marks], values[picture.marks], "o", color=plots.RED, ms=7)
        above.set_ylabel(picture.labels[1])
        below.set_xlabel(picture.labels[0])
        below.set_ylabel(picture.labels[2])
        above.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2)
