"""Materials and lines that explain a test best: damped Gauss-Newton steps of a few numbers.

The numbers are the parameters of all materials and the distances of nodes near the lines. Where it is sought, the side
of the window through which a camera sees is one more. Far from the answer, what is left of the displacements weighs as
their noise.
"""

import dataclasses

import numpy as np
import scipy.sparse
from jaxtyping import Float

from hypernode.identification.interface_noise import Left, left_of
from hypernode.identification.interfaces import Interfaces
from hypernode.identification.projected_newton import projected_steps
from hypernode.identification.seen_test import SeenTest
from hypernode.verdict import Ending

#: Distance from a line, in sides of cells, within which it may change: corners of the cells that it cuts.
REACH = 1.3
#: In sides of cells: how near a line its distances bend, and by how much they usually do.
BENT, BEND = 0.8, 0.3
#: Inverse variance of what a step changes of distances without data. Regions of fewer nodes than a cell's are none.
HELD, FEWEST = 3.0, 4
#: Steps before which distances are measured anew, so that their slope stays one, and how many follow at least.
MEASURED, SETTLED = (2, 5), 6
#: What a step gains that ends a descent, and the same over the cost.
GAIN, RELATIVE_GAIN = 0.5, 1e-3
#: Inverse variance of the window without data: none.
UNKNOWN = 1e-6


@dataclasses.dataclass(frozen=True)
class Fit:
    """Where a descent ended.

    Attributes:
        field: materials and lines.
        states: equilibrium of every step.
        white: residuals over the believed noise, free of what edges share, by step.
        left: what displacements leave.
        misfit, forces: root mean squares of the residuals of displacements and forces.
        force_squared: squared misfit of the forces, whose errors are shared.
        cost, prior: half the squared residuals with what numbers cost without data, and the latter.
        determined: how many numbers the data determine, with displacements as uncertain as what is left of them.
        of_materials: how many of these are of materials, with lines as they are.
        window, window_error: side of the window in points, its standard deviation, 0 where it is not sought.
        ending: how the descent ended.
        history: misfit before every step.
    """

    field: Interfaces
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
    window: float
    window_error: float
    ending: Ending
    history: list[float]


@dataclasses.dataclass(frozen=True)
class _Numbers:
    """The numbers of a field, their prior and their bounds.

    Attributes:
        y: values.
        near: nodes of each line's distances.
        held, centre: inverse covariance and mean without data.
        lowest: least values.
        floor: added to the curvature, for what data do not tell.
    """

    y: Float[np.ndarray, " number"]
    near: list
    held: scipy.sparse.csr_matrix
    centre: Float[np.ndarray, " number"]
    lowest: Float[np.ndarray, " number"]
    floor: Float[np.ndarray, " number"]

    def prior(self, y) -> float:
        """What numbers cost without data."""
        return 0.5 * float((y - self.centre) @ (self.held @ (y - self.centre)))


