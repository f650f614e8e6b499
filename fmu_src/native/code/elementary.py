"""C tables for the elementary functions of `law/elementary.c`, computed with 60 decimal digits."""

from collections.abc import Iterator, Sequence
from decimal import Decimal, localcontext
from functools import cache
from math import factorial

from ...joint_parts.c_text import format_array_definition, format_double_literal

EXP_LOG_TABLE_INTERVALS = 32
"""Number of intervals in the tables of exponential and logarithm [1]."""
LOG_TABLE_START_BITS = 0x3FE6AAAA00000000
"""Bit pattern of the double at which the table of the logarithm begins; 1 lies inside an interval."""
_BIT_PATTERN_OF_ONE = 0x3FF0000000000000
"""Bit pattern of the double 1.0."""
LOG_TABLE_MANTISSA_BITS = 47
"""Mantissa bits below the interval index: 52 - log2(EXP_LOG_TABLE_INTERVALS)."""
_TABLE_DECIMAL_DIGITS = 60
"""Number of decimal digits with which the tables are computed [1]."""
_PI = Decimal("3.1415926535897932384626433832795028841971693993751058209749445923078164")
"""Pi with more digits than _TABLE_DECIMAL_DIGITS."""
_ERF_NODES_PER_UNIT, _ERF_MAX_ARGUMENT, _ERF_TERM_COUNT = 4, 6, 15
_EXPM1_TERM_COUNT, _SINE_TERM_COUNT = 13, 8


@cache
def make_tables_header() -> str:
    """Make the C header elementary_tables.h: constants and tables of the elementary functions."""
    with localcontext() as context:
        context.prec = _TABLE_DECIMAL_DIGITS
        log_2, quarter = Decimal(2).ln(), _PI / 2
        per_place = log_2 / EXP_LOG_TABLE_INTERVALS
        macros = {
            "LOG_2": _round_to_bits(log_2, 42),
            "LOG_2_LOW": float(log_2 - Decimal(_round_to_bits(log_2, 42))),
            "INTERVALS_PER_LOG_2": float(1 / per_place),
            "LOG_2_PER_INTERVAL": _round_to_bits(per_place, 42),
            "LOG_2_PER_INTERVAL_LOW": float(per_place - Decimal(_round_to_bits(per_place, 42))),
            "ERF_NODES_PER_UNIT": float(_ERF_NODES_PER_UNIT),
            "QUARTERS_PER_RADIAN": float(1 / quarter),
        }
        arrays = {
            "QUARTER_TURN[4]": [[value] for value in _split_into_short_doubles(quarter)],
            f"EXP_TABLE[{EXP_LOG_TABLE_INTERVALS}][2]": [
                _split_into_double_and_error((k * per_place).exp()) for k in range(EXP_LOG_TABLE_INTERVALS)
            ],
            f"LOG_TABLE[{EXP_LOG_TABLE_INTERVALS}][3]": list(_make_log_rows()),
            f"EXPM1_SERIES[{_EXPM1_TERM_COUNT}]": [[1 / factorial(n + 2)] for n in range(_EXPM1_TERM_COUNT)],
            f"ERF_TABLE[{_ERF_NODES_PER_UNIT * _ERF_MAX_ARGUMENT + 1}][{_ERF_TERM_COUNT}]": list(
                _make_erf_rows()
            ),
            f"SINE_SERIES[{_SINE_TERM_COUNT}]": [
                [-((-1) ** n) / factorial(2 * n + 3)] for n in range(_SINE_TERM_COUNT)
            ],
            f"COSINE_SERIES[{_SINE_TERM_COUNT}]": [
                [(-1) ** n / factorial(2 * n + 4)] for n in range(_SINE_TERM_COUNT)
            ],
        }
    counts = {
        "EXP_LOG_TABLE_INTERVALS": EXP_LOG_TABLE_INTERVALS,
        "LOG_BITS": LOG_TABLE_MANTISSA_BITS,
        "N_EXPM1_TERMS": _EXPM1_TERM_COUNT,
        "N_ERF_TERMS": _ERF_TERM_COUNT,
        "N_SINE_TERMS": _SINE_TERM_COUNT,
    }
    return "\n".join(
        [
            f"enum {{ {', '.join(f'{name} = {n}' for name, n in counts.items())} }};",
            f"#define LOG_BEGIN {LOG_TABLE_START_BITS:#x}",
            *(f"#define {name} {format_double_literal(value)}" for name, value in macros.items()),
            *(
                format_array_definition(f"static const double {name}", map(_format_table_row, rows))
                for name, rows in arrays.items()
            ),
        ]
    )


