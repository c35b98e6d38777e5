"""Which points of a file of arrays are of another material, as its array of labels says."""

from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import cKDTree

from hypernode.dic.array_files import arrays_in
from hypernode.dic.arrays import NAMES, named, positions_in
from hypernode.dic.errors import DicError
from hypernode.dic.text import shown


def labels_of(arrays: Mapping[str, np.ndarray], name: str, points: int) -> Int[np.ndarray, " point"] | None:
    """The kind of material of every point, numbered from 0; None where an array has not one label a point."""
    values = np.ravel(arrays[name])
    kinds = np.unique(values)
    if len(values) != points or not 1 < len(kinds) < points:
        return None
    return np.searchsorted(kinds, values)


def said_of_labels(path: Path, arrays: Mapping[str, np.ndarray], names: Mapping[str, str | None], points: int) -> str:
    """What may be done with the labels of a file, in a sentence; empty where it has none."""
    name = named(arrays, "label", names)
    if name is None:
        return ""
    labels = labels_of(arrays, name, points)
    if labels is None:
        return f"{path.name}: {name!r} does not tell points of one material from those of another, and is not used"
    return (
        f"{path.name}: {name!r} names {labels.max() + 1} kinds of material. The identification does not look at it; "
        f"shape_image: {path.name}, with its folder, compares the identified shape with it"
    )


def labelled_shape(
    path: Path, names: Mapping[str, str | None], y_up: bool
) -> Callable[[Float[np.ndarray, "point 2"]], Float[np.ndarray, " point"]]:
    """Points of the unit square -> 1 where the nearest measured point is of another material than most of the rim.

    Args:
        path: of arrays with positions and labels.
        names: of its arrays, where they are not the usual ones.
        y_up: whether y of the positions points upward.

    Raises:
        DicError: it has no positions, or no label of every point.
    """
    arrays = arrays_in(path)
    position = positions_in(path, arrays, names).reshape(-1, 2)
    name = named(arrays, "label", names)
    labels = None if name is None else labels_of(arrays, name, len(position))
    if labels is None:
        raise DicError(
            f"{path}: no array with a label of every point among {shown(sorted(arrays))}; known names are "
            f"{shown(NAMES['label'])}: store one, or name an image, shape_image"
        )
    at = (position - position.min(axis=0)) / np.ptp(position, axis=0)
    if not y_up:
        at[:, 1] = 1.0 - at[:, 1]
    rim = np.abs(at - 0.5).max(axis=1) > 0.5 - 1e-9
    matrix = np.bincount(labels[rim]).argmax()
    inside, tree = (labels != matrix).astype(float), cKDTree(at)
    return lambda X: inside[tree.query(X)[1]]
