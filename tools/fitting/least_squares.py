"""Least squares over the logarithms of positive parameters, with bounds and covariance.

A thin layer over `scipy.optimize.least_squares` (trust region reflective): parameters move in logarithms, a
parameter set that the model refuses is stepped back from, and the Jacobian at the solution gives the
covariance.

A parameter may be exchanged for what the data see of it while a fit searches. Where a law's level and
exponent together make a stiffness that the data know a thousand times better than either, steps in the two
parameters leave the narrow curved valley of that stiffness at once. With the stiffness as an unknown instead
of the level the valley is straight.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from jointfmu.quantity import Array

Residuals = Callable[[Mapping[str, float]], Array]
"""Residuals (n) [1] at {name: value}; ValueError or RuntimeError where the model refuses the values."""

STEP = 1e-4
"""Step of the central differences in a logarithm [1]: the tables' errors of 1e-8 give 1e-4 of slope."""
TOLERANCE = 1e-8
"""Relative change of cost or parameters at which a fit ends [1]."""
MOST_STEPS = 300
RIDGE = 0.01
"""Pull towards the start, in residuals' standard deviations per unit of a logarithm [1]: too weak to
move what the data determine, enough to hold what they do not."""
EDGE = 1e-6
"""Distance from a bound, in logarithms [1], at which a parameter is said to sit on it."""


@dataclass(frozen=True, slots=True)
class Unknown:
    """A positive parameter to find, between open bounds in its SI unit."""

    name: str
    unit: str
    start: float
    low: float
    high: float

    def __post_init__(self) -> None:
        if not self.low < self.start < self.high or self.start <= 0.0:
            unit = "" if self.unit == "1" else f" {self.unit}"
            raise ValueError(
                f"{self.name} = {self.start:g}{unit} cannot be fitted from there: a fit in logarithms "
                f"starts inside ({max(self.low, 0.0):g}, {self.high:g}){unit}"
            )


@dataclass(frozen=True, slots=True)
class Solution:
    """The best values and how well the data determine them.

    values     : {name: value} [SI]
    residuals  : (n) at the solution, on the scale of the residual function
    noise      : standard deviation of one residual
    jacobian   : (n, k) derivatives of the residuals in the logarithms
    covariance : (k, k) [1] of the logarithms
    at_bound   : names whose value sits on a bound
    limit      : what the model refused beside the solution, if that is where the fit ended
    """

    unknowns: tuple[Unknown, ...]
    values: Mapping[str, float]
    residuals: Array
    noise: float
    jacobian: Array
    covariance: Array
    at_bound: tuple[str, ...]
    limit: str | None

    @property
    def deviations(self) -> dict[str, float]:
        """Relative standard deviation [1] of each parameter: that of its logarithm."""
        root = np.sqrt(np.diag(self.covariance))
        return {u.name: float(d) for u, d in zip(self.unknowns, root, strict=True)}

    @property
    def correlation(self) -> Array:
        """Correlation (k, k) [1] of the logarithms."""
        root = np.sqrt(np.diag(self.covariance))
        return np.asarray(self.covariance / np.outer(root, root))


NOTHING = Solution((), {}, np.zeros(0), 1.0, np.zeros((0, 0)), np.zeros((0, 0)), (), None)
"""No unknowns."""


