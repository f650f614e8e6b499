"""Numbers that are the same to the bit on every processor, and what decides is taken from them alone.

Additions, products, quotients and square roots of IEEE 754 are rounded in one way everywhere. Exponentials,
powers and angles are not, nor are products of matrices, in which a library chooses the order and may fuse an
addition with its product. A search that compares such numbers ends elsewhere when their last bits differ. So
searches take rounded numbers, combine them by the functions of this module, and numpy's elementary ones.
"""

import numpy as np
from numpy.typing import NDArray

from ...quantity import Array
from .shape import PressureShape

DIGITS = 20
"""Binary digits to which numbers are rounded before they decide: 1e-6, far above what processors differ by
and far below what a choice of points is accurate to."""
NEARLY_HALF = 0.5 - 0.01 * np.sqrt(2.0)
"""What is added to a number of steps before it is cut off [1]."""
TOGETHER = 22
"""Rows of a symmetric matrix that are summed up to the same column [1]: all but half are found once."""
NOTHING = 2.0**-46
"""Part of the largest number [1] below which another one is zero: what rounding leaves of it."""


def rounded(shape: PressureShape, digits: int = DIGITS) -> PressureShape:
    """A shape whose numbers are rounded to binary digits: shares to their own, all else to the
    largest one's.

    Numbers are rounded up a little above the half of a step, where no short fraction lies, and alike on both
    sides of zero: what mirrors itself goes on doing so.
    """
    mantissa, exponent = np.frexp(shape.share)
    share = np.ldexp(_steps(mantissa, digits), exponent)
    others = (to_digits(values, digits) for values in (shape.position, shape.equal, shape.tilt))
    return PressureShape(share, *others)


def to_digits(values: Array, digits: int = DIGITS) -> Array:
    """Values rounded to binary digits of the largest one."""
    exponent = np.frexp(np.max(np.abs(values)))[1]
    return np.asarray(np.ldexp(_steps(np.ldexp(values, -exponent), digits), exponent))


def ranks(values: Array) -> NDArray[np.intp]:
    """Ranks (n) of values, the largest first; of equal ones in the order of their places."""
    return np.argsort(np.argsort(-to_digits(values), kind="stable"), kind="stable")


def _steps(values: Array, digits: int) -> Array:
    """Values up to 1 in steps of 2^-digits."""
    sizes = np.floor(np.ldexp(np.abs(values), digits) + NEARLY_HALF)
    return np.asarray(np.ldexp(np.copysign(sizes, values) + 0.0, -digits))


def cleared(shape: PressureShape) -> PressureShape:
    """A shape in which what rounding left of a zero is one."""

    def zeros(values: Array) -> Array:
        return np.where(np.abs(values) > NOTHING * np.max(np.abs(values)), values, 0.0)

    position = np.column_stack([zeros(values) for values in shape.position.T])
    return PressureShape(shape.share, position, zeros(shape.equal), zeros(shape.tilt))


def over(rows: Array, weights: Array) -> Array:
    """Sums (m) of rows (m, n) times weights (n)."""
    return np.asarray(np.add.reduce(rows * weights, axis=1))


def combined(weights: Array, rows: Array) -> Array:
    """Sum (n) of rows (m, n), each times its weight (m)."""
    return np.asarray(np.add.reduce(weights[:, None] * rows, axis=0))


def product(one: Array, other: Array) -> Array:
    """(m, k) sums over n of one (m, n) times other (k, n)."""
    out = np.zeros((len(one), len(other)))
    for left, right in zip(one.T.copy(), other.T.copy(), strict=True):
        out += left[:, None] * right
    return out


def squared(rows: Array) -> Array:
    """(m, m) the same of rows (m, n) with themselves."""
    columns, out = rows.T.copy(), np.empty((len(rows), len(rows)))
    for first in range(0, len(rows), TOGETHER):
        last = first + TOGETHER
        for one, row in zip(out[first:last], rows[first:last], strict=True):
            one[:last] = np.add.reduce(row[:, None] * columns[:, :last], axis=0)
        out[:first, first:last] = out[first:last, :first].T
    return out


def length(vector: Array) -> float:
    """Euclidean norm of a vector (n)."""
    return float(np.sqrt(np.add.reduce(vector * vector)))


def powers(base: float, count: int) -> Array:
    """base, base^2, ... (count)."""
    return np.multiply.accumulate(np.full(count, base))


def root(values: Array, power: Array) -> Array:
    """(m, n) the roots of values >= 0 (m, n) or (m, 1), of 2, 4, 8, ... 64 (m, 1)."""
    return _again(np.sqrt, values, power)


def to_power(values: Array, power: Array) -> Array:
    """(m, n) values (m, n) to a power of 2, 4, 8, ... 64 (m, 1)."""
    return _again(np.square, values, power)


def _again(function: np.ufunc, values: Array, power: Array) -> Array:
    """(m, n) the function of values, once, twice, ... for powers of 2, 4, ..."""
    out = np.broadcast_to(values, np.broadcast_shapes(values.shape, power.shape)).copy()
    for k in range(6):
        function(out, out=out, where=power > 2.0**k)
    return out
