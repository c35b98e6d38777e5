"""Shapes of inclusions, found without the true shape and then compared with it."""

import itertools
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from scipy.spatial import cKDTree
from skimage.filters import threshold_otsu

from hypernode.evaluation.judgement import Judgement
from hypernode.fem.mesh import Mesh

#: Shift over side length and relative change of size that a registration may use, and how often its grid is halved.
REGISTRATION_LIMIT, REGISTRATION_HALVINGS = 0.05, 4
#: Share of the cells at either end whose values count as that of the last one before them.
OUTLIERS = 0.005


def border_cells(mesh: Mesh) -> Bool[np.ndarray, " cell"]:
    """Cells that touch the bounding rectangle."""
    on = np.zeros(len(mesh.nodes), dtype=bool)
    for edge in ("left", "right", "bottom", "top"):
        on |= mesh.on_edge(edge)
    return on[mesh.cells].any(axis=1)


def two_levels(indicator: Float[np.ndarray, " cell"]) -> Bool[np.ndarray, " cell"]:
    """Cells above Otsu's threshold; none if all values are equal.

    Between two well separated levels Otsu's criterion is flat. The threshold is then half-way between the two means,
    which has the widest margin. A few outliers do not shift the threshold.

    Raises:
        ValueError: the indicator of a cell is not a number.
    """
    if unknown := np.count_nonzero(np.isnan(indicator)):
        raise ValueError(
            f"{unknown} of {len(indicator)} cells have no stress at the stretch from which the shape is read: the "
            "identified material is not physical there; look at the misfits and at the loss of its identification"
        )
    indicator = np.clip(indicator, *np.quantile(indicator, (OUTLIERS, 1.0 - OUTLIERS)))
    if np.ptp(indicator) <= 1e-12 * max(np.abs(indicator).max(), 1e-300):
        return np.zeros(len(indicator), dtype=bool)
    high = indicator > threshold_otsu(indicator)
    return indicator > 0.5 * (indicator[high].mean() + indicator[~high].mean())


def inner_side(mesh: Mesh, high: Bool[np.ndarray, " cell"]) -> Bool[np.ndarray, " cell"]:
    """The inclusion: the side of a split with fewer cells at the border."""
    border = border_cells(mesh)
    return high if high[border].mean() <= (~high)[border].mean() else ~high


def find_inclusion(mesh: Mesh, indicator: Float[np.ndarray, " cell"]) -> Bool[np.ndarray, " cell"]:
    """The inclusion from a split of the sheet into two levels; empty if all values are equal.

    Raises:
        ValueError: as :func:`two_levels`.
    """
    return inner_side(mesh, two_levels(indicator))


def dice(a, b) -> float:
    """2 |a and b| / (|a| + |b|); 1 if both are empty."""
    total = a.sum() + b.sum()
    return float(2.0 * (a & b).sum() / total) if total else 1.0


def intersection_over_union(a, b) -> float:
    """|a and b| / |a or b|; 1 if both are empty."""
    union = (a | b).sum()
    return float((a & b).sum() / union) if union else 1.0


def _boundary(mesh: Mesh, shape):
    """Midpoints of the cell sides that separate the shape from the rest."""
    cells, _, middle = mesh.neighbours()
    return middle[shape[cells[:, 0]] != shape[cells[:, 1]]]


def boundary_distance(mesh: Mesh, a, b) -> float:
    """Mean distance between the outlines of two shapes, symmetric, in the length unit of the mesh."""
    first, second = _boundary(mesh, a), _boundary(mesh, b)
    if len(first) == 0 or len(second) == 0:
        return float("nan")
    return float(0.5 * (cKDTree(second).query(first)[0].mean() + cKDTree(first).query(second)[0].mean()))


