"""Table of units: quantity, size in SI units and display units; parser for units in input files.

Units are written as in FMI and Modelica: symbols with exponents, joined by dots, the divisors after a slash,
`N.m.s/rad`. The parser also reads common spellings, `Nm`, `N*m`, `N·m`, `mm²`, `N/mm^2`, `°`, and a power of
ten before the unit, as in columns of catalogues: `1e4 N.m/rad`, `x10^4 Nm/rad`.
Sizes are computed as exact fractions and rounded once.
"""

import re
from collections.abc import Mapping
from fractions import Fraction
from functools import cache
from math import degrees, log10, tau
from typing import NamedTuple, TypeAlias

UnitSizes: TypeAlias = Mapping[str, float]
"""{unit: size in SI units}; the first key is the SI unit."""

_FORCE_EXPONENTS = {"kg": 1, "m": 1, "s": -2}
"""Exponents of the SI base units of the newton."""
_PRESSURE_EXPONENTS = {"kg": 1, "m": -1, "s": -2}
"""Exponents of the SI base units of the pascal."""
_DEGREE_IN_RAD = 1 / Fraction(degrees(1.0))
"""Size of a degree in radians, as an exact fraction of a float."""
_UNIT_SYMBOLS: dict[str, tuple[Fraction | int, dict[str, int]]] = {
    "1": (1, {}),
    "kg": (1, {"kg": 1}),
    "m": (1, {"m": 1}),
    "s": (1, {"s": 1}),
    "K": (1, {"K": 1}),
    "rad": (1, {"rad": 1}),
    "Hz": (1, {"s": -1}),
    "N": (1, _FORCE_EXPONENTS),
    "kgf": (Fraction("9.80665"), _FORCE_EXPONENTS),
    "lbf": (Fraction("4.4482216152605"), _FORCE_EXPONENTS),
    "Pa": (1, _PRESSURE_EXPONENTS),
    "bar": (100000, _PRESSURE_EXPONENTS),
    "psi": (Fraction("4.4482216152605") / Fraction("0.0254") ** 2, _PRESSURE_EXPONENTS),
    "J": (1, {"kg": 1, "m": 2, "s": -2}),
    "W": (1, {"kg": 1, "m": 2, "s": -3}),
    "t": (1000, {"kg": 1}),
    "min": (60, {"s": 1}),
    "deg": (_DEGREE_IN_RAD, {"rad": 1}),
    "arcmin": (_DEGREE_IN_RAD / 60, {"rad": 1}),
    "arcsec": (_DEGREE_IN_RAD / 3600, {"rad": 1}),
    "rev": (Fraction(tau), {"rad": 1}),
}
"""{symbol: (size in SI units, exponents of the SI base units)}; the radian counts as a base unit."""
_PREFIX_EXPONENTS = {"G": 9, "M": 6, "k": 3, "c": -2, "m": -3, "u": -6, "µ": -6, "μ": -6, "n": -9}
"""{prefix of a unit: power of ten}, for the symbols in _PREFIXED_SYMBOLS; both Unicode signs for micro."""
_PREFIXED_SYMBOLS = ("m", "s", "rad", "Hz", "N", "Pa", "J", "W")
"""Symbols of units that may have a prefix (km, mm, ...)."""
_UNIT_FACTOR_PATTERN = re.compile(r"([^\W\d_]+|1(?!\d))(\d*)")
"""Pattern of one factor of a unit: symbol and exponent."""
_POWER_OF_TEN_PATTERN = re.compile(
    r"[x\u00d7]?\s*(?:1e|10\s?\^\s?|10(?=[⁰¹²³⁴⁵⁶⁷⁸⁹⁻]))([+-]?\d+|[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)\s*[.*·⋅]?\s*(?=\D)"
)
"""Pattern of a power of ten before a unit: `1e4`, `x10^4`, `10⁴`."""
MAX_POWER_OF_TEN = 12
"""Largest absolute exponent of a power of ten before a unit [1]."""
_SUPERSCRIPT_DIGITS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")
"""Translation of superscript digits to ordinary ones."""

_SPELLING_REPLACEMENTS = (
    (re.compile(r"[·⋅*]"), "."),
    (re.compile(r"\^(?=\d)"), ""),
    (re.compile("²"), "2"),
    (re.compile("³"), "3"),
    (re.compile(r"°|\bdegrees?\b"), "deg"),
    (re.compile("\u2032"), "arcmin"),
    (re.compile("\u2033"), "arcsec"),
    (re.compile(r"(?<![^\W_])([kmuµμ]?N|kgf)(?=[mcuµμ]?m(?![^\W_]))"), r"\1."),
)
"""(pattern of another spelling, replacement in FMI notation); the last: force times length without a dot."""


class Unit(NamedTuple):
    """SI unit: the quantity that it measures, its base units, its display units.

    quantity        : name of the quantity, as in the Modelica Standard Library if defined there
    base_exponents  : exponents of the SI base units
    display_factors : {display unit: factor}, displayed value = SI value * factor
    """

    quantity: str
    base_exponents: Mapping[str, int]
    display_factors: Mapping[str, float]


def unit_size(unit: str) -> float:
    """Size of a unit in SI units. Raises ValueError if the unit is unknown."""
    return float(_parse_unit(unit)[0])


def base_exponents(unit: str) -> dict[str, int]:
    """Exponents of the SI base units of a unit, without zeros. Raises ValueError if the unit is unknown."""
    return dict(_parse_unit(unit)[1])


