"""The objective of the constrained stage, its Gauss-Newton steps, and its posterior samples."""

import dataclasses
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import scipy.sparse
from jaxtyping import Float

from hypernode.identification import budgets, numerics
from hypernode.identification.deflated_cg import DeflatedCG, Solution
from hypernode.identification.problem import FieldProblem
from hypernode.identification.regulariser import JumpCost, Regulariser
from hypernode.identification.sensitivities import Jacobian


class Step(NamedTuple):
    """A damped Gauss-Newton step with results of its linear solve.

    Attributes:
        change: of the parameters, flattened.
        gradient_norm: of the objective by the parameters, where it is linearised.
        cg_residual, cg_iterations: where conjugate gradients ended: relative residual, and how many iterations.
        deflation: directions for the next step.
    """

    change: np.ndarray
    gradient_norm: float
    cg_residual: float
    cg_iterations: int
    deflation: np.ndarray | None


def white_residuals(problem: FieldProblem, states, sigma: float, linear: Jacobian | None):
    """(displacements, forces): misfits of a test over their uncertainties, free of what errors of edges explain.

    Args:
        sigma: uncertainty of the displacements.
        linear: sensitivities with the covariance of the residuals; without them residuals count as independent.
    """
    u, f = problem.residuals(states)
    every = np.concatenate([*(r / sigma for r in u), f])
    if linear is not None:
        every = linear.whiten(every)
    return tuple(np.split(every, [len(every) - len(f)]))


@dataclasses.dataclass(frozen=True, kw_only=True)
class Objective:
    """What is minimised: misfits in units of their uncertainty, jumps of the field, a small ridge.

    Methods with an argument ``linear``, the sensitivities at some field, whiten residuals by the errors of prescribed
    edges. Without it residuals count as independent.

    Attributes:
        problem: the data, and the equilibrium that ties a field to them.
        regulariser, regulariser_weight, jump_cost: what jumps cost.
        ridge, centre: weight of the squared distance of each parameter from its prior value ``centre``.
    """

    problem: FieldProblem
    regulariser: Regulariser
    regulariser_weight: float
    jump_cost: JumpCost
    ridge: Float[np.ndarray, " parameter"]
    centre: Float[np.ndarray, " parameter"]

    def residuals(self, states, sigma: float, linear: Jacobian | None) -> tuple[np.ndarray, np.ndarray]:
        """(displacements, forces): misfits over their uncertainties, free of what errors of edges explain."""
        return white_residuals(self.problem, states, sigma, linear)

    def misfit(self, states, linear: Jacobian | None) -> float:
        """Root mean square of the displacement misfit over its noise."""
        # A linearisation has the uncertainty that displacements had there.
        sigma = self.problem.sigma if linear is None else linear.sigma
        u, _ = self.residuals(states, sigma, linear)
        return float(np.sqrt(np.mean(u**2))) * sigma / self.problem.sigma

    def force_misfit(self, states, linear: Jacobian | None) -> float:
        """Root mean square of the misfit of the forces over their uncertainty."""
        _, f = self.residuals(states, self.problem.sigma, linear)
        return float(np.sqrt(np.mean(f**2))) if len(f) else 0.0

    def value(self, params, states, sigma: float, linear: Jacobian | None) -> float:
        """The objective with displacements weighted by ``sigma``."""
        regular = self.regulariser_weight * self.regulariser.value(params, self.jump_cost)
        regular += 0.5 * self.ridge @ (params.ravel() - self.centre) ** 2
        return self.misfits(states, sigma, linear) + regular

    def misfits(self, states, sigma: float, linear: Jacobian | None) -> float:
        """The part of :meth:`value` due to displacements and forces."""
        return 0.5 * sum(float(r @ r) for r in self.residuals(states, sigma, linear))

    def misfit_gradient(self, states, linear: Jacobian) -> Float[np.ndarray, " parameter"]:
        """Gradient of the share of displacements and forces in :meth:`value` by the parameters, flattened."""
        return linear.adjoint(np.concatenate(self.residuals(states, linear.sigma, linear)))

    def gauss_newton(self, linear: Jacobian, params, states, damping: float, explained: bool, deflation) -> Step:
        """Step of a damped Gauss-Newton iteration from the field of ``linear``, by conjugate gradients.

        Args:
            explained: whether the displacements are already explained, so that the step may be looser.
            deflation: what the step before left, or None.
        """
        R, r, B = self._jump_roots(params)
        gradient = self.misfit_gradient(states, linear)
        gradient += block_diagonal(B).T @ (R.T @ r) + self.ridge * (params.ravel() - self.centre)
        system = NormalEquations(
            curvature=linear.nearly_curvature,
            R=R,
            B=B,
            ridge=self.ridge + damping,
            deflation=deflation,
        )
        iterations = budgets.CG_ITERATIONS[int(self.jump_cost.scale is not None)]
        solution = system.solve(-gradient, numerics.CG_TOLERANCE[int(explained)], iterations)
        change = system.to_params(solution.x)
        norm = float(np.linalg.norm(gradient))
        return Step(change, norm, solution.residual, solution.iterations, solution.deflation)

    def precision(self, curvature: Callable, params, deflation=None) -> "NormalEquations":
        """Systems with the inverse covariance of the posterior at a field (Laplace's approximation).

        Args:
            curvature: x -> J^T J x, of all tests together.
            params: the field (cell, parameter).
            deflation: what a solve of a similar system left, or None.
        """
        R, _, B = self._jump_roots(params)
        return NormalEquations(curvature=curvature, R=R, B=B, ridge=self.ridge, deflation=deflation)

    def posterior_samples(
        self, linear: Jacobian, params, count: int, seed: int, deflation=None
    ) -> Float[np.ndarray, "posterior_sample cell parameter"]:
        """Samples of the posterior about the best field, where it is linearised (Laplace's approximation).

        They are drawn from the Gaussian with the curvature of the objective. Each solves the linear system for randomly
        perturbed data, jumps and ridge (Papandreou and Yuille 2010).
        """
        R, _, B = self._jump_roots(params)
        system = self.precision(linear.curvature, params, deflation)
        random, fields = np.random.default_rng(seed), []
        for _ in range(count):
            disturbed = linear.adjoint(random.normal(size=linear.shape[0]))
            disturbed += block_diagonal(B).T @ (R.T @ random.normal(size=R.shape[0]))
            disturbed += np.sqrt(self.ridge) * random.normal(size=params.size)
            solution = system.solve(disturbed, numerics.SAMPLE_TOLERANCE, budgets.SAMPLE_ITERATIONS, learn=False)
            fields.append(params + system.to_params(solution.x).reshape(params.shape))
        return np.array(fields)

    def effective_parameters(self, linear: Jacobian, params, deflation=None) -> float:
        """Effective number of parameters: those that the test determines, and not jumps and ridge.

        It is the trace of J H^-1 J^T, with H the curvature of data, jumps and ridge together (MacKay, Bayesian
        interpolation, 1992). One vector of random signs estimates it (Hutchinson); the standard error is at most the
        root of twice the trace. Similar fields are compared with the same signs, which reduces the error of their
        difference.

        Args:
            linear: sensitivities at the field.
            params: the field (cell, parameter).
            deflation: what a solve of a similar system left, or None.
        """
        signs = np.random.default_rng(0).choice([-1.0, 1.0], linear.shape[0])
        load = linear.adjoint(signs)
        system = self.precision(linear.curvature, params, deflation)
        solved = system.solve(load, numerics.TRACE_TOLERANCE, budgets.SAMPLE_ITERATIONS, learn=False)
        return float(load @ system.to_params(solved.x))

    def _jump_roots(self, params):
        """:meth:`Regulariser.roots` with the regulariser's weight."""
        R, r, B = self.regulariser.roots(params, self.jump_cost)
        weight = np.sqrt(self.regulariser_weight)
        return weight * R, weight * r, B


