"""A field of stiffness, cut into a few parts: where a search for materials and lines begins."""

import numpy as np
from jaxtyping import Float, Int

from hypernode.fem.mesh import Mesh
from hypernode.identification import budgets, thresholds
from hypernode.identification.contours import regions_of
from hypernode.identification.interfaces import Interfaces


def centres(values: Float[np.ndarray, "cell number"], count: int) -> Float[np.ndarray, "centre number"]:
    """The centres from which the numbers of cells are least far in the mean: of one number its :func:`levels`.

    Of several, medians of what is nearest to each, again and again, from the levels along each principal axis.
    """
    if values.shape[1] == 1:
        return levels(values[:, 0], count)[:, None]
    best, least = None, np.inf
    for axis in np.linalg.svd(values - values.mean(axis=0), full_matrices=False)[2]:
        along = values @ axis
        nearest = np.abs(along[:, None] - levels(along, count)).argmin(axis=1)
        for _ in range(budgets.MEDIANS):
            found = np.array([np.median(values[nearest == k], axis=0) for k in np.unique(nearest)])
            distance = np.linalg.norm(values[:, None] - found, axis=2)
            before, nearest = nearest, distance.argmin(axis=1)
            if (nearest == before).all():
                break
        if distance.min(axis=1).sum() < least:
            best, least = found, distance.min(axis=1).sum()
    return best


def levels(values: Float[np.ndarray, " cell"], count: int) -> Float[np.ndarray, " level"]:
    """The levels from which values are least far in the mean: medians in one dimension, found exactly.

    They are found by dynamic programming over sorted values (Wang and Song, Ckmeans.1d.dp, The R Journal 3, 2011).
    Distances stand in the place of their squares, which a blurred interface between far levels would rule.
    """
    v = np.sort(values)
    v = v[np.linspace(0, len(v) - 1, min(len(v), budgets.QUANTILES)).round().astype(int)]
    number, total = len(v), np.concatenate([[0.0], np.cumsum(v)])
    first, last = np.meshgrid(np.arange(number), np.arange(number), indexing="ij")
    middle = (first + last) // 2
    below = v[middle] * (middle - first + 1) - (total[middle + 1] - total[first])
    above = total[last + 1] - total[middle + 1] - v[middle] * (last - middle)
    cost = below + above
    cost = np.where(first <= last, cost, np.inf)
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
    ranges = zip(starts, lasts, strict=True)
    return np.array([v[(a + b) // 2] for a, b in ranges])


def without_small(mesh: Mesh, labels: Int[np.ndarray, " cell"]) -> Int[np.ndarray, " cell"]:
    """Labels in which every part of few touching cells has the label that most cells around it have."""
    pairs, labels = mesh.touching(), labels.copy()
    part = regions_of(mesh, labels)
    small = np.flatnonzero(np.bincount(part) < thresholds.FEWEST_CELLS)
    both = np.concatenate([pairs, pairs[:, ::-1]])
    for number in small:
        around = both[(part[both[:, 0]] == number) & (part[both[:, 1]] != number), 1]
        if len(around):
            labels[part == number] = np.bincount(labels[around]).argmax()
    return labels


def parts(
    numbers: Float[np.ndarray, "cell number"],
    count: int,
    known: Interfaces,
    columns: list[int],
    of_materials: Float[np.ndarray, "material number"],
) -> tuple[Int[np.ndarray, " cell"], Float[np.ndarray, "material parameter"]]:
    """(number of the part of every cell, its material) of parts of about equal numbers, the largest first.

    Each is of the material that most of it was, with other numbers.

    Args:
        numbers: of every cell of the grid, such as the logarithm of its stiffness.
        count: how many parts; what is left of them where small ones are none may be fewer.
        known: the materials before, and their lines.
        columns: parameters that numbers add to.
        of_materials: numbers of each of these.
    """
    centre, before = centres(numbers, count), known.labels()
    nearest = np.linalg.norm(numbers[:, None] - centre, axis=2).argmin(axis=1)
    labels = without_small(known.lines.grid.mesh, nearest)
    size = np.bincount(labels, minlength=len(centre))
    order = [k for k in np.argsort(-size, kind="stable") if size[k]]
    was = [int(np.bincount(before[labels == k]).argmax()) for k in order]
    materials = known.materials[was].copy()
    materials[:, columns] += centre[order] - of_materials[was]
    return np.argsort(order)[np.unique(labels, return_inverse=True)[1]], materials
