"""Cholesky factors of a sheet's grid, line by line of nodes, for solves of many columns.

Unknowns of a line of nodes meet only those of the lines beside it. So the matrix is block tridiagonal, and so is its
factor L. A sheet of n x n cells takes 2 n^3 numbers instead of the n^4 of an inverse. A solve is two passes over the
lines, each of products of matrices.
"""

from typing import NamedTuple

import numpy as np
import scipy.sparse
from jaxtyping import Float, Int
from scipy.linalg.lapack import dtrtri


class BlockFactors(NamedTuple):
    """A = L L^T of a symmetric positive definite matrix, by blocks of equal size; short ones are filled up with ones.

    Attributes:
        place: of every unknown among those of all blocks (unknown,).
        pivots: inverses of the diagonal blocks of L (block, size, size).
        below: blocks of L left of the diagonal, zero for the first (block, size, size).
    """

    place: Int[np.ndarray, " unknown"]
    pivots: Float[np.ndarray, "block size size"]
    below: Float[np.ndarray, "block size size"]

    @classmethod
    def of(cls, matrix: scipy.sparse.spmatrix, block: Int[np.ndarray, " unknown"]) -> "BlockFactors":
        """Factorise a matrix (unknown, unknown), of which unknowns of a block meet only those of the blocks beside it.

        Raises:
            ValueError: unknowns meet whose blocks are further apart.
            numpy.linalg.LinAlgError: the matrix is not positive definite.
        """
        _, block, size = np.unique(block, return_inverse=True, return_counts=True)
        inside = np.empty(len(block), int)
        inside[np.argsort(block, kind="stable")] = np.concatenate([np.arange(count) for count in size])
        entries = scipy.sparse.coo_matrix(matrix.tocsc())
        apart = block[entries.row] - block[entries.col]
        if np.abs(apart).max() > 1:
            raise ValueError("unknowns of lines that are not neighbours meet: the matrix is not block tridiagonal")
        shape = (len(size), size.max(), size.max())
        pivots, below = np.zeros(shape), np.zeros(shape)
        for blocks, entry in ((pivots, apart == 0), (below, apart == 1)):
            row, column = entries.row[entry], entries.col[entry]
            blocks[block[row], inside[row], inside[column]] = entries.data[entry]
        filled, unused = np.nonzero(np.arange(shape[1]) >= size[:, None])
        pivots[filled, unused, unused] = 1.0
        for k in range(len(size)):
            if k:
                below[k] = below[k] @ pivots[k - 1].T
            pivots[k], _ = dtrtri(np.linalg.cholesky(pivots[k] - below[k] @ below[k].T), lower=1)
        return cls(block * shape[1] + inside, pivots, below)

    @classmethod
    def of_band(cls, matrix: scipy.sparse.spmatrix, most: int) -> "BlockFactors | None":
        """Factorise by blocks of neighbouring unknowns; None where they take more memory than asked [bytes]."""
        entries, count = scipy.sparse.coo_matrix(matrix), matrix.shape[0]
        size = max(int(np.abs(entries.row - entries.col).max()), 1)
        if 16 * count * size > most:
            return None
        return cls.of(matrix, np.arange(count) // size)

    def solve(self, right: Float[np.ndarray, "unknown column"]) -> Float[np.ndarray, "unknown column"]:
        """A^-1 of every column."""
        blocks, size = self.pivots.shape[:2]
        x = np.zeros((blocks * size, right.shape[1]))
        x[self.place] = right
        x = x.reshape(blocks, size, -1)
        for k in range(blocks):
            if k:
                x[k] -= self.below[k] @ x[k - 1]
            x[k] = self.pivots[k] @ x[k]
        for k in reversed(range(blocks)):
            if k + 1 < blocks:
                x[k] -= self.below[k + 1].T @ x[k + 1]
            x[k] = self.pivots[k].T @ x[k]
        return x.reshape(blocks * size, -1)[self.place]
