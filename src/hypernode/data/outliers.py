"""Points that a camera mistook: displacements that no sheet has between its neighbours."""

import numpy as np
import scipy.ndimage
from jaxtyping import Bool, Float

from hypernode.fem.mesh import Mesh

#: Opposite neighbours between which a point lies, as steps along the rows and columns of the grid.
_PAIRS = ((0, 1), (1, 0), (1, 1), (1, -1))
#: Standard deviations of the noise beyond which a deviation is no chance: one in two million.
_CHANCE = 5.0
#: Of a deviation from the median of means of two neighbours, in units of the noise of one point: sqrt(1 + 1/3) where
#: all four are known.
_SCATTER = np.sqrt(4.0 / 3.0)
#: What the second largest of eight deviations by noise seldom exceeds, in standard deviations of one.
_SECOND_LARGEST = 2.0
#: How much more than its neighbours a point may deviate where the sheet itself bends, at a corner of an interface.
_SHARPEST = 4.0

#: Fewest steps that tell what of a deviation belongs to the sheet.
_FEWEST_STEPS = 3
#: Largest deviation at a kink, over the step of the grid times the mean strain: half of a strain that jumps by as much.
_KINK = 0.5
#: How unevenly what belongs to the sheet may grow with the motion: materials stiffen, and notches open.
_UNEVEN = 0.25


def outliers(
    mesh: Mesh, u: Float[np.ndarray, "step node 2"], noise: Float[np.ndarray, "step 2"]
) -> Bool[np.ndarray, "step node"]:
    """Which points stand alone: off what their neighbours say by more than noise and the sheet's own kinks explain.

    What neighbours say is the median of the interpolations between opposite ones. The deviation from it is compared
    with the noise, and with the second largest deviation among the neighbours. Along an interface two of them deviate
    as the point itself does; next to an outlier one does. At the outline the largest counts, since one of the two is
    missing there. The test follows Westerweel and Scarano (Universal outlier detection for PIV data, 2005), who take
    medians of both.

    Args:
        mesh: the grid, without points where there is no material.
        u: displacement, NaN where a point was lost.
        noise: standard deviation of each step and component; where it is zero nothing is told.
    """
    x, y = mesh.lines
    found = np.zeros(u.shape[:2], bool)
    for i in np.flatnonzero((noise > 0.0).any(axis=0)):
        grid = np.full((len(u), len(y) * len(x)), np.nan)
        grid[:, mesh.places] = u[..., i]
        grid = grid.reshape(len(u), len(y), len(x))
        signed = np.stack([_deviation(x, y, each) for each in grid])
        own = _of_the_sheet(signed, grid)
        rest = np.maximum(np.abs(signed - own) - _UNEVEN * np.abs(own), 0.0)
        for step in np.flatnonzero(noise[:, i] > 0.0):
            level, deviation = noise[step], np.abs(signed[step])
            scatter = _SCATTER * level[i]
            bent = np.maximum(_second_largest_around(deviation) - _SECOND_LARGEST * scatter, 0.0)
            alone = np.minimum(deviation - _SHARPEST * bent, rest[step]) > _CHANCE * scatter
            found[step] |= alone.ravel()[mesh.places]
    return found


def _of_the_sheet(
    deviation: Float[np.ndarray, "step row column"], grid: Float[np.ndarray, "step row column"]
) -> Float[np.ndarray, "step row column"]:
    """What of the deviations grows with the motion in all steps, as at an interface that runs between two points.

    No more than a kink of the mean strain of the sheet gives, but beside points that no step shows: strain has no bound
    at the tip of a notch, and where a neighbour is missing, it is compared with those along the rim alone. Zero where
    fewer than three steps tell it.
    """
    if len(deviation) < _FEWEST_STEPS:
        return np.zeros_like(deviation)
    moved = (np.nanmax(grid, axis=(1, 2)) - np.nanmin(grid, axis=(1, 2)))[:, None, None]
    beside = scipy.ndimage.binary_dilation(np.isnan(grid).all(axis=0), np.ones((3, 3)))
    largest = np.where(beside, moved, _KINK * moved / max(grid.shape[1:]))
    share = np.median(deviation / np.where(moved > 0.0, moved, 1.0), axis=0)
    return np.clip(share * moved, -largest, largest)


def _deviation(x, y, grid: Float[np.ndarray, "row column"]) -> Float[np.ndarray, "row column"]:
    """How far each point is off the median of the interpolations between its opposite neighbours.

    Zero where there are none: such a point is not judged.
    """
    padded = np.pad(grid, 1, constant_values=np.nan)
    share_x, share_y = (_share(line) for line in (x, y))
    said = []
    for row, column in _PAIRS:
        before, after = _shifted(padded, -row, -column), _shifted(padded, row, column)
        share = share_x[None, :] if column else share_y[:, None]
        if column < 0:
            share = 1.0 - share
        said.append(before + share * (after - before))
    said = np.stack(said)
    judged = np.isfinite(said).any(axis=0) & np.isfinite(grid)
    median = np.nanmedian(np.where(judged, said, 0.0), axis=0)
    return np.where(judged, grid - median, 0.0)


def _share(line):
    """How far each point lies on the way from the one before to the one after; one half at the ends, which lack one."""
    share = np.full(len(line), 0.5)
    share[1:-1] = (line[1:-1] - line[:-2]) / (line[2:] - line[:-2])
    return share


def _shifted(padded, row: int, column: int):
    """The neighbours so many rows and columns away, of a field with a margin of one."""
    rows, columns = (size - 2 for size in padded.shape)
    return padded[1 + row : 1 + row + rows, 1 + column : 1 + column + columns]


def _second_largest_around(values: Float[np.ndarray, "row column"]) -> Float[np.ndarray, "row column"]:
    """Second largest value of the eight neighbours of each point; the largest where one is beyond the outline."""
    padded = np.pad(values, 1, constant_values=np.inf)
    around = [_shifted(padded, r, c) for r in (-1, 0, 1) for c in (-1, 0, 1) if (r, c) != (0, 0)]
    around = np.sort(np.stack(around), axis=0)
    missing = np.isinf(around).sum(axis=0)
    rank = np.where(missing == 0, 2, missing + 1)
    return np.take_along_axis(around, (len(around) - rank)[None], axis=0)[0]
