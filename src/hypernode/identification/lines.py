"""Where lines between materials are told apart, on the measured grid and on finer finite elements."""

import dataclasses

import numpy as np
import scipy.sparse
from jaxtyping import Float

from hypernode.fem.contour import ContourLines
from hypernode.fem.mesh import Mesh
from hypernode.fem.refinement import Refinement
from hypernode.identification.gradual import Splines


@dataclasses.dataclass(frozen=True)
class Lines:
    """Where lines are told apart: distances at the nodes of the measured grid, cells of finer finite elements.

    Attributes:
        grid, fine: geometry of lines on both meshes.
        apart: distance between points of a line that move, in sides of cells.
        splines: of what changes gradually; None where nothing does.
        as_one: whether the shape of every line is known, so that it moves as a whole.
        between: bilinear interpolation of distances, which count in sides of cells (fine node, grid node).
    """

    grid: ContourLines
    fine: ContourLines
    between: scipy.sparse.csr_matrix
    _: dataclasses.KW_ONLY
    apart: float = 1.0
    splines: Splines | None = None
    as_one: bool = False

    @classmethod
    def of(cls, grid: Mesh, refinement: Refinement, like: "Lines | None" = None) -> "Lines":
        """On a measured grid and the mesh that divides it, as on other finite elements of that grid."""
        per_side = round(np.sqrt(refinement.subcells.shape[1]))
        found = cls(ContourLines(grid), ContourLines(refinement.mesh), per_side * refinement.interpolation)
        if like is None:
            return found
        splines = None if like.splines is None else Splines.of(grid, refinement.mesh, like.splines.bend)
        return dataclasses.replace(found, apart=like.apart, splines=splines, as_one=like.as_one)

    def from_centre(self, cell: int) -> Float[np.ndarray, " node"]:
        """Distance of every node of the grid from the centre of a cell, in sides of cells."""
        mesh = self.grid.mesh
        places = np.stack(np.divmod(mesh.places, len(mesh.lines[0])), axis=1)
        return np.linalg.norm(places - places[mesh.cells[cell]].mean(axis=0), axis=1)
