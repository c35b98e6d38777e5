"""Exact derivatives of the residuals of a finite-element equilibrium by the parameters of its material.

With R(u, p) = 0 in the free nodes, du/dp = -K^-1 dR/dp; forces follow from R on the edges. The Jacobian of a sheet is
dense, of some thousand residuals by some thousand parameters and load step. It is known as products, each of which
costs a back-substitution with the factors of the tangent stiffness K; they take one vector or the columns of a matrix.

The steps of one test are points of one smooth path, along which the Jacobian grows nearly with the load. Two of them
therefore give the curvature of all, by a quadrature rule.
"""

import functools
from collections.abc import Sequence
from itertools import combinations

import numpy as np
import scipy.linalg
from jaxtyping import Float

from hypernode.fem.factors import factorise
from hypernode.identification import budgets, numerics


def quadrature(sizes: Float[np.ndarray, " step"]) -> Float[np.ndarray, " step"]:
    """Weights of two load steps of a test, zero for the others, whose weighted sum stands for that of all steps.

    The sum is exact for what grows with the square and the cube of the load. Of the pairs with positive weights, that
    one is taken which comes closest for the fourth power and for what does not grow. Without such a pair every step
    counts once.

    Args:
        sizes: load of every step.
    """
    best, rule = np.inf, np.ones(len(sizes))
    if len(sizes) <= 2:
        return rule
    moments = sizes ** np.arange(5)[:, None]
    total = moments.sum(axis=1)
    for pair in map(list, combinations(range(len(sizes)), 2)):
        if np.ptp(sizes[pair]) == 0.0:
            continue
        weights = np.linalg.solve(moments[2:4, pair], total[2:4])
        error = np.abs(moments[[0, 4]][:, pair] @ weights / total[[0, 4]] - 1.0).sum()
        if weights.min() > 0.0 and error < best:
            best, rule = error, np.zeros(len(sizes))
            rule[pair] = weights
    return rule


def directions(A: Float[np.ndarray, "residual error"]):
    """(left singular vectors, squared singular values) of ``A``, without those of :data:`NEGLIGIBLE_VARIANCE`."""
    variance, V = scipy.linalg.eigh(A.T @ A)
    told = variance > numerics.NEGLIGIBLE_VARIANCE
    return A @ (V[:, told] / np.sqrt(variance[told])), variance[told]


def _without(directions: Float[np.ndarray, "residual direction"], share, residual):
    """``residual``, or every column of it, without a share of it in each of some orthonormal directions."""
    return residual - directions @ (share * (directions.T @ residual).T).T


def _quadratic(root: Float[np.ndarray, "parameter error"], change):
    """root root^T change."""
    return root @ (root.T @ change)


class StepJacobian:
    """The Jacobian J (residual, parameter) of one load step at one material field.

    Residuals are the observed displacements of the step, then its forces, over their uncertainties. Errors of the
    prescribed edges, shared by all of the sheet, make their covariance I + A A^T with A the derivative by the edges'
    independent errors. Its inverse root is I - U g U^T with the left singular vectors U of A and
    g = 1 - 1 / sqrt(1 + s^2).

    Attributes:
        factor: factors of the free tangent stiffness.
        variance: what errors of the prescribed edges add to the variance of the residuals, in each direction of theirs.
        observed, parameters: how many displacements are observed, and how many parameters there are.

    Args:
        K: tangent stiffness (degree of freedom, degree of freedom).
        B: derivative of the nodal forces by the parameters (degree of freedom, parameter).
        free: free degrees of freedom.
        observe: observed displacements over their uncertainty from all of them.
        forces: direction (degree of freedom,) and uncertainty of every measured resultant.
        errors: errors of the prescribed displacements (degree of freedom, independent standard normal number), sparse.
        answered: A, where it is known (residual, independent standard normal number).
    """

    def __init__(self, *, K, B, free, observe, forces, errors, answered=None):
        self._rows, self._free, self._observe = K[free], free, observe
        self._seen = observe[:, free]
        self.factor = factorise(self._rows[:, free])
        self._load = B[free]
        self._load_transposed = self._load.T.tocsr()
        reactions = self._reactions = [K @ direction / sigma for direction, sigma in forces]
        self._force_rows = np.zeros((len(forces), B.shape[1]))
        for row, (direction, sigma), reaction in zip(self._force_rows, forces, reactions, strict=True):
            row[:] = B.T @ direction / sigma - self._load_transposed @ self.factor.solve(reaction[free])
        self.observed, self.parameters = observe.shape[0], B.shape[1]
        self._shared, self.variance = directions(self._answered(errors) if answered is None else answered)

    def _answered(self, errors):
        """How residuals answer to errors of the prescribed displacements, some at a time."""
        found = []
        for first in range(0, errors.shape[1], budgets.ERRORS_AT_ONCE):
            some = errors[:, first : first + budgets.ERRORS_AT_ONCE]
            du = some.toarray()
            du[self._free] = -self.factor.solve((self._rows @ some).toarray())
            found.append(np.concatenate([self._observe @ du, *(r[None] @ du for r in self._reactions)]))
        return np.concatenate(found, axis=1) if found else np.zeros((self.observed + len(self._reactions), 0))

    def displacement(self, change):
        """First-order change of the free displacements."""
        return -self.factor.solve(self._load @ change)

    def whiten(self, residual):
        """Residuals that share the errors of prescribed edges, as independent ones of unit variance."""
        return _without(self._shared, 1.0 - 1.0 / np.sqrt(1.0 + self.variance), residual)

    def without(self, white, errors):
        """Whitened residuals, without what further errors explain of them."""
        shared, variance = directions(self.whiten(self._answered(errors)))
        return _without(shared, 1.0 - 1.0 / np.sqrt(1.0 + variance), white)

    def product(self, change):
        """J change, not whitened."""
        return np.concatenate([self._seen @ self.displacement(change), self._force_rows @ change])

    def _adjoint(self, residual):
        """J^T residual, not whitened."""
        observed, forces = np.split(residual, [self.observed])
        return self._force_rows.T @ forces - self._load_transposed @ self.factor.solve(self._seen.T @ observed)

    def adjoint(self, residual):
        """J^T residual."""
        return self._adjoint(self.whiten(residual))

    def curvature(self, change):
        """J^T J change."""
        residual = self.product(change)
        return self._adjoint(_without(self._shared, self.variance / (1.0 + self.variance), residual))


