"""Whether a sheet keeps its volume: the test decides between laws that keep it and laws with J.

A law of I1 alone that keeps the volume is the plainest, and stands where it explains the test. Where it leaves more
than noise, or has terms that may stand for a volume that changes, the search begins again. It goes through laws whose
area has an energy of its own, and the likelier field is kept. These have no fibres: one test hardly tells both.
"""

from collections.abc import Callable

from hypernode.config.methods import Constrained
from hypernode.identification.candidate import BY_CHANCE, EVIDENCE
from hypernode.identification.choice import likeliest
from hypernode.identification.estimate import Estimate
from hypernode.identification.interface_estimate import InterfaceEstimate

#: Terms that contain the thickness, which J leaves open.
OF_THICKNESS = ("I2", "ogden")


def with_area(settings: Constrained) -> Constrained | None:
    """The same search through laws with J; None where they are not asked for, or where all laws have it."""
    if settings.volume != "told" or "J" in settings.terms:
        return None
    every = (*settings.isotropic_terms, *settings.terms, *settings.further_terms)
    further = ["I1_squared"] if "I1_squared" in every else []
    return settings.model_copy(update={"terms": ["J"], "isotropic_terms": [], "further_terms": further})


def may_stand_for_area(found: InterfaceEstimate) -> bool:
    """Whether a law that keeps the volume may do so in the place of one that does not.

    It does where it leaves more than noise, or has terms that change the stress across a pull.
    """
    return bool(set(found.basis.terms) & {*OF_THICKNESS, "fibre"}) or leaves_more_than_noise(found)


def leaves_more_than_noise(found: InterfaceEstimate) -> bool:
    """Whether displacements leave more than what is believed of their noise, by more than chance."""
    known = found.problem.observations.noise_uncertainty
    limit = 1.0 + BY_CHANCE * max(known, (2.0 * found.left.independent) ** -0.5)
    return found.left.level / found.problem.observations.scatter > limit


def of_either(
    settings: Constrained, search: Callable[[Constrained], InterfaceEstimate | None]
) -> InterfaceEstimate | None:
    """The field of few materials whose law keeps the volume, or the one that does not where it is likelier.

    Args:
        search: what finds a field of few materials; None where they do not explain the test.
    """
    kept, other = search(settings), with_area(settings)
    if other is None or (kept is not None and not may_stand_for_area(kept)):
        return kept
    changes = search(other)
    if kept is None or changes is None:
        return changes or kept
    # Of residuals that share as much as those of the one that shares more.
    independent = min(kept.left.independent, changes.left.independent)
    gain = _total(kept, independent) - _total(changes, independent)
    best, passed = (changes, kept) if gain > EVIDENCE else (kept, changes)
    return best.instead_of(passed, because=f"scores {abs(gain):+.1f} against a law that says otherwise of the volume")


def _total(found: InterfaceEstimate, independent: float) -> float:
    score = found.score
    return score.total + (independent / found.left.independent - 1.0) * score.displacements


def of_cells_of_either(settings: Constrained, search: Callable[[Constrained], Estimate]) -> Estimate:
    """A field of cells whose law keeps the volume, or the likelier one of the area's energy alone."""
    kept, other = search(settings), with_area(settings)
    if other is None or not settings.layers:
        return kept
    return likeliest(kept, search(other.model_copy(update={"further_terms": []})))
