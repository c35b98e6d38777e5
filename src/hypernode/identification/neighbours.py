"""Cells of which a test says little, decided by their neighbours and judged by the whole objective.

At an interface two cells may share a jump: the test sees what they are together, and a descent leaves both between the
two materials, or one too stiff and one too soft. Under other deformations these few cells are what is most wrong. Each
is offered the materials of its neighbours, alone or together with another such cell at its side; what the move does to
the misfits follows from the sensitivities, what it does to jumps is computed.
"""

import itertools
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from hypernode.fem.mesh import Mesh
from hypernode.identification.estimate import Estimate


@dataclass(frozen=True)
class Offer:
    """A neighbour's material for a cell: the cell and the change of its parameters (parameter,)."""

    cell: int
    change: Float[np.ndarray, " parameter"]


def moved_by_neighbours(found: Estimate) -> Float[np.ndarray, "cell parameter"] | None:
    """Parameters after all moves that lower the objective, the best one first; None where there is none."""
    problem, objective = found.problem, found.objective
    strategy = problem.strategy
    stiffness = problem.stiffness(found.params)[0]
    around = _neighbours(problem.mesh)
    alone, contour = _doubtful(stiffness, around, strategy.plateau)
    offers = _offers(found.params, stiffness, around, alone, contour, strategy.plateau)[: strategy.most_offers]
    if not offers:
        return None
    linear = problem.linearise(found.params, found.states, problem.sigma)
    gradient = linear.adjoint(np.concatenate(objective.residuals(found.states, problem.sigma, linear)))
    columns = np.zeros((found.params.size, len(offers)))
    for k, offer in enumerate(offers):
        columns.reshape(*found.params.shape, -1)[offer.cell, :, k] = offer.change
    slope, curvature = columns.T @ gradient, columns.T @ linear.curvature(columns)
    moves = [(k,) for k in range(len(offers))]
    moves += [
        (a, b) for a, b in itertools.combinations(range(len(offers)), 2) if offers[b].cell in around[offers[a].cell]
    ]
    return _best_moves(found, offers, moves, slope, curvature)


def _best_moves(found: Estimate, offers: list[Offer], moves: list[tuple[int, ...]], slope, curvature):
    """Apply the move that lowers the objective most, as long as one does; a cell moves once."""
    objective, params, slope = found.objective, found.params.copy(), slope.copy()
    regular, settled, changed = objective.regular(params), set(), False
    gains: dict[tuple[int, ...], float] = {}
    while True:
        moves = [move for move in moves if not any(offers[k].cell in settled for k in move)]
        for move in moves:
            if move not in gains:
                gains[move] = objective.regular(_applied(params, offers, move)) - regular
        costs = [gains[move] + slope[list(move)].sum() + 0.5 * curvature[np.ix_(move, move)].sum() for move in moves]
        best = _decided(offers, moves, costs, objective.strategy.decisive)
        if best is None:
            return params if changed else None
        params, changed = _applied(params, offers, best), True
        slope += curvature[:, list(best)].sum(axis=1)
        regular = objective.regular(params)
        cells = {offers[k].cell for k in best}
        settled |= cells
        # What others do to jumps has changed near by.
        near = {int(n) for cell in cells for n in _within(found.problem.mesh, cell)}
        gains = {move: gain for move, gain in gains.items() if not any(offers[k].cell in near for k in move)}


def _decided(offers: list[Offer], moves, costs: list[float], decisive: float) -> tuple[int, ...] | None:
    """The move that lowers the objective most and by enough, where no other of the same cells comes near it."""
    by_cells: dict[frozenset[int], list[float]] = {}
    for move, cost in zip(moves, costs, strict=True):
        by_cells.setdefault(frozenset(offers[k].cell for k in move), []).append(cost)
    for place in np.argsort(costs, kind="stable"):
        if costs[place] > -decisive:
            return None
        rivals = sorted(by_cells[frozenset(offers[k].cell for k in moves[place])])[1:2]
        if not rivals or rivals[0] > costs[place] + decisive:
            return moves[place]
    return None


def _applied(params, offers: list[Offer], move: tuple[int, ...]):
    params = params.copy()
    for k in move:
        params[offers[k].cell] += offers[k].change
    return params


def _within(mesh: Mesh, cell: int) -> np.ndarray:
    """Cells that share a node with one."""
    return np.flatnonzero(np.isin(mesh.cells, mesh.cells[cell]).any(axis=1))


def _neighbours(mesh: Mesh) -> list[set[int]]:
    """Cells that share a side or a corner with each."""
    around: list[set[int]] = [set() for _ in mesh.cells]
    for one, other in np.concatenate([mesh.neighbours()[0], mesh.diagonal_neighbours()[0]]).tolist():
        around[one].add(other)
        around[other].add(one)
    return around


def _doubtful(stiffness: Float[np.ndarray, " cell"], around: list[set[int]], plateau: float):
    """(cells that are part of no phase, not even of a thin one; cells at a contour of theirs)."""
    alike = np.array([
        sum(abs(stiffness[cell] - stiffness[other]) < plateau for other in others) for cell, others in enumerate(around)
    ])  # fmt: skip
    # Along a straight contour three of eight neighbours are of the other side.
    return alike < 2, np.array([len(others) for others in around]) - alike >= 3


def _offers(params, stiffness, around, alone, contour, plateau: float) -> list[Offer]:
    """For each doubtful cell the materials of its stiffest, softest and middle neighbour that is part of a phase."""
    offers = []
    for cell in np.flatnonzero(alone | contour):
        known = sorted((n for n in around[cell] if not alone[n]), key=lambda n: stiffness[n])
        chosen: list[int] = []
        for other in known[:1] + known[-1:] + known[len(known) // 2 : len(known) // 2 + 1]:
            if all(abs(stiffness[other] - stiffness[each]) >= plateau for each in (cell, *chosen)):
                chosen.append(other)
        offers += [(not alone[cell], Offer(int(cell), params[other] - params[cell])) for other in chosen]
    # Of many, first those of cells that are part of nothing, and of them those that change most.
    return [offer for _, offer in sorted(offers, key=lambda each: (each[0], -float(np.abs(each[1].change[0]))))]
