"""A series as files of the declared table, which read back to the same numbers."""

from pathlib import Path

import numpy as np

from hypernode.dic.series import Series


def write_series(series: Series, folder: Path, name: str = "frame") -> list[Path]:
    """Write one file a frame, columns x, y, u, v with their unit, y upward, ``nan`` where lost.

    Returns:
        The files, in order.
    """
    folder.mkdir(parents=True, exist_ok=True)
    positions = np.stack(np.meshgrid(series.x, series.y), axis=-1).reshape(-1, 2)
    header = ",".join(f"{column} [{series.unit}]" for column in "xyuv")
    paths = []
    for frame in series.frames:
        rows = np.column_stack([positions, frame.displacement.reshape(-1, 2)]).tolist()
        paths.append(folder / f"{name}{frame.number:04d}.csv")
        paths[-1].write_text("\n".join([header, *(",".join(map(repr, row)) for row in rows)]) + "\n")
    return paths
