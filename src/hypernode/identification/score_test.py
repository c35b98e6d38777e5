"""What terms that may join a law explain, to first order where the law without them stands.

The energy is linear in every coefficient, so that one of zero changes neither equilibrium nor its tangent. Only the
derivative by that coefficient is new. One law that begins all terms gives the derivatives of all of them. What each
would explain follows without a descent (Rao, Large sample tests of statistical hypotheses concerning several parameters
with applications to problems of estimation, 1948).
"""

import dataclasses
import functools
from collections.abc import Sequence

import numpy as np
import scipy.linalg
import scipy.optimize
import scipy.sparse
from jaxtyping import Float

from hypernode.identification.candidate import Candidate
from hypernode.identification.interface_numbers import numbers_of
from hypernode.identification.interfaces import Interfaces
from hypernode.identification.points import Points, PointStress
from hypernode.identification.seen_test import SeenTest
from hypernode.identification.sheet import Sheet
from hypernode.mechanics.convex_basis import PARAMETERS, ConvexBasis

#: Terms that say more of another one.
BELONGS = {"across": "fibre", "stiffening": "fibre", "I1_stiffening": "I1_squared"}
#: Doubled-angle vectors of fibres. Those between two of them are about as a family along each.
UNITS = np.array([[np.cos(angle), np.sin(angle)] for angle in np.arange(4) * np.pi / 2.0])


@dataclasses.dataclass(frozen=True)
class Joined:
    """The coefficients of one term beside the numbers of a field, to first order where they are zero.

    No coefficient is negative. Those of fibres are the strengths of two families, on either side of a direction.

    Attributes:
        materials: of the law with all terms, others than this one none (material, parameter).
        kept, new: which of its parameters are those of the law without the term, and which are the term's.
        into: the term's parameters by its coefficients.
        y: numbers of the field, those of its materials first.
        free: which of them may change.
        own: Cholesky factor of their curvature.
        between: curvature between them and the coefficients of all materials.
        reduced, slope: curvature and gradient by the coefficients, where the numbers follow.
    """

    materials: Float[np.ndarray, "material parameter"]
    kept: list[int]
    new: list[int]
    into: Float[np.ndarray, "new coefficient"]
    y: Float[np.ndarray, " number"]
    free: np.ndarray
    own: tuple
    between: Float[np.ndarray, "free coefficients"]
    reduced: Float[np.ndarray, "coefficients coefficients"]
    slope: Float[np.ndarray, " coefficients"]

    def least(self, precision: float, pull: Float[np.ndarray, " coefficients"] | None = None):
        """(coefficients of least cost, by how much the cost falls, a factor of their curvature).

        Args:
            precision: inverse variance of a coefficient without data.
            pull: independent standard normal numbers, by which the gradient is disturbed.
        """
        curvature = self.reduced + precision * np.eye(len(self.slope))
        half = np.linalg.cholesky(curvature)
        right = -scipy.linalg.solve_triangular(half, self.slope, lower=True)
        right = right if pull is None else right + pull
        x = scipy.optimize.lsq_linear(half.T, right, (0.0, np.inf), method="bvls").x
        return x, -float(self.slope @ x + 0.5 * x @ curvature @ x)

    def by_chance(self, normal: Float[np.ndarray, " free"]) -> Float[np.ndarray, " free"]:
        """A change of the numbers that the test allows, of independent standard normal numbers."""
        return scipy.linalg.solve_triangular(np.tril(self.own[0]), normal, lower=True, trans=1)

    def at(self, x: Float[np.ndarray, " coefficients"], change: Float[np.ndarray, " free"] | float = 0.0):
        """(numbers of the field, materials of the law with the term) at some coefficients.

        Args:
            change: of the numbers, beside what the coefficients make of them.
        """
        y, materials = self.y.copy(), self.materials.copy()
        y[self.free] += change - scipy.linalg.cho_solve(self.own, self.between @ x)
        materials[:, self.kept] = y[: len(materials) * len(self.kept)].reshape(len(materials), -1)
        told = np.any(self.into, axis=1)
        materials[:, np.array(self.new)[told]] = x.reshape(len(materials), -1) @ self.into[told].T
        return y, materials


