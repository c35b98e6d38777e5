"""A test as materials and lines answer to it: equilibrium, residuals, what they share, and their derivatives."""

from collections.abc import Iterator, Sequence
from typing import Protocol, runtime_checkable

import numpy as np
import scipy.sparse
from jaxtyping import Float

from hypernode.fem.factors import AT_ONCE, Factors, factorise
from hypernode.identification import numerics, priors
from hypernode.identification.answers import Answer, adjoint
from hypernode.identification.coats import Cuts
from hypernode.identification.errors import EdgeAnswers, SharedErrors
from hypernode.identification.interfaces import Interfaces
from hypernode.identification.observations import seen_points
from hypernode.identification.points import Points
from hypernode.identification.problem import FieldProblem
from hypernode.identification.resultants import shared_errors
from hypernode.identification.sensitivities import Jacobian, StepJacobian
from hypernode.identification.sheet import CellMaterials, Sheet


@runtime_checkable
class OfCells(Protocol):
    """A field that says what cells are of: :class:`Interfaces`, or one whose materials differ from cell to cell."""

    def cells(self) -> tuple[CellMaterials, Cuts | None]:
        """(what every cell of the finite elements is of, the lines that cut each pair of its layers)."""


class SeenTest:
    """Some load steps of a test, seen through a window.

    A state is (displacement (node, 2), nodal forces (degree of freedom,), tangent) of one step.

    Attributes:
        problem: law, observations and forces.
        steps: numbers of the load steps.
        sheet: the finite elements.
        window: side of the window, in points of the grid.
        sigma: uncertainty of displacements, as believed.

    Args:
        window: left out, that of the observations.
        edges: how the residuals of every step answer to errors of prescribed edges, where that is known.
    """

    def __init__(
        self,
        problem: FieldProblem,
        steps: list[int],
        window: float | None = None,
        edges: Sequence[EdgeAnswers] | None = None,
    ):
        observations = problem.observations
        self.problem, self.steps, self.sigma = problem, steps, problem.sigma
        self.sheet = Sheet(problem.mesh, Points(problem.basis), observations.relative_thickness)
        self.boundaries = [observations.boundaries[k] for k in steps]
        self.forces = [[f for f in problem.forces if f.step == k] for k in steps]
        flat = [f for each in self.forces for f in each]
        errors = shared_errors(flat) / np.array([f.sigma for f in flat])[:, None] if flat else np.zeros((0, 1))
        self._loads = np.split(errors, np.cumsum([len(each) for each in self.forces])[:-1]) if steps else []
        self._answers = edges
        #: (tangent, factors) of every step where its derivatives were asked for last.
        self._latest: dict[int, tuple] = {}
        self.step = observations.grid.step
        self.see_through(observations.window / self.step if window is None else window)

    @property
    def observed(self) -> int:
        """How many displacements are observed."""
        return sum(len(boundary.seen) for boundary in self.boundaries)

    # Windows.

    def see_through(self, window: float) -> None:
        """Look through another window from now on."""
        self.window = min(window, priors.LARGEST_WINDOW)
        self._observe = self._through(self.window)

    def _through(self, window: float):
        observations = self.problem.observations
        if not observations.by_points:
            return [b.observe for b in self.boundaries]
        seen = seen_points(observations.refinement, window * self.step, observations.kernel)
        return [scipy.sparse.diags(1.0 / b.relative) @ seen[b.observed] for b in self.boundaries]

    def by_window(self, states, sigma: float) -> list[np.ndarray]:
        """Derivative of the residuals by the side of the window, by step (residual, 1)."""
        more, less = self.window + numerics.WINDOW_DIFFERENCE, max(self.window - numerics.WINDOW_DIFFERENCE, 0.0)
        pairs = zip(self._through(more), self._through(less), states, self.forces, strict=True)
        apart = more - less
        return [
            np.concatenate([(wide - narrow) @ u.ravel() / (apart * sigma), np.zeros(len(forces))])[:, None]
            for wide, narrow, (u, _, _), forces in pairs
        ]

    # Equilibrium and what is left.

    def followed(self, field: OfCells, states, answers: Sequence[Answer], change) -> list | None:
        """Equilibrium of every step after a change of the numbers; None where there is none.

        Args:
            field: with the changed numbers.
            states, answers: before, and how they answer to numbers.
        """
        before = [u for u, _, _ in states]
        near = [answer.near(u, change) for u, answer in zip(before, answers, strict=True)]
        return self.states(field, near) or self.states(field, before)

    def states(self, field: OfCells, guesses) -> list | None:
        """Equilibrium of every step near guesses of the displacement; None where there is none."""
        (of, _), found = field.cells(), []
        tolerance = numerics.NEWTON_TOLERANCE
        for k, (guess, boundary) in enumerate(zip(guesses, self.boundaries, strict=True)):
            _, near = self._latest.get(k, (None, None))
            reached = self.sheet.equilibrium(guess, boundary.free, of, tolerance, near)
            if reached is None:
                return None
            found.append(reached)
        return found

    def with_tangents(self, field: OfCells, states) -> list:
        """States in equilibrium once more with their tangents, which a fit does not keep."""
        of, _ = field.cells()
        return [(u, *self.sheet.response(u, of)) for u, _, _ in states]

    def _of_steps(self, states):
        return zip(states, self.boundaries, self._observe, self.forces, strict=True)

    def residuals(self, states, sigma: float) -> list[np.ndarray]:
        """Misfit of displacements over ``sigma``, then of forces over their uncertainty, by step."""
        found = []
        for (u, force, _), boundary, observe, forces in self._of_steps(states):
            of_f = [(f.direction @ force - f.value) / f.sigma for f in forces]
            found.append(np.concatenate([(observe @ u.ravel() - boundary.seen) / sigma, of_f]))
        return found

    def of_displacements(self, residuals) -> list[np.ndarray]:
        """The part of residuals that displacements have, by step."""
        return [r[: len(b.seen)] for r, b in zip(residuals, self.boundaries, strict=True)]

    def left(self, states) -> float:
        """Root mean square of what is left of the displacements, over their noise."""
        of_u = self.of_displacements(self.residuals(states, self.sigma))
        return float(np.sqrt(np.mean(np.concatenate(of_u) ** 2)))

    def sigma_of(self, states, before: float = np.inf) -> float:
        """What is left weighs as noise, until noise is all that is left."""
        return max(self.sigma, min(self.sigma * self.left(states), before))

    def shared(self, states, sigma: float, anew: bool = False) -> SharedErrors:
        """What residuals share; how edges are answered is followed again only where ``anew``."""
        if self._answers is None or anew:
            self._answers = [self._edge_answers(k, *each) for k, each in enumerate(self._of_steps(states))]
        return SharedErrors(self._answers, self._loads, sigma)

    def _edge_answers(self, step: int, state, boundary, observe, forces) -> EdgeAnswers:
        K, free = state[2], boundary.free
        du = boundary.errors.toarray()
        du[free] = -self._factors(step, K, free).solve((K[free] @ boundary.errors).toarray())
        of_f = [(K @ f.direction / f.sigma) @ du for f in forces]
        seen = observe @ du
        return EdgeAnswers(seen, np.array(of_f).reshape(len(forces), -1), seen.T @ seen)

    # Derivatives.

    def answers(self, states, loads) -> Iterator[Answer]:
        """How one step after the other answers to numbers whose load on the nodes is given."""
        for k, ((_, _, K), boundary, observe, forces) in enumerate(self._of_steps(states)):
            free = boundary.free
            yield Answer.of(self._factors(k, K, free), K, loads[k], free, observe, forces)

    def jacobians(self, states, loads, sigma: float) -> Iterator[Float[np.ndarray, "residual number"]]:
        """Derivative of the residuals by numbers, of one step after the other: of :meth:`answers`, not kept."""
        for k, ((_, _, K), boundary, observe, forces) in enumerate(self._of_steps(states)):
            free, load = boundary.free, loads[k].tocsc()
            factors, J = self._factors(k, K, free), np.empty((len(boundary.seen) + len(forces), load.shape[1]))
            for first in range(0, load.shape[1], AT_ONCE):
                some = slice(first, first + AT_ONCE)
                J[:, some] = Answer.of(factors, K, load[:, some], free, observe, forces).over(sigma)
            yield J
            del J

    def adjoint(self, states, loads, sigma: float, residuals) -> Float[np.ndarray, "number column"]:
        """J^T of columns of the residuals of all steps.

        Args:
            loads: derivative of the nodal forces by the numbers, by step.
            residuals: by step (residual, column).
        """
        return sum(
            adjoint(self._factors(k, K, b.free), K, loads[k], b.free, observe / sigma, forces, residuals[k])
            for k, ((_, _, K), b, observe, forces) in enumerate(self._of_steps(states))
        )

    def _factors(self, step: int, K, free) -> Factors:
        """Factors of the free tangent of a step; the latest of each step are kept."""
        known, factors = self._latest.get(step, (None, None))
        if known is not K:
            factors = factorise(K[free][:, free], self.problem.mesh.nodes[free // 2])
            self._latest[step] = K, factors
        return factors

    def loads(self, field: Interfaces, states, moves) -> list[scipy.sparse.csr_matrix]:
        """Derivative of the nodal forces by the numbers of a field, by step."""
        return [field.loads(self.sheet, u, moves) for u, _, _ in states]

    def jacobian(self, field: Interfaces, states, moves) -> Jacobian:
        """Derivatives by the numbers of a field as products, with what residuals share."""
        steps, known = [], self.shared(states, self.sigma).answers
        loads = self.loads(field, states, moves)
        for each, load, edges in zip(self._of_steps(states), loads, known, strict=True):
            (_, _, K), boundary, observe, forces = each
            directions = [(f.direction, f.sigma) for f in forces]
            steps.append(
                StepJacobian(
                    K=K,
                    B=load,
                    free=boundary.free,
                    observe=observe / self.sigma,
                    forces=directions,
                    errors=boundary.errors,
                    answered=np.concatenate([edges.u / self.sigma, edges.f]),
                )
            )
        of_forces = [self.steps.index(f.step) for each in self.forces for f in each]
        return Jacobian(
            steps=steps,
            force_steps=of_forces,
            force_errors=np.concatenate(self._loads),
            sigma=self.sigma,
            shares=np.ones(len(steps)),
        )
