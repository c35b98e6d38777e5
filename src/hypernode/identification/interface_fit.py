"""Fit of materials and lines by damped Gauss-Newton steps with few unknowns.

The unknowns are the parameters of all materials and the displacements of points of the lines. The side of the
correlation window may be one more. Far from the solution the residual of the displacements serves as their noise.
"""

import dataclasses
from collections.abc import Sequence

import numpy as np

from hypernode.identification import numerics, priors, thresholds
from hypernode.identification.errors import EdgeAnswers
from hypernode.identification.interface_noise import Left, left_of
from hypernode.identification.interface_numbers import Derivatives, Numbers, numbers_of
from hypernode.identification.interfaces import Interfaces
from hypernode.identification.projected_newton import projected_steps
from hypernode.identification.seen_test import SeenTest
from hypernode.verdict import Ending


@dataclasses.dataclass(frozen=True, kw_only=True)
class Fit:
    """Where a descent ended.

    Attributes:
        field: materials and lines.
        steps: numbers of the load steps that count.
        states: equilibrium of every step, without its tangent, which would be most of the memory of a search.
        white: residuals over the believed noise, free of what edges share, by step.
        left: residuals of the displacements.
        misfit, forces: root mean squares of the residuals of displacements and forces.
        force_squared: squared misfit of the forces, whose errors are shared.
        cost, prior: half the squared residuals plus the prior, and the prior alone.
        determined: number of unknowns that the data determine, with the residual as the uncertainty of displacements.
        of_materials: how many of them belong to materials, with fixed lines.
        covariance: of the parameters of the materials, one material after the other, with such displacements.
        window, window_error: side of the window in points, its standard deviation, 0 where it is not sought.
        ending: how the descent ended.
        history: misfit before every step.
        edges: how residuals answer to errors of prescribed edges, by step.
    """

    field: Interfaces
    steps: list[int]
    states: list
    white: list[np.ndarray]
    left: Left
    misfit: float
    forces: float
    force_squared: float
    cost: float
    prior: float
    determined: float
    of_materials: float
    covariance: np.ndarray
    window: float
    window_error: float
    ending: Ending
    history: list[float]
    edges: Sequence[EdgeAnswers]


