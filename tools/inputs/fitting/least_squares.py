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

ResidualFunction = Callable[[Mapping[str, float]], Array]
"""Function {name: value} -> residuals (n) [1]; ValueError or RuntimeError if the model refuses values."""

FINITE_DIFFERENCE_STEP = 1e-4
"""Step of the central differences, in the logarithm of a parameter [1].

Tabulated laws have errors of 1e-8; with this step they cause errors of 1e-4 of the derivatives.
"""
CONVERGENCE_TOLERANCE = 1e-8
"""Relative change of cost or parameters at which a fit ends [1]."""
MAX_FUNCTION_EVALUATIONS = 300
"""Maximum number of function evaluations of one fit, without those for the Jacobian."""
RIDGE_WEIGHT = 0.01
"""Weight of the regularisation towards the start values: standard deviations of a residual per unit of a
logarithm [1]. Too weak to move determined parameters, strong enough to hold undetermined parameters."""
AT_BOUND_TOLERANCE = 1e-6
"""Distance to a bound, in the logarithm [1], below which a parameter counts as being on the bound."""


@dataclass(frozen=True, slots=True)
class Unknown:
    """Parameter to be fitted: name, unit, start value and open bounds in this SI unit.

    parameter_scale : scale of a parameter of any sign, in its unit; None: the parameter is positive
    """

    parameter_name: str
    si_unit: str
    start_value: float
    lower_bound: float
    upper_bound: float
    parameter_scale: float | None = None

    def __post_init__(self) -> None:
        low = self.lower_bound if self.parameter_scale else max(self.lower_bound, 0.0)
        if not low < self.start_value < self.upper_bound:
            unit = "" if self.si_unit == "1" else f" {self.si_unit}"
            raise ValueError(
                f"{self.parameter_name} = {self.start_value:g}{unit} cannot be the start value of the fit; "
                f"expected a value inside ({low:g}, {self.upper_bound:g}){unit}"
            )

    def to_search_variable(self, parameter_value: float) -> float:
        """Variable [1] of the search: logarithm of the parameter's value, or value over `parameter_scale`."""
        if self.parameter_scale:
            return parameter_value / self.parameter_scale
        return float(np.log(parameter_value)) if parameter_value > 0.0 else -np.inf

    def from_search_variable(self, search_variable: float) -> float:
        """Value of the parameter for a variable of the search: logarithm, or value over `parameter_scale`."""
        with np.errstate(over="ignore"):
            return (
                search_variable * self.parameter_scale
                if self.parameter_scale
                else float(np.exp(search_variable))
            )


