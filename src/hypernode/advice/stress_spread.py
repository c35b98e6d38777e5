"""How far the stress of a field is left open by tests whose information is known."""

from collections.abc import Callable, Sequence
from functools import partial

import jax
import numpy as np
import scipy.linalg
from jaxtyping import Float

from hypernode.identification.objective import Objective
from hypernode.mechanics.convex_basis import ConvexBasis
from hypernode.mechanics.modes import mode_gradients

#: Relative residual at which a system counts as solved, and most iterations. A variance is then too small by half a per
#: cent, where that was measured.
TOLERANCE, ITERATIONS = 0.03, 200
#: Share of the largest eigenvalue below which a direction is one that solves to that tolerance do not resolve.
REDUNDANT = 1e-3


class StressSpread:
    """Root mean square of the posterior deviation of the stress, over cells and homogeneous deformations, relative.

    Near the best field, the stress P of the cells under the probe modes is linear in the parameters, with the
    derivative S. Its variance is the trace of A = S H^-1 S^T, with the inverse covariance H of the posterior. A is
    known as products with random signs, each a solve with H. Where few directions make up most of A, as the level of
    the stress does, their share is exact and only the rest is left to chance. This is XTrace (Epperly, Tropp and
    Webber, SIAM Journal on Matrix Analysis and Applications 45, 2024). The same signs for all tests leave of chance
    little in a comparison.

    Args:
        objective: what was minimised, which knows jumps and ridge.
        params: the field (subcell, parameter).
        stretches: at which the probe modes are taken (stretch,).
        count: how many vectors of signs.
        seed: of them.
    """

    def __init__(
        self,
        *,
        objective: Objective,
        params: Float[np.ndarray, "subcell parameter"],
        stretches: Sequence[float],
        count: int,
        seed: int,
    ):
        self._objective, self._params = objective, params
        mesh, children = objective.problem.observations.grid, objective.problem.refinement.subcells
        P, S = _linear_stress(objective.problem.basis, params, stretches)
        weight = np.sqrt(mesh.areas / np.sum(mesh.areas))
        #: Root mean square size of the stress.
        self.size = float(np.linalg.norm(weight[:, None] * P[children].mean(axis=1)))
        # The stress of a cell is the mean of its subcells'.
        self._children = children
        self._derivative = S[children] * (weight / (children.shape[1] * self.size))[:, None, None, None]
        shape = (len(mesh.areas), P.shape[1], count)
        self._signs = np.random.default_rng(seed).choice([-1.0, 1.0], shape)
        loads = np.zeros((*params.shape, count))
        loads[children] = np.einsum("crz,csrp->cspz", self._signs, self._derivative)
        self._loads = loads.reshape(-1, count)
        self._deflation = None

    def variances(self, curvatures: Sequence[Callable]) -> Float[np.ndarray, " z"]:
        """The relative variance of the stress where the tests tell as much as their curvatures say.

        Its estimates, each of which leaves another vector of signs to chance; the mean is the best one.

        Args:
            curvatures: x -> J^T J x of every test, over its noise, of one vector or of the columns of a matrix.
        """
        curvature = partial(_summed, curvatures)
        if self._deflation is None:
            # What makes one of these systems slow does so in all of them.
            first = self._objective.precision(curvature, self._params)
            self._deflation = first.solve(self._loads[:, 0], TOLERANCE, ITERATIONS).deflation
        system = self._objective.precision(curvature, self._params, self._deflation)
        solved = system.solve_columns(self._loads, TOLERANCE, ITERATIONS).reshape(*self._params.shape, -1)
        image = np.einsum("csrp,cspz->crz", self._derivative, solved[self._children])
        return traces(*(each.reshape(-1, each.shape[-1]) for each in (self._signs, image)))


def traces(signs: Float[np.ndarray, "n z"], image: Float[np.ndarray, "n z"]) -> Float[np.ndarray, " z"]:
    """Estimates of the trace of a positive matrix A from its ``image`` A Omega of random signs Omega.

    Each takes the exact trace of what all vectors but one span in A, and of the rest what that one finds.
    """
    inner, size = signs.T @ image, image.T @ image
    inner = (inner + inner.T) / 2
    found = []
    for left in range(len(inner)):
        others = np.delete(np.arange(len(inner)), left)
        weight, vectors = scipy.linalg.eigh(inner[np.ix_(others, others)])
        told = weight > REDUNDANT * weight[-1]
        root = vectors[:, told] / np.sqrt(weight[told])
        spanned = np.trace(root.T @ size[np.ix_(others, others)] @ root)
        found.append(spanned + inner[left, left] - np.sum((root.T @ inner[others, left]) ** 2))
    return np.array(found)


def _summed(curvatures, change):
    return sum(curvature(change) for curvature in curvatures)


def _linear_stress(basis: ConvexBasis, params, stretches):
    """(P (subcell, component), its derivative (subcell, component, parameter)) of all modes and stretches together.

    Each is over the root of the number of modes and stretches, so that squares sum to means.
    """
    F = mode_gradients(stretches).reshape(-1, 2, 2)
    scale = 1.0 / np.sqrt(len(F))

    def stress(params):
        return scale * basis.stress(np.moveaxis(F, 0, -1), params[:, None]).ravel()

    P, S = (jax.jit(jax.vmap(function))(params) for function in (stress, jax.jacfwd(stress)))
    return np.asarray(P), np.asarray(S)
