"""Numbers of `jointfmu new`: quantity, unit and plausible range of every option, in one table; their parser.

A number without a unit has the unit of its option. If it is outside the plausible range, the user probably
means another unit (metres instead of millimetres): the number is refused, and the message says what to write.
A number with its unit is refused only outside the limits of its quantity.
"""

import math
import re
from collections.abc import Mapping
from dataclasses import KW_ONLY, dataclass, field
from typing import NamedTuple

from jointfmu.quantity.units import conversion_factor

from ...common.options import format_option_flag
from .reading import NUMBER_PATTERN, check_separators

_RANGE_PATTERN = re.compile(r"(.+?)\s*\.\.\s*(.+)")
"""Pattern of a range LOW..HIGH."""


@dataclass(frozen=True, slots=True)
class DrawingQuantity:
    """Quantity of a drawing option: unit, plausible range, limits.

    meaning         : the quantity in words
    unit            : unit of a number that the user states without one
    si_unit         : SI unit
    plausible_range : plausible magnitude of a number without a unit [unit]
    limits          : allowed values with any unit [unit]; the lower one is excluded unless `allows_zero`
    other_units     : units that users mistake for `unit`
    extra_units     : {unit that only this quantity has: its size [si_unit]}
    allows_zero     : whether 0 is a value
    has_sign        : whether negative numbers are values
    allows_range    : whether LOW..HIGH is a value
    """

    meaning: str
    unit: str
    si_unit: str
    plausible_range: tuple[float, float] = (0.0, math.inf)
    _: KW_ONLY
    limits: tuple[float, float] = (0.0, math.inf)
    other_units: tuple[str, ...] = ()
    extra_units: Mapping[str, float] = field(default_factory=dict)
    allows_zero: bool = False
    has_sign: bool = False
    allows_range: bool = False


class StatedNumber(NamedTuple):
    """Number that the user states for an option, with its range, in SI units.

    Without a range, low = value = high.
    """

    value: float
    low: float
    high: float

    @property
    def is_range(self) -> bool:
        """Whether the user states a range for the number."""
        return self.high > self.low


MIN_HEIGHT = 1e-4
"""Smallest plausible roughness height of a surface [um]: polished silicon wafers have twice as much."""
KGF_PER_MM2 = 9.80665e6
"""Unit of Brinell and Vickers hardness [Pa]: kgf/mm2."""
BRINELL_AND_VICKERS = dict.fromkeys(("HB", "HBW", "HV"), KGF_PER_MM2)
"""Units of hardness that a number may have, with their size [Pa]."""


def _declare_length(
    meaning: str,
    min_plausible: float,
    max_plausible: float,
    *,
    max_allowed: float = math.inf,
    allows_zero: bool = False,
    has_sign: bool = False,
) -> DrawingQuantity:
    """Declare a length in mm, with its plausible range [mm] and a limit [mm]."""
    return DrawingQuantity(
        meaning,
        "mm",
        "m",
        (min_plausible, max_plausible),
        limits=(0.0, max_allowed),
        other_units=("m", "um"),
        allows_zero=allows_zero,
        has_sign=has_sign,
    )


def _declare_height(name: str, max_plausible: float) -> DrawingQuantity:
    """Declare a roughness height in um, up to a plausible limit [um]."""
    return DrawingQuantity(
        f"{name} of machined surfaces",
        "um",
        "m",
        (0.005, max_plausible),
        limits=(MIN_HEIGHT, max_plausible),
        other_units=("m", "mm", "nm"),
        allows_range=True,
    )


def _declare_friction(meaning: str) -> DrawingQuantity:
    """Declare a coefficient of friction; clean pairs of the same metal in air have 0.8 to 1.5."""
    return DrawingQuantity(meaning, "1", "1", limits=(0.0, 2.0), allows_range=True)


def _declare_torque(
    meaning: str,
    min_plausible: float,
    max_plausible: float,
    *,
    allows_zero: bool = False,
    allows_range: bool = False,
) -> DrawingQuantity:
    """Declare a torque in N.m, with its plausible range [N.m]."""
    return DrawingQuantity(
        meaning,
        "N.m",
        "N.m",
        (min_plausible, max_plausible),
        other_units=("kN.m", "mN.m"),
        allows_zero=allows_zero,
        allows_range=allows_range,
    )


