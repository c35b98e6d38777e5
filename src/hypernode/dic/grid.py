"""Measured points onto one grid: placed where they lie on one, interpolated where they nearly do."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.spatial import Delaunay, QhullError, cKDTree

from hypernode.dic.errors import DicError
from hypernode.dic.moving_positions import why_off
from hypernode.dic.points import Points

#: Distance from a line of the grid, in steps, within which a point lies on it.
ON_LINE = 0.02
#: Share of a grid's extent below which two coordinates are the same.
ROUNDING = 1e-9
#: Fewest lines of a grid along an axis.
FEWEST_LINES = 4
#: Most places of a grid for each of its points.
MOST_PLACES = 4
#: Distance in steps within which a point of a later frame is one of the reference.
_SAME_POINT = 0.1
#: Share of a frame's points that the reference may not know.
_UNKNOWN_SHARE = 0.05
#: Longest side, in steps, of a triangle of neighbours: a diagonal and half a step for irregularity.
_LONGEST_SIDE = 2.0
#: Share of a triangle by which a grid point may lie outside: rounding of the outermost points.
_OUTSIDE = 0.02
#: Largest number of grid points over that of measured ones: a narrow strip across the diagonal needs as many as its
#: length is of its width.
_EMPTIEST = 100


@dataclass(frozen=True)
class ExactGrid:
    """A grid on which every point lies.

    Attributes:
        x, y: its lines, as the files give them.
    """

    x: Float[np.ndarray, " column"]
    y: Float[np.ndarray, " row"]

    @property
    def step(self) -> Float[np.ndarray, " 2"]:
        """Of the grid along x and y."""
        return np.array([np.median(np.diff(lines)) for lines in (self.x, self.y)])

    @property
    def regular(self) -> bool:
        """Whether lines are enough, and whole steps apart."""
        return min(len(self.x), len(self.y)) >= FEWEST_LINES and _regular(self.x) and _regular(self.y)

    def values(self, points: Points, reference: int) -> Float[np.ndarray, "row column 2"]:
        """Displacements of a frame on the grid, NaN where none was measured.

        Raises:
            DicError: a point lies off the grid, or is there twice.
        """
        x, y = self.x, self.y
        position = points.position
        column, on_column = _line(x, position[:, 0])
        row, on_row = _line(y, position[:, 1])
        known = on_column & on_row
        if not known.all():
            bad = int(np.flatnonzero(~known)[0])
            raise DicError(
                f"{points.path}:{points.line[bad]}: the point {_shown(points, bad)} is not on the grid of frame "
                f"{reference}{why_off(points, self._on)}"
            )
        place = row * len(x) + column
        if np.bincount(place, minlength=1).max() > 1:
            _refuse_twice(points, place)
        grid = np.full((len(y) * len(x), 2), np.nan)
        grid[place] = points.displacement[:, :2]
        return grid.reshape(len(y), len(x), 2)

    def _on(self, position: np.ndarray) -> np.ndarray:
        return _line(self.x, position[:, 0])[1] & _line(self.y, position[:, 1])[1]


@dataclass(frozen=True, kw_only=True)
class NearGrid:
    """A grid near the points of the reference, on which displacements are interpolated linearly between three of them.

    Attributes:
        x, y: its lines.
        nearby: the reference's points, in steps.
        step: of the grid along x and y.
        corners: for each grid point the three points around it; those of a point with none around it are the first.
        weights: of these, NaN where there are none.
        moved: median and largest distance from a grid point to the nearest measured one, in steps.
    """

    x: Float[np.ndarray, " column"]
    y: Float[np.ndarray, " row"]
    nearby: cKDTree
    step: Float[np.ndarray, " 2"]
    corners: np.ndarray
    weights: np.ndarray
    moved: tuple[float, float]

    def values(self, points: Points, reference: int) -> Float[np.ndarray, "row column 2"]:
        """Displacements of a frame on the grid, NaN where a point around is lost.

        Raises:
            DicError: points are there twice, or too many of them are not among those of the reference.
        """
        index, known = self._matched(points.position[:, :2] / self.step)
        if np.mean(~known) > _UNKNOWN_SHARE:
            bad = int(np.argmin(known))
            raise DicError(
                f"{points.path}:{points.line[bad]}: the point {_shown(points, bad)} is not among those of frame "
                f"{reference}, as {np.mean(~known):.0%} are not: are positions those of the deformed sheet?"
            )
        _refuse_twice(points, np.where(known, index, -1 - np.arange(len(index))))
        measured = np.full((self.nearby.n, 2), np.nan)
        measured[index[known]] = points.displacement[known, :2]
        around = measured[self.corners]
        # A corner without weight may be lost.
        around[self.weights == 0.0] = 0.0
        return np.einsum("gk,gka->ga", self.weights, around).reshape(len(self.y), len(self.x), 2)

    def _matched(self, position: np.ndarray):
        """(index of the reference's point nearest to each position in steps, whether it is the same point)."""
        same_order = position.shape == self.nearby.data.shape
        if same_order and (np.abs(position - self.nearby.data) < _SAME_POINT / 2).all():
            return np.arange(len(position)), np.ones(len(position), dtype=bool)
        distance, index = self.nearby.query(position)
        return index, distance < _SAME_POINT


def _shown(points: Points, index: int) -> str:
    return "[" + " ".join(f"{value:g}" for value in points.position[index]) + "]"


def _refuse_twice(points: Points, place: np.ndarray) -> None:
    unique, counts = np.unique(place, return_counts=True)
    if (counts > 1).any():
        again = np.flatnonzero(place == unique[np.argmax(counts)])[1]
        # One is a slip; many are a sheet that shrank to a point.
        units = ": are positions in another unit?" if 2 * len(unique) < len(place) else ": delete the row"
        raise DicError(f"{points.path}:{points.line[again]}: the point {_shown(points, again)} is there twice{units}")


def grid_of(points: Points) -> ExactGrid | NearGrid:
    """The grid of the reference's points.

    Raises:
        DicError: the points span no grid.
    """
    for axis, name in enumerate("xy"):
        distinct = len(_lines(points.position[:, axis]))
        if distinct < FEWEST_LINES:
            raise DicError(f"{points.path}: only {distinct} distinct {name} positions: no grid")
    return exact_grid_of(points) or _near_grid(points)


def exact_grid_of(points: Points) -> ExactGrid | None:
    """The grid along the axes on which the reference's points lie, ``None`` where they lie on none."""
    grid = ExactGrid(*(_lines(points.position[:, axis]) for axis in (0, 1)))
    if grid.regular and len(grid.x) * len(grid.y) <= MOST_PLACES * len(points.position):
        return grid
    return None


def _line(lines: np.ndarray, values: np.ndarray):
    """(index of the nearest line of each value, whether the value lies on it)."""
    index = np.searchsorted((lines[1:] + lines[:-1]) / 2.0, values)
    return index, np.abs(lines[index] - values) <= ON_LINE * np.median(np.diff(lines))


def _lines(values: np.ndarray) -> np.ndarray:
    """Distinct values, those that differ by rounding alone taken as one."""
    lines = np.unique(values)
    return lines[np.append(True, np.diff(lines) > ROUNDING * (lines[-1] - lines[0]))]


def _regular(lines: np.ndarray) -> bool:
    steps = np.diff(lines) / np.median(np.diff(lines))
    return bool(np.all(np.abs(steps - np.round(steps)) <= ON_LINE) and np.all(steps > 0.5))


def _near_grid(points: Points) -> NearGrid:
    position = points.position[:, :2]
    _refuse_twice(points, np.unique(position, axis=0, return_inverse=True)[1])
    step = _steps(points)
    if np.prod(np.ptp(position, axis=0) / step + 1.0) > _EMPTIEST * len(position):
        raise DicError(f"{points.path}: the points are scattered too widely for a grid")
    axes = [_axis(position[:, k], step[k]) for k in (0, 1)]
    step = np.array([axis[1] - axis[0] for axis in axes])
    grid = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2) / step
    # In steps, so that triangles and distances mean the same along both axes.
    triangles = _triangles(points, position / step)
    at = triangles.find_simplex(grid, tol=_OUTSIDE)
    sides = triangles.points[triangles.simplices]
    longest = np.linalg.norm(sides - np.roll(sides, 1, axis=1), axis=-1).max(axis=1)
    nearby = cKDTree(position / step)
    distance = nearby.query(grid)[0]
    inside = (at >= 0) & (longest[at] <= _LONGEST_SIDE) & (distance <= 1.0)
    if not inside.any():
        raise DicError(f"{points.path}: the points are scattered too widely for a grid")
    to_first = triangles.transform[at]
    two = np.einsum("gij,gj->gi", to_first[:, :2], grid - to_first[:, 2])
    weights = np.column_stack([two, 1.0 - two.sum(axis=1)])
    weights[~inside] = np.nan
    corners = np.where(inside[:, None], triangles.simplices[at], 0)
    # A grid point on a measured one needs no other, which may be lost.
    weights[np.abs(weights) < 1e-6] = 0.0
    kept = distance[inside]
    moved = (float(np.median(kept)), float(kept.max()))
    return NearGrid(x=axes[0], y=axes[1], nearby=nearby, step=step, corners=corners, weights=weights, moved=moved)


