"""Penalty on jumps of a field of parameters between cells."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import scipy.sparse
from jaxtyping import Float

from hypernode.fem.mesh import Mesh
from hypernode.identification import budgets, priors

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

    smallest: float = field(default_factory=lambda: priors.SMALLEST_JUMP)
    scale: float | None = None
    isotropic: bool = False

    def of(self, size: Float[np.ndarray, "..."]) -> Float[np.ndarray, "..."]:
        """What jumps of these sizes cost, each over a unit of length."""
        return size if self.scale is None else self.scale * np.log1p(size / self.scale)

    def weight(self, size: Float[np.ndarray, "..."]) -> Float[np.ndarray, "..."]:
        """Weight of half the square of a jump of this size, whose slope is that of the cost."""
        return 1.0 / size / (1.0 if self.scale is None else 1.0 + size / self.scale)


class Jumps:
    """Jumps between neighbouring cells of a field of some coordinates (cell, coordinate).

    Args:
        mesh: of the cells.
        unit: length that counts as one.
    """

    def __init__(self, mesh: Mesh, unit: float):
        sides, length, _ = mesh.neighbours()
        corners, across = mesh.diagonal_neighbours()
        isotropic = np.concatenate([SIDE_SHARE * length, CORNER_SHARE * across])
        # By whether the sum is isotropic.
        every = [sides, np.concatenate([sides, corners])]
        self._difference = [_differences(pairs, len(mesh.cells)) for pairs in every]
        self._length = [length / unit, isotropic / unit]

    def _sized(self, values, cost: JumpCost):
        """(jumps (pair, coordinate), their size)."""
        jumps = self._difference[cost.isotropic] @ values
        return jumps, np.sqrt((jumps**2).sum(axis=1) + cost.smallest**2)

    def value(self, values: Float[np.ndarray, "cell coordinate"], cost: JumpCost) -> float:
        """Sum over pairs of neighbours of length x cost of the jump."""
        _, size = self._sized(values, cost)
        return float(self._length[cost.isotropic] @ cost.of(size))

    def roots(self, values: Float[np.ndarray, "cell coordinate"], cost: JumpCost):
        """(D (pair, cell), D values): half the square of D y touches the value from above, for coordinates y."""
        jumps, size = self._sized(values, cost)
        root = np.sqrt(self._length[cost.isotropic] * cost.weight(size))
        return scipy.sparse.diags(root) @ self._difference[cost.isotropic], root[:, None] * jumps


def unit_length(areas: Float[np.ndarray, " cell"]) -> float:
    """Length of interface that counts as one, by the areas of the measured cells.

    On finer grids it costs what it does on the finest that is not begun from a coarser one.
    """
    return float((areas.sum() / min(len(areas), budgets.MOST_CELLS_AT_ONCE)) ** 0.5)


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

    def __init__(self, *, mesh: Mesh, names, unit: float, stiffness: Callable):
        self._jumps = Jumps(mesh, unit)
        self._share = np.array([priors.JUMP_SHARES.get(name, priors.DEFAULT_JUMP_SHARE) for name in names])
        self._stiffness = stiffness

    def _coordinates(self, params):
        """(what jumps (cell, coordinate), its derivative (cell, coordinate, parameter))."""
        values = params * self._share
        derivative = np.tile(np.diag(self._share), (len(params), 1, 1))
        values[:, 0], derivative[:, 0] = self._stiffness(params)
        return values, derivative

    def value(self, params: Float[np.ndarray, "cell parameter"], cost: JumpCost) -> float:
        """The penalty."""
        return self._jumps.value(self._coordinates(params)[0], cost)

    def roots(self, params: Float[np.ndarray, "cell parameter"], cost: JumpCost):
        """(R, r, B): with y = B x, y^T R^T R y is a quadratic form that touches the penalty from above.

        The form is of first order in the change of the coordinates y, which are independent of each other in it. The
        penalty's gradient by the parameters is B^T R^T r. All act on flattened fields.
        """
        values, derivative = self._coordinates(params)
        D, jumps = self._jumps.roots(values, cost)
        R = scipy.sparse.kron(D, scipy.sparse.identity(derivative.shape[1]))
        return R.tocsr(), jumps.ravel(), derivative
