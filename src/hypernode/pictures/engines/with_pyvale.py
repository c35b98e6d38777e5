"""Follows points through the pictures of a folder with pyvale: `python with_pyvale.py FOLDER`.

Takes pictures.npy (frame, row, column), mask.npy (row, column) and settings.json. Leaves correlated.npz with column,
row (point,), displacement (frame, point, 2) in pixels, columns to the right and rows down, NaN where lost. Its
correlation (frame, point) is the zero-normalised cross-correlation.
"""

import json
import sys
from pathlib import Path

import numpy as np
import pyvale.dic as dic
from scipy.ndimage import distance_transform_edt

SHAPES = {"affine": "AFFINE", "quadratic": "QUAD"}
#: Change of the parameters below which a subset is at rest; at ten times more, quadratic subsets stop early.
PRECISION = 1e-4
#: First subsets that are tried one after the other: where one or its neighbours are lost in any picture, pyvale ends.
SEEDS = 10
#: Quadratic subsets take up to 40 of them on clean pictures, pyvale's own limit.
ITERATIONS = 100


def seeds(mask, subset: int):
    """Column and row of pixels where the first subset may be compared: each farthest from the mask's edge and from
    the ones before."""
    left = np.pad(mask, 1)
    half = subset // 2
    rows, columns = mask.shape
    for _ in range(SEEDS):
        distance = distance_transform_edt(left)
        row, column = np.unravel_index(np.argmax(distance), left.shape)
        if distance[row, column] <= half:
            return
        yield [int(np.clip(column - 1, half, columns - 1 - half)), int(np.clip(row - 1, half, rows - 1 - half))]
        left[row, column] = False


def compare(pictures, mask, seed: list[int], settings: dict, results: Path) -> None:
    """Let pyvale leave a file of points for every picture after the first."""
    dic.calculate_2d(
        pictures[0],
        pictures[1:],
        mask,
        seed,
        subset_size=settings["subset"],
        subset_step=settings["step"],
        shape_function=SHAPES[settings["shape"]],
        precision=PRECISION,
        max_iterations=ITERATIONS,
        max_displacement=settings["reach"],
        incremental_update="IMAGE" if settings["incremental"] else "OFF",
        num_threads=settings["threads"],
        output_basepath=results,
        print_level=0,
    )


def follow(folder: Path) -> dict:
    """The points of every picture after the first, as pyvale finds them."""
    pictures = np.load(folder / "pictures.npy")
    mask = np.load(folder / "mask.npy")
    settings = json.loads((folder / "settings.json").read_text())
    tried = list(seeds(mask, settings["subset"]))
    if not tried:
        raise ValueError("no subset lies within the mask")
    for k, seed in enumerate(tried):
        results = folder / f"seed_{k}"
        results.mkdir()
        try:
            compare(pictures, mask, seed, settings, results)
            break
        except RuntimeError:
            if k + 1 == len(tried):
                raise
    found = dic.import_2d(str(results / "*.csv"), delimiter=",", layout="column", print_level=0)
    displacement = np.stack([found.u_px, found.v_px], axis=-1)
    displacement[~found.converged.astype(bool)] = np.nan
    return {
        "column": found.ss_x,
        "row": found.ss_y,
        "displacement": displacement,
        "correlation": found.cost,
    }


if __name__ == "__main__":
    FOLDER = Path(sys.argv[1])
    np.savez(FOLDER / "correlated.npz", **follow(FOLDER))
