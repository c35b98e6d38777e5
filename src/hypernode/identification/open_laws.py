"""Laws that a test cannot tell from the one that was kept, and what they leave open of other deformations.

A term that does not pay is not known to be none. To first order the test says how large its coefficients may be, with
what the kept numbers make of them. Samples of that law stand beside those of the kept one. A law with another volume
contains no kept one: its materials take a few steps first.
"""

import dataclasses
from collections.abc import Callable

import numpy as np
from jaxtyping import Float

from hypernode.config.methods import Constrained
from hypernode.identification import budgets, priors, thresholds
from hypernode.identification.candidate import Candidate
from hypernode.identification.interface_estimate import InterfaceEstimate
from hypernode.identification.interface_fit import InterfaceFit
from hypernode.identification.interface_numbers import numbers_of
from hypernode.identification.interfaces import Interfaces
from hypernode.identification.law_search import OF_THICKNESS, open_terms, translated
from hypernode.identification.problem import FieldProblem, with_law
from hypernode.identification.score_test import ScoreTest, score_test
from hypernode.identification.seen_test import SeenTest
from hypernode.identification.trials import largest_and_half, largest_steps
from hypernode.mechanics.convex_basis import ConvexBasis

#: Where an area begins: near one that keeps the volume, c3 = 0.1 and c4 = 0.9.
AREA = {"log1p_J_area": float(np.log1p(0.1)), "log1p_J_volume": float(np.log1p(0.9))}


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


def open_laws(found: InterfaceEstimate, settings: Constrained, count: int, seed: int) -> list[OpenLaw]:
    """Every law with one term more that explains the test as well as the kept one.

    Args:
        found: the kept field.
        settings: configuration of the stage, whose terms may join.
        count, seed: of the samples of each law.
    """
    kept, random, laws = found.found, np.random.default_rng(seed), []
    terms = open_terms(kept.terms, settings)
    if terms:
        score = score_test(kept, terms)
        # Laws differ most in the largest step.
        compared = _Compared(with_law(kept.problem, score.points.law), kept, largest_steps(kept.problem))
        laws += [_of_term(kept, score, compared, term, count, random) for term in terms]
    if "J" in terms_left(kept.terms, settings) and not _volume_refuted(found):
        laws.append(_of_volume(kept, count, random))
    return [law for law in laws if law is not None]


def terms_left(kept: tuple[str, ...], settings: Constrained) -> tuple[str, ...]:
    """Terms that may join a law, and J where the test decides on the volume."""
    return open_terms(kept, settings) + (("J",) if settings.volume == "told" and "J" not in kept else ())


def _volume_refuted(found: InterfaceEstimate) -> bool:
    """Whether the search tried laws of another volume, and displacements speak against all of them.

    Each is compared with the law that it stood against, on the same elements and load steps.
    """
    lacks = []
    for trial in found.trace.reasons:
        if "J" not in trial.terms:
            continue
        against = trial.start
        while against is not None and "J" in against.terms:
            against = against.start
        own = 1.0 if against is None else max(against.misfits["displacement"], 1.0)
        lacks.append(found.left.independent * np.log(trial.misfits["displacement"] / own))
    return bool(lacks and min(lacks) > thresholds.AS_WELL)


def _of_term(kept: Candidate, score: ScoreTest, compared: "_Compared", term: str, count: int, random) -> OpenLaw:
    """A law that contains the kept one, fibres in all directions."""
    joined, fields, gains = score.joined(term), [], []
    for first, each in enumerate(joined):
        gains.append(each.least(priors.LAW_HELD)[1])
        size = len(each.slope)
        drawn = [each.least(priors.LAW_HELD, random.normal(size=size))[0] for _ in range(first, count, len(joined))]
        changes = [each.by_chance(random.normal(size=len(each.free))) for _ in drawn]

        def at(n, near, each=each, drawn=drawn, changes=changes):
            y, materials = each.at(near * drawn[n], near * changes[n])
            return kept.fit.field.at(y, kept.fit.field.still).with_law(materials)

        fields += compared.near_enough(at, [float(x.max()) for x in drawn], len(each.free) + size)
    law = score.points.with_term(term)
    alone = [field.with_law(score.points.of_term(term, field.materials)) for field in fields]
    return OpenLaw(term, law, _of_cells(alone), max(gains))


