"""A sheet of a few phases, each of one material: a contour and a handful of numbers that explain a noisy test as well.

Free cells at an interface end half-way between its sides wherever the test hardly tells them apart. No gradient leads
away from there, since the cost of a jump is concave. If each side is one material, a cell belongs to one or to the
other. Where it belongs changes the residuals by many times their noise. Phases are not assumed: their field is kept
where it is the likelier one.
"""

import dataclasses

import numpy as np
import scipy.sparse
from jaxtyping import Int

from hypernode.config.methods import Constrained
from hypernode.identification.choice import reason_against
from hypernode.identification.contours import ContourModel, changes_of_field, doubtful, options_at_contours, relabelled
from hypernode.identification.estimate import Estimate
from hypernode.identification.few_materials import MaterialEquations, Phases, medians, split
from hypernode.identification.foresight import Foresight
from hypernode.identification.gauss_newton import first_field, objective_at_end
from hypernode.identification.objective import Objective
from hypernode.identification.problem import FieldProblem
from hypernode.identification.projected_newton import projected_steps
from hypernode.progress import Progress, say
from hypernode.verdict import Ending


def in_phases(found: Estimate, name: str) -> Estimate:
    """The field of a few phases that explains a noisy test, if it is likelier than ``found``; otherwise ``found``."""
    if not _may_be_phases(found.problem):
        return found
    best = _of_few_phases(found.objective, found.params, [state.u for state in found.states], name)
    if best is None:
        return found
    if best.underfitted:
        return found.instead_of(best, because="does not explain the test")
    if found.information_criterion <= best.information_criterion:
        return found.instead_of(best, because=reason_against(best, found))
    return best.after(found).instead_of(found, because=reason_against(found, best))


def on_finer_grid(problem: FieldProblem, settings: Constrained, before: Estimate, name: str) -> Estimate | None:
    """A field of a few phases, with contours of this grid, that begins from a field of a coarser one.

    None where no such field explains a noisy test.
    """
    if not _may_be_phases(problem):
        return None
    params, centre, guesses = first_field(problem, before)
    best = _of_few_phases(objective_at_end(problem, settings, centre), params, guesses, name)
    return None if best is None or best.ambiguous else best.after(before)


def _may_be_phases(problem: FieldProblem) -> bool:
    """Whether noise makes many minima, and every cell is of one material.

    On an observed grid interfaces cut cells, which labels then bend the materials to explain.
    """
    return problem.sharp and problem.observations.own_grid


def _of_few_phases(objective: Objective, params, guesses, name: str) -> Estimate | None:
    """The likeliest field of a few phases near some parameters, or None where none has an equilibrium.

    A phase is split in two by its stiffness as long as that pays at once.
    """
    problem = objective.problem
    level, _ = problem.stiffness(params)
    best, labels = None, np.zeros(len(level), dtype=int)
    for _ in range(problem.strategy.most_phases):
        materials = medians(problem.mesh, params, labels, problem.basis.lowest)
        found = _at(objective, Phases(labels, materials), guesses)
        if found is None:
            break
        found = _with_materials(found)
        pays = best is None or _criterion(found) < _criterion(best)
        if pays:
            found = _settled(found, name)
            # Noise makes the best of many contours look real.
            pays = best is None or _criterion(found) < _criterion(best)
        found = found.recorded(_counted(found.material_count))
        if not pays:
            best = best.instead_of(found, because="one material more does not pay")
            break
        best = found if best is None else found.instead_of(best, because="one material more pays")
        guesses = [state.u for state in found.states]
        labels = split(level, found.phases.labels)
    return best


def _counted(number: int) -> str:
    return f"cells of {number} material" + ("" if number == 1 else "s")


def _criterion(found: Estimate) -> float:
    """The information criterion among fields of phases: each region pays for the places that it might be at as well."""
    return found.information_criterion + found.phases.regions(found.problem.mesh) * np.log(len(found.params))


def _reached(objective: Objective, phases: Phases, near: Estimate) -> Estimate | None:
    """:func:`_at` beside an estimate."""
    return _at(objective, phases, [state.u for state in near.states])


def _at(objective: Objective, phases: Phases, guesses) -> Estimate | None:
    """The estimate of a field of phases, or None where that has no equilibrium within reach."""
    problem, params = objective.problem, phases.params
    states = problem.equilibrium.states(params, guesses)
    if states is None:
        return None
    linear = problem.linearise(params, states, problem.sigma)
    history = np.array([objective.misfit(states, linear)])
    cost = objective.value(params, states, problem.sigma, linear)
    return Estimate(objective, linear, params, states, history, cost, Ending.UNFINISHED, None, phases)


def _settled(start: Estimate, name: str) -> Estimate:
    """Materials and contours in turn, until neither lowers the cost any more.

    What contours hardly explain of a misfit that is far from its noise is no matter of contours, and is left.
    """
    strategy, found = start.problem.strategy, start
    ending, count = Ending.OUT_OF_ITERATIONS, len(start.phases.materials)
    words = f"{count} {'phase' if count == 1 else 'phases'}"
    progress = Progress(f"constrained field, contours of {words}", name, strategy.phase_rounds)
    for _ in range(strategy.phase_rounds):
        moved = _with_contours(found)
        progress.advance(misfit=float(found.history[-1]), cost=found.cost)
        if moved is None:
            ending = Ending.CONVERGED
            break
        gained, found = found.cost - moved.cost, moved.after(found)
        if found.unexplained > 1.0 and gained < strategy.phase_share * (found.cost - found.problem.cost_of_noise):
            ending = Ending.STAGNATED
            break
    say("constrained field", name, f"{words}, {ending}: {found.summary}")
    return dataclasses.replace(found, ending=ending)


