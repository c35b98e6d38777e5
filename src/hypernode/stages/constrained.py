"""Equilibrium as a constraint: the material field whose finite-element solution is what was measured.

Displacements are data here, not input. The unknown is a field of convex-basis coefficients, one set a
cell; for every guess JAX-FEM solves the equilibrium of each load step, and the misfit of displacements
and edge forces, in units of their noise, is reduced together with the jumps of the field by
Gauss-Newton steps. Nothing measured is ever differentiated, so noise hardly matters.

The stiffness alone comes first: one number a cell finds where the material changes, along a path without the
valleys that all coefficients together make. From there the other terms are released.
"""

import dataclasses
import functools
import json
import sys

import numpy as np

from hypernode.config import Constrained
from hypernode.errors import ExpectedError
from hypernode.mechanics.convex_basis import FIBRE_VECTOR
from hypernode.progress import Progress
from hypernode.stages.field_problem import FieldProblem
from hypernode.stages.jumps import Jumps
from hypernode.stages.objective import Objective
from hypernode.storage.netcdf import read, units_of, write

#: Weight of the squared distance from the homogeneous fit, small: it decides only what data leave open.
RIDGE = 0.02
#: Iterations with total variation before jumps above ``jump_scale`` stop costing more.
CONVEX_ITERATIONS = 5
#: Length of the fibre vector from which it can grow.
SMALLEST_FIBRE = 0.01
#: Largest change of a parameter in one step.
LARGEST_STEP = 1.0
#: Damping beyond which no descent is left to find.
LARGEST_DAMPING = 1e6
#: Share of the cost below which misfits leave nothing to explain: without noise, that of a neo-Hookean sheet is a few
#: thousandths, and that of any other nearly one.
NOTHING_LEFT = 0.02
#: A displacement misfit this close to its noise counts as explained.
CLOSE = 1.05
#: Misfits of displacements and of forces, over their uncertainties, beyond which a test is not explained. The forces of
#: good fields are missed by one to three uncertainties: a thousandth.
UNEXPLAINED, FORCES_UNEXPLAINED = 2.0, 4.0
#: Standard deviations by which the misfit of displacements of known noise may exceed that noise by chance.
CHANCE = 1.0
#: Size below which jumps are smoothed in the end where displacements have noise, which would hide in gentle slopes that
#: cost nothing. On the way so sharp a bend makes many local minima.
SHARP_JUMP = 0.005
#: First step tried once jumps stop costing more. A step minimises a quadratic that lies above the
#: penalty, and so falls short of where the penalty leads.
OVER_RELAXATION = 1.7
#: What jumps cost for a few iterations, to leave one of the many minima that noise makes: factors of the weight and of
#: the size above which jumps stop costing more, and how many iterations.
SHAKES = ((0.2, 1.0, 6), (1.0, 10.0, 4))


@dataclasses.dataclass(frozen=True)
class Plateau:
    """Where a descent ends early because other terms follow: its misfit hardly falls any more.

    Attributes:
        share, iterations: less than this share of the misfit in this many iterations, beyond the convex start.
        above: misfit below which it goes on regardless.
    """

    share: float
    iterations: int
    above: float = 0.0

    def reached(self, history) -> bool:
        """Whether the last misfit lies on it."""
        followed = len(history) > CONVEX_ITERATIONS + self.iterations
        return followed and history[-1] > max(self.above, (1.0 - self.share) * history[-1 - self.iterations])


#: Before more terms follow, the stiffness is good enough there, or once its cost has fallen by less than
#: ``PLAIN_TOLERANCE`` in one iteration.
PLAIN_PLATEAU, PLAIN_TOLERANCE = Plateau(0.2, 3), 3e-3
#: Where further terms may follow, a test that is not explained waits for them there.
UNEXPLAINED_PLATEAU = Plateau(0.1, 5, above=UNEXPLAINED)


class IdentificationError(ExpectedError, RuntimeError):
    """No material field could be found; the message says at which iteration and why."""


