"""Number of distinguishable phases of a sheet, and whether there is an inclusion at all."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float, Int

from hypernode.evaluation.judgement import Judgement
from hypernode.evaluation.shape import find_inclusion, inner_side, two_levels
from hypernode.fem.mesh import Mesh

#: Standard deviations by which a split must explain more than the same split of what the test cannot tell.
BEYOND = 3.0
#: Interquartile range of a Gaussian in standard deviations.
QUARTILES_APART = 1.349
#: What a split must explain in any case: finite elements on a measured grid err by as much without any noise.
FLOOR = 0.01
#: Phases beyond which no more are looked for.
MOST = 5
#: Share of the sheet of the inclusion whose detectable contrast is said.
TYPICAL_SHARE = 0.2
#: Cells of the smallest phase.
LEAST_CELLS = 4

#: What a summary says of the inclusion.
SEEN, NONE, NOT_JUDGED = "distinguishable", "none distinguishable", "not judged"


@dataclass(frozen=True)
class Phases:
    """The phases of a sheet.

    Attributes:
        labels: number of each cell's phase, from the softest.
        shape: the inclusion, the side of the first split with fewer cells at the border; empty without an inclusion.
        seen: relative standard deviation of the stiffness between the two sides of the first split.
        needed: its limit; an inclusion exceeds it.
    """

    labels: Int[np.ndarray, " cell"]
    shape: Bool[np.ndarray, " cell"]
    seen: float
    needed: float

    @property
    def count(self) -> int:
        """Number of phases."""
        return int(self.labels.max()) + 1


def without_single_cells(mesh: Mesh, values: Float[np.ndarray, " cell"]) -> Float[np.ndarray, " cell"]:
    """Values in which a cell above or below all its edge neighbours takes the nearest value of theirs; lines and
    corners stay."""
    pairs, _, _ = mesh.neighbours()
    low, high = np.full(len(values), np.inf), np.full(len(values), -np.inf)
    for one, other in (pairs.T, pairs.T[::-1]):
        np.minimum.at(low, one, values[other])
        np.maximum.at(high, one, values[other])
    alone = low > high
    return np.clip(values, np.where(alone, values, low), np.where(alone, values, high))


def explained(
    values: Float[np.ndarray, " cell"], share: Float[np.ndarray, " cell"], high: Bool[np.ndarray, " cell"]
) -> float:
    """Standard deviation between the two parts of a split, in the unit of the values.

    It is sqrt(w1 w2 / (w1 + w2)) |m1 - m2|, with the area shares w and the medians m of the two parts. This is the root
    of Otsu's variance between classes (1979), with medians instead of means to limit the influence of single cells.

    Args:
        values: of the cells that are split.
        share: of each of them in the area of the whole sheet.
        high: which part each belongs to.
    """
    w1, w2 = share[high].sum(), share[~high].sum()
    if w1 == 0.0 or w2 == 0.0:
        return 0.0
    return float(np.sqrt(w1 * w2 / (w1 + w2)) * abs(np.median(values[high]) - np.median(values[~high])))


def needed_of(explained_by_chance: Float[np.ndarray, " sample"]) -> float:
    """Limit for a split: the value for splits of posterior samples plus :data:`BEYOND` standard deviations, or a floor.

    Median and interquartile range replace mean and standard deviation, since one outlier among few samples would make
    every inclusion indistinguishable. A ninth sample of the same kind exceeds the limit from eight samples in 1 to 4 %
    of the cases.
    """
    if not len(explained_by_chance):
        return FLOOR
    # Without bias in the median: quantiles of few samples lie closer together than those they are drawn of.
    lower, middle, upper = np.quantile(explained_by_chance, (0.25, 0.5, 0.75), method="median_unbiased")
    return max(FLOOR, float(middle + BEYOND * (upper - lower) / QUARTILES_APART))


@dataclass(frozen=True)
class _Part:
    """Cells that belong together so far, and their best split."""

    cells: Int[np.ndarray, " part"]
    high: Bool[np.ndarray, " part"]
    seen: float
    needed: float

    @classmethod
    def of(cls, cells, values, samples, share) -> "_Part":
        """Split some cells of a field, and the same cells of every sample."""
        high = two_levels(values[cells])
        chance = [explained(each[cells], share[cells], two_levels(each[cells])) for each in samples]
        return cls(cells, high, explained(values[cells], share[cells], high), needed_of(np.array(chance)))

    @property
    def excess(self) -> float:
        """Ratio to the limit; above one the two sides are distinguishable."""
        return self.seen / self.needed


def find_phases(
    mesh: Mesh, field: Float[np.ndarray, " cell"], deviations: Float[np.ndarray, "sample cell"] | None = None
) -> Phases:
    """Split the sheet in two, repeatedly, as long as a split explains more of the field than of its uncertainty.

    The part with the most distinct split is split next, up to :data:`MOST` phases. A split within a part is weighted by
    its area in the whole sheet, and compared with samples that are split within the same part. A seam between two
    phases, where cells are cut or a field is smooth, is a phase only if it is wider than one cell. A gradually varying
    stiffness has no phases, but may be divided into several.

    Args:
        field: indicator of the stiffness.
        deviations: of posterior samples from the best field, over the median of that field; None without noise.

    Raises:
        ValueError: as :func:`~hypernode.evaluation.shape.find_inclusion`.
    """
    scale = max(abs(float(np.median(field))), 1e-300)
    values = without_single_cells(mesh, field / scale)
    samples = [without_single_cells(mesh, 1.0 + each) for each in _finite(deviations, len(field))]
    share = mesh.areas / mesh.areas.sum()
    whole = _Part.of(np.arange(len(field)), values, samples, share)
    parts = [whole]
    while len(parts) < MOST and (widest := max(parts, key=lambda part: part.excess)).excess > 1.0:
        rest = [part for part in parts if part is not widest]
        sides = [_Part.of(widest.cells[side], values, samples, share) for side in (widest.high, ~widest.high)]
        finer = _labels([*rest, *sides], values)
        if any(_is_seam(mesh, finer, finer[side.cells[0]]) for side in sides):
            parts = [*rest, replace(widest, seen=0.0)]
        else:
            parts = [*rest, *sides]
    labels = _labels(parts, values)
    shape = inner_side(mesh, whole.high) if len(parts) > 1 else np.zeros(len(field), bool)
    return Phases(labels, shape, whole.seen, whole.needed)


def _labels(parts: list[_Part], values) -> Int[np.ndarray, " cell"]:
    """Number of the part of each cell, from the softest."""
    labels = np.empty(len(values), int)
    for label, part in enumerate(sorted(parts, key=lambda part: np.median(values[part.cells]))):
        labels[part.cells] = label
    return labels


def _is_seam(mesh: Mesh, labels, label: int) -> bool:
    """Whether most cells of a phase touch both a softer and a stiffer one, at a side or a corner."""
    softer, stiffer = np.zeros((2, len(labels)), dtype=bool)
    pairs = mesh.touching()
    for one, other in (pairs.T, pairs.T[::-1]):
        softer[one[labels[other] < labels[one]]] = True
        stiffer[one[labels[other] > labels[one]]] = True
    return bool((softer & stiffer)[labels == label].mean() > 0.5)


def _finite(deviations, cells: int) -> Float[np.ndarray, "sample cell"]:
    """Samples whose cells without a stress deviate like the median of their sample; none where all are."""
    if deviations is None:
        return np.empty((0, cells))
    deviations = np.where(np.isfinite(deviations), deviations, np.nan)
    deviations = deviations[~np.isnan(deviations).all(axis=1)]
    return np.where(np.isnan(deviations), np.nanmedian(deviations, axis=1, keepdims=True), deviations)


def score_phases(
    mesh: Mesh, field: Float[np.ndarray, " cell"], deviations: Float[np.ndarray, "sample cell"] | None, noisy: bool
) -> Judgement:
    """The inclusion and the phases of a sheet, and the smallest contrast that would be visible.

    Args:
        field, deviations: as of :func:`find_phases`.
        noisy: whether the displacements are noisy. If they are and there are no samples, the uncertainty is unknown and
            the sheet is split in any case.

    Raises:
        ValueError: as :func:`~hypernode.evaluation.shape.find_inclusion`.
    """
    if noisy and deviations is None:
        return Judgement({"shape": find_inclusion(mesh, field).astype(np.int64)}, {"inclusion": NOT_JUDGED})
    phases = find_phases(mesh, field, deviations)
    summary = {
        "inclusion": SEEN if phases.count > 1 else NONE,
        "contrast_seen": phases.seen,
        "contrast_needed": phases.needed,
        "detectable_contrast": phases.needed / float(np.sqrt(TYPICAL_SHARE * (1.0 - TYPICAL_SHARE))),
        "phases_found": phases.count,
    }
    smallest = smallest_phase(phases.needed, len(field))
    summary |= {} if smallest is None else {"smallest_phase": smallest}
    return Judgement({"shape": phases.shape.astype(np.int64), "phase_found": phases.labels}, summary)


def smallest_phase(needed: float, cells: int) -> float | None:
    """Share of the sheet from which a phase twice as stiff as the rest is distinguishable; None if none is.

    Such a phase of share w explains sqrt(w (1 - w)). A phase that is one cell wide counts as a seam, so that four
    cells are the least.
    """
    if needed >= 0.5:
        return None
    return max(0.5 * (1.0 - float(np.sqrt(1.0 - 4.0 * needed**2))), LEAST_CELLS / cells)


def phase_numbers(evaluation: Mapping) -> Int[np.ndarray, " cell"]:
    """Number of the phase of every cell, from the softest. Without phases: the two sides of the shape."""
    return np.asarray(evaluation["phase_found" if "phase_found" in evaluation else "shape"]).astype(int)
