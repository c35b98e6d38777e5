"""A few materials and the lines between them: the field of a sheet that is made of parts.

Materials are laid one over the other, as coats of paint: the first is everywhere, each further one where the distance
from its own line is positive. So any number of materials have lines of their own. Where two coats meet, the later one
hides the earlier. A cell that the uppermost line cuts is of two layers.
"""

import dataclasses

import numpy as np
import scipy.sparse
from jaxtyping import Float, Int

from hypernode.fem.contour import ContourLines
from hypernode.fem.mesh import Mesh
from hypernode.fem.refinement import Refinement
from hypernode.identification.sheet import CellMaterials, CellResponse

#: Share of a cell below which a layer of it is none.
SMALLEST_SHARE = 1e-5


@dataclasses.dataclass(frozen=True)
class Lines:
    """Where lines are told apart: distances at the nodes of the measured grid, cells of finer finite elements.

    Attributes:
        grid, fine: geometry of lines on both meshes.
        between: bilinear interpolation of distances, which count in sides of cells (fine node, grid node).
    """

    grid: ContourLines
    fine: ContourLines
    between: scipy.sparse.csr_matrix

    @classmethod
    def of(cls, grid: Mesh, refinement: Refinement) -> "Lines":
        """On a measured grid and the mesh that divides it."""
        per_side = round(np.sqrt(refinement.subcells.shape[1]))
        return cls(ContourLines(grid), ContourLines(refinement.mesh), per_side * refinement.interpolation)