def registered_dice(found, shape, X: Float[np.ndarray, "cell 2"]) -> tuple[float, tuple]:
    """Best Dice coefficient over small shifts and scalings of the reference shape.

    Args:
        found: cells of the found inclusion.
        shape: the reference as a function of unit-square points.
        X: cell centres in the unit square.

    Returns:
        (Dice, (shift x, shift y, scale x, scale y)).
    """

    def score(place):
        """Dice score of the reference moved and stretched by ``place``."""
        shift, size = np.array(place[:2]), 1.0 + np.array(place[2:])
        return dice(found, shape((X - 0.5 - shift) / size + 0.5) > 0.5)

    best, place = score((0.0,) * 4), (0.0,) * 4
    step = REGISTRATION_LIMIT
    for _ in range(REGISTRATION_HALVINGS + 1):
        # Around the best so far, on a grid that becomes finer; the score has steps, so no derivative helps.
        around = (np.array([p - step, p, p + step]).clip(-REGISTRATION_LIMIT, REGISTRATION_LIMIT) for p in place)
        for trial in itertools.product(*map(np.unique, around)):
            if (value := score(trial)) > best:
                best, place = value, trial
        step /= 2.0
    dx, dy, sx, sy = map(float, place)
    return best, (dx, dy, 1.0 + sx, 1.0 + sy)


def most_interior(mesh: Mesh, shape) -> np.ndarray:
    """For the matrix and the inclusion, the cell farthest from the other one and from the border."""
    centres = mesh.centres
    to_border = np.minimum(centres - mesh.lower, mesh.upper - centres).min(axis=1)
    chosen = []
    for side in (~shape, shape):
        distance = to_border.copy()
        if (~side).any():
            distance = np.minimum(distance, cKDTree(centres[~side]).query(centres)[0])
        chosen.append(int(np.argmax(np.where(side, distance, -1.0))))
    return np.array(chosen)


def curve_places(
    mesh: Mesh, shape: Bool[np.ndarray, " cell"], true_shape: Bool[np.ndarray, " cell"] | None
) -> Float[np.ndarray, "location 2"]:
    """Positions of the curves of matrix and inclusion, from the true phases if there are two. NaN for an inclusion that
    was not found.
    """
    two = true_shape is not None and true_shape.any() and not true_shape.all()
    places = mesh.centres[most_interior(mesh, true_shape if two else shape)]
    if not shape.any():
        places[1] = np.nan
    return places


@dataclass(frozen=True)
class PrintedShape:
    """The printed shape of a specimen.

    Attributes:
        inside: points of the unit square (point, 2) -> 1 in the inclusion and 0 outside.
        corners: lower left and upper right corner of the sheet, in the length unit of the test (2, 2).
        flipped: whether the cameras saw the back of the sheet, upside down.
    """

    inside: Callable
    corners: Float[np.ndarray, "2 2"]
    flipped: bool


def score_shape(
    mesh: Mesh, field: Float[np.ndarray, " cell"], shape: Bool[np.ndarray, " cell"], true_shape
) -> Judgement:
    """Ratio of the stiffness of inclusion and matrix, and overlap with the true or printed shape (None if unknown)."""
    summary, variables = {}, {}
    if shape.any() and not shape.all():
        summary["inclusion_over_matrix"] = float(field[shape].mean() / field[~shape].mean())
    if true_shape is not None:
        variables["shape_true"] = true_shape.astype(np.int64)
        summary |= {
            "dice": dice(shape, true_shape),
            "iou": intersection_over_union(shape, true_shape),
            "boundary_distance": boundary_distance(mesh, shape, true_shape),
        }
    return Judgement(variables, summary)


def score_printed(
    mesh: Mesh, shape: Bool[np.ndarray, " cell"], printed: PrintedShape
) -> tuple[Judgement, Bool[np.ndarray, " cell"]]:
    """(Dice score of the found shape after registration, the printed shape on the cells)."""
    lower, upper = printed.corners
    X = (mesh.centres - lower) / (upper - lower)
    if printed.flipped:
        X = X * (1.0, -1.0) + (0.0, 1.0)
    score, registration = registered_dice(shape, printed.inside, X)
    return Judgement(summary={"dice_registered": score, "registration": registration}), printed.inside(X) > 0.5