def _of_volume(kept: Candidate, count: int, random) -> OpenLaw | None:
    """A law of another volume; None where it explains the test worse."""
    terms = (*(term for term in kept.terms if term not in OF_THICKNESS), "J")
    problem = with_law(kept.problem, dataclasses.replace(kept.problem.basis, terms=terms))
    begun = kept.fit.field.with_law(translated(kept.fit.field.materials, kept.problem, problem, AREA))
    steps = largest_and_half(problem)
    compared = _Compared(problem, kept, steps)
    test = SeenTest(problem, steps, kept.fit.window)
    fit = InterfaceFit(test, move_lines=False).descend(begun, [kept.u[k] for k in steps], budgets.OTHER_VOLUME_STEPS)
    if fit is None or (gain := compared.own - compared.cost(fit.field)) < -thresholds.AS_WELL:
        return None
    numbers = numbers_of(problem, fit.field, fit.field.still, None)
    states = test.with_tangents(fit.field, fit.states)
    loads = test.loads(fit.field, states, numbers.moves)
    shared, residuals = (each(states, kept.sigma_left) for each in (test.shared, test.residuals))
    curvature, _ = shared.normal(test.jacobians(states, loads, kept.sigma_left), residuals)
    going = np.flatnonzero(numbers.within)
    half = np.linalg.cholesky((curvature + numbers.held.toarray())[np.ix_(going, going)])
    drawn = [np.linalg.solve(half.T, random.normal(size=len(going))) for _ in range(count)]

    def at(n, near):
        y = numbers.y.copy()
        y[going] += near * drawn[n]
        return fit.field.at(np.clip(y, *numbers.bounds), numbers.moves)

    fields = compared.near_enough(at, [float(np.abs(each).max()) for each in drawn], len(going))
    return OpenLaw("J", problem.basis, _of_cells(fields), gain)


class _Compared:
    """Fields of a law, compared with a candidate in some load steps."""

    def __init__(self, problem: FieldProblem, kept: Candidate, steps: list[int]):
        self._sigma = kept.sigma_left
        self._guesses = [kept.u[k] for k in steps]
        self._test = SeenTest(kept.problem, steps, kept.fit.window)
        self.own = self.cost(kept.fit.field)
        self._test = SeenTest(problem, steps, kept.fit.window)

    def cost(self, field: Interfaces) -> float:
        """Half of the squared residuals; infinite without equilibrium."""
        if (states := self._test.states(field, self._guesses)) is None:
            return np.inf
        test, sigma = self._test, self._sigma
        return 0.5 * test.shared(states, sigma).squared(test.residuals(states, sigma))

    def near_enough(self, at: Callable[[int, float], Interfaces], sizes: list[float], numbers: int) -> list[Interfaces]:
        """Samples that explain the test within what chance allows.

        A linear model of large changes is as wrong. The largest sample is brought nearer by half until it explains the
        test, and no other one is larger.

        Args:
            at: number of a sample, and its size over that of the draw -> the sample.
            sizes: of the draws.
            numbers: how many numbers were drawn.
        """
        allowed, largest = self.own + 0.5 * numbers + thresholds.AS_WELL, int(np.argmax(sizes))
        nearer = (0.5**halved for halved in range(budgets.HALVED))
        near = next((each for each in nearer if self.cost(at(largest, each)) <= allowed), 0.0)
        most = near * sizes[largest]
        return [at(n, 1.0 if size <= most else most / size) for n, size in enumerate(sizes)]


def _of_cells(fields: list[Interfaces]) -> Float[np.ndarray, "parameter posterior_sample part cell"]:
    """Parameters of the material at the centre of every cell."""
    return np.stack([field.by_cell() for field in fields], axis=1)[:, :, None]
