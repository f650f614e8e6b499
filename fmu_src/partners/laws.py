"""Equations of the partner FMUs: inertia, mass, and prescribed loads and motions.

A partner is an FMU that is connected to a joint in a system.
"""

from collections.abc import Mapping
from dataclasses import dataclass, make_dataclass
from math import comb
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from jointfmu.quantity import CheckedParameters, Number, quantity_field, smooth_step, smooth_step_slopes

GRAVITY = 9.80665
"""Standard acceleration of free fall [m/s2]."""


def _declare_lag_parameter(flange_name: str) -> Any:
    """Declare a body's parameter: delay of the force or torque on a flange in communication steps [1]."""
    doc = (
        f"delay of the load on {flange_name} in communication steps: 1 if a joint feeds it "
        f"in a parallel master, else 0"
    )
    return quantity_field("1", doc, ge=0.0, le=1.0)


@dataclass(frozen=True, kw_only=True)
class RotationalInertia(CheckedParameters):
    """Rotational inertia (pendulum) loaded by two torques and its weight."""

    inertia_name: ClassVar[str] = "J"
    J: float = quantity_field("kg.m2", "moment of inertia about the axis", gt=0.0)
    m: float = quantity_field("kg", "mass on which the weight acts", ge=0.0)
    l: float = quantity_field("m", "distance from the axis to the centre of mass", ge=0.0)  # noqa: E741
    lag_a: float = _declare_lag_parameter("a")
    lag_b: float = _declare_lag_parameter("b")

    def evaluate_outputs(self, variable_values: Mapping[str, Number]) -> dict[str, Number]:
        """Angle [rad] of the inertia from the hanging position, speed [rad/s], acceleration [rad/s2]."""
        weight = self.m * GRAVITY * self.l * np.sin(variable_values["phi"])
        return {
            "phi": variable_values["phi"],
            "w": variable_values["w"],
            "a": (variable_values["tau_a"] + variable_values["tau_b"] - weight) / self.J,
        }


@dataclass(frozen=True, kw_only=True)
class TranslationalMass(CheckedParameters):
    """Mass that moves along a line, loaded by two forces."""

    inertia_name: ClassVar[str] = "m"
    m: float = quantity_field("kg", "mass", gt=0.0)
    lag_a: float = _declare_lag_parameter("a")
    lag_b: float = _declare_lag_parameter("b")

    def evaluate_outputs(self, variable_values: Mapping[str, Number]) -> dict[str, Number]:
        """Position [m], speed [m/s] and acceleration [m/s2] of the mass under its forces."""
        return {
            "s": variable_values["s"],
            "v": variable_values["v"],
            "a": (variable_values["f_a"] + variable_values["f_b"]) / self.m,
        }


@dataclass(frozen=True, kw_only=True)
class _RampAndPulseLoad(CheckedParameters):
    """Force or torque as a function of time: a ramp that stays at its end value, plus a pulse.

    Subclasses define the heights of ramp and pulse.
    """

    ramp_start: float = quantity_field("s", "start time of the ramp")
    ramp_duration: float = quantity_field("s", "duration of the ramp", gt=0.0)
    pulse_start: float = quantity_field("s", "start time of the pulse")
    pulse_rise: float = quantity_field("s", "rise time and fall time of the pulse", gt=0.0)
    pulse_hold: float = quantity_field("s", "duration of the plateau of the pulse", ge=0.0)

    def find_corner_times(self) -> tuple[Number, ...]:
        """Times [s] at which a ramp or an edge of the pulse begins or ends."""
        top, fall = self.pulse_start + self.pulse_rise, self.pulse_start + self.pulse_rise + self.pulse_hold
        ramp = (self.ramp_start, self.ramp_start + self.ramp_duration)
        return (*ramp, self.pulse_start, top, fall, fall + self.pulse_rise)

    def evaluate_load(self, simulation_time: Number, ramp_height: Number, pulse_height: Number) -> Number:
        """Force [N] or torque [N.m] at a time [s], for an end value of the ramp and a peak of the pulse."""
        rise = smooth_step((simulation_time - self.pulse_start) / self.pulse_rise)
        fall = smooth_step(
            (simulation_time - self.pulse_start - self.pulse_rise - self.pulse_hold) / self.pulse_rise
        )
        return ramp_height * smooth_step(
            (simulation_time - self.ramp_start) / self.ramp_duration
        ) + pulse_height * (rise - fall)


@dataclass(frozen=True, kw_only=True)
class TorqueProfile(_RampAndPulseLoad):
    """Prescribed torque over time: ramp and pulse."""

    ramp_height: float = quantity_field("N.m", "torque at the end of the ramp")
    pulse_height: float = quantity_field("N.m", "torque of the plateau of the pulse")

    def evaluate_outputs(self, variable_values: Mapping[str, Number]) -> dict[str, Number]:
        """Prescribed torque [N.m] at the time of the variables, plus the input torque."""
        return {
            "tau": variable_values["tau_in"]
            + self.evaluate_load(variable_values["time"], self.ramp_height, self.pulse_height)
        }


