"""Which phase every cell belongs to: the best labels of a quadratic model of the misfit.

A cell that changes its phase changes the residuals by a column of the Jacobian, and a contour costs its length. To
first order the changes of many cells add, with the materials of the phases adjusted. The misfit is then a quadratic
form of binary variables. Single cells and pairs of neighbours change as long as the cost falls.
"""

from dataclasses import dataclass

import numpy as np
import scipy.sparse
import scipy.sparse.csgraph
from jaxtyping import Bool, Float, Int

from hypernode.fem.mesh import Mesh
from hypernode.identification import priors, thresholds


@dataclass(frozen=True)
class Options:
    """Changes of labels that may be made.

    Attributes:
        cell, label: which cell would have which label, another than it has (option,).
        pairs: numbers of every two options of neighbouring cells (pair, 2).
    """

    cell: Int[np.ndarray, " option"]
    label: Int[np.ndarray, " option"]
    pairs: Int[np.ndarray, "pair 2"]

    def those(self, some: Bool[np.ndarray, " option"]) -> "Options":
        """Some of them."""
        number = np.cumsum(some) - 1
        return Options(self.cell[some], self.label[some], number[self.pairs[some[self.pairs].all(axis=1)]])


def options_at_contours(mesh: Mesh, labels: Int[np.ndarray, " cell"]) -> Options:
    """Every cell that touches another phase, at a side or a corner, may have the label of that phase."""
    touching = mesh.touching()
    both = np.concatenate([touching, touching[:, ::-1]])
    differ = both[labels[both[:, 0]] != labels[both[:, 1]]]
    return options_of(mesh, *np.unique(np.stack([differ[:, 0], labels[differ[:, 1]]], axis=1), axis=0).T)


def options_of(mesh: Mesh, cell: Int[np.ndarray, " option"], label: Int[np.ndarray, " option"]) -> Options:
    """These changes, and which of them are of neighbouring cells."""
    member = (np.ones(len(cell)), (np.arange(len(cell)), cell))
    member = scipy.sparse.csr_matrix(member, (len(cell), len(mesh.cells)))
    near = scipy.sparse.triu(member @ touching_of(mesh) @ member.T, 1).tocoo()
    return Options(cell, label, np.stack([near.row, near.col], axis=1))


def begin_regions(mesh: Mesh, labels: Int[np.ndarray, " cell"], options: Options) -> Bool[np.ndarray, " option"]:
    """Which options would be regions of their own: their cells touch none of that label."""
    count = 1 + max(labels.max(), options.label.max(initial=0))
    near = touching_of(mesh)[options.cell] @ np.eye(count)[labels]
    return near[np.arange(len(options.cell)), options.label] == 0.0


def at_contours(mesh: Mesh, labels: Int[np.ndarray, " cell"]) -> Bool[np.ndarray, " cell"]:
    """Cells that touch another phase, at a side or a corner."""
    pairs = mesh.touching()
    found = np.zeros(len(labels), dtype=bool)
    found[pairs[labels[pairs[:, 0]] != labels[pairs[:, 1]]]] = True
    return found


@dataclass(frozen=True, kw_only=True)
class ContourModel:
    """What changes of labels cost.

    Attributes:
        options: the changes.
        gradient, curvature: of the misfit by the options, as if they were real numbers from 0 to 1.
        lengths: what sides between cells cost (cell, cell).
    """

    options: Options
    gradient: Float[np.ndarray, " option"]
    curvature: Float[np.ndarray, "option option"]
    lengths: scipy.sparse.csr_matrix

    @classmethod
    def followed(cls, options: Options, curvature, gradient, held, dear, lengths) -> "ContourModel":
        """The model where the numbers behind the options follow.

        Args:
            curvature, gradient: of the misfit by the options, then by these numbers.
            held: inverse covariance of the numbers without data (number, number).
            dear: what each option costs beside what it explains.
        """
        count = len(options.cell)
        across = curvature[:count, count:]
        follow = np.linalg.solve(curvature[count:, count:] + held, np.c_[across.T, gradient[count:]])
        return cls(
            options=options,
            gradient=gradient[:count] - across @ follow[:, -1] + dear,
            curvature=curvature[:count, :count] - across @ follow[:, :-1],
            lengths=lengths,
        )