@dataclasses.dataclass
class Found:
    """Where a descent ended: parameters by cell, equilibrium states, misfits in units of the noise.

    ``cost`` is the whole objective there, minus the logarithm of how probable the field is after the test.
    """

    objective: Objective
    params: np.ndarray
    states: list
    history: np.ndarray
    cost: float

    @property
    def problem(self) -> FieldProblem:
        """The test, and the equilibrium that ties a field to it."""
        return self.objective.problem

    @property
    def force_misfit(self) -> float:
        """Root mean square of the misfit of the forces, in units of their uncertainty."""
        return self.objective.force_misfit(self.states)

    @property
    def unexplained(self) -> float:
        """The larger of the two misfits over what is still taken to be explained: beyond one, it is not."""
        return max(self.history[-1] / UNEXPLAINED, self.force_misfit / FORCES_UNEXPLAINED)

    @property
    def data_share(self) -> float:
        """Share of the cost that misfits make up: all that further terms could take away."""
        return self.objective.misfits(self.states, self.problem.sigma) / self.cost

    @property
    def doubtful(self) -> bool:
        """Whether the test is not explained, or leaves more of noisy displacements than their noise does by chance."""
        by_chance = 1.0 + CHANCE / (2.0 * np.sqrt(self.problem.cost_of_noise))
        return self.unexplained > 1.0 or (self.problem.noisy and self.history[-1] > by_chance)


def identify(measurement, settings: Constrained, name: str) -> Found:
    """The material field that explains a measurement: the stiffness alone, then the terms of the basis.

    None follows where the stiffness leaves nothing to explain, as it does without noise where a sheet is neo-Hookean.
    Where the terms leave doubt, all at once are released from the homogeneous sheet, since a stiffness that had to
    stand for other terms may mislead; where the test is still not explained, the further terms as well, which would
    only make longer valleys where they are not needed. Of what was tried the most probable field is kept.

    Raises:
        IdentificationError: no equilibrium at the homogeneous start.
    """

    @functools.cache
    def problem_of(*terms):
        return FieldProblem(measurement, settings.model_copy(update={"terms": list(terms)}))

    def with_terms(terms, before, plateau, tolerance=settings.tolerance):
        reached = descend(problem_of(*terms), settings, name, before, plateau, tolerance)
        path = [] if before is None else [before.history]
        return dataclasses.replace(reached, history=np.concatenate([*path, reached.history]))

    # Whether the sheet is compressible is no term among others: it says what the stiffness means.
    first = [term for term in settings.terms if term == "J"]
    further = UNEXPLAINED_PLATEAU if settings.further_terms else None
    if settings.terms == first:
        plain = with_terms(first, None, further)
        tried = [plain]
    else:
        plain = with_terms(first, None, PLAIN_PLATEAU, PLAIN_TOLERANCE)
        if plain.data_share < NOTHING_LEFT:
            return plain
        tried = [with_terms(settings.terms, plain, further)]
        if tried[0].doubtful:
            tried.append(with_terms(settings.terms, None, further))
    if settings.further_terms and min(each.unexplained for each in tried) > 1.0:
        tried.append(with_terms([*settings.terms, *settings.further_terms], plain, None))
    found = _shaken(min(tried, key=lambda each: each.cost), settings, name)
    if found.history[-1] > UNEXPLAINED:
        print(
            f"warning: constrained field of {name}: displacements are missed by {found.history[-1]:.1f} times their "
            f"noise. The terms ({_described(found.problem)}) do not explain this test, or "
            "the descent ended early: trust no number of this field; add further_terms or iterations",
            file=sys.stderr,
        )
    return found


def _shaken(found: Found, settings: Constrained, name: str) -> Found:
    """The best of what descents lead to that begin at ``found`` after jumps have cost something else for a while.

    Only where noise makes minima, and not through a correlation window, where what is gained is not worth the time.
    """
    if not found.problem.sharp:
        return found
    for weight, scale, iterations in SHAKES:
        other = {
            "jump_weight": weight * settings.jump_weight,
            "jump_scale": scale * settings.jump_scale,
            "iterations": min(iterations, settings.iterations),
        }
        away = descend(found.problem, settings.model_copy(update=other), name, found, None, 0.0)
        back = descend(found.problem, settings, name, away, None, settings.tolerance)
        history = np.concatenate([found.history, away.history, back.history])
        found = min(found, dataclasses.replace(back, history=history), key=lambda each: each.cost)
    return found


