"""What cameras would see of a synthetic test: their own grid, the average over a window."""

import numpy as np
from scipy.interpolate import RectBivariateSpline
from scipy.ndimage import uniform_filter1d

from hypernode.config.synthetic import Camera
from hypernode.fem.mesh import Mesh, rectilinear

#: Points a measured cell at which the displacement is averaged.
FINE = 16


def observed_by(camera: Camera, mesh: Mesh, u):
    """The displacement on the camera's own grid: averaged over its window, then sampled.

    Args:
        mesh: finite-element mesh of a sheet without holes.
        u: nodal displacements (step, node, 2).

    Returns:
        (mesh of the measured grid, displacements on it).
    """
    x, y = mesh.lines
    fine = [np.linspace(line[0], line[-1], FINE * n + 1) for line, n in zip((x, y), camera.cells, strict=True)]
    lines = [line[::FINE] for line in fine]
    widths = [max(1, round(camera.window / (line[1] - line[0]))) for line in fine]
    observed = np.empty((len(u), len(lines[1]) * len(lines[0]), 2))
    for step, field in enumerate(u):
        for i in range(2):
            values = RectBivariateSpline(y, x, field[:, i].reshape(len(y), len(x)), kx=1, ky=1)
            rows = _averaged(values(fine[1], fine[0]), widths[1], 0)[::FINE]
            observed[step, :, i] = _averaged(rows, widths[0], 1)[:, ::FINE].ravel()
    return rectilinear(*lines), observed


def _averaged(values, width: int, axis: int):
    """Moving average; beyond the edge the field goes on antisymmetrically, so that a linear one stays."""
    half = width // 2
    if half == 0:
        return values
    padding = [(half, half) if k == axis else (0, 0) for k in range(2)]
    padded = np.pad(values, padding, mode="reflect", reflect_type="odd")
    cut = [slice(half, -half) if k == axis else slice(None) for k in range(2)]
    return uniform_filter1d(padded, 2 * half + 1, axis=axis)[tuple(cut)]
