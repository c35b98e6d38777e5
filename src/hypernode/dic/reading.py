"""Any vendor's folder of displacement files, as a series on one grid."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from hypernode.config.specimen_tests import SpecimenTest
from hypernode.dic.assembled import frames_of_matrices, frames_of_ncorr, frames_of_subsets
from hypernode.dic.dialect import Dialect
from hypernode.dic.errors import DicError
from hypernode.dic.folder import Found, dialect_of, find_series
from hypernode.dic.grid import NearGrid, grid_of
from hypernode.dic.plane import plane_of
from hypernode.dic.points import Points, read_points, refuse_strays
from hypernode.dic.series import Frame, Series
from hypernode.dic.text import refuse_cut_lines
from hypernode.dic.tilt import Tilt, tilt_of
from hypernode.progress import say

#: Largest displacement of a reference, in steps of its grid: noise of a second picture of the sheet at rest.
_AT_REST = 0.05
#: The same where it is the picture that the others were compared with: rounding. Noise is a hundred times as large.
_ITSELF = 1e-5
#: Largest range of the out-of-plane displacement over the size of the sheet.
MAX_OUT_OF_PLANE = 0.05
#: Percentiles between which that range is taken: a few points that a camera mistook are not the sheet.
_RANGE = (1.0, 99.0)


def read_test(test: SpecimenTest) -> Series:
    """The series of a test, with what was decided about it in the log.

    Raises:
        DicError: as :func:`read_series`.
    """
    series = read_series(
        Path(test.folder),
        test.frames,
        dialect_of(test),
        y_points=test.y_points,
        allow_out_of_plane=test.allow_out_of_plane,
    )
    if series.unit == "mm" and test.pixel_size is not None:
        serves = "serves for the noise alone" if test.noise_pixels else "is ignored"
        say("import", test.folder, f"the files are in mm: pixel_size {serves}")
    return series


def read_series(
    folder: Path,
    numbers=None,
    dialect: Dialect | None = None,
    y_points: str | None = None,
    allow_out_of_plane: bool = False,
) -> Series:
    """Read the frames of a folder onto one grid.

    Args:
        folder: the folder.
        numbers: frames to read besides the reference; all when left out.
        dialect: of the files; they show it when left out.
        y_points: ``up`` or ``down`` where y of the files points otherwise than their dialect says.
        allow_out_of_plane: whether a stereo sheet may move far out of its plane.

    Raises:
        DicError: no or several series, missing frames, broken files, points off the reference's grid, a reference that
            is deformed, or a sheet that moves out of its plane.
    """
    found = find_series(folder, dialect)
    dialect = found.dialect if y_points is None else replace(found.dialect, y_up=y_points == "up")
    available, read = _source(found, dialect)
    first = read(available[0])
    implied = not dialect.reference and not _is_compared_with_itself(first)
    reference = available[0] - implied
    wanted = sorted(set(available if numbers is None else numbers) - {reference})
    _refuse_absent(folder, wanted, available)
    _tell(folder, dialect, first, reference, implied)
    at_rest = replace(first, displacement=np.zeros_like(first.displacement), force=None) if implied else first
    plane = plane_of(at_rest) if first.position.shape[1] == 3 else None
    at_rest = plane.seen(at_rest) if plane else at_rest
    refuse_strays(at_rest)
    tilt = tilt_of(at_rest)
    at_rest = tilt.seen(at_rest) if tilt else at_rest
    grid = tilt.grid if tilt else grid_of(at_rest)
    _refuse_deformed_reference(at_rest, grid, dialect)
    frames = [
        Frame(reference, grid.values(at_rest, reference), found.times.get(reference, at_rest.time), at_rest.force)
    ]
    out_of_plane = 0.0
    for number in wanted:
        points = _without_lost_zeros(read(number), dialect)
        refuse_cut_lines((first.path, points.path))
        if (points.unit, points.position.shape[1]) != (first.unit, first.position.shape[1]):
            raise DicError(f"{points.path}: other columns or units ({points.unit}) than {first.path.name}")
        if plane:
            points = plane.seen(points)
            out_of_plane = max(out_of_plane, _out_of_plane(points, at_rest, allow_out_of_plane))
        points = tilt.seen(points) if tilt else points
        time = found.times.get(number, points.time)
        frames.append(Frame(number, grid.values(points, reference), time, points.force))
    _tell_axes(folder, grid, tilt, first.unit)
    if plane:
        say("import", str(folder), f"the sheet moves out of its plane by {out_of_plane:.2%} of its size")
    used = dict.fromkeys([available[0], *wanted]) if dialect.content in ("frame", "davis8") else found.files
    files = tuple(found.files[number] for number in used)
    x, y = grid.x - grid.x[0], grid.y - grid.y[0]
    return Series(x, y, frames, first.unit, out_of_plane, files, tilt.degrees if tilt else 0.0)


def _is_compared_with_itself(points: Points) -> bool:
    """Whether a frame is the reference: its displacement is none but for rounding."""
    step = np.sqrt(np.prod(np.ptp(points.position[:, :2], axis=0)) / len(points.position))
    return bool(np.abs(np.nan_to_num(points.displacement)).max() <= _ITSELF * step)


def _refuse_absent(folder: Path, wanted: list[int], available: list[int]) -> None:
    absent = [n for n in wanted if n not in available]
    if absent:
        near = min(available, key=lambda n: abs(n - absent[0]))
        raise DicError(f"{folder}: frame {absent[0]} is not there; the nearest is {near}")


def _source(found: Found, dialect: Dialect) -> tuple[list[int], Callable[[int], Points]]:
    """(numbers of the frames, function that reads one, y upward)."""
    files = list(found.files.values())
    if dialect.content == "subset":
        frames = frames_of_subsets(files, dialect)
    elif dialect.content == "matrices":
        frames = frames_of_matrices(files, dialect)
    elif dialect.content == "ncorr":
        frames = frames_of_ncorr(files[0], dialect)
    else:
        return list(found.files), lambda number: _upward(read_points(found.files[number], dialect), dialect)
    return list(frames), lambda number: _upward(frames[number], dialect)


def _upward(points: Points, dialect: Dialect) -> Points:
    """Points with y and its displacement upward."""
    v_up = dialect.y_up if dialect.v_up is None else dialect.v_up
    position, u = points.position.copy(), points.displacement.copy()
    position[:, 1] *= 1.0 if dialect.y_up else -1.0
    u[:, 1] *= 1.0 if v_up else -1.0
    return replace(points, position=position, displacement=u)


def _without_lost_zeros(points: Points, dialect: Dialect) -> Points:
    if not dialect.zero_is_lost:
        return points
    u = points.displacement.copy()
    u[(u == 0.0).all(axis=1)] = np.nan
    return replace(points, displacement=u)


def _tell(folder: Path, dialect: Dialect, first: Points, reference: int, implied: bool) -> None:
    text = (
        f"files of {dialect.software} (format: {dialect.name}), in {first.unit}, y {'up' if dialect.y_up else 'down'}, "
        f"{len(first.position)} points in the first"
    )
    if implied:
        text += f"; the reference is not among them and counts as frame {reference}"
    say("import", str(folder), text)


def _tell_axes(folder: Path, grid, tilt: Tilt | None, unit: str) -> None:
    if tilt:
        text = (
            f"the grid is tilted by {tilt.degrees:.4g} degrees against the axes of the files: positions and "
            "displacements are along its own"
        )
        say("import", str(folder), text)
    if isinstance(grid, NearGrid):
        text = (
            f"points lie off a grid: interpolated onto {len(grid.x)} x {len(grid.y)} points {grid.step[0]:.4g} and "
            f"{grid.step[1]:.4g} {unit} apart; the nearest measured point is {grid.moved[0]:.2g} of a step away in the "
            f"median, {grid.moved[1]:.2g} at most"
        )
        say("import", str(folder), text)


def _refuse_deformed_reference(points: Points, grid, dialect: Dialect) -> None:
    step = min(np.median(np.diff(grid.x)), np.median(np.diff(grid.y)))
    size = np.linalg.norm(points.displacement[:, :2], axis=1)
    if np.isfinite(size).any() and np.nanmax(size) > _AT_REST * step:
        worst = int(np.nanargmax(size))
        raise DicError(
            f"{points.path}:{points.line[worst]}: the first frame is moved by {size[worst]:.4g} {points.unit}: "
            f"export the reference of {dialect.software}, whose displacement is zero, as its first frame"
        )


def _out_of_plane(points: Points, reference: Points, allowed: bool) -> float:
    """Range of a frame's out-of-plane displacement over the size of the sheet."""
    w = points.displacement[:, 2]
    size = np.ptp(reference.position[:, :2], axis=0).max()
    share = float(np.ptp(np.nanpercentile(w, _RANGE)) / size) if np.isfinite(w).any() else 0.0
    if share > MAX_OUT_OF_PLANE and not allowed:
        raise DicError(
            f"{points.path}: the sheet moves out of its plane by {share:.0%} of its size, more than "
            f"{MAX_OUT_OF_PLANE:.0%}: it is not in plane stress; allow_out_of_plane: true reads it all the same"
        )
    return share
