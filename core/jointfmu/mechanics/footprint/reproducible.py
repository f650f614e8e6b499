"""Arithmetic with the same result, to the bit, on every processor.

Additions, products, quotients and square roots of IEEE 754 are rounded identically everywhere. Exponentials,
powers and trigonometric functions are not. Nor are matrix products: a library chooses the order of additions
and may fuse a product with an addition. A search that compares such numbers can end differently if their last
bits differ. So searches use rounded numbers, and combine them only by functions of this module and elementary
operations of numpy.
"""

import numpy as np
from numpy.typing import NDArray

from ...quantity import Array
from .distribution import PressureDistribution

ROUNDING_BINARY_DIGITS = 20
"""Binary digits to which numbers are rounded before comparisons [1]. 2^-20 = 1e-6 is far above differences
between processors, and far below the accuracy of a choice of points."""
ROUNDING_OFFSET = 0.5 - 0.01 * np.sqrt(2.0)
"""Number added before truncation to an integer [1]: rounds up slightly above half a step."""
GRAM_BLOCK_SIZE = 22
"""Block size [1] for symmetric products: nearly half of the matrix is copied instead of computed."""
GRAM_BATCH_SIZE = 64
"""Number of columns [1] whose products are added in one call: they fit into a processor's cache."""
ROUND_OFF_OVER_LARGEST_NUMBER = 2.0**-46
"""Ratio to the largest number [1] below which a number counts as zero: round-off."""


def round_distribution(
    pressure_distribution: PressureDistribution, binary_digits: int = ROUNDING_BINARY_DIGITS
) -> PressureDistribution:
    """Round a pressure distribution to a number of significant binary digits.

    Each share is rounded relative to its own size; positions and pressure ratios relative to their largest.

    Numbers are rounded up from slightly above half a step, where no short fraction lies. Rounding is
    symmetric about zero, so a symmetric distribution stays symmetric.
    """
    mantissa, exponent = np.frexp(pressure_distribution.area_share)
    share = np.ldexp(_round_to_steps(mantissa, binary_digits), exponent)
    rounded_values = (
        round_to_digits(values, binary_digits)
        for values in (
            pressure_distribution.position,
            pressure_distribution.preload_pressure_ratio,
            pressure_distribution.moment_pressure_ratio,
        )
    )
    return PressureDistribution(share, *rounded_values)


def round_to_digits(unrounded_values: Array, binary_digits: int = ROUNDING_BINARY_DIGITS) -> Array:
    """Round values to a number of binary digits of the largest one."""
    exponent = np.frexp(np.max(np.abs(unrounded_values)))[1]
    return np.asarray(
        np.ldexp(_round_to_steps(np.ldexp(unrounded_values, -exponent), binary_digits), exponent)
    )


def rank_descending(ranked_values: Array) -> NDArray[np.intp]:
    """Ranks (n) of values in descending order, after rounding; equal values keep their order."""
    return np.argsort(np.argsort(-round_to_digits(ranked_values), kind="stable"), kind="stable")


def _round_to_steps(unrounded_values: Array, binary_digits: int) -> Array:
    """Round values between -1 and 1 to multiples of 2^-binary_digits."""
    sizes = np.floor(np.ldexp(np.abs(unrounded_values), binary_digits) + ROUNDING_OFFSET)
    return np.asarray(np.ldexp(np.copysign(sizes, unrounded_values) + 0.0, -binary_digits))


def clear_round_off(pressure_distribution: PressureDistribution) -> PressureDistribution:
    """Replace numbers of a pressure distribution that are only round-off by exact zeros.

    The limit is ROUND_OFF_OVER_LARGEST_NUMBER.
    """

    def clear_small_values(number_array: Array) -> Array:
        """Replace small values of one array by zeros."""
        return np.where(
            np.abs(number_array) > ROUND_OFF_OVER_LARGEST_NUMBER * np.max(np.abs(number_array)),
            number_array,
            0.0,
        )

    position = np.column_stack([clear_small_values(values) for values in pressure_distribution.position.T])
    return PressureDistribution(
        pressure_distribution.area_share,
        position,
        clear_small_values(pressure_distribution.preload_pressure_ratio),
        clear_small_values(pressure_distribution.moment_pressure_ratio),
    )


def weighted_sums(matrix_rows: Array, column_weights: Array) -> Array:
    """Weighted sums (m) of rows (m, n) with weights (n)."""
    return np.asarray(np.add.reduce(matrix_rows * column_weights, axis=1))


def linear_combination(row_weights: Array, matrix_rows: Array) -> Array:
    """Linear combination (n) of rows (m, n) with weights (m)."""
    return np.asarray(np.add.reduce(row_weights[:, None] * matrix_rows, axis=0))


def matrix_product(left_rows: Array, right_rows: Array) -> Array:
    """Matrix product a b^T (m, k) of a (m, n) and b (k, n)."""
    out = np.zeros((len(left_rows), len(right_rows)))
    for left, right in zip(left_rows.T.copy(), right_rows.T.copy(), strict=True):
        out += left[:, None] * right
    return out


def gram_matrix(matrix_rows: Array) -> Array:
    """Symmetric matrix product a a^T (m, m) of rows a (m, n), summed in the order of the columns."""
    columns, out = matrix_rows.T.copy(), np.empty((len(matrix_rows), len(matrix_rows)))
    for first in range(0, len(matrix_rows), GRAM_BLOCK_SIZE):
        last = min(first + GRAM_BLOCK_SIZE, len(matrix_rows))
        terms = np.zeros((1 + GRAM_BATCH_SIZE, last - first, last))  # the sum so far, then products
        for begin in range(0, len(columns), GRAM_BATCH_SIZE):
            batch = columns[begin : begin + GRAM_BATCH_SIZE]
            end = 1 + len(batch)
            np.multiply(batch[:, first:last, None], batch[:, None, :last], out=terms[1:end])
            terms[0] = np.add.reduce(terms[:end], axis=0)
        out[first:last, :last] = terms[0]
        out[:first, first:last] = out[first:last, :first].T
    return out


def euclidean_norm(vector: Array) -> float:
    """Euclidean norm of a vector (n)."""
    return float(np.sqrt(np.add.reduce(vector * vector)))


def successive_powers(power_base: float, power_count: int) -> Array:
    """Powers (count) of a number: base, base^2, ..., base^count."""
    return np.multiply.accumulate(np.full(power_count, power_base))


def take_power_of_two_root(radicands: Array, root_order: Array) -> Array:
    """Roots values^(1/exponent) (m, n) by repeated square roots, of values >= 0; exponents are 2, 4, ... 64.

    radicands : (m, n) or (m, 1)
    root_order : (m, 1)
    """
    return _apply_repeatedly(np.sqrt, radicands, root_order)


def raise_to_power_of_two(power_bases: Array, powers_of_two: Array) -> Array:
    """Raise values (m, n) to the exponents (m, 1) by repeated squaring; exponents are 2, 4, 8, ... 64."""
    return _apply_repeatedly(np.square, power_bases, powers_of_two)


def _apply_repeatedly(repeated_function: np.ufunc, start_values: Array, power_of_two: Array) -> Array:
    """Apply a function to values log2(power_of_two) times, one after the other. Returns an array (m, n)."""
    out = np.broadcast_to(start_values, np.broadcast_shapes(start_values.shape, power_of_two.shape)).copy()
    for k in range(6):
        repeated_function(out, out=out, where=power_of_two > 2.0**k)
    return out
