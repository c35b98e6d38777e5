"""One descent to the material field that explains a measurement, by damped Gauss-Newton steps."""

import dataclasses

import numpy as np

from hypernode.config.methods import Constrained
from hypernode.errors import ExpectedError
from hypernode.identification.objective import Objective
from hypernode.identification.problem import FieldProblem
from hypernode.identification.regulariser import Jumps
from hypernode.mechanics.convex_basis import FIBRE_VECTOR
from hypernode.progress import Progress

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


#: A displacement misfit this close to its noise counts as explained.
CLOSE = 1.05


#: Misfits of displacements and of forces, over their uncertainties, beyond which a test is not explained. The forces of
#: good fields are missed by one to three uncertainties: a thousandth.
UNEXPLAINED, FORCES_UNEXPLAINED = 2.0, 4.0


#: Standard deviations by which the misfit of displacements of known noise may exceed that noise by chance, and beyond
#: which it never does.
CHANCE, NO_CHANCE = 1.0, 3.0


#: Share of the cost that misfits without noise have where the terms do not contain the material: half and more. Where
#: they do, a few hundredths.
MUCH_LEFT = 0.3


#: Size below which jumps are smoothed in the end where displacements have noise, which would hide in gentle slopes that
#: cost nothing. On the way so sharp a bend makes many local minima.
SHARP_JUMP = 0.005


#: First step tried once jumps stop costing more. A step minimises a quadratic that lies above the
#: penalty, and so falls short of where the penalty leads.
OVER_RELAXATION = 1.7


@dataclasses.dataclass(frozen=True)
class Plateau:
    """Where a descent ends early because other terms follow: its misfit hardly falls any more.

    Attributes:
        share, iterations: less than this share of the misfit in this many iterations, beyond the convex start.
        above: misfit below which it goes on regardless.
        left: share of the cost that misfits have, below which it goes on as well.
    """

    share: float
    iterations: int
    above: float = 0.0
    left: float = 0.0

    def reached(self, history, data_share: float) -> bool:
        """Whether the last misfit lies on it, which has that share of the cost."""
        if len(history) <= CONVEX_ITERATIONS + self.iterations or data_share < self.left:
            return False
        return history[-1] > max(self.above, (1.0 - self.share) * history[-1 - self.iterations])


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
    def excess(self) -> float:
        """How much more of noisy displacements is left than their noise, in standard deviations of that by chance."""
        return 2.0 * np.sqrt(self.problem.cost_of_noise) * (self.history[-1] - 1.0) if self.problem.noisy else 0.0

    @property
    def ambiguous(self) -> bool:
        """Whether the test is not explained, or leaves more of noisy displacements than their noise does by chance."""
        return self.unexplained > 1.0 or self.excess > CHANCE

    @property
    def underfitted(self) -> bool:
        """Whether no field of these terms explains the test, as far as this one tells."""
        much = self.excess > NO_CHANCE if self.problem.noisy else self.data_share > MUCH_LEFT
        return self.unexplained > 1.0 or much

    def at(self, params) -> "Found | None":
        """The same test with other parameters, or None where they have no equilibrium within reach."""
        states = self.problem.states(params, [state.u for state in self.states])
        if states is None:
            return None
        cost = self.objective.value(params, states, self.problem.sigma)
        return dataclasses.replace(self, params=params, states=states, cost=cost)


def _first_field(problem: FieldProblem, before: Found | None):
    """(parameters by cell, where the ridge pulls them, guesses of the states) of a descent, which may follow another.

    Fibres that no force tells of have no gradient at zero, so they begin a little above; but none is what the
    ridge prefers, so that they vanish where the data say nothing of them.
    """
    names, cells = problem.basis.names, len(problem.mesh.cells)
    centre = np.tile(problem.homogeneous, (cells, 1))
    params = centre.copy()
    fibre = [k for k, key in enumerate(names) if key in FIBRE_VECTOR]
    centre[:, fibre] = 0.0
    if fibre and np.linalg.norm(problem.homogeneous[fibre]) < SMALLEST_FIBRE:
        params[:, fibre] = SMALLEST_FIBRE, 0.0
    if before is None:
        return params, centre, problem.extension(params)
    # Other terms of the homogeneous fit are stiffness too; only the differences between cells are kept.
    known = [names.index(name) for name in before.problem.basis.names]
    found, u = before.params, [state.u for state in before.states]
    if problem.divided and not before.problem.divided:
        found, u = problem.inherited(found, u)
    params[:, known] = problem.homogeneous[known] + (found - before.problem.homogeneous)
    return params, centre, u


