"""What terms that may join a law explain, to first order where the law without them stands.

The energy is linear in every coefficient, or nearly so where one says how a term stiffens. One of zero changes neither
equilibrium nor its tangent. Only the derivative by it is new. One law that begins all terms gives the
derivatives of all of them. What each would explain follows without a descent (Rao, Large sample tests of statistical
hypotheses concerning several parameters with applications to problems of estimation, 1948).
"""

import dataclasses
from collections.abc import Sequence

import numpy as np
import scipy.linalg
import scipy.optimize
import scipy.sparse
from jaxtyping import Float

from hypernode.identification import numerics
from hypernode.identification.candidate import Candidate
from hypernode.identification.interface_numbers import numbers_of
from hypernode.identification.interfaces import Interfaces
from hypernode.identification.seen_test import SeenTest
from hypernode.identification.sheet import Sheet
from hypernode.identification.term_points import UNITS, TermPoints, coefficient_of, fibre_vector, parameter_of
from hypernode.mechanics.convex_basis import FIBRE_VECTOR, PARAMETERS, ConvexBasis

#: Terms that say more of another one.
BELONGS = {"across": "fibre", "stiffening": "fibre", "I1_stiffening": "I1_squared"}
#: Parameters log(1 + .) of coefficients that are relative to the level, not to another term.
LOGARITHMIC = [name for term in ("I1_squared", "I2", "ogden") for name in PARAMETERS[term]]


@dataclasses.dataclass(frozen=True, kw_only=True)
class Joined:
    """The coefficients of one term beside the numbers of a field, to first order where they are zero.

    No coefficient is negative. Those of fibres are the strengths of two families, on either side of a direction.

    Attributes:
        law: with all terms.
        materials: of that law, other terms than this one none (material, parameter).
        kept, new: which of its parameters are those of the law without the term, and which are the term's.
        into: the term's parameters by its coefficients.
        y: numbers of the field, those of its materials first.
        free: which of them may change.
        own: Cholesky factor of their curvature.
        between: curvature between them and the coefficients of all materials.
        reduced, slope: curvature and gradient by the coefficients, where the numbers follow.
    """

    law: ConvexBasis
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
        """(coefficients of least cost, by how much the cost falls).

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

        The stress is linear in products of the level and what is relative to it. These follow the linear model, and not
        their logarithms: a valley along which a term takes the place of another is straight in them.

        Args:
            change: of the numbers, beside what the coefficients make of them.
        """
        moved = self.y.copy()
        moved[self.free] += change - scipy.linalg.cho_solve(self.own, self.between @ x)
        shape = len(self.materials), len(self.kept)
        step = (moved - self.y)[: np.prod(shape)].reshape(shape)
        grown, names = np.maximum(1.0 + step[:, 0], numerics.LEAST_LEVEL), self.law.names
        materials = self.materials.copy()
        for column, more in zip(self.kept, step.T, strict=True):
            p = materials[:, column]
            if names[column] in LOGARITHMIC:
                c, slope = coefficient_of(p)
                materials[:, column] = parameter_of((c + slope * more + c * step[:, 0]) / grown)
            elif names[column] in FIBRE_VECTOR:
                materials[:, column] = (p + more + p * step[:, 0]) / grown
            else:
                materials[:, column] = p + more
        materials[:, self.kept[0]] = self.materials[:, self.kept[0]] + np.log(grown)
        told = self.into @ x.reshape(len(materials), -1).T
        if names[self.new[0]] in FIBRE_VECTOR:
            materials[:, self.new[:2]] = fibre_vector((told[:2] / grown).T)
            return moved, materials
        for column, coefficient in zip(self.new, told, strict=True):
            relative = coefficient / grown if names[column] in LOGARITHMIC else coefficient
            materials[:, column] = parameter_of(relative)
        return moved, materials


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

    def __init__(self, *, test: SeenTest, field: Interfaces, states, sigma: float, terms: Sequence[str]):
        problem = test.problem
        self.points, self._field = TermPoints(problem.basis, terms), field
        shared, residuals = test.shared(states, sigma), test.residuals(states, sigma)
        numbers = numbers_of(problem, field, field.still, None)
        self._known, self._y = len(numbers.y), numbers.y
        sheet, (of, _) = Sheet(problem.mesh, self.points, problem.observations.relative_thickness), field.cells()
        loads = [
            scipy.sparse.hstack([own, field.loads_of_materials(sheet.cell_response(u, of), of)], format="csr")
            for own, (u, _, _) in zip(test.loads(field, states, field.still), states, strict=True)
        ]
        jacobians = test.jacobians(states, loads, sigma)
        self._curvature, self._gradient = shared.normal(jacobians, residuals)
        # Coefficients at their bound stay there.
        self._free = np.flatnonzero(numbers.within)
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
            law=law,
            materials=self.points.among(materials.T).T,
            kept=[law.names.index(name) for name in self.points.kept.names],
            new=[law.names.index(name) for name in PARAMETERS[term]],
            into=into,
            y=self._y,
            free=self._free,
            own=own,
            between=between,
            reduced=self._curvature[np.ix_(theirs, theirs)] - between.T @ follow,
            slope=self._gradient[theirs] - follow.T @ self._pull,
        )


def score_test(kept: Candidate, terms: tuple[str, ...]) -> ScoreTest:
    """Terms that may join the law of a candidate, with what it leaves of displacements as their noise."""
    test = SeenTest(kept.problem, kept.fit.steps, kept.fit.window, kept.fit.edges)
    states = test.with_tangents(kept.fit.field, kept.fit.states)
    return ScoreTest(test=test, field=kept.fit.field, states=states, sigma=kept.sigma_left, terms=terms)


def price(kept: Candidate, parameters: int, numbers: int) -> float:
    """What the score asks for parameters of a term, and for numbers that the data determine."""
    return 0.5 * parameters * float(np.log(max(kept.fit.left.independent, 2.0))) + numbers
