"""How a sheet moves along its end lines and in the middle between them."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

#: Share of a line that must be measured to tell how it moves.
_MEASURED = 0.5
#: Share of the points of two lines that must face each other to be compared alone.
_FACING = 0.25
#: The same of ends that are whole but for single points.
_NEARLY_WHOLE = 0.9
#: Fewest points of a line: two for its slope, as many for its scatter.
_FEWEST = 4
#: Fewest lines from one end to the other.
_FEWEST_LINES = 4
#: Between these shares of the way from end to end lie the lines of the middle, where a sheet contracts most.
_MIDDLE = (1.0 / 3.0, 2.0 / 3.0)


@dataclass(frozen=True, kw_only=True)
class Ends:
    """Both end lines normal to one axis J, and the lines between them.

    Attributes:
        distance: between the end lines.
        gradient: mean of du_i/dX_J between them (i,).
        uncertainty: its standard deviation.
        across: slope of the component across the axis along each end line.
        middle: the same, of the lines in the middle.
        middle_uncertainty: its standard deviation.
        bend: larger scatter of the component along the axis about the straight end lines.
    """

    distance: float
    gradient: Float[np.ndarray, " 2"]
    uncertainty: Float[np.ndarray, " 2"]
    across: Float[np.ndarray, " 2"]
    middle: float
    middle_uncertainty: float
    bend: float


@dataclass(frozen=True, kw_only=True)
class _Lines:
    """Straight lines of least squares through the displacement along every line of the grid that is measured.

    Attributes:
        at: position of each line.
        centre: value in the middle of the grid.
        slope: derivative along the line.
        scatter: standard deviation about it.
        points: of how many points.
        span: standard deviation of their positions.
    """

    at: Float[np.ndarray, " line"]
    centre: Float[np.ndarray, "line 2"]
    slope: Float[np.ndarray, "line 2"]
    scatter: Float[np.ndarray, "line 2"]
    points: Int[np.ndarray, " line"]
    span: Float[np.ndarray, " line"]


def ends_of(
    x: Float[np.ndarray, " column"],
    y: Float[np.ndarray, " row"],
    displacement: Float[np.ndarray, "row column 2"],
    axis: int,
) -> Ends | None:
    """The end lines normal to an axis; None where there are none that are measured by half.

    Args:
        x, y: lines of the grid.
        displacement: of a frame, NaN where lost.
        axis: 0 for the left and right end, 1 for the bottom and top.
    """
    along, along_line = (x, y) if axis == 0 else (y, x)
    lines = _fitted(along, along_line, np.moveaxis(displacement, 1 - axis, 0))
    if len(lines.at) < _FEWEST_LINES:
        return None
    across, ends, distance = 1 - axis, [0, -1], float(lines.at[-1] - lines.at[0])
    share = (lines.at - lines.at[0]) / distance
    middle = (share >= _MIDDLE[0]) & (share <= _MIDDLE[1])
    # Half of the lines may be lost between the ends.
    middle = middle if middle.any() else np.arange(len(share)) == len(share) // 2
    mean_error = np.linalg.norm(lines.scatter[ends] / np.sqrt(lines.points[ends])[:, None], axis=0)
    slope_error = lines.scatter[:, across] / (np.sqrt(lines.points) * lines.span)
    slope = lines.slope[ends, across]
    whole = lines.points[ends] >= _NEARLY_WHOLE * len(along_line)
    if whole.any():
        # What is left of an end beside missing material says little of what holds it.
        slope = np.where(whole, slope, slope[whole].mean())
    return Ends(
        distance=distance,
        gradient=_gradient(lines, along, np.moveaxis(displacement, 1 - axis, 0), axis),
        uncertainty=mean_error / distance,
        across=slope,
        middle=float(lines.slope[middle, across].mean()),
        middle_uncertainty=float(slope_error[middle].mean()),
        bend=float(lines.scatter[ends, axis].max()),
    )


def _gradient(lines: _Lines, along: np.ndarray, u: np.ndarray, axis: int) -> np.ndarray:
    """Mean of du_i/dX_J between the end lines (i,): between points that face each other, where there are enough.

    Where part of an end is missing, what moves along the end lines is told by the two sides between them: what is left
    beside a corner without material would shear the sheet.
    """
    distance = lines.at[-1] - lines.at[0]
    low, high = (u[np.searchsorted(along, lines.at[end])] for end in (0, -1))
    facing = np.isfinite(low).all(axis=1) & np.isfinite(high).all(axis=1)
    if facing.mean() < _FACING:
        return (lines.centre[-1] - lines.centre[0]) / distance
    gradient = (high - low)[facing].mean(axis=0) / distance
    if facing.mean() < _NEARLY_WHOLE:
        sides = [_slope(along, u[:, side, 1 - axis]) for side in (0, -1)]
        gradient[1 - axis] = gradient[1 - axis] if None in sides else np.mean(sides)
    return gradient


def _slope(at: np.ndarray, values: np.ndarray) -> float | None:
    """Slope of the straight line through values along a side; None where less than half of it is measured."""
    known = np.isfinite(values)
    return float(np.polyfit(at[known], values[known], 1)[0]) if known.mean() >= _MEASURED else None


def _fitted(at: np.ndarray, position: np.ndarray, u: Float[np.ndarray, "line point 2"]) -> _Lines:
    """Least squares through both components of every line of which enough points are measured."""
    known = np.isfinite(u[..., 0]) & np.isfinite(u[..., 1])
    points = known.sum(axis=1)
    enough = points >= max(_FEWEST, _MEASURED * u.shape[1])
    known, points, u = known[enough], points[enough], np.nan_to_num(u[enough])
    weight, count = known[:, :, None], points[:, None]
    mean = (known * position).sum(axis=1) / points
    offset = (position - mean[:, None]) * known
    square = (offset**2).sum(axis=1)
    value = (weight * u).sum(axis=1) / count
    slope = (offset[:, :, None] * u).sum(axis=1) / square[:, None]
    rest = weight * (u - value[:, None] - offset[:, :, None] * slope[:, None])
    centre = value + slope * (0.5 * (position[0] + position[-1]) - mean)[:, None]
    scatter = np.sqrt((rest**2).sum(axis=1) / count)
    return _Lines(
        at=at[enough], centre=centre, slope=slope, scatter=scatter, points=points, span=np.sqrt(square / points)
    )