@dataclass(frozen=True, kw_only=True)
class ForceProfile(_RampAndPulseLoad):
    """Prescribed force over time: ramp and pulse."""

    ramp_height: float = quantity_field("N", "force at the end of the ramp")
    pulse_height: float = quantity_field("N", "force of the plateau of the pulse")

    def evaluate_outputs(self, variable_values: Mapping[str, Number]) -> dict[str, Number]:
        """Prescribed force [N] at the time of the variables, plus the input force."""
        return {
            "f": variable_values["f_in"]
            + self.evaluate_load(variable_values["time"], self.ramp_height, self.pulse_height)
        }


@dataclass(frozen=True, kw_only=True)
class AngleProfile(CheckedParameters):
    """Prescribed rotation from rest to rest over time, as of a motor that follows its command exactly."""

    start: float = quantity_field("s", "start time of the rotation")
    duration: float = quantity_field("s", "duration of the rotation", gt=0.0)
    height: float = quantity_field("rad", "angle of the rotation")

    def find_corner_times(self) -> tuple[Number, ...]:
        """Times [s] at which the rotation begins and ends."""
        return (self.start, self.start + self.duration)

    def evaluate_outputs(self, variable_values: Mapping[str, Number]) -> dict[str, Number]:
        """Prescribed angle [rad] and angular speed [rad/s], plus the input angle and speed."""
        x = (variable_values["time"] - self.start) / self.duration
        rate, _ = smooth_step_slopes(x)
        return {
            "phi": variable_values["phi_in"] + self.height * smooth_step(x),
            "w": variable_values["w_in"] + self.height * rate / self.duration,
        }


TORQUE_CURVE_CONTROL_POINT_COUNT = 17
"""Number of control points of a TorqueCurve [1]."""


_TORQUE_CONTROL_POINT_NAMES = [f"p{k + 1}" for k in range(TORQUE_CURVE_CONTROL_POINT_COUNT)]
"""Parameter names of the control points: p1, p2, ..."""


@dataclass(frozen=True, kw_only=True)
class _BernsteinTorque(CheckedParameters):
    """Prescribed torque over time as a Bernstein polynomial; constant before its start and after its end."""

    start: float = quantity_field("s", "start time of the curve")
    duration: float = quantity_field("s", "duration of the curve", gt=0.0)

    @staticmethod
    def basis_functions(normalized_time: Number) -> list[Number]:
        """Bernstein polynomials (17): weights of the control points at a time scaled to 0 ... 1."""
        r = np.fmin(np.fmax(normalized_time, 0.0), 1.0)
        last = TORQUE_CURVE_CONTROL_POINT_COUNT - 1
        return [
            comb(last, k) * r**k * (1.0 - r) ** (last - k) for k in range(TORQUE_CURVE_CONTROL_POINT_COUNT)
        ]

    @classmethod
    def fit_control_points(
        cls, normalized_times: NDArray[np.float64], torque_values: NDArray[np.float64]
    ) -> dict[str, float]:
        """Fit control points {name: torque [N.m]} to a torque curve by least squares; exact at both ends.

        normalized_times : (n) times of the curve [1], 0 to 1
        torque_values    : (n) torques at these times [N.m]
        """
        weights = np.stack(cls.basis_functions(normalized_times), axis=1)
        ends = [0, TORQUE_CURVE_CONTROL_POINT_COUNT - 1]
        remainder = torque_values - weights[:, ends] @ torque_values[[0, -1]]
        inner, *_ = np.linalg.lstsq(weights[:, 1:-1], remainder, rcond=None)
        points = [torque_values[0], *inner, torque_values[-1]]
        return dict(zip(_TORQUE_CONTROL_POINT_NAMES, map(float, points), strict=True))

    def find_corner_times(self) -> tuple[Number, ...]:
        """Times [s] at which the prescribed torque begins and ends to change."""
        return (self.start, self.start + self.duration)

    def evaluate_outputs(self, variable_values: Mapping[str, Number]) -> dict[str, Number]:
        """Prescribed torque [N.m] at the time of the variables, plus the input torque."""
        weights = self.basis_functions((variable_values["time"] - self.start) / self.duration)
        terms = [
            getattr(self, name) * weight
            for name, weight in zip(_TORQUE_CONTROL_POINT_NAMES, weights, strict=True)
        ]
        return {"tau": variable_values["tau_in"] + sum(terms)}


def _define_control_point(point_name: str) -> tuple[str, type, Any]:
    """Define the dataclass field of the torque [N.m] at one control point of the Bernstein polynomial."""
    doc = (
        f"torque at point {point_name[1:]} of {TORQUE_CURVE_CONTROL_POINT_COUNT} of the Bernstein polynomial"
    )
    return point_name, float, quantity_field("N.m", doc)


TorqueCurve: type[_BernsteinTorque] = make_dataclass(
    "TorqueCurve",
    [_define_control_point(name) for name in _TORQUE_CONTROL_POINT_NAMES],
    bases=(_BernsteinTorque,),
    namespace={"__doc__": _BernsteinTorque.__doc__, "__module__": __name__},
    frozen=True,
    kw_only=True,
)