def _first_field(problem: FieldProblem, before: Found | None):
    """(parameters by cell, where the ridge pulls them) of a descent that follows that of the stiffness alone.

    Fibres that no force tells of have no gradient at zero, so they begin a little above; but none is what the
    ridge prefers, so that they vanish where the data say nothing of them.
    """
    names, cells = problem.basis.names, len(problem.mesh.cells)
    centre = np.tile(problem.homogeneous, (cells, 1))
    params = centre.copy()
    fibre = [names.index(key) for key in FIBRE_VECTOR if key in names]
    centre[:, fibre] = 0.0
    # Other terms of the homogeneous fit are stiffness too; only the differences between cells are kept.
    if before is not None:
        known = [names.index(name) for name in before.problem.basis.names]
        params[:, known] += before.params - before.problem.homogeneous
    if fibre and np.linalg.norm(params[0, fibre]) < SMALLEST_FIBRE:
        params[:, fibre] = SMALLEST_FIBRE, 0.0
    return params, centre


def _objective(problem: FieldProblem, settings: Constrained, centre) -> Objective:
    """What a descent minimises; ``centre`` is where the ridge pulls all parameters but the stiffness."""
    ridge = np.tile(np.where(np.arange(centre.shape[1]) == 0, 0.0, RIDGE**2), len(centre))
    jumps = Jumps(problem.mesh, problem.basis.names, problem.stiffness)
    return Objective(problem, jumps, settings.jump_weight, ridge, centre.ravel())


def descend(
    problem: FieldProblem,
    settings: Constrained,
    name: str,
    before: Found | None,
    plateau: Plateau | None,
    tolerance: float,
) -> Found:
    """The parameter field whose equilibrium is closest to the data, and its states.

    Displacements are weighted by the larger of their noise and their present misfit, so that early
    iterations, far from the solution, are not ruled by the last digit.

    Args:
        before: what the stiffness alone found, to begin from; the homogeneous sheet without it.
        plateau: where it ends early, if other terms may follow.
        tolerance: decrease of the cost in one iteration, over the cost of noise, at which it ends once the data are
            explained.

    Raises:
        IdentificationError: no equilibrium at the homogeneous start.
    """
    params, centre = _first_field(problem, before)
    guesses = problem.extension(params) if before is None else [state.u for state in before.states]
    states = problem.states(params, guesses)
    if states is None:
        raise IdentificationError(
            f"constrained field of {name}: no equilibrium for the homogeneous material; are the held edges "
            "smooth, and is every load step one state of the same test?"
        )
    objective = _objective(problem, settings, centre)
    jumps = objective.jumps
    # What the stiffness alone found has its jumps already: nothing is gained by making them cost more again.
    jumps.scale = None if before is None else settings.jump_scale
    # There is nothing to sharpen yet where other terms follow for certain.
    finest = SHARP_JUMP if problem.sharp and tolerance <= settings.tolerance else jumps.smallest
    progress = Progress(f"constrained field ({_described(problem)})", name, settings.iterations)
    damping, history = 1.0, [objective.misfit(states)]
    for iteration in range(settings.iterations):
        sigma = problem.sigma * max(1.0, history[-1])
        objective.linearise(params, states, sigma)
        cost = objective.value(params, states, sigma)
        step = objective.gauss_newton(params, states, damping, history[-1] <= CLOSE)
        longest = 1.0 if jumps.scale is None else OVER_RELAXATION
        found = _line_search(objective, params, states, sigma, step, cost, longest)
        if found is None:
            if damping > LARGEST_DAMPING:
                break
            damping = max(100.0 * damping, 1.0)
            progress.advance(misfit=history[-1], cost=cost)
            continue
        params, states, after, fraction = found
        damping = max(damping / 4, 1e-4) if fraction >= 0.99 else 4 * damping if fraction < 0.5 else damping
        history.append(objective.misfit(states))
        progress.advance(misfit=history[-1], cost=after)
        close = history[-1] <= CLOSE
        if jumps.scale is None and (close or iteration + 1 >= CONVEX_ITERATIONS):
            jumps.scale = settings.jump_scale
        else:
            settled = close and jumps.isotropic and cost - after < tolerance * problem.cost_of_noise
            if (settled and jumps.smallest == finest) or (plateau and plateau.reached(history)):
                break
            jumps.smallest = finest if settled else jumps.smallest
        jumps.isotropic = jumps.isotropic or bool(close)
    jumps.scale, jumps.isotropic, jumps.smallest = settings.jump_scale, True, finest
    if problem.noisy:
        objective.linearise(params, states, problem.sigma)
    cost = objective.value(params, states, problem.sigma)
    return Found(objective, params, states, np.array(history), cost)


