"""Units of all variables: SI base units, the quantity they measure, and the display unit that people read."""

from math import log10
from typing import NamedTuple


class Unit(NamedTuple):
    """Name of the quantity, as in the Modelica Standard Library where it has one, exponents of the SI base
    units, and display units as {name: factor}: display = value * factor.
    """

    quantity: str
    base: dict[str, int]
    display: dict[str, float]


_DEG = 57.29577951308232

UNITS: dict[str, Unit] = {
    "1": Unit("Ratio", {}, {"1": 1.0}),
    "s": Unit("Time", {"s": 1}, {"s": 1.0}),
    "rad": Unit("Angle", {"rad": 1}, {"deg": _DEG, "arcmin": 60.0 * _DEG}),
    "rad/s": Unit("AngularVelocity", {"rad": 1, "s": -1}, {"rev/min": 60.0 / 6.283185307179586}),
    "rad/s2": Unit("AngularAcceleration", {"rad": 1, "s": -2}, {"rad/s2": 1.0}),
    "m": Unit("Length", {"m": 1}, {"mm": 1e3, "um": 1e6}),
    "m/s": Unit("Velocity", {"m": 1, "s": -1}, {"mm/s": 1e3}),
    "m/s2": Unit("Acceleration", {"m": 1, "s": -2}, {"m/s2": 1.0}),
    "m2": Unit("Area", {"m": 2}, {"mm2": 1e6, "um2": 1e12}),
    "N": Unit("Force", {"kg": 1, "m": 1, "s": -2}, {"kN": 1e-3}),
    "N.m": Unit("Torque", {"kg": 1, "m": 2, "s": -2}, {"N.m": 1.0}),
    "N.m/rad": Unit(
        "RotationalSpringConstant",
        {"kg": 1, "m": 2, "s": -2, "rad": -1},
        {"N.m/arcmin": 1.0 / (60.0 * _DEG)},
    ),
    "N.m.s/rad": Unit("RotationalDampingConstant", {"kg": 1, "m": 2, "s": -1, "rad": -1}, {"N.m.s/rad": 1.0}),
    "N/m": Unit("TranslationalSpringConstant", {"kg": 1, "s": -2}, {"N/um": 1e-6}),
    "N.s/m": Unit("TranslationalDampingConstant", {"kg": 1, "s": -1}, {"kN.s/m": 1e-3}),
    "Pa": Unit("Pressure", {"kg": 1, "m": -1, "s": -2}, {"MPa": 1e-6, "GPa": 1e-9}),
    "Pa/m": Unit("PressureGradient", {"kg": 1, "m": -2, "s": -2}, {"MPa/um": 1e-12}),
    "Pa/m2": Unit("PressureCurvature", {"kg": 1, "m": -3, "s": -2}, {"MPa/um2": 1e-18}),
    "kg.m2": Unit("MomentOfInertia", {"kg": 1, "m": 2}, {"kg.m2": 1.0}),
    "kg": Unit("Mass", {"kg": 1}, {"kg": 1.0}),
}


def display_unit(unit: str, typical: float) -> str:
    """The display unit in which a typical value reads best: nearest to 30, the first if it is zero."""
    names = UNITS[unit].display
    if typical == 0.0:
        return next(iter(names))
    return min(names, key=lambda name: abs(log10(abs(typical) * names[name] / 30.0)))
