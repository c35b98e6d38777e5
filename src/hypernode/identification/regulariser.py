"""How much a field of parameters varies from cell to cell, and what a jump of it costs."""

from collections.abc import Callable

import numpy as np
import scipy.sparse

from hypernode.fem.mesh import Mesh

#: Relative jumps below this size are smoothed rather than counted.
SMALLEST_JUMP = 0.02


#: What a jump of each further parameter counts, against one of the logarithm of the stiffness.
JUMP_SHARE = {"logit_dispersion": 0.3, "fibre_x": 4.0, "fibre_y": 4.0}


DEFAULT_JUMP_SHARE = 0.5


#: Length of an interface that a pair of cells with a common side, or with only a corner, stands for in the
#: isotropic sum. With these an interface along the grid and one at 45 degrees both count their true
#: length; sides alone favour staircases along the grid.
SIDE_SHARE, CORNER_SHARE = np.sqrt(2.0) - 1.0, 1.0 - np.sqrt(0.5)


def _differences(pairs, cells: int) -> scipy.sparse.csr_matrix:
    """Matrix (pair, cell) that takes cell values to their differences."""
    n = len(pairs)
    rows, signs = np.tile(np.arange(n), 2), np.repeat([1.0, -1.0], n)
    return scipy.sparse.csr_matrix((signs, (rows, pairs.T.ravel())), (n, cells))


class Jumps:
    """How much the parameter field varies from cell to cell, all parameters jointly.

    Total variation first: sum over shared sides of length x |jump|. With a ``scale``, a logarithm of it,
    scale log(1 + |jump| / scale), which no longer shrinks true jumps. Once ``isotropic``, cells that face
    each other at a corner count too, so that a contour costs its length in every direction; on the way
    there corners only add local minima. ``smallest`` is the size below which jumps are smoothed.

    Args:
        names: of the parameters, the level of the stiffness first.
        unit: length that counts as one.
        stiffness: takes parameters (cell, parameter) to (logarithm of the stress (cell,), its derivative), which takes
            the place of the level: what a jump of stiffness costs must not depend on the terms that make it, or it is
            divided among them.
    """

    def __init__(self, mesh: Mesh, names, unit: float, stiffness: Callable):
        sides, length, _ = mesh.neighbours()
        corners, across = mesh.diagonal_neighbours()
        isotropic = np.concatenate([SIDE_SHARE * length, CORNER_SHARE * across]) / unit
        cells = len(mesh.cells)
        # By whether the sum is isotropic.
        self._difference = [_differences(sides, cells), _differences(np.concatenate([sides, corners]), cells)]
        self._length = [length / unit, isotropic]
        self.isotropic, self.smallest = False, SMALLEST_JUMP
        self.share = np.array([JUMP_SHARE.get(name, DEFAULT_JUMP_SHARE) for name in names])
        self.scale, self._stiffness = None, stiffness

    def _coordinates(self, params):
        """(what jumps (cell, coordinate), its derivative (cell, coordinate, parameter))."""
        values = params * self.share
        derivative = np.tile(np.diag(self.share), (len(params), 1, 1))
        values[:, 0], derivative[:, 0] = self._stiffness(params)
        return values, derivative

    def _jumps(self, values):
        """(jumps (pair, coordinate), their size)."""
        jumps = self._difference[self.isotropic] @ values
        return jumps, np.sqrt((jumps**2).sum(axis=1) + self.smallest**2)

    def value(self, params) -> float:
        """The penalty."""
        _, size = self._jumps(self._coordinates(params)[0])
        cost = size if self.scale is None else self.scale * np.log1p(size / self.scale)
        return float(self._length[self.isotropic] @ cost)

    def roots(self, params):
        """(R, r, B): with y = B x, y^T R^T R y is a quadratic form that touches the penalty from above.

        The form to first order in the change of the coordinates y, in which one does not know of the other; the
        penalty's gradient by the parameters is B^T R^T r. All act on flattened fields.
        """
        values, derivative = self._coordinates(params)
        jumps, size = self._jumps(values)
        weight = self._length[self.isotropic] / size / (1.0 if self.scale is None else 1.0 + size / self.scale)
        root = np.sqrt(weight)
        weighted = scipy.sparse.diags(root) @ self._difference[self.isotropic]
        R = scipy.sparse.kron(weighted, scipy.sparse.identity(derivative.shape[1]))
        return R.tocsr(), (root[:, None] * jumps).ravel(), derivative
