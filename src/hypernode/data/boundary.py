"""What noisy measurements say of the displacement of prescribed edges, and how wrong that may be.

The displacement of an edge is smooth, so that its measured values are smoothed. The whole sheet follows the noise that
is left. A rigid edge of 50 nodes is known to a fifth of the noise of one node. An error of that size is shared by the
sheet, and weighs as much as thousands of independent errors.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from hypernode.data.lost import along
from hypernode.data.smoothing import smoothed
from hypernode.fem.mesh import EDGES, Mesh

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
