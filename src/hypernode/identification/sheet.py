"""Finite elements of a sheet of a few materials and lines between them: forces, tangent, and what decides them."""

from dataclasses import dataclass, fields, replace

import numpy as np
import scipy.sparse
from jaxtyping import Float, Int

from hypernode.fem.factors import Factors, factorise
from hypernode.fem.mesh import Mesh
from hypernode.identification import budgets, numerics
from hypernode.identification.coats import Pieces
from hypernode.identification.laminates import Jumps, LaminateStress, laminate
from hypernode.identification.points import Points


@dataclass(frozen=True, kw_only=True)
class CellMaterials(Pieces):
    """Which materials cells are of.

    A cell that lines cut is a weighted mean of layers of two materials.

    Attributes:
        materials: parameters (material, parameter).
        one: material of every cell; of a cut one it says nothing (cell,).
        factor: by which each cell is stiffer than its materials (cell,).
        added: to the parameters of the material of every cell that no line cuts (cell, parameter), or none.
    """

    materials: Float[np.ndarray, "material parameter"]
    one: Int[np.ndarray, " cell"]
    factor: Float[np.ndarray, " cell"]
    added: Float[np.ndarray, "cell parameter"] | float = 0.0

    @property
    def of_cells(self) -> Float[np.ndarray, "cell parameter"]:
        """Parameters of every cell that no line cuts."""
        return self.materials[self.one] + self.added

    def all_of(self, material: int) -> "CellMaterials":
        """Cells that are all of one of the materials, which no line cuts."""
        none = {each.name: getattr(self, each.name)[:0] for each in fields(Pieces)}
        return replace(self, one=np.full_like(self.one, material), **none)

    def layers(
        self,
        points: Points,
        F: Float[np.ndarray, "2 2 quad piece"],
        with_parameters: bool,
        near: Jumps | None = None,
    ) -> LaminateStress:
        """What each pair of layers answers to the deformation of its cell [..., quad and piece].

        Args:
            near: of the same layers under a deformation near this one.
        """
        given = self.materials[self.first].T, self.materials[self.second].T, self.share, self.normal.T
        each = (np.tile(part, F.shape[2]) for part in given)
        return laminate(points, F.reshape(2, 2, -1), *each, with_parameters, near)

    def mean(self, of_pieces: Float[np.ndarray, "... piece"], count: int) -> Float[np.ndarray, "... cell"]:
        """Weighted means over the pieces of every cell, zero in cells that no line cuts."""
        pieces = np.arange(len(self.cell))
        add = scipy.sparse.csr_matrix((self.weight, (pieces, self.cell)), (len(pieces), count))
        return (of_pieces.reshape(-1, len(pieces)) @ add).reshape(*of_pieces.shape[:-1], count)


