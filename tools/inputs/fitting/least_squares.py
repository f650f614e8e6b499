"""Nonlinear least squares, in the logarithms of positive parameters, with bounds and covariance.

A thin layer over `scipy.optimize.least_squares` (trust region reflective). The unknowns are the logarithms of
the parameters; a parameter of any sign is divided by a scale instead. "Logarithm" means both below. Residuals
are infinite at parameters that the model refuses, so the search steps back. The covariance follows from the
Jacobian at the solution.

During the search a parameter may be replaced by a derived quantity (`UnknownExchange`). Example: factor and
exponent of a power law together give a stiffness, which the data determine a thousand times better than
factor or exponent alone. Steps in factor and exponent leave the narrow curved valley of the cost at once.
With the stiffness as unknown instead of the factor, the valley is straight.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from jointfmu.quantity import Array

Residuals = Callable[[Mapping[str, float]], Array]
"""Function {name: value} -> residuals (n) [1]; ValueError or RuntimeError if the model refuses values."""

FINITE_DIFFERENCE_STEP = 1e-4
"""Step of the central differences, in the logarithm of a parameter [1].

Tabulated laws have errors of 1e-8; with this step they cause errors of 1e-4 of the derivatives.
"""
CONVERGENCE_TOLERANCE = 1e-8
"""Relative change of cost or parameters at which a fit ends [1]."""
MAX_EVALUATIONS = 300
"""Maximum number of function evaluations of one fit, without those for the Jacobian."""
RIDGE_WEIGHT = 0.01
"""Weight of the regularisation towards the start values: standard deviations of a residual per unit of a
logarithm [1]. Too weak to move determined parameters, strong enough to hold undetermined parameters."""
AT_BOUND_TOLERANCE = 1e-6
"""Distance to a bound, in the logarithm [1], below which a parameter counts as being on the bound."""


@dataclass(frozen=True, slots=True)
class Unknown:
    """Parameter to be fitted: name, unit, start value and open bounds in this SI unit.

    scale : scale of a parameter of any sign, in its unit; None: the parameter is positive
    """

    name: str
    unit: str
    start_value: float
    lower_bound: float
    upper_bound: float
    scale: float | None = None

    def __post_init__(self) -> None:
        low = self.lower_bound if self.scale else max(self.lower_bound, 0.0)
        if not low < self.start_value < self.upper_bound:
            unit = "" if self.unit == "1" else f" {self.unit}"
            raise ValueError(
                f"{self.name} = {self.start_value:g}{unit} cannot be the start value of the fit; expected a "
                f"value inside ({low:g}, {self.upper_bound:g}){unit}"
            )

    def to_search(self, value: float) -> float:
        """Number [1] that the search varies: logarithm of the parameter's value, or value over `scale`."""
        if self.scale:
            return value / self.scale
        return float(np.log(value)) if value > 0.0 else -np.inf

    def from_search(self, search_value: float) -> float:
        """Value of the parameter, for a number that the search varies: logarithm, or value over `scale`."""
        with np.errstate(over="ignore"):
            return search_value * self.scale if self.scale else float(np.exp(search_value))


@dataclass(frozen=True, slots=True)
class Solution:
    """Least-squares solution of a fit, and its uncertainty.

    values          : {name: value} [SI]
    residuals       : residuals (n) [1] at the solution
    noise           : standard deviation of one residual [1]
    jacobian        : derivatives (n, k) [1] of the residuals with respect to the logarithms of the parameters
    covariance      : covariance (k, k) [1] of the logarithms
    names_at_bound  : names of the parameters on a bound
    refusal_message : error message of the model next to the solution, if the fit ended where the model
                      refuses values; else None
    """

    unknowns: tuple[Unknown, ...]
    values: Mapping[str, float]
    residuals: Array
    noise: float
    jacobian: Array
    covariance: Array
    names_at_bound: tuple[str, ...]
    refusal_message: str | None

    @property
    def relative_deviations(self) -> dict[str, float]:
        """{name: relative standard deviation [1]}, equal to the standard deviation of the logarithm.

        For an unknown with a scale: standard deviation over this scale.
        """
        root = np.sqrt(np.diag(self.covariance))
        return {u.name: float(d) for u, d in zip(self.unknowns, root, strict=True)}

    @property
    def correlation(self) -> Array:
        """Correlation matrix (k, k) [1] of the logarithms of the parameters."""
        root = np.sqrt(np.diag(self.covariance))
        return np.asarray(self.covariance / np.outer(root, root))


