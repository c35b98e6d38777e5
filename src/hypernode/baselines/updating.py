"""Finite-element model updating of a few moduli (Kavanagh and Clough 1971).

The moduli mu_r of regions minimise

    sum |u(mu) - u_measured|^2 / (N s^2) + sum (f(mu) - f_measured)^2 / (M (p |f|)^2),

where u(mu) is in equilibrium under the measured displacements of the edges that are held. With s a hundredth of what
the displacements of a step come away from affine ones, and p a hundredth, misfits of one hundredth count as one. Noise
adds to s.
"""

import jax.numpy as jnp
import numpy as np
import scipy.sparse
from jaxtyping import Float, Int
from scipy.optimize import least_squares
from scipy.sparse.linalg import LinearOperator

from hypernode.baselines.equilibrium_gap import NEO_HOOKEAN, BaselineError, unit_stress
from hypernode.data.loading import Loading
from hypernode.fem.factors import factorise
from hypernode.fem.mesh import EDGE_NAMES, EDGES, Mesh, tied_edge
from hypernode.fem.solver import Equilibrium, EquilibriumSolver, law_stress

#: Misfits of one hundredth count as one.
PERCENT = 0.01


class Sheet:
    """A neo-Hookean sheet that is held as a test holds it, and what it misses of the test.

    Args:
        u: measured displacements.
        noise: standard deviation of their components.
    """

    def __init__(self, mesh: Mesh, loading: Loading, u: Float[np.ndarray, "step node 2"], noise: float):
        self.mesh, self.loading, self.u = mesh, loading, u
        self._solver = EquilibriumSolver(mesh, law_stress(NEO_HOOKEAN), {"params": jnp.zeros((len(mesh.cells), 1))})
        affine = np.concatenate([mesh.nodes, np.ones((len(mesh.nodes), 1))], axis=1)
        bent = np.stack([np.linalg.norm(each - affine @ np.linalg.lstsq(affine, each)[0]) for each in u])
        self._size = np.hypot(PERCENT * bent, noise * np.sqrt(u[0].size))
        self._fixed = [self._held(loading.constrained[case]) for case in loading.load_case]
        self._pulls = [self._pulled(step, case) for step, case in enumerate(loading.load_case)]
        self._dofs = (2 * mesh.cells[:, :, None] + np.arange(2)).reshape(len(mesh.cells), -1)

    @property
    def terms(self) -> int:
        """How many displacement fields and forces a misfit is of."""
        return len(self.u) + sum(len(known) for _, known in self._pulls)

    def _held(self, constrained) -> np.ndarray:
        """Flat degrees of freedom that keep their measured displacement."""
        mesh = self.mesh
        mask = np.zeros((len(mesh.nodes), 2), bool)
        for edge, name in enumerate(EDGE_NAMES):
            mask[mesh.on_edge(name)] |= constrained[edge]
        for i in range(2):
            if not mask[:, i].any():
                mask[np.argmin(np.abs(mesh.nodes - mesh.lower).sum(axis=1)), i] = True
        return np.flatnonzero(mask.ravel())

    def _pulled(self, step: int, case: int):
        """(rows that sum the nodal forces of edges whose resultants are measured, these resultants), in their units."""
        mesh, loading, rows, known = self.mesh, self.loading, [], []
        for i in range(2):
            edge = tied_edge(loading.constrained[case], loading.known[case], i)
            if edge is not None:
                unit = PERCENT * loading.scale[step] * mesh.size[1 - EDGES[edge][0]]
                row = np.zeros((len(mesh.nodes), 2))
                row[mesh.on_edge(edge), i] = 1.0 / unit
                rows.append(row.ravel())
                known.append(loading.resultant[step, i] / unit)
        return np.reshape(rows, (-1, 2 * len(mesh.nodes))), np.array(known)

    def states(self, level: Float[np.ndarray, " cell"], near=None) -> list[Equilibrium] | None:
        """Equilibrium of every step with these logarithms of moduli, or None where a step finds none.

        Args:
            near: states to begin from, in the place of the measured ones.
        """
        self._solver.set_parameters({"params": jnp.asarray(level)[:, None]})
        found = []
        for step, fixed in enumerate(self._fixed):
            found.append(self._solver.newton(self.u[step] if near is None else near[step].u, fixed))
            if found[-1].u is None:
                return None
        return found

    def misfit(self, states: list[Equilibrium]) -> Float[np.ndarray, " miss"]:
        """What the states miss of displacements and forces, step by step; one hundredth is one."""
        missed = []
        for step, state in enumerate(states):
            rows, known = self._pulls[step]
            missed += [(state.u - self.u[step]).ravel() / self._size[step], rows @ state.force - known]
        return np.concatenate(missed)

    def linearised(self, level: Float[np.ndarray, " cell"], states: list[Equilibrium]) -> LinearOperator:
        """Derivative of :meth:`misfit` by the logarithms of the moduli, at the last :meth:`states` and their ``level``.

        In equilibrium K du = -B dm on free degrees of freedom, with B the nodal forces of each cell.
        """
        parts = []
        for step, state in enumerate(states):
            free = np.setdiff1d(np.arange(state.u.size), self._fixed[step])
            _, K = self._solver.tangent(state.u)
            parts.append(
                (free, K, factorise(K[free][:, free]), self._forces_of_cells(level, state.u), self._pulls[step][0])
            )
        count, cells = self.u[0].size, len(self.mesh.cells)
        ends = np.cumsum([count + len(rows) for *_, rows in parts])

        def forward(change):
            moved = []
            for (free, K, factor, B, rows), size in zip(parts, self._size, strict=True):
                pushed, du = B @ change, np.zeros(count)
                du[free] = -factor.solve(pushed[free])
                moved += [du / size, rows @ (pushed + K @ du)]
            return np.concatenate(moved)

        def backward(missed):
            total = np.zeros(cells)
            each = zip(parts, self._size, np.split(missed, ends[:-1]), strict=True)
            for (free, K, factor, B, rows), size, here in each:
                pull = rows.T @ here[count:]
                answer = pull.copy()
                answer[free] -= factor.solve((here[:count] / size + K @ pull)[free])
                total += B.T @ answer
            return total

        return LinearOperator((ends[-1], cells), matvec=forward, rmatvec=backward, dtype=float)

    def _forces_of_cells(self, level, u) -> scipy.sparse.csr_matrix:
        """Nodal forces of each cell in its column, flat degrees of freedom in rows."""
        gradients, weights = self._solver.shape_gradients
        P = np.exp(level) * unit_stress(self._solver.deformation_gradient(u).T.swapaxes(0, 1))
        forces = np.einsum("cq,cqaJ,iJqc->cai", weights, gradients, P).reshape(len(self._dofs), -1)
        cell = np.repeat(np.arange(len(self._dofs)), self._dofs.shape[1])
        return scipy.sparse.csr_matrix((forces.ravel(), (self._dofs.ravel(), cell)), (u.size, len(self._dofs)))


def updated_moduli(sheet: Sheet, region: Int[np.ndarray, " cell"], start: float) -> Float[np.ndarray, " cell"]:
    """The coefficient of every cell, one for each region, from the same ``start``.

    The minimum is found by trust-region least squares, with derivatives by differences.

    Raises:
        BaselineError: the search does not converge, or no sheet of the start is in equilibrium.
    """

    def misfit(level):
        states = sheet.states(level[region])
        if states is None:
            raise BaselineError(f"a sheet with moduli {np.exp(level)} finds no equilibrium")
        return sheet.misfit(states)

    found = least_squares(misfit, np.full(region.max() + 1, np.log(start)), x_scale=0.1, diff_step=1e-4, xtol=1e-5)
    if found.status <= 0:
        raise BaselineError(f"model updating stopped after {found.nfev} evaluations: {found.message}")
    return np.exp(found.x)[region]
