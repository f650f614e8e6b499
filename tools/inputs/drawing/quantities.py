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
from .reading import NUMBER_WITH_UNIT_PATTERN, check_no_comma, split_number_texts

_RANGE_PATTERN = re.compile(r"(.+?)\s*\.\.\s*(.+)")
"""Pattern of a range LOW..HIGH."""


@dataclass(frozen=True, slots=True)
class DrawingQuantity:
    """Quantity of a drawing option: default unit, plausible range, allowed range.

    quantity_name   : the quantity in words
    default_unit    : unit of a number that the user states without one
    si_unit         : SI unit
    plausible_range : plausible magnitude of a number without a unit [default_unit]
    allowed_range   : allowed values with any unit [default_unit]; the lower end is excluded unless
                      `allows_zero`
    mistaken_units  : units that users mistake for `default_unit`
    extra_units     : {unit that only this quantity has: its size [si_unit]}
    allows_zero     : whether the value 0 is allowed
    allows_negative : whether negative numbers are allowed
    allows_range    : whether a range LOW..HIGH is allowed
    """

    quantity_name: str
    default_unit: str
    si_unit: str
    plausible_range: tuple[float, float] = (0.0, math.inf)
    _: KW_ONLY
    allowed_range: tuple[float, float] = (0.0, math.inf)
    mistaken_units: tuple[str, ...] = ()
    extra_units: Mapping[str, float] = field(default_factory=dict)
    allows_zero: bool = False
    allows_negative: bool = False
    allows_range: bool = False


class StatedNumber(NamedTuple):
    """Number that the user states for an option, with its range, in SI units.

    Without a range, both limits are equal to the value.
    """

    stated_value: float
    lower_limit: float
    upper_limit: float

    @property
    def is_range(self) -> bool:
        """Whether the user states a range for the number."""
        return self.upper_limit > self.lower_limit


MIN_ROUGHNESS_HEIGHT = 1e-4
"""Smallest plausible roughness height of a surface [um]: polished silicon wafers have twice as much."""
KGF_PER_MM2_IN_PASCAL = 9.80665e6
"""Unit of Brinell and Vickers hardness [Pa]: kgf/mm2."""
HARDNESS_UNIT_SIZES = dict.fromkeys(("HB", "HBW", "HV"), KGF_PER_MM2_IN_PASCAL)
"""Units of hardness that a number may have, with their size [Pa]."""


def _declare_length(
    quantity_name: str,
    min_plausible_value: float,
    max_plausible_value: float,
    *,
    max_allowed_value: float = math.inf,
    allows_zero: bool = False,
    allows_negative: bool = False,
) -> DrawingQuantity:
    """Declare a quantity that is a length, with its plausible range [mm] and largest allowed value [mm]."""
    return DrawingQuantity(
        quantity_name,
        "mm",
        "m",
        (min_plausible_value, max_plausible_value),
        allowed_range=(0.0, max_allowed_value),
        mistaken_units=("m", "um"),
        allows_zero=allows_zero,
        allows_negative=allows_negative,
    )


def _declare_roughness_height(roughness_symbol: str, max_plausible_value: float) -> DrawingQuantity:
    """Declare a quantity that is a roughness height, with its largest plausible value [um]."""
    return DrawingQuantity(
        f"{roughness_symbol} of machined surfaces",
        "um",
        "m",
        (0.005, max_plausible_value),
        allowed_range=(MIN_ROUGHNESS_HEIGHT, max_plausible_value),
        mistaken_units=("m", "mm", "nm"),
        allows_range=True,
    )


def _declare_friction_coefficient(quantity_name: str) -> DrawingQuantity:
    """Declare a quantity that is a coefficient of friction; clean pairs of the same metal have 0.8 to 1.5."""
    return DrawingQuantity(quantity_name, "1", "1", allowed_range=(0.0, 2.0), allows_range=True)


def _declare_torque(
    quantity_name: str,
    min_plausible_value: float,
    max_plausible_value: float,
    *,
    allows_zero: bool = False,
    allows_range: bool = False,
) -> DrawingQuantity:
    """Declare a quantity that is a torque, with its plausible range [N.m]."""
    return DrawingQuantity(
        quantity_name,
        "N.m",
        "N.m",
        (min_plausible_value, max_plausible_value),
        mistaken_units=("kN.m", "mN.m"),
        allows_zero=allows_zero,
        allows_range=allows_range,
    )


