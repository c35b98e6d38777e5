"""Two materials and the line between them, found together by damped Gauss-Newton steps.

A cell that an interface cuts is no mixture: the sides deform differently, and with a contrast its neighbours pay for
that. Here it is of two layers (:mod:`hypernode.mechanics.layers`), whose share and normal follow from one line through
the sheet. What the test decides are then two materials and where that line is.
"""

import dataclasses

import numpy as np
import scipy.sparse
from jaxtyping import Float

from hypernode.fem.contour import ContourLines
from hypernode.identification.estimate import Estimate
from hypernode.identification.few_materials import at_contours, medians, split
from hypernode.identification.layered_estimate import LayeredEstimate
from hypernode.identification.objective import white_residuals
from hypernode.identification.problem import FieldProblem, with_law
from hypernode.identification.projected_newton import projected_steps
from hypernode.identification.settings import Strategy
from hypernode.mechanics.layers import Layers
from hypernode.progress import Progress, say
from hypernode.verdict import Ending


class LayeredDescent:
    """Damped Gauss-Newton steps of two materials and a line from the halves of a free field."""

    def __init__(self, found: Estimate, materials: np.ndarray, line: np.ndarray, measured: int, name: str):
        self._found, self._name = found, name
        self._problem: FieldProblem = with_law(found.problem, Layers(found.problem.basis))
        self._strategy = found.problem.strategy
        self._lines = ContourLines(found.problem.mesh)
        self._start, self._line, self._measured = materials, line, measured
        ridge = found.objective.ridge.reshape(found.params.shape)[0]
        # Each material is held as one cell is: held by each of its cells, P of contrast 10 ends at twice the error.
        self._ridge = np.tile(ridge, 2)
        self._centre = np.tile(found.objective.centre.reshape(found.params.shape)[0], 2)

    @classmethod
    def of_halves(cls, found: Estimate, name: str) -> "LayeredDescent | None":
        """From the stiffer and the softer half of a free field; None where it has no halves."""
        problem = found.problem
        level, _ = problem.stiffness(found.params)
        labels = split(level, np.zeros(len(level), dtype=int))
        if not labels.any():
            return None
        materials = medians(problem.mesh, found.params, labels, found.basis.lowest)[::-1]
        # A cell that is cut is stiffer the more of it is stiff.
        fields = materials[:1], materials[1:], found.params
        stiff, soft, each = (np.exp(problem.stiffness(field)[0]) for field in fields)
        mixed = np.clip((each - soft) / (stiff - soft), 0.0, 1.0)
        line = ContourLines(problem.mesh).through(np.where(at_contours(problem.mesh, labels), mixed, labels))
        return cls(found, materials, line, problem.strategy.layer_measured, name)

    @classmethod
    def along(cls, line: Float[np.ndarray, " node"], found: Estimate, name: str) -> "LayeredDescent":
        """From a line that is near its place, and the sides of it in a free field."""
        mesh = found.problem.mesh
        share, _ = ContourLines(mesh).cells(line)
        sides = medians(mesh, found.params, (share > 0.5).astype(int), found.basis.lowest)
        return cls(found, sides[::-1], line, 0, name)

    def end(self) -> LayeredEstimate | None:
        """Where the descent ends; None where it finds no equilibrium, or less than a cell of a material is left."""
        strategy = self._strategy
        materials, line, states = self._start, self._line, self._found.states
        history, best, ending = [], None, Ending.OUT_OF_ITERATIONS
        progress = Progress("constrained field, two materials", self._name, strategy.layer_rounds)
        for number in range(strategy.layer_rounds):
            # To measure them anew bends what has become smooth: once the line is near its place they stay.
            if number < self._measured:
                line = self._lines.distance(line, strategy.layer_fewest)
            ended = self._round(materials, line, states)
            if ended is None:
                break
            history.append(ended.history[-1])
            progress.advance(misfit=history[-1], cost=ended.cost)
            gained = np.inf if best is None else best.cost - ended.cost
            best = ended
            materials, line, states = best.materials, best.distance, best.states
            if number >= max(1, self._measured) and _hopeless(history, strategy):
                ending = Ending.STAGNATED
                break
            if gained < strategy.layer_gain and number > self._measured:
                ending = Ending.CONVERGED
                break
        if best is None:
            return None
        say("constrained field", self._name, f"two materials and a line, {ending}: {best.summary}")
        return dataclasses.replace(best, ending=ending, history=np.array(history))

    def _params(self, materials, line, normals):
        share, _ = self._lines.cells(line)
        return self._problem.basis.field(materials, share, normals)

    def _states(self, materials, line, normals, near):
        params = self._params(materials, line, normals)
        return self._problem.equilibrium.states(params, [state.u for state in near])

    def _near(self, line):
        """(nodes whose distance may change, second differences of it that should be small)."""
        nodes = np.flatnonzero(np.abs(line) < self._strategy.layer_reach)
        bends, inside = self._lines.bends, np.zeros(len(line))
        inside[nodes] = 1.0
        whole = np.asarray(abs(bends).sum(axis=1)).ravel() - abs(bends) @ inside < 0.5
        middle = np.asarray(bends.argmin(axis=1)).ravel()
        rows = whole & (np.abs(line[middle]) < self._strategy.layer_bent)
        return nodes, bends[np.flatnonzero(rows)][:, nodes] / self._strategy.layer_bend

    def _columns(self, line, nodes):
        """Derivative of the flattened field by both materials and the distances of some nodes."""
        cells, width = len(self._problem.mesh.cells), len(self._problem.basis.names)
        count = self._start.size
        number = np.full(len(line), -1)
        number[nodes] = np.arange(len(nodes))
        slopes = self._lines.slopes(line)
        cell, corner = np.nonzero(slopes)
        node = number[self._problem.mesh.cells[cell, corner]]
        kept = node >= 0
        cell, corner, node = cell[kept], corner[kept], node[kept]
        of_materials = (np.arange(cells) * width + 1 + np.arange(count)[:, None]).ravel()
        rows = np.concatenate([of_materials, cell * width + 1 + count])
        columns = np.concatenate([np.repeat(np.arange(count), cells), count + node])
        values = np.concatenate([np.ones(len(of_materials)), slopes[cell, corner]])
        return scipy.sparse.csc_matrix((values, (rows, columns)), (cells * width, count + len(nodes)))

    def _derivative(self, linear, line, nodes):
        """Derivative of whitened residuals by materials and distances; of many the field does not know."""
        columns = self._columns(line, nodes)
        known = np.flatnonzero(np.diff(columns.indptr))
        J = np.zeros((linear.shape[0], columns.shape[1]))
        J[:, known] = linear.product(columns[:, known].toarray())
        return J

    def _round(self, materials, line, states) -> LayeredEstimate | None:
        """What some steps near a line lead to; None as of :meth:`end`.

        Its normals are those of the start: where two lines come close they turn with the least change of distances.
        """
        _, normals = self._lines.cells(line)
        states = self._states(materials, line, normals, states)
        if states is None:
            return None
        near = self._near(line)
        for _ in range(self._strategy.layer_steps):
            step = self._step(materials, line, states, normals, *near)
            if step is None:
                break
            materials, line, states, gained = step
            if gained < self._strategy.layer_gain:
                break
        of_first = self._lines.cells(line)[0].sum()
        if not 1.0 <= of_first <= len(self._problem.mesh.cells) - 1.0:
            return None
        return self._estimate(materials, line, states, normals)

    def _step(self, materials, line, states, normals, nodes, bends):
        """(materials, line, states, by how much the cost fell) of a step that lowers it, or None."""
        strategy, count = self._strategy, self._start.size
        linear = self._problem.linearise(self._params(materials, line, normals), states, self._problem.sigma)
        held = _held(self._ridge, bends)

        def white(states):
            return white_residuals(self._problem, states, self._problem.sigma, linear)

        def cost(x, states):
            centred = np.concatenate([x[:count] - self._centre, x[count:]])
            return 0.5 * sum(float(r @ r) for r in white(states)) + 0.5 * centred @ (held @ centred)

        x = np.concatenate([materials.ravel(), line[nodes]])
        J = self._derivative(linear, line, nodes)
        gradient = J.T @ np.concatenate(white(states))
        gradient += held @ np.concatenate([x[:count] - self._centre, x[count:]])
        curvature, before = J.T @ J + held.toarray(), cost(x, states)
        lowest = np.concatenate([np.tile(self._found.basis.lowest, len(materials)), np.full(len(nodes), -np.inf)])
        # What data do not tell of materials would take the longest step, and hold up all else.
        floor = np.repeat([strategy.largest_step**-2.0, strategy.layer_held], [count, len(nodes)])
        for changed, _ in projected_steps(x, gradient, curvature, lowest, floor, strategy):
            moved = line.copy()
            moved[nodes] = changed[count:]
            other = changed[:count].reshape(materials.shape)
            trial = self._states(other, moved, normals, states)
            if trial is not None and cost(changed, trial) < before:
                return other, moved, trial, before - cost(changed, trial)
        return None

    def _estimate(self, materials, line, states, normals) -> LayeredEstimate:
        """The estimate of materials and a line; its cost counts the line by its length, as that of a field does."""
        found, problem = self._found, self._problem
        objective = dataclasses.replace(found.objective, problem=problem)
        params = self._params(materials, line, normals)
        linear = problem.linearise(params, states, problem.sigma)
        nodes, bends = self._near(line)
        # Where neither data nor bends say anything of a distance, it is known to some cells.
        floor = np.concatenate([0.0 * self._ridge, np.full(len(nodes), self._strategy.layer_held)])
        held = _held(self._ridge, bends) + scipy.sparse.diags(floor)
        # A coefficient that is none, and would be less, answers to nothing.
        above = materials.ravel() > np.tile(found.basis.lowest, len(materials))
        answers = np.concatenate([np.flatnonzero(above), self._start.size + np.arange(len(nodes))])
        jump = objective.regulariser.between(materials, objective.jump_cost)[0, 1]
        unit = self._strategy.unit_length(problem.observations.grid.areas)
        cost = objective.misfits(states, problem.sigma, linear)
        cost += objective.regulariser_weight * jump * self._lines.length(line) / unit
        cost += 0.5 * self._ridge @ (materials.ravel() - self._centre) ** 2
        return LayeredEstimate(
            objective,
            linear,
            params,
            states,
            np.array([objective.misfit(states, linear)]),
            cost,
            Ending.UNFINISHED,
            None,
            free=found,
            materials=materials,
            distance=line,
            columns=self._columns(line, nodes)[:, answers],
            held=held[answers][:, answers],
        )


def _hopeless(history: list[float], strategy: Strategy) -> bool:
    """Whether a test is far from explained, and a round hardly came nearer."""
    return history[-1] > max(strategy.unexplained, (1.0 - strategy.layer_nearer) * history[-2])


def _held(ridge, bends) -> scipy.sparse.csr_matrix:
    """Inverse covariance of materials and line without data."""
    return scipy.sparse.block_diag([scipy.sparse.diags(ridge), bends.T @ bends], format="csr")
