"""Distance of a cell-wise stress field from the nearest one in equilibrium."""

from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np
import scipy.sparse
import scipy.sparse.linalg
from jax.experimental.sparse import BCOO
from jaxtyping import Array, ArrayLike, Bool, Float, Int

from hypernode.fem.block_cholesky import BlockCholesky
from hypernode.fem.mesh import EDGES, Mesh
from hypernode.fem.nodal_forces import nodal_force_matrices, stiffness_matrix, virtual_fields


def balance_energy(mesh: Mesh, K, component: int, constrained, measured):
    """(test functions T, their energy matrix, the tied edge) for one displacement component.

    Args:
        K: stiffness matrix whose energy measures the test functions.
        component: of the displacement, 0 or 1.
        constrained, measured: as in :meth:`EquilibriumGap.build`.
    """
    T, edge = virtual_fields(mesh, component, constrained, measured)
    energy = (T.T @ K @ T).tocsc()
    # A component that no edge holds can translate freely: its residual is balanced by construction,
    # so any stiffness of the translation gives the same gap.
    if not constrained[:, component].any():
        energy[0, 0] += energy.diagonal().mean()
    return T, energy, edge


def relative_gap(mesh: Mesh, constrained, measured, P, resultant, scale) -> Float[np.ndarray, " step"]:
    """:class:`EquilibriumGap` of given stresses, by sparse solves: for judging, not for training.

    Args:
        constrained, measured: as in :meth:`EquilibriumGap.build`.
        P: cell stresses [step, cell, i, J].
        resultant: force on the tied edge per component and unit thickness (step, 2).
        scale: stress unit of each step.
    """
    D, K = nodal_force_matrices(mesh), stiffness_matrix(mesh)
    total = np.zeros(len(P))
    for component in range(2):
        T, energy, edge = balance_energy(mesh, K, component, constrained, measured)
        R = T.T @ sum(D[J] @ P[:, :, component, J].T for J in range(2))
        if edge is not None:
            R[-1] -= resultant[:, component]
        total += np.sum(R * scipy.sparse.linalg.spsolve(energy, R).reshape(R.shape), axis=0)
    return np.sqrt(np.maximum(total, 0.0) / mesh.areas.sum()) / scale


def _lines(mesh: Mesh, T, edge: str | None) -> Int[np.ndarray, " test"]:
    """The line of nodes on which a test function is 1: along the tied edge, itself one, or along the shorter side."""
    axis = EDGES[edge][0] if edge is not None else int(np.argmax([len(lines) for lines in mesh.lines]))
    by_function = T.tocsc()
    first = by_function.indices[by_function.indptr[:-1]]
    return np.searchsorted(mesh.lines[axis], mesh.nodes[first, axis])


@jax.custom_vjp
def _energies(R: Float[ArrayLike, "test step"], energy: BlockCholesky) -> Float[Array, " step"]:
    """R K^-1 R of each column, differentiated by R alone; the solve is what costs, and one serves both."""
    return _energies_and_field(R, energy)[0]


def _energies_and_field(R, energy):
    field = energy.solve(R)
    return jnp.sum(R * field, axis=0), field


_energies.defvjp(_energies_and_field, lambda field, slope: (2.0 * slope * field, None))


@dataclass(frozen=True)
class EquilibriumGap:
    """Distance of a stress field from the nearest one in equilibrium with the measured forces.

    The residual of the virtual work is R = sum P : grad phi - f. It is measured in the norm dual to the energy of the
    test functions. With K the Laplacian on the same functions, gap^2 = R K^-1 R / (A |P_ave|^2). That equals the
    relative L2 distance to the nearest statically admissible stress. It also weights the residual by the inverse
    covariance of the divergence of a white stress error. So equilibrium and resultants need no weights of their own.

    Attributes:
        work: sparse maps[i][J] from cell stress to the virtual work (test function, cell).
        loads: virtual work of a unit resultant per component (test function,), zero where none is measured.
        energies: factors of K per component.
        area: area of the sheet.
    """

    work: tuple
    loads: tuple
    energies: tuple
    area: float

    @classmethod
    def build(
        cls,
        mesh: Mesh,
        constrained: Bool[np.ndarray, "edge 2"],
        measured: Bool[np.ndarray, "edge 2"],
        variance: float | Float[np.ndarray, " cell"] = 1.0,
    ) -> "EquilibriumGap":
        """Assemble for one test.

        Args:
            mesh: the measured grid.
            constrained: whether each edge's displacement component is prescribed.
            measured: whether the resultant of each edge and component is known.
            variance: of the stress in each cell over the mean one (cell,); stress that is in doubt is cheaper to
                correct, and the gap is what the cheapest correction costs.
        """
        D, K = nodal_force_matrices(mesh), stiffness_matrix(mesh, variance)
        work, loads, energies = [], [], []
        for component in range(2):
            T, energy, edge = balance_energy(mesh, K, component, constrained, measured)
            work.append(tuple(BCOO.from_scipy_sparse((T.T @ D[J]).astype(np.float32)) for J in range(2)))
            energies.append(BlockCholesky.of(energy, _lines(mesh, T, edge)))
            unit = np.zeros(T.shape[1])
            if edge is not None:
                unit[-1] = 1.0
            loads.append(jnp.asarray(unit, jnp.float32))
        return cls(tuple(work), tuple(loads), tuple(energies), float(mesh.areas.sum()))

    def squared(
        self,
        P: Float[ArrayLike, "2 2 step cell"],
        resultant: Float[ArrayLike, "step 2"],
        scale: Float[ArrayLike, " step"],
    ) -> Float[Array, " step"]:
        """The squared gap of every step.

        Args:
            P: cell stresses.
            resultant: force on the tied edge per component and unit thickness (any number where
                nothing is tied).
            scale: stress unit of each step.
        """
        total = jnp.zeros_like(scale)
        for i in range(2):
            R = sum(self.work[i][J] @ P[i, J].T for J in range(2)) - self.loads[i][:, None] * resultant[:, i]
            total = total + _energies(R / (scale * self.area**0.5), self.energies[i])
        return total
