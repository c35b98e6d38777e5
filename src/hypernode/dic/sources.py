"""The frames of a folder one by one, whichever way its files hold them, y upward."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from hypernode.dic.array_files import arrays_in
from hypernode.dic.arrays import frame_of_arrays, frames_of_arrays
from hypernode.dic.assembled import frames_of_matrices, frames_of_ncorr, frames_of_stacked, frames_of_subsets
from hypernode.dic.dialect import Dialect
from hypernode.dic.folder import Found
from hypernode.dic.labels import said_of_labels
from hypernode.dic.points import Points, read_points
from hypernode.progress import say


def frames_in(found: Found, dialect: Dialect) -> tuple[list[int], Callable[[int], Points]]:
    """(numbers of the frames, function that reads one, y upward)."""
    files = list(found.files.values())
    if dialect.content == "subset":
        frames = frames_of_subsets(files, dialect)
    elif dialect.content == "stacked":
        frames = frames_of_stacked(files[0], dialect)
    elif dialect.content == "matrices":
        frames = frames_of_matrices(files, dialect)
    elif dialect.content == "arrays" and len(files) > 1:
        return list(found.files), lambda number: _upward(frame_of_arrays(found.files[number], dialect), dialect)
    elif dialect.content == "arrays":
        arrays = arrays_in(files[0])
        frames = frames_of_arrays(files[0], dialect, arrays)
        points = len(next(iter(frames.values())).position)
        if told := said_of_labels(files[0], arrays, dialect.arrays, points):
            say("import", str(files[0].parent), told)
    elif dialect.content == "ncorr":
        frames = frames_of_ncorr(files[0], dialect)
    else:
        return list(found.files), lambda number: _upward(read_points(found.files[number], dialect), dialect)
    return list(frames), lambda number: _upward(frames[number], dialect)


def backwards(available: list[int], read: Callable[[int], Points]) -> tuple[list[int], Callable[[int], Points]]:
    """The same frames in the opposite order, numbered from the same first to the same last number."""
    ends = available[0] + available[-1]
    return [ends - number for number in reversed(available)], lambda number: read(ends - number)


def _upward(points: Points, dialect: Dialect) -> Points:
    """Points with y and its displacement upward."""
    v_up = dialect.y_up if dialect.v_up is None else dialect.v_up
    position, u = points.position.copy(), points.displacement.copy()
    position[:, 1] *= 1.0 if dialect.y_up else -1.0
    u[:, 1] *= 1.0 if v_up else -1.0
    return replace(points, position=position, displacement=u)


def without_lost_zeros(points: Points, dialect: Dialect) -> Points:
    """The points, without displacements of exactly zero where zero marks a lost point."""
    if not dialect.zero_is_lost:
        return points
    u = points.displacement.copy()
    u[(u == 0.0).all(axis=1)] = np.nan
    return replace(points, displacement=u)