class TermPoints:
    """A law at points, with derivatives by the coefficients of terms that may join in place of those by its parameters.

    The stress is linear in them, so that differences of stresses are their derivatives.

    Args:
        kept: the law without the terms.
        terms: that may join.

    Attributes:
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


class ScoreTest:
    """Terms that may join the law of a field.

    Args:
        test: of the law without them.
        field, states: materials and lines in equilibrium.
        sigma: uncertainty of displacements.
        terms: that may join.

    Attributes:
        points: law with all terms.
    """

    def __init__(self, test: SeenTest, field: Interfaces, states, sigma: float, terms: Sequence[str]):
        self.points, self.sigma, self._field, problem = (
            TermPoints(test.problem.basis, terms),
            sigma,
            field,
            test.problem,
        )
        shared, residuals = test.shared(states, sigma), test.residuals(states, sigma)
        numbers = numbers_of(problem, field, field.still, None)
        self._known, self._y = len(numbers.y), numbers.y
        sheet, (of, _) = Sheet(problem.mesh, self.points, problem.observations.relative_thickness), field.cells()
        loads = [
            scipy.sparse.hstack([own, field.loads_of_materials(sheet.by_materials(u, of), of)], format="csr")
            for own, (u, _, _) in zip(test.loads(field, states, field.still), states, strict=True)
        ]
        answers = [each.J for each in test.answers(states, loads, sigma)]
        self._curvature, self._gradient = shared.normal(answers, residuals)
        # Coefficients at their bound stay there.
        self._free = np.flatnonzero(numbers.y > numbers.lowest)
        held = numbers.held.toarray()[np.ix_(self._free, self._free)]
        self._own = scipy.linalg.cho_factor(self._curvature[np.ix_(self._free, self._free)] + held, lower=True)
        self._pull = (self._gradient[: self._known] + numbers.slope(numbers.y))[self._free]

    def joined(self, term: str) -> list[Joined]:
        """The term beside the field; fibres from every direction."""
        columns = self.points.columns[term]
        if term != "fibre":
            return [self._joined(term, columns, np.eye(len(columns)))]
        sectors = [(k, (k + 1) % len(columns)) for k in range(len(columns))]
        into = [np.vstack([UNITS[[*each]].T, np.zeros(2)]) for each in sectors]
        return [self._joined(term, [columns[k] for k in each], to) for each, to in zip(sectors, into, strict=True)]

    def _joined(self, term: str, columns: list[int], into) -> Joined:
        law, materials, own = self.points.law, self._field.materials, self._own
        every = sum(map(len, self.points.columns.values()))
        theirs = self._known + np.concatenate([k * every + np.array(columns) for k in range(len(materials))])
        between = self._curvature[np.ix_(self._free, theirs)]
        follow = scipy.linalg.cho_solve(own, between)
        return Joined(
            self.points.among(materials.T).T,
            [law.names.index(name) for name in self.points.kept.names],
            [law.names.index(name) for name in PARAMETERS[term]],
            into,
            self._y,
            self._free,
            own,
            between,
            self._curvature[np.ix_(theirs, theirs)] - between.T @ follow,
            self._gradient[theirs] - follow.T @ self._pull,
        )


@functools.lru_cache(maxsize=1)
def score_test(kept: Candidate, terms: tuple[str, ...]) -> ScoreTest:
    """Terms that may join the law of a candidate, with what it leaves of displacements as their noise."""
    test = SeenTest(kept.problem, kept.fit.steps, kept.fit.window, kept.fit.edges)
    return ScoreTest(test, kept.fit.field, kept.fit.states, kept.sigma_left, terms)