class Jacobian:
    """The Jacobian J (residual, parameter) of all load steps.

    Residuals are the observed displacements step by step, then the forces. Forces of several steps share the errors of
    the load cell. These are treated as those of prescribed edges are in each step. Once the latter are taken out, the
    covariance is I + A A^T, with A the derivative by the shared errors.

    Args:
        force_steps: the load step of every force.
        force_errors: errors that forces share, over their uncertainties (force, independent standard normal number).
        sigma: the uncertainty of displacements that residuals are over.
        shares: weight of every load step in :meth:`nearly_curvature`.
    """

    def __init__(self, *, steps: list[StepJacobian], force_steps: list[int], force_errors, sigma: float, shares):
        self.steps, self.sigma, self._shares = steps, sigma, np.asarray(shares)
        of_step = np.concatenate(
            [*(np.full(step.observed, k) for k, step in enumerate(steps)), np.array(force_steps, int)]
        )
        self._rows = [np.flatnonzero(of_step == k) for k in range(len(steps))]
        #: (residuals, parameters).
        self.shape = len(of_step), steps[0].parameters
        self._of_step = of_step
        A = np.concatenate([np.zeros((self.shape[0] - len(force_steps), force_errors.shape[1])), force_errors])
        self._by_errors = self._white_by_step(A)
        self._shared, self._variance = directions(self._by_errors)

    def _white_by_step(self, residual):
        white = np.empty_like(residual)
        for step, rows in zip(self.steps, self._rows, strict=True):
            white[rows] = step.whiten(residual[rows])
        return white

    def _shared_curvature(self, shares):
        """Root (parameter, error) of what errors that forces share take from the curvature of the weighted steps."""
        weights = np.sqrt(shares)
        shared, variance = directions(weights[self._of_step][:, None] * self._by_errors)
        taken = shared * np.sqrt(variance / (1.0 + variance))
        steps = zip(self.steps, self._rows, weights, strict=True)
        return sum(weight * step.adjoint(taken[rows]) for step, rows, weight in steps)

    @functools.cached_property
    def _of_every_step(self):
        return self._shared_curvature(np.ones(len(self.steps)))

    @functools.cached_property
    def _of_weighted_steps(self):
        return self._shared_curvature(self._shares)

    @property
    def log_determinant(self) -> float:
        """Logarithm of the determinant of the residuals' covariance, beyond that of independent ones."""
        variances = [self._variance, *(step.variance for step in self.steps)]
        return float(sum(np.log1p(variance).sum() for variance in variances))

    def displacement(self, change) -> list[np.ndarray]:
        """First-order change of the free displacements of every step."""
        return [step.displacement(change) for step in self.steps]

    def whiten(self, residual):
        """Residuals that share errors of prescribed edges and of load cells, as independent ones of unit variance."""
        return self._independent(self._white_by_step(residual))

    def _independent(self, residual):
        """``residual`` without a share of it in each of the directions that errors of load cells have."""
        return _without(self._shared, 1.0 - 1.0 / np.sqrt(1.0 + self._variance), residual)

    def without(self, white, errors: Sequence):
        """Whitened residuals, without what further errors of prescribed displacements of each step explain of them."""
        left = white.copy()
        for step, rows, each in zip(self.steps, self._rows, errors, strict=True):
            left[rows] = step.without(white[rows], each)
        return left

    def of_steps(self, steps) -> np.ndarray:
        """Which residuals are those of some load steps (residual,)."""
        return np.isin(self._of_step, steps)

    def product(self, change):
        """J change, whitened, of one vector or of the columns of a matrix."""
        product = np.empty((self.shape[0], *change.shape[1:]))
        for step, rows in zip(self.steps, self._rows, strict=True):
            product[rows] = step.product(change)
        return self.whiten(product)

    def adjoint(self, residual):
        """J^T residual, of one vector of whitened residuals or of the columns of a matrix."""
        residual = self._independent(residual)
        return sum(step.adjoint(residual[rows]) for step, rows in zip(self.steps, self._rows, strict=True))

    def curvature(self, change):
        """J^T J change, step by step: the factors of one serve twice while they are at hand."""
        return sum(step.curvature(change) for step in self.steps) - _quadratic(self._of_every_step, change)

    def nearly_curvature(self, change):
        """:meth:`curvature` by the steps that have a share: a fraction of the time, and as good for a step downhill."""
        used = zip(self._shares, self.steps, strict=True)
        return sum(share * step.curvature(change) for share, step in used if share > 0.0) - _quadratic(
            self._of_weighted_steps, change
        )
