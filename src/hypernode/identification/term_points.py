"""Stress of a law at points, with derivatives by the coefficients of terms that it has not."""

import dataclasses
from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from hypernode.identification.points import Points, PointStress
from hypernode.mechanics.convex_basis import PARAMETERS, ConvexBasis

#: Doubled-angle vectors of fibres. Those between two of them are about as a family along each.
UNITS = np.array([[np.cos(angle), np.sin(angle)] for angle in np.arange(4) * np.pi / 2.0])


class TermPoints:
    """A law at points, with derivatives by the coefficients of terms that may join in place of those by its parameters.

    The stress is linear in them, so that differences of stresses are their derivatives.

    Args:
        kept: the law without the terms.
        terms: that may join.

    Attributes:
        kept: the law without them.
        law: with all of them.
        none: its parameters where terms are none (parameter,).
        columns: of each term, the derivatives by its coefficients; of fibres in several directions.
    """

    def __init__(self, kept: ConvexBasis, terms: Sequence[str]):
        every = tuple(term for term in PARAMETERS if term in (*kept.terms, *terms))
        self.law = dataclasses.replace(kept, terms=every)
        names = self.law.names
        self.none = np.where(np.isfinite(self.law.lowest), self.law.lowest, 0.0)
        self.kept = kept
        self._kept = [names.index(name) for name in kept.names]
        self._points, self._every = Points(kept), Points(self.law)
        self._begun: list[tuple[list[int], np.ndarray]] = []
        self.columns: dict[str, list[int]] = {}
        for term in terms:
            of_term = [names.index(name) for name in PARAMETERS[term]]
            self.none[of_term] = np.where(np.isfinite(self.law.lowest), self.none, self.law.start)[of_term]
            if term == "fibre":
                self.none[of_term[:2]] = 0.0
                begun = [(of_term[:2], unit) for unit in UNITS]
            else:
                begun = [([k], self.law.start[[k]]) for k in of_term]
            self.columns[term] = list(range(len(self._begun), len(self._begun) + len(begun)))
            self._begun += begun

    def among(self, params: Float[np.ndarray, "parameter ..."]) -> Float[np.ndarray, "parameter ..."]:
        """Parameters of the law of all terms where these are none."""
        found = np.empty((len(self.none), *params.shape[1:]))
        found[...] = self.none.reshape(-1, *(1,) * (params.ndim - 1))
        found[self._kept] = params
        return found

    def stress(self, F, params):
        """As of :meth:`Points.stress`."""
        return self._points.stress(F, params)

    def by_parameters(self, F, params) -> Float[np.ndarray, "2 2 coefficient point"]:
        """Derivative of the stress by all coefficients."""
        without = self.among(params)
        P, found = self._every.stress_alone(F, without), []
        for columns, values in self._begun:
            begun = without.copy()
            begun[columns] = values[:, None]
            found.append((self._every.stress_alone(F, begun) - P) / np.linalg.norm(values))
        return np.stack(found, axis=2)

    def all(self, F, params) -> PointStress:
        """As of :meth:`Points.all`, by coefficients."""
        return PointStress(*self.stress(F, params), self.by_parameters(F, params))