def conversion_factor(unit: str, target_unit: str) -> float:
    """Factor that converts a value in `unit` to `target_unit`; ValueError if their quantities differ."""
    (size, exponents), (target_size, target_exponents) = _parse_unit(unit), _parse_unit(target_unit)
    if exponents != target_exponents:
        raise ValueError(f"unit {unit!r} measures another quantity than {target_unit!r}")
    return float(size / target_size)


def unit_sizes(unit: str, *other_units: str) -> UnitSizes:
    """Sizes {unit: size in the first unit} of the units that an input accepts, the SI unit first.

    Raises ValueError if the units measure different quantities.
    """
    return {name: conversion_factor(name, unit) for name in (unit, *other_units)}


def unit_size_in(unit: str, accepted_units: UnitSizes) -> float:
    """Size of a unit in the first unit of `accepted_units`; any unit of the same quantity is possible.

    accepted_units : {unit: size in the first unit}

    Raises ValueError if the unit is unknown or measures another quantity.
    """
    return (
        accepted_units[unit]
        if unit in accepted_units
        else conversion_factor(unit, next(iter(accepted_units)))
    )


def replace_symbols(unit_text: str, symbol_replacements: Mapping[str, str]) -> str:
    """Replace symbols in a unit: `N/m3` with {"m": "mm"} becomes `N/mm3`."""
    return _UNIT_FACTOR_PATTERN.sub(
        lambda match: symbol_replacements.get(match[1], match[1]) + match[2], unit_text
    )


@cache
def _parse_unit(unit: str) -> tuple[Fraction, dict[str, int]]:
    """Parse a unit: its size in SI units, and its exponents of the SI base units.

    Raises ValueError if the unit is unknown.
    """
    total, exponents = Fraction(1), dict[str, int]()
    notation_text = unit
    if ten := _POWER_OF_TEN_PATTERN.match(notation_text):
        power = int(ten[1].translate(_SUPERSCRIPT_DIGITS))
        if abs(power) <= MAX_POWER_OF_TEN:
            total, notation_text = total * Fraction(10) ** power, notation_text[ten.end() :]
    for spelling, notation in _SPELLING_REPLACEMENTS:
        notation_text = spelling.sub(notation, notation_text)
    numerator, slash, denominator = notation_text.partition("/")
    for sign, product in ((1, numerator), (-1, denominator if slash else "1")):
        for text in product.split("."):
            if not (match := _UNIT_FACTOR_PATTERN.fullmatch(text)):
                raise ValueError(f"unit {unit!r} cannot be read; expected unit symbols, as in N.m.s/rad")
            power = sign * int(match[2] or 1)
            symbol_size, symbol_exponents = _parse_symbol(match[1], unit)
            total *= symbol_size**power
            for name, exponent in symbol_exponents.items():
                exponents[name] = exponents.get(name, 0) + power * exponent
    return total, {name: exponent for name, exponent in exponents.items() if exponent}


def _parse_symbol(unit_symbol: str, unit: str) -> tuple[Fraction, dict[str, int]]:
    """Parse one symbol of a unit, with or without a prefix (km): size in SI units, exponents of base units.

    unit : whole unit, for the error
    """
    if unit_symbol in _UNIT_SYMBOLS:
        symbol_size, symbol_exponents = _UNIT_SYMBOLS[unit_symbol]
        return Fraction(symbol_size), symbol_exponents
    exponent, rest = _PREFIX_EXPONENTS.get(unit_symbol[0]), unit_symbol[1:]
    if exponent is None or rest not in _PREFIXED_SYMBOLS:
        raise ValueError(
            f"unit {unit!r}: symbol {unit_symbol!r} is unknown, allowed are {', '.join(_UNIT_SYMBOLS)}"
        )
    return Fraction(10) ** exponent, _UNIT_SYMBOLS[rest][1]


def _make_unit(unit_name: str, quantity: str, *display_units: str) -> Unit:
    """Make a unit of the table UNITS, with factors to its display units."""
    return Unit(
        quantity,
        base_exponents(unit_name),
        {
            display_name: conversion_factor(unit_name, display_name)
            for display_name in display_units or (unit_name,)
        },
    )


UNITS: Mapping[str, Unit] = {
    name: _make_unit(name, *quantity_and_display)
    for name, quantity_and_display in {
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
        "W": ("Power",),
        "K": ("ThermodynamicTemperature",),
        "1/K": ("LinearTemperatureCoefficient",),
        "kg": ("Mass",),
        "kg.m2": ("MomentOfInertia",),
        "kg/m3": ("Density",),
    }.items()
}
"""{SI unit: quantity, base units, display units} for all variables, parameters and files."""

CELSIUS_UNIT = "degC"
CELSIUS_ZERO_IN_KELVIN = 273.15
"""Display unit of temperatures in FMUs, and its zero point [K]; files and pages use kelvin."""
LUBRICANT_TEMPERATURE_RANGE = 193.15, 473.15
"""Temperature range [K] in which lubricants work: -80 to 200 degrees C."""


def display_unit(unit: str, typical_value: float) -> str:
    """Display unit in which a typical value is nearest to 30; the first display unit if the value is zero."""
    names = UNITS[unit].display_factors
    if typical_value == 0.0:
        return next(iter(names))
    return min(names, key=lambda name: abs(log10(abs(typical_value) * names[name] / 30.0)))
