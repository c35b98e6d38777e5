"""Several tests of one sheet on one grid: that of the first, as far as all of them reach."""

import numpy as np
from jaxtyping import Float
from scipy.interpolate import RegularGridInterpolator

from hypernode.dic.errors import DicError
from hypernode.dic.load_case import LoadCase
from hypernode.progress import say

#: Distance of two lines, in steps, below which they are one: rounding of exported coordinates.
_SAME_LINE = 1e-3


def offset_of(case: LoadCase, first: LoadCase) -> Float[np.ndarray, " 2"]:
    """Where the corner of a test's measured field lies, from that of the first one [mm].

    Raises:
        DicError: nothing says so, and the fields differ in size, so that their centres need not be one point.
    """
    if case.test.grid_offset is not None:
        return np.array(case.test.grid_offset)
    step = np.array([np.median(np.diff(first.x)), np.median(np.diff(first.y))])
    apart = case.size - first.size
    if (np.abs(apart) > step).any():
        raise DicError(
            f"{case.test.folder}: its field of {case.size[0]:.4g} x {case.size[1]:.4g} mm is not that of "
            f"{first.test.folder}, {first.size[0]:.4g} x {first.size[1]:.4g} mm: say where its lower left corner lies "
            "from that of the other, grid_offset: [x, y] in mm"
        )
    return -0.5 * apart


def on_one_grid(cases: list[LoadCase]) -> tuple[np.ndarray, np.ndarray, list[Float[np.ndarray, "step row column 2"]]]:
    """(x, y, displacement of every test) on those lines of the first test's grid that all of them reach.

    Displacements of another grid are interpolated linearly, NaN where a point around is lost.

    Raises:
        DicError: tests have no common field, or nothing says where one lies.
    """
    first = cases[0]
    lines = [(case.x + dx, case.y + dy) for case, (dx, dy) in ((c, offset_of(c, first)) for c in cases)]
    axes = [_common([each[k] for each in lines], cases, k) for k in (0, 1)]
    fields = [_interpolated(case, own, axes) for case, own in zip(cases, lines, strict=True)]
    return *axes, fields


def _common(lines: list[np.ndarray], cases: list[LoadCase], axis: int) -> np.ndarray:
    """Lines of the first grid that lie within all of them."""
    first = lines[0]
    near = _SAME_LINE * np.median(np.diff(first))
    low, high = max(each[0] for each in lines) - near, min(each[-1] for each in lines) + near
    kept = first[(first >= low) & (first <= high)]
    if len(kept) < 4:
        raise DicError(f"{cases[-1].test.folder}: the fields of the tests have no common part along {'xy'[axis]}")
    return kept


def _interpolated(case: LoadCase, own, axes) -> Float[np.ndarray, "step row column 2"]:
    places = [_places(line, axis) for line, axis in zip(own, axes, strict=True)]
    if all(place is not None for place in places):
        return case.u[:, places[1]][:, :, places[0]]
    step = max(float(np.median(np.diff(line))) for line in own)
    say(
        "import", case.test.folder, f"interpolated onto the grid of the first test (its own has steps of {step:.4g} mm)"
    )
    clipped = [np.clip(axis, line[0], line[-1]) for line, axis in zip(own, axes, strict=True)]
    at = np.stack(np.meshgrid(clipped[1], clipped[0], indexing="ij"), axis=-1)
    fields = np.moveaxis(case.u, 0, -1)
    return np.moveaxis(RegularGridInterpolator((own[1], own[0]), fields)(at), -1, 0)


def _places(line: np.ndarray, axis: np.ndarray) -> np.ndarray | None:
    """Number of the line that each of the axis is; None where it lies between two."""
    nearest = np.abs(axis[:, None] - line).argmin(axis=1)
    same = np.abs(line[nearest] - axis) <= _SAME_LINE * np.median(np.diff(line))
    return nearest if same.all() else None