QUANTITIES: Mapping[str, DrawingQuantity] = {
    # bolted joint
    "plate": _declare_length("length or width of a plate", 4.0, 2e4),
    "at": _declare_length("position of a bolt", 1.0, 2e4, allows_zero=True, allows_negative=True),
    "circle": _declare_length("diameter of a pitch circle", 4.0, 2e4),
    "grip": _declare_length("clamped length", 0.5, 5e3),
    "thickness": _declare_length("thickness of a plate", 0.5, 3e3),
    "hole": _declare_length("diameter of a hole", 2.0, 150.0, max_allowed_value=150.0),
    "bearing": _declare_length("diameter of a bearing surface", 3.0, 400.0, max_allowed_value=400.0),
    "washers": _declare_length("diameter or thickness of a washer", 0.2, 400.0, max_allowed_value=400.0),
    "preload": DrawingQuantity(
        "preload of a bolt", "N", "N", (100.0, 3e6), mistaken_units=("kN",), allows_range=True
    ),
    "embedding": DrawingQuantity(
        "preload loss of a bolt",
        "N",
        "N",
        (5.0, 1e6),
        mistaken_units=("kN",),
        allows_zero=True,
        allows_range=True,
    ),
    "thread_friction": _declare_friction_coefficient("coefficient of friction in the thread"),
    "head_friction": _declare_friction_coefficient("coefficient of friction under the head"),
    # faces
    "Ra": _declare_roughness_height("Ra", 100.0),
    "Rq": _declare_roughness_height("Rq", 100.0),
    "Rz": _declare_roughness_height("Rz", 600.0),
    "longest_wave": DrawingQuantity(
        "longest wavelength of a roughness",
        "mm",
        "m",
        (0.02, 25.0),
        allowed_range=(0.0, 1e3),
        mistaken_units=("m", "um"),
        allows_range=True,
    ),
    "hardness": DrawingQuantity(
        "hardness",
        "MPa",
        "Pa",
        (300.0, 15e3),
        allowed_range=(0.0, 1e5),
        mistaken_units=("Pa", "GPa"),
        extra_units=HARDNESS_UNIT_SIZES,
        allows_range=True,
    ),
    "mu": _declare_friction_coefficient("coefficient of friction of metals"),
    # gears
    "module": _declare_length("normal module", 0.1, 60.0),
    "teeth": DrawingQuantity("number of teeth", "1", "1"),
    "width": _declare_length("width of a face", 0.5, 3e3),
    "radii": _declare_length("radius of curvature of a flank", 0.5, 1e5, allows_negative=True),
    "load": DrawingQuantity("normal load", "N", "N", (0.5, 1e8), mistaken_units=("kN", "mN")),
    "pressure_angle": DrawingQuantity(
        "pressure angle", "deg", "rad", (1.0, math.inf), mistaken_units=("rad",), allows_negative=True
    ),
    "helix_angle": DrawingQuantity(
        "helix angle",
        "deg",
        "rad",
        (1.0, math.inf),
        mistaken_units=("rad",),
        allows_zero=True,
        allows_negative=True,
    ),
    "profile_shift": DrawingQuantity(
        "profile shift coefficient",
        "1",
        "1",
        allowed_range=(0.0, 2.0),
        allows_zero=True,
        allows_negative=True,
    ),
    "centre_distance": _declare_length("centre distance", 1.0, 2e4),
    "tip_diameter": _declare_length("tip diameter of a wheel", 0.5, 2e4),
    "dedendum": DrawingQuantity("dedendum over the module", "1", "1", allowed_range=(1.0, 2.0)),
    "backlash": DrawingQuantity(
        "backlash",
        "um",
        "m",
        (0.5, 2e4),
        allowed_range=(0.0, 1e5),
        mistaken_units=("m", "mm", "nm"),
        allows_range=True,
    ),
    # bolts and gears
    "torque": _declare_torque("torque", 0.01, 1e7, allows_range=True),
    # drives
    "ratio": DrawingQuantity("ratio of a drive", "1", "1", allows_negative=True),
    "K1": DrawingQuantity("stiffness up to T1", "N.m/rad", "N.m/rad"),
    "K2": DrawingQuantity("stiffness from T1 to T2", "N.m/rad", "N.m/rad"),
    "K3": DrawingQuantity("stiffness above T2", "N.m/rad", "N.m/rad"),
    "T1": _declare_torque("torque T1", 0.01, 1e5),
    "T2": _declare_torque("torque T2", 0.01, 1e5),
    "rated_torque": _declare_torque("rated torque", 0.01, 1e5),
    "hysteresis": DrawingQuantity(
        "hysteresis loss", "arcmin", "rad", (0.01, 20.0), mistaken_units=("rad", "deg", "arcsec")
    ),
    "lost_motion": DrawingQuantity(
        "lost motion", "arcmin", "rad", (0.01, 60.0), mistaken_units=("rad", "deg", "arcsec")
    ),
    "rigidity": DrawingQuantity(
        "torsional rigidity",
        "N.m/arcmin",
        "N.m/rad",
        (0.1, 1e4),
        mistaken_units=("N.m/rad", "kN.m/rad", "kgf.m/arcmin"),
    ),
    "peak_torque": _declare_torque("largest permissible torque", 0.01, 1e6),
    "starting_torque": _declare_torque("starting torque", 1e-4, 100.0),
    "running_torque": _declare_torque("running torque", 1e-4, 100.0),
    "back_driving_torque": _declare_torque("back-driving torque", 1e-3, 1e4),
    "efficiency": DrawingQuantity("efficiency", "1", "1", extra_units={"%": 0.01}),
    "motor_drag": _declare_torque("motor drag", 1e-5, 100.0, allows_zero=True),
    "corner": DrawingQuantity("relative width of a corner", "1", "1", allows_negative=True),
}
"""{option of `jointfmu new`: quantity}: the same option has the same quantity in all joints."""


