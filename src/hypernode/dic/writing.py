"""A test as files of the declared table and a record of named columns, which read back to the same numbers."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from jaxtyping import Float

from hypernode.dic.series import Series


def write_series(series: Series, folder: Path, name: str = "frame") -> list[Path]:
    """Write one file a frame: columns x, y, u, v with their unit, y upward. Lost displacements are empty cells.

    Returns:
        The files, in order.
    """
    folder.mkdir(parents=True, exist_ok=True)
    positions = np.stack(np.meshgrid(series.x, series.y), axis=-1).reshape(-1, 2)
    header = [f"{column} [{series.unit}]" for column in "xyuv"]
    paths = []
    for frame in series.frames:
        paths.append(folder / f"{name}{frame.number:04d}.csv")
        _write(paths[-1], [header], np.column_stack([positions, frame.displacement.reshape(-1, 2)]))
    return paths


def write_force_record(
    path: Path,
    time: Float[np.ndarray, " sample"],
    displacement: Mapping[str, Float[np.ndarray, " sample"]],
    force: Mapping[str, Float[np.ndarray, " sample"]],
) -> None:
    """Write a record of columns Time [s], Displacement [mm] and Force [N].

    Args:
        path: of the file.
        time: of every sample.
        displacement, force: by axis, "x" or "y", which stands behind the columns' names where there are two of them.
    """
    mark = {axis: f" {axis}" if len(force) > 1 else "" for axis in force}
    names = ["Time", *(f"Displacement{mark[axis]}" for axis in force), *(f"Force{mark[axis]}" for axis in force)]
    units = ["(s)", *("(mm)" for _ in force), *("(N)" for _ in force)]
    columns = [time, *(displacement[axis] for axis in force), *force.values()]
    _write(path, [[f'"{cell}"' for cell in row] for row in (names, units)], np.column_stack(columns))


def _write(path: Path, head: list[list[str]], table: Float[np.ndarray, "row column"]) -> None:
    """Every number with all the digits that it takes to read the same bits; none where there is no number."""
    rows = [[repr(value) if value == value else "" for value in row] for row in table.tolist()]
    path.write_text("\n".join([*map(",".join, [*head, *rows]), ""]))
