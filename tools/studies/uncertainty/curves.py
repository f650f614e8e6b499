"""Quantities of a joint along a load ramp, for uncertainty studies.

Its tool module `uncertainty` states them.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, Protocol

import numpy as np

from jointfmu.joints.kind import JointKind
from jointfmu.joints.model import Variable
from jointfmu.quantity import Array

from ...common.joint_parts import load_tool_module


class JointSample(Protocol):
    """Joint with the parameters of one sample of an uncertainty study."""

    @property
    def parameter_set(self) -> Any:
        """Parameter set of the sample, without checks."""

    def evaluate_outputs(
        self, input_values: Mapping[str, Array], parameter_changes: Mapping[str, Any] | None = None
    ) -> Mapping[str, Array]:
        """Evaluate the joint at inputs (n), each reached from the virgin state: all outputs (n) [SI].

        parameter_changes : {parameter: value} in place of its value in the sample
        """


@dataclass(frozen=True, slots=True)
class DerivedOutput:
    """Quantity that is computed from several evaluations of the joint. It is 0 at zero load.

    output_variable : name, unit and meaning of the output
    compute_values  : function (sample, loads (m) above zero, ascending) -> values (m); the last load is the
        end of the ramp
    """

    output_variable: Variable
    compute_values: Callable[[JointSample, Array], Array]


@dataclass(frozen=True, slots=True, kw_only=True)
class LoadCurves:
    """Quantities of a kind of joint along a load ramp, which a study computes for each sample.

    fmu_name         : name of the FMU that is evaluated
    ramped_input     : input of the FMU that is the load
    outputs          : outputs of the FMU
    knot_count       : number of loads at which the FMU is evaluated if the ramp has more loads; cubic splines
        interpolate the outputs between these loads. None: the FMU is evaluated at all loads
    derived_outputs  : quantities that are computed from several evaluations of the FMU
    default_ramp_end : function, parameter set -> default end of the ramp
    max_load         : function, parameter set -> largest load of the tabulated law
    lost_load        : function, parameter set -> part of the load in a parameter file that the joint loses
        (preload by embedding)
    fixed_parameters : {parameter: value} during the ramp, in place of its value in the sample
    fixed_inputs     : function, parameter set -> {other input: constant value}
    """

    fmu_name: str
    ramped_input: Variable
    outputs: Sequence[Variable]
    knot_count: int | None = None
    derived_outputs: Sequence[DerivedOutput] = ()
    default_ramp_end: Callable[[Any], float]
    max_load: Callable[[Any], float]
    lost_load: Callable[[Any], float] = lambda parameters: 0.0
    fixed_parameters: Mapping[str, Any] = field(default_factory=dict)
    fixed_inputs: Callable[[Any], Mapping[str, float]] = lambda parameters: {}

    @property
    def quantity_units(self) -> dict[str, str]:
        """Units of all quantities: {quantity: unit}."""
        return {
            v.name: v.unit
            for v in (*self.outputs, *(quantity.output_variable for quantity in self.derived_outputs))
        }


def find_load_curves(joint_kind: JointKind) -> LoadCurves:
    """Find the quantities that a kind of joint has along a load ramp, in its module `uncertainty`.

    Raises ValueError if the joint has none.
    """
    module = load_tool_module(joint_kind, "uncertainty")
    if module is None:
        raise ValueError(f"joint = {joint_kind.name!r} states no quantities along a load ramp")
    curves: LoadCurves = module.UNCERTAINTY_CURVES
    return curves


def spline_weights(knots: Array, abscissas: Array, derivative_order: int = 0) -> Array:
    """Matrix (points, knots) that gives values of a cubic spline at points from its values at knots.

    derivative_order : order of the derivative; -1: integral from the first knot

    The samples of a study have the same knots and points but for round-off: both are rounded to 1e-12.
    """
    return _spline_weights(np.round(knots, 12).tobytes(), np.round(abscissas, 12).tobytes(), derivative_order)


@lru_cache(maxsize=16)
def _spline_weights(knots: bytes, abscissas: bytes, derivative_order: int) -> Array:
    """Matrix of `spline_weights` for rounded knots and points, cached."""
    from scipy.interpolate import CubicSpline  # takes most of the start of a process that runs FMUs

    x = np.frombuffer(knots)
    spline = CubicSpline(x, np.eye(x.size))
    spline = (
        spline.antiderivative()
        if derivative_order < 0
        else spline.derivative(derivative_order)
        if derivative_order
        else spline
    )
    return np.asarray(spline(np.frombuffer(abscissas)))
