"""One descent to the material field that explains a measurement, by damped Gauss-Newton steps."""

import dataclasses

import numpy as np

from hypernode.config.methods import Constrained
from hypernode.errors import ExpectedError
from hypernode.fem.transfer import transfer
from hypernode.identification import budgets, numerics, priors, thresholds
from hypernode.identification.estimate import Estimate
from hypernode.identification.objective import Objective
from hypernode.identification.problem import FieldProblem
from hypernode.identification.regulariser import JumpCost, Regulariser, unit_length
from hypernode.mechanics.convex_basis import FIBRE_VECTOR
from hypernode.progress import Progress, say
from hypernode.verdict import Ending


class IdentificationError(ExpectedError, RuntimeError):
    """No material field could be found; the message says at which iteration and why."""


def first_field(problem: FieldProblem, before: Estimate | None):
    """(parameters by cell, centre of the ridge, guesses of the states) for a descent, which may follow another.

    Fibres have no gradient at zero stiffness, so they begin slightly above. The ridge is centred at zero, so they
    vanish where the data do not determine them.
    """
    names, cells = problem.basis.names, len(problem.mesh.cells)
    smallest = numerics.SMALLEST_FIBRE
    centre = np.tile(problem.homogeneous.params, (cells, 1))
    params = centre.copy()
    fibre = [k for k, key in enumerate(names) if key in FIBRE_VECTOR]
    centre[:, fibre] = 0.0
    if fibre and np.linalg.norm(problem.homogeneous.params[fibre]) < smallest:
        params[:, fibre] = smallest, 0.0
    if before is None:
        return params, centre, problem.equilibrium.extension(params)
    # Other terms of the homogeneous fit are stiffness too; only the differences between cells are kept.
    known = [names.index(name) for name in before.problem.basis.names]
    found, u = before.params, [state.u for state in before.states]
    if len(before.problem.mesh.cells) != cells:
        onto = transfer(before.problem.mesh, problem.mesh)
        found, u = found[onto.cells], [onto.nodes @ each for each in u]
    params[:, known] = problem.homogeneous.params[known] + (found - before.problem.homogeneous.params)
    return params, centre, u


def _objective(problem: FieldProblem, settings: Constrained, centre, scale: float | None) -> Objective:
    """What a descent minimises; ``centre`` is where the ridge pulls all parameters but the stiffness."""
    ridge = np.tile(np.where(np.arange(centre.shape[1]) == 0, 0.0, priors.RIDGE**2), len(centre))
    unit = unit_length(problem.observations.grid.areas)
    regulariser = Regulariser(mesh=problem.mesh, names=problem.basis.names, unit=unit, stiffness=problem.stiffness)
    cost = JumpCost(priors.SMALLEST_JUMP, scale)
    return Objective(
        problem=problem,
        regulariser=regulariser,
        regulariser_weight=settings.regulariser_weight,
        jump_cost=cost,
        ridge=ridge,
        centre=centre.ravel(),
    )


def objective_at_end(problem: FieldProblem, settings: Constrained, centre) -> Objective:
    """The objective at the end of the last descent to a field; ``centre`` as in a descent."""
    objective = _objective(problem, settings, centre, settings.jump_scale)
    return dataclasses.replace(objective, jump_cost=_last_cost(problem, settings, sharpen=problem.sharp))


def _last_cost(problem: FieldProblem, settings: Constrained, sharpen: bool) -> JumpCost:
    finest = priors.SHARP_JUMP if sharpen else priors.SMALLEST_JUMP
    return JumpCost(finest, settings.jump_scale, isotropic=True)


