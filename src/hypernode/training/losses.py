"""What training of the hyper-network minimises: equilibrium of the stress, edge forces, variation."""

from collections.abc import Callable
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np

from hypernode.config.methods import Training
from hypernode.fem.gradient import mean_gradient
from hypernode.fem.nodal_forces import nodal_force_matrices
from hypernode.material.laws import node_stress
from hypernode.training.interpolant import InterpolatedGradient
from hypernode.training.outline import TRACTIONS, mean_tractions
from hypernode.training.problem import InverseProblem

#: Relative jumps of the stress below this size are smoothed rather than counted, as those of a constrained field.
SMALLEST_JUMP = 0.02
#: Divergences below this size, in stress over the length of the sheet, cost their square where larger ones cost
#: themselves.
SMALLEST_RESIDUAL = 0.1
#: Collocation points of the pointwise strong form in one iteration, where the config says nothing.
DEFAULT_POINTS = 250
#: What a divergence costs, from the square of its length.
PENALTIES = {
    "square": lambda squared: squared,
    "absolute": lambda squared: jnp.sqrt(squared + SMALLEST_RESIDUAL**2) - SMALLEST_RESIDUAL,
}


def equilibrated(problem: InverseProblem, settings: Training) -> Callable:
    """Squared distance of the stress P[i, J, step, cell] from the nearest equilibrated one.

    Like every loss of :data:`LOSSES` a function of (P, network, key).
    """
    tests = [
        (steps, gap, jnp.asarray(problem.loading.resultant[steps], jnp.float32), problem.scale[steps])
        for steps, gap in problem.gaps()
    ]

    def loss(P, network, key):
        total = 0.0
        for steps, gap, resultant, scale in tests:
            total += jnp.sum(gap.squared(P[:, :, steps], resultant, scale))
        return settings.equilibrium_weight * total / len(problem.loading.t)

    return loss


def strong(problem: InverseProblem, settings: Training) -> Callable:
    """Mean square of the central-difference divergence at interior nodes, plus edge terms."""
    mesh = problem.mesh
    count = np.bincount(mesh.cells.ravel(), minlength=len(mesh.nodes))
    interior = np.flatnonzero(count == 4)
    nodal_area = np.bincount(mesh.cells.ravel(), np.repeat(mesh.areas / 4, 4), len(mesh.nodes))
    gather = mesh_gather(mesh, interior)
    edges = mean_tractions(problem)
    length = problem.length

    def loss(P, network, key):
        divergence = [gather(P[i]) / nodal_area[interior] for i in range(2)]
        residual = sum(jnp.mean((d * length / problem.scale[:, None]) ** 2) for d in divergence)
        return settings.equilibrium_weight * residual + settings.force_weight * edges(P)

    return loss


def mesh_gather(mesh, nodes) -> Callable:
    """Nodal forces at ``nodes`` (all with four cells) as a gather: P[J, step, cell] -> [step, node]."""
    matrices = [D.tocsr()[nodes] for D in nodal_force_matrices(mesh)]
    columns = np.stack([row.indices.reshape(len(nodes), 4) for row in (m.sorted_indices() for m in matrices)])
    values = np.stack([row.data.reshape(len(nodes), 4) for row in (m.sorted_indices() for m in matrices)])
    weights = jnp.asarray(values, jnp.float32)

    def apply(P):
        return sum(jnp.sum(P[J][:, columns[J]] * weights[J], axis=-1) for J in range(2))

    return apply


