"""Cholesky factors of a sheet's grid in single precision, for solves inside compiled code."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import scipy.sparse
from jaxtyping import Array, Float, Int

from hypernode.fem.block_factors import BlockFactors


class BlockCholesky(NamedTuple):
    """:class:`~hypernode.fem.block_factors.BlockFactors` in single precision."""

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
        place, pivots, below = BlockFactors.of(matrix, line)
        return cls(jnp.asarray(place), jnp.asarray(pivots, jnp.float32), jnp.asarray(below, jnp.float32))

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
