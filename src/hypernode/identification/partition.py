"""A field of stiffness, cut into a few parts: where a search for materials and lines begins."""

import numpy as np
import scipy.sparse
import scipy.sparse.csgraph
from jaxtyping import Float, Int

from hypernode.fem.mesh import Mesh
from hypernode.identification.interfaces import Interfaces

#: Values that stand for all when levels are sought: their quantiles.
QUANTILES = 600
#: Parts of fewer touching cells are none: a line around less cannot be told from noise.
FEWEST_CELLS = 3


def levels(values: Float[np.ndarray, " cell"], count: int) -> Float[np.ndarray, " level"]:
    """The levels from which values are least far in the mean: medians in one dimension, found exactly.

    They are found by dynamic programming over sorted values (Wang and Song, Ckmeans.1d.dp, The R Journal 3, 2011).
    Distances stand in the place of their squares, which a blurred interface between far levels would rule.
    """
    v = np.sort(values)
    v = v[np.linspace(0, len(v) - 1, min(len(v), QUANTILES)).round().astype(int)]
    number, total = len(v), np.concatenate([[0.0], np.cumsum(v)])
    first, last = np.meshgrid(np.arange(number), np.arange(number), indexing="ij")
    middle = (first + last) // 2
    below = v[middle] * (middle - first + 1) - (total[middle + 1] - total[first])
    above = total[last + 1] - total[middle + 1] - v[middle] * (last - middle)
    cost = np.where(first <= last, below + above, np.inf)
    best, splits = cost[0], []
    for _ in range(count - 1):
        every = best[:-1, None] + cost[1:]
        splits.append(every.argmin(axis=0))
        best = every.min(axis=0)
    starts, end = [], number - 1
    for split in reversed(splits):
        end = int(split[end])
        starts.insert(0, end + 1)
    starts.insert(0, 0)
    lasts = [*(start - 1 for start in starts[1:]), number - 1]
    return np.array([v[(a + b) // 2] for a, b in zip(starts, lasts, strict=True)])


def without_small(mesh: Mesh, labels: Int[np.ndarray, " cell"], fewest: int = FEWEST_CELLS) -> Int[np.ndarray, " cell"]:
    """Labels in which every part of fewer touching cells has the label that most cells around it have."""
    pairs, labels = mesh.touching(), labels.copy()
    alike = pairs[labels[pairs[:, 0]] == labels[pairs[:, 1]]]
    joined = scipy.sparse.csr_matrix((np.ones(len(alike)), alike.T), 2 * (len(labels),))
    _, part = scipy.sparse.csgraph.connected_components(joined, directed=False)
    small = np.flatnonzero(np.bincount(part) < fewest)
    both = np.concatenate([pairs, pairs[:, ::-1]])
    for number in small:
        around = both[(part[both[:, 0]] == number) & (part[both[:, 1]] != number), 1]
        if len(around):
            labels[part == number] = np.bincount(labels[around]).argmax()
    return labels


def parts(
    stiffness: Float[np.ndarray, " cell"], count: int, known: Interfaces, of_materials: Float[np.ndarray, " material"]
) -> tuple[Int[np.ndarray, " cell"], Float[np.ndarray, "material parameter"]]:
    """(number of the part of every cell, its material) of parts of about equal stiffness, the largest first.

    Each is of the material that most of it was, made as stiff as it is.

    Args:
        stiffness: logarithm of the stiffness, by cell of the grid.
        count: how many levels; what is left of them where small parts are none may be fewer.
        known: the materials before, and their lines.
        of_materials: logarithm of the stiffness of each of these.
    """
    level, before = levels(stiffness, count), known.labels()
    labels = without_small(known.lines.grid.mesh, np.abs(stiffness[:, None] - level).argmin(axis=1))
    size = np.bincount(labels, minlength=count)
    order = [k for k in np.argsort(-size, kind="stable") if size[k]]
    was = [int(np.bincount(before[labels == k]).argmax()) for k in order]
    materials = known.materials[was].copy()
    materials[:, 0] += level[order] - of_materials[was]
    return np.argsort(order)[np.unique(labels, return_inverse=True)[1]], materials


def cut_into(
    stiffness: Float[np.ndarray, " cell"], count: int, known: Interfaces, of_materials: Float[np.ndarray, " material"]
) -> Interfaces:
    """:func:`parts` with lines around them."""
    labels, materials = parts(stiffness, count, known, of_materials)
    return Interfaces.around(known.lines, materials, labels)