@dataclasses.dataclass(frozen=True)
class Interfaces:
    """Materials and lines.

    Attributes:
        lines: where they are told apart.
        materials: parameters, in the order in which they are laid (material, parameter).
        distances: signed distance of every node of the grid from the line of each material but the first, positive
            where it is (line, node).
    """

    lines: Lines
    materials: Float[np.ndarray, "material parameter"]
    distances: Float[np.ndarray, "line node"]

    @classmethod
    def homogeneous(cls, lines: Lines, params: Float[np.ndarray, " parameter"]) -> "Interfaces":
        """One material."""
        return cls(lines, params[None], np.zeros((0, len(lines.grid.mesh.nodes))))

    @property
    def count(self) -> int:
        """How many materials there are."""
        return len(self.materials)

    def cells(self) -> tuple[CellMaterials, Int[np.ndarray, " cut"]]:
        """(what every cell of the finite elements is of, the line that cuts each cut cell)."""
        return self._cells(self.lines.fine, [self.lines.between @ distance for distance in self.distances])

    def grid_cells(self) -> CellMaterials:
        """What every cell of the measured grid is of."""
        return self._cells(self.lines.grid, self.distances)[0]

    def _cells(self, contours: ContourLines, distances):
        count = len(contours.mesh.cells)
        one, other, line = np.zeros(count, int), np.zeros(count, int), np.full(count, -1)
        share, normal = np.ones(count), np.tile([1.0, 0.0], (count, 1))
        for k, distance in enumerate(distances):
            covered, towards = contours.cells(distance)
            # Below a cut stands what most of the cell is of.
            below = np.where((line >= 0) & (share < 0.5), other, one)
            whole = covered > 1.0 - SMALLEST_SHARE
            cut = (covered > SMALLEST_SHARE) & ~whole
            # Where two lines cut a cell, the one that divides it more evenly counts.
            taken = cut & ((line < 0) | (np.abs(covered - 0.5) <= np.abs(share - 0.5)))
            one = np.where(whole | taken, k + 1, one)
            other = np.where(taken, below, other)
            line = np.where(taken, k, np.where(whole, -1, line))
            share = np.where(taken, covered, np.where(whole, 1.0, share))
            normal[taken] = towards[taken]
        cut = np.flatnonzero(line >= 0)
        return CellMaterials(self.materials, one, cut, other[cut], share[cut], normal[cut]), line[cut]

    def labels(self) -> Int[np.ndarray, " cell"]:
        """The material that most of every cell of the grid is of."""
        of = self.grid_cells()
        labels = of.one.copy()
        labels[of.cut] = np.where(of.share < 0.5, of.other, of.one[of.cut])
        return labels

    def near(self, reach: float) -> list[Int[np.ndarray, " near"]]:
        """Nodes of the grid of which each line's distance may change."""
        return [np.flatnonzero(np.abs(distance) < reach) for distance in self.distances]

    def loads(self, response: CellResponse, near) -> scipy.sparse.csr_matrix:
        """Derivative of the nodal forces by the materials, row by row, and by the distances of the near nodes."""
        of, line = self.cells()
        mesh, count = self.lines.fine.mesh, self.materials.shape[1]
        rows, columns, values = [], [], []
        for each, material, dofs in (
            (response.by_one, of.one, mesh.dofs),
            (response.by_other, of.other, mesh.dofs[of.cut]),
        ):
            rows.append(np.repeat(dofs[:, :, None], count, axis=2).ravel())
            columns.append(np.broadcast_to(material[:, None, None] * count + np.arange(count), each.shape).ravel())
            values.append(each.ravel())
        entries = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
        found = [scipy.sparse.csr_matrix(entries, (mesh.nodes.size, self.materials.size))]
        for k, nodes in enumerate(near):
            own = np.flatnonzero(line == k)
            slopes = self.lines.fine.slopes(self.lines.between @ self.distances[k])[of.cut[own]]
            each = response.by_share[own][:, :, None] * slopes[:, None]
            rows = np.broadcast_to(mesh.dofs[of.cut[own]][:, :, None], each.shape).ravel()
            columns = np.broadcast_to(mesh.cells[of.cut[own]][:, None], each.shape).ravel()
            by_fine = scipy.sparse.csr_matrix((each.ravel(), (rows, columns)), (mesh.nodes.size, len(mesh.nodes)))
            found.append(by_fine @ self.lines.between[:, nodes])
        return scipy.sparse.hstack(found, format="csr")

    def at(self, y: Float[np.ndarray, " number"], near) -> "Interfaces":
        """The same with other numbers, in the order of :meth:`loads`."""
        materials, rest = y[: self.materials.size].reshape(self.materials.shape), y[self.materials.size :]
        distances = self.distances.copy()
        ends = np.cumsum([0, *(len(nodes) for nodes in near)])
        for k, nodes in enumerate(near):
            distances[k, nodes] = rest[ends[k] : ends[k + 1]]
        return dataclasses.replace(self, materials=materials, distances=distances)

    def numbers(self, near) -> Float[np.ndarray, " number"]:
        """The numbers that :meth:`at` takes."""
        return np.concatenate([self.materials.ravel(), *(row[n] for row, n in zip(self.distances, near, strict=True))])

    def measured_anew(self, fewest: int) -> "Interfaces":
        """The same lines, from which distances are measured anew; regions of fewer nodes are none."""
        distances = [self.lines.grid.distance(row, fewest) for row in self.distances]
        return dataclasses.replace(self, distances=np.array(distances).reshape(self.distances.shape))

    def merged(self, one: int, other: int) -> "Interfaces":
        """The same with what is of the later of two materials given to the earlier one."""
        one, other = sorted((one, other))
        distances = list(self.distances)
        gone = distances.pop(other - 1)
        for k in range(other - 1):
            # What it hid stays hidden, but of the material that it joins.
            distances[k] = np.maximum(distances[k], gone) if k == one - 1 else np.minimum(distances[k], -gone)
        kept = np.delete(self.materials, other, axis=0)
        shape = len(kept) - 1, self.distances.shape[1]
        return dataclasses.replace(self, materials=kept, distances=np.array(distances).reshape(shape))

    def on(self, lines: Lines) -> "Interfaces":
        """The same on other finite elements of the same grid."""
        return dataclasses.replace(self, lines=lines)

    def with_law(self, materials: Float[np.ndarray, "material parameter"]) -> "Interfaces":
        """The same lines between other materials."""
        return dataclasses.replace(self, materials=materials)
