"""A folder to practise with, as a laboratory would bring it."""

from pathlib import Path

import numpy as np

from hypernode.dic.errors import DicError
from hypernode.dic.series import Frame, Series
from hypernode.dic.writing import write_force_record, write_series
from hypernode.synthetic.practice import practice_test


def run(folder: Path, kind: str, noise: float, seed: int) -> Path:
    """Write FOLDER/frame<number>.csv in mm and FOLDER/force_disp.csv; frames are a second apart.

    Args:
        folder: a new folder.
        kind: of load.
        noise: standard deviation of a measured displacement [mm].
        seed: of the noise.

    Returns:
        The folder.

    Raises:
        DicError: the folder holds something already.
    """
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise DicError(f"{folder}: holds something already: name a new folder")
    test = practice_test(kind, noise, seed)
    frames = [Frame(number, displacement) for number, displacement in enumerate(test.displacement)]
    write_series(Series(test.lines, test.lines, frames, unit="mm"), folder)
    write_force_record(folder / "force_disp.csv", np.arange(float(len(frames))), test.moved, test.force)
    return folder
