"""Nodal forces and virtual work of a cell-wise stress field on a quadrilateral mesh.

Stresses live at the cell centres, P[i, J, step, cell]. The nodal force of a hat function is then
R_a = sum_c A_c P_c . dN_a/dX, which on a regular grid equals the central-difference divergence at
the node times the cell area.
"""

import numpy as np
import scipy.sparse
import scipy.sparse.linalg
from jaxtyping import Float

from hypernode.fem.mesh import EDGE_NAMES, Mesh, tied_edge


def nodal_force_matrices(mesh: Mesh) -> list[scipy.sparse.csr_matrix]:
    """D_J with R_i = sum_J D_J P_iJ: nodal forces (node,) from cell stresses (cell,), J = X, Y."""
    gradient = mesh.gradient_operator() * mesh.areas[:, None, None]
    rows = mesh.cells.ravel()
    columns = np.repeat(np.arange(len(mesh.cells)), 4)
    shape = (len(mesh.nodes), len(mesh.cells))
    return [scipy.sparse.csr_matrix((gradient[:, :, J].ravel(), (rows, columns)), shape) for J in range(2)]


def stiffness_matrix(mesh: Mesh, conductivity: float | Float[np.ndarray, " cell"] = 1.0) -> scipy.sparse.csr_matrix:
    """Integral of k grad N_a . grad N_b, by 2 x 2 Gauss points of bilinear quadrilaterals, k one or by cell."""
    corner = mesh.nodes[mesh.cells]
    g = 1.0 / np.sqrt(3.0)
    total = np.zeros((len(mesh.cells), 4, 4))
    sign = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]], dtype=float)
    for xi, eta in g * sign:
        local = 0.25 * sign * np.stack([1 + eta * sign[:, 1], 1 + xi * sign[:, 0]], axis=1)
        jacobian = np.einsum("cai,aj->cij", corner, local)
        gradient = np.einsum("aj,cjJ->caJ", local, np.linalg.inv(jacobian))
        total += np.einsum("caJ,cbJ,c->cab", gradient, gradient, np.linalg.det(jacobian))
    total *= np.broadcast_to(conductivity, len(total))[:, None, None]
    rows = np.repeat(mesh.cells, 4, axis=1).ravel()
    columns = np.tile(mesh.cells, (1, 4)).ravel()
    n = len(mesh.nodes)
    return scipy.sparse.csr_matrix((total.ravel(), (rows, columns)), (n, n))


def virtual_fields(mesh: Mesh, component: int, constrained, measured):
    """Test functions (node, function) for one displacement component, and the edge that is tied or None.

    Nodes of a constrained edge move together where the edge is tied (:func:`tied_edge`), and not at all elsewhere:
    their reactions are unknown.
    """
    n = len(mesh.nodes)
    number = np.full(n, -2)
    for index, edge in enumerate(EDGE_NAMES):
        if constrained[index, component]:
            number[mesh.on_edge(edge)] = -1
    tied = tied_edge(constrained, measured, component)
    free = np.flatnonzero(number == -2)
    number[free] = np.arange(len(free))
    if tied is not None:
        on = mesh.on_edge(tied)
        for index, edge in enumerate(EDGE_NAMES):
            if constrained[index, component] and edge != tied:
                on &= ~mesh.on_edge(edge)
        number[on] = len(free)
    used = np.flatnonzero(number >= 0)
    shape = (n, len(free) + (tied is not None))
    return scipy.sparse.csr_matrix((np.ones(len(used)), (used, number[used])), shape), tied
