"""Whether a sheet keeps its volume: the test decides between laws that keep it and laws with J.

A law of I1 alone that keeps the volume is the plainest, and stands where it explains the test. Where it leaves more
than noise, or has terms that may stand for a volume that changes, the same materials are tried with another law. Its
area has an energy of its own, and the likelier law is kept. It has no fibres: one test hardly tells both. Where no few
materials of a kept volume explain the test, the search begins again with such laws.
"""

from collections.abc import Callable
from typing import NamedTuple

from hypernode.config.methods import Constrained
from hypernode.identification import budgets, thresholds
from hypernode.identification.candidate import Candidate
from hypernode.identification.choice import likeliest
from hypernode.identification.estimate import Estimate
from hypernode.identification.force_course import unless_impossible
from hypernode.identification.interface_estimate import InterfaceEstimate
from hypernode.identification.law_search import OF_THICKNESS, LawSearch, translated
from hypernode.identification.trials import Trials


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
        far: whether J leaves far more.
        open: whether both are about as likely.
    """

    kept: Candidate
    far: bool = False
    open: bool = False


def with_area(settings: Constrained) -> Constrained | None:
    """The same search through laws with J; None where they are not asked for, or where all laws have it."""
    if settings.volume != "told" or "J" in settings.terms:
        return None
    every = (*settings.isotropic_terms, *settings.terms, *settings.further_terms)
    further = ["I1_squared"] if "I1_squared" in every else []
    return settings.model_copy(update={"terms": ["J"], "isotropic_terms": [], "further_terms": further})


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
    problem, field = trials.problem(["J"], kept.subcells), kept.fit.field
    begin = dict(zip(problem.basis.names, problem.homogeneous.params, strict=True))
    materials = translated(field.materials, kept.problem, problem, begin)
    law = problem, field.with_law(materials), kept.u, steps
    found = trials.descend("a volume that changes", kept, *law, budgets.GIVEN_UP_AFTER, kept.fit.window, finds_window)
    if found is None:
        return Asked(kept)
    far = found.level > thresholds.NOT_MADE_OF_FEW * max(kept.level, 1.0)
    if not far:
        law = problem, found.fit.field, found.u, steps
        found = (
            trials.descend("the same, more steps", found, *law, budgets.NEAR, found.fit.window, finds_window) or found
        )
        found = LawSearch(trials, steps, finds_window).end(found)
    gain = found.gain_over(kept)
    best, passed = (found, kept) if gain > thresholds.EVIDENCE and not kept.halves(found) else (kept, found)
    why = f"scores {abs(gain):+.1f} against" if (gain > 0.0) == (best is found) else "leaves twice the squares of"
    trials.passed_over(passed, f"{why} a law that says otherwise of the volume")
    return Asked(best, far, abs(gain) <= thresholds.EVIDENCE)


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
