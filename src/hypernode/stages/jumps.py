"""How much a field of parameters varies from cell to cell, and what a jump of it costs."""

import numpy as np
import scipy.sparse

from hypernode.mechanics.mesh import Mesh

#: Relative jumps below this size are smoothed rather than counted.
SMALLEST_JUMP = 0.02
#: What a jump of each parameter counts, against one of the logarithm of the stiffness.
JUMP_SHARE = {"log_level": 1.0, "logit_dispersion": 0.3, "fibre_x": 4.0, "fibre_y": 4.0}
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
    """

    def __init__(self, mesh: Mesh, names):
        sides, length, _ = mesh.neighbours()
        corners, across = mesh.diagonal_neighbours()
        unit = np.sqrt(mesh.areas.mean())
        isotropic = np.concatenate([SIDE_SHARE * length, CORNER_SHARE * across]) / unit
        cells = len(mesh.cells)
        # By whether the sum is isotropic.
        self._difference = [_differences(sides, cells), _differences(np.concatenate([sides, corners]), cells)]
        self._length = [length / unit, isotropic]
        self.isotropic, self.smallest = False, SMALLEST_JUMP
        self.share = np.array([JUMP_SHARE.get(name, DEFAULT_JUMP_SHARE) for name in names])
        self.scale = None

    def _size(self, params):
        return np.sqrt(((self._difference[self.isotropic] @ (params * self.share)) ** 2).sum(axis=1) + self.smallest**2)

    def value(self, params) -> float:
        """The penalty."""
        size = self._size(params)
        cost = size if self.scale is None else self.scale * np.log1p(size / self.scale)
        return float(self._length[self.isotropic] @ cost)

    def hessian(self, params) -> scipy.sparse.csc_matrix:
        """Quadratic form that touches the penalty from above, on the flattened parameters."""
        root = self.root(params)
        return (root.T @ root).tocsc()

    def root(self, params) -> scipy.sparse.csr_matrix:
        """Matrix R with R^T R = :meth:`hessian`."""
        size = self._size(params)
        weight = self._length[self.isotropic] / size / (1.0 if self.scale is None else 1.0 + size / self.scale)
        weighted = scipy.sparse.diags(np.sqrt(weight)) @ self._difference[self.isotropic]
        return scipy.sparse.kron(weighted, scipy.sparse.diags(self.share)).tocsr()