def divergence(problem: InverseProblem, network, X, F, dF, transposed: bool = False):
    """Div P at points by forward-mode derivatives along X and Y.

    (Div P)_i = dP_iX/dX + dP_iY/dY with P not symmetric (equation ``eq:equilibrium``). The network is differentiated
    once for all load steps. These then follow one another, so that what one step needs stays in the cache.

    Args:
        network: hyper-network.
        X: scaled positions (point, 2).
        F, dF: deformation gradient [i, J, step, point] and its derivatives [k, i, J, step, point] along the two
            *unscaled* coordinates.
        transposed: differentiate P^T instead, the slip whose effect is an ablation.

    Returns:
        divergence[i, step, point].
    """
    unit = jnp.broadcast_to(jnp.eye(2, dtype=X.dtype)[:, None], (2, *X.shape)) / problem.length
    node_params, dparams = _along(lambda X: network(X).T, (X,), (unit,))

    def at_step(deformation):
        """Divergence [i, point] of one load step from its F and dF."""
        F, dF = deformation
        _, dP = _along(partial(node_stress, problem.node), (F, node_params), (dF, dparams))
        if transposed:
            dP = jnp.swapaxes(dP, 1, 2)
        return dP[0][:, 0] + dP[1][:, 1]

    found = jax.lax.map(at_step, (jnp.moveaxis(F, 2, 0), jnp.moveaxis(dF, 3, 0)))
    return jnp.moveaxis(found, 0, 1)


def _along(function, arguments, directions):
    """(value, derivatives [k, ...]) along several directions, the first axis of each of ``directions``."""
    # All directions at once: the value, which they share, is computed once.
    return jax.vmap(lambda *along: jax.jvp(function, arguments, along), out_axes=(None, 0))(*directions)


def autodiff(
    problem: InverseProblem, settings: Training, batch_mean: bool = False, transposed: bool = False
) -> Callable:
    """Mean square of the exact Div P at random cell centres, plus edge terms: the paper's loss.

    Args:
        batch_mean: square the mean over the points instead, which lets imbalance of one point cancel that of
            another; with ``transposed`` (see :func:`divergence`) a slip whose effect is an ablation.
    """
    X = jnp.asarray(problem.mesh.centres, jnp.float32)
    unit = jnp.eye(2)
    interpolated = InterpolatedGradient(problem.inputs["field"])
    dF = jnp.stack([jax.jvp(interpolated, (X,), (jnp.broadcast_to(unit[k], X.shape),))[1] for k in range(2)])
    cells = len(X)
    count = min(settings.points or DEFAULT_POINTS, cells)
    outline = TRACTIONS[settings.traction](problem)

    def loss(P, network, key):
        """Div P at points drawn anew, and tractions at the outline; other points are not asked."""
        at = jax.random.choice(key, cells, (count,), replace=False)
        div = divergence(problem, network, problem.X[at], problem.F[..., at], dF[..., at], transposed)
        relative = div * problem.length / problem.scale[:, None]
        if batch_mean:
            relative = jnp.mean(relative, axis=-1)
        squared = jnp.sum(relative**2, axis=0)
        residual = jnp.mean(PENALTIES[settings.penalty](squared))
        return settings.equilibrium_weight * residual + settings.force_weight * outline(network)

    return loss


LOSSES = {
    "equilibrated": equilibrated,
    "strong": strong,
    "autodiff": autodiff,
    "batch_mean": partial(autodiff, batch_mean=True),
    "wrong_index": partial(autodiff, transposed=True),
}


def variation(problem: InverseProblem) -> tuple[jax.Array, Callable]:
    """Total variation of the stress of the sheet under its mean deformation.

    It sums length x |jump of P| over shared sides, for the mean F of the largest step of each test, over the sheet's
    length and the load's stress. That is the length of a contour times the contrast across it. Stress along stiff
    fibres that varies from one fibre to the next is in equilibrium whatever it is, and the gap does not see it.

    Returns:
        (F[i, J, test, cell], cost of the stress P[i, J, test, cell] there).
    """
    sides, length, _ = problem.mesh.neighbours()
    share = jnp.asarray(length / problem.length, jnp.float32)
    largest = np.flatnonzero(problem.loading.t == 1.0)
    F = mean_gradient(problem.mesh, np.asarray(problem.F)[:, :, largest])
    F = jnp.broadcast_to(jnp.asarray(F, jnp.float32), (*F.shape[:3], len(problem.mesh.cells)))
    scale = problem.scale[largest][:, None]

    def cost(P):
        relative = P / scale
        jump = relative[..., sides[:, 1]] - relative[..., sides[:, 0]]
        return jnp.sum(share * jnp.sqrt(jnp.sum(jump**2, axis=(0, 1, 2)) + SMALLEST_JUMP**2))

    return F, cost
