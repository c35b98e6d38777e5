"""A test as materials and lines answer to it: equilibrium, residuals, what they share, and their derivatives."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np
import scipy.sparse
from jaxtyping import Float

from hypernode.fem.factors import factorise
from hypernode.identification.coats import Cuts
from hypernode.identification.errors import EdgeAnswers, SharedErrors
from hypernode.identification.interfaces import Interfaces
from hypernode.identification.observations import seen_points
from hypernode.identification.points import Points
from hypernode.identification.problem import FieldProblem
from hypernode.identification.resultants import shared_errors
from hypernode.identification.sensitivities import Jacobian, StepJacobian
from hypernode.identification.sheet import CellMaterials, Sheet

#: Half of the difference of two windows, in points, that stands for a derivative.
DIFFERENCE = 0.05
#: Largest side of a window, in points.
LARGEST_WINDOW = 6.0


@runtime_checkable
class OfCells(Protocol):
    """A field that says what cells are of: :class:`Interfaces`, or one whose materials differ from cell to cell."""

    def cells(self) -> tuple[CellMaterials, Cuts | None]:
        """(what every cell of the finite elements is of, the lines that cut each pair of its layers)."""


class Answer(NamedTuple):
    """How a step answers to numbers, to first order.

    Attributes:
        J: derivative of the residuals (residual, number).
        displacements: derivative of the displacement at free degrees of freedom by numbers that load nodes.
        some: which numbers do.
        free: degrees of freedom that equilibrium moves.
    """

    J: Float[np.ndarray, "residual number"]
    displacements: Float[np.ndarray, "free some"]
    some: np.ndarray
    free: np.ndarray

    def near(self, u: Float[np.ndarray, "node 2"], change: Float[np.ndarray, " number"]) -> Float[np.ndarray, "node 2"]:
        """Displacement near equilibrium once numbers have changed."""
        moved = u.copy()
        moved.ravel()[self.free] += self.displacements @ change[self.some]
        return moved


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
        self.step = observations.grid.step
        self.see_through(observations.window / self.step if window is None else window)

    @property
    def observed(self) -> int:
        """How many displacements are observed."""
        return sum(len(boundary.seen) for boundary in self.boundaries)

    # Windows.

    def see_through(self, window: float) -> None:
        """Look through another window from now on."""
        self.window = min(window, LARGEST_WINDOW)
        self._observe = self._through(self.window)

    def _through(self, window: float):
        observations = self.problem.observations
        if not observations.by_points:
            return [b.observe for b in self.boundaries]
        seen = seen_points(observations.refinement, window * self.step, observations.kernel)
        return [scipy.sparse.diags(1.0 / b.relative) @ seen[b.observed] for b in self.boundaries]

    def by_window(self, states, sigma: float) -> list[np.ndarray]:
        """Derivative of the residuals by the side of the window, by step (residual, 1)."""
        less = max(self.window - DIFFERENCE, 0.0)
        pairs = zip(self._through(self.window + DIFFERENCE), self._through(less), states, self.forces, strict=True)
        apart = self.window + DIFFERENCE - less
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
        for guess, boundary in zip(guesses, self.boundaries, strict=True):
            tolerance = self.problem.strategy.newton_tolerance
            reached = self.sheet.equilibrium(guess, boundary.free, of, tolerance)
            if reached is None:
                return None
            found.append(reached)
        return found

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
            self._answers = [self._edge_answers(*each) for each in self._of_steps(states)]
        return SharedErrors(self._answers, self._loads, sigma)

    @staticmethod
    def _edge_answers(state, boundary, observe, forces) -> EdgeAnswers:
        K, free = state[2], boundary.free
        rows, du = K[free], boundary.errors.toarray()
        du[free] = -factorise(rows[:, free]).solve((rows @ boundary.errors).toarray())
        of_f = [(K @ f.direction / f.sigma) @ du for f in forces]
        seen = observe @ du
        return EdgeAnswers(seen, np.array(of_f).reshape(len(forces), -1), seen.T @ seen)

    # Derivatives.

    def answers(self, states, loads, sigma: float) -> Iterator[Answer]:
        """How one step after the other answers to numbers whose load on the nodes is given."""
        for ((_, _, K), boundary, observe, forces), load in zip(self._of_steps(states), loads, strict=True):
            # Numbers that load nothing, as distances beside no cut cell, change nothing.
            some, free = np.flatnonzero(np.diff(load.tocsc().indptr)), boundary.free
            J = np.zeros((observe.shape[0] + len(forces), load.shape[1]))
            load = load[:, some]
            du = -factorise(K[free][:, free]).solve(load[free].toarray())
            J[: observe.shape[0], some] = (observe[:, free] / sigma) @ du
            for row, f in zip(J[observe.shape[0] :], forces, strict=True):
                row[some] = (load.T @ f.direction + (K @ f.direction)[free] @ du) / f.sigma
            yield Answer(J, du, some, free)

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
