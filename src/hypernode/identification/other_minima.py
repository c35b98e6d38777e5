"""Better fields near one that a descent found, where noise makes many minima."""

import numpy as np

from hypernode.config.methods import Constrained
from hypernode.fem.gradient import deformation_gradient
from hypernode.identification.choice import likeliest
from hypernode.identification.estimate import Estimate
from hypernode.identification.gauss_newton import descend
from hypernode.mechanics.convex_basis import FIBRE_VECTOR


def _nearly(found: Estimate, params, settings: Constrained, name: str, move: str) -> Estimate:
    """The more probable of ``found`` and where a descent from ``params`` ends.

    It is tried if these cost hardly more than ``found`` does: no more than noise changes costs by chance.
    """
    problem = found.problem
    other = found.at(params)
    if other is None or other.cost - found.cost > problem.strategy.by_chance * np.sqrt(problem.cost_of_noise):
        return found
    reached = descend(problem, settings, name, other, (), settings.tolerance, move)
    return likeliest(found, reached.after(found))


def with_law_of_sheet(found: Estimate, settings: Constrained, name: str) -> Estimate:
    """The more probable of ``found`` and where a descent ends that begins with one law in all cells, as stiff as found.

    While interfaces are sought, steps may take a term away from all cells. It then has no slope that would bring it
    back, whatever forces say. The homogeneous fit has the terms that the forces need.
    """
    problem = found.problem
    params = np.tile(problem.homogeneous.params, (len(found.params), 1))
    params[:, 0] += problem.stiffness(found.params)[0] - problem.stiffness(params)[0]
    other = found.at(params)
    if other is None:
        return found
    reached = descend(problem, settings, name, other, (), settings.tolerance, "one law for the sheet")
    return likeliest(found, reached.after(found))


def without_fibres(found: Estimate, settings: Constrained, name: str) -> Estimate:
    """Where a descent without fibres ends, if a noisy test does not tell of them and that field is the more probable.

    A descent begins with weak fibres, which noise may strengthen where they hardly carry anything; only under other
    loads would they.
    """
    fibre = [k for k, key in enumerate(found.problem.basis.names) if key in FIBRE_VECTOR]
    if not found.problem.sharp or not found.params[:, fibre].any():
        return found
    params = found.params.copy()
    params[:, fibre] = 0.0
    return _nearly(found, params, settings, name, "no fibres")


def without_stray_cells(found: Estimate, settings: Constrained, name: str) -> Estimate:
    """Where descents end that begin at the median of each cell's neighbours, as long as they find something better.

    Cells of which the test says little stay where an early iteration left them, and under other deformations they are
    what is most wrong. Only noisy data without a correlation window are tried. Without noise, the test says so much of
    each cell that medians do not explain it. Through a window, cells in between are something else.
    """
    while found.problem.sharp:
        better = _nearly(
            found, found.problem.mesh.median_of_neighbours(found.params), settings, name, "medians of neighbours"
        )
        if found.cost - better.cost < settings.tolerance * found.problem.cost_of_noise:
            return better
        found = better
    return found


def without_outlying_cells(found: Estimate, settings: Constrained, name: str) -> Estimate:
    """Where a descent ends that begins with the material of a neighbour in every cell that is like none of them.

    Where a cell has hardly been deformed enough to show a term, that term may be anything. Beyond what the cell has
    seen, its stress may then differ from every neighbour's by any factor. What costs so little that a descent left it,
    and is like a neighbour where it was seen, is more likely that neighbour's material. Only data without noise or cut
    cells are treated so: both make mixtures, which are like no neighbour.
    """
    while found.problem.certain and (params := resembling(found)) is not None:
        better = _nearly(found, params, settings, name, "outlying cells like a neighbour")
        if better.trial is found.trial:
            return better
        found = better
    return found


def resembling(found: Estimate) -> np.ndarray | None:
    """The field with the material of a neighbour in every outlying cell; None where there is no such cell.

    Stresses are compared under the mean deformation of the sheet. A cell is outlying where, in some load step, its
    stress differs from that of each neighbour by more than the jump that is one. It takes the material of the neighbour
    whose stress is nearest to its own at the deformations that it has seen.
    """
    problem, steps = found.problem, len(found.states)
    mesh, basis = problem.mesh, problem.basis
    pairs = mesh.touching()
    pairs = np.concatenate([pairs, pairs[:, ::-1]])

    def stress(params, F):
        """(2, 2, cell, step) of cells with their parameters, at F of the same shape."""
        each = np.repeat(params, steps, axis=0).T
        return np.asarray(basis.stress(F.reshape(2, 2, -1), each)).reshape(F.shape)

    common = np.repeat(problem.observations.mean_F[:, :, None], len(found.params), axis=2)
    level = np.log(np.linalg.norm(stress(found.params, common), axis=(0, 1)))
    differ = np.abs(level[pairs[:, 0]] - level[pairs[:, 1]]).max(axis=1) > (found.objective.jump_cost.scale or np.inf)
    outlying = np.bincount(pairs[~differ, 0], minlength=len(level)) == 0
    cell, other = pairs[outlying[pairs[:, 0]] & ~outlying[pairs[:, 1]]].T
    if len(cell) == 0:
        return None
    F = np.stack([deformation_gradient(mesh, state.u) for state in found.states], axis=1)[cell].transpose(2, 3, 0, 1)
    distance = np.sum((stress(found.params[cell], F) - stress(found.params[other], F)) ** 2, axis=(0, 1, 3))
    params = found.params.copy()
    # The last one that is written to a cell is the nearest.
    farthest_first = np.argsort(-distance, kind="stable")
    params[cell[farthest_first]] = found.params[other[farthest_first]]
    return params


def perturbed(found: Estimate, settings: Constrained, name: str) -> Estimate:
    """The best of what descents lead to that begin at ``found`` after jumps have cost something else for a while.

    Only where noise makes minima, and not through a correlation window, where what is gained is not worth the time.
    """
    if not found.problem.sharp:
        return found
    for change in found.problem.strategy.perturbations:
        other = {
            "regulariser_weight": change.weight * settings.regulariser_weight,
            "jump_scale": change.scale * settings.jump_scale,
            "iterations": min(change.iterations, settings.iterations),
        }
        away = descend(found.problem, settings.model_copy(update=other), name, found, (), 0.0, "jumps at another cost")
        back = descend(found.problem, settings, name, away, (), settings.tolerance, "jumps at their cost again")
        found = likeliest(found, back.after(found, away))
    return found
