"""What residuals of a test share: errors of prescribed edges in each step, of load cells in all of them.

Residuals are displacements over their uncertainty, then forces, of one step after the other. Their covariance is

C = I + A A^T + E E^T,

with A the answer of a step to independent errors of its prescribed edges, one block a step, and E the errors of the
forces by gain and zero of the load cells. Woodbury's identity makes of both a few directions in which residuals count
for less.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.linalg
from jaxtyping import Float

#: Variance that errors of edges add to a combination of residuals, over its own, below which it is left out.
NEGLIGIBLE = 1e-2


@dataclass(frozen=True)
class SharedErrors:
    """Covariance of the residuals of all steps.

    Attributes:
        directions: left singular vectors of A by step (residual, direction).
        variances: squared singular values by step (direction,).
        loads: E by step (residual, error).
    """

    directions: Sequence[Float[np.ndarray, "residual direction"]]
    variances: Sequence[Float[np.ndarray, " direction"]]
    loads: Sequence[Float[np.ndarray, "residual error"]]

    @classmethod
    def of(cls, answers: Sequence[np.ndarray], loads: Sequence[np.ndarray]) -> "SharedErrors":
        """From A and E by step."""
        directions, variances = [], []
        for A in answers:
            variance, V = scipy.linalg.eigh(A.T @ A)
            told = variance > NEGLIGIBLE
            directions.append(A @ (V[:, told] / np.sqrt(variance[told])))
            variances.append(variance[told])
        return cls(directions, variances, loads)

    def _unshared(self, step: int, residual):
        """C^-1 without E times residuals of a step, one vector or columns."""
        U, variance = self.directions[step], self.variances[step]
        return residual - U @ ((variance / (1.0 + variance)) * (U.T @ residual).T).T

    @property
    def _between(self):
        """I + E^T C^-1 E of edges alone."""
        each = [E.T @ self._unshared(k, E) for k, E in enumerate(self.loads)]
        return np.eye(self.loads[0].shape[1]) + sum(each)

    @property
    def log_determinant(self) -> float:
        """Of C."""
        edges = sum(float(np.log1p(variance).sum()) for variance in self.variances)
        return edges + float(np.linalg.slogdet(self._between)[1])

    def squared(self, residuals: Sequence[np.ndarray]) -> float:
        """r^T C^-1 r."""
        total, through = 0.0, 0.0
        for k, r in enumerate(residuals):
            unshared = self._unshared(k, r)
            total += float(r @ unshared)
            through = through + self.loads[k].T @ unshared
        return total - float(through @ np.linalg.solve(self._between, through))

    def normal(self, jacobians: Sequence[np.ndarray], residuals: Sequence[np.ndarray]):
        """(J^T C^-1 J, J^T C^-1 r)."""
        curvature = gradient = by_loads = through = 0.0
        for k, (J, r) in enumerate(zip(jacobians, residuals, strict=True)):
            U, variance = self.directions[k], self.variances[k]
            share = variance / (1.0 + variance)
            of_J, of_r = U.T @ J, U.T @ r
            curvature = curvature + J.T @ J - of_J.T @ (share[:, None] * of_J)
            gradient = gradient + J.T @ r - of_J.T @ (share * of_r)
            unshared = self._unshared(k, self.loads[k])
            by_loads, through = by_loads + J.T @ unshared, through + r @ unshared
        solved = np.linalg.solve(self._between, np.concatenate([by_loads.T, through[:, None]], axis=1))
        return curvature - by_loads @ solved[:, :-1], gradient - by_loads @ solved[:, -1]

    def white(self, residuals: Sequence[np.ndarray]) -> list[np.ndarray]:
        """Residuals as independent ones of unit variance, but for what load cells share."""
        found = []
        for U, variance, r in zip(self.directions, self.variances, residuals, strict=True):
            found.append(r - U @ ((1.0 - 1.0 / np.sqrt(1.0 + variance)) * (U.T @ r)))
        return found
