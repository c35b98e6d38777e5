"""Shares of phases in cells whose phase a coarser grid leaves open."""

import dataclasses

import numpy as np
import scipy.sparse
from jaxtyping import Bool, Float, Int

from hypernode.fem.transfer import transfer
from hypernode.identification.estimate import Estimate
from hypernode.identification.few_materials import Phases, at_contours, medians, split
from hypernode.identification.problem import FieldProblem


@dataclasses.dataclass(frozen=True)
class Shares:
    """A field of a few materials, of which some cells have shares.

    Attributes:
        phases: the materials, and what every cell is as far as no share says otherwise.
        cell, label: which cell may be of which other phase (option,).
        share: how much of the cell is (option,), from none to all.
    """

    phases: Phases
    cell: Int[np.ndarray, " option"]
    label: Int[np.ndarray, " option"]
    share: Float[np.ndarray, " option"]

    @property
    def members(self) -> scipy.sparse.csr_matrix:
        """Share of every phase in every cell (cell, phase)."""
        labels, cells = self.phases.labels, len(self.phases.labels)
        rows = np.concatenate([np.arange(cells), self.cell, self.cell])
        columns = np.concatenate([labels, self.label, labels[self.cell]])
        entries = np.concatenate([np.ones(cells), self.share, -self.share])
        return scipy.sparse.csr_matrix((entries, (rows, columns)), (cells, len(self.phases.materials)))

    @property
    def params(self) -> Float[np.ndarray, "cell parameter"]:
        """Parameters of every cell."""
        return self.members @ self.phases.materials

    @property
    def by_materials(self) -> scipy.sparse.csc_matrix:
        """Derivative of the flattened field by the flattened materials (cell x parameter, phase x parameter)."""
        return scipy.sparse.kron(self.members, scipy.sparse.identity(self.phases.materials.shape[1]), format="csc")

    @property
    def by_shares(self) -> scipy.sparse.csc_matrix:
        """Derivative of the flattened field by the shares (cell x parameter, option)."""
        change = self.phases.materials[self.label] - self.phases.materials[self.phases.labels[self.cell]]
        options, count = change.shape
        rows = (self.cell[:, None] * count + np.arange(count)).ravel()
        columns = np.repeat(np.arange(options), count)
        return scipy.sparse.csc_matrix((change.ravel(), (rows, columns)), (len(self.phases.labels) * count, options))

    @property
    def most(self) -> Phases:
        """The phases that cells have most of."""
        labels = np.asarray(self.members.todense()).argmax(axis=1)
        return dataclasses.replace(self.phases, labels=labels)

    def free(self, gradient: Float[np.ndarray, " option"]) -> Bool[np.ndarray, " option"]:
        """Shares that may follow a gradient downhill: not those that are none and would be less, or all and more."""
        return ~(((self.share <= 0.0) & (gradient > 0.0)) | ((self.share >= 1.0) & (gradient < 0.0)))

    def changed(self, materials: Float[np.ndarray, "phase parameter"], share: Float[np.ndarray, " option"]) -> "Shares":
        """The same with other materials and with shares as near as there can be: none below zero, no sum above one."""
        share = np.maximum(share, 0.0)
        total = np.bincount(self.cell, share, len(self.phases.labels))
        phases = dataclasses.replace(self.phases, materials=materials)
        return dataclasses.replace(self, phases=phases, share=share / np.maximum(total, 1.0)[self.cell])


def few_phases(found: Estimate, gradual: float) -> Int[np.ndarray, " cell"] | None:
    """Labels of the fewest phases within which stiffness hardly varies; None where more than a few would be needed.

    Args:
        found: a field without noise.
        gradual: standard deviation of the logarithm of the stiffness within a phase, off its contours, that is no jump.
    """
    mesh, (level, _) = found.problem.mesh, found.problem.stiffness(found.params)
    labels = np.zeros(len(level), dtype=int)
    for _ in range(found.problem.strategy.most_phases):
        if _off_median(level, labels)[~at_contours(mesh, labels)].std() < gradual:
            return labels
        finer = split(level, labels)
        if finer.max() == labels.max():
            return None
        labels = finer
    return None


def _off_median(level: Float[np.ndarray, " cell"], labels: Int[np.ndarray, " cell"]) -> Float[np.ndarray, " cell"]:
    """Difference between every cell's value and the median of its phase."""
    return level - np.array([np.median(level[labels == k]) for k in range(labels.max() + 1)])[labels]


def left_open(problem: FieldProblem, params, coarse: Estimate, gradual: float) -> Shares | None:
    """Shares in the cells of a finer grid that lie in coarse ones which touch another phase, or are like no phase.

    They begin with what makes cells as stiff as the coarse grid has them. None where that is of no few phases, or all
    of it is of one.

    Args:
        problem: the finer grid.
        params: its field as the coarse grid has it (cell, parameter).
        coarse: the field of the coarse grid.
        gradual: as of :func:`few_phases`.
    """
    labels = few_phases(coarse, gradual)
    if labels is None or labels.max() == 0:
        return None
    mesh, (level, _) = coarse.problem.mesh, coarse.problem.stiffness(coarse.params)
    one, other = mesh.touching().T
    near = np.zeros((len(labels), labels.max() + 1), dtype=bool)
    near[one, labels[other]] = near[other, labels[one]] = True
    near[np.arange(len(labels)), labels] = False
    near[~at_contours(mesh, labels) & (np.abs(_off_median(level, labels)) < gradual)] = False
    onto = transfer(mesh, problem.mesh).cells
    cell, label = np.nonzero(near[onto])
    fine = labels[onto]
    materials = medians(problem.mesh, params, fine, problem.basis.lowest)
    typical, _ = problem.stiffness(materials)
    own = typical[fine[cell]]
    share = (problem.stiffness(params)[0][cell] - own) / (typical[label] - own)
    return Shares(Phases(fine, materials), cell, label, np.zeros(len(cell))).changed(materials, share)