@dataclass(frozen=True, kw_only=True)
class CellResponse:
    """Nodal forces of cells by what decides them.

    Attributes:
        by_one: derivative of the forces by the parameters of the material of uncut cells (cell, 8, parameter).
        by_first, by_second: by those of both materials of a pair of layers (piece, 8, parameter).
        by_weight: by the weight of a pair (piece, 8).
        by_share: by the share of the first (piece, 8).
        by_normal: by the normal of the plane (piece, 8, 2).
        by_factor: by the logarithm of the factor of each cell (cell, 8), None where it is not asked for.
    """

    by_one: np.ndarray
    by_first: np.ndarray
    by_second: np.ndarray
    by_weight: np.ndarray
    by_share: np.ndarray
    by_normal: np.ndarray
    by_factor: np.ndarray | None


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
        # In the type that sparse matrices have, so that all tangents share them.
        pattern = place % count, np.searchsorted(place // count, np.arange(count + 1))
        self._pattern = [each.astype(np.int32) for each in pattern]

    def response(self, u: Float[np.ndarray, "node 2"], of: CellMaterials):
        """(nodal forces (degree of freedom,), their tangent (sparse))."""
        return self._response(u, of)[:2]

    def _response(self, u, of: CellMaterials, near: Jumps | None = None):
        """The same, with the jumps of the layers, which begin near those of a displacement nearby."""
        F, jumps = self._deformation(u), None
        P, A = self._of_whole_cells(self.points.stress, F, of)
        if len(of.cell):
            layers = of.layers(self.points, F[..., of.cell], False, near)
            P, A, jumps = *(self._with_layers(*each, of) for each in ((P, layers.P), (A, layers.by_F))), layers.jumps
        force = self._forces((P * of.factor)[:, :, None])[..., 0]
        # Forces follow from P by B, and F from u by B again.
        half = np.einsum("aJqc,iJkLqc->aikLqc", self._B, A * (of.factor * self._weight), optimize=True)
        K = np.einsum("aikLqc,bLqc->caibk", half, self._B, optimize=True).reshape(-1)
        data = np.bincount(self._place, K, len(self._pattern[0]))
        matrix = scipy.sparse.csc_matrix((data, *self._pattern), 2 * (self.mesh.nodes.size,))
        return np.bincount(self.mesh.dofs.ravel(), force.ravel(), self.mesh.nodes.size), matrix, jumps

    def cell_response(self, u: Float[np.ndarray, "node 2"], of: CellMaterials, by_factor: bool = False) -> CellResponse:
        """How nodal forces answer to what decides them."""
        F, whole = self._deformation(u), self._whole(of)
        D = self._of_whole_cells(lambda *given: (self.points.by_parameters(*given),), F, of)[0]
        layers = of.layers(self.points, F[..., of.cell], True) if len(of.cell) else None
        force = self.cell_forces(u, of, layers) if by_factor else None
        pieces = _no_pieces(D.shape[2]) if layers is None else self._of_pieces(layers, of)
        return CellResponse(by_one=self._forces(D * whole * of.factor), by_factor=force, **pieces)

    def cell_forces(
        self, u: Float[np.ndarray, "node 2"], of: CellMaterials, layers: LaminateStress | None = None
    ) -> Float[np.ndarray, "cell 8"]:
        """Nodal forces of every cell.

        Args:
            layers: what the layers answer to that displacement, where it is known.
        """
        F = self._deformation(u)
        P, _ = self._of_whole_cells(self.points.stress, F, of)
        if len(of.cell):
            layers = of.layers(self.points, F[..., of.cell], False) if layers is None else layers
            P = self._with_layers(P, layers.P, of)
        return self._forces((P * of.factor)[:, :, None])[..., 0]

    def _of_whole_cells(self, function, F, of: CellMaterials):
        """What a function of F and parameters at points makes of cells that are of one material [..., quad, cell]."""
        quads, cells = F.shape[2:]
        found = function(F.reshape(2, 2, -1), np.tile(of.of_cells.T, (1, quads)))
        return [each.reshape(*each.shape[:-1], quads, cells) for each in found]

    def _whole(self, of: CellMaterials):
        """Whether no line cuts a cell (cell,)."""
        return np.bincount(of.cell, minlength=len(self.mesh.cells)) == 0

    def _with_layers(self, of_one, of_layers, of: CellMaterials):
        """Values of cells [..., quad, cell], those of cut cells as means over their layers."""
        quads, cells = of_one.shape[-2:]
        return of_one * self._whole(of) + of.mean(of_layers.reshape(*of_layers.shape[:-1], quads, -1), cells)

    def _deformation(self, u) -> Float[np.ndarray, "2 2 quad cell"]:
        H = np.einsum("cai,aJqc->iJqc", u[self.mesh.cells], self._B)
        return H + np.eye(2)[:, :, None, None]

    def _forces(self, P, cells=slice(None)):
        """Nodal forces (cell, 8, column) of stresses [i, J, column, quad, cell]."""
        B, weight = self._B[..., cells], self._weight[:, cells]
        found = np.einsum("aJqc,iJpqc->caip", B, P * weight, optimize=True)
        return found.reshape(found.shape[0], 8, -1)

    def _of_pieces(self, layers: LaminateStress, of: CellMaterials) -> dict[str, np.ndarray]:
        """Everything of :class:`CellResponse` that pairs of layers have, by name."""
        found, quads, factor = [], self._B.shape[2], of.factor[of.cell]
        each = layers.by_first, layers.by_second, layers.P[:, :, None], layers.by_share[:, :, None], layers.by_normal
        for part, weight in zip(each, (of.weight, of.weight, np.ones(len(of.cell)), of.weight, of.weight), strict=True):
            stress = part.reshape(*part.shape[:3], quads, -1) * (weight * factor)
            found.append(self._forces(stress, of.cell))
        by_first, by_second, by_weight, by_share, by_normal = found
        by_number = {"by_weight": by_weight[..., 0], "by_share": by_share[..., 0]}
        return {"by_first": by_first, "by_second": by_second, "by_normal": by_normal, **by_number}

    def equilibrium(
        self, guess: Float[np.ndarray, "node 2"], free, of: CellMaterials, tolerance: float, near: Factors | None = None
    ):
        """(displacement, nodal forces, tangent) in equilibrium near a guess; None where Newton's method finds none.

        A step that leaves more than there was is halved: a compliant cell beside a stiff one would turn inside out.

        Args:
            near: factors of the free tangent of a state near by. They serve as long as every step leaves little.
        """
        u, jumps, left, step = guess.copy(), None, np.inf, None
        fixed = np.setdiff1d(np.arange(u.size), free)
        for _ in range(budgets.EQUILIBRIUM_STEPS):
            force, K, reached = self._response(u, of, jumps)
            size = np.linalg.norm(force[free])
            if not size < left:
                if step is None:
                    return None
                if near is None:
                    step = 0.5 * step
                    u = u + step
                else:
                    u, left, step, near = u + step, np.inf, None, None
                continue
            near = None if size > numerics.SLOW * left else near
            jumps, left = reached, size
            size = size / max(np.linalg.norm(force[fixed]), np.finfo(float).tiny)
            if size <= tolerance * (1.0 if near is None else numerics.WITH_OLD_FACTORS):
                return u, force, K
            step = np.zeros(u.size)
            step[free] = (near or factorise(K[free][:, free])).solve(force[free])
            step = step.reshape(u.shape)
            u = u - step
            # A step with its own factors leaves about the square of a small residual.
            if near is None and size**2 <= tolerance:
                return u, force - K @ step.ravel(), K
        return None


def _no_pieces(parameters: int) -> dict[str, np.ndarray]:
    """What :class:`CellResponse` has of pairs of layers where there are none, by name."""
    shapes = {"by_first": (parameters,), "by_second": (parameters,), "by_weight": (), "by_share": (), "by_normal": (2,)}
    return {name: np.zeros((0, 8, *shape)) for name, shape in shapes.items()}
