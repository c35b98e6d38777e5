"""A few materials and the lines between them: the field of a sheet that is made of parts.

Materials are laid one over the other, as coats of paint: the first is everywhere, each further one where the distance
from its own line is positive. So any number of materials have lines of their own. Where two coats meet, the later one
hides the earlier. A cell that a line cuts is of two layers.
"""

import dataclasses

import numpy as np
import scipy.sparse
from jaxtyping import Float, Int

from hypernode.fem.contour import ContourLines
from hypernode.identification import numerics
from hypernode.identification.coats import Cuts, laid, layers_of
from hypernode.identification.contours import Options, begin_regions, options_of, regions_of, sides_of
from hypernode.identification.gradual import Splines, loads_of_change, turned
from hypernode.identification.lines import Lines
from hypernode.identification.sheet import CellMaterials, CellResponse, Sheet


@dataclasses.dataclass(frozen=True)
class Interfaces:
    """Materials and lines.

    Attributes:
        lines: where they are told apart.
        materials: parameters, in the order in which they are laid (material, parameter).
        distances: signed distance of every node of the grid from the line of each material but the first, positive
            where it is (line, node).
        gradual: coefficients of the logarithm of a factor on all materials, none where nothing changes gradually.
        turn: of a law that changes with that factor, of :func:`turned`, or none. Only of one material.
    """

    lines: Lines
    materials: Float[np.ndarray, "material parameter"]
    distances: Float[np.ndarray, "line node"]
    gradual: Float[np.ndarray, " spline"] = dataclasses.field(default_factory=lambda: np.zeros(0))
    _: dataclasses.KW_ONLY
    turn: Float[np.ndarray, " turned"] = dataclasses.field(default_factory=lambda: np.zeros(0))

    @classmethod
    def homogeneous(cls, lines: Lines, params: Float[np.ndarray, " parameter"]) -> "Interfaces":
        """One material."""
        return cls(lines, params[None], np.zeros((0, len(lines.grid.mesh.nodes))))

    @classmethod
    def around(cls, lines: Lines, materials: Float[np.ndarray, "material parameter"], labels) -> "Interfaces":
        """Materials with a line around the cells of each but the first.

        Args:
            labels: material of every cell of the measured grid (cell,).
        """
        distances = [lines.grid.through((labels == k).astype(float)) for k in range(1, len(materials))]
        return cls(lines, materials, np.array(distances).reshape(len(materials) - 1, len(lines.grid.mesh.nodes)))

    @property
    def count(self) -> int:
        """How many materials there are."""
        return len(self.materials)

    @property
    def places(self) -> float:
        """Logarithm of the number of places where regions might be that lines bound."""
        return int(regions_of(self.lines.grid.mesh, self.labels()).max()) * self._place

    @property
    def _place(self) -> float:
        return float(np.log(len(self.lines.grid.mesh.cells)))

    def cells(self) -> tuple[CellMaterials, Cuts]:
        """(what every cell of the finite elements is of, the lines that cut each pair of its layers)."""
        distances = [self.lines.between @ distance for distance in self.distances]
        return self._cells(self.lines.fine, distances, self._log_factor("fine"))

    def grid_cells(self) -> CellMaterials:
        """What every cell of the measured grid is of."""
        return self._cells(self.lines.grid, self.distances, self.grid_factor())[0]

    def grid_factor(self) -> Float[np.ndarray, " cell"]:
        """Logarithm of the factor of every cell of the measured grid."""
        return self._log_factor("grid")

    def _log_factor(self, mesh: str) -> Float[np.ndarray, " cell"]:
        if self.lines.splines is None:
            return np.zeros(len(getattr(self.lines, mesh).mesh.cells))
        return getattr(self.lines.splines, mesh) @ self.gradual

    def _cells(self, contours: ContourLines, distances, log_factor):
        base, low, up = laid(contours, distances)
        cut = np.flatnonzero(up.line >= 0)
        once, twice = cut[low.line[cut] < 0], cut[low.line[cut] >= 0]
        pieces, cuts = layers_of(base, low, up, once, twice)
        factor, added = np.exp(log_factor), turned(log_factor, self.turn)
        return CellMaterials(materials=self.materials, one=base, factor=factor, added=added, **vars(pieces)), cuts

    def by_cell(self) -> Float[np.ndarray, "parameter cell"]:
        """Parameters of the material at the centre of every cell of the measured grid, its factor in the level."""
        factor = self.grid_factor()
        cells = self.materials[self.labels()] + turned(factor, self.turn)
        return np.concatenate([cells[:, :1] + factor[:, None], cells[:, 1:]], axis=1).T

    def labels(self) -> Int[np.ndarray, " cell"]:
        """The material that most of every cell of the grid is of."""
        base, low, up = laid(self.lines.grid, self.distances)
        area, rows = np.zeros((len(base), self.count)), np.arange(len(base))
        above, between = (np.where(cut.line < 0, 0.0, cut.share) for cut in (up, low))
        shares = (1.0 - above) * (1.0 - between), (1.0 - above) * between, above
        for material, share in zip((base, low.line + 1, up.line + 1), shares, strict=True):
            np.add.at(area, (rows, material), share)
        return area.argmax(axis=1)

    def moves(self, reach: float) -> list[scipy.sparse.csr_matrix]:
        """How distances follow when points of each line move along its normal (node, point of the line).

        A line whose shape is known moves along x and along y (node, 2).

        Args:
            reach: distance in sides of cells within which they follow.
        """
        if self.lines.as_one:
            return [self.lines.grid.as_one(distance) for distance in self.distances]
        return [self.lines.grid.along(distance, reach, self.lines.apart) for distance in self.distances]

    @property
    def still(self) -> list[scipy.sparse.csr_matrix]:
        """Moves of lines that stay."""
        return [scipy.sparse.csr_matrix((len(distance), 0)) for distance in self.distances]

    def loads_of_materials(self, response: CellResponse, of: CellMaterials) -> scipy.sparse.csr_matrix:
        """Derivative of the nodal forces by the materials, row by row, of cells that are of these."""
        mesh, count = self.lines.fine.mesh, response.by_one.shape[2]
        rows, columns, values = [], [], []
        for each, material, dofs in (
            (response.by_one, of.one, mesh.dofs),
            (response.by_first, of.first, mesh.dofs[of.cell]),
            (response.by_second, of.second, mesh.dofs[of.cell]),
        ):
            rows.append(np.repeat(dofs[:, :, None], count, axis=2).ravel())
            columns.append(np.broadcast_to(material[:, None, None] * count + np.arange(count), each.shape).ravel())
            values.append(each.ravel())
        entries = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
        return scipy.sparse.csr_matrix(entries, (mesh.nodes.size, self.count * count))

    def loads(self, sheet: Sheet, u: Float[np.ndarray, "node 2"], moves) -> scipy.sparse.csr_matrix:
        """Derivative of the nodal forces by the materials, row by row, by moves of the lines, splines and turns."""
        of, cuts = self.cells()
        response = sheet.cell_response(u, of, by_factor=self.lines.splines is not None)
        mesh, found = self.lines.fine.mesh, [self.loads_of_materials(response, of)]
        for k, move in enumerate(moves):
            own = np.flatnonzero((cuts.low == k) | (cuts.up == k))
            slopes, turns = self.lines.fine.slopes(self.lines.between @ self.distances[k], of.cell[own])
            by_weight = np.where(cuts.low == k, cuts.weight_by_low, cuts.weight_by_up)[own]
            between = (cuts.line[own] == k)[:, None]
            by_share = response.by_weight[own] * by_weight[:, None] + between * response.by_share[own]
            each = by_share[:, :, None] * slopes[:, None] + between[:, None] * (response.by_normal[own] @ turns)
            rows = np.broadcast_to(mesh.dofs[of.cell[own]][:, :, None], each.shape).ravel()
            columns = np.broadcast_to(mesh.cells[of.cell[own]][:, None], each.shape).ravel()
            by_fine = scipy.sparse.csr_matrix((each.ravel(), (rows, columns)), (mesh.nodes.size, len(mesh.nodes)))
            found.append(by_fine @ (self.lines.between @ move))
        if self.lines.splines is not None:
            found += loads_of_change(response, mesh, self.lines.splines, self.gradual, self.turn)
        return scipy.sparse.hstack(found, format="csr")

    def at(self, y: Float[np.ndarray, " number"], moves) -> "Interfaces":
        """The same with other materials and moved lines, by numbers in the order of :meth:`loads`."""
        sizes = self.materials.size, *(move.shape[1] for move in moves), len(self.gradual)
        materials, *each, gradual, turn = np.split(y, np.cumsum(sizes))
        moved = [row + move @ by for row, move, by in zip(self.distances, moves, each, strict=True)]
        materials, distances = materials.reshape(self.materials.shape), np.reshape(moved, self.distances.shape)
        return dataclasses.replace(self, materials=materials, distances=distances, gradual=gradual, turn=turn)

    def numbers(self, moves) -> Float[np.ndarray, " number"]:
        """The numbers that :meth:`at` takes, of lines where they are."""
        still = (np.zeros(move.shape[1]) for move in moves)
        return np.concatenate([self.materials.ravel(), *still, self.gradual, self.turn])

    def measured_anew(self, fewest: int) -> "Interfaces":
        """The same lines, from which distances are measured anew; regions of fewer nodes are none.

        Materials that are nowhere by then, or that a later one hides everywhere, are left out.
        """
        distances = [self.lines.grid.distance(row, fewest) for row in self.distances]
        hiding = [k for k, row in enumerate(distances) if row.min() > 0.0]
        first = hiding[-1] + 1 if hiding else 0
        kept = [k for k in range(first, len(distances)) if distances[k].max() > 0.0]
        materials = self.materials[[first, *(k + 1 for k in kept)]]
        distances = np.array([distances[k] for k in kept]).reshape(len(kept), self.distances.shape[1])
        return dataclasses.replace(self, materials=materials, distances=distances)

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

    def changing(self, factor: Float[np.ndarray, " cell"], bend: float) -> "Interfaces":
        """The same, on top of which a factor changes gradually, about as this one.

        Args:
            factor: its logarithm in every cell of the measured grid.
            bend: of :class:`Splines`.
        """
        splines = Splines.of(self.lines.grid.mesh, self.lines.fine.mesh, bend)
        lines = dataclasses.replace(self.lines, splines=splines)
        return dataclasses.replace(self, lines=lines, gradual=splines.fitted(factor))

    def with_law(self, materials: Float[np.ndarray, "material parameter"]) -> "Interfaces":
        """The same lines between other materials. Parameters that these have more come last, and do not turn."""
        more = materials.shape[1] - self.materials.shape[1]
        turn = np.append(self.turn, np.zeros(more)) if len(self.turn) and more >= 0 else np.zeros(0)
        return dataclasses.replace(self, materials=materials, turn=turn)

    def options(self) -> Options:
        """Every cell may be of every other material."""
        return options_of(self.lines.grid.mesh, *np.nonzero(self.labels()[:, None] != np.arange(self.count)))

    def dearer(self, options: Options) -> Float[np.ndarray, " option"]:
        """What each option costs beside the length of contours: its place, where it touches no cell of that label."""
        return begin_regions(self.lines.grid.mesh, self.labels(), options) * self._place

    @property
    def sides(self) -> scipy.sparse.csr_matrix:
        """What sides between materials cost (cell, cell)."""
        return sides_of(self.lines.grid.mesh)

    def with_labels(self, labels: Int[np.ndarray, " cell"]) -> "Interfaces":
        """The field with pieces of materials in the cells whose label is another one."""
        before, distances = self.labels(), self.distances.copy()
        for cell in np.flatnonzero(labels != before):
            piece = numerics.PIECE_REACH - self.lines.from_centre(cell)
            for k in range(max(labels[cell], 1), self.count):
                # What is laid later would hide the piece.
                own = k == labels[cell]
                distances[k - 1] = np.maximum(distances[k - 1], piece) if own else np.minimum(distances[k - 1], -piece)
        return dataclasses.replace(self, distances=distances).measured_anew(1)
