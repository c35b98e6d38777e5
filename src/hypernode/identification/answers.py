"""How a load step answers to numbers, to first order: displacements by solves, residuals by what is seen of them."""

from typing import NamedTuple

import numpy as np
import scipy.sparse
from jaxtyping import Float, Int

from hypernode.fem.factors import AT_ONCE, CholeskyFactors


class Answer(NamedTuple):
    """How a step answers to numbers, to first order.

    Attributes:
        displacements: derivative of the displacement at free degrees of freedom by numbers that load nodes.
        forces: derivative of the forces over their uncertainty (force, number).
        observe: observed displacements from those of free degrees of freedom (displacement, free).
        some: which numbers load nodes.
        free: degrees of freedom that equilibrium moves.
    """

    displacements: Float[np.ndarray, "free some"]
    forces: Float[np.ndarray, "force number"]
    observe: scipy.sparse.csr_matrix
    some: Int[np.ndarray, " some"]
    free: Int[np.ndarray, " free"]

    @classmethod
    def of(cls, factors, K, load, free, observe, forces) -> "Answer":
        """The answer to numbers whose load on the nodes is given.

        Args:
            factors: of the free tangent K.
            load: derivative of the nodal forces by the numbers (degree of freedom, number), sparse.
            observe: observed displacements from all of them, sparse.
            forces: measured resultants of the step.
        """
        # Numbers that load nothing, as distances beside no cut cell, change nothing.
        some = np.flatnonzero(np.diff(load.tocsc().indptr))
        by_force, load = np.zeros((len(forces), load.shape[1])), load[:, some]
        held = load[free].tocsc()
        du = factors.solve_sparse(held) if isinstance(factors, CholeskyFactors) else factors.solve(held.toarray())
        np.negative(du, out=du)
        for row, f in zip(by_force, forces, strict=True):
            row[some] = (load.T @ f.direction + (K @ f.direction)[free] @ du) / f.sigma
        return cls(du, by_force, observe[:, free], some, free)

    def over(self, sigma: float) -> Float[np.ndarray, "residual number"]:
        """Derivative of the residuals, of displacements over ``sigma``."""
        observed = self.observe.shape[0]
        J = np.zeros((observed + len(self.forces), self.forces.shape[1]))
        observe = self.observe / sigma
        for first in range(0, len(self.some), AT_ONCE):
            J[:observed, self.some[first : first + AT_ONCE]] = observe @ self.displacements[:, first : first + AT_ONCE]
        J[observed:] = self.forces
        return J

    def near(self, u: Float[np.ndarray, "node 2"], change: Float[np.ndarray, " number"]) -> Float[np.ndarray, "node 2"]:
        """Displacement near equilibrium once numbers have changed."""
        moved = u.copy()
        moved.ravel()[self.free] += self.displacements @ change[self.some]
        return moved


def adjoint(factors, K, load, free, observe, forces, residuals) -> Float[np.ndarray, "number column"]:
    """J^T of columns of residuals, by one solve a column and none a number.

    Args:
        factors, K, load, free, forces: of :meth:`Answer.of`.
        observe: observed displacements over their uncertainty from all of them, sparse.
        residuals: (residual, column).
    """
    of_u, of_f = np.split(residuals, [observe.shape[0]])
    directions = np.array([f.direction / f.sigma for f in forces]).reshape(len(forces), -1).T
    pulled = (observe.T @ of_u)[free] + (K @ directions)[free] @ of_f
    return load.T @ (directions @ of_f) - load[free].T @ factors.solve(pulled)