class InterfaceFit:
    """Descents on one test.

    Args:
        find_window: whether the side of the window is a number.
        move_lines: whether distances are.
        settled: whether lines are near their final position, so distances need not be recomputed.
    """

    def __init__(self, test: SeenTest, find_window: bool = False, move_lines: bool = True, settled: bool = False):
        self.test, self._finds, self._moves = test, find_window, move_lines
        self._window_error, self._measures = 0.0, move_lines and not settled
        #: Number of the damping with which the next step begins.
        self._damping = 0
        self._model: Derivatives | None = None
        self._latest: Derivatives | None = None

    def moves(self, field: Interfaces) -> list:
        """How the distances from each line follow when its points move."""
        return field.moves(numerics.LINE_REACH) if self._moves else field.still

    def _numbers(self, field: Interfaces, moves=None) -> Numbers:
        window = self.test.window if self._finds else None
        return numbers_of(self.test.problem, field, self.moves(field) if moves is None else moves, window)

    def descend(self, field: Interfaces, guesses, iterations: int) -> Fit | None:
        """Where a descent ends; None without equilibrium.

        Args:
            guesses: displacement of every step near its equilibrium.
        """
        test = self.test
        if (states := test.states(field, guesses)) is None:
            return None
        history, ending, sigma = [], Ending.OUT_OF_ITERATIONS, np.inf
        self._model = self._latest = None
        self._damping = 0
        for number in range(iterations):
            if self._measures and number in numerics.MEASURED_ANEW:
                anew = field.measured_anew(thresholds.FEWEST_NODES)
                again = test.states(anew, [u for u, _, _ in states])
                field, states = (field, states) if again is None else (anew, again)
                self._model = self._latest = None
                self._damping = 0
            sigma = test.sigma_of(states, sigma)
            history.append(test.left(states))
            fresh = self._model is None and not self._damping
            moved, before, gained = self._step(field, states, sigma)
            # What is gained far below noise is nothing.
            small = gained < max(
                numerics.DESCENT_GAIN, numerics.RELATIVE_DESCENT_GAIN * max(before, 0.5 * test.observed)
            )
            if moved is not None:
                field, states = moved
            if not fresh and (moved is None or small):
                # Old derivatives and damped steps say nothing of the end.
                self._model, self._damping = None, 0
            elif moved is None:
                ending = Ending.CONVERGED if small else Ending.STAGNATED
                break
            elif small and number >= numerics.SETTLED * (self._measures and field.count > 1):
                ending = Ending.CONVERGED
                break
        return self._fit(field, states, ending, history)

    def _followed(self, field: Interfaces, states) -> Derivatives:
        """Derivatives at a field."""
        moves, test = self.moves(field), self.test
        answers = list(test.answers(states, test.loads(field, states, moves)))
        return Derivatives(moves, answers, test.by_window(states, 1.0) if self._finds else None)

    def _step(self, field: Interfaces, states, sigma: float):
        """((field, states) after a step that lowers the cost, or None; cost before; by how much it fell, or should)."""
        test, fresh = self.test, self._model is None
        model = self._followed(field, states) if fresh else self._model
        numbers, self._model, self._latest = self._numbers(field, model.moves), None, model
        shared, residuals = test.shared(states, sigma), test.residuals(states, sigma)
        before = 0.5 * shared.squared(residuals) + numbers.prior(numbers.y)
        curvature, gradient = shared.normal(model.over(sigma), residuals)
        curvature = curvature + numbers.held.toarray()
        gradient = gradient + numbers.slope(numbers.y)
        if self._finds:
            covariance = np.linalg.inv(curvature + np.diag(priors.NOT_HELD * numbers.floor))
            self._window_error = sigma / test.sigma * float(np.sqrt(covariance[-1, -1]))
        window, count, promised = test.window, len(numbers.y) - self._finds, []
        for changed, gain, damping in projected_steps(
            numbers.y, gradient, curvature, numbers.bounds, numbers.floor, self._damping
        ):
            promised.append(gain)
            change = changed - numbers.y
            y = numbers.after(change, test.problem.basis)
            trial = field.at(y[:count], numbers.moves)
            reached = test.followed(trial, states, model.answers, change[:count])
            if reached is not None:
                if self._finds:
                    test.see_through(float(changed[-1]))
                after = 0.5 * shared.squared(test.residuals(reached, sigma)) + numbers.prior(y)
                if after < before:
                    if len(promised) == 1 and before - after > numerics.TRUSTED * gain:
                        self._model = model
                    # The next step is a little bolder than this one, and no more.
                    self._damping = max(damping - 1, 0)
                    return (trial, reached), before, before - after
            if not fresh:
                break
        test.see_through(window)
        return None, before, promised[0]

    def _fit(self, field: Interfaces, states, ending: Ending, history) -> Fit:
        test = self.test
        model = self._latest or self._followed(field, states)
        numbers = numbers_of(test.problem, field, model.moves, None)
        shared, residuals = test.shared(states, test.sigma, anew=self._measures), test.residuals(states, test.sigma)
        white, total = shared.white(residuals), shared.squared(residuals)
        # Lines that stay have their bends all the same.
        prior = (every := InterfaceFit(test)._numbers(field)).prior(every.y)
        of_u = test.of_displacements(white)
        of_f = np.concatenate([w[len(u) :] for w, u in zip(white, of_u, strict=True)])
        determined, of_materials, covariance = self._determined(numbers, model, shared, self._left(of_u, 0.0))
        return Fit(
            field=field,
            steps=test.steps,
            states=[(u, force, None) for u, force, _ in states],
            white=white,
            left=self._left(of_u, determined),
            misfit=_mean(np.concatenate(of_u)),
            forces=_mean(of_f),
            force_squared=total - sum(float(u @ u) for u in of_u),
            cost=0.5 * total + prior,
            prior=prior,
            determined=determined,
            of_materials=of_materials,
            covariance=covariance,
            window=test.window,
            window_error=self._window_error,
            ending=ending,
            history=history,
            edges=shared.answers,
        )

    def _left(self, of_u, determined: float) -> Left:
        """What residuals of displacements leave; of grey levels they share nothing."""
        observations = self.test.problem.observations
        observed = [boundary.observed for boundary in self.test.boundaries]
        return left_of(observations.grid if observations.by_points else None, observed, of_u, determined)

    def _determined(self, numbers: Numbers, model: Derivatives, shared, left: Left):
        """(how many numbers data determine, of materials alone, covariance of these), as displacements leave them."""
        sigma, count = shared.sigma * max(left.level * float(np.sqrt(left.inflation)), 1.0), len(numbers.y)
        nothing = [np.zeros(len(b.seen) + len(f)) for b, f in zip(self.test.boundaries, self.test.forces, strict=True)]
        jacobians = (J[:, :count] for J in model.over(sigma))
        curvature, _ = dataclasses.replace(shared, sigma=sigma).normal(jacobians, nothing)
        of_law, held = np.arange(count) < numbers.of_materials, numbers.held.toarray()
        held[np.diag_indices_from(held)] += np.where(of_law, 0.0, numbers.floor)

        def of(some):
            own = np.ix_(some, some)
            return float(np.trace(np.linalg.solve((curvature + held)[own], curvature[own]))) if len(some) else 0.0

        covariance = np.linalg.inv(curvature + held)[: numbers.of_materials, : numbers.of_materials]
        return of(np.flatnonzero(numbers.within)), of(np.flatnonzero(numbers.within & of_law)), covariance


def _mean(values) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(values**2))) if len(values) else 0.0
