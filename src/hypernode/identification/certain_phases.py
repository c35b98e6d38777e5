"""Where a descent on a grid of many cells begins without noise if the sheet is of a few materials.

A coarser grid tells the materials, and which of them most cells have. Open are the cells near its interfaces. Data
without noise tell every one of these. So each gets a share of the phases near it: one number a cell near an interface,
where a free field has all parameters in every cell. The materials are eliminated from every system, which leaves hardly
any valleys. Two or three Gauss-Newton steps tell the labels; then the materials follow alone.

The descent from there is short. It is of a free field, as without a coarser grid: nothing else depends on phases.
"""

import dataclasses

import numpy as np
import scipy.sparse

from hypernode.config.methods import Constrained
from hypernode.identification.deflated_cg import DeflatedCG
from hypernode.identification.estimate import Estimate
from hypernode.identification.few_materials import Phases
from hypernode.identification.gauss_newton import described, first_field, objective_at_end
from hypernode.identification.objective import Objective
from hypernode.identification.problem import FieldProblem
from hypernode.identification.projected_newton import bounded_step
from hypernode.identification.sensitivities import Jacobian
from hypernode.identification.shares import Shares, left_open
from hypernode.progress import say
from hypernode.verdict import Ending


def of_certain_phases(
    problem: FieldProblem, plain: FieldProblem, settings: Constrained, coarse: Estimate, name: str
) -> Estimate | None:
    """A field of a few phases near that of a coarser grid, whose cells have found their labels.

    Its materials have the plainest terms if these leave nothing to explain: on the coarse grid interfaces that cut
    cells may have asked for more. None where there is noise, where interfaces cut cells, or where no few phases come
    nearer the test than the coarse field.

    Args:
        problem: the finer grid, with the terms of the coarse field.
        plain: the same with the plainest terms.
        settings: configuration of the stage.
        coarse: the field of the coarser grid.
        name: case, for progress.
    """
    if not problem.certain:
        return None
    params, centre, guesses = first_field(problem, coarse)
    mixed = left_open(problem, params, coarse, settings.jump_scale)
    if mixed is None:
        return None
    objective = objective_at_end(problem, settings, centre)
    labelled = _labelled(objective, mixed, guesses)
    if labelled is None:
        return None
    found = _plainer(*labelled, problem, plain, settings) or _with_likeliest_materials(objective, *labelled, settings)
    if found is None or not _nearer(found, objective, params, guesses):
        return None
    words = f"{found.material_count} phases near those of the coarser grid ({described(found.problem)}), {found.ending}"
    say("constrained field", name, f"{words}: {found.summary}")
    return found.recorded("phases near those of the coarser grid", coarse).after(coarse)


def _plainer(
    phases: Phases, guesses, problem: FieldProblem, plain: FieldProblem, settings: Constrained
) -> Estimate | None:
    """The same phases of materials with the plainest terms, if these leave nothing to explain."""
    if plain.basis.terms == problem.basis.terms:
        return None
    materials = np.tile(plain.homogeneous.params, (len(phases.materials), 1))
    materials[:, 0] += problem.stiffness(phases.materials)[0] - plain.stiffness(materials)[0]
    start = dataclasses.replace(phases, materials=materials)
    centre = np.tile(plain.homogeneous.params, (len(phases.labels), 1))
    found = _with_likeliest_materials(objective_at_end(plain, settings, centre), start, guesses, settings)
    return found if found is not None and found.complete else None


def _nearer(found: Estimate, objective: Objective, params, guesses) -> bool:
    """Whether phases explain the test, or miss displacements by less than other parameters do."""
    if not found.ambiguous:
        return True
    states = objective.problem.equilibrium.states(params, guesses)
    return states is None or float(found.history[-1]) < objective.misfit(states, found.linear)


def _labelled(objective: Objective, mixed: Shares, guesses) -> tuple[Phases, list] | None:
    """The phases that cells have most of once that changes no more, and states near by; None where it goes on.

    Displacements are weighted by the larger of their uncertainty and their present misfit, as in a descent.
    """
    problem, strategy = objective.problem, objective.strategy
    states, deflation, linear = problem.equilibrium.states(mixed.params, guesses), None, None
    damping = strategy.phase_damping[1]
    for _ in range(strategy.phase_rounds):
        if states is None:
            return None
        sigma = problem.sigma * max(1.0, objective.misfit(states, None))
        # The factors of the last linearisation make room for those of this one.
        linear = None
        linear = problem.linearise(mixed.params, states, sigma)
        direction, deflation = _direction(objective, mixed, states, linear, damping, deflation)
        before, labels = objective.misfits(states, sigma, linear), mixed.most.labels
        for fraction in strategy.fraction ** np.arange(strategy.scaled_trials):
            materials, share = (fraction * each for each in direction)
            trial = mixed.changed(mixed.phases.materials + materials, mixed.share + share)
            reached = _states(problem, trial.params, states, linear)
            if reached is not None and objective.misfits(reached, sigma, linear) < before:
                break
        else:
            damping *= strategy.material_damping[2]
            continue
        damping *= strategy.material_damping[int(fraction < strategy.short_step)]
        mixed, states = trial, reached
        if np.array_equal(mixed.most.labels, labels):
            return mixed.most, states
    return None