def _with_materials(found: Estimate) -> Estimate:
    """The same contours between the likeliest materials, by damped Gauss-Newton steps.

    What a contour costs is its length here and does not shrink the jump, so that its cost has no part in a step.
    """
    objective, strategy = found.objective, found.problem.strategy

    def cost(each: Estimate, linear) -> float:
        held = 0.5 * objective.ridge @ (each.params.ravel() - objective.centre) ** 2
        return objective.misfits(each.states, linear.sigma, linear) + held

    for _ in range(strategy.phase_steps):
        linear, better = found.linear, None
        equations = MaterialEquations(linear.curvature, found.phases, objective.ridge)
        pull = objective.misfit_gradient(found.states, linear) + objective.ridge * (
            found.params.ravel() - objective.centre
        )
        gradient, curvature = equations.columns.T @ pull, equations.matrix
        x, lowest = found.phases.materials.ravel(), np.tile(found.basis.lowest, len(found.phases.materials))
        for changed, gain in projected_steps(x, gradient, curvature, lowest, np.zeros(len(x)), strategy):
            if gain < strategy.phase_gain:
                break
            phases = dataclasses.replace(found.phases, materials=changed.reshape(found.phases.materials.shape))
            trial = _reached(objective, phases, found)
            if trial is not None and cost(trial, linear) < cost(found, linear):
                better = trial
                break
        if better is None:
            break
        found = better.after(found)
    return found


def _with_contours(found: Estimate) -> Estimate | None:
    """Phases whose contours have moved to where they cost least, and their materials; None where none would move.

    The misfit is linearised where every cell that may change is half-way, so that the quadratic model holds on both
    sides; in it the materials follow the contours. Where it has nothing more to offer, the single cells of which it is
    least sure are changed in earnest, the most doubtful first, as far as that is not foreseen to be in vain.
    """
    objective, problem, phases = found.objective, found.problem, found.phases
    options = options_at_contours(problem.mesh, phases.labels)
    if not len(options.cell):
        return None
    half_way = phases.params
    np.add.at(half_way, options.cell, phases.materials[options.label])
    half_way /= 1.0 + np.bincount(options.cell, minlength=len(half_way))[:, None]
    states = problem.equilibrium.states(half_way, [state.u for state in found.states])
    if states is None:
        return None
    linear = problem.linearise(half_way, states, problem.sigma)
    model = ContourModel(
        options,
        *_quadratic(found, linear, changes_of_field(phases, options)),
        objective.regulariser.lengths(objective.jump_cost),
        objective.regulariser_weight * objective.regulariser.between(phases.materials, objective.jump_cost),
    )
    moved = _relabelled(found, relabelled(phases.labels, model, problem.strategy.phase_gain))
    if moved is not None:
        return moved
    doubted = doubtful(phases.labels, model, problem.strategy.phase_doubt)[: problem.strategy.phase_trials]
    return one_by_one(found, options.cell[doubted], options.label[doubted])


def one_by_one(start: Estimate, cells: Int[np.ndarray, " cell"], others: Int[np.ndarray, " cell"]) -> Estimate | None:
    """Other labels for single cells in turn, each kept where the cost falls by it; None where none is."""
    found, foresight = start, Foresight(start)
    for cell, other in zip(cells, others, strict=True):
        labels = found.phases.labels.copy()
        labels[cell] = other
        if foresight.gain(labels) >= -start.problem.strategy.phase_foresight:
            moved = _relabelled(found, labels)
            if moved is not None:
                found, foresight = moved, Foresight(moved)
    return None if found is start else found


def _relabelled(found: Estimate, labels: Int[np.ndarray, " cell"]) -> Estimate | None:
    """The same with other labels, and the materials that follow; None where these gain nothing, or lose a phase."""
    if np.array_equal(labels, found.phases.labels) or len(np.unique(labels)) < len(found.phases.materials):
        return None
    moved = _reached(found.objective, dataclasses.replace(found.phases, labels=labels), found)
    moved = moved and _with_materials(moved)
    return moved if moved and found.cost - moved.cost >= found.problem.strategy.phase_gain else None


def _quadratic(found: Estimate, linear, changes: scipy.sparse.csc_matrix):
    """(gradient, curvature) of the misfit by options, where the materials of the phases follow what is chosen."""
    pull = found.objective.misfit_gradient(found.states, linear)
    at_once = found.problem.strategy.columns_at_once
    blocks = [changes[:, k : k + at_once].toarray() for k in range(0, changes.shape[1], at_once)]
    curvature = np.concatenate([changes.T @ linear.nearly_curvature(block) for block in blocks], axis=1)
    equations = MaterialEquations(linear.nearly_curvature, found.phases, found.objective.ridge)
    crossed = changes.T @ equations.by_cells
    followed = np.linalg.solve(equations.matrix, crossed.T)
    curvature -= crossed @ followed
    gradient = changes.T @ pull - followed.T @ (equations.columns.T @ pull)
    return gradient, 0.5 * (curvature + curvature.T)
