"""Laws that a test cannot tell from the one that was kept, and what they leave open of other deformations.

A term that does not pay is not known to be none. Each one that is left joins the law of the materials, which take a few
steps with it. Where they then explain the test as well, samples of that law stand beside those of the kept one.
"""

import dataclasses

import numpy as np
from jaxtyping import Float

from hypernode.config.methods import Constrained
from hypernode.identification.interface_estimate import InterfaceEstimate
from hypernode.identification.interface_numbers import numbers_of
from hypernode.identification.interfaces import Interfaces
from hypernode.identification.law_search import BELONGS, OF_THICKNESS, translated, turned
from hypernode.identification.problem import FieldProblem, with_law
from hypernode.identification.projected_newton import bounded_step
from hypernode.identification.seen_test import SeenTest
from hypernode.identification.trials import largest_and_half
from hypernode.mechanics.convex_basis import PARAMETERS, ConvexBasis

#: Steps of materials with one term more: they begin near the kept ones.
STEPS = 5
#: Standard deviation of a parameter of that term without data: it is about as strong as the neo-Hookean term at most.
USUAL = 1.0
#: Logarithm of the likelihood that such a law may lack and still be no worse: two standard deviations of one number.
AS_WELL = 2.0
#: How often a sample may be brought nearer to its fit by half.
HALVED = 5
#: Where terms begin otherwise than a law does. Fibres begin weak and as strong as half of the matrix: along a valley
#: that bends, samples of one end say little of the other. An area begins near one that keeps the volume: c3 = 0.1 and
#: c4 = 0.9.
BEGUN = {
    "fibre": ({"fibre_x": 0.1}, {"fibre_x": 0.5}),
    "J": ({"log1p_J_area": float(np.log1p(0.1)), "log1p_J_volume": float(np.log1p(0.9))},),
}


@dataclasses.dataclass(frozen=True)
class OpenLaw:
    """A law with one term more that explains a test as well.

    Attributes:
        term: what it has more.
        basis: the law.
        samples: of its parameters (parameter, posterior_sample, part, cell).
        gain: by how much the logarithm of its likelihood is above that of the kept law.
    """

    term: str
    basis: ConvexBasis
    samples: Float[np.ndarray, "parameter posterior_sample part cell"]
    gain: float


@dataclasses.dataclass(frozen=True)
class _Fitted:
    """Materials of one law near those that were kept.

    Attributes:
        test, sigma: what they were fitted to, and the uncertainty of displacements.
        field, guesses: where they are, and displacement of every step there.
        cost: half of the squared residuals.
        half, of: a factor of the covariance of the numbers that may change, and which these are.
    """

    test: SeenTest
    sigma: float
    field: Interfaces
    guesses: list
    cost: float
    half: np.ndarray
    of: np.ndarray


def open_laws(found: InterfaceEstimate, settings: Constrained, count: int, seed: int) -> list[OpenLaw]:
    """Every law with one term more that explains the test as well as the kept one.

    Args:
        found: the kept field.
        settings: configuration of the stage, whose terms may join.
        count, seed: of the samples of each law.
    """
    steps, sigma = largest_and_half(found.problem), _sigma(found)
    guesses = [found.states[k].u for k in steps]
    own = _cost(SeenTest(found.problem, steps), found.field, guesses, sigma)
    random, laws = np.random.default_rng(seed), []
    for term in terms_left(found.basis.terms, settings):
        terms = [kept for kept in found.basis.terms if term != "J" or kept not in OF_THICKNESS]
        problem = with_law(found.problem, dataclasses.replace(found.basis, terms=(*terms, term)))
        tried = [
            _fitted(problem, found.field.with_law(each), steps, guesses, sigma)
            for begin in BEGUN.get(term, (None,))
            for each in turned(translated(found.field.materials, found.problem, problem, begin), problem, term)
        ]
        as_well = [each for each in tried if each is not None and each.cost <= own + AS_WELL]
        if as_well:
            samples = _samples(found, as_well, count, random)
            laws.append(OpenLaw(term, problem.basis, samples, own - min(each.cost for each in as_well)))
    return laws