def _objective(problem: FieldProblem, settings: Constrained, centre) -> Objective:
    """What a descent minimises; ``centre`` is where the ridge pulls all parameters but the stiffness."""
    ridge = np.tile(np.where(np.arange(centre.shape[1]) == 0, 0.0, RIDGE**2), len(centre))
    jumps = Jumps(problem.mesh, problem.basis.names, np.sqrt(problem.grid.areas.mean()), problem.stiffness)
    return Objective(problem, jumps, settings.regulariser_weight, ridge, centre.ravel())


def descend(
    problem: FieldProblem,
    settings: Constrained,
    name: str,
    before: Found | None,
    plateaus: tuple[Plateau, ...],
    tolerance: float,
) -> Found:
    """The parameter field whose equilibrium is closest to the data, and its states.

    Displacements are weighted by the larger of their noise and their present misfit, so that early
    iterations, far from the solution, are not ruled by the last digit.

    Args:
        before: what a descent found with these terms or fewer, of these cells or of those that they divide, to begin
            from; the homogeneous sheet without it.
        plateaus: where it ends early, if other terms may follow.
        tolerance: decrease of the cost in one iteration, over the cost of noise, at which it ends once the data are
            explained.

    Raises:
        IdentificationError: no equilibrium at the homogeneous start.
    """
    params, centre, guesses = _first_field(problem, before)
    states = problem.states(params, guesses)
    if states is None and before is not None:
        # Equilibrium under other terms may be out of reach of Newton's method from there.
        return descend(problem, settings, name, None, plateaus, tolerance)
    if states is None:
        raise IdentificationError(
            f"constrained field of {name}: no equilibrium for the homogeneous material; are the held edges "
            "smooth, and is every load step one state of the same test?"
        )
    objective = _objective(problem, settings, centre)
    jumps = objective.jumps
    # What was found before has its jumps already: nothing is gained by making them cost more again.
    jumps.scale = None if before is None else settings.jump_scale
    # There is nothing to sharpen yet where other terms follow for certain.
    finest = SHARP_JUMP if problem.sharp and tolerance <= settings.tolerance else jumps.smallest
    progress = Progress(f"constrained field ({described(problem)})", name, settings.iterations)
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
            if settled and jumps.smallest == finest:
                break
            if any(plateau.reached(history, objective.misfits(states, sigma) / after) for plateau in plateaus):
                break
            jumps.smallest = finest if settled else jumps.smallest
        jumps.isotropic = jumps.isotropic or bool(close)
    jumps.scale, jumps.isotropic, jumps.smallest = settings.jump_scale, True, finest
    if problem.noisy:
        objective.linearise(params, states, problem.sigma)
    cost = objective.value(params, states, problem.sigma)
    return Found(objective, params, states, np.array(history), cost)


def described(problem: FieldProblem) -> str:
    """The terms of a problem's basis in words."""
    return ", ".join(problem.basis.terms) or "neo-Hookean"


def _line_search(objective, params, states, sigma, change, before, longest):
    """The longest of a few fractions of ``change`` that lowers the cost, or None."""
    # Few parameters ask for long steps, where data say little of them; they must not hold the others up.
    # A clipped step need not lead downhill, though; a short enough one in the whole step's direction does.
    clipped = np.clip(change, -LARGEST_STEP, LARGEST_STEP)
    scaled = change * min(1.0, LARGEST_STEP / max(np.abs(change).max(), 1e-300))
    factors = [step.factor for step in objective.linear.steps]
    for direction, fractions in ((clipped, longest * 0.4 ** np.arange(2)), (scaled, 0.4 ** np.arange(5))):
        du = objective.linear.displacement(direction)
        for fraction in fractions:
            trial = params + fraction * direction.reshape(params.shape)
            guesses = []
            for state, d in zip(states, du, strict=True):
                guess = state.u.ravel().copy()
                guess[state.free] += fraction * d
                guesses.append(guess.reshape(-1, 2))
            reached = objective.problem.states(trial, guesses, factors)
            if reached is not None:
                after = objective.value(trial, reached, sigma)
                if after < before:
                    return trial, reached, after, fraction
    return None
