"""Finite elements of a sheet of a few materials and lines between them: forces, tangent, and what decides them."""

import copy
from dataclasses import dataclass

import numpy as np
import scipy.sparse
from jaxtyping import Float, Int

from hypernode.fem.factors import factorise
from hypernode.fem.mesh import Mesh
from hypernode.identification.laminates import laminate
from hypernode.identification.points import Points

#: Newton steps to equilibrium at most.
STEPS = 12


@dataclass(frozen=True)
class CellMaterials:
    """Which materials cells are of.

    Attributes:
        materials: parameters (material, parameter).
        one: material of every cell, of a cut one that on the positive side of its line (cell,).
        cut: numbers of the cells that a line cuts (cut,).
        other: material on the other side (cut,).
        share: of the first (cut,).
        normal: of the line there, towards the first (cut, 2).
    """

    materials: Float[np.ndarray, "material parameter"]
    one: Int[np.ndarray, " cell"]
    cut: Int[np.ndarray, " cut"]
    other: Int[np.ndarray, " cut"]
    share: Float[np.ndarray, " cut"]
    normal: Float[np.ndarray, "cut 2"]


@dataclass(frozen=True)
class CellResponse:
    """Nodal forces of cells by what decides them.

    Attributes:
        by_one: derivative of the forces by the parameters of the first material (cell, 8, parameter).
        by_other: by those of the second (cut, 8, parameter).
        by_share: by the share of the first (cut, 8).
    """

    by_one: np.ndarray
    by_other: np.ndarray
    by_share: np.ndarray


class Sheet:
    """Bilinear cells of a mesh.

    Args:
        relative_thickness: of every cell.
    """

    def __init__(self, mesh: Mesh, points: Points, relative_thickness: Float[np.ndarray, " cell"]):
        self.mesh, self.points = mesh, points
        corner = mesh.nodes[mesh.cells]
        g = 1.0 / np.sqrt(3.0)
        self._B, weight = [], []
        for s, t in ((-g, -g), (g, -g), (g, g), (-g, g)):
            local = 0.25 * np.array([[t - 1, s - 1], [1 - t, -1 - s], [1 + t, 1 + s], [-1 - t, 1 - s]])
            jacobian = np.einsum("cai,aj->cij", corner, local)
            self._B.append(np.einsum("aj,cjJ->aJc", local, np.linalg.inv(jacobian)))
            weight.append(np.linalg.det(jacobian))
        #: [a, J, quad, cell] and [quad, cell].
        self._B = np.stack(self._B, axis=2)
        self._weight = np.stack(weight) * relative_thickness
        dofs, count = mesh.dofs, mesh.nodes.size
        rows, columns = np.repeat(dofs, 8, axis=1).ravel(), np.tile(dofs, (1, 8)).ravel()
        place, self._place = np.unique(columns * count + rows, return_inverse=True)
        self._pattern = place % count, np.searchsorted(place // count, np.arange(count + 1))

    def response(self, u: Float[np.ndarray, "node 2"], of: CellMaterials, with_parameters: bool = False):
        """(nodal forces (degree of freedom,), their tangent (sparse), :class:`CellResponse` or None)."""
        H = np.einsum("cai,aJqc->iJqc", u[self.mesh.cells], self._B)
        F = H + np.eye(2)[:, :, None, None]
        shape, flat = F.shape, F.reshape(2, 2, -1)
        quads, params = shape[2], of.materials[of.one].T
        every = np.tile(params, (1, quads))
        if with_parameters:
            P, A, D = (each.reshape(*each.shape[:-1], *shape[2:]) for each in self.points.all(flat, every))
        else:
            P, A = (each.reshape(*each.shape[:-1], *shape[2:]) for each in self.points.stress(flat, every))
        cells = None
        if len(of.cut):
            some = F[..., of.cut].reshape(2, 2, -1)
            given = params[:, of.cut], of.materials[of.other].T, of.share, of.normal.T
            layers = laminate(self.points, some, *(np.tile(each, quads) for each in given), with_parameters)
            at = (quads, len(of.cut))
            P[..., of.cut] = layers.P.reshape(2, 2, *at)
            A[..., of.cut] = layers.by_F.reshape(2, 2, 2, 2, *at)
        if with_parameters:
            by_other, by_share = np.zeros((0, 8, D.shape[2])), np.zeros((0, 8))
            if len(of.cut):
                D[..., of.cut] = layers.by_first.reshape(*D.shape[:3], *at)
                by_other = self._forces(layers.by_second.reshape(*D.shape[:3], *at), of.cut)
                by_share = self._forces(layers.by_share.reshape(2, 2, 1, *at), of.cut)[..., 0]
            cells = CellResponse(self._forces(D), by_other, by_share)
        force = self._forces(P[:, :, None])[..., 0]
        # Forces follow from P by B, and F from u by B again.
        half = np.einsum("aJqc,iJkLqc->aikLqc", self._B, A * self._weight, optimize=True)
        K = np.einsum("aikLqc,bLqc->caibk", half, self._B, optimize=True).reshape(-1)
        data = np.bincount(self._place, K, len(self._pattern[0]))
        matrix = scipy.sparse.csc_matrix((data, *self._pattern), 2 * (self.mesh.nodes.size,))
        return np.bincount(self.mesh.dofs.ravel(), force.ravel(), self.mesh.nodes.size), matrix, cells

    def _forces(self, P, cells=slice(None)):
        """Nodal forces (cell, 8, column) of stresses [i, J, column, quad, cell]."""
        B, weight = self._B[..., cells], self._weight[:, cells]
        found = np.einsum("aJqc,iJpqc->caip", B, P * weight, optimize=True)
        return found.reshape(found.shape[0], 8, -1)

    def cell_forces(self, u: Float[np.ndarray, "node 2"], of: CellMaterials) -> Float[np.ndarray, "cell 8"]:
        """Nodal forces by cell."""
        F = np.einsum("cai,aJqc->iJqc", u[self.mesh.cells], self._B) + np.eye(2)[:, :, None, None]
        quads, params = F.shape[2], of.materials[of.one].T
        P, _ = self.points.stress(F.reshape(2, 2, -1), np.tile(params, (1, quads)))
        P = P.reshape(F.shape)
        if len(of.cut):
            given = params[:, of.cut], of.materials[of.other].T, of.share, of.normal.T
            some = F[..., of.cut].reshape(2, 2, -1)
            layers = laminate(self.points, some, *(np.tile(each, quads) for each in given), False)
            P[..., of.cut] = layers.P.reshape(2, 2, quads, -1)
        return self._forces(P[:, :, None])[..., 0]

    def stiffer(self, factor: Float[np.ndarray, " cell"]) -> "Sheet":
        """The same, every cell stiffer by a factor."""
        other = copy.copy(self)
        other._weight = self._weight * factor
        return other

    def equilibrium(self, guess: Float[np.ndarray, "node 2"], free, of: CellMaterials, tolerance: float):
        """(displacement, nodal forces, tangent) in equilibrium near a guess; None where Newton's method finds none."""
        u = guess.copy()
        fixed = np.setdiff1d(np.arange(u.size), free)
        for _ in range(STEPS):
            force, K, _ = self.response(u, of)
            size = np.linalg.norm(force[free]) / max(np.linalg.norm(force[fixed]), np.finfo(float).tiny)
            if not np.isfinite(size):
                return None
            if size <= tolerance:
                return u, force, K
            step = np.zeros(u.size)
            step[free] = factorise(K[free][:, free]).solve(force[free])
            u = u - step.reshape(u.shape)
        return None
