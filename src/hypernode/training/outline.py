"""What training asks of the stress at the outline: mean tractions of edges, or tractions at nodes."""

from collections.abc import Callable

import jax.numpy as jnp
import numpy as np

from hypernode.fem.mesh import EDGES
from hypernode.material.laws import node_stress
from hypernode.training.interpolant import InterpolatedGradient
from hypernode.training.problem import InverseProblem


def mean_tractions(problem: InverseProblem) -> Callable:
    """Mean squared error of measured resultants and of tractions on free edges, from edge cells.

    The resultant enters through the cells along each edge (``main_loss_function``); only pairs of
    edge and component that are measured or free contribute.

    Returns:
        P[i, J, step, cell] -> cost.
    """
    mesh, loading = problem.mesh, problem.loading
    low, high = mesh.centres.min(axis=0), mesh.centres.max(axis=0)
    spacing = np.sqrt(mesh.areas.mean())
    groups = []
    for edge, (axis, sign) in enumerate(EDGES.values()):
        on = np.abs(mesh.centres[:, axis] - (high if sign > 0 else low)[axis]) < 0.25 * spacing
        groups.append((edge, axis, np.flatnonzero(on)))

    def terms(P):
        """Mean squared error of the mean traction on every edge that is measured or free."""
        total = 0.0
        for edge, axis, cells in groups:
            for i in range(2):
                traction = P[i, axis][:, cells] / problem.scale[:, None]
                held = loading.constrained[loading.load_case, edge, i]
                known = loading.measured[:, i, axis] & held
                target = jnp.asarray(loading.P_average[:, i, axis], jnp.float32) / problem.scale
                total += jnp.mean(jnp.asarray(known) * (jnp.mean(traction, axis=1) - target) ** 2)
                total += jnp.mean(jnp.asarray(~held)[:, None] * traction**2)
        return total

    return terms


def border_cells(problem: InverseProblem):
    """Numbers of the cells beside a node that fewer than four cells share (cell,)."""
    mesh = problem.mesh
    return np.flatnonzero(np.bincount(mesh.cells.ravel(), minlength=len(mesh.nodes))[mesh.cells].min(axis=1) < 4)


def mean_tractions_of(problem: InverseProblem) -> Callable:
    """:func:`mean_tractions` of a network, whose stress is computed at the cells of the border alone."""
    border, edges, cells = border_cells(problem), mean_tractions(problem), len(problem.X)

    def cost(network):
        P_border = node_stress(problem.node, problem.F[..., border], network(problem.X[border]).T)
        return edges(jnp.zeros((*P_border.shape[:-1], cells)).at[..., border].set(P_border))

    return cost


def nodal_targets(problem: InverseProblem):
    """Where tractions are known, and what they are.

    Nodes of the four edges without the corners, which two edges share. A component that is held has the force of its
    node over the length that belongs to it. Where no nodal forces are known it has the mean stress of the test. One
    that is free has none.

    Returns:
        (nodes (point,), axes and signs of their normals (point,), tractions [i, step, point], their weights of the
        same shape: 0 where a component is held by a force that is not known).
    """
    mesh, loading = problem.mesh, problem.loading
    force = problem.nodal_force
    corner = sum(mesh.on_edge(edge).astype(int) for edge in EDGES) > 1
    nodes, axes, signs, targets, weights = [], [], [], [], []
    for edge, (name, (axis, sign)) in enumerate(EDGES.items()):
        on = np.flatnonzero(mesh.on_edge(name) & ~corner)
        place = mesh.lines[1 - axis]
        length = np.zeros(len(place))
        length[1:-1] = 0.5 * (place[2:] - place[:-2])
        length = length[np.searchsorted(place, mesh.nodes[on, 1 - axis])]
        held = loading.constrained[loading.load_case, edge].T[..., None]
        if force is None:
            spread = sign * loading.P_average[:, :, axis].T[..., None]
            known, traction = loading.measured[:, :, axis].T[..., None], np.repeat(spread, len(on), axis=2)
        else:
            known, traction = np.ones_like(held), np.moveaxis(force[:, on], 2, 0) / length
        nodes.append(on)
        axes.append(np.full(len(on), axis))
        signs.append(np.full(len(on), sign))
        targets.append(np.where(held, traction, 0.0))
        weights.append(np.broadcast_to(~held | known, traction.shape))
    return (
        np.concatenate(nodes),
        np.concatenate(axes),
        np.concatenate(signs),
        np.concatenate(targets, axis=2),
        np.concatenate(weights, axis=2),
    )


def nodal_tractions_of(problem: InverseProblem) -> Callable:
    """Mean over nodes of the outline and steps of |P N - t|^2 (second term of ``main_loss_function``), of a network."""
    nodes, axes, signs, targets, weights = nodal_targets(problem)
    mesh = problem.mesh
    F = InterpolatedGradient(problem.inputs["field"])(jnp.asarray(mesh.nodes[nodes], jnp.float32))
    X = jnp.asarray((mesh.nodes[nodes] - mesh.lower) / problem.length, jnp.float32)
    along_x = jnp.asarray(axes == 0)
    scale = problem.scale[:, None]
    signs, weights = jnp.asarray(signs, jnp.float32), jnp.asarray(weights, jnp.float32)
    wanted = jnp.asarray(targets, jnp.float32) / scale

    def cost(network):
        P = node_stress(problem.node, F, network(X).T)
        traction = signs * jnp.where(along_x, P[:, 0], P[:, 1]) / scale
        return jnp.mean(jnp.sum(weights * (traction - wanted) ** 2, axis=0))

    return cost


#: Values of ``training.traction`` that a network is judged by.
TRACTIONS = {"resultant": mean_tractions_of, "nodal": nodal_tractions_of}
