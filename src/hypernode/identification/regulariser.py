"""Penalty on jumps of a field of parameters between cells."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.sparse
from jaxtyping import Float

from hypernode.fem.mesh import Mesh
from hypernode.identification.settings import STRATEGY, Strategy

#: Length of an interface that a pair of cells with a common side, or with only a corner, stands for in the
#: isotropic sum. With these an interface along the grid and one at 45 degrees both count their true
#: length; sides alone favour staircases along the grid.
SIDE_SHARE, CORNER_SHARE = np.sqrt(2.0) - 1.0, 1.0 - np.sqrt(0.5)


@dataclass(frozen=True)
class JumpCost:
    """Penalty on a jump as a function of its size.

    Attributes:
        smallest: size below which jumps are smoothed.
        scale: without one, a jump costs its size (total variation); with one, a logarithm of it,
            scale log(1 + size / scale), which no longer shrinks true jumps.
        isotropic: whether cells that meet at a corner count as neighbours, so that a contour costs its length in every
            direction. Early in a search corners only add local minima.
    """

    smallest: float = STRATEGY.smallest_jump
    scale: float | None = None
    isotropic: bool = False

    def of(self, size: Float[np.ndarray, "..."]) -> Float[np.ndarray, "..."]:
        """What jumps of these sizes cost, each over a unit of length."""
        return size if self.scale is None else self.scale * np.log1p(size / self.scale)


def _differences(pairs, cells: int) -> scipy.sparse.csr_matrix:
    """Matrix (pair, cell) that takes cell values to their differences."""
    n = len(pairs)
    rows, signs = np.tile(np.arange(n), 2), np.repeat([1.0, -1.0], n)
    return scipy.sparse.csr_matrix((signs, (rows, pairs.T.ravel())), (n, cells))


class Regulariser:
    """Sum over shared sides of length x cost of the jump, all parameters of a cell jointly.

    Args:
        mesh: whose cells carry parameters.
        names: of the parameters, the level of the stiffness first.
        unit: length that counts as one.
        stiffness: takes parameters (cell, parameter) to (logarithm of the stress (cell,), its derivative), which takes
            the place of the level: what a jump of stiffness costs must not depend on the terms that make it, or it is
            divided among them.
    """

    def __init__(self, *, mesh: Mesh, names, unit: float, stiffness: Callable, strategy: Strategy = STRATEGY):
        sides, length, _ = mesh.neighbours()
        corners, across = mesh.diagonal_neighbours()
        isotropic = np.concatenate([SIDE_SHARE * length, CORNER_SHARE * across]) / unit
        cells = len(mesh.cells)
        # By whether the sum is isotropic.
        self._pairs = [sides, np.concatenate([sides, corners])]
        self._difference = [_differences(pairs, cells) for pairs in self._pairs]
        self._length = [length / unit, isotropic]
        self._share = np.array([strategy.jump_shares.get(name, strategy.default_jump_share) for name in names])
        self._stiffness = stiffness

    def _coordinates(self, params):
        """(what jumps (cell, coordinate), its derivative (cell, coordinate, parameter))."""
        values = params * self._share
        derivative = np.tile(np.diag(self._share), (len(params), 1, 1))
        values[:, 0], derivative[:, 0] = self._stiffness(params)
        return values, derivative

    def _jumps(self, values, cost: JumpCost):
        """(jumps (pair, coordinate), their size)."""
        jumps = self._difference[cost.isotropic] @ values
        return jumps, np.sqrt((jumps**2).sum(axis=1) + cost.smallest**2)

    def value(self, params: Float[np.ndarray, "cell parameter"], cost: JumpCost) -> float:
        """The penalty."""
        _, size = self._jumps(self._coordinates(params)[0], cost)
        return float(self._length[cost.isotropic] @ cost.of(size))

    def lengths(self, cost: JumpCost) -> scipy.sparse.csr_matrix:
        """Length of interface between every two cells that count as neighbours (cell, cell), symmetric."""
        one, other = self._pairs[cost.isotropic].T
        cells = self._difference[cost.isotropic].shape[1]
        half = scipy.sparse.csr_matrix((self._length[cost.isotropic], (one, other)), (cells, cells))
        return (half + half.T).tocsr()

    def between(
        self, materials: Float[np.ndarray, "phase parameter"], cost: JumpCost
    ) -> Float[np.ndarray, "phase phase"]:
        """What a unit of length between cells of two materials costs beyond one between cells that are alike."""
        values, _ = self._coordinates(materials)
        size = np.sqrt(((values[:, None] - values) ** 2).sum(axis=-1) + cost.smallest**2)
        return cost.of(size) - cost.of(np.array(cost.smallest))

    def roots(self, params: Float[np.ndarray, "cell parameter"], cost: JumpCost):
        """(R, r, B): with y = B x, y^T R^T R y is a quadratic form that touches the penalty from above.

        The form is of first order in the change of the coordinates y, which are independent of each other in it. The
        penalty's gradient by the parameters is B^T R^T r. All act on flattened fields.
        """
        values, derivative = self._coordinates(params)
        jumps, size = self._jumps(values, cost)
        weight = self._length[cost.isotropic] / size / (1.0 if cost.scale is None else 1.0 + size / cost.scale)
        root = np.sqrt(weight)
        weighted = scipy.sparse.diags(root) @ self._difference[cost.isotropic]
        R = scipy.sparse.kron(weighted, scipy.sparse.identity(derivative.shape[1]))
        return R.tocsr(), (root[:, None] * jumps).ravel(), derivative
