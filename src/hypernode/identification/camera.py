"""A displacement field as a camera sees it: averaged or fitted over a correlation window at every node."""

import numpy as np
import scipy.sparse
from scipy.interpolate import make_interp_spline

from hypernode.fem.mesh import Mesh

#: Place of the two points of Gauss, which integrate what is linear times quadratic exactly.
_GAUSS = 1.0 / np.sqrt(3.0)


def line_average(x: np.ndarray, width: float) -> scipy.sparse.csr_matrix:
    """Average of the piecewise linear interpolant of node values over ``width`` around every node.

    Beyond the ends the interpolant is continued antisymmetrically, so a linear field is reproduced.

    Args:
        x: increasing coordinates (node,).
        width: side of the window, at most the length of the line.

    Returns:
        Matrix (node, node).
    """
    half = min(0.5 * width, 0.5 * (x[-1] - x[0]))
    points, continued = _continued(x)
    integral = make_interp_spline(points, continued, k=1).antiderivative()
    average = (integral(x + half) - integral(x - half)) / (2.0 * half)
    average[np.abs(average) < 1e-12] = 0.0
    return scipy.sparse.csr_matrix(average)


def line_quadratic(x: np.ndarray, width: float) -> scipy.sparse.csr_matrix:
    """Middle of the quadratic that fits the piecewise linear interpolant best over ``width`` around every node.

    This is the filter of Savitzky and Golay (Analytical Chemistry 36, 1964) of second order. It is the mean of the
    interpolant times (9 - 15 t^2) / 4, with t from -1 to 1 over the window. Continued and returned as
    :func:`line_average` does.
    """
    half = min(0.5 * width, 0.5 * (x[-1] - x[0]))
    points, continued = _continued(x)
    filtered = np.zeros((len(x), len(points)))
    for row, middle in zip(filtered, x, strict=True):
        within = points[(points > middle - half) & (points < middle + half)]
        ends = np.concatenate([[middle - half], within, [middle + half]])
        centre, reach = 0.5 * (ends[1:] + ends[:-1]), 0.5 * np.diff(ends)
        for side in (-1.0, 1.0):
            at = centre + side * reach * _GAUSS
            weight = reach / (2.0 * half) * (9.0 - 15.0 * ((at - middle) / half) ** 2) / 4.0
            left = np.clip(np.searchsorted(points, at) - 1, 0, len(points) - 2)
            share = (at - points[left]) / (points[left + 1] - points[left])
            np.add.at(row, left, weight * (1.0 - share))
            np.add.at(row, left + 1, weight * share)
    filtered = filtered @ continued
    filtered[np.abs(filtered) < 1e-12] = 0.0
    return scipy.sparse.csr_matrix(filtered)


def _continued(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(the line and its mirror images beyond both ends, antisymmetric values there as a matrix of those at nodes)."""
    unit = np.eye(len(x))
    points = np.concatenate([2.0 * x[0] - x[:0:-1], x, 2.0 * x[-1] - x[-2::-1]])
    return points, np.concatenate([2.0 * unit[0] - unit[:0:-1], unit, 2.0 * unit[-1] - unit[-2::-1]])


def window_average(mesh: Mesh, width: float, kernel: str = "average") -> scipy.sparse.csr_matrix:
    """Matrix from nodal displacements, flattened (node, i), to those seen through the window. A node whose window
    contains a lost point or a hole is not averaged.

    Args:
        width: side of the window; 0 means no averaging.
        kernel: ``average``, or ``quadratic`` for the middle of 1, x, y, x^2, x y, y^2 fitted over the window.
    """
    if width == 0.0:
        return scipy.sparse.identity(mesh.nodes.size, format="csr")
    x, y = mesh.lines
    along_x, along_y = line_average(x, width), line_average(y, width)
    whole = scipy.sparse.kron(along_y, along_x, format="csr")
    if kernel == "quadratic":
        # The fit's quadratic terms are orthogonal over the square: each direction adds its own to the average.
        more_x, more_y = line_quadratic(x, width) - along_x, line_quadratic(y, width) - along_y
        whole = (whole + scipy.sparse.kron(along_y, more_x) + scipy.sparse.kron(more_y, along_x)).tocsr()
    place = mesh.places
    present = np.zeros(whole.shape[0])
    present[place] = 1.0
    complete = np.asarray((abs(whole) @ (1.0 - present)) == 0.0)[place]
    average = scipy.sparse.diags(complete.astype(float)) @ whole[place][:, place]
    average += scipy.sparse.diags(1.0 - complete)
    return scipy.sparse.kron(average, scipy.sparse.identity(2), format="csr")
