"""Positions of the deformed sheet that are taken for those of the sheet at rest, or the other way round."""

from collections.abc import Callable

import numpy as np

from hypernode.dic.points import Points

#: Share of the points that must lie on the grid once the displacement is taken out.
_NEARLY_ALL = 0.95
_MOVED = ", but without its displacement it is: positions move with the sheet; say so, {moving}"
_TAKEN_OUT = (
    ", but with its displacement it is: positions are those of the sheet at rest already; say deformed: false in table"
)


def why_off(points: Points, on_grid: Callable[[np.ndarray], np.ndarray]) -> str:
    """What explains that points of a frame lie off the grid, for a message; empty where nothing does.

    Args:
        points: of the frame.
        on_grid: which of positions (point, 2) lie on it.
    """
    position, u = points.position[:, :2], points.displacement[:, :2]
    known = np.isfinite(u).all(axis=1)
    for there, told in ((position - u, _MOVED), (position + u, _TAKEN_OUT)):
        if known.any() and on_grid(there[known]).mean() >= _NEARLY_ALL:
            return told.replace("{moving}", points.moving)
    return ""