def _triangles(points: Points, position: np.ndarray) -> Delaunay:
    try:
        return Delaunay(position)
    except QhullError:
        raise DicError(f"{points.path}: the points lie on a line: no grid") from None


def _steps(points: Points) -> np.ndarray:
    """Steps along x and y: the median length of those sides between neighbours that run nearly along each."""
    triangles = _triangles(points, points.position[:, :2])
    pairs = np.concatenate([triangles.simplices[:, [a, b]] for a, b in ((0, 1), (1, 2), (2, 0))])
    sides = np.abs(np.diff(triangles.points[pairs], axis=1)[:, 0])
    # Sides along the hull may be long; those of the inside are counted twice and outnumber them.
    steps = []
    for along, across in ((0, 1), (1, 0)):
        chosen = sides[:, across] < 0.4 * sides[:, along]
        if not chosen.any():
            raise DicError(f"{points.path}: the points span no grid along {'xy'[along]}")
        steps.append(np.median(sides[chosen, along]))
    return np.array(steps)


def _axis(values: np.ndarray, step: float) -> np.ndarray:
    """Equidistant lines through the values, of a step near the given one."""
    # The phase of the lines, which a median of values between two of them would miss.
    phase = np.angle(np.exp(2j * np.pi * values / step).mean()) / (2.0 * np.pi) * step
    middle = phase + step * np.round((np.median(values) - phase) / step)
    index = np.round((values - middle) / step)
    if index.min() < index.max():
        # The straight line of least squares through values over index.
        offset = index - index.mean()
        step = float((offset * values).sum() / (offset * offset).sum())
        middle = values.mean() - step * index.mean()
    first, last = (int(np.round((end - middle) / step)) for end in (values.min(), values.max()))
    return middle + step * np.arange(first, last + 1)
