"""How the camera, or the machine under it, moved between two pictures, told by edges that are held.

A camera that turns and shifts sees X + u = Q (X + u0) + t. u0 is the displacement of the sheet, Q a rotation about the
origin of the grid, t a translation. Rotations of the sheet itself are no sign of Q; a held edge is, as it keeps its
direction while the machine pulls.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from hypernode.dic.turning import turned
from hypernode.fem.mesh import EDGES

#: Share of an edge that must be measured: what is left may lie at one end and tell its noise alone.
_MEASURED = 0.5
#: Fewest points of an edge: from the scatter of fewer, more than one still frame in a hundred seems to be turned.
_FEWEST = 8
#: Independent values that an edge has at least, however smoothly it bends: two for its line, as many for its scatter.
_INDEPENDENT = 4
#: Uncertainties beyond which an angle is taken for one.
_SIGNIFICANT = 3.0


@dataclass(frozen=True)
class CameraMotion:
    """Rigid motion of what the camera sees, x -> Q x + t.

    Attributes:
        angle: of Q, counter-clockwise with y upward [rad].
        angle_uncertainty: its standard deviation, infinite where no edge tells it [rad].
        translation: t, in the unit of the grid.
    """

    angle: float
    angle_uncertainty: float
    translation: Float[np.ndarray, " 2"]

    @property
    def significant(self) -> bool:
        """Whether the angle is more than what chance and edges that are not quite straight make."""
        return abs(self.angle) > _SIGNIFICANT * self.angle_uncertainty


def camera_motion(
    x: Float[np.ndarray, " column"],
    y: Float[np.ndarray, " row"],
    displacement: Float[np.ndarray, "row column 2"],
    held: Iterable[tuple[str, int]],
) -> CameraMotion:
    """The motion of the camera from the reference to a frame.

    The angle is that of the deformed edges whose normal component is held: slopes of straight lines of least squares,
    averaged with the inverses of their variances. It is as uncertain as their fits say, neighbouring points not being
    independent, or by half the largest difference between edges where that is more.

    No measurement tells the translation from one of the sheet. It is chosen such that, turned back, the mean of a
    component over one edge is zero. The edge is the left or bottom one that holds the component, and of two the one
    that it is normal to. Where no edge holds it, or no point of the edge is measured, the mean is over all points.

    Args:
        x, y: lines of the grid; the rotation is about their zero.
        displacement: since the reference, NaN where lost.
        held: (edge, component) pairs whose displacement is prescribed, as ``mechanics.loads.CONSTRAINED`` has them.
    """
    held = tuple(held)
    deformed = _positions(x, y) + displacement
    found = [_direction(_line(deformed, edge), component) for edge, component in held if EDGES[edge][0] == component]
    angle, uncertainty = _mean([each for each in found if each is not None])
    back = turned(deformed, -angle) - _positions(x, y)
    shift = np.array([_at_rest(back, component, held) for component in (0, 1)])
    return CameraMotion(angle, uncertainty, turned(shift, angle))


def without(
    motion: CameraMotion,
    x: Float[np.ndarray, " column"],
    y: Float[np.ndarray, " row"],
    displacement: Float[np.ndarray, "row column 2"],
) -> Float[np.ndarray, "row column 2"]:
    """Displacements as a camera that had not moved would have seen them; for motions that are significant."""
    position = _positions(x, y)
    return turned(position + displacement - motion.translation, -motion.angle) - position


def _positions(x: np.ndarray, y: np.ndarray) -> Float[np.ndarray, "row column 2"]:
    return np.stack(np.meshgrid(x, y), axis=-1)


def _line(field: Float[np.ndarray, "row column 2"], edge: str) -> Float[np.ndarray, "point 2"]:
    """The outermost line of the grid at an edge."""
    axis, sign = EDGES[edge]
    return np.moveaxis(field, 1 - axis, 0)[0 if sign < 0 else -1]


def _direction(line: Float[np.ndarray, "point 2"], normal: int) -> tuple[float, float] | None:
    """(angle by which a line is turned from its axis, its variance), ``None`` where too little of it is measured."""
    measured = np.isfinite(line).all(axis=1)
    if measured.sum() < max(_FEWEST, _MEASURED * len(line)):
        return None
    offset = line[measured] - line[measured].mean(axis=0)
    along, across = offset[:, 1 - normal], offset[:, normal]
    slope = (along @ across) / (along @ along)
    angle = np.arctan(slope)
    # At right angles to the line, as the noise of both components moves points off it.
    off = (across - slope * along) * np.cos(angle)
    length = along @ along / np.cos(angle) ** 2
    rounding = np.finfo(float).eps * np.abs(line[measured]).max()
    repeats = min(repeats_of(off), len(off) / _INDEPENDENT)
    # The line takes up two of the independent values.
    variance = max(off @ off / (len(off) - 2.0 * repeats), rounding**2) * repeats / length
    return float(angle if normal == 1 else -angle), float(variance)


def repeats_of(off: Float[np.ndarray, " point"]) -> float:
    """How many points in a row say the same, from the correlation r of neighbours: (1 + r) / (1 - r).

    Sums of an autoregressive series scatter by that more than those of independent values (Priestley, Spectral Analysis
    and Time Series, 1981). Subsets of neighbouring points share pixels, and a line that bends is off its
    straight line over many points.
    """
    total = off @ off
    r = max(float(off[1:] @ off[:-1] / total), 0.0) if total > 0.0 else 0.0
    return (1.0 + r) / (1.0 - r)


def _mean(directions: list[tuple[float, float]]) -> tuple[float, float]:
    """(mean of angles weighted by their inverse variances, its uncertainty)."""
    if not directions:
        return 0.0, np.inf
    angles, variances = np.array(directions).T
    weights = 1.0 / variances
    return float(weights @ angles / weights.sum()), float(max(weights.sum() ** -0.5, 0.5 * np.ptp(angles)))


def _at_rest(displacement: Float[np.ndarray, "row column 2"], component: int, held: tuple) -> float:
    """The mean of a component over the edge that is taken as at rest; zero where nothing is measured."""
    low = [edge for edge, each in held if each == component and EDGES[edge][1] < 0]
    low.sort(key=lambda edge: EDGES[edge][0] != component)
    for points in (*(_line(displacement, edge) for edge in low), displacement.reshape(-1, 2)):
        values = points[np.isfinite(points).all(axis=1), component]
        if len(values):
            return float(values.mean())
    return 0.0