QUANTITIES: Mapping[str, DrawingQuantity] = {
    # bolted joint
    "plate": _declare_length("length or width of a plate", 4.0, 2e4),
    "at": _declare_length("position of a bolt", 1.0, 2e4, allows_zero=True, has_sign=True),
    "circle": _declare_length("diameter of a pitch circle", 4.0, 2e4),
    "grip": _declare_length("clamped length", 0.5, 5e3),
    "thickness": _declare_length("thickness of a plate", 0.5, 3e3),
    "hole": _declare_length("diameter of a hole", 2.0, 150.0, max_allowed=150.0),
    "bearing": _declare_length("diameter of a bearing surface", 3.0, 400.0, max_allowed=400.0),
    "washers": _declare_length("diameter or thickness of a washer", 0.2, 400.0, max_allowed=400.0),
    "preload": DrawingQuantity(
        "preload of a bolt", "N", "N", (100.0, 3e6), other_units=("kN",), allows_range=True
    ),
    "embedding": DrawingQuantity(
        "preload loss of a bolt",
        "N",
        "N",
        (5.0, 1e6),
        other_units=("kN",),
        allows_zero=True,
        allows_range=True,
    ),
    "thread_friction": _declare_friction("coefficient of friction in the thread"),
    "head_friction": _declare_friction("coefficient of friction under the head"),
    # faces
    "Ra": _declare_height("Ra", 100.0),
    "Rq": _declare_height("Rq", 100.0),
    "Rz": _declare_height("Rz", 600.0),
    "longest_wave": DrawingQuantity(
        "longest wavelength of a roughness",
        "mm",
        "m",
        (0.02, 25.0),
        limits=(0.0, 1e3),
        other_units=("m", "um"),
        allows_range=True,
    ),
    "hardness": DrawingQuantity(
        "hardness",
        "MPa",
        "Pa",
        (300.0, 15e3),
        limits=(0.0, 1e5),
        other_units=("Pa", "GPa"),
        extra_units=BRINELL_AND_VICKERS,
        allows_range=True,
    ),
    "mu": _declare_friction("coefficient of friction of metals"),
    # gears
    "module": _declare_length("normal module", 0.1, 60.0),
    "teeth": DrawingQuantity("number of teeth", "1", "1"),
    "width": _declare_length("width of a face", 0.5, 3e3),
    "radii": _declare_length("radius of curvature of a flank", 0.5, 1e5, has_sign=True),
    "load": DrawingQuantity("normal load", "N", "N", (0.5, 1e8), other_units=("kN", "mN")),
    "pressure_angle": DrawingQuantity(
        "pressure angle", "deg", "rad", (1.0, math.inf), other_units=("rad",), has_sign=True
    ),
    "helix_angle": DrawingQuantity(
        "helix angle", "deg", "rad", (1.0, math.inf), other_units=("rad",), allows_zero=True, has_sign=True
    ),
    "profile_shift": DrawingQuantity(
        "profile shift coefficient", "1", "1", limits=(0.0, 2.0), allows_zero=True, has_sign=True
    ),
    "centre_distance": _declare_length("centre distance", 1.0, 2e4),
    "tip_diameter": _declare_length("tip diameter of a wheel", 0.5, 2e4),
    "dedendum": DrawingQuantity("dedendum over the module", "1", "1", limits=(1.0, 2.0)),
    "backlash": DrawingQuantity(
        "backlash", "um", "m", (0.5, 2e4), limits=(0.0, 1e5), other_units=("m", "mm", "nm"), allows_range=True
    ),
    # bolts and gears
    "torque": _declare_torque("torque", 0.01, 1e7, allows_range=True),
    # drives
    "ratio": DrawingQuantity("ratio of a drive", "1", "1", has_sign=True),
    "K1": DrawingQuantity("stiffness up to T1", "N.m/rad", "N.m/rad"),
    "K2": DrawingQuantity("stiffness from T1 to T2", "N.m/rad", "N.m/rad"),
    "K3": DrawingQuantity("stiffness above T2", "N.m/rad", "N.m/rad"),
    "T1": _declare_torque("torque T1", 0.01, 1e5),
    "T2": _declare_torque("torque T2", 0.01, 1e5),
    "rated_torque": _declare_torque("rated torque", 0.01, 1e5),
    "hysteresis": DrawingQuantity(
        "hysteresis loss", "arcmin", "rad", (0.01, 20.0), other_units=("rad", "deg", "arcsec")
    ),
    "lost_motion": DrawingQuantity(
        "lost motion", "arcmin", "rad", (0.01, 60.0), other_units=("rad", "deg", "arcsec")
    ),
    "rigidity": DrawingQuantity(
        "torsional rigidity",
        "N.m/arcmin",
        "N.m/rad",
        (0.1, 1e4),
        other_units=("N.m/rad", "kN.m/rad", "kgf.m/arcmin"),
    ),
    "peak_torque": _declare_torque("largest permissible torque", 0.01, 1e6),
    "starting_torque": _declare_torque("starting torque", 1e-4, 100.0),
    "running_torque": _declare_torque("running torque", 1e-4, 100.0),
    "back_driving_torque": _declare_torque("back-driving torque", 1e-3, 1e4),
    "efficiency": DrawingQuantity("efficiency", "1", "1", extra_units={"%": 0.01}),
    "motor_drag": _declare_torque("motor drag", 1e-5, 100.0, allows_zero=True),
    "corner": DrawingQuantity("relative width of a corner", "1", "1", has_sign=True),
}
"""{option of `jointfmu new`: quantity}: the same option has the same quantity in all joints."""


