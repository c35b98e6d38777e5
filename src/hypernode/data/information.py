"""What pictures say of displacements, where no points stand between: their information on the nodes of a fine mesh."""

from dataclasses import dataclass

import numpy as np
import scipy.sparse
import scipy.sparse.linalg
import xarray as xr
from jaxtyping import Bool, Float, Int

from hypernode.fem.factors import SYMMETRIC
from hypernode.fem.mesh import Mesh

#: Share of its diagonal that joins information which a picture may lack in some direction.
_LEAST = 1e-10
#: Names of the variables of a measurement.
NAMES = ("grey_X", "grey_cells", "grey_u", "grey_information", "grey_pull")


@dataclass(frozen=True)
class Information:
    """Grey levels near some displacements u0, by which u costs half of (u - u0)^T M (u - u0) - 2 b^T (u - u0).

    That is what is left of the squared differences of grey levels, over their variance, once they are linearised at u0.

    Attributes:
        mesh: fine enough for what pictures resolve.
        u: the displacements u0.
        matrix: M of every element, its degrees of freedom node by node; 0 where a picture says nothing.
        pull: b of every element.
    """

    mesh: Mesh
    u: Float[np.ndarray, "step node 2"]
    matrix: Float[np.ndarray, "step element 8 8"]
    pull: Float[np.ndarray, "step element 8"]

    def to_variables(self) -> dict[str, np.ndarray]:
        """As a measurement holds it."""
        return dict(zip(NAMES, (self.mesh.nodes, self.mesh.cells, self.u, self.matrix, self.pull), strict=True))

    def root(self, step: int, used: Bool[np.ndarray, " element"]):
        """(R, R v, observed) of a step by some of the elements, with R^T R = M and v the displacements that cost least.

        What displacements cost more than v is half of the square of R u - R v: independent numbers of unit variance, if
        they are right.

        Returns:
            Cholesky's factor R (row, dof), sparse; R v (row,); the degrees of freedom on which the picture has a say,
            as many as there are rows.
        """
        dofs = self.mesh.dofs[used]
        count = self.mesh.nodes.size
        M, b = assembled(dofs, self.matrix[step, used], self.pull[step, used], count)
        diagonal = M.diagonal()
        observed = np.flatnonzero(diagonal > 0.0)
        if not len(observed):
            return scipy.sparse.csr_matrix((0, count)), np.zeros(0), observed
        least = _LEAST * scipy.sparse.diags(diagonal[observed])
        factors = scipy.sparse.linalg.splu((M[observed][:, observed] + least).tocsc(), **SYMMETRIC)
        pivots = np.sqrt(factors.U.diagonal())
        R = scipy.sparse.diags(pivots) @ factors.L.T.tocsr()[:, factors.perm_c]
        v = self.u[step].ravel()[observed] + factors.solve(b[observed])
        onto = scipy.sparse.csr_matrix((np.ones(len(observed)), (np.arange(len(observed)), observed)), (len(v), count))
        return R @ onto, R @ v, observed


def assembled(
    dofs: Int[np.ndarray, "element 8"],
    matrix: Float[np.ndarray, "element 8 8"],
    vector: Float[np.ndarray, "element 8"],
    count: int,
) -> tuple[scipy.sparse.csc_matrix, Float[np.ndarray, " dof"]]:
    """Sums over elements of their matrices and vectors, ``count`` degrees of freedom in all."""
    rows, columns = np.repeat(dofs, 8, axis=1).ravel(), np.tile(dofs, (1, 8)).ravel()
    sparse = scipy.sparse.csc_matrix((matrix.ravel(), (rows, columns)), (count, count))
    return sparse, np.bincount(dofs.ravel(), vector.ravel(), count)


def information_of(measurement: xr.Dataset) -> Information | None:
    """What a measurement holds of it; None where displacements were measured point by point."""
    if "grey_X" not in measurement:
        return None
    nodes, cells, *rest = (measurement[name].values for name in NAMES)
    return Information(Mesh(nodes, cells), *rest)
