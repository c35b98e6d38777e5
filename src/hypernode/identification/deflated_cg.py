"""Conjugate gradients for a sequence of systems, each of which makes the next one easier.

From one Gauss-Newton step to the next the systems change little, and what makes them slow stays: a few directions, long
waves of the stiffness and valleys between the terms, whose curvature the preconditioner misses by orders of magnitude.
Every solve meets them among its search directions. The worst are kept, and the next solve treats them exactly
(deflation: Nicolaides 1987; Saad, Yeung, Erhel and Guyomarc'h 2000).
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import scipy.linalg
import scipy.sparse
import scipy.sparse.linalg
from jaxtyping import Float

from hypernode.fem.factors import factorise

#: Directions whose curvature is below this share of the largest, after scaling, say the same as others.
REDUNDANT = 1e-8


def worst_directions(directions, products, metric, kept: int) -> Float[np.ndarray, "n kept"]:
    """Of the span of some directions what a preconditioner misses most (Rayleigh and Ritz).

    Args:
        directions: (n, direction).
        products: the system's matrix times each of them.
        metric: the matrix that the preconditioner inverts.
        kept: how many directions at most.
    """
    scale = 1.0 / np.sqrt(np.einsum("ij,ij->j", directions, products))
    directions, curvature = directions * scale, directions.T @ products * np.outer(scale, scale)
    weight, vectors = scipy.linalg.eigh((curvature + curvature.T) / 2)
    told = weight > REDUNDANT * weight[-1]
    whiten = vectors[:, told] / np.sqrt(weight[told])
    # Eigenvalues of the preconditioned system, one over these, would all be one if the preconditioner were perfect.
    inverse, vectors = scipy.linalg.eigh(whiten.T @ (directions.T @ (metric @ directions)) @ whiten)
    if len(inverse) > kept:
        # The few at the two ends without which the ratio of the largest to the smallest is least.
        left = len(inverse) - kept
        low = np.argmin(inverse[left - 1 :] / inverse[: kept + 1])
        vectors = np.delete(vectors, np.s_[low : low + left], axis=1)
    return directions @ (whiten @ vectors)


class Solution(NamedTuple):
    """Where conjugate gradients ended.

    Attributes:
        x: the solution (n,).
        residual: norm of b - A x over that of b.
        iterations: how many products with A it took.
        deflation: directions that make the next system easier (n, direction), or None.
    """

    x: np.ndarray
    residual: float
    iterations: int
    deflation: np.ndarray | None


class DeflatedCG:
    """One symmetric positive definite system of n unknowns.

    Args:
        product: x -> A x, of one vector (n,) or of several (n, k).
        metric: sparse matrix near A, whose factors precondition.
        kept: how many directions a solve leaves for the next system.
        deflation: those that a solve of a similar system left, if there was one (n, direction).
    """

    def __init__(
        self,
        product: Callable,
        metric: scipy.sparse.spmatrix,
        kept: int,
        deflation: Float[np.ndarray, "n k"] | None = None,
    ):
        self._product, self._metric, self._kept, self._deflation = product, metric, kept, deflation
        self._factors = factorise(metric)
        if deflation is not None:
            self._image = product(deflation)
            coarse = deflation.T @ self._image
            self._coarse = scipy.linalg.inv((coarse + coarse.T) / 2)

    def _precondition(self, r):
        """Exact in the deflated directions, the factors of the metric in what is left of the others."""
        if self._deflation is None:
            return self._factors.solve(r)
        share = self._coarse @ (self._deflation.T @ r)
        rest = self._factors.solve(r - self._image @ share)
        return rest + self._deflation @ (share - self._coarse @ (self._image.T @ rest))

    def solve(self, b: Float[np.ndarray, " n"], rtol: float, iterations: int, learn: bool = True) -> Solution:
        """A x = b to the relative residual ``rtol``, or as near as ``iterations`` come.

        Args:
            learn: whether a further system follows, for which the worst directions are kept.
        """
        searched = []

        def product(x):
            searched.append((x.copy(), self._product(x)))
            return searched[-1][1]

        shape = (len(b), len(b))
        A = scipy.sparse.linalg.LinearOperator(shape, product, dtype=float)
        M = scipy.sparse.linalg.LinearOperator(shape, self._precondition, dtype=float)
        x = scipy.sparse.linalg.cg(A, b, rtol=rtol, maxiter=iterations, M=M)[0]
        residual = np.linalg.norm(b - self._product(x)) / max(np.linalg.norm(b), np.finfo(float).tiny)
        return Solution(x, float(residual), len(searched), self._worst(searched) if learn else None)

    def solve_columns(self, b: Float[np.ndarray, "n k"], rtol: float, iterations: int) -> Float[np.ndarray, "n k"]:
        """A x = b of several columns at a time, for which products cost half; none learns of another."""
        x, r = np.zeros_like(b), b.copy()
        z = self._precondition(r)
        p, rho = z.copy(), np.einsum("nk,nk->k", r, z)
        enough = rtol * np.linalg.norm(b, axis=0)
        for _ in range(iterations):
            active = np.flatnonzero(np.linalg.norm(r, axis=0) > enough)
            if not len(active):
                break
            image = self._product(p[:, active])
            step = rho[active] / np.einsum("nk,nk->k", p[:, active], image)
            x[:, active] += step * p[:, active]
            r[:, active] -= step * image
            z = self._precondition(r[:, active])
            after = np.einsum("nk,nk->k", r[:, active], z)
            p[:, active] = z + after / rho[active] * p[:, active]
            rho[active] = after
        return x

    def _worst(self, searched) -> Float[np.ndarray, "n kept"] | None:
        """What was worst among the deflated directions and those of a solve; the former if it had none."""
        if not searched:
            return self._deflation
        parts = [np.stack(each, axis=1) for each in zip(*searched, strict=True)]
        if self._deflation is not None:
            before = self._deflation, self._image
            parts = [np.concatenate(each, axis=1) for each in zip(before, parts, strict=True)]
        return worst_directions(*parts, self._metric, self._kept)
