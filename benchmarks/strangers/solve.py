"""Equilibrium of a sheet by quadratic triangles of scikit-fem, refined where an interface cuts them."""

from dataclasses import dataclass
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
import scipy.sparse
import skfem
from matplotlib.tri import Triangulation
from scipy.sparse.linalg import cg, splu

from benchmarks.strangers.design import SIDE, Sheet
from benchmarks.strangers.laws import energy

#: Triangles' sides to a step of the camera's grid: of a field without jumps, and of one that is refined at them.
SIDES, COARSE_SIDES, REFINEMENTS = 2.1, 1.3, 3
#: Largest residual of free nodes over that of held ones.
TOLERANCE = 1e-9


class NoEquilibrium(RuntimeError):
    """Newton's method did not end."""


@dataclass(frozen=True)
class Equilibria:
    """A sheet at several loads.

    Attributes:
        amount: share of the largest load (load,).
        basis: of the scalar field that each component of the displacement is.
        u: displacement (load, node, 2) [mm].
        force: over the thickness, on the right edge along x and on the upper along y (load, 2) [N/mm].
    """

    amount: np.ndarray
    basis: skfem.Basis
    u: np.ndarray
    force: np.ndarray

    def displacement(self, X) -> np.ndarray:
        """At positions [mm] (point, 2), as (load, point, 2)."""
        # Those on the edge of the sheet are in no triangle after rounding.
        at = np.clip(np.asarray(X), 1e-9 * SIDE, (1.0 - 1e-9) * SIDE).T
        mesh, mapping, element = self.basis.mesh, self.basis.mapping, self.basis.elem
        cells = Triangulation(*mesh.p, mesh.t.T).get_trifinder()(*at)
        local = mapping.invF(at[:, :, None], tind=cells)
        found = np.zeros((len(self.u), at.shape[1], 2))
        for k, dofs in enumerate(self.basis.element_dofs):
            shape = np.asarray(element.gbasis(mapping, local, k, tind=cells)[0])
            found += shape[:, :1] * self.u[:, dofs[cells]]
        return found


def mesh_of(sheet: Sheet) -> skfem.MeshTri:
    """Triangles [mm] whose sides have no regard to the camera's grid."""
    smooth = sheet.shape in ("slope", "none")
    ticks = np.linspace(0.0, SIDE, round((SIDES if smooth else COARSE_SIDES) * (sheet.points - 1)) + 1)
    mesh = skfem.MeshTri.init_tensor(ticks, ticks)
    share = np.array([(i, j, 4 - i - j) for i in range(5) for j in range(5 - i)]) / 4
    for _ in range(0 if smooth else REFINEMENTS):
        inside = np.einsum("pk,dkc->cpd", share, mesh.p[:, mesh.t])
        weights = sheet.weights(inside.reshape(-1, 2)).reshape(*inside.shape[:2], -1)
        mesh = mesh.refined(np.flatnonzero((weights != weights[:, :1]).any(axis=(1, 2))))
    return mesh


@partial(jax.jit, static_argnames="kind")
def _response(kind, laws, weights, gradients, measure, u):
    """Forces (cell, node, 2) and stiffnesses (cell, node, 2, node, 2) of cells that move by u (cell, node, 2)."""
    F = jnp.eye(2) + jnp.einsum("cai,cqaJ->cqiJ", u, gradients)
    first = jax.grad(energy, argnums=2)
    by_point = (None, None, 0, 0)
    P = jax.vmap(jax.vmap(first, by_point), by_point)(kind, laws, F, weights)
    A = jax.vmap(jax.vmap(jax.jacfwd(first, argnums=2), by_point), by_point)(kind, laws, F, weights)
    force = jnp.einsum("cqiJ,cqaJ,cq->cai", P, gradients, measure)
    return force, jnp.einsum("cqaJ,cqiJkL,cqbL,cq->caibk", gradients, A, gradients, measure, optimize="optimal")


