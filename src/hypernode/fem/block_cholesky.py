"""Cholesky factors of a sheet's grid, line by line of nodes, for solves inside compiled code.

Unknowns of a line of nodes meet only those of the lines beside it. So the matrix is block tridiagonal, and so is its
factor L. A sheet of n x n cells takes 2 n^3 numbers instead of the n^4 of an inverse. A solve is two passes over the
lines.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import scipy.linalg
import scipy.sparse
from jaxtyping import Array, Float, Int


class BlockCholesky(NamedTuple):
    """A = L L^T of a symmetric positive matrix, by blocks of equal size; short ones are filled up with ones.

    Attributes:
        place: of every unknown among those of all blocks (unknown,).
        pivots: inverses of the diagonal blocks of L (block, size, size).
        below: blocks of L left of the diagonal, zero for the first (block, size, size).
    """

    place: Int[Array, " unknown"]
    pivots: Float[Array, "block size size"]
    below: Float[Array, "block size size"]

    @classmethod
    def of(cls, matrix: scipy.sparse.spmatrix, line: Int[np.ndarray, " unknown"]) -> "BlockCholesky":
        """Factorise in double precision, keep in single.

        Args:
            matrix: symmetric and positive definite (unknown, unknown).
            line: which line of nodes an unknown is on; blocks are lines in rising order.

        Raises:
            ValueError: unknowns meet that are on lines further apart.
        """
        _, block, size = np.unique(line, return_inverse=True, return_counts=True)
        inside = np.empty(len(block), int)
        inside[np.argsort(block, kind="stable")] = np.concatenate([np.arange(count) for count in size])
        entries = matrix.tocoo()
        apart = block[entries.row] - block[entries.col]
        if np.abs(apart).max() > 1:
            raise ValueError("unknowns of lines that are not neighbours meet: the matrix is not block tridiagonal")
        shape = (len(size), size.max(), size.max())
        diagonal, left = np.zeros(shape), np.zeros(shape)
        for blocks, entry in ((diagonal, apart == 0), (left, apart == 1)):
            row, column = entries.row[entry], entries.col[entry]
            np.add.at(blocks, (block[row], inside[row], inside[column]), entries.data[entry])
        filled, unused = np.nonzero(np.arange(shape[1]) >= size[:, None])
        diagonal[filled, unused, unused] = 1.0
        pivots, below = np.empty(shape, np.float32), np.empty(shape, np.float32)
        pivot = np.zeros(shape[1:])
        for k in range(len(size)):
            lower = left[k] @ pivot.T
            pivot = scipy.linalg.solve_triangular(
                np.linalg.cholesky(diagonal[k] - lower @ lower.T), np.eye(shape[1]), lower=True
            )
            pivots[k], below[k] = pivot, lower
        return cls(jnp.asarray(block * shape[1] + inside), jnp.asarray(pivots), jnp.asarray(below))

    def solve(self, right: Float[Array, "unknown column"]) -> Float[Array, "unknown column"]:
        """A^-1 of every column."""
        blocks, size, columns = *self.pivots.shape[:2], right.shape[1]
        filled = jnp.zeros((blocks * size, columns), right.dtype).at[self.place].set(right)

        def forward(before, block):
            pivot, below, right = block
            here = pivot @ (right - below @ before)
            return here, here

        def backward(after, block):
            pivot, below, right = block
            here = pivot.T @ (right - after)
            return below.T @ here, here

        nothing = jnp.zeros((size, columns), right.dtype)
        _, half = jax.lax.scan(forward, nothing, (self.pivots, self.below, filled.reshape(blocks, size, columns)))
        _, whole = jax.lax.scan(backward, nothing, (self.pivots, self.below, half), reverse=True)
        return whole.reshape(-1, columns)[self.place]
