"""Parsing of numbers on drawings: with a unit or in the default unit of the option, sizes such as 200x100."""

import math
import re
from collections.abc import Sequence

from jointfmu.quantity.units import CELSIUS_ZERO_IN_KELVIN, LUBRICANT_TEMPERATURE_RANGE, conversion_factor

from ...common.options import format_option_flag

_TEMPERATURE_PATTERN = re.compile(r"([+-]?\d+(?:\.\d*)?)\s*(K|degC|°C|C|)")
"""Pattern of a temperature and its unit."""
NUMBER_WITH_UNIT_PATTERN = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?)\s*(.*)", re.IGNORECASE)
"""Pattern of a number and its unit."""
_COMMA_PATTERN = re.compile(r"[+-]?\d*,\d+(?:,\d+)*(.*)")
"""Pattern of a number with a decimal comma."""
_THOUSANDS_PATTERN = re.compile(r"[+-]?\d{1,3}(?:,\d{3})+(.*)")
"""Pattern of a number with commas between thousands."""


def check_no_comma(option_name: str, number_text: str) -> None:
    """Raise ValueError for a number with a comma, decimal or of thousands; the message says what to write."""
    text = number_text.strip()
    if not _COMMA_PATTERN.fullmatch(text):
        return
    point, joined = text.replace(",", "."), text.replace(",", "")
    advice = f"{point} with a decimal point" if text.count(",") == 1 else joined
    if _THOUSANDS_PATTERN.fullmatch(text) and text.count(",") == 1:
        advice += f", or {joined} if the comma separates thousands"
    raise ValueError(f"{format_option_flag(option_name)} = {number_text!r} has a comma; write {advice}")


def parse_number(
    option_name: str, number_text: str, default_unit: str, result_unit: str, lower_bound: float | None = 0.0
) -> float:
    """Parse the number of an option of a drawing, with its own unit or the unit of the option.

    option_name  : name of the option, for the error
    default_unit : unit of a number that is stated without one
    result_unit  : unit of the result
    lower_bound  : the number must be above it [result_unit]; None: no bound

    Raises ValueError for text that is not a number, a wrong unit, an infinite number, or one out of range.
    """
    check_no_comma(option_name, number_text)
    match = NUMBER_WITH_UNIT_PATTERN.fullmatch(number_text.strip())
    example = f"expected a number in {default_unit}, or with its unit as in 1{default_unit}"
    if default_unit == "1":
        example = "expected a number without a unit"
    if not match:
        raise ValueError(f"{format_option_flag(option_name)} = {number_text!r} is not a number; {example}")
    try:
        value = float(match[1]) * conversion_factor(match[2] or default_unit, result_unit)
    except ValueError as error:
        raise ValueError(f"{format_option_flag(option_name)} = {number_text!r}: {error}; {example}") from None
    if not math.isfinite(value) or (lower_bound is not None and not value > lower_bound):
        low = "-inf" if lower_bound is None else f"{lower_bound:g}"
        allowed = f"({low}, inf)" if result_unit == "1" else f"({low}, inf) {result_unit}"
        raise ValueError(f"{format_option_flag(option_name)} = {number_text!r} is outside {allowed}")
    return value


def parse_temperature(option_name: str, temperature_text: str) -> float:
    """Parse the temperature [K] of an option, stated in degC or with the unit K.

    Raises ValueError for text that is not a temperature, or outside LUBRICANT_TEMPERATURE_RANGE.
    """
    match = _TEMPERATURE_PATTERN.fullmatch(temperature_text.strip())
    if not match:
        raise ValueError(
            f"{format_option_flag(option_name)} = {temperature_text!r} is not a temperature; "
            "expected 45, 45degC or 318.15K"
        )
    kelvin = float(match[1]) + (0.0 if match[2] == "K" else CELSIUS_ZERO_IN_KELVIN)
    low, high = LUBRICANT_TEMPERATURE_RANGE
    if not low <= kelvin <= high:
        advice = ""
        if not match[2] and low <= float(match[1]) <= high:
            advice = f"; if it is in K, write {match[1]}K"
        raise ValueError(
            f"{format_option_flag(option_name)} = {temperature_text!r} is read as "
            f"{kelvin - CELSIUS_ZERO_IN_KELVIN:g} degC, outside [{low - CELSIUS_ZERO_IN_KELVIN:g}, "
            f"{high - CELSIUS_ZERO_IN_KELVIN:g}] degC{advice}"
        )
    return kelvin


def parse_numbers(
    option_name: str,
    numbers_text: str,
    default_unit: str,
    result_unit: str,
    *,
    number_separator: str,
    expected_number_count: int,
    lower_bound: float | None = 0.0,
) -> list[float]:
    """Parse several numbers of an option with a separator between them, such as 200x100.

    expected_number_count : how many numbers there must be

    Raises ValueError for another count, and as `parse_number`.
    """
    words = split_number_texts(option_name, numbers_text, number_separator, expected_number_count)
    return [parse_number(option_name, word, default_unit, result_unit, lower_bound) for word in words]


def split_number_texts(
    option_name: str, numbers_text: str, number_separator: str, expected_number_count: int
) -> list[str]:
    """Split the text of an option at the separator of its numbers. Raises ValueError for another count."""
    words = numbers_text.split(number_separator)
    if len(words) != expected_number_count:
        example = number_separator.join(["200", "100"][:expected_number_count])
        raise ValueError(
            f"{format_option_flag(option_name)} = {numbers_text!r} has {len(words)} numbers, "
            f"expected {expected_number_count}, as in {example}"
        )
    return words


def expand_to_sides(option_name: str, side_texts: Sequence[str] | None) -> tuple[str, str] | None:
    """Expand one or two texts of an option to one text for each side of the contact; None if there is none.

    Raises ValueError for more than two texts.
    """
    if not side_texts:
        return None
    if len(side_texts) > 2:
        raise ValueError(
            f"{format_option_flag(option_name)} has {len(side_texts)} values, state one for both sides, or "
            "one for each side"
        )
    return side_texts[0], side_texts[-1]
