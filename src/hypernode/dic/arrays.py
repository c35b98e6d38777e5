"""Frames of one file of arrays: npz, HDF5 or MATLAB, with positions, displacements and forces under known names."""

from collections.abc import Mapping
from dataclasses import replace
from itertools import permutations
from pathlib import Path

import numpy as np

from hypernode.dic.array_files import COMPONENTS, arrays_in
from hypernode.dic.dialect import Dialect
from hypernode.dic.errors import DicError
from hypernode.dic.points import Points, points_from
from hypernode.dic.text import shown

#: Names by what an array holds; those of the configuration come before them.
NAMES = {
    "positions": (
        "DIC_X",
        "positions",
        *map(" ".join, COMPONENTS["positions"]),
        "X",
        "coordinates",
        "coords",
        "points",
    ),
    "displacements": (
        *("DIC_disp", "displacements", *map(" ".join, COMPONENTS["displacements"])),
        *("U", "disp", "displacement"),
    ),
    "force": ("instron_force", "force", "F", "load", "forces", "Force"),
    "crosshead": ("instron_disp", "crosshead", "crosshead_displacement"),
    "time": ("time", "instron_time", "t"),
    "label": ("label", "labels"),
}
#: Arrays whose unit is known by their name.
_MILLIMETRES = ("DIC_X",)
#: Share of the largest position within which positions of two frames are alike.
_ROUNDING = 1e-6


def holds_frames(path: Path, names: Mapping[str, str | None]) -> bool:
    """Whether a file has positions and displacements under known names."""
    try:
        arrays = arrays_in(path)
    except DicError:
        return False
    return all(named(arrays, role, names) is not None for role in ("positions", "displacements"))


def said_of(path: Path) -> str:
    """What a file without frames holds, for a message."""
    try:
        arrays = arrays_in(path)
    except DicError as error:
        return f"; {error}"
    # Both components of a structure are what a key may name.
    listed = shown(sorted(arrays, key=lambda name: (" " not in name, name)))
    moving = named(arrays, "positions", {}) if named(arrays, "displacements", {}) is None else None
    return (
        f"; {path.name} holds the arrays {listed}: say which are what, --set 'arrays={{positions: NAME, "
        "displacements: NAME, force: NAME, unit: mm}'"
        + (f"; if {moving!r} are those of every frame, store the first, and displacements from it" if moving else "")
    )


def frames_of_arrays(
    path: Path, dialect: Dialect, arrays: Mapping[str, np.ndarray], courses: bool = True
) -> dict[int, Points]:
    """Frames of a file of arrays, numbered from 0 on.

    Args:
        path: the file.
        dialect: with the names of its arrays.
        arrays: what it holds.
        courses: whether it has a time, a force and the way of a crosshead of every frame.

    Raises:
        DicError: an array is absent, or of a shape that does not fit the others.
    """
    if dialect.unit is None and named(arrays, "positions", dialect.arrays) in _MILLIMETRES:
        dialect = replace(dialect, unit="mm")
    position = positions_in(path, arrays, dialect.arrays)
    displacement = _array(path, arrays, "displacements", dialect.arrays).astype(float)
    if _components_first(_array(path, arrays, "positions", dialect.arrays)):
        displacement = displacement.T
    u = _in_order(path, displacement, position.shape[:-1])
    position = position.reshape(-1, 2)
    roles = ("time", "force", "crosshead") if courses else ()
    course = {role: _course(path, arrays, role, len(u), dialect) for role in roles}
    line = np.arange(1, len(position) + 1)
    frames = {}
    for number, each in enumerate(u):
        cells = dict(zip("xyuv", (*position.T, *each.T), strict=True))
        points = points_from(path, cells, line, dict.fromkeys("xyuv", ""), [], dialect)
        told = {role: None if values is None else float(values[number]) for role, values in course.items()}
        frames[number] = replace(points, **told)
    return frames


