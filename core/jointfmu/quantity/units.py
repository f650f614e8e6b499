"""The one table of units: what each measures, how large it is, and in which unit people read it.

A unit is written as FMI and Modelica write it: symbols with exponents, joined by dots, after a slash what
divides, `N.m.s/rad`. What is read may be written as people do: `Nm`, `N*m`, `N·m`, `mm²`, `N/mm^2`, `°`,
and with a power of ten before it, as columns of catalogues have: `1e4 N.m/rad`, `x10^4 Nm/rad`.
Sizes are exact fractions of the symbols' and rounded once.
"""

import re
from collections.abc import Mapping
from fractions import Fraction
from functools import cache
from math import degrees, log10, tau
from typing import NamedTuple, TypeAlias

Sizes: TypeAlias = Mapping[str, float]
"""{unit: its size in the SI unit}, the SI unit first."""

_FORCE = {"kg": 1, "m": 1, "s": -2}
_DEGREE = 1 / Fraction(degrees(1.0))
_SYMBOLS: dict[str, tuple[Fraction | int, dict[str, int]]] = {
    "1": (1, {}),
    "kg": (1, {"kg": 1}),
    "m": (1, {"m": 1}),
    "s": (1, {"s": 1}),
    "K": (1, {"K": 1}),
    "rad": (1, {"rad": 1}),
    "Hz": (1, {"s": -1}),
    "N": (1, _FORCE),
    "kgf": (Fraction("9.80665"), _FORCE),
    "Pa": (1, {"kg": 1, "m": -1, "s": -2}),
    "J": (1, {"kg": 1, "m": 2, "s": -2}),
    "t": (1000, {"kg": 1}),
    "min": (60, {"s": 1}),
    "deg": (_DEGREE, {"rad": 1}),
    "arcmin": (_DEGREE / 60, {"rad": 1}),
    "arcsec": (_DEGREE / 3600, {"rad": 1}),
    "rev": (Fraction(tau), {"rad": 1}),
}
"""Sizes in SI and exponents of the SI base units; the radian counts as one."""
_PREFIXES = {"G": 9, "M": 6, "k": 3, "c": -2, "m": -3, "u": -6, "µ": -6, "μ": -6, "n": -9}
"""Powers of ten, before _PREFIXED; both Unicode signs for micro."""
_PREFIXED = ("m", "s", "rad", "Hz", "N", "Pa", "J")
_FACTOR = re.compile(r"([^\W\d_]+|1(?!\d))(\d*)")
_POWER_OF_TEN = re.compile(
    r"[x\u00d7]?\s*(?:1e|10\s?\^\s?|10(?=[⁰¹²³⁴⁵⁶⁷⁸⁹⁻]))([+-]?\d+|[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)\s*[.*·⋅]?\s*(?=\D)"
)
"""Before a unit."""
MOST_POWER = 12
"""Largest power of ten before a unit, either way [1]."""
_RAISED = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")

_WRITTEN = (
    (re.compile(r"[·⋅*]"), "."),
    (re.compile(r"\^(?=\d)"), ""),
    (re.compile("²"), "2"),
    (re.compile("³"), "3"),
    (re.compile(r"°|\bdegrees?\b"), "deg"),
    (re.compile("\u2032"), "arcmin"),
    (re.compile("\u2033"), "arcsec"),
    (re.compile(r"(?<![^\W_])([kmuµμ]?N|kgf)(?=[mcuµμ]?m(?![^\W_]))"), r"\1."),
)
"""Other ways of writing, and ours; the last one is a force and a length without a dot."""


class Unit(NamedTuple):
    """An SI unit: name of the quantity, as in the Modelica Standard Library where it has one, exponents of
    the SI base units, and display units as {name: factor}: display = value * factor.
    """

    quantity: str
    base: Mapping[str, int]
    display: Mapping[str, float]


def size(unit: str) -> float:
    """How many SI units one unit is; ValueError if the unit is unknown."""
    return float(_parsed(unit)[0])


def base(unit: str) -> dict[str, int]:
    """Exponents of the SI base units, without zeros; ValueError if the unit is unknown."""
    return dict(_parsed(unit)[1])


def factor(unit: str, to: str) -> float:
    """What turns a number in one unit into another unit; ValueError if they measure different things."""
    source, target = _parsed(unit), _parsed(to)
    if source[1] != target[1]:
        raise ValueError(f"unit {to!r} does not measure what {unit!r} does")
    return float(source[0] / target[0])


def sizes(unit: str, *others: str) -> Sizes:
    """The units that a border takes, the SI unit first; ValueError if they measure different things."""
    return {name: factor(name, unit) for name in (unit, *others)}


