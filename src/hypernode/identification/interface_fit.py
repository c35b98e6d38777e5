"""Materials and lines that explain a test best: damped Gauss-Newton steps of a few numbers."""

import dataclasses

import numpy as np
import scipy.sparse
from jaxtyping import Float

from hypernode.fem.factors import factorise
from hypernode.identification.errors import SharedErrors
from hypernode.identification.interfaces import Interfaces
from hypernode.identification.observations import Observations, seen_points
from hypernode.identification.projected_newton import projected_steps
from hypernode.identification.resultants import EdgeForce, shared_errors
from hypernode.identification.settings import Strategy
from hypernode.identification.sheet import Sheet
from hypernode.mechanics.convex_basis import ConvexBasis


@dataclasses.dataclass(frozen=True)
class Fit:
    field: Interfaces
    states: list
    sigma: float
    misfit: float
    forces: float
    cost: float
    prior: float
    determined: float
    ending: str
    history: list
    residuals: list


class InterfaceFit:
    """Descents of materials and lines on one test."""

    def __init__(self, observations: Observations, law: ConvexBasis, sheet: Sheet, forces: list[EdgeForce], strategy: Strategy, level: float, sigma: float, steps=None, window=0.0, find_window=False):
        self.observations, self.law, self.sheet, self.strategy = observations, law, sheet, strategy
        steps = range(len(observations.boundaries)) if steps is None else steps
        self.steps = list(steps)
        self.boundaries = [observations.boundaries[k] for k in steps]
        self.find_window, self.step = find_window, float(np.median(np.diff(observations.grid.lines[0])))
        self.set_window(window)
        self.forces = [[f for f in forces if f.step == k] for k in steps]
        self.sigma = sigma
        flat = [f for each in self.forces for f in each]
        E = shared_errors(flat) / np.array([f.sigma for f in flat])[:, None] if flat else np.zeros((0, 1))
        self._loads = np.split(E, np.cumsum([len(each) for each in self.forces])[:-1])
        self._centre = np.zeros(len(law.names))
        self._centre[0] = level
        self._answers = None

    def matrices(self, window):
        """Displacements observed through a window (in grid steps), by step, over their relative errors."""
        seen = seen_points(self.observations.refinement, window * self.step, "average")
        return [scipy.sparse.diags(1.0 / b.relative) @ seen[b.observed] for b in self.boundaries]

    def set_window(self, window):
        self.window = window
        self.observe = self.matrices(window)

    def by_window(self):
        """Derivative of what is observed by the window (matrix by step)."""
        h = 0.05
        more, less = self.matrices(self.window + h), self.matrices(max(self.window - h, 0.0))
        return [(a - b) / (h + min(h, self.window)) for a, b in zip(more, less)]

    def states(self, field: Interfaces, guesses):
        of, _ = field.cells()
        found = []
        for guess, boundary in zip(guesses, self.boundaries, strict=True):
            reached = self.sheet.equilibrium(guess, boundary.free, of, self.strategy.newton_tolerance)
            if reached is None:
                return None
            found.append(reached)
        return found

    def residuals(self, states, sigma):
        found = []
        for (u, force, _), boundary, observe, forces in zip(states, self.boundaries, self.observe, self.forces, strict=True):
            f = [(f.direction @ force - f.value) / f.sigma for f in forces]
            found.append(np.concatenate([(observe @ u.ravel() - boundary.seen) / sigma, f]))
        return found

    def edge_answers(self, states):
        """Displacements observed and forces by errors of the prescribed edges, by step."""
        found = []
        for (_, _, K), boundary, observe, forces in zip(states, self.boundaries, self.observe, self.forces, strict=True):
            free, rows = boundary.free, K[boundary.free]
            du = boundary.errors.toarray()
            du[free] = -factorise(rows[:, free]).solve((rows @ boundary.errors).toarray())
            f = [(K @ f.direction / f.sigma) @ du for f in forces]
            found.append((observe @ du, np.array(f).reshape(len(forces), -1)))
        return found

    def shared(self, states, sigma, anew=False) -> SharedErrors:
        if self._answers is None or anew:
            self._answers = self.edge_answers(states)
        A = [np.concatenate([u / sigma, f]) for u, f in self._answers]
        E = [np.concatenate([np.zeros((len(u), load.shape[1])), load]) for (u, _), load in zip(self._answers, self._loads)]
        return SharedErrors.of(A, E)

    def jacobians(self, field, states, near, sigma):
        of, _ = field.cells()
        found = []
        for (u, _, K), boundary, observe, forces in zip(states, self.boundaries, self.observe, self.forces, strict=True):
            free = boundary.free
            B = field.loads(self.sheet.response(u, of, True)[2], near)
            count = B.shape[1]
            # Distances of nodes beside no cut cell change nothing.
            some = np.flatnonzero(np.diff(B.tocsc().indptr))
            B = B[:, some]
            du = -factorise(K[free][:, free]).solve(B[free].toarray())
            J = np.zeros((observe.shape[0] + len(forces), count))
            J[: observe.shape[0], some] = (observe[:, free] / sigma) @ du
            for row, f in zip(J[observe.shape[0] :], forces, strict=True):
                row[some] = (B.T @ f.direction + (K @ f.direction)[free] @ du) / f.sigma
            found.append(J)
        return found

    def _held(self, field: Interfaces, near):
        strategy, bends = self.strategy, field.lines.grid.bends
        ridge = np.full(len(self.law.names), strategy.ridge)
        blocks = [scipy.sparse.diags(np.tile(ridge, field.count))]
        middle = np.asarray(bends.argmin(axis=1)).ravel()
        for row, nodes in zip(field.distances, near, strict=True):
            inside = np.zeros(len(row))
            inside[nodes] = 1.0
            whole = np.asarray(abs(bends).sum(axis=1)).ravel() - abs(bends) @ inside < 0.5
            rows = whole & (np.abs(row[middle]) < strategy.layer_bent)
            some = bends[np.flatnonzero(rows)][:, nodes] / strategy.layer_bend
            blocks.append(some.T @ some)
        return scipy.sparse.block_diag(blocks, format="csr")

    def descend(self, field: Interfaces, guesses, iterations=30, gain=0.5, say=None, lines=True, relative=1e-4) -> Fit | None:
        strategy = self.strategy
        states = self.states(field, guesses)
        if states is None:
            return None
        history, ending, sigma = [], "out of iterations", np.inf
        count = sum(o.shape[0] for o in self.observe)
        for number in range(iterations):
            if lines and number in (2, 5, 9) and len(field.distances):
                anew = field.measured_anew(strategy.layer_fewest)
                again = self.states(anew, [s[0] for s in states])
                if again is not None:
                    field, states = anew, again
            near = field.near(strategy.layer_reach) if lines else [np.zeros(0, int)] * len(field.distances)
            held = self._held(field, near)
            raw = self.residuals(states, 1.0)
            left = np.sqrt(sum(float(r[: o.shape[0]] @ r[: o.shape[0]]) for r, o in zip(raw, self.observe)) / count)
            # What is left weighs as noise, until noise is all that is left.
            sigma = max(self.sigma, min(left, sigma))
            shared = self.shared(states, sigma)
            residuals = self.residuals(states, sigma)
            y, jacobians = field.numbers(near), self.jacobians(field, states, near, sigma)
            if self.find_window:
                y = np.concatenate([y, [self.window]])
                held = scipy.sparse.block_diag([held, [[1e-6]]], format="csr")
                for k, D in enumerate(self.by_window()):
                    column = np.zeros((len(jacobians[k]), 1))
                    column[: D.shape[0], 0] = D @ states[k][0].ravel() / sigma
                    jacobians[k] = np.concatenate([jacobians[k], column], axis=1)
            extra = len(y) - field.materials.size
            centre = np.concatenate([np.tile(self._centre, field.count), np.zeros(extra)])
            if self.find_window:
                centre[-1] = self.window
            lowest = np.concatenate([np.tile(self.law.lowest, field.count), np.full(extra, -np.inf)])

            def value(y, residuals):
                return 0.5 * shared.squared(residuals) + 0.5 * float((y - centre) @ (held @ (y - centre)))

            before = value(y, residuals)
            history.append(left / self.sigma)
            curvature, gradient = shared.normal(jacobians, residuals)
            curvature, gradient = curvature + held.toarray(), gradient + held @ (y - centre)
            floor = np.concatenate([np.full(field.materials.size, strategy.largest_step**-2.0), np.full(extra, strategy.layer_held)])
            moved, at = None, self.window
            if self.find_window:
                lowest[-1] = 0.0
            for trials, (changed, _) in enumerate(projected_steps(y, gradient, curvature, lowest, floor, strategy)):
                trial = field.at(changed[: len(changed) - self.find_window], near)
                reached = self.states(trial, [s[0] for s in states])
                if self.find_window:
                    self.set_window(float(min(changed[-1], 6.0)))
                if reached is not None:
                    after = value(changed, self.residuals(reached, sigma))
                    if after < before:
                        moved = trial, reached, before - after
                        break
            if say:
                say(number, before, history[-1], len(y), trials, moved and moved[2])
            if moved is None:
                self.set_window(at)
                ending = "stagnated"
                break
            field, states, gained = moved
            if gained < max(gain, relative * before) and number > 9 * bool(len(field.distances) and lines):
                ending = "converged"
                break
        return self.fit(field, states, ending, history, lines)

    def fit(self, field, states, ending, history, lines=True):
        strategy, sigma = self.strategy, self.sigma
        near = field.near(strategy.layer_reach) if lines else [np.zeros(0, int)] * len(field.distances)
        held = self._held(field, near)
        shared = self.shared(states, sigma, anew=True)
        residuals = self.residuals(states, sigma)
        y = field.numbers(near)
        extra = len(y) - field.materials.size
        centre = np.concatenate([np.tile(self._centre, field.count), np.zeros(extra)])
        G, _ = shared.normal(self.jacobians(field, states, near, sigma), residuals)
        going = np.concatenate([field.materials.ravel() > np.tile(self.law.lowest, field.count), np.ones(extra, bool)])
        floor = np.concatenate([np.zeros(field.materials.size), np.full(extra, strategy.layer_held)])
        G = G[np.ix_(going, going)]
        determined = float(np.trace(np.linalg.solve(G + held.toarray()[np.ix_(going, going)] + np.diag(floor[going]), G)))
        prior = 0.5 * float((y - centre) @ (held @ (y - centre)))
        white = shared.white(residuals)
        u = np.concatenate([w[: o.shape[0]] for w, o in zip(white, self.observe)])
        f = np.concatenate([w[o.shape[0] :] for w, o in zip(white, self.observe)])
        rms = lambda x: float(np.sqrt(np.mean(x**2))) if len(x) else 0.0
        return Fit(field, states, sigma, rms(u), rms(f), 0.5 * shared.squared(residuals) + prior, prior, determined, ending, history, residuals)
