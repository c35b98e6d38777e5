"""What the drawn shape with the true materials scores on the grid of a camera, beside what was identified.

    python benchmarks/drawn_shape.py [CASE ...]

The truth of a synthetic sheet is one material or another in every finite element. A camera has other cells. The shape
as it was drawn, with both true materials, is the best that lines can be. What it misses is the difference of two grids.
Run it in a folder where ``make`` has been.
"""

import json
import sys
from pathlib import Path

import numpy as np
import xarray as xr

from hypernode.config.loading import load_config
from hypernode.data.measurement import mesh_of
from hypernode.evaluation.scores import relative_error
from hypernode.storage.netcdf import read
from hypernode.synthetic.geometry import make_shape

CASES = ("X_camera", "ring_camera", "P_camera_low")


def error_of(inside, evaluation: xr.Dataset) -> tuple[float, int]:
    """(stress error of a shape with the true materials in all modes, how many cells are on its wrong side).

    Args:
        inside: whether every cell is in the inclusion (cell,).
    """
    areas, true = mesh_of(evaluation).areas, evaluation["phase"].values > 0
    P = evaluation["P_true"].values
    # Under a common deformation all cells of a material have one stress.
    found = P.copy()
    for phase in (False, True):
        found[:, :, inside == phase] = P[:, :, true == phase].mean(axis=2, keepdims=True)
    return relative_error(found, P, areas), int((inside != true).sum())


def main():
    """Print both for every case."""
    config = load_config("config/config.yaml")
    for name in sys.argv[1:] or CASES:
        evaluation = read(Path("results") / name / "hypernode" / "evaluation.nc")
        case, mesh = config.cases[name], mesh_of(evaluation)
        centres = mesh.nodes[mesh.cells].mean(axis=1) / np.array(case.size)
        drawn = make_shape(config.geometries[case.geometry])(centres) > 0.5
        error, cells = error_of(drawn, evaluation)
        own = json.loads(evaluation.attrs["summary"])["stress_error_all_modes"]
        wrong = int(((evaluation["shape"].values > 0.5) != (evaluation["phase"].values > 0)).sum())
        print(f"{name}: drawn shape {error:.4f}, {cells} cells; identified {own:.4f}, {wrong} cells")


if __name__ == "__main__":
    main()