def parse_quantity(option_name: str, text: str, default_unit: str | None = None) -> StatedNumber:
    """Parse the number of an option, or its range LOW..HIGH; the value of a range is its middle.

    option_name  : name of the option, a key of QUANTITIES
    default_unit : unit of a number without one, if it differs from that of the quantity; such a number is
                   not compared with the plausible range

    Raises ValueError, one line, for text that is not a number, a wrong unit, or a value that is not allowed
    or not plausible.
    """
    quantity = QUANTITIES[option_name]
    match = _RANGE_PATTERN.fullmatch(text.strip())
    if not match:
        value = _parse_value(option_name, text, default_unit)
        return StatedNumber(value, value, value)
    if not quantity.allows_range:
        raise ValueError(f"{format_option_flag(option_name)} = {text!r} is a range; expected one number")
    unit = number[2] if (number := NUMBER_PATTERN.fullmatch(match[2])) else ""
    has_unit = (first := NUMBER_PATTERN.fullmatch(match[1])) is None or first[2]
    low, high = (
        _parse_value(option_name, end, default_unit)
        for end in (match[1] if has_unit else match[1] + unit, match[2])
    )
    if not low < high:
        raise ValueError(f"{format_option_flag(option_name)} = {text!r} is not a range; expected LOW..HIGH")
    return StatedNumber(0.5 * (low + high), low, high)


def parse_value(option_name: str, text: str, default_unit: str | None = None) -> float:
    """Parse the number of an option in its SI unit. Raises ValueError as `parse_quantity`, or for a range."""
    number = parse_quantity(option_name, text, default_unit)
    if number.is_range:
        raise ValueError(f"{format_option_flag(option_name)} = {text!r} is a range; expected one number")
    return number.value


def parse_values(option_name: str, text: str, *, separator: str, value_count: int) -> list[float]:
    """Parse several numbers of an option with a separator between them, as in 200x100.

    value_count : how many numbers there must be

    Raises ValueError for another count, and as `parse_value`.
    """
    words = text.split(separator)
    if len(words) != value_count:
        example = separator.join(["200", "100"][:value_count])
        raise ValueError(
            f"{format_option_flag(option_name)} = {text!r} has {len(words)} numbers, expected "
            f"{value_count}, as in {example}"
        )
    return [parse_value(option_name, word) for word in words]


