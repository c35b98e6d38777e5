"""A field of a few materials, and how these answer to data while the contours between them stay."""

import dataclasses
from collections.abc import Callable

import numpy as np
import scipy.sparse
import scipy.sparse.csgraph
from jaxtyping import Bool, Float, Int
from skimage.filters import threshold_otsu

from hypernode.fem.mesh import Mesh


@dataclasses.dataclass(frozen=True)
class Phases:
    """A field of a few materials.

    Attributes:
        labels: number of every cell's phase (cell,).
        materials: parameters of every phase (phase, parameter).
    """

    labels: Int[np.ndarray, " cell"]
    materials: Float[np.ndarray, "phase parameter"]

    @property
    def params(self) -> Float[np.ndarray, "cell parameter"]:
        """Parameters of every cell."""
        return self.materials[self.labels]

    @property
    def columns(self) -> scipy.sparse.csc_matrix:
        """Derivative of the flattened field by the flattened materials (cell x parameter, phase x parameter)."""
        cells, count = len(self.labels), self.materials.shape[1]
        of_phase = (np.ones(cells), (np.arange(cells), self.labels))
        member = scipy.sparse.csr_matrix(of_phase, (cells, len(self.materials)))
        return scipy.sparse.kron(member, scipy.sparse.identity(count), format="csc")

    def regions(self, mesh: Mesh) -> int:
        """How many regions of touching cells of one phase there are."""
        pairs = mesh.touching()
        alike = pairs[self.labels[pairs[:, 0]] == self.labels[pairs[:, 1]]]
        joined = scipy.sparse.csr_matrix((np.ones(len(alike)), alike.T), 2 * (len(self.labels),))
        return int(scipy.sparse.csgraph.connected_components(joined, directed=False, return_labels=False))


def at_contours(mesh: Mesh, labels: Int[np.ndarray, " cell"]) -> Bool[np.ndarray, " cell"]:
    """Cells that touch another phase, at a side or a corner."""
    pairs = mesh.touching()
    found = np.zeros(len(labels), dtype=bool)
    found[pairs[labels[pairs[:, 0]] != labels[pairs[:, 1]]]] = True
    return found


def split(level: Float[np.ndarray, " cell"], labels: Int[np.ndarray, " cell"]) -> Int[np.ndarray, " cell"]:
    """Labels with one phase more: the cells above Otsu's threshold in the phase whose stiffness varies most in all."""
    spread = [((level[labels == k] - level[labels == k].mean()) ** 2).sum() for k in range(labels.max() + 1)]
    cells = np.flatnonzero(labels == int(np.argmax(spread)))
    finer = labels.copy()
    if np.ptp(level[cells]) > 0.0:
        high = level[cells] > threshold_otsu(level[cells])
        half_way = 0.5 * (np.median(level[cells[high]]) + np.median(level[cells[~high]]))
        finer[cells[level[cells] > half_way]] = labels.max() + 1
    return finer


def medians(mesh: Mesh, params, labels: Int[np.ndarray, " cell"], lowest) -> Float[np.ndarray, "phase parameter"]:
    """Median parameters of every phase, off its contours as far as it has such cells.

    What has a ``lowest`` value, near zero, is not below zero, where it would hardly have a slope.
    """
    inside = ~at_contours(mesh, labels)
    members = [labels == k for k in range(labels.max() + 1)]
    each = [np.median(params[m & inside if (m & inside).any() else m], axis=0) for m in members]
    return np.where(np.isfinite(lowest), np.maximum(each, 0.0), each)


class ReducedEquations:
    """C^T (J^T J) C y + held y = C^T b for the numbers y that decide a field by columns C.

    Attributes:
        columns: C.
        by_cells: J^T J C (cell x parameter, number).
        matrix: C^T J^T J C + held.

    Args:
        curvature: x -> J^T J x.
        columns: derivative of the flattened field by the numbers, sparse.
        held: inverse covariance of the numbers without data, sparse.
    """

    def __init__(self, curvature: Callable, columns, held):
        self.columns = columns
        self.by_cells = curvature(columns.toarray())
        self.matrix = columns.T @ self.by_cells + held.toarray()

    def solve_columns(self, b, rtol: float, iterations: int):
        """How the field answers to the columns of ``b`` (cell x parameter, k); neither bound is needed, it is exact."""
        return self.columns @ np.linalg.solve(self.matrix, self.columns.T @ b)


class MaterialEquations(ReducedEquations):
    """Those of the materials of phases, whose contours do not follow.

    Args:
        curvature: x -> J^T J x.
        phases: whose materials follow.
        ridge: by parameter of the cells.
        lowest: parameters of materials that are not above it stay where they are; all follow without it.
    """

    def __init__(self, curvature: Callable, phases: Phases, ridge: Float[np.ndarray, " parameter"], lowest=-np.inf):
        columns = phases.columns[:, np.flatnonzero(phases.materials > lowest)]
        super().__init__(curvature, columns, columns.T @ scipy.sparse.diags(ridge) @ columns)
