"""What a camera makes of a displacement field: the average over its correlation window, at every node."""

import numpy as np
import scipy.sparse
from scipy.interpolate import make_interp_spline

from hypernode.fem.mesh import Mesh


def line_average(x: np.ndarray, width: float) -> scipy.sparse.csr_matrix:
    """Average of the piecewise linear interpolant of node values over ``width`` around every node.

    Beyond the ends the interpolant goes on antisymmetrically, so that a linear field stays what it is.

    Args:
        x: increasing coordinates (node,).
        width: side of the window, at most the length of the line.

    Returns:
        Matrix (node, node).
    """
    half = min(0.5 * width, 0.5 * (x[-1] - x[0]))
    unit = np.eye(len(x))
    points = np.concatenate([2.0 * x[0] - x[:0:-1], x, 2.0 * x[-1] - x[-2::-1]])
    continued = np.concatenate([2.0 * unit[0] - unit[:0:-1], unit, 2.0 * unit[-1] - unit[-2::-1]])
    integral = make_interp_spline(points, continued, k=1).antiderivative()
    average = (integral(x + half) - integral(x - half)) / (2.0 * half)
    average[np.abs(average) < 1e-12] = 0.0
    return scipy.sparse.csr_matrix(average)


def window_average(mesh: Mesh, width: float) -> scipy.sparse.csr_matrix:
    """Matrix that takes nodal displacements, flattened (node, i), to what is seen through the window.

    Where the window holds a grid point that was lost, or a hole, the node is taken as it is.
    """
    if width == 0.0:
        return scipy.sparse.identity(mesh.nodes.size, format="csr")
    x, y = mesh.lines
    whole = scipy.sparse.kron(line_average(y, width), line_average(x, width), format="csr")
    place = mesh.places
    present = np.zeros(whole.shape[0])
    present[place] = 1.0
    complete = np.asarray((whole @ (1.0 - present)) == 0.0)[place]
    average = scipy.sparse.diags(complete.astype(float)) @ whole[place][:, place]
    average += scipy.sparse.diags(1.0 - complete)
    return scipy.sparse.kron(average, scipy.sparse.identity(2), format="csr")
