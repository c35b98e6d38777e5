"""Files of arrays, npz, HDF5 or MATLAB, as numeric arrays by their names."""

import warnings
import zipfile
from collections import Counter
from collections.abc import Iterable, Mapping
from itertools import product
from pathlib import Path

import numpy as np

from hypernode.dic.errors import DicError

#: Endings of such files.
SUFFIXES = {".npz", ".h5", ".hdf5", ".mat"}
#: Names of arrays that hold one component each.
COMPONENTS = {
    "positions": (("x", "y"), ("X", "Y")),
    "displacements": (("u", "v"), ("U", "V"), ("ux", "uy"), ("Ux", "Uy"), ("UX", "UY")),
}
_HDF5 = b"\x89HDF\r\n\x1a\n"
#: What readers of such files raise where one is broken.
_BROKEN = (OSError, ValueError, KeyError, TypeError, NotImplementedError, EOFError, RuntimeError, zipfile.BadZipFile)


def arrays_in(path: Path) -> dict[str, np.ndarray]:
    """The numeric arrays of a file by their names; of MATLAB and HDF5 those of structures and groups as well.

    Where several structures hold an array of one name, each is ``structure/field``. One array of each component, as
    ``x`` and ``y``, or ``u`` and ``v``, becomes one of both, named by both. Where x and y are the lines of a grid, it
    holds their points (row, column, 2).

    Raises:
        DicError: it cannot be read.
    """
    arrays = _arrays_in(path)
    places = sorted({path[: path.rfind("/") + 1] for path in arrays})
    pairs = [(role, letters) for role, several in COMPONENTS.items() for letters in several]
    for at, (role, letters) in product(places, pairs):
        pair = tuple(at + letter for letter in letters)
        first, second = (arrays.get(name) for name in pair)
        if first is None or second is None:
            continue
        beside = [each for name, each in arrays.items() if name.startswith(at)]
        if role == "positions" and _are_lines(first, second, beside):
            first, second = np.meshgrid(np.ravel(first), np.ravel(second))
        if first.shape == second.shape:
            arrays[" ".join(pair)] = np.stack([first, second], axis=-1)
    return arrays


def _are_lines(x: np.ndarray, y: np.ndarray, others: Iterable[np.ndarray]) -> bool:
    """Whether x and y are those of the lines of a grid, and not of every point.

    Then none has a value twice, and an array beside them has both axes.
    """
    if any(len(np.unique(each)) < each.size for each in (x, y)):
        return False
    beside = [list(each.shape) for each in others if each is not x and each is not y]
    return any(x.size in each and y.size in each and (x.size != y.size or each.count(x.size) > 1) for each in beside)


def _arrays_in(path: Path) -> dict[str, np.ndarray]:
    try:
        if path.suffix.lower() == ".npz":
            with np.load(path, allow_pickle=False) as file:
                return {name: file[name] for name in file.files if file[name].dtype.kind in "fiu"}
        with open(path, "rb") as handle:
            start = handle.read(520)
        if _HDF5 in (start[:8], start[512:520]):
            return _of_hdf5(path)
        return _of_matlab(path)
    except _BROKEN as error:
        objects = "pickle" in str(error)
        why = "it holds objects of Python: store arrays of numbers, one of each kind" if objects else error
        raise DicError(f"{path}: cannot be read as arrays: {why}") from None


def _of_matlab(path: Path) -> dict[str, np.ndarray]:
    import scipy.io

    try:
        with warnings.catch_warnings():
            # What it reads then is no measurement.
            warnings.filterwarnings("error", message=".*may be corrupt")
            return _by_names(_of_structures(scipy.io.loadmat(path)))
    except (scipy.io.matlab.MatReadError, UserWarning) as error:
        raise ValueError(str(error)) from None


def _of_structures(values: Mapping[str, object], at: str = "", depth: int = 3) -> dict[str, np.ndarray]:
    """Numeric arrays of a MATLAB file, and those in its structures, as ``structure/field``."""
    found = {}
    for name, value in values.items():
        if not isinstance(value, np.ndarray):
            continue
        if value.dtype.kind in "fiu":
            found[at + name] = value
        elif value.dtype.names and value.size == 1 and depth:
            fields = {each: value[each].item() for each in value.dtype.names}
            found |= _of_structures(fields, f"{at}{name}/", depth - 1)
    return found


def _by_names(found: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Arrays by their own names; where several structures hold one of a name, each keeps that of its structure."""
    owners = Counter(path.rpartition("/")[2] for path in found)
    return {path if owners[name := path.rpartition("/")[2]] > 1 else name: each for path, each in found.items()}


def _of_hdf5(path: Path) -> dict[str, np.ndarray]:
    import netCDF4

    found: dict[str, np.ndarray] = {}
    with netCDF4.Dataset(path) as file:
        file.set_auto_maskandscale(False)
        groups = [("", file)]
        while groups:
            at, group = groups.pop(0)
            groups += [(f"{at}{name}/", inner) for name, inner in group.groups.items()]
            for name, variable in group.variables.items():
                if isinstance(variable.dtype, np.dtype) and variable.dtype.kind in "fiu":
                    # What stands in a group has its own name, unless another has it already.
                    found[f"{at}{name}" if name in found else name] = np.array(variable[...])
    # MATLAB writes its columns first.
    return {name: each.T if path.suffix.lower() == ".mat" else each for name, each in found.items()}
