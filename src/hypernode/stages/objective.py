"""What the constrained stage minimises, its Gauss-Newton steps, and the fields that it cannot tell from the best."""

import dataclasses

import numpy as np
import scipy.sparse
import scipy.sparse.linalg
from jaxtyping import Float

from hypernode.stages.equilibrium_solver import factorise
from hypernode.stages.field_problem import FieldProblem
from hypernode.stages.jumps import Jumps

#: Conjugate-gradient iterations of a step, before and after jumps stop costing more.
LINEAR_ITERATIONS = (150, 200)
#: Residual at which they end, relative to the gradient: while the displacements are not explained, and
#: then. The valleys on the way are narrow; a loose step crosses them to and fro, and where that ends is chance.
LINEAR_TOLERANCE = (0.003, 0.01)
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
    jump_weight: float
    ridge: np.ndarray
    centre: np.ndarray

    def misfit(self, states) -> float:
        """Root mean square of the displacement misfit."""
        u, _ = self.problem.residuals(states)
        return float(np.sqrt(sum(r @ r for r in u) / sum(len(r) for r in u)))

    def value(self, params, states, sigma: float) -> float:
        """The objective with displacements weighted by ``sigma``."""
        u, f = self.problem.residuals(states)
        regular = self.jump_weight * self.jumps.value(params)
        regular += 0.5 * self.ridge @ (params.ravel() - self.centre) ** 2
        return 0.5 * (sum(r @ r for r in u) / sigma**2 + f @ f) + regular

    def gauss_newton(self, params, states, sigma: float, damping: float, explained: bool):
        """(linearisation, step) of a damped Gauss-Newton iteration, by preconditioned conjugate gradients."""
        linear, gradient, curvature = self.data_model(params, states, sigma)
        regular = self.jump_weight * self.jumps.hessian(params) + scipy.sparse.diags(self.ridge + damping)
        gradient += (regular - damping * scipy.sparse.identity(params.size)) @ params.ravel() - self.ridge * self.centre
        solve = _normal_equations(linear, regular, np.tile(CURVATURE_SHARE * curvature, len(params)))
        iterations = LINEAR_ITERATIONS[int(self.jumps.scale is not None)]
        return linear, solve(-gradient, LINEAR_TOLERANCE[int(explained)], iterations)

    def draws(self, params, states, count: int, seed: int) -> Float[np.ndarray, "draw cell parameter"]:
        """Fields that the test tells as little from the best one as its noise allows.

        Samples of the Gaussian with the curvature of the objective there (Laplace's approximation): each answers to
        data, jumps and ridge disturbed by as much as they weigh (Papandreou and Yuille 2010).
        """
        linear, _, curvature = self.data_model(params, states, self.problem.sigma)
        root = np.sqrt(self.jump_weight) * self.jumps.root(params)
        regular = root.T @ root + scipy.sparse.diags(self.ridge)
        solve = _normal_equations(linear, regular.tocsc(), np.tile(CURVATURE_SHARE * curvature, len(params)))
        u, f = self.problem.residuals(states)
        random, fields = np.random.default_rng(seed), []
        for _ in range(count):
            disturbed = linear.adjoint([random.normal(size=r.shape) for r in u], random.normal(size=f.shape))
            disturbed += root.T @ random.normal(size=root.shape[0])
            disturbed += np.sqrt(self.ridge) * random.normal(size=params.size)
            fields.append(params + solve(disturbed, DRAW_TOLERANCE, DRAW_ITERATIONS).reshape(params.shape))
        return np.array(fields)

    def data_model(self, params, states, sigma: float):
        """(linearisation, gradient of the misfits (flat), their mean second derivative by parameter).

        The last is the diagonal of J^T J from products with random signs (Hutchinson's estimate).
        """
        linear = self.problem.linearise(params, states, sigma)
        u, f = self.problem.residuals(states)
        signs = np.random.default_rng(0).choice([-1.0, 1.0], (CURVATURE_PROBES, params.size))
        estimate = sum(v * linear.adjoint(*linear.forward(v)) for v in signs) / CURVATURE_PROBES
        curvature = np.maximum(estimate.reshape(params.shape).mean(axis=0), 0.0)
        return linear, linear.adjoint([r / sigma for r in u], f), curvature


def _normal_equations(linear, regular, curvature):
    """(right-hand side, tolerance, iterations) -> solution with J^T J + ``regular``, by conjugate gradients.

    Args:
        curvature: share of the data's mean curvature, by parameter, that joins the preconditioner.
    """
    precondition = factorise(regular + scipy.sparse.diags(curvature))
    operator = scipy.sparse.linalg.LinearOperator(
        regular.shape, lambda x: linear.adjoint(*linear.forward(x)) + regular @ x
    )
    inverse = scipy.sparse.linalg.LinearOperator(regular.shape, precondition.solve)
    return lambda b, rtol, maxiter: scipy.sparse.linalg.cg(operator, b, rtol=rtol, maxiter=maxiter, M=inverse)[0]