def parse_quantity(option_name: str, option_text: str, default_unit: str | None = None) -> StatedNumber:
    """Parse the number of an option, or its range LOW..HIGH; the value of a range is its middle.

    option_name  : name of the option, a key of QUANTITIES
    default_unit : unit of a number without one, if it differs from that of the quantity; such a number is not
                   compared with the plausible range

    Raises ValueError, one line, for text that is not a number, a wrong unit, or a value that is not allowed
    or not plausible.
    """
    quantity = QUANTITIES[option_name]
    match = _RANGE_PATTERN.fullmatch(option_text.strip())
    if not match:
        value = _parse_single_value(option_name, option_text, default_unit)
        return StatedNumber(value, value, value)
    if not quantity.allows_range:
        raise ValueError(
            f"{format_option_flag(option_name)} = {option_text!r} is a range; expected one number"
        )
    unit = number[2] if (number := NUMBER_WITH_UNIT_PATTERN.fullmatch(match[2])) else ""
    has_unit = (first := NUMBER_WITH_UNIT_PATTERN.fullmatch(match[1])) is None or first[2]
    low, high = (
        _parse_single_value(option_name, end, default_unit)
        for end in (match[1] if has_unit else match[1] + unit, match[2])
    )
    if not low < high:
        raise ValueError(
            f"{format_option_flag(option_name)} = {option_text!r}: expected LOW..HIGH, LOW below HIGH"
        )
    return StatedNumber(0.5 * (low + high), low, high)


def parse_quantity_value(option_name: str, option_text: str, default_unit: str | None = None) -> float:
    """Parse the number of an option in its SI unit. Raises ValueError as `parse_quantity`, or for a range."""
    number = parse_quantity(option_name, option_text, default_unit)
    if number.is_range:
        raise ValueError(
            f"{format_option_flag(option_name)} = {option_text!r} is a range; expected one number"
        )
    return number.stated_value


def parse_quantity_values(
    option_name: str, option_text: str, *, number_separator: str, expected_value_count: int
) -> list[float]:
    """Parse several numbers of an option, such as 200x100, in SI units.

    expected_value_count : how many numbers there must be

    Raises ValueError for another count, and as `parse_quantity_value`.
    """
    words = split_number_texts(option_name, option_text, number_separator, expected_value_count)
    return [parse_quantity_value(option_name, word) for word in words]


