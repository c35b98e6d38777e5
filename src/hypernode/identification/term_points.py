"""Stress of a law at points, with derivatives by the coefficients of terms that it has not."""

import dataclasses
from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from hypernode.identification import numerics
from hypernode.identification.points import Points, PointStress
from hypernode.mechanics.convex_basis import FIBRE_VECTOR, PARAMETERS, ROUNDING, SMALLEST, ConvexBasis

#: Doubled-angle vectors of fibres. Those between two of them are about as a family along each.
UNITS = np.array([[np.cos(angle), np.sin(angle)] for angle in np.arange(4) * np.pi / 2.0])


class _OfKeptLevel(ConvexBasis):
    """A basis whose level stays that of the neo-Hookean term where powers of stretches join.

    Where they are none, such a law is the one without them.
    """

    def mixed(self, p):
        """As of :class:`ConvexBasis`."""
        return 1.0


def coefficient_of(parameter: Float[np.ndarray, "..."]):
    """(coefficient of a parameter log(1 + .), which the basis smooths near zero, its derivative)."""
    value = np.expm1(parameter)
    root = np.hypot(value, 2.0 * SMALLEST)
    coefficient = 0.5 * (value + root)
    return coefficient, coefficient / root * np.exp(parameter)


def parameter_of(coefficient: Float[np.ndarray, "..."]) -> Float[np.ndarray, "..."]:
    """Parameter of a coefficient, :data:`ABSENT` of none: the inverse of :func:`coefficient_of`."""
    c = np.maximum(coefficient, coefficient_of(numerics.ABSENT)[0])
    return np.log1p(c - SMALLEST**2 / c)


def fibre_vector(strength: Float[np.ndarray, "material 2"]) -> Float[np.ndarray, "material 2"]:
    """Vectors of fibres of a strength, which begins gradually, along doubled angles."""
    size = np.linalg.norm(strength, axis=1, keepdims=True)
    return strength * np.sqrt((size + ROUNDING) ** 2 - ROUNDING**2) / np.maximum(size, np.finfo(float).tiny)


def fibre_strength(vector: Float[np.ndarray, "material 2"]) -> Float[np.ndarray, "material 2"]:
    """The inverse of :func:`fibre_vector`."""
    length = np.linalg.norm(vector, axis=1, keepdims=True)
    return vector * (np.hypot(length, ROUNDING) - ROUNDING) / np.maximum(length, np.finfo(float).tiny)


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
        self.law = (_OfKeptLevel if "ogden" in terms else ConvexBasis)(every, kept.invariant_scale)
        names = self.law.names
        self.none = np.where(np.isfinite(self.law.lowest), numerics.ABSENT, 0.0)
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
        #: How large they have begun: a term's coefficient, or the strength of fibres.
        self._sizes = [
            float(np.linalg.norm(fibre_strength(values[None])) if len(values) > 1 else coefficient_of(values[0])[0])
            for _, values in self._begun
        ]

    def among(self, params: Float[np.ndarray, "parameter ..."]) -> Float[np.ndarray, "parameter ..."]:
        """Parameters of the law of all terms where these are none."""
        found = np.empty((len(self.none), *params.shape[1:]))
        found[...] = self.none.reshape(-1, *(1,) * (params.ndim - 1))
        found[self._kept] = params
        return found

    def with_term(self, term: str) -> ConvexBasis:
        """The kept law with one term more."""
        return dataclasses.replace(self.kept, terms=(*self.kept.terms, term))

    def of_term(self, term: str, materials: Float[np.ndarray, "material parameter"]):
        """Parameters of :meth:`with_term` of materials of the law of all, other terms none (material, parameter)."""
        law, names = self.with_term(term), self.law.names
        found = materials[:, [names.index(name) for name in law.names]]
        return np.maximum(_of_whole_level(law, found) if term == "ogden" else found, law.lowest)

    def stress(self, F, params):
        """As of :meth:`Points.stress`."""
        return self._points.stress(F, params)

    def by_parameters(self, F, params) -> Float[np.ndarray, "2 2 coefficient point"]:
        """Derivative of the stress by all coefficients."""
        without = self.among(params)
        P, found = self._every.stress_alone(F, without), []
        for (columns, values), size in zip(self._begun, self._sizes, strict=True):
            begun = without.copy()
            begun[columns] = values[:, None]
            found.append((self._every.stress_alone(F, begun) - P) / size)
        return np.stack(found, axis=2)

    def all(self, F, params) -> PointStress:
        """As of :meth:`Points.all`, by coefficients."""
        return PointStress(*self.stress(F, params), self.by_parameters(F, params))


def _of_whole_level(law: ConvexBasis, materials: Float[np.ndarray, "material parameter"]):
    """The same materials with the stiffness of all powers of stretches as their level."""
    given, found = dict(zip(law.names, materials.T, strict=True)), materials.copy()
    mixed = np.asarray(law.mixed(given))
    found[:, 0] += np.log(mixed)
    if "I1_squared" in law.terms:
        column = law.names.index("log1p_I1_squared")
        found[:, column] = parameter_of(coefficient_of(materials[:, column])[0] / mixed)
    if law.has_fibres:
        columns = [law.names.index(name) for name in FIBRE_VECTOR]
        found[:, columns] = fibre_vector(fibre_strength(materials[:, columns]) / mixed[:, None])
    return found