def _parse_value(option_name: str, number_text: str, default_unit: str | None) -> float:
    """Parse one number in the SI unit of its option."""
    quantity, flag = QUANTITIES[option_name], format_option_flag(option_name)
    unit = default_unit or quantity.unit
    example = f"expected a number in {unit}, or with its unit as in 1{unit}"
    if unit == "1":
        example = "expected a number without a unit"
    check_separators(option_name, number_text)
    match = NUMBER_PATTERN.fullmatch(number_text.strip())
    if not match:
        raise ValueError(f"{flag} = {number_text!r} is not a number; {example}")
    number, stated_unit = float(match[1]), match[2]
    try:
        value = number * _unit_size(quantity, stated_unit or unit)
    except ValueError as error:
        others = ", ".join(quantity.extra_units)
        raise ValueError(
            f"{flag} = {number_text!r}: {error}; {example}{f', or in {others}' if others else ''}"
        ) from None
    magnitude = value / _unit_size(quantity, quantity.unit)
    low, high = quantity.plausible_range
    if (
        not (stated_unit or default_unit)
        and math.isfinite(magnitude)
        and (magnitude > 0.0 or (quantity.has_sign and magnitude != 0.0))
        and not low <= abs(magnitude) <= high
        and (advice := _advise_unit(quantity, match[1], abs(magnitude)))
    ):
        interval = f"are {low:g} to {high:g}" if high < math.inf else f"is at least {low:g}"
        raise ValueError(
            f"{flag} = {number_text!r} is read as {magnitude:g} {quantity.unit}, plausible {interval} "
            f"{quantity.unit}; {advice}"
        )
    _check_limits(option_name, number_text, magnitude)
    return value


def _check_limits(option_name: str, number_text: str, magnitude: float) -> None:
    """Raise ValueError if a number, in the unit of its option, is outside the limits of its quantity."""
    quantity = QUANTITIES[option_name]
    low, high = quantity.limits
    if quantity.has_sign:
        inside, lower = abs(magnitude) <= high, f"[{-high:g}" if high < math.inf else "(-inf"
    elif quantity.allows_zero:
        inside, lower = low <= magnitude <= high, f"[{low:g}"
    else:
        inside, lower = low < magnitude <= high, f"({low:g}"
    if inside and math.isfinite(magnitude):
        return
    interval = f"{lower}, {high:g}]" if high < math.inf else f"{lower}, inf)"
    unit = "" if quantity.unit == "1" else f" {quantity.unit}"
    raise ValueError(
        f"{format_option_flag(option_name)} = {number_text!r} is outside {interval}{unit}: {quantity.meaning}"
    )


def _unit_size(quantity: DrawingQuantity, unit: str) -> float:
    """Size of a unit in the SI unit of a quantity. Raises ValueError if the unit measures something else."""
    if unit in quantity.extra_units:
        return quantity.extra_units[unit]
    return conversion_factor(unit, quantity.si_unit)


def _advise_unit(quantity: DrawingQuantity, number_text: str, magnitude: float) -> str:
    """Advice what to write instead of a number that is not plausible in the unit of its option.

    magnitude : absolute value of the number [quantity.unit]

    Empty for a number without a unit that no other unit makes plausible, if it is also outside the limits.
    """
    low, high = quantity.plausible_range
    size = _unit_size(quantity, quantity.unit)
    candidates = {_unit_size(quantity, unit): unit for unit in reversed((*quantity.extra_units,))}
    candidates |= {_unit_size(quantity, unit): unit for unit in quantity.other_units}
    advice = [
        f"if it is in {unit}, write {number_text}{unit} ({magnitude * unit_size / size:.4g} {quantity.unit})"
        for unit_size, unit in candidates.items()
        if low <= magnitude * unit_size / size <= high
    ]
    if not advice and quantity.limits[0] <= magnitude <= quantity.limits[1] and quantity.unit != "1":
        advice.append(f"if {quantity.unit} is right, write {number_text}{quantity.unit}")
    return "; ".join(advice)
