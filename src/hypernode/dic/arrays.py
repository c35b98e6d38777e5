"""Frames of one file of arrays: npz, HDF5 or MATLAB, with positions, displacements and forces under known names."""

import zipfile
from collections.abc import Mapping
from dataclasses import replace
from itertools import permutations
from pathlib import Path

import numpy as np

from hypernode.dic.dialect import Dialect
from hypernode.dic.errors import DicError
from hypernode.dic.points import Points, points_from
from hypernode.dic.text import shown

#: Endings of such files.
SUFFIXES = {".npz", ".h5", ".hdf5", ".mat"}
#: Names of arrays that hold one component each.
COMPONENTS = {
    "positions": (("x", "y"), ("X", "Y")),
    "displacements": (("u", "v"), ("U", "V"), ("ux", "uy"), ("Ux", "Uy"), ("UX", "UY")),
}
#: Names by what an array holds; those of the configuration come before them.
NAMES = {
    "positions": ("DIC_X", "positions", *map(" ".join, COMPONENTS["positions"]), "X", "coordinates"),
    "displacements": ("DIC_disp", "displacements", *map(" ".join, COMPONENTS["displacements"]), "U", "disp"),
    "force": ("instron_force", "force", "F"),
    "crosshead": ("instron_disp", "crosshead", "crosshead_displacement"),
    "time": ("time", "instron_time", "t"),
    "label": ("label", "labels"),
}
#: Arrays whose unit is known by their name.
_MILLIMETRES = ("DIC_X",)
_HDF5 = b"\x89HDF\r\n\x1a\n"
#: What readers of such files raise where one is broken.
_BROKEN = (OSError, ValueError, KeyError, TypeError, NotImplementedError, EOFError, RuntimeError, zipfile.BadZipFile)


def arrays_in(path: Path) -> dict[str, np.ndarray]:
    """The numeric arrays of a file by their names; of MATLAB 7.3 and HDF5 those at the top.

    One array of each component, as ``x`` and ``y``, or ``u`` and ``v``, becomes one of both, named by both.

    Raises:
        DicError: it cannot be read.
    """
    arrays = _arrays_in(path)
    for pair in (pair for pairs in COMPONENTS.values() for pair in pairs):
        first, second = (arrays.get(name) for name in pair)
        if first is not None and second is not None and first.shape == second.shape:
            arrays[" ".join(pair)] = np.stack([first, second], axis=-1)
    return arrays


def _arrays_in(path: Path) -> dict[str, np.ndarray]:
    try:
        if path.suffix.lower() == ".npz":
            with np.load(path, allow_pickle=False) as file:
                return {name: file[name] for name in file.files if file[name].dtype.kind in "fiu"}
        with open(path, "rb") as handle:
            start = handle.read(520)
        if _HDF5 in (start[:8], start[512:520]):
            return _of_hdf5(path)
        import scipy.io

        return {k: v for k, v in scipy.io.loadmat(path).items() if isinstance(v, np.ndarray) and v.dtype.kind in "fiu"}
    except _BROKEN as error:
        raise DicError(f"{path}: cannot be read as arrays: {error}") from None


def _of_hdf5(path: Path) -> dict[str, np.ndarray]:
    import netCDF4

    with netCDF4.Dataset(path) as file:
        file.set_auto_maskandscale(False)
        numeric = {k: v for k, v in file.variables.items() if isinstance(v.dtype, np.dtype) and v.dtype.kind in "fiu"}
        found = {name: np.array(variable[...]) for name, variable in numeric.items()}
    # MATLAB writes its columns first.
    return {name: each.T if path.suffix.lower() == ".mat" else each for name, each in found.items()}


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
        names = shown(sorted(arrays_in(path)))
    except DicError as error:
        return f"; {error}"
    return (
        f"; {path.name} holds the arrays {names}: say which are what, --set 'arrays={{positions: NAME, displacements: "
        "NAME, force: NAME, unit: mm}'"
    )


def frames_of_arrays(path: Path, dialect: Dialect) -> dict[int, Points]:
    """Frames of a file of arrays, numbered from 0 on.

    Raises:
        DicError: an array is absent, or of a shape that does not fit the others.
    """
    arrays = arrays_in(path)
    if dialect.unit is None and named(arrays, "positions", dialect.arrays) in _MILLIMETRES:
        dialect = replace(dialect, unit="mm")
    position = positions_in(path, arrays, dialect.arrays)
    displacement = _array(path, arrays, "displacements", dialect.arrays).astype(float)
    if _components_first(_array(path, arrays, "positions", dialect.arrays)):
        displacement = displacement.T
    u = _in_order(path, displacement, position.shape[:-1])
    position = position.reshape(-1, 2)
    course = {role: _course(path, arrays, role, len(u), dialect) for role in ("time", "force", "crosshead")}
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
    position = np.squeeze(stored).astype(float)
    position = position.T if _components_first(stored) else position
    if position.ndim not in (2, 3) or position.shape[-1] != 2:
        raise DicError(f"{path}: positions of shape {position.shape}: store them as (point, 2) or (row, column, 2)")
    return position


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
        places = [axis for axis in range(u.ndim) if axis not in (frame, component)]
        if tuple(u.shape[axis] for axis in places) == grid and u.shape[component] == 2 and u.shape[frame] > 1:
            return np.transpose(u, (frame, *places, component)).reshape(u.shape[frame], -1, 2)
    store = "(frame, point, 2)" if len(grid) == 1 else "(frame, row, column, 2)"
    at = " x ".join(map(str, grid))
    raise DicError(f"{path}: displacements of shape {u.shape} for {at} points: store them as {store}")