class _System:
    """Forces and tangents of a whole sheet."""

    def __init__(self, sheet: Sheet, mesh: skfem.MeshTri):
        self.sheet = sheet
        self.basis = basis = skfem.Basis(mesh, skfem.ElementTriP2(), intorder=4)
        self.gradients = np.stack([each[0].grad for each in basis.basis]).transpose(2, 3, 0, 1)
        self.measure = np.asarray(basis.dx)
        X = np.asarray(basis.global_coordinates()).transpose(1, 2, 0)
        weights = sheet.weights(X.reshape(-1, 2)) * sheet.relative_thickness(X.reshape(-1, 2))
        self.weights = weights.reshape(*X.shape[:2], -1)
        self.nodes = basis.element_dofs.T
        self.dofs = (2 * self.nodes[:, :, None] + np.arange(2)).reshape(len(self.nodes), -1)
        self.X = basis.doflocs.T

    def response(self, u, amount: float):
        """(force (node, 2), tangent) at displacements (node, 2) and a share of the largest load."""
        forces, stiffness = _response(
            self.sheet.kind, self.sheet.laws_at(amount), self.weights, self.gradients, self.measure, u[self.nodes]
        )
        width, size = self.dofs.shape[1], u.size
        force = np.bincount(self.dofs.ravel(), np.asarray(forces).ravel(), size).reshape(-1, 2)
        rows, columns = np.repeat(self.dofs, width, axis=1).ravel(), np.tile(self.dofs, (1, width)).ravel()
        return force, scipy.sparse.csc_matrix((np.asarray(stiffness).ravel(), (rows, columns)), (size, size))

    def held(self):
        """(numbers of the degrees of freedom that are held, displacement (node, 2) of an affine sheet at full load)."""
        low, high = self.X < 1e-9, self.X > SIDE - 1e-9
        strain = np.array([self.sheet.across * self.sheet.top, self.sheet.top])
        if self.sheet.load == "clamped_y":
            strain[0], ends = 0.0, low[:, 1] | high[:, 1]
            mask = np.stack([ends, ends], axis=1)
        else:
            mask = low | high
        return np.flatnonzero(mask), strain * self.X


def solve(sheet: Sheet, loads: int = 6) -> Equilibria:
    """Equilibrium at equal shares of the largest load.

    Raises:
        NoEquilibrium: Newton's method does not end.
    """
    system = _System(sheet, mesh_of(sheet))
    held, affine = system.held()
    free = np.setdiff1d(np.arange(affine.size), held)
    amounts = np.arange(1, loads + 1) / loads
    u, before, found, forces = affine, 1.0, [], []
    for amount in amounts:
        u = _equilibrium(system, u * (amount / before), held, free, amount)
        force, _ = system.response(u, amount)
        found.append(u)
        forces.append([force[system.X[:, axis] > SIDE - 1e-9, axis].sum() for axis in range(2)])
        before = amount
    return Equilibria(amounts, system.basis, np.array(found), np.array(forces))


def _equilibrium(system: _System, u, held, free, amount: float):
    """The displacement in equilibrium that moves held nodes as ``u`` does.

    The first tangent is factorised; conjugate gradients with it solve the systems of the later ones.
    """
    factor = None
    for _ in range(25):
        force, tangent = system.response(u, amount)
        residual = force.ravel()[free]
        if np.linalg.norm(residual) < TOLERANCE * np.linalg.norm(force.ravel()[held]):
            return u
        tangent = tangent[free][:, free]
        if factor is None:
            factor = splu(tangent, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
            change = factor.solve(residual)
        else:
            inverse = scipy.sparse.linalg.LinearOperator(tangent.shape, factor.solve)
            change, _ = cg(tangent, residual, rtol=1e-5, maxiter=60, M=inverse)
        u = _moved(system, u, free, change, np.linalg.norm(residual), amount)
    raise NoEquilibrium(f"seed {system.sheet.seed}: no equilibrium")


def _moved(system: _System, u, free, change, size, amount: float):
    """``u`` less a change, or as much of it as does not double the residual."""
    for halvings in range(6):
        new = u.copy().ravel()
        new[free] -= change / 2**halvings
        new = new.reshape(-1, 2)
        found = np.linalg.norm(system.response(new, amount)[0].ravel()[free])
        if np.isfinite(found) and found < 2.0 * size:
            return new
    raise NoEquilibrium(f"seed {system.sheet.seed}: no step lowers the residual")