def measured(unit: str, allowed: Sizes) -> float:
    """The size of a unit in the first of `allowed`, whichever unit of the same quantity it is.

    Raises ValueError if the unit is unknown or measures something else.
    """
    return allowed[unit] if unit in allowed else factor(unit, next(iter(allowed)))


def rewritten(unit: str, symbols: Mapping[str, str]) -> str:
    """A unit with other symbols in the place of some: `N/m3` with m as mm is `N/mm3`."""
    return _FACTOR.sub(lambda match: symbols.get(match[1], match[1]) + match[2], unit)


@cache
def _parsed(unit: str) -> tuple[Fraction, dict[str, int]]:
    """Size and exponents of a unit."""
    whole, exponents = Fraction(1), dict[str, int]()
    plain = unit
    if ten := _POWER_OF_TEN.match(plain):
        power = int(ten[1].translate(_RAISED))
        if abs(power) <= MOST_POWER:
            whole, plain = whole * Fraction(10) ** power, plain[ten.end() :]
    for other, ours in _WRITTEN:
        plain = other.sub(ours, plain)
    above, slash, below = plain.partition("/")
    for sign, part in ((1, above), (-1, below if slash else "1")):
        for text in part.split("."):
            if not (match := _FACTOR.fullmatch(text)):
                raise ValueError(f"unit {unit!r} is none; expected symbols as in N.m.s/rad")
            power = sign * int(match[2] or 1)
            own, its = _symbol(match[1], unit)
            whole *= own**power
            for name, exponent in its.items():
                exponents[name] = exponents.get(name, 0) + power * exponent
    return whole, {name: exponent for name, exponent in exponents.items() if exponent}


def _symbol(symbol: str, unit: str) -> tuple[Fraction, dict[str, int]]:
    """Size and exponents of a symbol, with or without a prefix."""
    if symbol in _SYMBOLS:
        own, its = _SYMBOLS[symbol]
        return Fraction(own), its
    ten, rest = _PREFIXES.get(symbol[0]), symbol[1:]
    if ten is None or rest not in _PREFIXED:
        raise ValueError(f"unit {unit!r}: symbol {symbol!r} is unknown, allowed are {', '.join(_SYMBOLS)}")
    return Fraction(10) ** ten, _SYMBOLS[rest][1]


def _unit(name: str, quantity: str, *display: str) -> Unit:
    return Unit(quantity, base(name), {shown: factor(name, shown) for shown in display or (name,)})


UNITS: Mapping[str, Unit] = {
    name: _unit(name, *told)
    for name, told in {
        "1": ("Ratio",),
        "s": ("Time",),
        "Hz": ("Frequency",),
        "rad": ("Angle", "deg", "arcmin"),
        "rad/s": ("AngularVelocity", "rev/min"),
        "rad/s2": ("AngularAcceleration",),
        "m": ("Length", "mm", "um"),
        "m/s": ("Velocity", "mm/s"),
        "m/s2": ("Acceleration",),
        "m2": ("Area", "mm2", "um2"),
        "N": ("Force", "kN"),
        "N.m": ("Torque",),
        "N.m/rad": ("RotationalSpringConstant", "N.m/arcmin"),
        "N.m.s/rad": ("RotationalDampingConstant",),
        "N/m": ("TranslationalSpringConstant", "N/um"),
        "N.s/m": ("TranslationalDampingConstant", "kN.s/m"),
        "N/m3": ("SpringConstantPerArea", "MPa/um"),
        "Pa": ("Pressure", "MPa", "GPa"),
        "Pa/m": ("PressureGradient", "MPa/um"),
        "Pa/m2": ("PressureCurvature", "MPa/um2"),
        "J": ("Energy",),
        "K": ("ThermodynamicTemperature",),
        "1/K": ("LinearTemperatureCoefficient",),
        "kg": ("Mass",),
        "kg.m2": ("MomentOfInertia",),
        "kg/m3": ("Density",),
    }.items()
}
"""The SI units of all variables, parameters and files: {unit: (quantity, display units)}."""

CELSIUS = "degC"
KELVIN_AT_ZERO = 273.15
"""The display unit of temperatures in FMUs, and its zero in K; files and pages have the SI unit."""
LUBRICANTS = 193.15, 473.15
"""Temperatures [K], -80 to 200 degrees C, between which a lubricant is one."""


def display_unit(unit: str, typical: float) -> str:
    """The display unit in which a typical value reads best: nearest to 30, the first if it is zero."""
    names = UNITS[unit].display
    if typical == 0.0:
        return next(iter(names))
    return min(names, key=lambda name: abs(log10(abs(typical) * names[name] / 30.0)))
