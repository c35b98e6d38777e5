"""Frames of one file of arrays: npz, HDF5 or MATLAB, with positions, displacements and forces under known names."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from hypernode.dic.dialect import Dialect
from hypernode.dic.errors import DicError
from hypernode.dic.points import Points, points_from
from hypernode.dic.text import shown
from hypernode.installation import needs

#: Endings of such files.
SUFFIXES = {".npz", ".h5", ".hdf5", ".mat"}
#: Names by what an array holds; those of the configuration come before them.
NAMES = {
    "positions": ("DIC_X", "positions", "X", "coordinates"),
    "displacements": ("DIC_disp", "displacements", "U", "disp"),
    "force": ("instron_force", "force", "F"),
}
_HDF5 = b"\x89HDF\r\n\x1a\n"


def arrays_in(path: Path) -> dict[str, np.ndarray]:
    """The numeric arrays of a file by their names; of MATLAB 7.3 and HDF5 those at the top.

    Raises:
        DicError: it cannot be read, or what reads it is not installed.
    """
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
    except (OSError, ValueError, KeyError, TypeError, NotImplementedError, EOFError) as error:
        raise DicError(f"{path}: cannot be read as arrays: {error}") from None


def _of_hdf5(path: Path) -> dict[str, np.ndarray]:
    try:
        import h5py
    except ImportError:
        raise DicError(f"{path}: is a file of HDF5, and {needs('h5py')}") from None
    turned = path.suffix.lower() == ".mat"
    with h5py.File(path, "r") as file:
        found = {k: np.array(v) for k, v in file.items() if isinstance(v, h5py.Dataset) and v.dtype.kind in "fiu"}
    # MATLAB writes its columns first.
    return {name: each.T if turned else each for name, each in found.items()}


def holds_frames(path: Path, names: Mapping[str, str | None]) -> bool:
    """Whether a file has positions and displacements under known names."""
    try:
        arrays = arrays_in(path)
    except DicError:
        return False
    return all(_named(arrays, role, names) is not None for role in ("positions", "displacements"))


def frames_of_arrays(path: Path, dialect: Dialect) -> dict[int, Points]:
    """Frames of a file of arrays, numbered from 0 on.

    Raises:
        DicError: an array is absent, or of a shape that does not fit the others.
    """
    arrays = arrays_in(path)
    position = _array(path, arrays, "positions", dialect.arrays)
    displacement = _array(path, arrays, "displacements", dialect.arrays)
    position = np.squeeze(position)
    position = position.T if position.ndim == 2 and position.shape[0] == 2 != position.shape[1] else position
    if position.ndim != 2 or position.shape[1] != 2:
        raise DicError(f"{path}: positions of shape {position.shape}: store them as (point, 2)")
    u = _in_order(path, displacement, len(position))
    forces = _named(arrays, "force", dialect.arrays)
    force = None if forces is None else np.ravel(arrays[forces]).astype(float)
    if force is not None and len(force) != len(u):
        raise DicError(f"{path}: {len(force)} forces {forces!r} of {len(u)} frames: store one a frame")
    line = np.arange(1, len(position) + 1)
    frames = {}
    for number, each in enumerate(u):
        cells = dict(zip("xyuv", (*position.T.astype(float), *each.T), strict=True))
        points = points_from(path, cells, line, dict.fromkeys("xyuv", ""), [], dialect)
        known = None if force is None else float(force[number])
        frames[number] = Points(path, points.position, points.displacement, points.line, points.unit, None, known)
    return frames


def _named(arrays: Mapping[str, np.ndarray], role: str, names: Mapping[str, str | None]) -> str | None:
    wanted = (names[role],) if names.get(role) else NAMES[role]
    return next((name for name in wanted if name in arrays), None)


def _array(path: Path, arrays: Mapping[str, np.ndarray], role: str, names: Mapping[str, str | None]) -> np.ndarray:
    name = _named(arrays, role, names)
    if name is None:
        raise DicError(
            f"{path}: no array of {role} among {shown(sorted(arrays))}: name it (--set 'arrays={{{role}: NAME}}')"
        )
    return arrays[name]


def _in_order(path: Path, u: np.ndarray, points: int) -> np.ndarray:
    """Displacements as (frame, point, 2), whichever order of axes they are stored in."""
    u = u[None] if u.ndim == 2 else u
    orders = [
        order
        for order in ((0, 1, 2), (2, 0, 1), (1, 0, 2), (0, 2, 1), (2, 1, 0), (1, 2, 0))
        if u.ndim == 3 and (u.shape[order[1]], u.shape[order[2]]) == (points, 2)
    ]
    if not orders or u.shape[orders[0][0]] < 2:
        raise DicError(f"{path}: displacements of shape {u.shape} for {points} points: store them as (frame, point, 2)")
    return np.transpose(u, orders[0]).astype(float)