def _parse_single_value(option_name: str, number_text: str, default_unit: str | None) -> float:
    """Parse one number in the SI unit of its option."""
    quantity, flag = QUANTITIES[option_name], format_option_flag(option_name)
    unit = default_unit or quantity.default_unit
    example = f"expected a number in {unit}, or with its unit as in 1{unit}"
    if unit == "1":
        example = "expected a number without a unit"
    check_no_comma(option_name, number_text)
    match = NUMBER_WITH_UNIT_PATTERN.fullmatch(number_text.strip())
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
    magnitude = value / _unit_size(quantity, quantity.default_unit)
    low, high = quantity.plausible_range
    if (
        not (stated_unit or default_unit)
        and math.isfinite(magnitude)
        and (magnitude > 0.0 or (quantity.allows_negative and magnitude != 0.0))
        and not low <= abs(magnitude) <= high
        and (advice := _advise_unit(quantity, match[1], abs(magnitude)))
    ):
        interval = f"are {low:g} to {high:g}" if high < math.inf else f"is at least {low:g}"
        raise ValueError(
            f"{flag} = {number_text!r} is read as {magnitude:g} {quantity.default_unit}, plausible "
            f"{interval} {quantity.default_unit}; {advice}"
        )
    _check_limits(option_name, number_text, magnitude)
    return value


def _check_limits(option_name: str, number_text: str, number_in_option_unit: float) -> None:
    """Raise ValueError if a number, in the default unit of its option, is outside the allowed range."""
    quantity = QUANTITIES[option_name]
    low, high = quantity.allowed_range
    if quantity.allows_negative:
        inside, lower = abs(number_in_option_unit) <= high, f"[{-high:g}" if high < math.inf else "(-inf"
    elif quantity.allows_zero:
        inside, lower = low <= number_in_option_unit <= high, f"[{low:g}"
    else:
        inside, lower = low < number_in_option_unit <= high, f"({low:g}"
    if inside and math.isfinite(number_in_option_unit):
        return
    interval = f"{lower}, {high:g}]" if high < math.inf else f"{lower}, inf)"
    unit = "" if quantity.default_unit == "1" else f" {quantity.default_unit}"
    raise ValueError(
        f"{format_option_flag(option_name)} = {number_text!r} is outside {interval}{unit}: "
        f"{quantity.quantity_name}"
    )


def _unit_size(drawing_quantity: DrawingQuantity, unit_name: str) -> float:
    """Size of a unit in the SI unit of a quantity. Raises ValueError if the unit measures something else."""
    if unit_name in drawing_quantity.extra_units:
        return drawing_quantity.extra_units[unit_name]
    return conversion_factor(unit_name, drawing_quantity.si_unit)


def _advise_unit(drawing_quantity: DrawingQuantity, number_text: str, magnitude_in_option_unit: float) -> str:
    """Advice what to write instead of a number that is not plausible in the default unit of its option.

    magnitude_in_option_unit : absolute value of the number [default_unit]

    Empty if no other unit makes the number plausible and the number is outside the allowed range.
    """
    low, high = drawing_quantity.plausible_range
    size = _unit_size(drawing_quantity, drawing_quantity.default_unit)
    candidates = {
        _unit_size(drawing_quantity, unit): unit for unit in reversed((*drawing_quantity.extra_units,))
    }
    candidates |= {_unit_size(drawing_quantity, unit): unit for unit in drawing_quantity.mistaken_units}
    advice = [
        f"if it is in {unit}, write {number_text}{unit} ({magnitude_in_option_unit * unit_size / size:.4g} "
        f"{drawing_quantity.default_unit})"
        for unit_size, unit in candidates.items()
        if low <= magnitude_in_option_unit * unit_size / size <= high
    ]
    if (
        not advice
        and drawing_quantity.allowed_range[0] <= magnitude_in_option_unit <= drawing_quantity.allowed_range[1]
        and drawing_quantity.default_unit != "1"
    ):
        advice.append(
            f"if {drawing_quantity.default_unit} is right, write {number_text}{drawing_quantity.default_unit}"
        )
    return "; ".join(advice)
