"""Numbers as they stand on drawings: in a unit of their own or in that of the drawing, 200x100, 4xM12."""

import math
import re
from collections.abc import Sequence

from jointfmu.quantity.units import KELVIN_AT_ZERO, LUBRICANTS, factor

from ..command_line.common import flag

_TEMPERATURE = re.compile(r"([+-]?\d+(?:\.\d*)?)\s*(K|degC|°C|C|)")
_NUMBER = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?)\s*(.*)", re.IGNORECASE)


def number(name: str, text: str, unit: str, to: str, least: float | None = 0.0) -> float:
    """A number of the option `name` in the unit `to`; without a unit of its own it has `unit`.

    Raises ValueError if it is none, of another unit, infinite, or not above `least` (None: any).
    """
    match = _NUMBER.fullmatch(text.strip())
    example = f"expected a number in {unit}, or with its unit as in 1{unit}"
    if not match:
        raise ValueError(f"{flag(name)} = {text!r} is no number; {example}")
    try:
        value = float(match[1]) * factor(match[2] or unit, to)
    except ValueError as error:
        raise ValueError(f"{flag(name)} = {text!r}: {error}; {example}") from None
    if not math.isfinite(value) or (least is not None and not value > least):
        low = "-inf" if least is None else f"{least:g}"
        raise ValueError(f"{flag(name)} = {text!r} is outside ({low}, inf)")
    return value


def temperature(name: str, text: str) -> float:
    """A temperature [K] of the option `name`, stated in degC, or with K behind it.

    Raises ValueError if it is none, or outside LUBRICANTS.
    """
    match = _TEMPERATURE.fullmatch(text.strip())
    if not match:
        raise ValueError(f"{flag(name)} = {text!r} is no temperature; expected 45, 45degC or 318.15K")
    kelvin = float(match[1]) + (0.0 if match[2] == "K" else KELVIN_AT_ZERO)
    if not LUBRICANTS[0] <= kelvin <= LUBRICANTS[1]:
        low, high = (end - KELVIN_AT_ZERO for end in LUBRICANTS)
        raise ValueError(
            f"{flag(name)} = {text!r} is {kelvin:g} K, outside [{low:g}, {high:g}] degC; kelvin are stated "
            "as 318.15K"
        )
    return kelvin


def numbers(
    name: str, text: str, unit: str, to: str, *, by: str, count: int, least: float | None = 0.0
) -> list[float]:
    """So many numbers with a sign between them: 200x100. Raises ValueError as `number`."""
    parts = text.split(by)
    if len(parts) != count:
        example = by.join(["200", "100"][:count])
        raise ValueError(
            f"{flag(name)} = {text!r} has {len(parts)} numbers, expected {count}, as in {example}"
        )
    return [number(name, part, unit, to, least) for part in parts]


def both(name: str, texts: Sequence[str] | None) -> tuple[str, str] | None:
    """What is stated of the two sides: once for both, or of each. Raises ValueError if there are more."""
    if not texts:
        return None
    if len(texts) > 2:
        raise ValueError(f"{flag(name)} has {len(texts)} values, expected one for both sides or one of each")
    return texts[0], texts[-1]
