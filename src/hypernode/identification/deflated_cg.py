"""Conjugate gradients for a sequence of systems, each of which makes the next one easier.

From one Gauss-Newton step to the next the systems change little, and what makes them slow stays: a few directions, long
waves of the stiffness and valleys between the terms, whose curvature the preconditioner misses by orders of magnitude.
Every solve meets them among its search directions. The worst are kept, and the next solve treats them exactly
(deflation: Nicolaides 1987; Saad, Yeung, Erhel and Guyomarc'h 2000).
"""

from collections.abc import Callable

import numpy as np
import scipy.linalg
import scipy.sparse
import scipy.sparse.linalg
from jaxtyping import Float

from hypernode.fem.factors import factorise

#: Directions that are kept.
KEPT = 40


#: Directions whose curvature is below this share of the largest, after scaling, say the same as others.
REDUNDANT = 1e-8


def worst_directions(directions, products, metric) -> Float[np.ndarray, "n kept"]:
    """Of the span of some directions what a preconditioner misses most (Rayleigh and Ritz).

    Args:
        directions: (n, direction).
        products: the system's matrix times each of them.
        metric: the matrix that the preconditioner inverts.
    """
    scale = 1.0 / np.sqrt(np.einsum("ij,ij->j", directions, products))
    directions, curvature = directions * scale, directions.T @ products * np.outer(scale, scale)
    weight, vectors = scipy.linalg.eigh((curvature + curvature.T) / 2)
    told = weight > REDUNDANT * weight[-1]
    whiten = vectors[:, told] / np.sqrt(weight[told])
    # Eigenvalues of the preconditioned system, one over these, would all be one if the preconditioner were perfect.
    inverse, vectors = scipy.linalg.eigh(whiten.T @ (directions.T @ (metric @ directions)) @ whiten)
    if len(inverse) > KEPT:
        # The few at the two ends without which the ratio of the largest to the smallest is least.
        left = len(inverse) - KEPT
        low = np.argmin(inverse[left - 1 :] / inverse[: KEPT + 1])
        vectors = np.delete(vectors, np.s_[low : low + left], axis=1)
    return directions @ (whiten @ vectors)


class DeflatedCG:
    """One symmetric positive definite system of n unknowns.

    Args:
        product: x -> A x, of one vector (n,) or of several (n, k).
        metric: sparse matrix near A, whose factors precondition.
        known: what a solver of a similar system :meth:`learned`, if there was one.
    """

    def __init__(self, product: Callable, metric: scipy.sparse.spmatrix, known: Float[np.ndarray, "n k"] | None = None):
        self._product, self._metric, self._known = product, metric, known
        self._factors = factorise(metric)
        self._seen = []
        if known is not None:
            self._image = product(known)
            coarse = known.T @ self._image
            self._coarse = scipy.linalg.inv((coarse + coarse.T) / 2)

    def _precondition(self, r):
        """Exact in the known directions, the factors of the metric in what is left of the others."""
        if self._known is None:
            return self._factors.solve(r)
        share = self._coarse @ (self._known.T @ r)
        rest = self._factors.solve(r - self._image @ share)
        return rest + self._known @ (share - self._coarse @ (self._image.T @ rest))

    def solve(self, b: Float[np.ndarray, " n"], rtol: float, iterations: int) -> Float[np.ndarray, " n"]:
        """A x = b to the relative residual ``rtol``, or as near as ``iterations`` come."""
        self._seen = []

        def product(x):
            self._seen.append((x.copy(), self._product(x)))
            return self._seen[-1][1]

        shape = (len(b), len(b))
        A = scipy.sparse.linalg.LinearOperator(shape, product, dtype=float)
        M = scipy.sparse.linalg.LinearOperator(shape, self._precondition, dtype=float)
        return scipy.sparse.linalg.cg(A, b, rtol=rtol, maxiter=iterations, M=M)[0]

    def learned(self) -> Float[np.ndarray, "n kept"] | None:
        """What was worst among the known directions and those of the last solve; the known ones if there were none."""
        if not self._seen:
            return self._known
        parts = [np.stack(each, axis=1) for each in zip(*self._seen, strict=True)]
        if self._known is not None:
            known = self._known, self._image
            parts = [np.concatenate(each, axis=1) for each in zip(known, parts, strict=True)]
        return worst_directions(*parts, self._metric)
