"""A regular grid that stands at an angle to the axes of its files, seen in its own."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import cKDTree

from hypernode.dic.grid import FEWEST_LINES, MOST_PLACES, ON_LINE, ROUNDING, ExactGrid, exact_grid_of
from hypernode.dic.points import Points
from hypernode.dic.turning import turned

#: Longest side between neighbours over the distance of nearest ones: halfway to the diagonal of a square.
_NEIGHBOURS = 1.2
#: How much nearer to lines turning must bring the points: irregular ones gain a few per cent, by chance.
_NEARER = 10.0
#: Steps of the least squares for the angle; each leaves the cube of its error.
_REFINEMENTS = 3


@dataclass(frozen=True)
class Tilt:
    """The axes of a tilted grid.

    Attributes:
        angle: from x of the files to x of the grid, counter-clockwise with y upward, in (-pi/4, pi/4] [rad].
        grid: the grid in its own axes.
    """

    angle: float
    grid: ExactGrid

    @property
    def degrees(self) -> float:
        """The angle in degrees."""
        return float(np.degrees(self.angle))

    def seen(self, points: Points) -> Points:
        """Points with the components in the plane along the axes of the grid."""
        return replace(
            points,
            position=turned(points.position, -self.angle),
            displacement=turned(points.displacement, -self.angle),
        )


def tilt_of(points: Points) -> Tilt | None:
    """The tilt of the grid on which the reference's points lie, ``None`` where they lie on no grid that is tilted.

    Sides between neighbours tell the angle modulo 90 degrees, by the mean direction of four times their angles (Mardia
    and Jupp, Directional Statistics, 2000). Least squares of the lines through all points refine it.
    Where the points fill a rectangle along the axes of the files better than one along the grid's, the sheet stands
    along the former, and the grid is not turned.
    """
    position = np.unique(points.position[:, :2], axis=0)
    if len(position) < FEWEST_LINES**2:
        return None
    step, angle = _neighbours(position)
    # Crossings of a grid lie on lines along other axes as well at 45 degrees alone.
    if abs(angle) < np.pi / 8 and exact_grid_of(points) is not None:
        return None
    angle = _refined(position, angle, step)
    along = turned(position, -angle)
    index = [_line(along[:, axis], 0.5 * step) for axis in (0, 1)]
    grid = ExactGrid(*(_means(along[:, axis], index[axis]) for axis in (0, 1)))
    if not grid.regular or len(grid.x) * len(grid.y) > MOST_PLACES * len(position):
        return None
    off, before = (
        np.array([np.abs(_off_lines(place[:, axis], index[axis])).max() for axis in (0, 1)])
        for place in (along, position)
    )
    if (off > ON_LINE * grid.step).any() or off.max() * _NEARER > before.max():
        return None
    # By a step along each side, that of the files must be the smaller one.
    if np.prod(np.ptp(along, axis=0)) > np.prod(np.ptp(position, axis=0) + step):
        return None
    return Tilt(float(angle), grid)


def _neighbours(position: Float[np.ndarray, "point 2"]) -> tuple[float, float]:
    """(distance of nearest points, angle of the sides between neighbours modulo 90 degrees)."""
    tree = cKDTree(position)
    step = float(np.median(tree.query(position, k=2)[0][:, 1]))
    one, other = tree.query_pairs(_NEIGHBOURS * step, output_type="ndarray").T
    side = position[other] - position[one]
    return step, float(np.angle(np.exp(4j * np.arctan2(side[:, 1], side[:, 0])).mean()) / 4.0)


def _line(values: Float[np.ndarray, " point"], gap: float) -> Int[np.ndarray, " point"]:
    """Number of the line of each value: lines are further than ``gap`` apart."""
    order = np.argsort(values)
    line = np.empty(len(values), dtype=int)
    line[order] = np.append(0, np.cumsum(np.diff(values[order]) > gap))
    return line


def _means(values: np.ndarray, line: np.ndarray) -> np.ndarray:
    return np.bincount(line, values) / np.bincount(line)


def _off_lines(values: np.ndarray, line: np.ndarray) -> np.ndarray:
    return values - _means(values, line)[line]


def _refined(position: Float[np.ndarray, "point 2"], angle: float, step: float) -> float:
    """The angle at which the points are nearest to their lines in the sense of least squares, in (-pi/4, pi/4]."""
    along = turned(position, -angle)
    column, row = (_line(along[:, axis], 0.5 * step) for axis in (0, 1))
    for _ in range(_REFINEMENTS):
        x, y = turned(position, -angle).T
        # Turned further by a small angle d, points are x + d y off lines along y and y - d x off lines along x.
        off_x, along_y = _off_lines(x, column), _off_lines(y, column)
        off_y, along_x = _off_lines(y, row), _off_lines(x, row)
        angle += (off_y @ along_x - off_x @ along_y) / (along_x @ along_x + along_y @ along_y)
    quarter = np.pi / 2.0
    # Rounding shall not tell -45 from 45 degrees.
    return angle - quarter * np.ceil((angle - quarter / 2.0) / quarter - ROUNDING)
