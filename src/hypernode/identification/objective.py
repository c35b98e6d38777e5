"""What the constrained stage minimises, its Gauss-Newton steps, and the fields that it cannot tell from the best."""

import dataclasses
from collections.abc import Callable

import numpy as np
import scipy.sparse
from jaxtyping import Float

from hypernode.identification.deflated_cg import DeflatedCG
from hypernode.identification.problem import FieldProblem
from hypernode.identification.regulariser import Jumps
from hypernode.identification.sensitivities import Jacobian

#: Conjugate-gradient iterations of a step, before and after jumps stop costing more.
LINEAR_ITERATIONS = (150, 200)


#: Residual at which they end, relative to the gradient: while the displacements are not explained, and
#: then. The valleys on the way are narrow; a loose step crosses them to and fro, and where that ends is chance.
LINEAR_TOLERANCE = (0.001, 0.003)


#: Share of the mean curvature of the data that joins the preconditioner, and how many random vectors
#: estimate it.
CURVATURE_SHARE, CURVATURE_PROBES = 0.3, 2


#: Relative residual and most iterations of a draw.
DRAW_TOLERANCE, DRAW_ITERATIONS = 0.01, 100


@dataclasses.dataclass
class Objective:
    """What is minimised: misfits in units of their uncertainty, jumps of the field, a small ridge."""

    problem: FieldProblem
    jumps: Jumps
    regulariser_weight: float
    ridge: np.ndarray
    centre: np.ndarray
    #: What the last step learned of the normal equations, for the next one's.
    known: np.ndarray | None = None
    #: The last linearisation: it knows what residuals share.
    linear: Jacobian | None = None

    def residuals(self, states, sigma: float) -> tuple[np.ndarray, np.ndarray]:
        """(displacements, forces): misfits over their uncertainties, free of what errors of held edges explain."""
        u, f = self.problem.residuals(states)
        every = np.concatenate([*(r / sigma for r in u), f])
        if self.linear is not None:
            every = self.linear.whiten(every)
        return tuple(np.split(every, [len(every) - len(f)]))

    def misfit(self, states) -> float:
        """Root mean square of the displacement misfit over its noise."""
        # The last linearisation has the uncertainty that displacements had then.
        sigma = self.problem.sigma if self.linear is None else self.linear.sigma
        u, _ = self.residuals(states, sigma)
        return float(np.sqrt(np.mean(u**2))) * sigma / self.problem.sigma

    def force_misfit(self, states) -> float:
        """Root mean square of the misfit of the forces over their uncertainty."""
        _, f = self.residuals(states, self.problem.sigma)
        return float(np.sqrt(np.mean(f**2))) if len(f) else 0.0

    def value(self, params, states, sigma: float) -> float:
        """The objective with displacements weighted by ``sigma``."""
        regular = self.regulariser_weight * self.jumps.value(params)
        regular += 0.5 * self.ridge @ (params.ravel() - self.centre) ** 2
        return self.misfits(states, sigma) + regular

    def misfits(self, states, sigma: float) -> float:
        """The share of displacements and forces in :meth:`value`."""
        return 0.5 * sum(float(r @ r) for r in self.residuals(states, sigma))

    def linearise(self, params, states, sigma: float) -> None:
        """Make a field the one about which steps, draws and what residuals share are known."""
        self.linear = self.problem.linearise(params, states, sigma)

    def gauss_newton(self, params, states, damping: float, explained: bool):
        """Step of a damped Gauss-Newton iteration from the field linearised last, by conjugate gradients."""
        R, r, B = self._jump_roots(params)
        gradient = self.linear.adjoint(np.concatenate(self.residuals(states, self.linear.sigma)))
        gradient += block_diagonal(B).T @ (R.T @ r) + self.ridge * (params.ravel() - self.centre)
        system = NormalEquations(self.linear.nearly_curvature, R, B, self.ridge + damping, self.known)
        iterations = LINEAR_ITERATIONS[int(self.jumps.scale is not None)]
        step = system.solve(-gradient, LINEAR_TOLERANCE[int(explained)], iterations)
        self.known = system.learned()
        return step

    def draws(self, params, count: int, seed: int) -> Float[np.ndarray, "draw cell parameter"]:
        """Fields that the test tells as little from the best one, where it is linearised, as its noise allows.

        Samples of the Gaussian with the curvature of the objective there (Laplace's approximation): each answers to
        data, jumps and ridge disturbed by as much as they weigh (Papandreou and Yuille 2010).
        """
        linear = self.linear
        R, _, B = self._jump_roots(params)
        system = NormalEquations(linear.curvature, R, B, self.ridge, self.known)
        random, fields = np.random.default_rng(seed), []
        for _ in range(count):
            disturbed = linear.adjoint(random.normal(size=linear.shape[0]))
            disturbed += block_diagonal(B).T @ (R.T @ random.normal(size=R.shape[0]))
            disturbed += np.sqrt(self.ridge) * random.normal(size=params.size)
            fields.append(params + system.solve(disturbed, DRAW_TOLERANCE, DRAW_ITERATIONS).reshape(params.shape))
        return np.array(fields)

    def _jump_roots(self, params):
        """:meth:`Jumps.roots` with the weight of jumps."""
        R, r, B = self.jumps.roots(params)
        weight = np.sqrt(self.regulariser_weight)
        return weight * R, weight * r, B


