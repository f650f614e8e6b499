"""Factorisation of large symmetric positive definite matrices (CHOLMOD, by way of CVXOPT)."""

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Cholesky:
    """Supernodal Cholesky factor of a sparse symmetric positive definite matrix.

    matrix : (n, n) scipy.sparse, its lower triangle is read

    Raises
    ------
    RuntimeError : the matrix is not positive definite
    """

    def __init__(self, matrix: sp.spmatrix) -> None:
        from cvxopt import cholmod, spmatrix
        from cvxopt import matrix as dense

        lower = sp.tril(matrix).tocoo()
        rows, columns = (dense(part.astype(np.int64)) for part in (lower.row, lower.col))
        cholmod.options["supernodal"] = 2
        packed = spmatrix(dense(lower.data), rows, columns, lower.shape)
        self._factor = cholmod.symbolic(packed)
        try:
            cholmod.numeric(packed, self._factor)
        except ArithmeticError:
            raise RuntimeError(
                "a stiffness matrix is not positive definite: a body can move freely"
            ) from None

    def solve(self, right: Array) -> Array:
        """Solution (n) or (n, k) of `matrix @ x = right`."""
        from cvxopt import cholmod
        from cvxopt import matrix as dense

        x = dense(np.asfortranarray(right, dtype=np.float64))
        cholmod.solve(self._factor, x)
        return np.array(x).reshape(right.shape)