def solve(
    unknowns: Sequence[Unknown],
    residuals: Residuals,
    *,
    noise: float | None = None,
    nuisances: int = 0,
    tolerance: float = TOLERANCE,
) -> Solution:
    """The values with the least sum of squared residuals.

    Parameters
    ----------
    residuals : model against data, all with the same standard deviation
    noise     : standard deviation of a residual; estimated from the residuals if None
    nuisances : parameters that the residual function itself eliminates (an offset, say)

    Raises
    ------
    ValueError   : the model refuses the starting values, or there are too few data
    RuntimeError : no solution after MOST_STEPS steps
    """
    from scipy.optimize import least_squares

    model = _Model(tuple(unknowns), residuals)
    place = model.start
    first = residuals(model.named(place))
    spare = first.size - place.size - nuisances
    if spare < 1 and noise is None:
        raise ValueError(
            f"{first.size} data points are too few for {place.size + nuisances} unknowns "
            f"({', '.join(model.names)}): at least {place.size + nuisances + 1} are needed"
        )
    rest = first
    for _ in range(2 if noise is None else 1):  # the noise is known after the first
        model.ridge = RIDGE * (_spread(rest) if noise is None else noise)
        result = least_squares(
            model,
            place,
            jac=model.jacobian,
            bounds=(model.low, model.high),
            x_scale="jac",
            xtol=tolerance,
            ftol=tolerance,
            gtol=1e-15,
            max_nfev=MOST_STEPS,
        )
        if result.status == 0:
            raise RuntimeError(f"the fit of {', '.join(model.names)} found no end within {MOST_STEPS} steps")
        place, rest = result.x, result.fun[: first.size]
    jacobian = result.jac[: first.size]
    if noise is None:
        noise = float(np.sqrt(rest @ rest / spare))
    edge = np.minimum(place - model.low, model.high - place) < EDGE
    return Solution(
        unknowns=tuple(unknowns),
        values=model.named(place),
        residuals=rest,
        noise=noise,
        jacobian=jacobian,
        covariance=covariance(jacobian, noise),
        at_bound=tuple(name for name, there in zip(model.names, edge, strict=True) if there),
        limit=model.refusal if model.retreated else None,
    )


def best_start(
    unknowns: Sequence[Unknown],
    starts: Mapping[str, Sequence[float]],
    tried: Callable[[dict[str, float]], tuple[Mapping[str, float], float]],
) -> Sequence[Unknown]:
    """The unknowns at the best of the starting points; at their own starts where the model refuses all.

    starts : {name: values beside the start's}
    tried  : starting point -> the values there, which it may move, and their cost
    """
    best, least = unknowns, np.inf
    for point in product(*((u.start, *starts.get(u.name, ())) for u in unknowns)):
        try:
            values, cost = tried(dict(zip((u.name for u in unknowns), point, strict=True)))
        except (ValueError, RuntimeError):
            continue
        if cost < least and all(u.low < values[u.name] < u.high for u in unknowns):
            least, best = cost, [replace(u, start=values[u.name]) for u in unknowns]
    return best


def _spread(residuals: Array) -> float:
    """Root mean square [1]."""
    return float(np.sqrt(np.mean(residuals**2)))


class _Model:
    """Residuals and ridge over an array of logarithms, infinite where the model refuses."""

    def __init__(self, unknowns: tuple[Unknown, ...], residuals: Residuals) -> None:
        self.names = [u.name for u in unknowns]
        self.start = np.log([u.start for u in unknowns])
        with np.errstate(divide="ignore"):
            self.low = np.log([max(u.low, 0.0) for u in unknowns]) + 1e-9
            self.high = np.log([u.high for u in unknowns]) - 1e-9
        self.residuals = residuals
        self.ridge = 0.0
        self.size = 0
        self.refusal: str | None = None
        self.retreated = False

    def named(self, logs: Array) -> dict[str, float]:
        with np.errstate(over="ignore"):
            return dict(zip(self.names, np.exp(logs).tolist(), strict=True))

    def __call__(self, logs: Array) -> Array:
        try:
            value = self.residuals(self.named(logs))
        except (ValueError, RuntimeError) as error:
            if not self.size:
                raise
            self.refusal = str(error)
            return np.full(self.size, np.inf)
        value = np.concatenate([value, self.ridge * (logs - self.start)])
        self.size = value.size
        return value

    def jacobian(self, logs: Array) -> Array:
        """Central differences; one-sided where a side is refused or out of bounds."""
        middle = self(logs)
        self.retreated = False
        columns = []
        for k in range(logs.size):
            ends = np.clip(logs[k] + np.array([-STEP, STEP]), self.low[k], self.high[k])
            sides = []
            for end in ends:
                there = logs.copy()
                there[k] = end
                sides.append(self(there) if end != logs[k] else middle)
            fine = [bool(np.all(np.isfinite(side))) for side in sides]
            self.retreated |= not all(fine)
            places = [end if good else logs[k] for end, good in zip(ends, fine, strict=True)]
            low, high = (side if good else middle for side, good in zip(sides, fine, strict=True))
            width = places[1] - places[0]
            columns.append((high - low) / width if width > 0.0 else np.zeros_like(middle))
        return np.stack(columns, axis=1)