def _states(problem: FieldProblem, params, states, linear: Jacobian):
    """Equilibrium at other parameters, from states near by and their factors."""
    factors = [step.factor for step in linear.steps]
    return problem.equilibrium.states(params, [state.u for state in states], factors)


def _direction(objective: Objective, mixed: Shares, states, linear: Jacobian, damping: float, deflation):
    """((change of the materials, change of the shares), what the next system learns) of a Gauss-Newton step.

    Materials follow the shares, but for numbers that would go beyond where they may: these stop there first.
    """
    strategy, materials = objective.strategy, mixed.phases.materials
    by_materials, by_shares = mixed.by_materials, mixed.by_shares
    pull = objective.misfit_gradient(states, linear) + objective.ridge * (mixed.params.ravel() - objective.centre)
    answer = linear.curvature(by_materials.toarray())
    own = by_materials.T @ answer + (by_materials.T @ scipy.sparse.diags(objective.ridge) @ by_materials).toarray()
    crossed, of_materials, of_shares = by_shares.T @ answer, by_materials.T @ pull, by_shares.T @ pull
    x, lowest = materials.ravel(), np.tile(objective.problem.basis.lowest, len(materials))
    alone, _, going = bounded_step(x, of_materials, own, lowest, damping, strategy)
    stopped = np.where(going, 0.0, alone - x)
    followed = np.zeros(crossed.T.shape)
    damped = own + damping * np.diag(np.diag(own))
    followed[going] = np.linalg.solve(damped[np.ix_(going, going)], crossed.T[going])
    free = mixed.free(of_shares)
    signs = np.random.default_rng(0).choice([-1.0, 1.0], len(free))
    typical = float(np.mean(signs * (by_shares.T @ linear.curvature(by_shares @ signs))))

    def product(x):
        """The curvature by the free shares, whose materials follow; the others are left alone."""
        some = (free * x.T).T
        change = by_shares.T @ linear.curvature(by_shares @ some) - crossed @ (followed @ some)
        return np.where(free, change.T, typical * x.T).T

    metric = typical * scipy.sparse.identity(len(free), format="csc")
    solver = DeflatedCG(product, metric, strategy.deflated_directions, deflation)
    downhill = followed.T @ (of_materials + damped @ stopped) - of_shares - crossed @ stopped
    solved = solver.solve(np.where(free, downhill, 0.0), strategy.cg_tolerance[1], strategy.cg_iterations[0])
    changed, *_ = bounded_step(x, of_materials + crossed.T @ solved.x, own, lowest, damping, strategy)
    return ((changed - x).reshape(materials.shape), solved.x), solved.deflation


def _with_likeliest_materials(objective: Objective, phases: Phases, guesses, settings: Constrained) -> Estimate | None:
    """The likeliest materials of phases, by steps of Levenberg and Marquardt; None where there is no equilibrium.

    Coefficients are curved functions of their parameters near zero, so that valleys are, and how much damping a step
    needs is remembered for the next.
    """
    problem, strategy, shape = objective.problem, objective.strategy, phases.materials.shape
    columns, lowest = phases.columns.toarray(), np.tile(problem.basis.lowest, shape[0])
    # Of a material there is one, however many cells it has.
    ridge, centre = (np.tile(each[: shape[1]], shape[0]) for each in (objective.ridge, objective.centre))
    states = problem.equilibrium.states(phases.params, [state.u for state in guesses])
    if states is None:
        return None
    damping, linear, history, gained = strategy.phase_damping[1], None, [], [np.inf]
    least, ending = settings.tolerance * problem.cost_of_noise, Ending.OUT_OF_ITERATIONS
    for _ in range(settings.iterations):
        linear = None
        linear = problem.linearise(phases.params, states, problem.sigma)
        history.append(objective.misfit(states, linear))
        x = phases.materials.ravel()
        cost = _cost(objective, x, states, linear, ridge, centre)
        answer = linear.product(columns)
        gradient = answer.T @ np.concatenate(objective.residuals(states, linear.sigma, linear)) + ridge * (x - centre)
        curvature = answer.T @ answer + np.diag(ridge)
        if bounded_step(x, gradient, curvature, lowest, 0.0, strategy)[1] < least:
            ending = Ending.CONVERGED
            break
        # Along a curved valley a step may gain little, and the next one much.
        if sum(gained[-3:]) < least:
            ending = Ending.STAGNATED
            break
        for _ in range(len(strategy.phase_damping)):
            changed, gain, _ = bounded_step(x, gradient, curvature, lowest, damping, strategy)
            trial = dataclasses.replace(phases, materials=changed.reshape(shape))
            reached = _states(problem, trial.params, states, linear)
            after = np.inf if reached is None else _cost(objective, changed, reached, linear, ridge, centre)
            if after < cost:
                break
            damping *= strategy.material_damping[2]
        else:
            ending = Ending.STAGNATED
            break
        phases, states = trial, reached
        gained.append(cost - after)
        damping *= strategy.material_damping[int(gained[-1] < strategy.short_step * gain)]
    cost = objective.value(phases.params, states, problem.sigma, linear)
    return Estimate(objective, linear, phases.params, states, np.array(history), cost, ending, None, phases)


def _cost(objective: Objective, x, states, linear: Jacobian, ridge, centre) -> float:
    return objective.misfits(states, linear.sigma, linear) + 0.5 * float(ridge @ (x - centre) ** 2)
