"""A sheet whose cells are each of one of a few materials: a mosaic, as finite elements or a printer's voxels make it.

No line cuts a cell. Which material a cell is of changes by whole cells.
"""

import dataclasses

import numpy as np
import scipy.sparse
from jaxtyping import Float, Int

from hypernode.fem.contour import ContourLines
from hypernode.identification import priors
from hypernode.identification.coats import Cut, Cuts, layers_of
from hypernode.identification.contours import Options, at_contours, options_at_contours
from hypernode.identification.interfaces import Interfaces
from hypernode.identification.lines import Lines
from hypernode.identification.sheet import CellMaterials


@dataclasses.dataclass(frozen=True, kw_only=True)
class Mosaic(Interfaces):
    """Materials of whole cells.

    Attributes:
        of_cells: material of every cell of the measured grid, whose cells are the finite elements (cell,).
        given: labels that lines told, from which few cells differ; None without lines (cell,).
        code: logarithm of the number of lines as probable as those.
    """

    of_cells: Int[np.ndarray, " cell"] = None
    given: Int[np.ndarray, " cell"] | None = None
    code: float = 0.0

    @classmethod
    def of(cls, lines: Lines, materials: Float[np.ndarray, "material parameter"], labels) -> "Mosaic":
        """The materials of cells with these labels."""
        return cls(lines, materials, np.zeros((0, len(lines.grid.mesh.nodes))), of_cells=labels)

    @property
    def places(self) -> float:
        """Logarithm of the number of labels as probable as these: of contours as long, or of changes of given ones."""
        mesh = self.lines.grid.mesh
        if self.given is not None:
            return self.code + self._change * int((self.of_cells != self.given).sum())
        sides, _, _ = mesh.neighbours()
        apart = int((self.of_cells[sides[:, 0]] != self.of_cells[sides[:, 1]]).sum())
        return priors.CONTOUR_SIDE * apart + super().places

    @property
    def _change(self) -> float:
        """What a label costs that is another one than was given: as many cells at contours may be it."""
        return float(np.log(max(at_contours(self.lines.grid.mesh, self.given).sum(), 1)))

    def _cells(self, contours: ContourLines, distances, log_factor) -> tuple[CellMaterials, Cuts]:
        none, nowhere = Cut.none(len(self.of_cells)), np.zeros(0, int)
        pieces, cuts = layers_of(self.of_cells, none, none, nowhere, nowhere)
        factor = np.exp(log_factor)
        return CellMaterials(materials=self.materials, one=self.of_cells, factor=factor, **vars(pieces)), cuts

    def labels(self) -> Int[np.ndarray, " cell"]:
        """The material of every cell."""
        return self.of_cells

    def measured_anew(self, fewest: int) -> "Mosaic":
        """The same: no distance is measured."""
        return self

    def merged(self, one: int, other: int) -> "Mosaic":
        """The same with what is of the later of two materials given to the earlier one."""
        one, other = sorted((one, other))
        given = None if self.given is None else np.where(self.given == other, one, self.given)
        return dataclasses.replace(self, given=given).with_labels(np.where(self.of_cells == other, one, self.of_cells))

    def options(self) -> Options:
        """Cells at contours may be of what they touch."""
        return options_at_contours(self.lines.grid.mesh, self.of_cells)

    def dearer(self, options: Options) -> Float[np.ndarray, " option"]:
        """What each option costs beside the length of contours: to be another label than was given, or none."""
        if self.given is None:
            return np.zeros(len(options.cell))
        given = self.given[options.cell]
        away, now = options.label != given, self.of_cells[options.cell] != given
        return self._change * (away.astype(float) - now)

    @property
    def sides(self) -> scipy.sparse.csr_matrix:
        """What sides between materials cost: nothing where labels were given."""
        return super().sides * (self.given is None)

    def with_labels(self, labels: Int[np.ndarray, " cell"]) -> "Mosaic":
        """The same with other labels. Materials that are nowhere are left out."""
        kept, labels = np.unique(labels, return_inverse=True)
        number = np.full(self.count, -1)
        number[kept] = np.arange(len(kept))
        given = None if self.given is None else number[self.given]
        return dataclasses.replace(self, materials=self.materials[kept], of_cells=labels, given=given)