def terms_left(kept: tuple[str, ...], settings: Constrained) -> list[str]:
    """Terms that may join a law: those of the configuration, and J where the test decides on the volume."""
    every = [*settings.isotropic_terms, *settings.terms, *settings.further_terms]
    every += ["J"] if settings.volume == "told" else []
    excluded = OF_THICKNESS if "J" in kept else ()
    return [
        term
        for term in dict.fromkeys(every)
        if term not in kept and term not in excluded and BELONGS.get(term, term) in (*kept, term)
    ]


def _sigma(found: InterfaceEstimate) -> float:
    """Uncertainty of displacements, with what the kept field leaves of them."""
    return found.problem.sigma * max(found.left.level * found.left.inflation**0.5, 1.0)


def _cost(test: SeenTest, field: Interfaces, guesses, sigma: float) -> float:
    """Half of the squared residuals; infinite without equilibrium."""
    if (states := test.states(field, guesses)) is None:
        return np.inf
    return 0.5 * test.shared(states, sigma).squared(test.residuals(states, sigma))


def _fitted(problem: FieldProblem, field: Interfaces, steps, guesses, sigma: float) -> _Fitted | None:
    """A few steps of the materials of a law, lines as they are; None without equilibrium."""
    test, best = SeenTest(problem, steps), None
    for _ in range(STEPS + 1):
        if (states := test.states(field, guesses)) is None:
            return best
        shared, residuals = test.shared(states, sigma), test.residuals(states, sigma)
        cost = 0.5 * shared.squared(residuals)
        if best is not None and cost >= best.cost:
            return best
        guesses = [u for u, _, _ in states]
        numbers = numbers_of(problem, field, field.still, None)
        answers = test.answers(states, test.loads(field, states, field.still), sigma)
        curvature, gradient = shared.normal([answer.J for answer in answers], residuals)
        usual = np.zeros(len(numbers.y))
        usual[: field.materials.size] = np.tile(_precision(problem.basis), field.count)
        curvature = curvature + numbers.held.toarray() + np.diag(usual)
        gradient = gradient + numbers.slope(numbers.y)
        changed, _, going = bounded_step(numbers.y, gradient, curvature, numbers.lowest, 0.0, problem.strategy)
        of = np.flatnonzero(going)
        values, vectors = np.linalg.eigh(curvature[np.ix_(of, of)])
        half = vectors / np.sqrt(np.maximum(values, np.finfo(float).eps * values.max()))
        best = _Fitted(test, sigma, field, guesses, cost, half, of)
        field = field.at(changed, field.still)
    return best


def _precision(basis: ConvexBasis) -> np.ndarray:
    """Inverse variance of the parameters of the last term without data."""
    return np.where(np.isin(basis.names, list(PARAMETERS[basis.terms[-1]])), USUAL**-2.0, 0.0)


def _samples(found: InterfaceEstimate, fitted: list[_Fitted], count: int, random) -> np.ndarray:
    """Samples of the fits in turn, as fields of the measured cells."""
    of_cells = []
    for number in range(count):
        field = _sample(fitted[number % len(fitted)], random)
        cells = field.materials[found.labels].T
        cells[0] += found.field.grid_factor()
        of_cells.append(cells)
    return np.stack(of_cells, axis=1)[:, :, None]


def _sample(fit: _Fitted, random) -> Interfaces:
    """One that the test cannot tell from the fit.

    The curvature says little of fibres that are nearly none. A sample that explains the test worse than chance allows
    is brought nearer to the fit.
    """
    y, still = fit.field.numbers(fit.field.still), fit.field.still
    change = fit.half @ random.normal(size=len(fit.of))
    allowed = fit.cost + 0.5 * len(fit.of) + AS_WELL
    for _ in range(HALVED):
        moved = y.copy()
        moved[fit.of] += change
        field = fit.field.at(moved, still)
        if _cost(fit.test, field, fit.guesses, fit.sigma) <= allowed:
            return field
        change = 0.5 * change
    return fit.field
