"""The final estimate of a search for materials and lines: all load steps, with noise and window estimated again."""

import dataclasses

import numpy as np
import scipy.sparse

from hypernode.data.believed_noise import BelievedNoise
from hypernode.data.believed_window import BelievedWindow
from hypernode.data.measurement import correlation_window, displacement_noise, window_uncertainty
from hypernode.fem.factors import factorise
from hypernode.identification import budgets, numerics, priors, thresholds
from hypernode.identification.candidate import Candidate
from hypernode.identification.equilibrium import State
from hypernode.identification.interface_estimate import InterfaceEstimate
from hypernode.identification.interface_fit import InterfaceFit
from hypernode.identification.interface_numbers import bends_of, held_of
from hypernode.identification.law_search import LawSearch
from hypernode.identification.lines import Lines
from hypernode.identification.moves import Moves
from hypernode.identification.objective import Objective
from hypernode.identification.observations import description_error
from hypernode.identification.regulariser import JumpCost
from hypernode.identification.seen_test import SeenTest
from hypernode.identification.trials import Trials
from hypernode.identification.unseen_strips import with_carried_shares
from hypernode.identification.window_error import changed_by_window, told_errors


def answer(trials: Trials, kept: Candidate, finds_window: bool) -> InterfaceEstimate | None:
    """The estimate of a candidate for all load steps; None where one of them has no equilibrium.

    The residual that differs from step to step is noise. The residual common to all steps is a model error, up to the
    expected discretisation error.

    Args:
        kept: the candidate that the search ended with.
        finds_window: whether the side of the window is sought.
    """
    every = list(range(len(kept.problem.observations.u)))
    floor = _believed(trials, kept, finds_window and kept.fit.field.count > 1)
    problem = trials.problem(kept.terms, kept.subcells, floor)
    field = kept.fit.field.on(Lines.of(problem.observations.grid, problem.refinement, kept.fit.field.lines))
    u = {k: _near(kept, k) for k in every}
    found = trials.descend("all load steps", kept, problem, field, u, every, budgets.ANSWER_STEPS)
    if found is None:
        return None
    # Steps that the search left out may tell a term more, and that a gradual law is no single one.
    found = Moves(trials, every, False).turned(LawSearch(trials, every, False).end(found))
    estimate = _estimate(trials, found)
    told = with_carried_shares(trials.measurement, estimate)
    if told is None:
        return estimate
    trials.believe(told)
    problem, move = trials.problem(found.terms, found.subcells, floor), "what is beside the points"
    again = trials.descend(move, found, problem, found.fit.field, found.u, every, budgets.ANSWER_STEPS)
    return estimate if again is None else _estimate(trials, again)


def _near(kept: Candidate, step: int) -> np.ndarray:
    """Equilibrium of a step with the field of a candidate; the measured edges alone where there is none.

    It is followed from the closest step of its load case that was fitted, as far at once as Newton's method reaches.
    """
    problem, fit, held = kept.problem, kept.fit, kept.u[step].ravel()
    if step in fit.steps:
        return kept.u[step]
    observations, (of, _) = problem.observations, fit.field.cells()
    t, case, free = observations.loading.t, observations.loading.load_case, observations.boundaries[step].free
    closest = min((k for k in fit.steps if case[k] == case[step]), key=lambda k: abs(t[k] - t[step]))
    u, sheet = kept.u[closest], SeenTest(problem, [step]).sheet
    _, K = sheet.response(u, of)
    done, part = 0.0, 1.0
    while done < 1.0 and part > numerics.SHORTEST_WAY:
        change = part / (1.0 - done) * (held - u.ravel())
        change[free] = 0.0
        change[free] = -factorise(K[free][:, free]).solve((K @ change)[free])
        near = u + change.reshape(u.shape)
        reached = sheet.equilibrium(near, free, of, numerics.NEWTON_TOLERANCE)
        if reached is None:
            part = 0.5 * part
            continue
        (u, _, K), done = reached, done + part
        part = min(part, 1.0 - done)
    return u if done == 1.0 else kept.u[step]


def _believed(trials: Trials, final: Candidate, finds_window: bool) -> float:
    """What finite elements miss, once the trials believe the noise and the window that are left."""
    if not final.problem.observations.by_points:
        return 0.0
    left, observations, sigma = final.fit.left, final.problem.observations, final.problem.sigma
    step, measurement, steps = SeenTest(final.problem, []).step, trials.measurement, final.fit.steps
    side, kernel = correlation_window(measurement)
    side, error = (final.fit.window * step, final.fit.window_error * step) if finds_window else (side, 0.0)
    # Without a window, what is left beside lines is of finite elements as large as the grid's step.
    # Of the field's own displacements: a mean over a window changes noise as well.
    u = np.stack([state[0][final.problem.refinement.nodes] for state in final.fit.states])
    changed = changed_by_window(observations.grid, u, max(side, step), kernel)
    boundaries = [observations.boundaries[k] for k in steps]
    residuals = [
        sigma * b.relative * white[: len(b.seen)] for white, b in zip(final.fit.white, boundaries, strict=True)
    ]
    near = [each.ravel()[b.observed] for each, b in zip(changed, boundaries, strict=True)]
    level, share = told_errors(np.concatenate(residuals), np.concatenate(near))
    level = level / (sigma * observations.scatter) * left.level / final.fit.misfit
    told = max(level, 1.0 / level) > thresholds.NOISE_KNOWN and not left.alike
    if told and displacement_noise(measurement) > 0.0:
        believed = BelievedNoise.read(measurement.attrs)
        trials.believe(dataclasses.replace(believed, factor=believed.factor * level).of(measurement))
    if side > 0.0 and window_uncertainty(measurement) > 0.0:
        trials.believe(BelievedWindow(side, error, share).of(trials.measurement))
        return 0.0
    trusted = description_error(False, final.subcells, len(observations.grid.cells))
    size = float(np.sqrt(np.mean(changed**2)))
    return min(share * size, trusted * float(np.abs(observations.u).max())) if final.fit.field.distances.size else 0.0


def _estimate(trials: Trials, found: Candidate) -> InterfaceEstimate:
    fit, problem = found.fit, found.problem
    test = SeenTest(problem, fit.steps, fit.window, fit.edges)
    moves, materials = InterfaceFit(test).moves(fit.field), fit.field.materials
    count = len(fit.field.numbers(moves))
    unknown = np.where(np.arange(count) < materials.size, 0.0, priors.DISTANCE_HELD)
    going = np.ones(count, bool)
    going[: materials.size] = (materials > problem.basis.lowest).ravel()
    each = zip(fit.states, problem.observations.boundaries, strict=True)
    trace, records = trials.trace(fit.left.independent)
    return InterfaceEstimate(
        objective=Objective(
            problem=problem,
            regulariser=None,
            regulariser_weight=0.0,
            jump_cost=JumpCost(),
            ridge=np.zeros(count),
            centre=np.zeros(count),
        ),
        linear=test.jacobian(fit.field, test.with_tangents(fit.field, fit.states), moves),
        params=materials,
        states=[State(u, force, boundary.free) for (u, force, _), boundary in each],
        history=np.array([*found.history, fit.misfit]),
        cost=fit.cost,
        ending=fit.ending,
        step=None,
        trial=records[found],
        trace=trace,
        found=found,
        moves=moves,
        going=going,
        # Where neither data nor bends say anything of a distance, it is known to some cells.
        held=held_of(fit.field, bends_of(fit.field, moves)) + scipy.sparse.diags(unknown),
    )