EMPTY_SOLUTION = Solution((), {}, np.zeros(0), 1.0, np.zeros((0, 0)), np.zeros((0, 0)), (), None)
"""Solution of a fit without unknowns."""


def solve(
    unknowns: Sequence[Unknown],
    residuals: Residuals,
    *,
    noise: float | None = None,
    nuisance_count: int = 0,
    tolerance: float = CONVERGENCE_TOLERANCE,
    difference_steps: float | Array = FINITE_DIFFERENCE_STEP,
) -> Solution:
    """Minimise the sum of squared residuals over the unknowns.

    Parameters
    ----------
    unknowns       : parameters to be fitted
    residuals      : residual function; all residuals have the same standard deviation
    noise          : standard deviation of a residual [1]; estimated from the residuals if None
    nuisance_count : number of parameters that the residual function itself eliminates (for example an offset)
    tolerance      : relative change of cost or parameters at which the fit ends [1]
    difference_steps : step of the central differences, in the logarithm of each parameter [1]

    Raises
    ------
    ValueError   : the model refuses the starting values, or there are too few data
    RuntimeError : no solution after MAX_EVALUATIONS evaluations
    """
    from scipy.optimize import least_squares

    model = _LogarithmicModel(tuple(unknowns), residuals, difference_steps)
    logs = model.start
    first = residuals(model.values_by_name(logs))
    degrees_of_freedom = first.size - logs.size - nuisance_count
    if degrees_of_freedom < 1 and noise is None:
        raise ValueError(
            f"{first.size} data points are too few for {logs.size + nuisance_count} unknowns "
            f"({', '.join(model.names)}): at least {logs.size + nuisance_count + 1} are needed"
        )
    current = first
    for _ in range(2 if noise is None else 1):  # the first fit estimates the noise
        model.ridge = RIDGE_WEIGHT * (_root_mean_square(current) if noise is None else noise)
        result = least_squares(
            model,
            logs,
            jac=model.jacobian,
            bounds=(model.low, model.high),
            x_scale="jac",
            xtol=tolerance,
            ftol=tolerance,
            gtol=1e-15,
            max_nfev=MAX_EVALUATIONS,
        )
        if result.status == 0:
            raise RuntimeError(
                f"the fit of {', '.join(model.names)} did not converge within {MAX_EVALUATIONS} steps"
            )
        logs, current = result.x, result.fun[: first.size]
    jacobian = result.jac[: first.size]
    if noise is None:
        noise = float(np.sqrt(current @ current / degrees_of_freedom))
    at_bound = np.minimum(logs - model.low, model.high - logs) < AT_BOUND_TOLERANCE
    return Solution(
        unknowns=tuple(unknowns),
        values=model.values_by_name(logs),
        residuals=current,
        noise=noise,
        jacobian=jacobian,
        covariance=covariance(jacobian, noise),
        names_at_bound=tuple(name for name, on_bound in zip(model.names, at_bound, strict=True) if on_bound),
        refusal_message=model.refusal if model.retreated else None,
    )


