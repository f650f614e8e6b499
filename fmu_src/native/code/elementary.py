"""Tables for the elementary functions of `law/elementary.c`, computed with 60 decimal digits."""

from collections.abc import Iterator, Sequence
from decimal import Decimal, localcontext
from functools import cache
from math import factorial

from ...joint_parts.c_text import array, number

PLACES = 32
"""Number of intervals in the tables of exponential and logarithm [1]."""
LOG_BEGIN = 0x3FE6AAAA00000000
"""Bit pattern of the double at which the table of the logarithm begins; 1 lies inside an interval."""
_BITS_OF_ONE = 0x3FF0000000000000
LOG_BITS = 47
"""Mantissa bits below the interval index: 52 - log2(TABLE_INTERVALS)."""
_DIGITS = 60
_PI = Decimal("3.1415926535897932384626433832795028841971693993751058209749445923078164")
_ERF_PER_PLACE, _ERF_END, _N_ERF = 4, 6, 15
_N_EXPM1, _N_WAVE = 13, 8


@cache
def tables() -> str:
    """Text of elementary_tables.h; its numbers are exact to the last bit of a double."""
    with localcontext() as context:
        context.prec = _DIGITS
        log_2, quarter = Decimal(2).ln(), _PI / 2
        per_place = log_2 / PLACES
        macros = {
            "LOG_2": _first(log_2, 42),
            "LOG_2_LOW": float(log_2 - Decimal(_first(log_2, 42))),
            "INTERVALS_PER_LOG_2": float(1 / per_place),
            "LOG_2_PER_INTERVAL": _first(per_place, 42),
            "LOG_2_PER_INTERVAL_LOW": float(per_place - Decimal(_first(per_place, 42))),
            "ERF_NODES_PER_UNIT": float(_ERF_PER_PLACE),
            "QUARTERS_PER_RADIAN": float(1 / quarter),
        }
        arrays = {
            "QUARTER_TURN[4]": [[value] for value in _split_number(quarter)],
            f"EXP_TABLE[{PLACES}][2]": [_pair((k * per_place).exp()) for k in range(PLACES)],
            f"LOG_TABLE[{PLACES}][3]": list(_logs()),
            f"EXPM1_SERIES[{_N_EXPM1}]": [[1 / factorial(n + 2)] for n in range(_N_EXPM1)],
            f"ERF_TABLE[{_ERF_PER_PLACE * _ERF_END + 1}][{_N_ERF}]": list(_erf()),
            f"SINE_SERIES[{_N_WAVE}]": [[-((-1) ** n) / factorial(2 * n + 3)] for n in range(_N_WAVE)],
            f"COSINE_SERIES[{_N_WAVE}]": [[(-1) ** n / factorial(2 * n + 4)] for n in range(_N_WAVE)],
        }
    counts = {
        "TABLE_INTERVALS": PLACES,
        "LOG_BITS": LOG_BITS,
        "N_EXPM1_TERMS": _N_EXPM1,
        "N_ERF_TERMS": _N_ERF,
        "N_SINE_TERMS": _N_WAVE,
    }
    return "\n".join(
        [
            f"enum {{ {', '.join(f'{name} = {n}' for name, n in counts.items())} }};",
            f"#define LOG_BEGIN {LOG_BEGIN:#x}",
            *(f"#define {name} {number(value)}" for name, value in macros.items()),
            *(array(f"static const double {name}", map(_row, rows)) for name, rows in arrays.items()),
        ]
    )


def _row(values: Sequence[float]) -> str:
    """Format one row of a C array."""
    text = ", ".join(number(value) for value in values)
    return text if len(values) == 1 else f"{{{text}}}"


def _first(value: Decimal, bits: int) -> float:
    """Round a number to a multiple of 2^-bits."""
    return float((value * 2**bits).to_integral_value()) * 2.0**-bits


def _pair(value: Decimal) -> list[float]:
    """Split a number into the nearest double and the relative error of that double."""
    high = float(value)
    return [high, float(value / Decimal(high) - 1)]


def _split_number(value: Decimal) -> Iterator[float]:
    """Split a number into three doubles of 33 bits, whose products with 20 bits are exact, and the rest."""
    for bits in (32, 65, 98):
        yield (leading := _first(value, bits))
        value -= Decimal(leading)
    yield float(value)


def _logs() -> Iterator[list[float]]:
    """Rows 1/c, high and low part of log(c) for each interval of the logarithm.

    c is near the middle of the interval, and 1/c has few bits. In the interval of 1, c is exactly 1.
    """
    for interval in range(PLACES):
        begin, end = (LOG_BEGIN + (k << LOG_BITS) for k in (interval, interval + 1))
        middle = 0.5 * (_double(begin) + _double(end))
        inverse = 1.0 if begin <= _BITS_OF_ONE < end else round(2.0**16 / middle) * 2.0**-16
        log = -Decimal(inverse).ln()
        high = _first(log, 42)
        yield [inverse, high, float(log - Decimal(high))]


def _double(bits: int) -> float:
    """Positive double with a given bit pattern."""
    return float.fromhex(f"0x1.{bits & ((1 << 52) - 1):013x}p{(bits >> 52) - 1023}")


def _erf() -> Iterator[list[float]]:
    """Coefficients of the Taylor series of erf about each node: Hermite polynomials times a Gaussian."""
    for node in range(_ERF_PER_PLACE * _ERF_END + 1):
        x = Decimal(node) / _ERF_PER_PLACE
        gaussian = 2 / _PI.sqrt() * (-x * x).exp()
        term = total = x
        n = 0
        while term > Decimal(10) ** -_DIGITS:  # erf(x) = Gaussian times the sum of 2^n x^(2n+1)/(2n+1)!!
            n += 1
            term *= 2 * x * x / (2 * n + 1)
            total += term
        row, previous, hermite = [float(gaussian * total)], Decimal(0), Decimal(1)
        for n in range(_N_ERF - 1):
            row.append(float((-1) ** n * hermite * gaussian / factorial(n + 1)))
            previous, hermite = hermite, 2 * x * hermite - 2 * n * previous
        yield row