def descend(
    problem: FieldProblem,
    settings: Constrained,
    name: str,
    before: Estimate | None,
    tolerance: float,
    move: str = "the terms from the homogeneous sheet",
) -> Estimate:
    """The parameter field whose equilibrium is closest to the data, and its states.

    Displacements are weighted by the larger of their noise and their present misfit. Early iterations, far from the
    solution, are then not dominated by small residuals.

    Args:
        settings: configuration of the stage.
        name: case, for progress and messages.
        before: start, the result of a descent with these terms or fewer, on this mesh or a coarser one. The homogeneous
            sheet if left out.
        tolerance: decrease of the cost in one iteration, over the cost of noise, at which it ends once the data are
            explained.
        move: what is tried, in words, for the record.

    Raises:
        IdentificationError: no equilibrium at the homogeneous start.
    """
    params, centre, guesses = first_field(problem, before)
    states = problem.equilibrium.states(params, guesses)
    if states is None and before is not None:
        # Equilibrium under other terms may be out of reach of Newton's method from there.
        return descend(problem, settings, name, None, tolerance, move)
    if states is None:
        raise IdentificationError(
            f"constrained field of {name}: no equilibrium for the homogeneous material; are the prescribed edges "
            "smooth, and is every load step one state of the same test?"
        )
    # What was found before has its jumps already: nothing is gained by making them cost more again. On a finer grid
    # they are near their places only, and jumps that cost their size find these.
    jumps = before is not None and len(before.params) == len(params)
    objective = _objective(problem, settings, centre, settings.jump_scale if jumps else None)
    final = _last_cost(problem, settings, sharpen=problem.sharp)
    stage = f"constrained field ({described(problem)})"
    progress = Progress(stage, name, settings.iterations)
    damping, history, linear, step = numerics.FIRST_DAMPING, [objective.misfit(states, None)], None, None
    ending = Ending.OUT_OF_ITERATIONS
    for iteration in range(settings.iterations):
        sigma = problem.sigma * max(1.0, history[-1])
        # A linearisation is the largest thing in memory: the last one goes before the next one is made.
        linear = None
        linear = problem.linearise(params, states, sigma)
        cost = objective.value(params, states, sigma, linear)
        explained = history[-1] <= thresholds.EXPLAINED
        step = objective.gauss_newton(linear, params, states, damping, explained, step and step.deflation)
        found = _line_search(objective, linear, params, states, step.change, cost)
        if found is None:
            if damping > numerics.LARGEST_DAMPING:
                ending = Ending.STAGNATED
                break
            damping = max(numerics.DAMPING_AFTER_FAILURE * damping, numerics.FIRST_DAMPING)
            progress.advance(misfit=history[-1], cost=cost)
            continue
        params, states, after, fraction = found
        damping = _next_damping(damping, fraction)
        history.append(objective.misfit(states, linear))
        progress.advance(misfit=history[-1], cost=after)
        jump_cost = objective.jump_cost
        close = history[-1] <= thresholds.EXPLAINED
        if jump_cost.scale is None and (close or iteration + 1 >= budgets.CONVEX_STEPS):
            jump_cost = dataclasses.replace(jump_cost, scale=settings.jump_scale)
        else:
            settled = close and jump_cost.isotropic and cost - after < tolerance * problem.cost_of_noise
            if settled and jump_cost.smallest == final.smallest:
                ending = Ending.CONVERGED
                break
            jump_cost = dataclasses.replace(jump_cost, smallest=final.smallest if settled else jump_cost.smallest)
        jump_cost = dataclasses.replace(jump_cost, isotropic=jump_cost.isotropic or bool(close))
        objective = dataclasses.replace(objective, jump_cost=jump_cost)
    objective = dataclasses.replace(objective, jump_cost=final)
    if not problem.certain:
        linear = None
        linear = problem.linearise(params, states, problem.sigma)
    cost = objective.value(params, states, problem.sigma, linear)
    estimate = Estimate(
        objective=objective,
        linear=linear,
        params=params,
        states=states,
        history=np.array(history),
        cost=cost,
        ending=ending,
        step=step,
    )
    estimate = estimate.recorded(move, before)
    say(stage, name, f"{ending} after {len(history) - 1} of at most {settings.iterations} steps: {estimate.summary}")
    return estimate


def described(problem: FieldProblem) -> str:
    """The terms of a problem's basis in words."""
    return ", ".join(problem.basis.terms) or "neo-Hookean"


def _next_damping(damping: float, fraction: float) -> float:
    """Less after a whole step, more after a short one."""
    if fraction >= numerics.WHOLE_STEP:
        return max(numerics.DAMPING_AFTER_SUCCESS * damping, numerics.SMALLEST_DAMPING)
    return numerics.DAMPING_AFTER_SHORT_STEP * damping if fraction < numerics.SHORT_STEP else damping


def _line_search(objective: Objective, linear, params, states, change, before: float):
    """(parameters, states, cost, fraction) at the longest of a few fractions of ``change`` that lowers the cost.

    None where there is no such fraction.
    """
    longest = 1.0 if objective.jump_cost.scale is None else numerics.OVER_RELAXATION
    # Few parameters ask for long steps, where data say little of them; they must not hold the others up.
    # A clipped step need not lead downhill, though; a short enough one in the whole step's direction does.
    clipped = np.clip(change, -numerics.LARGEST_STEP, numerics.LARGEST_STEP)
    scaled = change * min(1.0, numerics.LARGEST_STEP / max(np.abs(change).max(), np.finfo(float).tiny))
    factors = [step.factor for step in linear.steps]
    # A coefficient may be below none on the way: it comes back from there.
    bounds = objective.problem.bounds.copy()
    bounds[0, 1:] = -np.inf
    fractions = (
        (clipped, longest * numerics.SEARCH_FACTOR ** np.arange(budgets.CLIPPED_TRIALS)),
        (scaled, numerics.SEARCH_FACTOR ** np.arange(budgets.SCALED_TRIALS)),
    )
    for direction, lengths in fractions:
        du = linear.displacement(direction)
        for fraction in lengths:
            trial = np.clip(params + fraction * direction.reshape(params.shape), *bounds)
            guesses = []
            for state, d in zip(states, du, strict=True):
                guess = state.u.ravel().copy()
                guess[state.free] += fraction * d
                guesses.append(guess.reshape(-1, 2))
            reached = objective.problem.equilibrium.states(trial, guesses, factors)
            if reached is not None:
                after = objective.value(trial, reached, linear.sigma, linear)
                if after < before:
                    return trial, reached, after, fraction
    return None