def _format_table_row(row_values: Sequence[float]) -> str:
    """Format the values of one row of a table as a C array."""
    text = ", ".join(format_double_literal(value) for value in row_values)
    return text if len(row_values) == 1 else f"{{{text}}}"


def _round_to_bits(exact_number: Decimal, fraction_bits: int) -> float:
    """Round a number to a multiple of 2^-fraction_bits."""
    return float((exact_number * 2**fraction_bits).to_integral_value()) * 2.0**-fraction_bits


def _split_into_double_and_error(exact_number: Decimal) -> list[float]:
    """Split a number into the nearest double and the relative error of that double."""
    high = float(exact_number)
    return [high, float(exact_number / Decimal(high) - 1)]


def _split_into_short_doubles(exact_number: Decimal) -> Iterator[float]:
    """Split a number into a sum of four doubles.

    The first three have 33 bits each, so their products with an integer of 20 bits are exact.
    """
    for bits in (32, 65, 98):
        yield (leading := _round_to_bits(exact_number, bits))
        exact_number -= Decimal(leading)
    yield float(exact_number)


def _make_log_rows() -> Iterator[list[float]]:
    """Make the rows of the table of the logarithm: 1/c, high and low part of log(c) for each interval.

    c is a number near the middle of the interval whose reciprocal has few bits. In the interval of 1, c is
    exactly 1.
    """
    for interval in range(EXP_LOG_TABLE_INTERVALS):
        begin, end = (LOG_TABLE_START_BITS + (k << LOG_TABLE_MANTISSA_BITS) for k in (interval, interval + 1))
        middle = 0.5 * (_convert_bits_to_double(begin) + _convert_bits_to_double(end))
        inverse = 1.0 if begin <= _BIT_PATTERN_OF_ONE < end else round(2.0**16 / middle) * 2.0**-16
        log = -Decimal(inverse).ln()
        high = _round_to_bits(log, 42)
        yield [inverse, high, float(log - Decimal(high))]


def _convert_bits_to_double(bit_pattern: int) -> float:
    """Convert a bit pattern (64-bit integer) to the positive double with this pattern."""
    return float.fromhex(f"0x1.{bit_pattern & ((1 << 52) - 1):013x}p{(bit_pattern >> 52) - 1023}")


def _make_erf_rows() -> Iterator[list[float]]:
    """Yield the rows of the table of the error function: Taylor coefficients of erf about each node.

    The coefficients are Hermite polynomials times a Gaussian.
    """
    for node in range(_ERF_NODES_PER_UNIT * _ERF_MAX_ARGUMENT + 1):
        x = Decimal(node) / _ERF_NODES_PER_UNIT
        gaussian = 2 / _PI.sqrt() * (-x * x).exp()
        term = total = x
        n = 0
        while (
            term > Decimal(10) ** -_TABLE_DECIMAL_DIGITS
        ):  # erf(x) = Gaussian times the sum of 2^n x^(2n+1)/(2n+1)!!
            n += 1
            term *= 2 * x * x / (2 * n + 1)
            total += term
        row, previous, hermite = [float(gaussian * total)], Decimal(0), Decimal(1)
        for n in range(_ERF_TERM_COUNT - 1):
            row.append(float((-1) ** n * hermite * gaussian / factorial(n + 1)))
            previous, hermite = hermite, 2 * x * hermite - 2 * n * previous
        yield row
