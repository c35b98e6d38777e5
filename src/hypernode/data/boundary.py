"""What noisy measurements say of the displacement of prescribed edges, and how wrong that may be.

The displacement of an edge is smooth, so that its measured values are smoothed. The whole sheet follows the noise that
is left. A rigid edge of 50 nodes is known to a fifth of the noise of one node. An error of that size is shared by the
sheet, and weighs as much as thousands of independent errors.
"""

import functools
from dataclasses import dataclass

import numpy as np
import scipy.linalg
from jaxtyping import Bool, Float
from scipy.optimize import minimize_scalar

from hypernode.data.lost import along
from hypernode.fem.mesh import EDGES, Mesh

#: Bounds of the roughness's weight, over those at which the smoothest and the roughest mode are halved.
WEIGHTS = 1e-4, 1e4
#: Errors of a mode that are below this share of the noise are left out.
SMALLEST_ERROR = 0.1
#: Share of an edge's points that must be measured: what it does is read from them, and it should not be guessed.
LEAST_MEASURED = 0.5


@dataclass(frozen=True)
class PrescribedDisplacement:
    """Prescribed displacements of one load step.

    Attributes:
        mask: which components of which nodes are prescribed.
        values: their displacement, 0 elsewhere.
        errors: matrix (degree of freedom, mode), by which independent standard normal numbers become the errors of
            ``values``.
    """

    mask: Bool[np.ndarray, "node 2"]
    values: Float[np.ndarray, "node 2"]
    errors: Float[np.ndarray, "dof mode"]


def roughness(x: Float[np.ndarray, " point"]) -> Float[np.ndarray, "point point"]:
    """Matrix of the integral of the squared second derivative of the natural cubic spline through values at ``x``.

    Q R^-1 Q^T of Green and Silverman, Nonparametric Regression and Generalized Linear Models (1994), section 2.1.
    """
    h = np.diff(x)
    n = len(x)
    Q, R = np.zeros((n, n - 2)), np.zeros((n - 2, n - 2))
    inner = np.arange(n - 2)
    Q[inner, inner], Q[inner + 1, inner], Q[inner + 2, inner] = 1 / h[:-1], -1 / h[:-1] - 1 / h[1:], 1 / h[1:]
    R[inner, inner] = (h[:-1] + h[1:]) / 3
    R[inner[:-1], inner[1:]] = R[inner[1:], inner[:-1]] = h[1:-1] / 6
    return Q @ scipy.linalg.solve(R, Q.T, assume_a="pos")


@functools.cache
def _modes(x: tuple[float, ...]):
    """(roughness, shape) of the modes of an edge, smoothest first: every step and component has the same."""
    bending, modes = np.linalg.eigh(roughness(np.array(x)))
    # Straight lines are not bent at all.
    bending[:2] = 0.0
    return bending, modes


def smoothed(x: Float[np.ndarray, " point"], values: Float[np.ndarray, " point"], noise: float):
    """The smoothing spline of noisy values along an edge, with the weight of roughness under which they are likeliest.

    It is the posterior mean, if curves are the likelier the less they are bent (Wahba, Spline Models for Observational
    Data, 1990). ``errors`` are the root of the posterior covariance.

    Args:
        x: increasing positions.
        noise: standard deviation of the values.

    Returns:
        (values (point,), errors (point, mode)).
    """
    if noise == 0.0 or len(x) < 3:
        errors = noise * np.eye(len(x))
        return values, errors[:, errors.any(axis=0)]
    bending, modes = _modes(tuple(x))
    amounts = modes.T @ values
    bent, observed = bending[2:], (amounts[2:] / noise) ** 2

    def unlikely(log_weight):
        signal = 1.0 + 1.0 / (np.exp(log_weight) * bent)
        return np.sum(np.log(signal) + observed / signal)

    bounds = np.log([WEIGHTS[0] / bent[-1], WEIGHTS[1] / bent[0]])
    # The likelihood may have more than one peak: the highest on a grid, then its top.
    grid = np.linspace(*bounds, 41)
    best = np.argmin([unlikely(w) for w in grid])
    around = grid[max(best - 1, 0)], grid[min(best + 1, 40)]
    weight = np.exp(minimize_scalar(unlikely, bounds=around, method="bounded").x)
    share = 1.0 / (1.0 + weight * bending)
    kept = share > SMALLEST_ERROR**2
    return modes @ (share * amounts), noise * modes[:, kept] * np.sqrt(share[kept])


def _smoothed_edge(edge: str, x: Float[np.ndarray, " point"], u: Float[np.ndarray, " point"], noise: float):
    """:func:`smoothed` of an edge's measured points, and what they say of the lost ones between and beside them."""
    known = np.isfinite(u)
    if known.all():
        return smoothed(x, u, noise)
    if known.sum() < max(2, LEAST_MEASURED * len(x)):
        raise ValueError(
            f"of the {edge} edge of the grid only {known.sum()} of {len(x)} points are measured, too few to prescribe "
            "its displacement: drop more of the outermost points (edge_ring)"
        )
    values, modes = smoothed(x[known], u[known], noise)
    between = along(x, x[known])
    return between @ values, between @ modes


def prescribed_displacement(
    mesh: Mesh,
    u: Float[np.ndarray, "node 2"],
    prescribed: Float[np.ndarray, "edge 2"],
    noise: Float[np.ndarray, " 2"],
) -> PrescribedDisplacement:
    """Prescribed displacements: the measured ones on every prescribed edge, smoothed along it.

    Where two prescribed edges meet, their mean. Lost points of an edge, NaN, move as their neighbours along it say.

    Args:
        prescribed: which components of which edges are prescribed.
        noise: standard deviation of the components of ``u``.

    Raises:
        ValueError: of an edge less is measured than :data:`LEAST_MEASURED`.
    """
    total, count, errors = np.zeros_like(u), np.zeros_like(u), []
    for index, (edge, (axis, _)) in enumerate(EDGES.items()):
        on = np.flatnonzero(mesh.on_edge(edge))
        on = on[np.argsort(mesh.nodes[on, 1 - axis])]
        for i in np.flatnonzero(prescribed[index]):
            values, modes = _smoothed_edge(edge, mesh.nodes[on, 1 - axis], u[on, i], noise[i])
            total[on, i] += values
            count[on, i] += 1
            spread = np.zeros((*u.shape, modes.shape[1]))
            spread[on, i] = modes
            errors.append(spread)
    share = 1.0 / np.maximum(count, 1)
    every = np.concatenate([np.zeros((*u.shape, 0)), *errors], axis=2) * share[:, :, None]
    return PrescribedDisplacement(count > 0, total * share, every.reshape(u.size, -1))