def select_start(
    unknowns: Sequence[Unknown],
    alternative_starts: Mapping[str, Sequence[float]],
    evaluate_start: Callable[[dict[str, float]], tuple[Mapping[str, float], float]],
) -> Sequence[Unknown]:
    """Select the start values with the lowest cost; return the unknowns with these start values.

    alternative_starts : {name: alternative start values}; all combinations with the unknowns' own starts are
                         tried
    evaluate_start     : function: starting point -> values, which it may adjust, and their cost

    If the model refuses all points, the unknowns keep their own starts.
    """
    best, least = unknowns, np.inf
    for point in product(*((u.start_value, *alternative_starts.get(u.name, ())) for u in unknowns)):
        try:
            values, cost = evaluate_start(dict(zip((u.name for u in unknowns), point, strict=True)))
        except (ValueError, RuntimeError):
            continue
        if cost < least and all(u.lower_bound < values[u.name] < u.upper_bound for u in unknowns):
            least, best = cost, [replace(u, start_value=values[u.name]) for u in unknowns]
    return best


def _root_mean_square(residuals: Array) -> float:
    """Root mean square of residuals (n) [1]."""
    return float(np.sqrt(np.mean(residuals**2)))


class _LogarithmicModel:
    """Residuals and regularisation as functions of ln(parameters) (k); infinite if the model refuses them."""

    def __init__(
        self, unknowns: tuple[Unknown, ...], residuals: Residuals, difference_steps: float | Array
    ) -> None:
        self.unknowns = unknowns
        self.names = [u.name for u in unknowns]
        self.start = np.array([u.to_search(u.start_value) for u in unknowns])
        self.low = np.array([u.to_search(u.lower_bound) for u in unknowns]) + 1e-9
        self.high = np.array([u.to_search(u.upper_bound) for u in unknowns]) - 1e-9
        self.residuals = residuals
        self.difference_steps = np.broadcast_to(difference_steps, len(unknowns))
        self.ridge = 0.0
        self.size = 0
        self.refusal: str | None = None
        self.retreated = False

    def values_by_name(self, log_values: Array) -> dict[str, float]:
        """Values {name: value} of the parameters, from their logarithms (k)."""
        pairs = zip(self.unknowns, log_values.tolist(), strict=True)
        return {unknown.name: unknown.from_search(value) for unknown, value in pairs}

    def __call__(self, log_values: Array) -> Array:
        """Residuals and regularisation at logarithms (k) of the parameters."""
        try:
            value = self.residuals(self.values_by_name(log_values))
        except (ValueError, RuntimeError) as error:
            if not self.size:
                raise
            self.refusal = str(error)
            return np.full(self.size, np.inf)
        value = np.concatenate([value, self.ridge * (log_values - self.start)])
        self.size = value.size
        return value

    def jacobian(self, log_values: Array) -> Array:
        """Jacobian by central differences; one-sided if one side is refused by the model or out of bounds."""
        middle = self(log_values)
        self.retreated = False
        columns = []
        for k in range(log_values.size):
            ends = np.clip(
                log_values[k] + self.difference_steps[k] * np.array([-1.0, 1.0]),
                self.low[k],
                self.high[k],
            )
            sides = []
            for end in ends:
                shifted = log_values.copy()
                shifted[k] = end
                sides.append(self(shifted) if end != log_values[k] else middle)
            finite = [bool(np.all(np.isfinite(side))) for side in sides]
            self.retreated |= not all(finite)
            used_ends = [end if good else log_values[k] for end, good in zip(ends, finite, strict=True)]
            low, high = (side if good else middle for side, good in zip(sides, finite, strict=True))
            width = used_ends[1] - used_ends[0]
            columns.append((high - low) / width if width > 0.0 else np.zeros_like(middle))
        return np.stack(columns, axis=1)


def covariance(jacobian: Array, noise: float) -> Array:
    """Covariance noise^2 (J^T J)^-1 of fitted parameters, by singular values of the Jacobian J.

    Directions without effect on the residuals get a huge variance.
    """
    _, s, rows = np.linalg.svd(jacobian, full_matrices=False)
    s = np.maximum(s, 1e-12 * max(float(s[0]), 1e-300))
    half = rows.T / s
    return np.asarray(noise**2 * (half @ half.T))


EXCHANGE_TOLERANCE, MAX_SECANT_STEPS = 1e-10, 40
"""Relative tolerance [1] of the derived quantity of an `UnknownExchange`, largest number of secant steps."""