def block_diagonal(blocks: Float[np.ndarray, "cell row column"]) -> scipy.sparse.bsr_matrix:
    """Matrix with one block a cell, on flattened fields."""
    return scipy.sparse.bsr_matrix((blocks, np.arange(len(blocks)), np.arange(len(blocks) + 1)))


class NormalEquations:
    """(J^T J + B^T R^T R B + ridge) x = b, solved for the coordinates y = B x of jumps.

    In these coordinates the penalty on jumps decouples. The preconditioner then consists of one small matrix for each
    coordinate instead of one large matrix.

    Args:
        curvature: x -> J^T J x.
        R: root of the jumps' quadratic form.
        B: one invertible block a cell.
        ridge: by parameter.
        deflation: directions from the solve of an earlier system, or None.
    """

    def __init__(
        self,
        *,
        curvature: Callable,
        R,
        B: Float[np.ndarray, "cell coordinate parameter"],
        ridge,
        deflation,
    ):
        inverse = np.linalg.inv(B)
        # Of no function here is this object a part: a circle of references would keep all of a linearisation in memory
        # until garbage is collected.
        to_params = self._to_params = block_diagonal(inverse).tocsr()
        to_coordinates = self._to_coordinates = to_params.T.tocsr()
        jumps = (R.T @ R).tocsc()

        def data(y):
            return to_coordinates @ curvature(to_params @ y)

        def product(y):
            x = to_params @ y
            held = ridge * x if x.ndim == 1 else ridge[:, None] * x
            return to_coordinates @ (curvature(x) + held) + jumps @ y

        # The mean curvature of the data by coordinate: the diagonal of J^T J from products with random signs
        # (Hutchinson's estimate).
        signs = np.random.default_rng(0).choice([-1.0, 1.0], (jumps.shape[0], budgets.CURVATURE_PROBES))
        estimate = (signs * data(signs)).mean(axis=1).reshape(B.shape[:2])
        typical = numerics.CURVATURE_SHARE * np.maximum(estimate.mean(axis=0), 0.0)
        held = np.einsum("cp,cpq->cq", ridge.reshape(B.shape[:2]), inverse**2)
        metric = jumps + scipy.sparse.diags((held + typical).ravel())
        self._solver = DeflatedCG(product, metric, budgets.DEFLATED_DIRECTIONS, deflation)

    def solve(self, b, rtol: float, iterations: int, learn: bool = True) -> Solution:
        """The coordinates y to the relative residual ``rtol``, or as near as ``iterations`` come."""
        return self._solver.solve(self._to_coordinates @ b, rtol, iterations, learn)

    def solve_columns(self, b, rtol: float, iterations: int):
        """The same of several columns at a time (parameter, k), to their parameters."""
        return self._to_params @ self._solver.solve_columns(self._to_coordinates @ b, rtol, iterations)

    def to_params(self, y):
        """x of the coordinates y."""
        return self._to_params @ y