def touching_of(mesh: Mesh) -> scipy.sparse.csr_matrix:
    """1 for cells that touch at a side or a corner (cell, cell)."""
    return _of_pairs(mesh, mesh.touching(), 1.0)


def regions_of(mesh: Mesh, labels: Int[np.ndarray, " cell"]) -> Int[np.ndarray, " cell"]:
    """Number of the region of every cell: of touching cells of one label."""
    pairs = mesh.touching()
    alike = pairs[labels[pairs[:, 0]] == labels[pairs[:, 1]]]
    return scipy.sparse.csgraph.connected_components(_of_pairs(mesh, alike, 1.0), directed=False)[1]


def sides_of(mesh: Mesh) -> scipy.sparse.csr_matrix:
    """What sides between cells cost (cell, cell)."""
    return _of_pairs(mesh, mesh.neighbours()[0], priors.CONTOUR_SIDE)


def _of_pairs(mesh: Mesh, pairs: Int[np.ndarray, "pair 2"], value: float) -> scipy.sparse.csr_matrix:
    """A value for both cells of every pair (cell, cell)."""
    both = np.concatenate([pairs, pairs[:, ::-1]])
    return scipy.sparse.csr_matrix((np.full(len(both), value), both.T), (len(mesh.cells),) * 2)


def relabelled(labels: Int[np.ndarray, " cell"], model: ContourModel) -> Int[np.ndarray, " cell"]:
    """The labels after every change of one option, or of two of neighbouring cells, that lowers the cost.

    Args:
        model: what changes of these labels cost.
    """
    options, curvature = model.options, model.curvature
    between = 1.0 - np.eye(1 + max(labels.max(), options.label.max(initial=0)))
    labels, first = labels.copy(), labels
    taken = np.zeros(len(options.cell), dtype=bool)
    gradient, own, (one, other) = model.gradient.copy(), 0.5 * np.diag(curvature), options.pairs.T
    rows = model.lengths[options.cell]
    shared = np.asarray(rows[one, options.cell[other]]).ravel() if len(one) else np.zeros(0)
    each = np.arange(len(taken))
    while len(taken):
        sign = np.where(taken, -1.0, 1.0)
        to = np.where(taken, first[options.cell], options.label)
        now = labels[options.cell]
        around = rows @ between[labels]
        change = sign * gradient + own + around[each, to] - around[each, now]
        # A cell has one label: what would take another option of it waits until it has its first label again.
        change[_blocked(options, taken)] = np.inf
        together = change[one] + change[other] + sign[one] * sign[other] * curvature[one, other]
        together += shared * (
            between[to[one], to[other]]
            - between[to[one], now[other]]
            - between[now[one], to[other]]
            + between[now[one], now[other]]
        )
        best = [int(change.argmin())]
        if len(together) and together.min() < change[best[0]]:
            best = list(options.pairs[together.argmin()])
        lowered = min(change.min(), together.min(initial=np.inf))
        if not lowered < -thresholds.CHANGED_CELLS_GAIN:
            # Errors of far cells may hide one another.
            far = change[:, None] + change + np.outer(sign, sign) * curvature
            far[options.cell[:, None] == options.cell] = np.inf
            far[one, other] = far[other, one] = np.inf
            best = list(np.unravel_index(far.argmin(), far.shape))
            lowered = float(far[tuple(best)])
        if not lowered < -thresholds.CHANGED_CELLS_GAIN:
            break
        for k in best:
            gradient += sign[k] * curvature[:, k]
            labels[options.cell[k]] = to[k]
            taken[k] = not taken[k]
    return labels


def _blocked(options: Options, taken: Bool[np.ndarray, " option"]) -> Bool[np.ndarray, " option"]:
    """Options of a cell that has taken another one."""
    changed = np.zeros(options.cell.max() + 1, dtype=bool)
    changed[options.cell[taken]] = True
    return changed[options.cell] & ~taken
