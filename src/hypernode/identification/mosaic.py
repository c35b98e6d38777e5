"""A sheet whose cells are each of one of a few materials: a mosaic, as finite elements or a printer's voxels make it.

No line cuts a cell. Which material a cell is of changes by whole cells. What a change does to the test is linearised
where every cell that may change is a mixture of what it may be. So one model holds on both sides.
"""

import dataclasses

import numpy as np
import scipy.sparse
from jaxtyping import Float, Int

from hypernode.fem.contour import ContourLines
from hypernode.identification import budgets, numerics, priors
from hypernode.identification.coats import Cut, Cuts, layers_of
from hypernode.identification.contours import (
    ContourModel,
    Options,
    at_contours,
    options_at_contours,
    relabelled,
    sides_of,
)
from hypernode.identification.interface_numbers import held_of_materials
from hypernode.identification.interfaces import Interfaces, Lines
from hypernode.identification.promising import promising
from hypernode.identification.seen_test import SeenTest
from hypernode.identification.sheet import CellMaterials, CellResponse


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
        return priors.CONTOUR_SIDE * apart + (self.count - 1) * float(np.log(len(mesh.cells)))

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
        labels = np.where(self.of_cells == other, one, self.of_cells)
        return dataclasses.replace(
            self, materials=np.delete(self.materials, other, axis=0), of_cells=labels - (labels > other)
        )

    def relabelled(self, test: SeenTest, states) -> "list[Mosaic]":
        """The same with labels that should explain a test better: all changes, then those that promise most.

        Args:
            states: equilibrium of every step of the test.
        """
        options = options_at_contours(self.lines.grid.mesh, self.of_cells)
        if not len(options.cell) or (model := self._model(test, states, options)) is None:
            return []
        labels = relabelled(self.of_cells, model)
        changed = np.flatnonzero(labels != self.of_cells)
        order = changed[np.argsort(self._promised(model, labels, changed), kind="stable")]
        sets = [order[: int(np.ceil(share * len(order)))] for share in numerics.SHARES_OF_CHANGES if len(order)]
        sets += [order[k : k + 1] for k in range(min(len(order), budgets.TRIED_ALONE))]
        found = []
        for some in dict.fromkeys(tuple(each.tolist()) for each in sets):
            changed = self.of_cells.copy()
            changed[list(some)] = labels[list(some)]
            if len(np.unique(changed)) == self.count:
                found.append(dataclasses.replace(self, of_cells=changed))
        return found

    def _promised(self, model: ContourModel, labels, changed) -> Float[np.ndarray, " changed"]:
        """What each change alone, of all that are promised, changes of the cost, the others made."""
        options = model.options
        taken = labels[options.cell] == options.label
        slope = model.gradient + model.curvature @ taken - 0.5 * np.diag(model.curvature)
        of_cell = dict(zip(options.cell[taken].tolist(), slope[taken].tolist(), strict=True))
        return np.array([of_cell[cell] for cell in changed.tolist()])

    def _model(self, test: SeenTest, states, options: Options) -> ContourModel | None:
        """The misfit by options, as a quadratic form whose materials follow."""
        some, half_way = np.ones(len(options.cell), bool), self._half_way(options)
        held = np.diag(held_of_materials(self))
        if len(some) > budgets.ALL_ASKED:
            loads = self._loads_at(test, states, half_way, options)
            some = promising(test, states, loads, self._dearer(options), held)
        if not some.any():
            return None
        tolerance, between = numerics.NEWTON_TOLERANCE, []
        for (u, _, _), boundary in zip(states, test.boundaries, strict=True):
            between.append(test.sheet.equilibrium(u, boundary.free, half_way, tolerance))
        if any(each is None for each in between):
            return None
        columns = np.append(some, np.ones(self.materials.size, bool))
        loads = [each[:, columns] for each in self._loads_at(test, between, half_way, options)]
        options, sigma, sides = options.those(some), test.sigma_of(states), sides_of(self.lines.grid.mesh)
        jacobians = test.jacobians(between, loads, sigma)
        curvature, gradient = test.shared(states, sigma).normal(jacobians, test.residuals(states, sigma))
        lengths = sides if self.given is None else 0.0 * sides
        return ContourModel.followed(options, curvature, gradient, held, self._dearer(options), lengths, self.count)

    def _dearer(self, options: Options) -> Float[np.ndarray, " option"]:
        """What each option costs beside the length of contours: to be another label than was given, or none."""
        if self.given is None:
            return np.zeros(len(options.cell))
        given = self.given[options.cell]
        away, now = options.label != given, self.of_cells[options.cell] != given
        return self._change * (away.astype(float) - now)

    def _half_way(self, options: Options) -> CellMaterials:
        """Cells that may change as mixtures of all that they may be, in equal parts; the options come first."""
        changing = np.unique(options.cell)
        cell = np.concatenate([options.cell, changing])
        material = np.concatenate([options.label, self.of_cells[changing]])
        weight = 1.0 / np.bincount(cell, minlength=len(self.of_cells))[cell]
        normal = np.tile([1.0, 0.0], (len(cell), 1))
        half = np.full(len(cell), 0.5)
        return CellMaterials(
            materials=self.materials,
            one=self.of_cells,
            cell=cell,
            first=material,
            second=material,
            share=half,
            normal=normal,
            weight=weight,
            factor=np.ones(len(self.of_cells)),
        )

    def _loads_at(self, test: SeenTest, states, half_way: CellMaterials, options: Options):
        """:meth:`_loads` by step, at given states, with changes half-way."""
        return [self._loads(test.sheet.cell_response(u, half_way), half_way, options) for u, _, _ in states]

    def _loads(self, response: CellResponse, of: CellMaterials, options: Options) -> scipy.sparse.csr_matrix:
        """Derivative of the nodal forces by the options, then by the materials, row by row."""
        mesh, number = self.lines.fine.mesh, len(options.cell)
        now = np.searchsorted(np.unique(options.cell), options.cell) + number
        change = response.by_weight[:number] - response.by_weight[now]
        rows, columns = mesh.dofs[options.cell], np.repeat(np.arange(number), 8)
        by_options = scipy.sparse.csr_matrix((change.ravel(), (rows.ravel(), columns)), (mesh.nodes.size, number))
        return scipy.sparse.hstack([by_options, self.loads_of_materials(response, of)], format="csr")