def _described(problem: FieldProblem) -> str:
    """The terms of a problem's basis in words."""
    return ", ".join(problem.basis.terms) or "neo-Hookean"


def _line_search(objective, params, states, sigma, change, before, longest):
    """The longest of a few fractions of ``change`` that lowers the cost, or None."""
    # Few parameters ask for long steps, where data say little of them; they must not hold the others up.
    # A clipped step need not lead downhill, though; a short enough one in the whole step's direction does.
    clipped = np.clip(change, -LARGEST_STEP, LARGEST_STEP)
    scaled = change * min(1.0, LARGEST_STEP / max(np.abs(change).max(), 1e-300))
    for direction, fractions in ((clipped, longest * 0.4 ** np.arange(2)), (scaled, 0.4 ** np.arange(5))):
        du = objective.linear.displacement(direction)
        for fraction in fractions:
            trial = params + fraction * direction.reshape(params.shape)
            guesses = []
            for state, d in zip(states, du, strict=True):
                guess = state.u.ravel().copy()
                guess[state.free] += fraction * d
                guesses.append(guess.reshape(-1, 2))
            reached = objective.problem.states(trial, guesses, objective.linear.factors)
            if reached is not None:
                after = objective.value(trial, reached, sigma)
                if after < before:
                    return trial, reached, after, fraction
    return None


def run(settings: Constrained, name: str, measurement_file: str, output: str, attributes: dict) -> None:
    """Identify the field of basis coefficients and write its equilibrium states.

    Args:
        settings: the method's ``constrained`` section.

    Raises:
        IdentificationError: no equilibrium at the homogeneous start.
    """
    measurement = read(measurement_file)
    found = identify(measurement, settings, name)
    problem, params, states, history = found.problem, found.params, found.states, found.history
    u = np.stack([state.u for state in states])
    variables = {key: measurement[key].values for key in ("X", "cells", "corners", "test", "stretch")}
    variables |= {"u": u, "loss": history, "loss_iteration": np.arange(len(history))}
    variables |= {f"basis.{key}": (("cell",), params[:, index]) for index, key in enumerate(problem.basis.names)}
    # Without noise there is nothing that a test cannot tell apart by chance.
    if settings.draws and problem.noisy:
        draws = found.objective.draws(params, settings.draws, settings.seed)
        variables |= {f"draw.{key}": (("draw", "cell"), draws[..., k]) for k, key in enumerate(problem.basis.names)}
    if "F_truth" in measurement:
        variables["F_truth"] = measurement["F_truth"].values
    write(
        output,
        variables,
        f"equilibrium field of {name}",
        {
            **attributes,
            "units": units_of(measurement),
            "material_kind": "convex_basis",
            "basis": json.dumps(dataclasses.asdict(problem.basis)),
            "displacement_sigma": problem.sigma,
            "displacement_misfit": float(history[-1]),
            "force_misfit": found.force_misfit,
            "homogeneous_force_misfit": problem.force_misfit.tolist(),
        },
        parents=[measurement_file],
    )
