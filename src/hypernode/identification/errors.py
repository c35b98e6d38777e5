"""Covariance of the residuals of a test: errors of prescribed edges in each step, of load cells in all steps.

Residuals are displacements over their uncertainty, then forces, of one step after the other. Their covariance is

C = I + A A^T + E E^T,

A is the answer of a step to independent errors of its prescribed edges, one block a step. E are the errors of the
forces by gain and zero of the load cells. Woodbury's identity makes of the inverse small systems, one an edge error.
"""

import functools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy.linalg
from jaxtyping import Float


class EdgeAnswers(NamedTuple):
    """Derivative of the residuals of a step by independent errors of its prescribed edges.

    Attributes:
        u: displacements that are observed (displacement, error).
        f: forces over their uncertainty (force, error).
        gram: u^T u.
    """

    u: Float[np.ndarray, "displacement error"]
    f: Float[np.ndarray, "force error"]
    gram: Float[np.ndarray, "error error"]


@dataclass(frozen=True)
class SharedErrors:
    """Covariance of the residuals of all steps.

    Attributes:
        answers: to edges, by step.
        loads: errors of load cells by step (force, error).
        sigma: by which residuals of displacements are divided.
    """

    answers: Sequence[EdgeAnswers]
    loads: Sequence[Float[np.ndarray, "force error"]]
    sigma: float

    @functools.cached_property
    def _factors(self):
        """Cholesky factors of I + A^T A, by step."""
        grams = (a.gram / self.sigma**2 + a.f.T @ a.f for a in self.answers)
        return [scipy.linalg.cho_factor(np.eye(len(g)) + g, lower=True) for g in grams]

    def _by_edges(self, step: int, residual):
        """A^T residual, of one vector or of columns."""
        answers = self.answers[step]
        return answers.u.T @ residual[: len(answers.u)] / self.sigma + answers.f.T @ residual[len(answers.u) :]

    @functools.cached_property
    def _of_loads(self):
        """(A^T E by step, L^-1 of these, I + E^T C^-1 E of edges alone)."""
        through = [a.f.T @ E for a, E in zip(self.answers, self.loads, strict=True)]
        solved = [self._half(k, each) for k, each in enumerate(through)]
        between = sum(E.T @ E - half.T @ half for E, half in zip(self.loads, solved, strict=True))
        return solved, np.eye(self.loads[0].shape[1]) + between

    def _half(self, step: int, right):
        """L^-1 right."""
        return scipy.linalg.solve_triangular(self._factors[step][0], right, lower=True)

    @property
    def log_determinant(self) -> float:
        """Of C."""
        edges = sum(2.0 * float(np.log(np.diag(factor)).sum()) for factor, _ in self._factors)
        return edges + float(np.linalg.slogdet(self._of_loads[1])[1])

    def squared(self, residuals: Sequence[np.ndarray]) -> float:
        """r^T C^-1 r."""
        total, through = 0.0, 0.0
        for k, r in enumerate(residuals):
            half = self._half(k, self._by_edges(k, r))
            total += float(r @ r - half @ half)
            through = through + self.loads[k].T @ r[len(self.answers[k].u) :] - self._of_loads[0][k].T @ half
        return total - float(through @ np.linalg.solve(self._of_loads[1], through))

    def normal(self, jacobians: Iterable[np.ndarray], residuals: Sequence[np.ndarray]):
        """(J^T C^-1 J, J^T C^-1 r)."""
        curvature = gradient = by_loads = through = 0.0
        steps, J = iter(jacobians), None
        for k, r in enumerate(residuals):
            # That of one step takes memory enough while the next is made.
            del J
            J = next(steps)
            half, half_r = self._half(k, self._by_edges(k, J)), self._half(k, self._by_edges(k, r))
            curvature = curvature + J.T @ J - half.T @ half
            gradient = gradient + J.T @ r - half.T @ half_r
            first, E, of_loads = len(self.answers[k].u), self.loads[k], self._of_loads[0][k]
            by_loads = by_loads + J[first:].T @ E - half.T @ of_loads
            through = through + r[first:] @ E - half_r @ of_loads
        solved = np.linalg.solve(self._of_loads[1], np.concatenate([by_loads.T, through[:, None]], axis=1))
        return curvature - by_loads @ solved[:, :-1], gradient - by_loads @ solved[:, -1]

    def weighed(self, residuals: Sequence[np.ndarray]) -> list[np.ndarray]:
        """C^-1 of columns of residuals, by step (residual, column)."""
        halves = [self._half(k, self._by_edges(k, r)) for k, r in enumerate(residuals)]
        each = zip(residuals, halves, self.answers, self.loads, self._of_loads[0], strict=True)
        through = sum(E.T @ r[len(a.u) :] - of_loads.T @ half for r, half, a, E, of_loads in each)
        by_loads, found = np.linalg.solve(self._of_loads[1], through), []
        for k, (r, half, a, E) in enumerate(zip(residuals, halves, self.answers, self.loads, strict=True)):
            by_edges = half - self._of_loads[0][k] @ by_loads
            taken = scipy.linalg.solve_triangular(self._factors[k][0], by_edges, lower=True, trans=1)
            left = r - np.concatenate([a.u @ taken / self.sigma, a.f @ taken])
            left[len(a.u) :] -= E @ by_loads
            found.append(left)
        return found

    def white(self, residuals: Sequence[np.ndarray]) -> list[np.ndarray]:
        """Residuals of each step, transformed to unit variance; correlation by load cells remains."""
        found = []
        for k, r in enumerate(residuals):
            answers = self.answers[k]
            gram = answers.gram / self.sigma**2 + answers.f.T @ answers.f
            variance, V = np.linalg.eigh(gram)
            # (I + A A^T)^(-1/2) = I - A V (1 - (1 + s^2)^(-1/2)) / s^2 V^T A^T.
            safe = np.maximum(variance, np.finfo(float).tiny)
            share = np.where(variance > 1e-12, (1.0 - 1.0 / np.sqrt(1.0 + safe)) / safe, 0.5)
            taken = V @ (share * (V.T @ self._by_edges(k, r)))
            found.append(r - np.concatenate([answers.u @ taken / self.sigma, answers.f @ taken]))
        return found
