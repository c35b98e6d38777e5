"""Factors of sparse symmetric matrices: Cholesky's by CHOLMOD; SuperLU's where a matrix is not positive definite."""

import contextlib
import functools
from collections.abc import Callable

import cvxopt
import cvxopt.cholmod
import numpy as np
import scipy.sparse
import scipy.sparse.linalg
from cholespy import CholeskySolverD, MatrixType
from jaxtyping import Float

from hypernode.fem.block_factors import BlockFactors
from hypernode.fem.nested_factors import NestedFactors

#: Of SuperLU for symmetric matrices: pivots must not disturb their ordering, and those that are positive definite need
#: none, so that their factors are those of Cholesky.
SYMMETRIC = {"permc_spec": "MMD_AT_PLUS_A", "diag_pivot_thresh": 0.0, "options": {"SymmetricMode": True}}


#: Columns from which factors that solve for many at once pay for being made, and how many they solve for at once.
MANY, AT_ONCE = 64, 128
#: Unknowns from which nested dissection takes less time than blocks: of 70 x 70 cells.
NESTED = 10_000
#: Memory up to which they are factors by blocks [bytes]: of 200 x 200 cells.
MOST_OF_BLOCKS = 640 * 2**20


class CholeskyFactors:
    """Cholesky factors of a sparse symmetric positive definite matrix, of which the lower triangle is read.

    Args:
        places: of the unknowns in a sheet, where they are known.

    Raises:
        ArithmeticError: the matrix is not positive definite.
    """

    def __init__(self, matrix: scipy.sparse.spmatrix, places: Float[np.ndarray, "n 2"] | None = None):
        self._matrix, self._places = matrix, places
        lower = scipy.sparse.tril(matrix).tocoo()
        rows, columns = (cvxopt.matrix(each.astype(np.int64)) for each in (lower.row, lower.col))
        entries = cvxopt.spmatrix(cvxopt.matrix(lower.data), rows, columns, matrix.shape)
        self._factors = cvxopt.cholmod.symbolic(entries)
        cvxopt.cholmod.numeric(entries, self._factors)

    def solve(self, b: Float[np.ndarray, "n ..."]) -> Float[np.ndarray, "n ..."]:
        """A^-1 b, of one vector or of the columns of a matrix."""
        b = np.asarray(b, float)
        if b.size == 0:
            return b.copy()
        if b.ndim == 2 and b.shape[1] >= MANY:
            return self._of_many(b)
        x = cvxopt.matrix(b)
        cvxopt.cholmod.solve(self._factors, x)
        return np.array(x).reshape(b.shape)

    @functools.cached_property
    def _columns(self) -> Callable:
        """A solve that takes many columns at once, where that of CVXOPT takes one after the other."""
        # Where a sheet is about to buckle, rounding decides whether a matrix counts as positive definite.
        with contextlib.suppress(np.linalg.LinAlgError):
            if self._places is not None and len(self._places) >= NESTED:
                return NestedFactors(self._matrix, self._places).solve
            if blocks := BlockFactors.of_band(self._matrix, MOST_OF_BLOCKS):
                return blocks.solve
        lower = scipy.sparse.tril(self._matrix, format="csc")
        indices = lower.indptr.astype(np.int32), lower.indices.astype(np.int32)
        factors = CholeskySolverD(lower.shape[0], *indices, lower.data, MatrixType.CSC)

        def solve(b):
            given, solved = np.ascontiguousarray(b), np.empty(b.shape)
            factors.solve(given, solved)
            return solved

        return solve

    def solve_sparse(self, b: scipy.sparse.csc_matrix) -> Float[np.ndarray, "n column"]:
        """A^-1 of sparse columns, of which only some at a time are made dense."""
        return self._of_many(b) if b.shape[1] >= MANY else self.solve(b.toarray())

    def _of_many(self, b) -> Float[np.ndarray, "n column"]:
        found = np.empty(b.shape)
        for first in range(0, b.shape[1], AT_ONCE):
            some = b[:, first : first + AT_ONCE]
            found[:, first : first + AT_ONCE] = self._columns(some.toarray() if scipy.sparse.issparse(b) else some)
        return found


#: What :func:`factorise` makes.
Factors = CholeskyFactors | scipy.sparse.linalg.SuperLU


def factorise(matrix: scipy.sparse.spmatrix, places: Float[np.ndarray, "n 2"] | None = None) -> Factors:
    """Factors of a symmetric matrix, with a method ``solve``.

    Args:
        matrix: of n unknowns.
        places: of the unknowns in a sheet, where they are known. Of a large one many columns are then solved faster.
    """
    try:
        return CholeskyFactors(matrix, places)
    except ArithmeticError:
        # A sheet that buckles has a tangent like that.
        return scipy.sparse.linalg.splu(matrix.tocsc(), **SYMMETRIC)
