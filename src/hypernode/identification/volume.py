"""Whether a sheet keeps its volume: the test decides between laws that keep it and laws with J.

A law of I1 alone that keeps the volume is the plainest, and stands where it explains the test. Where it leaves more
than noise, or has terms that may stand for a volume that changes, the same materials are tried with another law. Its
area has an energy of its own in the place of fibres, or beside them where that is far off. The likelier law is kept.
Where no few materials of a kept volume explain the test, the search begins again with such laws.
"""

from collections.abc import Callable
from typing import NamedTuple

from hypernode.config.methods import Constrained
from hypernode.identification import budgets, numerics, thresholds
from hypernode.identification.candidate import Candidate
from hypernode.identification.choice import likeliest
from hypernode.identification.estimate import Estimate
from hypernode.identification.force_course import unless_impossible
from hypernode.identification.interface_estimate import InterfaceEstimate
from hypernode.identification.law_search import OF_THICKNESS, LawSearch, translated
from hypernode.identification.score_test import BELONGS
from hypernode.identification.trials import Trials
from hypernode.verdict import Ending


class Parts(NamedTuple):
    """What a search for few materials ended with.

    Attributes:
        found: the field; None where few materials do not explain the test, or where they are not sought.
        keeps_volume: whether no law with J came near, so that none is sought further.
    """

    found: InterfaceEstimate | None
    keeps_volume: bool


class Asked(NamedTuple):
    """What a test says of the volume of given materials.

    Attributes:
        kept: the candidate, or the same materials of a law with J where that is likelier.
        far: whether J leaves far more, without fibres.
        open: whether both are about as likely.
    """

    kept: Candidate
    far: bool = False
    open: bool = False


def with_area(settings: Constrained, fibres: bool = False) -> Constrained | None:
    """The same search through laws with J; None where they are not asked for, or where all laws have it.

    Args:
        fibres: whether these laws may have fibres.
    """
    if settings.volume != "told" or "J" in settings.terms:
        return None
    every = dict.fromkeys([*settings.isotropic_terms, *settings.terms, *settings.further_terms])
    terms = ["J", *(term for term in every if fibres and of_fibres(term))]
    further = [term for term in every if term == "I1_squared"]
    return settings.model_copy(update={"terms": terms, "isotropic_terms": [], "further_terms": further})


def of_fibres(term: str) -> bool:
    """Whether a term is that of fibres, or says more of them."""
    return BELONGS.get(term, term) == "fibre"


def may_stand_for_area(kept: Candidate) -> bool:
    """Whether a law that keeps the volume may do so in the place of one that does not.

    It does where it leaves more than noise, or has terms that change the stress across a pull.
    """
    return bool(set(kept.terms) & {*OF_THICKNESS, "fibre"}) or kept.leaves_more_than_noise


def of_likelier_volume(trials: Trials, kept: Candidate, steps: list[int], finds_window: bool) -> Asked:
    """Whether a law with J is likelier than that of a candidate, between the same materials.

    Args:
        steps: load steps that count.
        finds_window: whether the side of the window is sought.
    """
    told = with_area(trials.settings) is None or "J" in kept.terms or kept.leaves_nothing
    if told or not may_stand_for_area(kept):
        return Asked(kept)
    found = _with_area(trials, kept, (), steps, finds_window)
    far = found is not None and _is_far(found, kept)
    if (far or found is None) and (fibres := tuple(filter(of_fibres, kept.terms))):
        if found is not None:
            trials.passed_over(found, "leaves far more than fibres do")
        found = _with_area(trials, kept, fibres, steps, finds_window) or found
    if found is None:
        return Asked(kept)
    if not _is_far(found, kept):
        if found.fit.ending is not Ending.CONVERGED:
            law, window = (found.problem, found.fit.field, found.u, steps), found.fit.window
            found = trials.descend("the same, more steps", found, *law, budgets.NEAR, window, finds_window) or found
        found = LawSearch(trials, steps, finds_window).end(found)
    gain = found.gain_over(kept)
    best, passed = (found, kept) if gain > thresholds.EVIDENCE and not kept.halves(found) else (kept, found)
    why = f"scores {abs(gain):+.1f} against" if (gain > 0.0) == (best is found) else "leaves twice the squares of"
    trials.passed_over(passed, f"{why} a law that says otherwise of the volume")
    return Asked(best, far, abs(gain) <= thresholds.EVIDENCE)


def _is_far(found: Candidate, kept: Candidate) -> bool:
    return found.level > thresholds.NOT_MADE_OF_FEW * max(kept.level, 1.0)


def _with_area(trials: Trials, kept: Candidate, fibres: tuple[str, ...], steps, finds_window) -> Candidate | None:
    """The materials of a candidate with J, beside its terms of fibres or in their place; None without equilibrium."""
    problem, field = trials.problem(["J", *fibres], kept.subcells), kept.fit.field
    begin = numerics.NEARLY_KEPT if fibres else dict(zip(problem.basis.names, problem.homogeneous.params, strict=True))
    law = problem, field.with_law(translated(field.materials, kept.problem, problem, begin)), kept.u, steps
    return trials.descend("a volume that changes", kept, *law, budgets.GIVEN_UP_AFTER, kept.fit.window, finds_window)


def of_either(
    settings: Constrained, parts: Callable[[Constrained], Parts], cells: Callable[[Constrained], Estimate]
) -> Estimate:
    """The field of few materials, or of cells, with a law that keeps the volume or with one that changes it.

    Laws with J are tried where others explain nothing, unless they were far off already.

    Args:
        parts, cells: searches for either field.
    """
    found, keeps_volume = parts(settings)
    other = None if keeps_volume else with_area(settings)
    if found is None and other is not None:
        found = unless_impossible(lambda: parts(other).found)
    if found is not None:
        return found
    kept = cells(settings)
    if other is None or not settings.layers or not kept.underfitted:
        return kept
    more = unless_impossible(lambda: cells(other.model_copy(update={"further_terms": []})))
    return kept if more is None else likeliest(kept, more)