@dataclass(frozen=True, slots=True)
class UnknownExchange:
    """Replacement of an unknown by a derived quantity during a fit.

    exchanged_name   : name of the unknown that is replaced
    derived_quantity : function {name: value} -> derived quantity; positive, and monotone in the replaced
                       unknown
    unit             : unit of the quantity
    quantity_label   : name of the quantity
    """

    exchanged_name: str
    derived_quantity: Callable[[Mapping[str, float]], float]
    unit: str
    quantity_label: str

    def derived_unknown(self, unknowns: Mapping[str, Unknown]) -> Unknown:
        """Unknown for the derived quantity; its start value follows from the start values of `unknowns`."""
        start = self.derived_quantity({name: u.start_value for name, u in unknowns.items()})
        return Unknown(self.quantity_label, self.unit, start, 0.0, np.inf)

    def restore_unknowns(self, parameter_values: Mapping[str, float], start_value: float) -> dict[str, float]:
        """Replace the derived quantity by the value of the unknown that gives it, by the secant method.

        start_value : start value of the replaced unknown, for the secant method

        Raises ValueError if no value of the replaced unknown gives the quantity.
        """
        rest = {name: value for name, value in parameter_values.items() if name != self.quantity_label}
        target = float(np.log(parameter_values[self.quantity_label]))

        def logarithmic_error(log_value: float) -> float:
            """Logarithm of the computed over the wanted derived quantity."""
            return (
                float(np.log(self.derived_quantity({**rest, self.exchanged_name: float(np.exp(log_value))})))
                - target
            )

        low, high = float(np.log(start_value)), float(np.log(start_value)) + FINITE_DIFFERENCE_STEP
        at_low, at_high = logarithmic_error(low), logarithmic_error(high)
        for _ in range(MAX_SECANT_STEPS):
            if abs(at_high) <= EXCHANGE_TOLERANCE or at_high == at_low:
                break
            step = -at_high * (high - low) / (at_high - at_low)
            low, high = high, high + float(np.clip(step, -5.0, 5.0))
            at_low, at_high = at_high, logarithmic_error(high)
        if abs(at_high) > 1e3 * EXCHANGE_TOLERANCE:
            raise ValueError(
                f"no {self.exchanged_name} gives {self.quantity_label} = "
                f"{parameter_values[self.quantity_label]:g} {self.unit}"
            )
        return {**rest, self.exchanged_name: float(np.exp(high))}

    def express_in_original_unknowns(self, solution: Solution, unknowns: Mapping[str, Unknown]) -> Solution:
        """Transform a solution for the derived quantity into a solution for the unknown that it replaced."""
        restored = self.restore_unknowns(solution.values, unknowns[self.exchanged_name].start_value)
        values = {name: restored[name] for name in unknowns}
        transformation = np.eye(len(values))
        index = [u.name for u in solution.unknowns].index(self.quantity_label)
        transformation[index] = self._logarithmic_derivatives(values)
        jacobian = solution.jacobian @ transformation
        return replace(
            solution,
            unknowns=tuple(unknowns.values()),
            values=values,
            jacobian=jacobian,
            covariance=covariance(jacobian, solution.noise),
        )

    def _logarithmic_derivatives(self, parameter_values: Mapping[str, float]) -> Array:
        """Derivatives (k) [1] of ln(derived quantity) with respect to the logarithms of the k parameters."""

        def perturbed_quantity(parameter_name: str, log_step: float) -> float:
            """Logarithm of the derived quantity with one perturbed parameter."""
            return float(
                np.log(
                    self.derived_quantity(
                        {
                            **parameter_values,
                            parameter_name: parameter_values[parameter_name] * float(np.exp(log_step)),
                        }
                    )
                )
            )

        return np.array(
            [
                (
                    perturbed_quantity(n, FINITE_DIFFERENCE_STEP)
                    - perturbed_quantity(n, -FINITE_DIFFERENCE_STEP)
                )
                / (2.0 * FINITE_DIFFERENCE_STEP)
                for n in parameter_values
            ]
        )