@dataclass(frozen=True, slots=True)
class FitSolution:
    """Least-squares solution of a fit, and its uncertainty.

    values          : {name: value} [SI] of the k fitted parameters
    residuals       : n residuals [1] at the solution
    noise           : standard deviation of one residual [1]
    jacobian        : derivatives (n, k) [1] of the residuals with respect to the logarithms of the parameters
    covariance      : covariance (k, k) [1] of the logarithms of the parameters
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
        return {u.parameter_name: float(d) for u, d in zip(self.unknowns, root, strict=True)}

    @property
    def correlation(self) -> Array:
        """Correlation matrix (k, k) [1] of the logarithms of the parameters."""
        root = np.sqrt(np.diag(self.covariance))
        return np.asarray(self.covariance / np.outer(root, root))


SOLUTION_WITHOUT_UNKNOWNS = FitSolution(
    (), {}, np.zeros(0), 1.0, np.zeros((0, 0)), np.zeros((0, 0)), (), None
)
"""Solution of a fit without unknowns."""


def solve_least_squares(
    unknowns: Sequence[Unknown],
    residual_function: ResidualFunction,
    *,
    residual_deviation: float | None = None,
    nuisance_count: int = 0,
    convergence_tolerance: float = CONVERGENCE_TOLERANCE,
    difference_steps: float | Array = FINITE_DIFFERENCE_STEP,
) -> FitSolution:
    """Minimise the sum of squared residuals over the unknowns.

    Parameters
    ----------
    unknowns              : parameters to be fitted
    residual_function     : residual function; all residuals have the same standard deviation
    residual_deviation    : standard deviation of a residual [1]; estimated from the residuals if None
    nuisance_count        : number of parameters that the residual function itself eliminates (for example an
                            offset)
    convergence_tolerance : relative change of cost or parameters at which the fit ends [1]
    difference_steps      : step of the central differences, in the logarithm of each parameter [1]

    Raises
    ------
    ValueError   : the model refuses the starting values, or there are too few data
    RuntimeError : no solution after MAX_FUNCTION_EVALUATIONS evaluations
    """
    from scipy.optimize import least_squares

    model = _LogarithmicModel(tuple(unknowns), residual_function, difference_steps)
    logs = model.start
    first = residual_function(model.values_by_name(logs))
    degrees_of_freedom = first.size - logs.size - nuisance_count
    if degrees_of_freedom < 1 and residual_deviation is None:
        raise ValueError(
            f"{first.size} data points are too few for {logs.size + nuisance_count} unknowns "
            f"({', '.join(model.names)}): at least {logs.size + nuisance_count + 1} are needed"
        )
    current = first
    for _ in range(2 if residual_deviation is None else 1):  # the first fit estimates the noise
        model.ridge = RIDGE_WEIGHT * (
            _root_mean_square(current) if residual_deviation is None else residual_deviation
        )
        result = least_squares(
            model,
            logs,
            jac=model.jacobian,
            bounds=(model.low, model.high),
            x_scale="jac",
            xtol=convergence_tolerance,
            ftol=convergence_tolerance,
            gtol=1e-15,
            max_nfev=MAX_FUNCTION_EVALUATIONS,
        )
        if result.status == 0:
            raise RuntimeError(
                f"the fit of {', '.join(model.names)} did not converge within {MAX_FUNCTION_EVALUATIONS} "
                "steps; start from other values, or fit fewer parameters"
            )
        logs, current = result.x, result.fun[: first.size]
    jacobian = result.jac[: first.size]
    if residual_deviation is None:
        residual_deviation = float(np.sqrt(current @ current / degrees_of_freedom))
    at_bound = np.minimum(logs - model.low, model.high - logs) < AT_BOUND_TOLERANCE
    return FitSolution(
        unknowns=tuple(unknowns),
        values=model.values_by_name(logs),
        residuals=current,
        noise=residual_deviation,
        jacobian=jacobian,
        covariance=parameter_covariance(jacobian, residual_deviation),
        names_at_bound=tuple(name for name, on_bound in zip(model.names, at_bound, strict=True) if on_bound),
        refusal_message=model.refusal if model.retreated else None,
    )


def select_start_values(
    unknowns: Sequence[Unknown],
    alternative_start_values: Mapping[str, Sequence[float]],
    evaluate_start_values: Callable[[dict[str, float]], tuple[Mapping[str, float], float]],
) -> Sequence[Unknown]:
    """Select the start values with the lowest cost; return the unknowns with these start values.

    alternative_start_values : {name: alternative start values}; all combinations with the start values of the
                               unknowns are tried
    evaluate_start_values    : function: start values -> start values, which it may adjust, and their cost

    If the model refuses all combinations, the unknowns keep their own start values.
    """
    best, least = unknowns, np.inf
    for point in product(
        *((u.start_value, *alternative_start_values.get(u.parameter_name, ())) for u in unknowns)
    ):
        try:
            values, cost = evaluate_start_values(
                dict(zip((u.parameter_name for u in unknowns), point, strict=True))
            )
        except (ValueError, RuntimeError):
            continue
        if cost < least and all(u.lower_bound < values[u.parameter_name] < u.upper_bound for u in unknowns):
            least, best = cost, [replace(u, start_value=values[u.parameter_name]) for u in unknowns]
    return best


def _root_mean_square(residuals: Array) -> float:
    """Root mean square of residuals (n) [1]."""
    return float(np.sqrt(np.mean(residuals**2)))


class _LogarithmicModel:
    """Residuals of a fit as a function of the logarithms of the k parameters, extended by a ridge term.

    The residuals are infinite where the model refuses the parameters.
    """

    def __init__(
        self,
        unknowns: tuple[Unknown, ...],
        residual_function: ResidualFunction,
        difference_steps: float | Array,
    ) -> None:
        self.unknowns = unknowns
        self.names = [u.parameter_name for u in unknowns]
        self.start = np.array([u.to_search_variable(u.start_value) for u in unknowns])
        self.low = np.array([u.to_search_variable(u.lower_bound) for u in unknowns]) + 1e-9
        self.high = np.array([u.to_search_variable(u.upper_bound) for u in unknowns]) - 1e-9
        self.residuals = residual_function
        self.difference_steps = np.broadcast_to(difference_steps, len(unknowns))
        self.ridge = 0.0
        self.size = 0
        self.refusal: str | None = None
        self.retreated = False

    def values_by_name(self, log_parameters: Array) -> dict[str, float]:
        """Values {name: value} of the parameters, from their logarithms (k)."""
        pairs = zip(self.unknowns, log_parameters.tolist(), strict=True)
        return {unknown.parameter_name: unknown.from_search_variable(value) for unknown, value in pairs}

    def __call__(self, log_parameters: Array) -> Array:
        """Residuals and ridge term at the logarithms of the k parameters."""
        try:
            value = self.residuals(self.values_by_name(log_parameters))
        except (ValueError, RuntimeError) as error:
            if not self.size:
                raise
            self.refusal = str(error)
            return np.full(self.size, np.inf)
        value = np.concatenate([value, self.ridge * (log_parameters - self.start)])
        self.size = value.size
        return value

    def jacobian(self, log_parameters: Array) -> Array:
        """Jacobian by central differences; one-sided if one side is refused by the model or out of bounds."""
        middle = self(log_parameters)
        self.retreated = False
        columns = []
        for k in range(log_parameters.size):
            ends = np.clip(
                log_parameters[k] + self.difference_steps[k] * np.array([-1.0, 1.0]),
                self.low[k],
                self.high[k],
            )
            sides = []
            for end in ends:
                shifted = log_parameters.copy()
                shifted[k] = end
                sides.append(self(shifted) if end != log_parameters[k] else middle)
            finite = [bool(np.all(np.isfinite(side))) for side in sides]
            self.retreated |= not all(finite)
            used_ends = [end if good else log_parameters[k] for end, good in zip(ends, finite, strict=True)]
            low, high = (side if good else middle for side, good in zip(sides, finite, strict=True))
            width = used_ends[1] - used_ends[0]
            columns.append((high - low) / width if width > 0.0 else np.zeros_like(middle))
        return np.stack(columns, axis=1)


def parameter_covariance(jacobian: Array, residual_deviation: float) -> Array:
    """Covariance noise^2 (J^T J)^-1 of fitted parameters, by singular values of the Jacobian J.

    Directions without effect on the residuals get a huge variance.
    """
    _, s, rows = np.linalg.svd(jacobian, full_matrices=False)
    s = np.maximum(s, 1e-12 * max(float(s[0]), 1e-300))
    half = rows.T / s
    return np.asarray(residual_deviation**2 * (half @ half.T))


DERIVED_QUANTITY_TOLERANCE, MAX_EXCHANGE_SECANT_STEPS = 1e-10, 40
"""Relative tolerance [1] of the derived quantity of an `UnknownExchange`, largest number of secant steps."""


@dataclass(frozen=True, slots=True)
class UnknownExchange:
    """Replacement of a fitted parameter, during a fit, by a quantity that it determines (a stiffness).

    exchanged_unknown_name : name of the parameter that is replaced
    derived_quantity       : function {name: value} of the parameters -> quantity; positive, and monotone in
                             the replaced parameter
    quantity_unit          : unit of the quantity
    quantity_label         : name of the quantity
    """

    exchanged_unknown_name: str
    derived_quantity: Callable[[Mapping[str, float]], float]
    quantity_unit: str
    quantity_label: str

    def derived_unknown(self, unknowns: Mapping[str, Unknown]) -> Unknown:
        """Unknown of the fit that stands for the derived quantity, instead of the replaced parameter.

        Its start value follows from the start values of `unknowns`.
        """
        start = self.derived_quantity({name: u.start_value for name, u in unknowns.items()})
        return Unknown(self.quantity_label, self.quantity_unit, start, 0.0, np.inf)

    def restore_unknowns(self, parameter_values: Mapping[str, float], start_value: float) -> dict[str, float]:
        """Find the replaced parameter that gives the derived quantity; return all parameters {name: value}.

        parameter_values : {name: value} of the other parameters and of the derived quantity
        start_value      : start value of the replaced parameter, for the secant method

        Raises ValueError if no value of the replaced parameter gives the quantity.
        """
        rest = {name: value for name, value in parameter_values.items() if name != self.quantity_label}
        target = float(np.log(parameter_values[self.quantity_label]))

        def log_quantity_ratio(log_unknown: float) -> float:
            """Logarithm of the ratio of computed to wanted derived quantity, for ln(replaced parameter)."""
            return (
                float(
                    np.log(
                        self.derived_quantity(
                            {**rest, self.exchanged_unknown_name: float(np.exp(log_unknown))}
                        )
                    )
                )
                - target
            )

        low, high = float(np.log(start_value)), float(np.log(start_value)) + FINITE_DIFFERENCE_STEP
        at_low, at_high = log_quantity_ratio(low), log_quantity_ratio(high)
        for _ in range(MAX_EXCHANGE_SECANT_STEPS):
            if abs(at_high) <= DERIVED_QUANTITY_TOLERANCE or at_high == at_low:
                break
            step = -at_high * (high - low) / (at_high - at_low)
            low, high = high, high + float(np.clip(step, -5.0, 5.0))
            at_low, at_high = at_high, log_quantity_ratio(high)
        if abs(at_high) > 1e3 * DERIVED_QUANTITY_TOLERANCE:
            raise ValueError(
                f"no value of {self.exchanged_unknown_name} gives {self.quantity_label} = "
                f"{parameter_values[self.quantity_label]:g} {self.quantity_unit}"
            )
        return {**rest, self.exchanged_unknown_name: float(np.exp(high))}

    def express_in_original_unknowns(
        self, solution: FitSolution, unknowns: Mapping[str, Unknown]
    ) -> FitSolution:
        """Convert a solution for the derived quantity to a solution for the unknown that it replaced."""
        restored = self.restore_unknowns(solution.values, unknowns[self.exchanged_unknown_name].start_value)
        values = {name: restored[name] for name in unknowns}
        transformation = np.eye(len(values))
        index = [u.parameter_name for u in solution.unknowns].index(self.quantity_label)
        transformation[index] = self._logarithmic_derivatives(values)
        jacobian = solution.jacobian @ transformation
        return replace(
            solution,
            unknowns=tuple(unknowns.values()),
            values=values,
            jacobian=jacobian,
            covariance=parameter_covariance(jacobian, solution.noise),
        )

    def _logarithmic_derivatives(self, parameter_values: Mapping[str, float]) -> Array:
        """Derivatives (k) [1] of ln(derived quantity) with respect to the logarithms of the k parameters."""

        def log_perturbed_quantity(parameter_name: str, log_parameter_step: float) -> float:
            """Logarithm of the derived quantity if the logarithm of one parameter changes by a step."""
            return float(
                np.log(
                    self.derived_quantity(
                        {
                            **parameter_values,
                            parameter_name: parameter_values[parameter_name]
                            * float(np.exp(log_parameter_step)),
                        }
                    )
                )
            )

        return np.array(
            [
                (
                    log_perturbed_quantity(n, FINITE_DIFFERENCE_STEP)
                    - log_perturbed_quantity(n, -FINITE_DIFFERENCE_STEP)
                )
                / (2.0 * FINITE_DIFFERENCE_STEP)
                for n in parameter_values
            ]
        )
