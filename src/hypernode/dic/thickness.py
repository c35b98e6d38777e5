"""The thickness of a sheet from place to place, as a table of positions."""

from pathlib import Path

import numpy as np
from jaxtyping import Float
from scipy.interpolate import LinearNDInterpolator, NearestNDInterpolator
from scipy.spatial import QhullError

from hypernode.dic.errors import DicError
from hypernode.dic.text import read_text

#: Header of the table: lengths in mm, positions from the lower left corner of the measured field.
HEADER = ("x", "y", "thickness")


def thickness_at(path: Path, X: Float[np.ndarray, "point 2"]) -> Float[np.ndarray, " point"]:
    """Thickness [mm] at positions [mm]: linear between the points of the table, that of the nearest one outside.

    Raises:
        DicError: the file cannot be read, is no such table, or a thickness is not positive.
    """
    rows = [line.split(",") for line in read_text(path).splitlines() if line.strip()]
    if not rows or tuple(cell.split("[")[0].strip().lower() for cell in rows[0]) != HEADER:
        raise DicError(f"{path}:1: a map of the thickness has the columns x,y,thickness, all in mm")
    values = []
    for number, row in enumerate(rows[1:], start=2):
        try:
            values.append([float(cell) for cell in row])
        except ValueError:
            raise DicError(f"{path}:{number}: not a number in {','.join(row)[:60]!r}") from None
        if len(row) != len(HEADER) or not np.isfinite(values[-1]).all() or values[-1][2] <= 0.0:
            raise DicError(f"{path}:{number}: needs a position and a positive thickness, found {','.join(row)[:60]!r}")
    table = np.array(values).reshape(-1, len(HEADER))
    try:
        inside = LinearNDInterpolator(table[:, :2], table[:, 2])(X)
    except (QhullError, ValueError):
        raise DicError(f"{path}: {len(table)} points on a line or fewer than three: no map") from None
    return np.where(np.isfinite(inside), inside, NearestNDInterpolator(table[:, :2], table[:, 2])(X))
