"""Correlated points of pictures as the frames of a test."""

from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float

from hypernode.dic.errors import DicError
from hypernode.dic.grid import FEWEST_LINES, grid_of
from hypernode.dic.points import Points
from hypernode.dic.series import Frame, Series


def whole_subsets(
    position: Float[np.ndarray, "point 2"], size: Float[np.ndarray, " 2"], subset: float
) -> Bool[np.ndarray, " point"]:
    """Which points have their whole subset on a sheet: beyond its edge, the background is correlated as well.

    Args:
        position: from the lower left corner of the sheet.
        size: its sides.
        subset: side of a subset, in the same unit.
    """
    return ((position >= 0.5 * subset) & (position <= size - 0.5 * subset)).all(axis=1)


def series_of(
    source: Path, position: Float[np.ndarray, "point 2"], displacement: Float[np.ndarray, "frame point 2"]
) -> tuple[Series, Float[np.ndarray, " 2"]]:
    """(frames of the points on their grid in mm, the position of its lower left corner).

    Args:
        source: the file that holds the points, for messages.
        position: of the points in the reference, y upward [mm].
        displacement: since the reference, which is the first frame, NaN where a point was lost [mm].

    Raises:
        DicError: the points are on no grid, or too few.
    """
    if len(position) < FEWEST_LINES**2:
        raise DicError(
            f"{source}: only {len(position)} points have their whole subset on the sheet: choose a smaller subset or "
            "step, or more pixels"
        )
    frames = [
        Points(path=source, position=position, displacement=each, line=np.arange(1, len(position) + 1), unit="mm")
        for each in displacement
    ]
    grid = grid_of(frames[0])
    values = [Frame(number, grid.values(points, 0)) for number, points in enumerate(frames)]
    return Series(grid.x - grid.x[0], grid.y - grid.y[0], values, unit="mm"), np.array([grid.x[0], grid.y[0]])