def covariance(jacobian: Array, noise: float) -> Array:
    """noise^2 (J^T J)^-1 by singular values; directions without any effect get a huge variance."""
    _, s, rows = np.linalg.svd(jacobian, full_matrices=False)
    s = np.maximum(s, 1e-12 * max(float(s[0]), 1e-300))
    half = rows.T / s
    return np.asarray(noise**2 * (half @ half.T))


EXACT, SECANTS = 1e-10, 40
"""Relative accuracy with which the quantity is met [1], and the steps for that."""


@dataclass(frozen=True, slots=True)
class Exchange:
    """What takes the place of an unknown.

    name     : of the unknown
    quantity : what takes its place; a positive function of the values, monotone in the unknown
    unit     : of the quantity
    label    : its name
    """

    name: str
    quantity: Callable[[Mapping[str, float]], float]
    unit: str
    label: str

    def unknown(self, unknowns: Mapping[str, Unknown]) -> Unknown:
        """The quantity as an unknown, at the start of the others."""
        start = self.quantity({name: u.start for name, u in unknowns.items()})
        return Unknown(self.label, self.unit, start, 0.0, np.inf)

    def values(self, found: Mapping[str, float], near: float) -> dict[str, float]:
        """The values of the unknowns in which the quantity stands for its own; the search begins at `near`.

        Raises ValueError if the quantity cannot be met.
        """
        rest = {name: value for name, value in found.items() if name != self.label}
        target = float(np.log(found[self.label]))

        def miss(log: float) -> float:
            return float(np.log(self.quantity({**rest, self.name: float(np.exp(log))}))) - target

        low, high = float(np.log(near)), float(np.log(near)) + STEP
        at_low, at_high = miss(low), miss(high)
        for _ in range(SECANTS):
            if abs(at_high) <= EXACT or at_high == at_low:
                break
            step = -at_high * (high - low) / (at_high - at_low)
            low, high = high, high + float(np.clip(step, -5.0, 5.0))
            at_low, at_high = at_high, miss(high)
        if abs(at_high) > 1e3 * EXACT:
            raise ValueError(f"no {self.name} gives {self.label} = {found[self.label]:g} {self.unit}")
        return {**rest, self.name: float(np.exp(high))}

    def back(self, solution: Solution, unknowns: Mapping[str, Unknown]) -> Solution:
        """A solution over the quantity as one over the unknowns."""
        found = self.values(solution.values, unknowns[self.name].start)
        values = {name: found[name] for name in unknowns}
        turn = np.eye(len(values))
        own = [u.name for u in solution.unknowns].index(self.label)
        turn[own] = self._slopes(values)
        jacobian = solution.jacobian @ turn
        return replace(
            solution,
            unknowns=tuple(unknowns.values()),
            values=values,
            jacobian=jacobian,
            covariance=covariance(jacobian, solution.noise),
        )

    def _slopes(self, values: Mapping[str, float]) -> Array:
        """Derivatives of the quantity in the values, all in logarithms."""

        def moved(name: str, by: float) -> float:
            return float(np.log(self.quantity({**values, name: values[name] * float(np.exp(by))})))

        return np.array([(moved(n, STEP) - moved(n, -STEP)) / (2.0 * STEP) for n in values])