def positions_in(path: Path, arrays: Mapping[str, np.ndarray], names: Mapping[str, str | None]) -> np.ndarray:
    """Positions of a file of arrays, (point, 2) or (row, column, 2), whichever axis is stored first.

    Raises:
        DicError: there are none, or of another shape.
    """
    stored = _array(path, arrays, "positions", names)
    displacements = named(arrays, "displacements", names)
    if displacements and stored.ndim > 2 and arrays[displacements].shape == stored.shape:
        stored = _of_the_first(path, stored.astype(float), arrays[displacements].astype(float))
    position = np.squeeze(stored).astype(float)
    position = position.T if _components_first(stored) else position
    if position.ndim not in (2, 3) or position.shape[-1] != 2:
        raise DicError(f"{path}: positions of shape {position.shape}: store them as (point, 2) or (row, column, 2)")
    return position


def _of_the_first(path: Path, position: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Positions at rest, of those that are stored for every frame, at rest or in the deformed sheet.

    Raises:
        DicError: they are neither.
    """
    for there in (position, position - u):
        scatter = np.nan_to_num(np.abs(there - there[:1]))
        if scatter.max() <= _ROUNDING * np.nanmax(np.abs(position)):
            return there[0]
    raise DicError(
        f"{path}: positions of shape {position.shape}, one a frame, are neither those at rest nor those with the "
        "displacements: store those at rest as (point, 2) or (row, column, 2)"
    )


def frame_of_arrays(path: Path, dialect: Dialect) -> Points:
    """The one frame of a file that holds no more.

    Raises:
        DicError: as :func:`frames_of_arrays`.
    """
    arrays = arrays_in(path)
    name = named(arrays, "displacements", dialect.arrays)
    u = np.squeeze(_array(path, arrays, "displacements", dialect.arrays))
    # Frames are told from places where there are two of them.
    arrays = arrays | {name: np.stack([u, u])}
    if u.size != positions_in(path, arrays, dialect.arrays).size:
        raise DicError(f"{path}: several frames in one of several files: keep one test a folder, or one frame a file")
    return frames_of_arrays(path, dialect, arrays, courses=False)[0]


def _components_first(stored: np.ndarray) -> bool:
    shape = np.squeeze(stored).shape
    return len(shape) > 1 and shape[0] == 2 != shape[-1]


def _course(path: Path, arrays: Mapping[str, np.ndarray], role: str, frames: int, dialect: Dialect):
    """One value a frame; None where no array holds them.

    Raises:
        DicError: there are not as many as frames.
    """
    name = named(arrays, role, dialect.arrays)
    values = None if name is None else np.ravel(arrays[name]).astype(float)
    if values is not None and len(values) != frames:
        raise DicError(f"{path}: {len(values)} values of {role} {name!r} of {frames} frames: store one a frame")
    return values


def named(arrays: Mapping[str, np.ndarray], role: str, names: Mapping[str, str | None]) -> str | None:
    """Name of the array of a role: that of the configuration, else the first usual one; None where there is none."""
    wanted = (names[role],) if names.get(role) else NAMES[role]
    return next((name for name in wanted if name in arrays), None)


def _array(path: Path, arrays: Mapping[str, np.ndarray], role: str, names: Mapping[str, str | None]) -> np.ndarray:
    name = named(arrays, role, names)
    if name is None:
        raise DicError(
            f"{path}: no array of {role} among {shown(sorted(arrays))}: name it (--set 'arrays={{{role}: NAME}}')"
        )
    return arrays[name]


def _in_order(path: Path, u: np.ndarray, grid: tuple[int, ...]) -> np.ndarray:
    """Displacements as (frame, point, 2), whichever order of axes they are stored in."""
    if u.ndim == 4 and len(grid) == 1:
        u = u.reshape(u.shape[0], -1, u.shape[-1])
    # The frame first and the component last is the usual order, and is tried first.
    orders = sorted(permutations(range(u.ndim), 2), key=lambda each: (each[1] != u.ndim - 1, each[0]))
    for frame, component in orders:
        kept = [axis for axis in range(u.ndim) if axis not in (frame, component)]
        for places in (kept, kept[::-1]):
            if tuple(u.shape[axis] for axis in places) == grid and u.shape[component] == 2 and u.shape[frame] > 1:
                return np.transpose(u, (frame, *places, component)).reshape(u.shape[frame], -1, 2)
    store = "(frame, point, 2)" if len(grid) == 1 else "(frame, row, column, 2)"
    at = " x ".join(map(str, grid))
    raise DicError(f"{path}: displacements of shape {u.shape} for {at} points: store them as {store}")