class InterfaceFit:
    """Descents on one test.

    Args:
        find_window: whether the side of the window is a number.
        move_lines: whether distances are.
        settled: whether lines are near their place, so that distances need not be measured anew.
    """

    def __init__(self, test: SeenTest, find_window: bool = False, move_lines: bool = True, settled: bool = False):
        self.test, self._finds, self._moves = test, find_window, move_lines
        self._strategy, self._law = test.problem.strategy, test.problem.basis
        self._window_error, self._measures = 0.0, move_lines and not settled

    def near(self, field: Interfaces) -> list:
        """Nodes of which each line's distance is a number."""
        return field.near(REACH) if self._moves else [np.zeros(0, int) for _ in field.distances]

    def held(self, field: Interfaces, near) -> scipy.sparse.csr_matrix:
        """Inverse covariance of materials and distances without data."""
        bends = field.lines.grid.bends
        blocks = [self._strategy.ridge * scipy.sparse.identity(field.materials.size)]
        middle, whole = np.asarray(bends.argmin(axis=1)).ravel(), np.asarray(abs(bends).sum(axis=1)).ravel()
        for row, nodes in zip(field.distances, near, strict=True):
            inside = np.zeros(len(row))
            inside[nodes] = 1.0
            rows = (whole - abs(bends) @ inside < 0.5) & (np.abs(row[middle]) < BENT)
            some = bends[np.flatnonzero(rows)][:, nodes] / BEND
            blocks.append(some.T @ some)
        return scipy.sparse.block_diag(blocks, format="csr")

    def _numbers(self, field: Interfaces) -> _Numbers:
        near = self.near(field)
        y, held = field.numbers(near), self.held(field, near)
        centre = np.zeros(len(self._law.names))
        centre[0] = self.test.problem.homogeneous.params[0]
        extra = len(y) - field.materials.size
        centre = np.concatenate([np.tile(centre, field.count), np.zeros(extra)])
        lowest = np.concatenate([np.tile(self._law.lowest, field.count), np.full(extra, -np.inf)])
        known = self._strategy.largest_step**-2.0
        floor = np.concatenate([np.full(field.materials.size, known), np.full(extra, HELD)])
        if self._finds:
            y, centre = np.append(y, self.test.window), np.append(centre, self.test.window)
            held = scipy.sparse.block_diag([held, [[UNKNOWN]]], format="csr")
            lowest, floor = np.append(lowest, 0.0), np.append(floor, known)
        return _Numbers(y, near, held, centre, lowest, floor)

    def descend(self, field: Interfaces, guesses, iterations: int) -> Fit | None:
        """Where a descent ends; None without equilibrium.

        Args:
            guesses: displacement of every step near its equilibrium.
        """
        test = self.test
        if (states := test.states(field, guesses)) is None:
            return None
        history, ending, sigma = [], Ending.OUT_OF_ITERATIONS, np.inf
        for number in range(iterations):
            if self._measures and number in MEASURED:
                anew = field.measured_anew(FEWEST)
                again = test.states(anew, [u for u, _, _ in states])
                field, states = (field, states) if again is None else (anew, again)
            sigma = test.sigma_of(states, sigma)
            history.append(test.left(states))
            moved, before, gained = self._step(field, states, sigma)
            if moved is None:
                ending = Ending.CONVERGED if gained < max(GAIN, RELATIVE_GAIN * before) else Ending.STAGNATED
                break
            field, states = moved
            if gained < max(GAIN, RELATIVE_GAIN * before) and number >= SETTLED * (self._measures and field.count > 1):
                ending = Ending.CONVERGED
                break
        return self._fit(field, states, ending, history)

    def _step(self, field: Interfaces, states, sigma: float):
        """((field, states) after a step that lowers the cost, or None; cost before; by how much it fell, or should)."""
        test, numbers = self.test, self._numbers(field)
        shared, residuals = test.shared(states, sigma), test.residuals(states, sigma)
        jacobians = test.answers(states, test.loads(field, states, numbers.near), sigma)
        if self._finds:
            columns = test.by_window(states, sigma)
            jacobians = [np.concatenate(each, axis=1) for each in zip(jacobians, columns, strict=True)]
        before = 0.5 * shared.squared(residuals) + numbers.prior(numbers.y)
        curvature, gradient = shared.normal(jacobians, residuals)
        curvature = curvature + numbers.held.toarray()
        gradient = gradient + numbers.held @ (numbers.y - numbers.centre)
        if self._finds:
            covariance = np.linalg.inv(curvature + np.diag(UNKNOWN * numbers.floor))
            self._window_error = sigma / test.sigma * float(np.sqrt(covariance[-1, -1]))
        window, count, promised = test.window, len(numbers.y) - self._finds, []
        for changed, gain in projected_steps(
            numbers.y, gradient, curvature, numbers.lowest, numbers.floor, self._strategy
        ):
            promised.append(gain)
            trial = field.at(changed[:count], numbers.near)
            reached = test.states(trial, [u for u, _, _ in states])
            if reached is None:
                continue
            if self._finds:
                test.see_through(float(changed[-1]))
            after = 0.5 * shared.squared(test.residuals(reached, sigma)) + numbers.prior(changed)
            if after < before:
                return (trial, reached), before, before - after
        test.see_through(window)
        return None, before, promised[0]

    def _fit(self, field: Interfaces, states, ending: Ending, history) -> Fit:
        test, numbers = self.test, InterfaceFit(self.test, False, self._moves)._numbers(field)
        shared, residuals = test.shared(states, test.sigma, anew=True), test.residuals(states, test.sigma)
        white, total = shared.white(residuals), shared.squared(residuals)
        # Lines that stay have their bends all the same.
        prior = (every := InterfaceFit(self.test)._numbers(field)).prior(every.y)
        of_u = test.of_displacements(white)
        of_f = np.concatenate([w[len(u) :] for w, u in zip(white, of_u, strict=True)])
        observed = [boundary.observed for boundary in test.boundaries]
        left = left_of(test.problem.observations.grid, observed, of_u, 0.0)
        jacobians = test.answers(states, test.loads(field, states, numbers.near), test.sigma)
        determined, of_materials = self._determined(field, numbers, shared, jacobians, residuals, left)
        return Fit(
            field,
            states,
            white,
            left_of(test.problem.observations.grid, observed, of_u, determined),
            _mean(np.concatenate(of_u)),
            _mean(of_f),
            total - sum(float(u @ u) for u in of_u),
            0.5 * total + prior,
            prior,
            determined,
            of_materials,
            test.window,
            self._window_error,
            ending,
            history,
        )

    def _determined(self, field, numbers: _Numbers, shared, jacobians, residuals, left: Left):
        """(how many numbers the data determine, of materials alone), with displacements as uncertain as they leave."""
        looser = max(left.level * float(np.sqrt(left.inflation)), 1.0)
        for J, u in zip(jacobians, self.test.of_displacements(residuals), strict=True):
            J[: len(u)] /= looser
        shared = dataclasses.replace(shared, sigma=shared.sigma * looser)
        curvature, _ = shared.normal(jacobians, [np.zeros(len(r)) for r in residuals])
        held = numbers.held.toarray()
        held[np.diag_indices_from(held)] += np.where(np.arange(len(held)) < field.materials.size, 0.0, numbers.floor)

        def of(some):
            own = np.ix_(some, some)
            return float(np.trace(np.linalg.solve((curvature + held)[own], curvature[own]))) if len(some) else 0.0

        going = np.flatnonzero(numbers.y > numbers.lowest)
        return of(going), of(going[going < field.materials.size])


def _mean(values) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(values**2))) if len(values) else 0.0
