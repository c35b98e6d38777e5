"""Conjugate gradients for a sequence of similar systems, with deflation.

From one Gauss-Newton step to the next the systems change little. A few directions make every solve slow: long waves of
the stiffness, and valleys between the terms. The preconditioner misses their curvature by orders of magnitude. Every
solve finds them among its search directions. The worst are kept, and the next solve treats them exactly (Nicolaides
1987; Saad, Yeung, Erhel and Guyomarc'h 2000).
"""

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np
import scipy.linalg
import scipy.sparse
import scipy.sparse.linalg
from jaxtyping import Float

from hypernode.fem.factors import factorise
from hypernode.identification import budgets, numerics

#: Some vectors, each in its own array or as the rows of one.
Vectors = Sequence[Float[np.ndarray, " n"]] | Float[np.ndarray, "vector n"]


def _pieces(vectors: Vectors) -> Iterator[slice]:
    """Rows of the matrix of some vectors of which copies may be made at a time."""
    n, rows = len(vectors[0]), max(budgets.COPIED // (8 * len(vectors)), 1)
    return (slice(first, first + rows) for first in range(0, n, rows))


def _columns(vectors: Vectors, rows: slice = slice(None)) -> Float[np.ndarray, "row vector"]:
    return np.stack([each[rows] for each in vectors], axis=1)


def _products(one, other, scale) -> Float[np.ndarray, "vector other"]:
    """Scalar products of every two of some vectors, the first of which are scaled."""
    return sum((_columns(one, rows) * scale).T @ _columns(other, rows) for rows in _pieces(one))


def _own_products(one, other) -> Float[np.ndarray, " vector"]:
    """Scalar products of some vectors with as many others, each with its own."""
    return sum(np.einsum("ij,ij->j", _columns(one, rows), _columns(other, rows)) for rows in _pieces(one))


def _metric_products(vectors, metric, scale) -> Float[np.ndarray, "vector vector"]:
    """Scalar products of every two of some scaled vectors in a metric."""
    n, found = len(vectors[0]), []
    some = max(budgets.COPIED // (8 * n), 1)
    for first in range(0, len(vectors), some):
        part = slice(first, first + some)
        images = metric @ (_columns(vectors[part]) * scale[part])
        found.append(_products(vectors, images.T, scale))
    return np.concatenate(found, axis=1)


def _combined(vectors, scale, combinations) -> Float[np.ndarray, "n combination"]:
    """Combinations of some scaled vectors."""
    return np.concatenate([_columns(vectors, rows) * scale @ combinations for rows in _pieces(vectors)])


def worst_combinations(directions, products, metric, kept: int):
    """Directions that a preconditioner treats worst in a given span (Rayleigh and Ritz).

    Args:
        directions: vectors (n,).
        products: the system's matrix times each of them.
        metric: the matrix that the preconditioner inverts.
        kept: how many directions at most.

    Returns:
        Factors of the directions (direction,), and combinations of the directions times these (direction, kept).
    """
    scale = 1.0 / np.sqrt(_own_products(directions, products))
    curvature = _products(directions, products, 1.0) * np.outer(scale, scale)
    weight, vectors = scipy.linalg.eigh((curvature + curvature.T) / 2)
    told = weight > numerics.REDUNDANT * weight[-1]
    whiten = vectors[:, told] / np.sqrt(weight[told])
    # Eigenvalues of the preconditioned system, one over these, would all be one if the preconditioner were perfect.
    inverse, vectors = scipy.linalg.eigh(whiten.T @ _metric_products(directions, metric, scale) @ whiten)
    if len(inverse) > kept:
        # The few at the two ends without which the ratio of the largest to the smallest is least.
        left = len(inverse) - kept
        low = np.argmin(inverse[left - 1 :] / inverse[: kept + 1])
        vectors = np.delete(vectors, np.s_[low : low + left], axis=1)
    return scale, whiten @ vectors


class SearchDirections:
    """Search directions of a solve, and the matrix times each of them.

    Args:
        metric: the matrix that the preconditioner inverts.
        kept: how many directions are wanted in the end.
        most: how many are remembered at a time; beyond, the worst ``kept`` take the place of all.
    """

    def __init__(self, metric, kept: int, most: int):
        self._metric, self._kept, self._most = metric, kept, most
        self._directions, self._products = [], []

    def add(self, direction: Float[np.ndarray, " n"], product: Float[np.ndarray, " n"]) -> None:
        """Remember one more."""
        if len(self._directions) >= self._most:
            both = self._directions, self._products
            told = worst_combinations(*both, self._metric, self._kept)
            self._directions, self._products = (list(_combined(each, *told).T.copy()) for each in both)
        self._directions.append(direction.copy())
        self._products.append(product)

    def worst(self, deflation, image) -> Float[np.ndarray, "n kept"] | None:
        """The worst among them and earlier ones with their products; the latter if there are none."""
        if not self._directions:
            return deflation
        directions, products = self._directions, self._products
        if deflation is not None:
            directions, products = [*deflation.T, *directions], [*image.T, *products]
        return _combined(directions, *worst_combinations(directions, products, self._metric, self._kept))


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
        self._image = None if deflation is None else product(deflation)
        if deflation is not None:
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
        most = max(3 * self._kept, budgets.REMEMBERED // (2 * b.nbytes))
        searched, count = SearchDirections(self._metric, self._kept, most), 0

        def product(x):
            nonlocal count
            count += 1
            image = self._product(x)
            if learn:
                searched.add(x, image)
            return image

        shape = (len(b), len(b))
        A = scipy.sparse.linalg.LinearOperator(shape, product, dtype=float)
        M = scipy.sparse.linalg.LinearOperator(shape, self._precondition, dtype=float)
        x = scipy.sparse.linalg.cg(A, b, rtol=rtol, maxiter=iterations, M=M)[0]
        residual = np.linalg.norm(b - self._product(x)) / max(np.linalg.norm(b), np.finfo(float).tiny)
        return Solution(x, float(residual), count, searched.worst(self._deflation, self._image) if learn else None)

    def solve_columns(self, b: Float[np.ndarray, "n k"], rtol: float, iterations: int) -> Float[np.ndarray, "n k"]:
        """A x = b of several columns, none of which learns of another."""
        return np.stack([self.solve(each, rtol, iterations, learn=False).x for each in b.T], axis=1)
