"""Matrices of polynomial interpolation and integration on [0, 1], the same for all samples."""

from functools import cache

import numpy as np
from numpy.polynomial import chebyshev

from jointfmu.quantity import Array


def nodes(count: int) -> Array:
    """Chebyshev points of the second kind on [0, 1], ends included, ascending."""
    return np.asarray(0.5 * (1.0 - np.cos(np.pi * np.arange(count) / (count - 1))))


@cache
def coefficients(count: int) -> Array:
    """(count, count) from values at `nodes` to Chebyshev coefficients: values @ matrix."""
    return np.asarray(np.linalg.inv(chebyshev.chebvander(2.0 * nodes(count) - 1.0, count - 1)).T)


def interpolation(count: int, x: Array) -> Array:
    """(count, x.size) from values at `nodes` to values at x in [0, 1]: values @ matrix."""
    return np.asarray(coefficients(count) @ chebyshev.chebvander(2.0 * x - 1.0, count - 1).T)


def integration(count: int, x: Array) -> Array:
    """(count, x.size) from values at `nodes` to integrals from 0 to x: values @ matrix."""
    # column j: coefficients of the integral of T_j
    integral = chebyshev.chebint(np.eye(count), lbnd=-1.0, axis=0)
    at = chebyshev.chebvander(2.0 * x - 1.0, count) @ integral
    return np.asarray(np.where(x > 0.0, 0.5 * coefficients(count) @ at.T, 0.0))


def discrete_gauss(values: Array, weights: Array, count: int) -> tuple[Array, Array]:
    """Gauss quadrature of a discrete measure: `count` nodes that integrate polynomials of its values exactly.

    values, weights : (n) of the measure
    Returns nodes and weights (count), exact up to degree 2 count - 1 (Lanczos; Golub and Welsch 1969).
    """
    from scipy.linalg import eigh_tridiagonal

    total = float(np.sum(weights))
    basis = [np.sqrt(weights / total)]
    diagonal, off = [], []
    for k in range(count):
        q = values * basis[k]
        diagonal.append(float(q @ basis[k]))
        for earlier in (*basis, *basis):  # twice: keeps the basis orthogonal to round-off
            q = q - (q @ earlier) * earlier
        norm = float(np.linalg.norm(q))
        if k + 1 == count or norm <= 1e-13 * float(np.max(np.abs(values))):
            break
        off.append(norm)
        basis.append(q / norm)
    at, vectors = eigh_tridiagonal(np.array(diagonal), np.array(off))
    return np.asarray(at), np.asarray(total * vectors[0] ** 2)