def block_diagonal(blocks: Float[np.ndarray, "cell row column"]) -> scipy.sparse.bsr_matrix:
    """Matrix with one block a cell, on flattened fields."""
    return scipy.sparse.bsr_matrix((blocks, np.arange(len(blocks)), np.arange(len(blocks) + 1)))


class NormalEquations:
    """(J^T J + B^T R^T R B + ridge) x = b, solved for the coordinates y = B x of jumps.

    There the jumps of one coordinate do not know of another's, and the metric of the solver, which has them all, falls
    into one small matrix a coordinate; by the parameters it would be one large matrix.

    Args:
        curvature: x -> J^T J x.
        R: root of the jumps' quadratic form.
        B: one invertible block a cell.
        ridge: by parameter.
        known: what an earlier system :meth:`learned`.
    """

    def __init__(self, curvature: Callable, R, B: Float[np.ndarray, "cell coordinate parameter"], ridge, known):
        inverse = np.linalg.inv(B)
        self._to_params = block_diagonal(inverse).tocsr()
        self._to_coordinates = self._to_params.T.tocsr()
        jumps = (R.T @ R).tocsc()

        def data(y):
            return self._to_coordinates @ curvature(self._to_params @ y)

        def product(y):
            x = self._to_params @ y
            held = ridge * x if x.ndim == 1 else ridge[:, None] * x
            return self._to_coordinates @ (curvature(x) + held) + jumps @ y

        # The mean curvature of the data by coordinate: the diagonal of J^T J from products with random signs
        # (Hutchinson's estimate).
        signs = np.random.default_rng(0).choice([-1.0, 1.0], (jumps.shape[0], CURVATURE_PROBES))
        estimate = (signs * data(signs)).mean(axis=1).reshape(B.shape[:2])
        typical = CURVATURE_SHARE * np.maximum(estimate.mean(axis=0), 0.0)
        held = np.einsum("cp,cpq->cq", ridge.reshape(B.shape[:2]), inverse**2)
        metric = jumps + scipy.sparse.diags((held + typical).ravel())
        self._solver = DeflatedCG(product, metric, known)

    def solve(self, b, rtol: float, iterations: int):
        """x to the relative residual ``rtol`` of the coordinates' system, or as near as ``iterations`` come."""
        return self._to_params @ self._solver.solve(self._to_coordinates @ b, rtol, iterations)

    def learned(self):
        """What makes the next system easier, see :class:`DeflatedCG`."""
        return self._solver.learned()
